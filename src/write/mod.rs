//! From a drawing to bytes on disk.
//!
//! [`to_svg`] gives the text, [`pen_order`] the order of its paths, [`graph_json`] writes the stroke graph and reads it
//! back, and [`write_file`] puts bytes in place whole or not at all.

mod file;
pub mod graph_json;
mod number;
mod order;
mod path_data;
mod svg;

pub use file::write_file;
pub use order::{pen_order, pen_up_length};
pub use svg::{SvgOptions, to_svg};

pub(crate) use number::Rounding;
