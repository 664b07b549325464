//! From trails to strokes.
use crate::drawing::*;
/// Fits every trail.
pub fn fit(
    image: &crate::clean::LineImage,
    graph: &crate::graph::StrokeGraph,
    _options: &crate::options::Options,
) -> crate::drawing::Drawing {
    let mut d = crate::drawing::Drawing::new(image.ink.width() as f64, image.ink.height() as f64);
    for t in &graph.trails {
        let w = graph.walk(t);
        let segments: Vec<Segment> = w.windows(2).map(|p| Segment::Line(kurbo::Line::new(p[0].point, p[1].point))).collect();
        if segments.is_empty() { continue; }
        d.strokes.push(Stroke { centreline: Centreline::Path { segments, closed: t.closed }, width: image.line_width, color: Color::BLACK });
    }
    d
}
