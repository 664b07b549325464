//! Where the field comes from.

use crate::args::{self, CleanArgs, Estimator, FieldSourceArgs, FitArgs};
use fieldtrace::Result;
use fieldtrace::estimate::{FieldEstimator, StructureTensor};
use fieldtrace::pipeline::Vectorizer;

/// What traces under the options and with the estimator that were asked for.
pub(crate) fn vectorizer(source: &FieldSourceArgs, clean: &CleanArgs, fit: Option<&FitArgs>) -> Result<Vectorizer> {
    Vectorizer::with(args::options(clean, fit), estimator(source)?)
}

/// The estimator that was asked for.
fn estimator(args: &FieldSourceArgs) -> Result<Box<dyn FieldEstimator>> {
    match args.estimator {
        Estimator::Tensor => Ok(Box::new(StructureTensor::default())),
        #[cfg(feature = "learned")]
        Estimator::Unet => Ok(Box::new(network(args)?)),
    }
}

/// The network of some weights on some device.
#[cfg(feature = "learned")]
fn network(args: &FieldSourceArgs) -> Result<fieldtrace::estimate::UNet> {
    use fieldtrace::estimate::UNet;
    use fieldtrace::unet;
    let Some(device) = unet::device(&args.device.device)? else {
        return args.weights.as_deref().map_or_else(UNet::built_in, UNet::from_file);
    };
    let weights = match &args.weights {
        Some(path) => unet::load(path, &device)?,
        None => unet::built_in(&device)?,
    };
    Ok(UNet::on_device(weights, device))
}
