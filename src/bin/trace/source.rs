//! Where the field comes from.

use crate::args::{self, CleanArgs, Estimator, FieldSourceArgs, FitArgs, NetworkArgs};
use fieldtrace::Result;
use fieldtrace::estimate::{FieldEstimator, StructureTensor};
use fieldtrace::pipeline::Vectorizer;

/// What traces under the options and with the estimator that were asked for.
pub(crate) fn vectorizer(source: &FieldSourceArgs, clean: &CleanArgs, fit: Option<&FitArgs>) -> Result<Vectorizer> {
    Vectorizer::with(args::options(clean, fit), estimator(source.estimator, &source.network)?)
}

/// The estimator that was asked for.
#[cfg_attr(not(feature = "learned"), allow(unused_variables))]
pub(crate) fn estimator(kind: Estimator, network: &NetworkArgs) -> Result<Box<dyn FieldEstimator>> {
    match kind {
        Estimator::Tensor => Ok(Box::new(StructureTensor::default())),
        #[cfg(feature = "learned")]
        Estimator::Unet => Ok(Box::new(unet(network)?)),
    }
}

/// The network of some weights on some device.
#[cfg(feature = "learned")]
fn unet(args: &NetworkArgs) -> Result<fieldtrace::estimate::UNet> {
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
