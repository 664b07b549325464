//! Weights on disk: one file that holds the network's shape and its numbers, in half precision.

use super::model::{UNet, UNetConfig};
use crate::error::{Error, Result};
use burn::store::burn_pack::Reader;
use burn::store::{BurnpackStore, HalfPrecisionAdapter, ModuleSnapshot};
use burn::tensor::{Bytes, Device};
use std::path::Path;

/// A network with the shape that it was built from.
#[derive(Clone, Debug)]
pub struct Weights {
    /// The shape.
    pub config: UNetConfig,
    /// The network.
    pub model: UNet,
}

/// Metadata key of the shape, as JSON.
const CONFIG: &str = "fieldtrace.unet";

/// Saves a network; convolutions are rounded to half precision, norms are kept.
///
/// # Errors
/// [`Error::Weights`] when the file cannot be written.
pub fn save(path: &Path, config: &UNetConfig, model: &UNet) -> Result<()> {
    let name = path.display().to_string();
    let shape = serde_json::to_string(config).map_err(|e| failed(&name, e))?;
    let store = BurnpackStore::from_file(path).overwrite(true).auto_extension(false);
    let mut store = store.metadata(CONFIG, shape).with_to_adapter(HalfPrecisionAdapter::new());
    model.save_into(&mut store).map_err(|e| failed(&name, e))
}

/// Loads a network that [`save`] wrote.
///
/// # Errors
/// [`Error::Weights`] when the file cannot be read or does not hold such a network.
pub fn load(path: &Path, device: &Device) -> Result<Weights> {
    let name = path.display().to_string();
    let reader = Reader::from_file_exact(path).map_err(|e| failed(&name, e))?;
    load_from(&name, &reader, BurnpackStore::from_file(path).auto_extension(false), device)
}

/// The weights that the program carries.
///
/// # Errors
/// [`Error::Weights`] never, unless the program was built around a broken file.
pub fn built_in(device: &Device) -> Result<Weights> {
    let name = "the built-in weights";
    let reader = Reader::from_bytes(Bytes::from_bytes_vec(BUILT_IN.0.to_vec())).map_err(|e| failed(name, e))?;
    load_from(name, &reader, BurnpackStore::from_static(&BUILT_IN.0), device)
}

/// Tensors are read in place, so their bytes have to be aligned.
#[repr(align(64))]
struct Aligned<T: ?Sized>(T);

static BUILT_IN: &Aligned<[u8]> = &Aligned(*include_bytes!("weights/field.bpk"));

fn load_from(name: &str, reader: &Reader, store: BurnpackStore, device: &Device) -> Result<Weights> {
    let shape = reader.metadata().get(CONFIG).ok_or_else(|| failed(name, "holds no field network"))?;
    let config: UNetConfig = serde_json::from_str(shape).map_err(|e| failed(name, e))?;
    let mut model = config.init(device, 0);
    let mut store = store.with_from_adapter(HalfPrecisionAdapter::new());
    model.load_from(&mut store).map_err(|e| failed(name, e))?;
    Ok(Weights { config, model })
}

fn failed(name: &str, cause: impl std::fmt::Display) -> Error {
    Error::Weights { input: name.to_owned(), reason: cause.to_string() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_built_in_weights_can_be_read() {
        let weights = built_in(&Device::flex()).unwrap();
        assert_eq!(weights.config, UNetConfig::default());
    }
}
