//! The tensor library's side of a file of weights.

use super::config::UNetConfig;
use super::model::UNet;
use super::weights::{CONFIG, Weights};
use crate::error::{Error, Result};
use burn::store::{HalfPrecisionAdapter, ModuleSnapshot, SafetensorsStore};
use burn::tensor::Device;
use std::path::Path;

impl Weights {
    /// The network on a device of the tensor library.
    ///
    /// # Errors
    /// [`Error::Weights`] when the file does not hold all of it.
    pub fn model(&self, device: &Device) -> Result<UNet> {
        let mut model = self.config().init(device, 0);
        let store = SafetensorsStore::from_bytes(Some(self.bytes()));
        let mut store = store.with_from_adapter(HalfPrecisionAdapter::new());
        model.load_from(&mut store).map_err(|e| self.failed(e))?;
        Ok(model)
    }
}

/// Saves a network to a file that [`Weights::read`] reads, whole or not at all.
///
/// # Errors
/// [`Error::Weights`] when the file cannot be written.
pub fn save(path: &Path, config: &UNetConfig, model: &UNet) -> Result<()> {
    let failed = |reason: String| Error::Weights { input: path.display().to_string(), reason };
    let shape = serde_json::to_string(config).map_err(|e| failed(e.to_string()))?;
    // One entry only, for the order of several is not fixed.
    let store = SafetensorsStore::from_file(path).overwrite(true).clear_metadata().metadata(CONFIG, shape);
    model.save_into(&mut store.with_to_adapter(HalfPrecisionAdapter::new())).map_err(|e| failed(e.to_string()))
}
