//! Curves in the pieces that a format or a machine knows.

use super::Curves;
use crate::drawing::{Centreline, Drawing, Segment};
use kurbo::{Arc, BezPath, CubicBez, Line, ParamCurve, ParamCurveNearest, PathEl, Point, Vec2};
use std::f64::consts::TAU;

/// A cubic is parted at most so many times in two.
const DEEPEST: u32 = 10;
/// What is asked of flattening, which is up to half as much again off where a curve turns the other way.
const STRICT: f64 = 0.65;
/// So many places of a cubic are compared with its arcs, and of each arc with the cubic.
const PLACES: usize = 8;
/// Accuracy of that, as a share of the tolerance.
const NEAREST: f64 = 1e-2;

/// A drawing whose strokes are made of some kinds of pieces alone, none further than `tolerance` from the curve that it stands
/// for. Circles stay circles, except where lines alone are wanted.
pub(super) fn with_curves(drawing: &Drawing, curves: Curves, tolerance: f64) -> Drawing {
    let mut drawing = drawing.clone();
    for stroke in &mut drawing.strokes {
        stroke.centreline = match (curves, &stroke.centreline) {
            (Curves::Arcs, Centreline::Path { segments, closed }) => {
                let segments = segments.iter().flat_map(|s| in_arcs(s, tolerance)).collect();
                Centreline::Path { segments, closed: *closed }
            }
            (Curves::Lines, Centreline::Path { closed, .. }) => {
                in_lines(&stroke.centreline.to_path(), *closed, tolerance)
            }
            (Curves::Lines, Centreline::Circle(_)) => in_lines(&stroke.centreline.to_path(), true, tolerance),
            (_, other) => other.clone(),
        };
    }
    if curves == Curves::Lines {
        for fill in &mut drawing.fills {
            let mut flat = BezPath::new();
            kurbo::flatten(&fill.outline, STRICT * tolerance, |el| flat.push(el));
            fill.outline = flat;
        }
    }
    drawing
}

/// The corners of a chain of lines along a path.
pub(super) fn polyline(path: &BezPath, tolerance: f64) -> Vec<Point> {
    let mut points: Vec<Point> = Vec::new();
    kurbo::flatten(path, STRICT * tolerance, |el| match el {
        PathEl::MoveTo(p) | PathEl::LineTo(p) => points.push(p),
        PathEl::ClosePath => points.extend(points.first().copied()),
        PathEl::QuadTo(..) | PathEl::CurveTo(..) => {}
    });
    points.dedup();
    points
}

/// The corners of the closed outlines of a region.
pub(super) fn rings(outline: &BezPath, tolerance: f64) -> Vec<Vec<Point>> {
    let mut rings = Vec::new();
    let mut one = BezPath::new();
    for &el in outline.elements().iter().chain(&[PathEl::MoveTo(Point::ZERO)]) {
        if matches!(el, PathEl::MoveTo(_)) && !one.elements().is_empty() {
            let mut ring = polyline(&std::mem::take(&mut one), tolerance.max(1e-6));
            if ring.len() > 1 && ring.first() == ring.last() {
                ring.pop();
            }
            rings.extend((ring.len() > 2).then_some(ring));
        }
        one.push(el);
    }
    rings
}

fn in_lines(path: &BezPath, closed: bool, tolerance: f64) -> Centreline {
    let points = polyline(path, tolerance);
    let segments: Vec<Segment> = points.windows(2).map(|w| Segment::Line(Line::new(w[0], w[1]))).collect();
    match points.first() {
        Some(&p) if segments.is_empty() => Centreline::Dot(p),
        _ => Centreline::Path { segments, closed },
    }
}

fn in_arcs(segment: &Segment, tolerance: f64) -> Vec<Segment> {
    match segment {
        Segment::Line(_) | Segment::Arc(_) => vec![*segment],
        Segment::Cubic(cubic) => {
            let mut pieces = Vec::new();
            part(*cubic, tolerance, DEEPEST, &mut pieces);
            pieces
        }
    }
}

