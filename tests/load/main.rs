//! Reading inputs: every format, depth and orientation against expected pixels, every bad input against its error.

mod bad;
mod fixtures;
mod formats;
mod metadata;
mod pages;
mod sizes;
mod svg;
mod tiff;
