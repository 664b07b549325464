//! Weights on disk: a safetensors file with the numbers of a network, and its shape among the metadata.
//!
//! Tensors have the names and layouts of the fields of the network: `down.N` and `up.N`, blocks with `conv1`, `norm1`,
//! `conv2` and `norm2`, then `head`. Convolutions are in half precision, norms in single; either is read anywhere.

use super::config::UNetConfig;
use crate::error::{Error, Result};
use half::f16;
use half::slice::HalfFloatSliceExt;
use safetensors::{Dtype, SafeTensors};
use std::borrow::Cow;
use std::path::Path;

/// Metadata key of the shape, as JSON.
pub(super) const CONFIG: &str = "fieldtrace.unet";

/// A file of weights in memory.
#[derive(Clone, Debug)]
pub struct Weights {
    /// What the file is called in errors.
    name: String,
    config: UNetConfig,
    bytes: Cow<'static, [u8]>,
}

impl Weights {
    /// The weights that the program carries.
    ///
    /// # Errors
    /// [`Error::Weights`] never, unless the program was built around a broken file.
    pub fn built_in() -> Result<Self> {
        Self::new("the built-in weights".into(), Cow::Borrowed(include_bytes!("weights/field.safetensors")))
    }

    /// The weights of the network that finds ink, which the program carries too.
    ///
    /// # Errors
    /// [`Error::Weights`] never, unless the program was built around a broken file.
    pub fn built_in_ink() -> Result<Self> {
        Self::new("the built-in ink weights".into(), Cow::Borrowed(include_bytes!("weights/ink.safetensors")))
    }

    /// The weights in a file that `trace train` wrote.
    ///
    /// # Errors
    /// [`Error::Read`] when the file cannot be read, [`Error::Weights`] when it does not hold a network.
    pub fn read(path: &Path) -> Result<Self> {
        let name = path.display().to_string();
        let bytes = std::fs::read(path).map_err(|cause| Error::Read { input: name.clone(), cause })?;
        Self::new(name, Cow::Owned(bytes))
    }

    fn new(name: String, bytes: Cow<'static, [u8]>) -> Result<Self> {
        let fail = |reason: String| Error::Weights { input: name.clone(), reason };
        let (_, header) =
            SafeTensors::read_metadata(&bytes).map_err(|e| fail(format!("not a safetensors file: {e}")))?;
        let shape = header.metadata().as_ref().and_then(|all| all.get(CONFIG));
        let shape = shape.ok_or_else(|| fail("holds no network".into()))?;
        let config: UNetConfig = serde_json::from_str(shape).map_err(|e| fail(e.to_string()))?;
        if !config.is_sound() {
            return Err(fail(format!("there is no network of such a shape: {shape}")));
        }
        Ok(Self { name, config, bytes })
    }

    /// The shape of the network.
    pub fn config(&self) -> UNetConfig {
        self.config
    }

    /// The numbers of the network.
    pub(super) fn numbers(&self) -> Result<Numbers<'_>> {
        let tensors = SafeTensors::deserialize(&self.bytes).map_err(|e| self.failed(e))?;
        Ok(Numbers { weights: self, tensors })
    }

    /// Other numbers for a network of this shape.
    pub(super) fn with_bytes(&self, bytes: Cow<'static, [u8]>) -> Self {
        Self { name: self.name.clone(), config: self.config, bytes }
    }

    #[cfg(feature = "train")]
    pub(super) fn bytes(&self) -> Vec<u8> {
        self.bytes.to_vec()
    }

    /// The error for something wrong with the file.
    pub(crate) fn failed(&self, cause: impl std::fmt::Display) -> Error {
        Error::Weights { input: self.name.clone(), reason: cause.to_string() }
    }
}

/// The tensors of a file by name.
pub(super) struct Numbers<'a> {
    weights: &'a Weights,
    pub tensors: SafeTensors<'a>,
}

impl Numbers<'_> {
    /// The numbers of a tensor of a shape.
    pub fn get(&self, name: &str, shape: &[usize]) -> Result<Vec<f32>> {
        let failed = |reason: String| self.weights.failed(format!("{name}: {reason}"));
        let tensor = self.tensors.tensor(name).map_err(|e| failed(e.to_string()))?;
        if tensor.shape() != shape {
            return Err(failed(format!("is {:?} and has to be {shape:?}", tensor.shape())));
        }
        let bytes = tensor.data();
        match tensor.dtype() {
            Dtype::F16 => {
                let half: Vec<f16> = bytes.as_chunks().0.iter().map(|b| f16::from_le_bytes(*b)).collect();
                Ok(half.to_f32_vec())
            }
            Dtype::F32 => Ok(bytes.as_chunks().0.iter().map(|b| f32::from_le_bytes(*b)).collect()),
            other => Err(failed(format!("numbers of type {other:?} are not read"))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_built_in_weights_can_be_read() {
        assert_eq!(Weights::built_in().unwrap().config(), UNetConfig::default());
        assert_eq!(Weights::built_in_ink().unwrap().config(), UNetConfig::ink());
    }

    #[test]
    fn a_file_that_holds_no_network_is_named() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("some.safetensors");
        let refused = |bytes: &[u8], reason: &str| {
            std::fs::write(&path, bytes).unwrap();
            let error = Weights::read(&path).unwrap_err().to_string();
            assert!(error.contains("some.safetensors") && error.contains(reason), "{error}");
        };
        refused(b"nothing", "not a safetensors file");
        refused(&[&2u64.to_le_bytes()[..], b"{}"].concat(), "no network");
        let with = |shape: &str| {
            let shape = shape.replace('"', "\\\"");
            let header = format!("{{\"__metadata__\":{{\"{CONFIG}\":\"{shape}\"}}}}");
            [&(header.len() as u64).to_le_bytes()[..], header.as_bytes()].concat()
        };
        refused(&with(r#"{"width":16,"depth":9}"#), "depth");
        refused(&with(r#"{"levels":63}"#), "no network of such a shape");
        std::fs::write(&path, with(r#"{"width":16}"#)).unwrap();
        let error = super::super::engine::Engine::new(&Weights::read(&path).unwrap()).unwrap_err().to_string();
        assert!(error.contains("some.safetensors") && error.contains("down.0.conv1.weight"), "{error}");
    }
}