/// Puts the arcs of a cubic in place: two that share its ends and the tangents there, where they are near enough, or those of
/// its halves.
fn part(cubic: CubicBez, tolerance: f64, depth: u32, pieces: &mut Vec<Segment>) {
    match biarc(cubic) {
        Some(pair) if is_near(&cubic, &pair, tolerance) => {
            pieces.extend(pair.into_iter().filter(|s| s.start() != s.end()))
        }
        _ if depth == 0 => pieces.push(Segment::Line(Line::new(cubic.p0, cubic.p3))),
        _ => {
            let (a, b) = cubic.subdivide();
            part(a, tolerance, depth - 1, pieces);
            part(b, tolerance, depth - 1, pieces);
        }
    }
}

/// Whether a cubic and its arcs go the same way to within a tolerance. Each may leave the other where that one turns back.
fn is_near(cubic: &CubicBez, pair: &[Segment; 2], tolerance: f64) -> bool {
    let mut places = (1..PLACES).map(|k| k as f64 / PLACES as f64);
    let to_pair = |p: Point| pair.iter().map(|s| distance(s, p)).fold(f64::INFINITY, f64::min);
    let to_cubic = |p: Point| cubic.nearest(p, NEAREST * tolerance).distance_sq.sqrt();
    places.clone().all(|t| to_pair(cubic.eval(t)) <= tolerance)
        && places.all(|t| pair.iter().all(|s| to_cubic(s.eval(t)) <= tolerance))
}

/// Unit tangents at the ends of a cubic; a handle of no length leaves it to the next.
fn tangents(c: &CubicBez) -> Option<(Vec2, Vec2)> {
    let first = |ways: [Vec2; 3]| ways.into_iter().find(|way| way.hypot() > 1e-9).map(|way| way.normalize());
    let start = first([c.p1 - c.p0, c.p2 - c.p0, c.p3 - c.p0])?;
    let end = first([c.p3 - c.p2, c.p3 - c.p1, c.p3 - c.p0])?;
    Some((start, end))
}

/// Two arcs that join smoothly, from one end of a cubic to the other (Bolton, *Biarc curves*, 1975), with legs of the same
/// length. `None` where there are none.
fn biarc(c: CubicBez) -> Option<[Segment; 2]> {
    let (start, end) = tangents(&c)?;
    let (chord, sum) = (c.p3 - c.p0, start + end);
    let turn = 2.0 * (1.0 - start.dot(end));
    let along = chord.dot(sum);
    let leg = if turn > 1e-9 {
        (-along + (along * along + turn * chord.hypot2()).sqrt()) / turn
    } else if chord.dot(end) > 1e-9 {
        chord.hypot2() / (4.0 * chord.dot(end))
    } else {
        return None;
    };
    let joint = c.p0.midpoint(c.p3) + (start - end) * (0.5 * leg);
    let backwards = arc(c.p3, -end, joint);
    let second = match backwards {
        Segment::Arc(a) => Segment::Arc(a.reversed()),
        _ => Segment::Line(Line::new(joint, c.p3)),
    };
    Some([arc(c.p0, start, joint), second])
}

/// The arc from a point in a direction to another point; a line where it does not turn.
fn arc(from: Point, direction: Vec2, to: Point) -> Segment {
    let chord = to - from;
    let aside = direction.cross(chord);
    if aside.abs() <= 1e-6 * chord.hypot2() {
        return Segment::Line(Line::new(from, to));
    }
    let radius = 0.5 * chord.hypot2() / aside;
    let centre = from + direction.turn_90() * radius;
    let (start, end) = ((from - centre).atan2(), (to - centre).atan2());
    let sweep = if radius > 0.0 { (end - start).rem_euclid(TAU) } else { -(start - end).rem_euclid(TAU) };
    Segment::Arc(Arc::new(centre, (radius.abs(), radius.abs()), start, sweep, 0.0))
}

