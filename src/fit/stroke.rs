//! One trail as one stroke.

use super::Tolerance;
use super::arc::fit_circle;
use super::chain::join;
use super::rectangle;
use super::samples::Samples;
use super::segmentation::{Kind, segment};
use crate::drawing::{Centreline, Segment};
use crate::graph::TrailPoint;
use kurbo::{Circle, Line, Point, Vec2};

/// A flagged corner that turns by less than this (22 degrees) is no corner.
const LEAST_TURN: f64 = 0.38;

/// Lines that end at a corner are led to where they cross, up to a line width from its node; where they run together in a
/// spike, up to this share of a line width over the sine of half their angle.
const SPIKE: f64 = 0.12;

/// Lines cross clearly where the sine of their angle is more than this (9 degrees).
const LEAST_SINE: f64 = 0.15;

/// A line that passes a corner's node by more than this, in line widths, is not bent to end there.
const ASIDE: f64 = 0.75;

/// The centreline of a trail; `None` when it has no extent.
pub(super) fn fit_trail(walk: &[TrailPoint], closed: bool, tolerance: Tolerance) -> Option<Centreline> {
    let mut walk: Vec<TrailPoint> = walk.to_vec();
    walk.dedup_by(|b, a| {
        let same = (a.point - b.point).hypot() < 1e-6;
        a.corner |= same && b.corner;
        same
    });
    if closed && walk.len() > 2 && (walk[0].point - walk[walk.len() - 1].point).hypot() < 1e-6 {
        let last = walk.pop()?;
        walk[0].corner |= last.corner;
    }
    if walk.len() < 2 {
        return None;
    }
    let corners = corners(&walk, closed, tolerance);
    if !closed {
        return Some(Centreline::Path { segments: open(&walk, &corners, tolerance), closed: false });
    }
    let Some(&first) = corners.first() else { return Some(smooth_loop(&walk, tolerance)) };
    // A loop with corners is an open line from its first corner back to it.
    let n = walk.len();
    let mut line: Vec<TrailPoint> = walk[first..].to_vec();
    line.extend_from_slice(&walk[..=first]);
    let corners: Vec<usize> = corners.iter().map(|c| c - first).filter(|&c| c > 0 && c < n).collect();
    let mut segments = open(&line, &corners, tolerance);
    close_corner(&mut segments, tolerance);
    Some(Centreline::Path { segments, closed: true })
}

/// Indices of flagged points at which the line really turns.
fn corners(walk: &[TrailPoint], closed: bool, tolerance: Tolerance) -> Vec<usize> {
    let n = walk.len();
    let is_inner = |k: usize| closed || (k > 0 && k + 1 < n);
    let turns = |k: usize| {
        let before = direction(walk, k, closed, -1, tolerance);
        let after = direction(walk, k, closed, 1, tolerance);
        before.zip(after).is_some_and(|(b, a)| (-b).cross(a).atan2((-b).dot(a)).abs() > LEAST_TURN)
    };
    (0..n).filter(|&k| walk[k].corner && is_inner(k) && turns(k)).collect()
}

/// Direction from a point along the walk, over a couple of line widths.
fn direction(walk: &[TrailPoint], k: usize, closed: bool, step: i64, tolerance: Tolerance) -> Option<Vec2> {
    let n = walk.len() as i64;
    let reach = 2.5 * tolerance.width;
    let mut last = k as i64;
    for i in 1..n {
        let index = k as i64 + i * step;
        let index = if closed { index.rem_euclid(n) } else { index };
        if index < 0 || index >= n {
            break;
        }
        last = index;
        if (walk[last as usize].point - walk[k].point).hypot() > reach {
            break;
        }
    }
    let d = walk[last as usize].point - walk[k].point;
    (d.hypot() > 1e-9).then(|| d.normalize())
}

