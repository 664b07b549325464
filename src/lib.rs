//! Turns raster line drawings into few, smooth, editable centreline strokes.

pub mod clean;
pub mod drawing;
pub mod error;
pub mod estimate;
pub mod field;
pub mod fit;
pub mod graph;
pub mod hooks;
pub mod inspect;
pub mod load;
pub mod options;
pub mod pipeline;
mod profile;
pub mod raster;
pub mod render;
pub mod streamline;
pub mod write;

pub use error::{Error, Result};
