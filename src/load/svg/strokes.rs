//! The strokes of a parsed SVG: what a trace of its rendering should find.

use super::arcs::with_arcs;
use super::canvas;
use crate::drawing::{Centreline, Color, Drawing, Fill, Segment, Stroke};
use kurbo::{Affine, BezPath, CubicBez, Line, PathEl, Point, QuadBez, Shape};
use resvg::tiny_skia::PathSegment;
use usvg::{Group, LineCap, Node, Paint, PaintOrder, Tree};

/// Distance in pixels under which points are the same and a filled region has no inside.
const ZERO_LENGTH: f64 = 1e-4;

/// Most dashes of one path; finer patterns are taken as a solid line.
const MOST_DASHES: f64 = 50_000.0;

/// The strokes and fills of an SVG in pixels of its rendering at `scale` pixels for one CSS pixel.
///
/// - Each subpath of a stroked shape is one [`Stroke`], dashes are strokes of their own, and subpaths without length
///   are dots where they have caps. Quadratic pieces are raised to cubics; circular arcs are arcs again, and circles
///   circles.
/// - All transforms are applied; a width is scaled by the square root of the transform's area factor.
/// - A filled shape is a [`Fill`]; text is filled outlines.
/// - The colour is that of the paint over white; gradients count as the mean of their stops and patterns as black.
/// - White paint over the bare canvas is paper and left out, so is what is invisible. Clips, masks, filters and
///   embedded images are not followed.
pub fn drawing(tree: &Tree, scale: f64) -> Drawing {
    let (width, height) = canvas(tree, scale);
    let mut drawing = Drawing::new(width as f64, height as f64);
    add_group(tree.root(), 1.0, scale, &mut drawing);
    drawing
}

fn add_group(group: &Group, opacity: f32, scale: f64, drawing: &mut Drawing) {
    for node in group.children() {
        match node {
            Node::Group(g) => add_group(g, opacity * g.opacity().get(), scale, drawing),
            Node::Text(t) => add_group(t.flattened(), opacity, scale, drawing),
            Node::Path(p) if p.is_visible() => add_path(p, opacity, scale, drawing),
            Node::Path(_) | Node::Image(_) => {}
        }
    }
}

fn add_path(path: &usvg::Path, opacity: f32, scale: f64, drawing: &mut Drawing) {
    let outline = outline(path.data());
    let to_pixels = Affine::scale(scale) * affine(path.abs_transform());
    if path.paint_order() == PaintOrder::FillAndStroke {
        add_fill(path, &outline, to_pixels, opacity, drawing);
        add_strokes(path, &outline, to_pixels, opacity, drawing);
    } else {
        add_strokes(path, &outline, to_pixels, opacity, drawing);
        add_fill(path, &outline, to_pixels, opacity, drawing);
    }
}

fn add_fill(path: &usvg::Path, outline: &BezPath, to_pixels: Affine, opacity: f32, drawing: &mut Drawing) {
    let Some(fill) = path.fill() else { return };
    let Some(color) = color(fill.paint(), fill.opacity().get() * opacity, drawing) else { return };
    let outline = to_pixels * closed(outline);
    if !is_flat(&outline) {
        drawing.fills.push(Fill { outline, color });
    }
}

fn add_strokes(path: &usvg::Path, outline: &BezPath, to_pixels: Affine, opacity: f32, drawing: &mut Drawing) {
    let Some(stroke) = path.stroke() else { return };
    let Some(color) = color(stroke.paint(), stroke.opacity().get() * opacity, drawing) else { return };
    let width = f64::from(stroke.width().get()) * to_pixels.determinant().abs().sqrt();
    let line = to_pixels * dashed(outline, stroke);
    let capped = stroke.linecap() != LineCap::Butt;
    let centrelines = subpaths(&line).into_iter().filter_map(|s| centreline(&s, capped));
    drawing.strokes.extend(centrelines.map(|centreline| Stroke { color, ..Stroke::new(centreline, width) }));
}

