//! From a field and the ink to streamlines.

use kurbo::Point;

/// A traced centreline: points about half a pixel apart.
#[derive(Clone, Debug, PartialEq)]
pub struct Streamline {
    /// The points, in pixels of the line image. A closed streamline does not repeat its first point.
    pub points: Vec<Point>,
    /// Measured ink width at each point, in pixels; NaN inside junctions, where it cannot be measured.
    pub widths: Vec<f64>,
    /// Whether the last point joins the first.
    pub closed: bool,
}

/// Traces the ink along the field.
pub fn trace(_image: &crate::clean::LineImage, _frames: &crate::field::FrameField) -> Vec<Streamline> {
    Vec::new()
}
