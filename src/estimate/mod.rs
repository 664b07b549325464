//! From ink to a 2-PolyVector field.

use crate::clean::LineImage;
use crate::error::Result;
use crate::field::PolyVectorField;

/// Anything that can tell the directions of a line drawing.
pub trait FieldEstimator: Send + Sync {
    /// A short name for messages and tables.
    fn name(&self) -> &str;

    /// The field of an image, of the image's size, defined at least on its mask.
    ///
    /// # Errors
    /// [`crate::Error::Estimate`] when no field can be given.
    fn estimate(&self, image: &LineImage) -> Result<PolyVectorField>;
}

/// The field from local gradients, without a network.
#[derive(Clone, Debug, Default)]
pub struct StructureTensor;

impl FieldEstimator for StructureTensor {
    fn name(&self) -> &str {
        "tensor"
    }

    fn estimate(&self, image: &LineImage) -> Result<PolyVectorField> {
        let (w, h) = image.ink.size();
        Ok(PolyVectorField::from_directions(w, h, |_, _| None))
    }
}