/// An open line, section by section between corners.
fn open(walk: &[TrailPoint], corners: &[usize], tolerance: Tolerance) -> Vec<Segment> {
    let mut bounds = vec![0];
    bounds.extend_from_slice(corners);
    bounds.push(walk.len() - 1);
    let sections = bounds.windows(2).map(|b| section(&walk[b[0]..=b[1]], tolerance));
    let mut out: Vec<Segment> = Vec::new();
    for (mut next, &bound) in sections.zip(&bounds) {
        if let (Some(a), Some(b)) = (out.last_mut(), next.first_mut()) {
            let between = sharpen(a, b, walk[bound].point, tolerance);
            out.extend(between);
        }
        out.append(&mut next);
    }
    out
}

/// The segments of one section; its ends are kept.
fn section(walk: &[TrailPoint], tolerance: Tolerance) -> Vec<Segment> {
    let (first, last) = (walk[0].point, walk[walk.len() - 1].point);
    let samples = Samples::from_trail(walk);
    if samples.len() < 4 || samples.length() < tolerance.width {
        return vec![Segment::Line(Line::new(first, last))];
    }
    let pieces = segment(&samples, tolerance);
    join(&samples, &pieces, false, [Some(first), Some(last)], tolerance)
}

/// Lets two segments end at one corner: where their lines cross if both are lines, else at the node. Lines of
/// which one passes far from the node keep their courses, and what leads from one to the other is returned.
fn sharpen(a: &mut Segment, b: &mut Segment, node: Point, tolerance: Tolerance) -> Option<Segment> {
    let mut point = node;
    if let (Segment::Line(l), Segment::Line(m)) = (&*a, &*b) {
        if let Some(crossing) = crossing(*l, *m, node, tolerance) {
            point = crossing;
        } else if (l.p1 - node).hypot().max((m.p0 - node).hypot()) > ASIDE * tolerance.width {
            return Some(Segment::Line(Line::new(l.p1, m.p0)));
        }
    } else if let Segment::Line(l) = &*a {
        point = l.p1;
    } else if let Segment::Line(m) = &*b {
        point = m.p0;
    }
    set_end(a, point);
    set_start(b, point);
    None
}

/// Where two lines cross, if they do so clearly and near the node at which they end.
fn crossing(l: Line, m: Line, node: Point, tolerance: Tolerance) -> Option<Point> {
    let (d, e) = (l.p1 - l.p0, m.p1 - m.p0);
    let (det, product) = (d.cross(e), d.hypot() * e.hypot());
    let crossing = l.p0 + d * ((m.p0 - l.p0).cross(e) / det);
    let sine_of_half = (0.5 + 0.5 * d.dot(e) / product).max(0.0).sqrt();
    let reach = (SPIKE / sine_of_half).max(1.0) * tolerance.width;
    (det.abs() > LEAST_SINE * product && (crossing - node).hypot() < reach).then_some(crossing)
}

fn close_corner(segments: &mut Vec<Segment>, tolerance: Tolerance) {
    if let [first, .., last] = segments.as_mut_slice() {
        let node = first.start().midpoint(last.end());
        let between = sharpen(last, first, node, tolerance);
        segments.extend(between);
    }
}

/// Moves the end of a segment by a small amount.
pub(super) fn set_end(segment: &mut Segment, point: Point) {
    match segment {
        Segment::Line(l) => l.p1 = point,
        Segment::Cubic(c) => {
            c.p2 += point - c.p3;
            c.p3 = point;
        }
        Segment::Arc(_) => *segment = bent_arc(segment, segment.start(), point),
    }
}

/// Moves the start of a segment by a small amount.
pub(super) fn set_start(segment: &mut Segment, point: Point) {
    match segment {
        Segment::Line(l) => l.p0 = point,
        Segment::Cubic(c) => {
            c.p1 += point - c.p0;
            c.p0 = point;
        }
        Segment::Arc(_) => *segment = bent_arc(segment, point, segment.end()),
    }
}

