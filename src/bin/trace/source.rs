//! Where the field comes from.

use crate::args::{self, CleanArgs, Estimator, FieldSourceArgs, FitArgs, NetworkArgs};
use fieldtrace::Result;
use fieldtrace::estimate::{FieldEstimator, StructureTensor, UNet};
use fieldtrace::pipeline::Vectorizer;
use fieldtrace::unet::{Backend, Weights};

/// What traces under the options and with the estimator that were asked for.
pub(crate) fn vectorizer(source: &FieldSourceArgs, clean: &CleanArgs, fit: Option<&FitArgs>) -> Result<Vectorizer> {
    let all = Vectorizer::with(args::options(clean, fit), estimator(source.estimator, &source.network)?)?;
    fit.iter().flat_map(|fit| &fit.without).try_fold(all, |vectorizer, pass| vectorizer.without(pass))
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