/// The colour of a paint over white; `None` where it cannot be seen.
fn color(paint: &Paint, opacity: f32, drawing: &Drawing) -> Option<Color> {
    let mean = |stops: &[usvg::Stop]| {
        let mut sum = [0.0; 4];
        for s in stops {
            let c = s.color();
            let values = [f32::from(c.red), f32::from(c.green), f32::from(c.blue), s.opacity().get()];
            sum.iter_mut().zip(values).for_each(|(sum, v)| *sum += v / stops.len() as f32);
        }
        sum
    };
    let [r, g, b, a] = match paint {
        Paint::Color(c) => [f32::from(c.red), f32::from(c.green), f32::from(c.blue), 1.0],
        Paint::LinearGradient(l) => mean(l.stops()),
        Paint::RadialGradient(r) => mean(r.stops()),
        Paint::Pattern(_) => [0.0, 0.0, 0.0, 1.0],
    };
    let alpha = a * opacity;
    let seen = [r, g, b].map(|c| (255.0 + (c - 255.0) * alpha).round() as u8);
    let bare = drawing.fills.is_empty() && drawing.strokes.is_empty();
    (alpha > 0.0 && !(bare && seen == [255; 3])).then_some(Color(seen))
}

fn affine(t: usvg::Transform) -> Affine {
    Affine::new([t.sx, t.ky, t.kx, t.sy, t.tx, t.ty].map(f64::from))
}

fn outline(path: &resvg::tiny_skia::Path) -> BezPath {
    let p = |p: resvg::tiny_skia::Point| Point::new(p.x.into(), p.y.into());
    let element = |s| match s {
        PathSegment::MoveTo(a) => PathEl::MoveTo(p(a)),
        PathSegment::LineTo(a) => PathEl::LineTo(p(a)),
        PathSegment::QuadTo(a, b) => PathEl::QuadTo(p(a), p(b)),
        PathSegment::CubicTo(a, b, c) => PathEl::CurveTo(p(a), p(b), p(c)),
        PathSegment::Close => PathEl::ClosePath,
    };
    BezPath::from_vec(path.segments().map(element).collect())
}

/// The path with every subpath closed.
fn closed(path: &BezPath) -> BezPath {
    let mut all = BezPath::new();
    for mut subpath in subpaths(path) {
        if !matches!(subpath.elements().last(), Some(PathEl::ClosePath)) {
            subpath.close_path();
        }
        all.extend(subpath);
    }
    all
}

/// Whether all points lie on one line, so that nothing is enclosed.
fn is_flat(path: &BezPath) -> bool {
    let points = points(path);
    let Some(&first) = points.first() else { return true };
    let far =
        points.iter().fold(first, |a, &b| if b.distance_squared(first) > a.distance_squared(first) { b } else { a });
    let along = far - first;
    let length = along.hypot();
    length < ZERO_LENGTH || points.iter().all(|&p| along.cross(p - first).abs() / length < ZERO_LENGTH)
}

/// All end and control points.
fn points(path: &BezPath) -> Vec<Point> {
    let mut points = Vec::new();
    for element in path.elements() {
        match *element {
            PathEl::MoveTo(a) | PathEl::LineTo(a) => points.push(a),
            PathEl::QuadTo(a, b) => points.extend([a, b]),
            PathEl::CurveTo(a, b, c) => points.extend([a, b, c]),
            PathEl::ClosePath => {}
        }
    }
    points
}

fn dashed(path: &BezPath, stroke: &usvg::Stroke) -> BezPath {
    let Some(pattern) = stroke.dasharray() else { return path.clone() };
    let pattern: Vec<f64> = pattern.iter().map(|&d| f64::from(d).max(0.0)).collect();
    let period: f64 = pattern.iter().sum();
    let dashes = path.perimeter(1e-2) / period * pattern.len() as f64;
    // False where the period is nothing and the ratio no number.
    if dashes < MOST_DASHES {
        kurbo::dash(path.iter(), f64::from(stroke.dashoffset()).rem_euclid(period), &pattern).collect()
    } else {
        path.clone()
    }
}

