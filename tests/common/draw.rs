//! Known drawings and their rasters.

use super::paper::Paper;
use fieldtrace::drawing::{Centreline, Color, Drawing, Segment, Stroke};
use fieldtrace::load::Scan;
use fieldtrace::options::Options;
use fieldtrace::pipeline::Vectorizer;
use fieldtrace::raster::Raster;
use fieldtrace::render::render;
use kurbo::{Arc, BezPath, Circle, CubicBez, Line, PathEl, Point, Vec2};
use tiny_skia::{FillRule, LineCap, LineJoin, Paint, PathBuilder, Pixmap, Transform};

/// A chain of straight lines.
pub fn polyline(points: &[Point], closed: bool, width: f64) -> Stroke {
    let mut segments: Vec<Segment> = points.windows(2).map(|p| Segment::Line(Line::new(p[0], p[1]))).collect();
    if closed {
        segments.push(Segment::Line(Line::new(points[points.len() - 1], points[0])));
    }
    stroke(Centreline::Path { segments, closed }, width)
}

/// One straight line.
pub fn line(from: impl Into<Point>, to: impl Into<Point>, width: f64) -> Stroke {
    polyline(&[from.into(), to.into()], false, width)
}

/// A full circle.
pub fn circle(center: impl Into<Point>, radius: f64, width: f64) -> Stroke {
    stroke(Centreline::Circle(Circle::new(center, radius)), width)
}

/// A circular arc; angles in radians.
pub fn arc(center: impl Into<Point>, radius: f64, start: f64, sweep: f64, width: f64) -> Stroke {
    let arc = Arc::new(center, (radius, radius), start, sweep, 0.0);
    stroke(Centreline::Path { segments: vec![Segment::Arc(arc)], closed: false }, width)
}

/// One cubic.
pub fn cubic(points: [(f64, f64); 4], width: f64) -> Stroke {
    let [a, b, c, d] = points;
    let segments = vec![Segment::Cubic(CubicBez::new(a, b, c, d))];
    stroke(Centreline::Path { segments, closed: false }, width)
}

/// A dot of a diameter.
pub fn dot(center: impl Into<Point>, diameter: f64) -> Stroke {
    stroke(Centreline::Dot(center.into()), diameter)
}

fn stroke(centreline: Centreline, width: f64) -> Stroke {
    Stroke::new(centreline, width)
}

/// The point at a distance and an angle in degrees, clockwise on the screen.
pub fn polar(center: Point, degrees: f64, distance: f64) -> Point {
    center + Vec2::from_angle(degrees.to_radians()) * distance
}

/// A drawing on a canvas.
pub fn sheet(width: usize, height: usize, strokes: Vec<Stroke>) -> Drawing {
    Drawing { strokes, ..Drawing::new(width as f64, height as f64) }
}

/// How ink is put on the canvas.
#[derive(Clone, Copy, Debug)]
pub struct Pen {
    /// How lines end.
    pub cap: LineCap,
    /// How lines turn.
    pub join: LineJoin,
    /// Whether edges are grey.
    pub anti_alias: bool,
}

impl Default for Pen {
    fn default() -> Self {
        Self { cap: LineCap::Round, join: LineJoin::Round, anti_alias: true }
    }
}

/// Black strokes on white, as a scan, drawn by a round pen.
pub fn scan(drawing: &Drawing) -> Scan {
    scan_by(drawing, Pen::default())
}

/// Black strokes on white, as a scan.
pub fn scan_by(drawing: &Drawing, pen: Pen) -> Scan {
    let (width, height) = (drawing.width as u32, drawing.height as u32);
    let mut pixmap = Pixmap::new(width, height).expect("a canvas");
    let paint = Paint { anti_alias: pen.anti_alias, ..Paint::default() };
    for fill in &drawing.fills {
        let path = skia_path(&fill.outline);
        pixmap.fill_path(&path, &paint, FillRule::EvenOdd, Transform::identity(), None);
    }
    for stroke in &drawing.strokes {
        if let Centreline::Dot(p) = stroke.centreline {
            let path = PathBuilder::from_circle(p.x as f32, p.y as f32, 0.5 * stroke.width as f32).expect("a dot");
            pixmap.fill_path(&path, &paint, FillRule::Winding, Transform::identity(), None);
            continue;
        }
        let pen = tiny_skia::Stroke {
            width: stroke.width as f32,
            line_cap: pen.cap,
            line_join: pen.join,
            ..tiny_skia::Stroke::default()
        };
        let path = skia_path(&stroke.centreline.to_path());
        if stroke.width <= 1.0 {
            // As a line, it would be one of its own: without caps, and thinner the nearer to a diagonal.
            let outline = path.stroke(&pen, 4.0).expect("an outline");
            pixmap.fill_path(&outline, &paint, FillRule::Winding, Transform::identity(), None);
            continue;
        }
        pixmap.stroke_path(&path, &paint, &pen, Transform::identity(), None);
    }
    let gray = pixmap.pixels().iter().map(|p| 1.0 - f32::from(p.alpha()) / 255.0).collect();
    scan_of(Raster::from_vec(width as usize, height as usize, gray).expect("one sample a pixel"))
}

