//! Where the network runs.

use crate::error::{Error, Result};
use burn::tensor::Device;

/// The tensor library's device of a name; `None` for `auto` and `cpu`, which are the crate's own engine.
///
/// `flex` is the tensor library's own CPU backend. `ndarray` and `gpu` exist where the program was built with the Cargo
/// feature of that name.
///
/// # Errors
/// [`Error::Option`] when there is no such device or the program was built without it.
pub fn device(name: &str) -> Result<Option<Device>> {
    match name {
        "auto" | "cpu" => Ok(None),
        "flex" => Ok(Some(Device::flex())),
        #[cfg(feature = "ndarray")]
        #[allow(deprecated, reason = "deprecated upstream in favour of flex; kept for comparison")]
        "ndarray" => Ok(Some(Device::ndarray())),
        #[cfg(feature = "gpu")]
        "gpu" => Ok(Some(Device::wgpu(burn::tensor::DeviceKind::DefaultDevice))),
        "ndarray" | "gpu" => {
            let reason = format!("{name} needs a program that was built with --features {name}");
            Err(Error::Option { option: "device", reason })
        }
        _ => Err(Error::Option { option: "device", reason: format!("{name} is not auto, cpu, flex, ndarray or gpu") }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn devices_have_names() {
        assert!(device("auto").unwrap().is_none() && device("cpu").unwrap().is_none());
        assert!(device("flex").unwrap().is_some());
        assert!(device("tpu").unwrap_err().to_string().contains("tpu"));
        #[cfg(not(feature = "gpu"))]
        assert!(device("gpu").unwrap_err().to_string().contains("--features gpu"));
    }
}
