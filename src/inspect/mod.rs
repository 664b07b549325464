//! Pictures of what each stage made, laid over the input, and whether that looks like a line drawing.
//!
//! Each `*_overlay` function gives an SVG in pixels of the input, with the lightened input inside it, and
//! [`to_png`] makes it a picture. [`DebugDir`] is an observer that writes one of each stage to a folder.

mod comparison;
mod debug_dir;
mod field;
mod graph;
mod likeness;
mod lines;
mod overlay;
mod strokes;

pub use comparison::comparison_overlay;
pub use debug_dir::DebugDir;
pub use field::{coverage_picture, field_overlay, ink_picture};
pub use graph::{graph_overlay, streamlines_overlay};
pub use likeness::{NO_DRAWING, edge_share};
pub use lines::lines_overlay;
pub use overlay::to_png;
pub use strokes::drawing_overlay;