/// The arc of the same turn between two other points.
fn bent_arc(segment: &Segment, start: Point, end: Point) -> Segment {
    let Segment::Arc(arc) = segment else { return *segment };
    let chord = end - start;
    let tangent = Vec2::from_angle(chord.atan2() - 0.5 * arc.sweep_angle);
    match super::arc::arc_from_tangent(start, tangent, end) {
        Some(arc) => Segment::Arc(arc),
        None => Segment::Line(Line::new(start, end)),
    }
}

/// A closed line without corners: a circle or a rectangle with round corners if it is one, else a chain that closes smoothly.
fn smooth_loop(walk: &[TrailPoint], tolerance: Tolerance) -> Centreline {
    let around = |from: usize| {
        let mut line: Vec<TrailPoint> = walk[from..].to_vec();
        line.extend_from_slice(&walk[..=from]);
        Samples::from_trail(&line)
    };
    let samples = around(0);
    if let Some(circle) = circle(&samples, tolerance) {
        return Centreline::Circle(circle);
    }
    if let Some(rectangle) = rectangle::round(&samples, tolerance) {
        return rectangle;
    }
    // A first pass finds a joint to start from, before a line if there is one: a cut through the middle of a piece
    // would split it.
    let pieces = segment(&samples, tolerance);
    let after = pieces.iter().skip(1).max_by_key(|p| (p.kind == Kind::Line, p.to - p.from));
    let start = after.map_or(0, |p| p.from);
    let samples = around(start.min(walk.len() - 1));
    let pieces = segment(&samples, tolerance);
    let segments = join(&samples, &pieces, true, [None, None], tolerance);
    Centreline::Path { segments, closed: true }
}

/// The circle through all samples, if none leaves it by more than the tolerance allows.
fn circle(samples: &Samples, tolerance: Tolerance) -> Option<Circle> {
    let circle = fit_circle(samples, 0, samples.len() - 1)?;
    // Points that are all around it are a diameter apart.
    let across = samples.points.iter().map(|p| (*p - samples.points[0]).hypot()).fold(0.0, f64::max);
    if across < circle.radius {
        return None;
    }
    let deviation = (circle.error / samples.len() as f64).sqrt();
    let off = samples.points.iter().zip(&samples.weights);
    let worst = off.map(|(p, w)| ((*p - circle.centre).hypot() - circle.radius).abs() * w).fold(0.0, f64::max);
    let limit = tolerance.fit.max(1.5 * samples.scatter(tolerance.width));
    (deviation < limit && worst < 3.0 * limit).then(|| Circle::new(circle.centre, circle.radius))
}

#[cfg(test)]
mod tests {
    use super::*;
    use kurbo::ParamCurveNearest;

    #[test]
    fn a_node_beside_two_lines_bends_neither() {
        for aside in [3.0, 5.0, 8.0] {
            let point =
                |x: f64, y: f64, corner: bool| TrailPoint { point: Point::new(x, y), width: 3.0, noise: 0.0, corner };
            let mut walk: Vec<TrailPoint> = (0..80).map(|k| point(0.5 * f64::from(k), 0.0, false)).collect();
            walk.push(point(42.0, aside, true));
            walk.extend((0..100).map(|k| point(52.0, 10.0 + 0.5 * f64::from(k), false)));
            let tolerance = Tolerance { fit: 0.3, width: 3.0, steadiness: 0.15, pixel: 1.0 };
            let Some(Centreline::Path { segments, .. }) = fit_trail(&walk, false, tolerance) else { panic!("no line") };
            // Beside the node itself anything goes.
            for p in walk.iter().map(|p| p.point).filter(|p| p.x < 36.0 || p.y > 16.0) {
                let nearest = segments.iter().map(|s| match s {
                    Segment::Line(l) => l.nearest(p, 1e-6).distance_sq.sqrt(),
                    _ => f64::MAX,
                });
                let off = nearest.fold(f64::MAX, f64::min);
                assert!(off < 0.3, "{p:?} is {off} off with the node {aside} aside");
            }
        }
    }
}
