//! What is done to the graph once it is assembled.

pub(super) mod confidence;
mod dashes;
mod ends;
pub(super) mod gaps;
mod layers;
pub(super) mod taper;

pub use confidence::DOUBTFUL;
pub(crate) use layers::join as join_layers;
