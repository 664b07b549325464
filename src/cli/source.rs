//! Where the field comes from.

use crate::Result;
use crate::cli::args::{self, CleanArgs, Estimator, FieldSourceArgs, FitArgs, NetworkArgs};
use crate::estimate::{FieldEstimator, StructureTensor, UNet};
use crate::options::StrokeWidth;
use crate::pipeline::Vectorizer;
use crate::unet::{Backend, Weights};
use crate::write::Format;

/// What traces under the options and with the estimator that were asked for, for a format where strokes are written.
pub(crate) fn vectorizer(
    source: &FieldSourceArgs,
    clean: &CleanArgs,
    fit: Option<(&FitArgs, &dyn Format)>,
) -> Result<Vectorizer> {
    let mut options = args::options(clean, fit.map(|(fit, _)| fit));
    if options.width == StrokeWidth::Profile && fit.is_some_and(|(_, format)| !format.has_profiles()) {
        options.width = StrokeWidth::Outline;
    }
    let all = Vectorizer::with(options, estimator(source.estimator, &source.network)?)?;
    let mut without = fit.iter().flat_map(|(fit, _)| &fit.without);
    without.try_fold(all, |vectorizer, pass| vectorizer.without(pass))
}

/// The estimator that was asked for.
pub(crate) fn estimator(kind: Estimator, network: &NetworkArgs) -> Result<Box<dyn FieldEstimator>> {
    Ok(match kind {
        Estimator::Tensor => Box::new(StructureTensor::default()),
        Estimator::Unet => {
            let backend = Backend::named(&network.device.device)?;
            let weights = network.weights.as_deref().map_or_else(Weights::built_in, Weights::read)?;
            Box::new(UNet::new(&weights, backend)?)
        }
    })
}
