//! Training of the network that sees ink on pages.

mod loss;
mod pages;
mod pictures;
mod sample;
#[cfg(test)]
mod tests;
mod validate;

pub(super) use loss::InkLoss;
pub(super) use pages::Stored;
pub(super) use sample::crops;
pub use validate::{InkError, InkValidation, InkValidator};
