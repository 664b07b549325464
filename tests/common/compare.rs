//! How far two drawings are apart.

use fieldtrace::drawing::{Centreline, Drawing, Segment};
use fieldtrace::render::render;
use kurbo::{Affine, BezPath, ParamCurve, ParamCurveArclen, Point};
use rstar::primitives::Line;
use rstar::{PointDistance, RTree};

/// Distance between samples along a line, in pixels.
const SPACING: f64 = 0.25;

/// Share of ink that two drawings have in common.
pub fn common_ink(a: &Drawing, b: &Drawing) -> f64 {
    let (a, b) = (render(a), render(b));
    let sum =
        |f: fn(f32, f32) -> f32| -> f64 { a.data().iter().zip(b.data()).map(|(&a, &b)| f64::from(f(a, b))).sum() };
    sum(f32::min) / sum(f32::max)
}

/// The centrelines of a drawing.
pub fn lines(drawing: &Drawing) -> Vec<BezPath> {
    drawing.strokes.iter().map(|s| s.centreline.to_path()).collect()
}

/// The centrelines under a map.
pub fn mapped(drawing: &Drawing, map: Affine) -> Vec<BezPath> {
    lines(drawing).into_iter().map(|path| map * path).collect()
}

/// Distances between two sets of lines, both ways.
#[derive(Clone, Copy, Debug)]
pub struct Apart {
    /// Mean distance from a point of one set to the other set, the mean of both ways.
    pub mean: f64,
    /// The largest distance from a point of one set to the other set, over both ways.
    pub max: f64,
}

/// How far two sets of lines are apart; infinitely where only one of them is empty.
pub fn apart(a: &[BezPath], b: &[BezPath]) -> Apart {
    let (a, b) = (sampled(a), sampled(b));
    if a.is_empty() && b.is_empty() {
        return Apart { mean: 0.0, max: 0.0 };
    }
    let (out, home) = (distances(&a, &b), distances(&b, &a));
    let mean = |d: &[f64]| d.iter().sum::<f64>() / d.len() as f64;
    let max = out.iter().chain(&home).fold(0.0f64, |m, d| m.max(*d));
    Apart { mean: 0.5 * (mean(&out) + mean(&home)), max }
}

/// How far the strokes of two drawings are apart.
pub fn strokes_apart(a: &Drawing, b: &Drawing) -> Apart {
    apart(&lines(a), &lines(b))
}

/// How far a trace is from the lines that were drawn, when the truth's last `margin` pixels before each open end
/// may be missing: where a line ends is a question of its own.
pub fn body_apart(truth: &Drawing, traced: &Drawing, margin: f64) -> Apart {
    let (mut from, to) = (sampled(&lines(truth)), sampled(&lines(traced)));
    let ends = ends_of(truth);
    for chain in &mut from {
        chain.retain(|p| ends.iter().all(|end| p.distance(*end) > margin));
    }
    let missing = distances(&from, &to).into_iter().fold(0.0, f64::max);
    let added = distances(&to, &sampled(&lines(truth))).into_iter().fold(0.0, f64::max);
    Apart { max: missing.max(added), ..strokes_apart(truth, traced) }
}

/// The largest distance from a point of the first set to the second.
pub fn farthest(from: &[BezPath], to: &[BezPath]) -> f64 {
    distances(&sampled(from), &sampled(to)).into_iter().fold(0.0, f64::max)
}

/// Lines as chains of points at even distances; a dot is a chain of one.
fn sampled(paths: &[BezPath]) -> Vec<Vec<Point>> {
    let chain = |path: &BezPath| {
        let mut points: Vec<Point> = path.elements().first().and_then(|e| e.end_point()).into_iter().collect();
        for segment in path.segments() {
            let count = (segment.arclen(1e-3) / SPACING).ceil() as usize;
            points.extend((1..=count).map(|i| segment.eval(i as f64 / count as f64)));
        }
        points
    };
    paths.iter().map(chain).filter(|points| !points.is_empty()).collect()
}

/// Distance of each point of some chains to the nearest of the other chains.
fn distances(from: &[Vec<Point>], to: &[Vec<Point>]) -> Vec<f64> {
    let pieces = |chain: &Vec<Point>| match chain[..] {
        [one] => vec![piece(one, one)],
        _ => chain.windows(2).map(|p| piece(p[0], p[1])).collect(),
    };
    let pieces = RTree::bulk_load(to.iter().flat_map(pieces).collect());
    let near = |p: &Point| {
        let nearest = pieces.nearest_neighbor(&[p.x, p.y]);
        nearest.map_or(f64::INFINITY, |piece| piece.distance_2(&[p.x, p.y]).sqrt())
    };
    from.iter().flatten().map(near).collect()
}

fn piece(a: Point, b: Point) -> Line<[f64; 2]> {
    Line::new([a.x, a.y], [b.x, b.y])
}

/// The largest distance from a drawing's free ends to the nearest of the true ends, and the other way.
pub fn ends_apart(traced: &Drawing, ends: &[Point]) -> f64 {
    let traced: Vec<Point> = ends_of(traced);
    if traced.is_empty() || ends.is_empty() {
        return if traced.len() == ends.len() { 0.0 } else { f64::INFINITY };
    }
    let far = |from: &[Point], to: &[Point]| {
        let near = |p: &Point| to.iter().map(|q| p.distance(*q)).fold(f64::INFINITY, f64::min);
        from.iter().map(near).fold(0.0, f64::max)
    };
    far(&traced, ends).max(far(ends, &traced))
}

/// Both ends of every open line.
pub fn ends_of(drawing: &Drawing) -> Vec<Point> {
    let open = |c: &&Centreline| matches!(c, Centreline::Path { closed: false, .. });
    let lines = drawing.strokes.iter().map(|s| &s.centreline).filter(open);
    lines.flat_map(|c| [c.start(), c.end()]).collect()
}

/// Whether a line is made of straight pieces alone, and how many.
pub fn straight_pieces(centreline: &Centreline) -> Option<usize> {
    let Centreline::Path { segments, .. } = centreline else { return None };
    segments.iter().all(|s| matches!(s, Segment::Line(_))).then_some(segments.len())
}

/// The largest distance of a line from the straight line between its ends.
pub fn bow(centreline: &Centreline) -> f64 {
    let chord = kurbo::Line::new(centreline.start(), centreline.end());
    let mut path = BezPath::new();
    path.move_to(chord.p0);
    path.line_to(chord.p1);
    farthest(&[centreline.to_path()], &[path])
}
