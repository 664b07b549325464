//! The U-Net that regresses the 2-PolyVector field, with its input and its weights.

mod backend;
mod config;
pub(crate) mod engine;
mod features;
#[cfg(feature = "train")]
mod model;
#[cfg(feature = "train")]
mod store;
mod weights;

pub use backend::Backend;
pub use config::UNetConfig;
pub(crate) use features::{Extractor, Shown};
pub use features::{Features, Input, features, shown};
#[cfg(feature = "train")]
pub use model::{Block, UNet, Within};
#[cfg(feature = "train")]
pub use store::save;
pub use weights::Weights;
