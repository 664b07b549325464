//! From a drawing back to ink.

use crate::drawing::{Centreline, Drawing, Stroke};
use crate::raster::Raster;
use kurbo::{BezPath, PathEl};
use tiny_skia::{FillRule, LineCap, LineJoin, Paint, Path, PathBuilder, Pixmap, StrokeDash, Transform};

/// How much of each pixel a drawing inks, 0 to 1, anti-aliased: strokes with round caps and joins over
/// solid regions. Colours are not looked at. The raster has the canvas' size, rounded up.
pub fn render(drawing: &Drawing) -> Raster<f32> {
    let size = |side: f64| (side.ceil().max(0.0)) as u32;
    let (width, height) = (size(drawing.width), size(drawing.height));
    let Some(mut pixmap) = Pixmap::new(width, height) else {
        return Raster::filled(width as usize, height as usize, 0.0);
    };
    let paint = Paint { anti_alias: true, ..Paint::default() };
    for fill in &drawing.fills {
        if let Some(path) = skia_path(&fill.outline) {
            pixmap.fill_path(&path, &paint, FillRule::EvenOdd, Transform::identity(), None);
        }
    }
    for stroke in &drawing.strokes {
        draw_stroke(&mut pixmap, &paint, stroke);
    }
    let coverage = pixmap.pixels().iter().map(|p| f32::from(p.alpha()) / 255.0).collect();
    Raster::from_vec(width as usize, height as usize, coverage).expect("one sample a pixel")
}

fn draw_stroke(pixmap: &mut Pixmap, paint: &Paint, stroke: &Stroke) {
    let width = stroke.width as f32;
    if let Centreline::Dot(p) = stroke.centreline {
        if let Some(path) = PathBuilder::from_circle(p.x as f32, p.y as f32, 0.5 * width) {
            pixmap.fill_path(&path, paint, FillRule::Winding, Transform::identity(), None);
        }
        return;
    }
    let dash = stroke.dashes.and_then(|d| StrokeDash::new(vec![d.dash as f32, d.gap as f32], d.offset as f32));
    let pen = tiny_skia::Stroke {
        width,
        line_cap: LineCap::Round,
        line_join: LineJoin::Round,
        dash,
        ..tiny_skia::Stroke::default()
    };
    if let Some(path) = skia_path(&stroke.centreline.to_path()) {
        pixmap.stroke_path(&path, paint, &pen, Transform::identity(), None);
    }
}

/// The path in `f32`; `None` where it is empty or not finite.
fn skia_path(path: &BezPath) -> Option<Path> {
    let mut builder = PathBuilder::new();
    for element in path.elements() {
        let f = |p: kurbo::Point| (p.x as f32, p.y as f32);
        match *element {
            PathEl::MoveTo(p) => builder.move_to(f(p).0, f(p).1),
            PathEl::LineTo(p) => builder.line_to(f(p).0, f(p).1),
            PathEl::QuadTo(a, p) => builder.quad_to(f(a).0, f(a).1, f(p).0, f(p).1),
            PathEl::CurveTo(a, b, p) => builder.cubic_to(f(a).0, f(a).1, f(b).0, f(b).1, f(p).0, f(p).1),
            PathEl::ClosePath => builder.close(),
        }
    }
    builder.finish()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::{Color, Fill, Segment};
    use kurbo::{Circle, Line, Point, Rect, Shape};

    fn drawing(centreline: Centreline, width: f64) -> Drawing {
        let mut drawing = Drawing::new(40.0, 30.0);
        drawing.strokes.push(Stroke::new(centreline, width));
        drawing
    }

    fn area(raster: &Raster<f32>) -> f64 {
        raster.data().iter().map(|&c| f64::from(c)).sum()
    }

    #[test]
    fn the_ink_has_the_area_of_the_strokes() {
        let line = Segment::Line(Line::new((10.0, 10.0), (30.0, 10.0)));
        let round_ends = std::f64::consts::PI * 4.0;
        let cases = [
            (Centreline::Path { segments: vec![line], closed: false }, 80.0 + round_ends),
            (Centreline::Circle(Circle::new((20.0, 15.0), 8.0)), 2.0 * std::f64::consts::PI * 8.0 * 4.0),
            (Centreline::Dot(Point::new(12.3, 9.1)), round_ends),
        ];
        for (centreline, expected) in cases {
            let ink = render(&drawing(centreline, 4.0));
            assert_eq!(ink.size(), (40, 30));
            assert!((area(&ink) - expected).abs() < 0.02 * expected + 0.2, "{} is not {expected}", area(&ink));
        }
    }

    #[test]
    fn coverage_is_exact_for_straight_edges() {
        let line = Segment::Line(Line::new((5.0, 10.25), (35.0, 10.25)));
        let ink = render(&drawing(Centreline::Path { segments: vec![line], closed: false }, 2.0));
        for (y, expected) in [(8, 0.0), (9, 0.75), (10, 1.0), (11, 0.25)] {
            assert!((ink[(20, y)] - expected).abs() < 0.02, "{} in row {y}", ink[(20, y)]);
        }
    }

    #[test]
    fn holes_are_left_open() {
        let mut drawing = Drawing::new(20.0, 20.0);
        let mut outline = Rect::new(2.0, 2.0, 18.0, 18.0).to_path(0.1);
        outline.extend(Rect::new(6.0, 6.0, 14.0, 14.0).to_path(0.1));
        drawing.fills.push(Fill { outline, color: Color::BLACK });
        let ink = render(&drawing);
        assert_eq!((ink[(4, 4)], ink[(10, 10)]), (1.0, 0.0));
    }

    #[test]
    fn an_empty_canvas_is_no_error() {
        assert_eq!(render(&Drawing::new(0.0, 5.0)).size(), (0, 5));
    }
}
