//! What runs a network.

use crate::error::{Error, Result};
#[cfg(feature = "train")]
use burn::tensor::Device;

/// What runs a network.
#[derive(Clone, Debug)]
pub enum Backend {
    /// The crate's own engine, on the CPU.
    Engine,
    /// A device of the tensor library.
    #[cfg(feature = "train")]
    Library(Device),
}

impl Backend {
    /// The backend of a name: the engine for `auto` and `cpu`. `flex` is the tensor library's own on the CPU, built in by
    /// the Cargo feature `train`; `ndarray` and `gpu` by the features of those names.
    ///
    /// # Errors
    /// [`Error::Option`] when there is no such backend or the program was built without it.
    pub fn named(name: &str) -> Result<Self> {
        match name {
            "auto" | "cpu" => Ok(Self::Engine),
            #[cfg(feature = "train")]
            "flex" => Ok(Self::Library(Device::flex())),
            #[cfg(feature = "ndarray")]
            #[allow(deprecated, reason = "deprecated upstream in favour of flex; kept for comparison")]
            "ndarray" => Ok(Self::Library(Device::ndarray())),
            #[cfg(feature = "gpu")]
            "gpu" => Ok(Self::Library(Device::wgpu(burn::tensor::DeviceKind::DefaultDevice))),
            #[cfg(not(feature = "train"))]
            "flex" => Err(missing(name, "train")),
            #[cfg(not(feature = "ndarray"))]
            "ndarray" => Err(missing(name, name)),
            #[cfg(not(feature = "gpu"))]
            "gpu" => Err(missing(name, name)),
            _ => Err(Error::Option {
                option: "device",
                reason: format!("{name} is not auto, cpu, flex, ndarray or gpu"),
            }),
        }
    }

    /// The device to train on; the engine cannot, so that is the tensor library's own on the CPU.
    #[cfg(feature = "train")]
    pub fn to_train(self) -> Device {
        match self {
            Self::Engine => Device::flex(),
            Self::Library(device) => device,
        }
    }
}

#[cfg(not(all(feature = "ndarray", feature = "gpu")))]
fn missing(name: &str, feature: &str) -> Error {
    Error::Option {
        option: "device",
        reason: format!("{name} needs a program that was built with --features {feature}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn backends_have_names() {
        let engine = |name| matches!(Backend::named(name), Ok(Backend::Engine));
        assert!(engine("auto") && engine("cpu"));
        assert!(Backend::named("tpu").unwrap_err().to_string().contains("tpu"));
        let built_in = [("flex", "train"), ("ndarray", "ndarray"), ("gpu", "gpu")];
        let features = [cfg!(feature = "train"), cfg!(feature = "ndarray"), cfg!(feature = "gpu")];
        for ((name, feature), is_built_in) in built_in.into_iter().zip(features) {
            match Backend::named(name) {
                Ok(_) => assert!(is_built_in),
                Err(e) => assert!(!is_built_in && e.to_string().ends_with(&format!("--features {feature}"))),
            }
        }
    }
}
