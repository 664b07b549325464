//! Pictures of what each stage made, laid over the input, and whether that looks like a line drawing.
//!
//! Each `*_overlay` function gives an SVG in pixels of the input, with the lightened input inside it, and
//! [`to_png`] makes it a picture. [`DebugDir`] is an observer that writes one of each stage to a folder.

#[cfg(feature = "svg-input")]
mod comparison;
#[cfg(feature = "files")]
mod debug_dir;
#[cfg(feature = "svg-input")]
mod field;
#[cfg(feature = "svg-input")]
mod graph;
mod likeness;
#[cfg(feature = "svg-input")]
mod lines;
#[cfg(feature = "svg-input")]
mod overlay;
#[cfg(feature = "svg-input")]
mod strokes;

#[cfg(feature = "files")]
pub use debug_dir::DebugDir;
pub use likeness::{NO_DRAWING, edge_share};
#[cfg(feature = "svg-input")]
pub use {
    comparison::comparison_overlay,
    field::{coverage_picture, field_overlay, ink_picture},
    graph::{graph_overlay, streamlines_overlay},
    lines::lines_overlay,
    overlay::to_png,
    strokes::drawing_overlay,
};
