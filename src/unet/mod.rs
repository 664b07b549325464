//! The U-Nets that regress the 2-PolyVector field and that find ink on a page, with their input and their weights.

mod backend;
mod config;
pub(crate) mod engine;
mod features;
mod ink;
mod mirror;
#[cfg(feature = "train")]
mod model;
#[cfg(feature = "train")]
mod store;
mod weights;

pub use backend::Backend;
pub use config::{Output, UNetConfig};
#[cfg(feature = "train")]
pub(crate) use features::signs;
pub(crate) use features::{Extractor, Shown};
pub use features::{Features, Input, features, shown};
pub use ink::InkNet;
#[cfg(feature = "train")]
pub(crate) use ink::MIDDLE;
#[cfg(feature = "train")]
pub(crate) use mirror::SWAPPED;
#[cfg(feature = "train")]
pub use model::{Block, UNet, Within};
#[cfg(feature = "train")]
pub use store::save;
pub use weights::Weights;
