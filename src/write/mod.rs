//! From a drawing to bytes on disk.
//!
//! [`to_svg`] gives the text, [`pen_order`] the order of its paths, [`graph_json`] writes the stroke graph and reads it
//! back, [`write_file`] puts bytes in place whole or not at all, and [`remove_abandoned`] clears away what a killed run
//! left of that.

mod file;
pub mod graph_json;
mod number;
mod order;
mod path_data;
mod svg;

pub use file::{remove_abandoned, write_file, write_png};
pub use order::{pen_order, pen_up_length};
pub use svg::{SvgOptions, to_svg};

pub(crate) use number::Rounding;