/// One path for each move of the pen.
fn subpaths(path: &BezPath) -> Vec<BezPath> {
    let mut all: Vec<Vec<PathEl>> = Vec::new();
    let mut start = Point::ZERO;
    for &element in path.elements() {
        let closed = all.last().is_none_or(|s| matches!(s.last(), Some(PathEl::ClosePath)));
        match element {
            PathEl::MoveTo(p) => {
                start = p;
                all.push(vec![element]);
            }
            // What follows a closing without a move starts where the closed subpath did.
            _ if closed => all.push(vec![PathEl::MoveTo(start), element]),
            _ => all.last_mut().expect("an open subpath").push(element),
        }
    }
    all.into_iter().filter(|s| s.len() > 1).map(BezPath::from_vec).collect()
}

/// The centreline of one subpath; `None` where it has no length and no caps to show it.
fn centreline(subpath: &BezPath, capped: bool) -> Option<Centreline> {
    let first = *points(subpath).first()?;
    let mut closed = matches!(subpath.elements().last(), Some(PathEl::ClosePath));
    let mut segments: Vec<Segment> = Vec::new();
    for segment in subpath.segments() {
        let segment = match segment {
            kurbo::PathSeg::Line(l) => Segment::Line(l),
            kurbo::PathSeg::Quad(q) => raised(q),
            kurbo::PathSeg::Cubic(c) => Segment::Cubic(c),
        };
        if extent(&segment) > ZERO_LENGTH {
            segments.push(segment);
        }
    }
    if segments.is_empty() {
        return capped.then_some(Centreline::Dot(first));
    }
    // Pieces that were left out for want of length may have been the ones that met.
    closed &= segments[segments.len() - 1].end().distance(segments[0].start()) <= 2.0 * ZERO_LENGTH;
    Some(with_arcs(&segments, closed))
}

fn raised(q: QuadBez) -> Segment {
    Segment::Cubic(q.raise())
}

/// Greatest distance of a piece's points from its start.
fn extent(segment: &Segment) -> f64 {
    match segment {
        Segment::Line(Line { p0, p1 }) => p0.distance(*p1),
        Segment::Cubic(CubicBez { p0, p1, p2, p3 }) => {
            [p1, p2, p3].map(|p| p.distance(*p0)).into_iter().fold(0.0, f64::max)
        }
        Segment::Arc(a) => a.radii.x,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_subpath_after_a_closing_starts_where_the_closed_one_did() {
        let path = BezPath::from_svg("M1 1L5 1L5 5ZL9 9M2 2M3 3L4 4").unwrap();
        let parts = subpaths(&path);
        assert_eq!(parts.len(), 3);
        assert_eq!(parts[1], BezPath::from_svg("M1 1L9 9").unwrap());
        assert_eq!(parts[2], BezPath::from_svg("M3 3L4 4").unwrap());
    }

    #[test]
    fn flat_outlines_enclose_nothing() {
        assert!(is_flat(&BezPath::from_svg("M0 0L10 10L5 5Z").unwrap()));
        assert!(is_flat(&BezPath::from_svg("M3 3L3 3").unwrap()));
        assert!(!is_flat(&BezPath::from_svg("M0 0L10 10L10 0L0 10Z").unwrap()), "a figure of eight has area");
    }

    #[test]
    fn what_has_no_length_is_a_dot_only_with_caps() {
        let path = BezPath::from_svg("M3 4L3 4").unwrap();
        assert_eq!(centreline(&path, true), Some(Centreline::Dot(Point::new(3.0, 4.0))));
        assert_eq!(centreline(&path, false), None);
    }
}