/// How far a point is from a piece, or from the rest of its circle or line.
fn distance(segment: &Segment, p: Point) -> f64 {
    match segment {
        Segment::Line(l) => {
            let way = l.p1 - l.p0;
            let share = ((p - l.p0).dot(way) / way.hypot2().max(1e-18)).clamp(0.0, 1.0);
            p.distance(l.eval(share))
        }
        Segment::Arc(a) => (p.distance(a.center) - a.radii.x).abs(),
        Segment::Cubic(_) => f64::INFINITY,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::Stroke;
    use kurbo::BezPath;
    use proptest::prelude::*;

    fn traced(cubic: CubicBez) -> Drawing {
        let mut drawing = Drawing::new(100.0, 100.0);
        let centreline = Centreline::Path { segments: vec![Segment::Cubic(cubic)], closed: false };
        drawing.strokes.push(Stroke::new(centreline, 1.0));
        drawing
    }

    /// Arcs and lines stay near the curve, keep its ends and join.
    #[track_caller]
    fn assert_follows(p: [f64; 8], tolerance: f64) {
        let cubic = CubicBez::new((p[0], p[1]), (p[2], p[3]), (p[4], p[5]), (p[6], p[7]));
        for curves in [Curves::Arcs, Curves::Lines] {
            let drawing = with_curves(&traced(cubic), curves, tolerance);
            let Centreline::Path { segments, .. } = &drawing.strokes[0].centreline else { panic!() };
            assert!(segments.iter().all(|s| !matches!(s, Segment::Cubic(_))));
            assert!(segments[0].start().distance(cubic.p0) < 1e-6);
            assert!(segments[segments.len() - 1].end().distance(cubic.p3) < 1e-6);
            for pair in segments.windows(2) {
                assert!(pair[0].end().distance(pair[1].start()) < 1e-6);
            }
            for piece in segments {
                for k in 0..=24 {
                    let away = cubic.nearest(piece.eval(f64::from(k) / 24.0), 1e-6).distance_sq.sqrt();
                    assert!(away < 1.3 * tolerance + 1e-3, "{away} from the curve, asked {tolerance}");
                }
            }
        }
    }

    proptest! {
        #[test]
        fn pieces_follow_the_curve(p in proptest::array::uniform8(0.0..100.0f64), tolerance in 0.02..1.0f64) {
            assert_follows(p, tolerance);
        }
    }

    /// A curve that turns back beside itself: its places were near the arcs, but not the arcs near it.
    #[test]
    fn arcs_follow_a_curve_that_turns_back() {
        let p = [56.237, 83.779, 95.137, 63.811, 95.404, 59.685, 49.475, 99.817];
        assert_follows(p, 0.42);
    }

    #[test]
    fn a_quarter_circle_is_one_or_two_arcs() {
        let arc = Arc::new((50.0, 50.0), (30.0, 30.0), 0.3, 1.5, 0.0);
        let mut path = BezPath::new();
        path.move_to((0.0, 0.0));
        arc.to_cubic_beziers(1e-6, |a, b, c| path.curve_to(a, b, c));
        let start = arc.center + 30.0 * Vec2::from_angle(0.3);
        let PathEl::CurveTo(a, b, c) = path.elements()[1] else { panic!() };
        let drawing = with_curves(&traced(CubicBez::new(start, a, b, c)), Curves::Arcs, 0.01);
        let Centreline::Path { segments, .. } = &drawing.strokes[0].centreline else { panic!() };
        assert!(segments.len() <= 2);
        for segment in segments {
            let Segment::Arc(found) = segment else { panic!("not an arc") };
            assert!(found.center.distance(arc.center) < 0.1 && (found.radii.x - 30.0).abs() < 0.1);
        }
    }
}
