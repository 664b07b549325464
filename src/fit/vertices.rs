//! Corners that meet other strokes meet them exactly.
//!
//! Each stroke is fitted by itself, so corners that were drawn at one point come out a fraction of a pixel apart, and a
//! corner that stands on a line a fraction off it. Whoever edits the drawing, and every program that asks what touches
//! what, needs the same point.

use super::Tolerance;
use super::joints::CORNER;
use super::stroke::{set_end, set_start};
use crate::drawing::{Centreline, Segment, Stroke};
use kurbo::{BezPath, ParamCurve, ParamCurveNearest, Point, Shape, Vec2};
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};

/// Corners move to corners by no more than this, in line widths, and onto lines by no more than that.
const REACH: f64 = 0.2;
const BESIDE: f64 = 0.15;
/// A corner on a line goes so many pixels through it: rounded, it still meets the line.
const HAIR: f64 = 0.02;

/// A corner of a stroke: the joint before one of its segments.
#[derive(Clone, Copy, Debug)]
struct Vertex {
    stroke: usize,
    joint: usize,
    point: Point,
    /// Where the corner points to.
    tip: Vec2,
    /// Whether a line that keeps to an axis ends here: it would no longer.
    firm: bool,
}

/// Moves corners onto corners of other strokes, or else onto their lines.
pub(super) fn meet(strokes: &mut [Stroke], tolerance: Tolerance) {
    let reach = REACH * tolerance.width;
    let vertices: Vec<Vertex> = strokes.iter().enumerate().flat_map(|(i, s)| corners(i, &s.centreline)).collect();
    if vertices.iter().all(|v| v.firm) {
        return;
    }
    let places = vertices.iter().enumerate().map(|(i, v)| GeomWithData::new([v.point.x, v.point.y], i));
    let corners = RTree::bulk_load(places.collect());
    let lines = Lines::new(strokes);
    let target = |v: &Vertex| {
        let near = corners.locate_within_distance([v.point.x, v.point.y], reach * reach).map(|c| &vertices[c.data]);
        let leader = near.filter(|o| o.stroke != v.stroke).min_by_key(|o| (!o.firm, o.stroke, o.joint));
        match leader {
            Some(o) if o.firm || o.stroke < v.stroke => Some(o.point),
            Some(_) => None,
            None => Some(lines.nearest(v, BESIDE * tolerance.width)? + v.tip * HAIR),
        }
    };
    let moves: Vec<(Vertex, Point)> =
        vertices.iter().filter(|v| !v.firm).filter_map(|v| Some((*v, target(v)?))).collect();
    for (vertex, point) in moves {
        let Centreline::Path { segments, .. } = &mut strokes[vertex.stroke].centreline else { continue };
        let n = segments.len();
        set_start(&mut segments[vertex.joint], point);
        set_end(&mut segments[(vertex.joint + n - 1) % n], point);
    }
}

fn corners(stroke: usize, centreline: &Centreline) -> Vec<Vertex> {
    let Centreline::Path { segments, closed } = centreline else { return Vec::new() };
    let first = if *closed && segments.len() > 1 { 0 } else { 1 };
    let corner = |joint: usize| {
        let (before, after) = (&segments[(joint + segments.len() - 1) % segments.len()], &segments[joint]);
        let (a, b) = (direction(before, 1.0), direction(after, 0.0));
        let point = after.start();
        let turns = a.cross(b).abs() > CORNER.sin() || a.dot(b) < 0.0;
        turns.then(|| Vertex {
            stroke,
            joint,
            point,
            tip: (a - b).normalize(),
            firm: keeps_to_axis(before) || keeps_to_axis(after),
        })
    };
    (first..segments.len()).filter_map(corner).collect()
}

/// Unit direction of a segment near its start (`t = 0`) or its end (`t = 1`).
fn direction(segment: &Segment, t: f64) -> Vec2 {
    const NEAR: f64 = 0.02;
    let (from, to) = if t < 0.5 { (0.0, NEAR) } else { (1.0 - NEAR, 1.0) };
    let d = segment.eval(to) - segment.eval(from);
    if d.hypot() > 1e-9 { d.normalize() } else { Vec2::ZERO }
}

fn keeps_to_axis(segment: &Segment) -> bool {
    matches!(segment, Segment::Line(l) if (l.p1.x - l.p0.x).abs().min((l.p1.y - l.p0.y).abs()) < 1e-6)
}

