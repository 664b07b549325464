//! From a drawing to bytes on disk.
//!
//! [`to_svg`] gives the text, [`pen_order`] the order of its paths, and [`write_file`] puts bytes in
//! place whole or not at all.

mod file;
mod number;
mod order;
mod path_data;
mod svg;

pub use file::write_file;
pub use order::{pen_order, pen_up_length};
pub use svg::{SvgOptions, to_svg};

pub(crate) use number::Rounding;
