//! The U-Net that regresses the 2-PolyVector field, with its input and its weights.

mod backend;
mod config;
pub(crate) mod engine;
mod features;
mod mirror;
#[cfg(feature = "train")]
mod model;
#[cfg(feature = "train")]
mod store;
mod weights;

pub use backend::Backend;
pub use config::UNetConfig;
#[cfg(feature = "train")]
pub(crate) use features::signs;
pub(crate) use features::{Extractor, Shown};
pub use features::{Features, Input, features, shown};
#[cfg(feature = "train")]
pub(crate) use mirror::SWAPPED;
#[cfg(feature = "train")]
pub use model::{Block, UNet, Within};
#[cfg(feature = "train")]
pub use store::save;
pub use weights::Weights;