/// The box of a piece, the number of its stroke and its own in the stroke's path.
type Boxed = GeomWithData<Rectangle<[f64; 2]>, (usize, usize)>;

/// All pieces of all strokes, findable by place.
struct Lines {
    paths: Vec<BezPath>,
    tree: RTree<Boxed>,
}

impl Lines {
    fn new(strokes: &[Stroke]) -> Self {
        let paths: Vec<BezPath> = strokes.iter().map(|s| s.centreline.to_path()).collect();
        let boxes = paths.iter().enumerate().flat_map(|(i, path)| {
            path.segments().enumerate().map(move |(k, segment)| {
                let b = segment.bounding_box();
                GeomWithData::new(Rectangle::from_corners([b.x0, b.y0], [b.x1, b.y1]), (i, k + 1))
            })
        });
        let tree = RTree::bulk_load(boxes.collect());
        Self { paths, tree }
    }

    /// The nearest point of another stroke.
    fn nearest(&self, v: &Vertex, reach: f64) -> Option<Point> {
        let Point { x, y } = v.point;
        let around = AABB::from_corners([x - reach, y - reach], [x + reach, y + reach]);
        let near = self.tree.locate_in_envelope_intersecting(&around).map(|piece| piece.data);
        let of_others = near.filter(|(stroke, _)| *stroke != v.stroke);
        let found = of_others.filter_map(|(stroke, k)| {
            let segment = self.paths[stroke].get_seg(k)?;
            let nearest = segment.nearest(v.point, 1e-6);
            Some((nearest.distance_sq, stroke, k, segment.eval(nearest.t)))
        });
        let nearest = found.min_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))))?;
        (nearest.0 <= reach * reach).then_some(nearest.3)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    use kurbo::Line;

    const TOLERANCE: Tolerance = Tolerance { fit: 0.3, width: 4.0, steadiness: 0.1, pixel: 1.0 };

    fn chain(points: &[(f64, f64)]) -> Stroke {
        let lines = points.windows(2).map(|p| Segment::Line(Line::new(p[0], p[1])));
        let centreline = Centreline::Path { segments: lines.collect(), closed: false };
        Stroke::new(centreline, 4.0)
    }

    /// The only corner of a chain of two lines.
    fn corner(stroke: &Stroke) -> Point {
        let Centreline::Path { segments, .. } = &stroke.centreline else { panic!("no chain") };
        assert_eq!(segments[0].end(), segments[1].start());
        segments[1].start()
    }

    #[test]
    fn corners_of_two_strokes_are_one_point_and_lines_keep_to_their_axes() {
        for (dx, dy) in [(0.3, 0.2), (-0.5, 0.4), (0.0, 0.7), (2.0, 1.0)] {
            let upright = chain(&[(50.0, 10.0), (50.0, 50.0), (90.0, 50.0)]);
            let slanted = chain(&[(10.0, 20.0), (50.0 + dx, 50.0 + dy), (20.0, 90.0)]);
            for mut strokes in [vec![upright.clone(), slanted.clone()], vec![slanted.clone(), upright.clone()]] {
                let upright_at = strokes.iter().position(|s| *s == upright).unwrap();
                meet(&mut strokes, TOLERANCE);
                assert_eq!(strokes[upright_at], upright);
                let far = dx.hypot(dy) > REACH * TOLERANCE.width;
                assert_eq!(corner(&strokes[1 - upright_at]) == corner(&upright), !far, "{dx}, {dy}");
            }
        }
    }

    #[test]
    fn a_corner_beside_a_line_stands_on_it() {
        for aside in [-0.5, -0.1, 0.2, 0.5, 1.5] {
            let line = chain(&[(0.0, 50.0), (100.0, 60.0)]);
            let mut strokes = vec![chain(&[(20.0, 10.0), (50.0, 55.0 + aside), (80.0, 10.0)]), line.clone()];
            let before = strokes.clone();
            meet(&mut strokes, TOLERANCE);
            assert_eq!(strokes[1], line);
            let off = (corner(&strokes[0]) - Point::new(50.0, 55.0)).cross(Vec2::new(10.0, 1.0).normalize());
            let stands = f64::abs(aside) < BESIDE * TOLERANCE.width;
            assert!(
                if stands { (0.0..1.1 * HAIR).contains(&off.abs()) } else { strokes == before },
                "{off} from {aside}"
            );
        }
    }
}