/// Strokes in their own colours on a ground, drawn by a round pen; later strokes cover earlier ones.
pub fn color_scan(drawing: &Drawing, ground: Color) -> Scan {
    let (width, height) = (drawing.width as u32, drawing.height as u32);
    let mut pixmap = Pixmap::new(width, height).expect("a canvas");
    let skia = |Color([r, g, b]): Color| tiny_skia::Color::from_rgba8(r, g, b, 255);
    pixmap.fill(skia(ground));
    let mut paint = Paint::default();
    for fill in &drawing.fills {
        paint.set_color(skia(fill.color));
        pixmap.fill_path(&skia_path(&fill.outline), &paint, FillRule::EvenOdd, Transform::identity(), None);
    }
    for stroke in &drawing.strokes {
        paint.set_color(skia(stroke.color));
        let pen = tiny_skia::Stroke {
            width: stroke.width as f32,
            line_cap: LineCap::Round,
            line_join: LineJoin::Round,
            ..tiny_skia::Stroke::default()
        };
        pixmap.stroke_path(&skia_path(&stroke.centreline.to_path()), &paint, &pen, Transform::identity(), None);
    }
    let pixels = pixmap.pixels();
    let rgb = image::RgbImage::from_fn(width, height, |x, y| {
        let p = pixels[(y * width + x) as usize];
        image::Rgb([p.red(), p.green(), p.blue()])
    });
    scan_of_rgb(rgb)
}

/// A scan of colours without a resolution.
pub fn scan_of_rgb(rgb: image::RgbImage) -> Scan {
    let luma = |x: usize, y: usize| {
        let [r, g, b] = rgb.get_pixel(x as u32, y as u32).0.map(|v| f32::from(v) / 255.0);
        0.2126 * r + 0.7152 * g + 0.0722 * b
    };
    Scan { gray: Raster::from_fn(rgb.width() as usize, rgb.height() as usize, luma), rgb: Some(rgb), dpi: None }
}

fn skia_path(path: &BezPath) -> tiny_skia::Path {
    let mut builder = PathBuilder::new();
    let f = |p: Point| (p.x as f32, p.y as f32);
    for element in path.elements() {
        match *element {
            PathEl::MoveTo(p) => builder.move_to(f(p).0, f(p).1),
            PathEl::LineTo(p) => builder.line_to(f(p).0, f(p).1),
            PathEl::QuadTo(a, p) => builder.quad_to(f(a).0, f(a).1, f(p).0, f(p).1),
            PathEl::CurveTo(a, b, p) => builder.cubic_to(f(a).0, f(a).1, f(b).0, f(b).1, f(p).0, f(p).1),
            PathEl::ClosePath => builder.close(),
        }
    }
    builder.finish().expect("a path")
}

/// A grey scan without a resolution.
pub fn scan_of(gray: Raster<f32>) -> Scan {
    Scan { gray, rgb: None, dpi: None }
}

/// Pencil on paper without specks.
pub const SPECKLESS: Paper = Paper { specks: 0.0, ..Paper::PENCIL };

/// A drawing by a round pen as a scan of some paper; `seed` makes each its own.
pub fn on_paper(drawing: &Drawing, paper: Paper, seed: u64) -> Scan {
    scan_of(paper.scan(&scan(drawing).gray, seed))
}

/// A drawing as a scan, dashes and all.
pub fn rendered(drawing: &Drawing) -> Scan {
    scan_of(render(drawing).map(|ink| 1.0 - ink))
}

/// The trace of a scan under the default options.
pub fn trace(scan: &Scan) -> Drawing {
    trace_under(Options::default(), scan)
}

/// The trace of a scan under some options, without the passes that `FIELDTRACE_WITHOUT` names, with commas between them: so
/// it is found which tests guard a pass.
pub fn trace_under(options: Options, scan: &Scan) -> Drawing {
    let all = Vectorizer::new(options).expect("options in their range");
    let names = std::env::var("FIELDTRACE_WITHOUT").unwrap_or_default();
    let names = names.split(',').filter(|name| !name.is_empty());
    let vectorizer = names.fold(all, |vectorizer, name| vectorizer.without(name).expect("the name of a pass"));
    vectorizer.trace(scan).expect("a trace")
}
