//! From trails to strokes.

/// Fits every trail.
pub fn fit(
    image: &crate::clean::LineImage,
    _graph: &crate::graph::StrokeGraph,
    _options: &crate::options::Options,
) -> crate::drawing::Drawing {
    crate::drawing::Drawing::new(image.ink.width() as f64, image.ink.height() as f64)
}
