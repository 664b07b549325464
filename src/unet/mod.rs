//! The U-Net that regresses the 2-PolyVector field, with its input and its weights.

mod device;
pub(crate) mod engine;
mod features;
mod model;
mod weights;

pub use device::device;
pub(crate) use features::{Extractor, Shown};
pub use features::{Features, Input, features, shown};
pub use model::{Block, UNet, UNetConfig};
pub use weights::{Weights, built_in, load, save};
