//! From ink to a 2-PolyVector field.

mod tensor;
mod unet;

pub use tensor::StructureTensor;
pub use unet::UNet;

use crate::cancel::Cancel;
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

    /// The same unless told to stop; one that takes long polls the token on its way.
    ///
    /// # Errors
    /// Those of [`Self::estimate`] and the token's.
    fn estimate_until(&self, image: &LineImage, cancel: &Cancel) -> Result<PolyVectorField> {
        cancel.check()?;
        self.estimate(image)
    }
}
