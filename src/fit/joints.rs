//! Where pieces meet, sharply or smoothly, and the segments between their joints.

use super::Tolerance;
use super::arc::{arc_from_tangent, end_tangent, fit_circle};
use super::cubic::{Ends, fit_cubic, tangents};
use super::fillet::{Fillet, fit_fillet};
use super::line::fit_line;
use super::samples::{Samples, WORST};
use super::segmentation::{Kind, Piece, near};
use crate::drawing::Segment;
use kurbo::{Line, Point, Rect, Shape, Vec2};

/// Pieces that meet at a larger angle than this (18 degrees) make a corner.
pub(super) const CORNER: f64 = 0.31;
/// A line this near to an axis (1.2 degrees) is put on it where that moves no point by more than the tolerance.
const AXIS: f64 = 0.021;
/// An arc's tangents may miss its neighbours' by this much (1.5 degrees) and still be called smooth.
const ARC_KINK: f64 = 0.026;

/// One cubic turns no further than this (about 100 degrees) of an arc that is not exact.
const QUARTER: f64 = 1.75;

/// How far to both sides of a joint of curves its course is looked at, in line widths.
const COURSE: f64 = 2.0;
/// How far a cubic may leave the box of its samples, in pixels; and how often its handles are shortened by a quarter.
const ASTRAY: f64 = 2.0;
const SHORTENED: usize = 30;
/// What a piece says about its ends before joints are placed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Draft {
    pub piece: Piece,
    start: Point,
    end: Point,
    pub start_tangent: Vec2,
    end_tangent: Vec2,
    /// For lines, a point on the line.
    on_line: Point,
    /// Standard deviation of its points about it.
    pub deviation: f64,
}

/// A joint between pieces, or an end of the section.
#[derive(Clone, Copy, Debug)]
pub(super) struct Joint {
    pub point: Point,
    /// The common tangent; `None` at a corner or a loose end.
    pub tangent: Option<Vec2>,
}

/// The joints of pieces in a row.
pub(super) fn placed(
    samples: &Samples,
    drafts: &[Draft],
    closed: bool,
    ends: [Option<Point>; 2],
    tolerance: Tolerance,
) -> Vec<Joint> {
    let n = drafts.len();
    let mut joints: Vec<Joint> = Vec::with_capacity(n + 1);
    for k in 0..=n {
        let joint = match (k, closed) {
            (0, false) => loose(&drafts[0], true, ends[0]),
            (k, false) if k == n => loose(&drafts[n - 1], false, ends[1]),
            (k, _) => meet(samples, &drafts[(k + n - 1) % n], &drafts[k % n], tolerance),
        };
        joints.push(joint);
    }
    for (k, draft) in drafts.iter().enumerate() {
        align_tangents(draft, k, closed, &mut joints);
    }
    round_corners(samples, drafts, closed, &mut joints);
    joints
}

pub(super) fn draft(samples: &Samples, piece: Piece, tolerance: Tolerance) -> Draft {
    let (from, to) = (piece.from, piece.to);
    let (start, end) = (near(samples, from), near(samples, to));
    let deviation = |error: f64| (error / samples.moments(from, to).w.max(1e-9)).sqrt();
    match piece.kind {
        Kind::Line => {
            let line = fit_line(samples, from, to);
            let d = on_axis(line.direction, (end - start).hypot(), tolerance);
            let foot = |p: Point| line.point + d * (p - line.point).dot(d);
            let (start, end) = (foot(start), foot(end));
            Draft {
                piece,
                start,
                end,
                start_tangent: d,
                end_tangent: d,
                on_line: line.point,
                deviation: deviation(line.error),
            }
        }
        Kind::Arc | Kind::Cubic => {
            let circle = if piece.kind == Kind::Arc { fit_circle(samples, from, to) } else { None };
            if let Some(circle) = circle {
                let turn = (start - circle.centre).cross(samples.points[(from + to) / 2] - circle.centre).signum();
                let tangent = |p: Point| circle.tangent(p) * turn;
                let (start, end) = (circle.foot(start), circle.foot(end));
                let (start_tangent, end_tangent) = (tangent(start), tangent(end));
                return Draft {
                    piece,
                    start,
                    end,
                    start_tangent,
                    end_tangent,
                    on_line: start,
                    deviation: deviation(circle.error),
                };
            }
            let ends = Ends { start, end, start_tangent: None, end_tangent: None };
            let fitted = fit_cubic(samples, from, to, &ends, 6);
            let (start_tangent, end_tangent) = tangents(&fitted.curve);
            Draft { piece, start, end, start_tangent, end_tangent, on_line: start, deviation: deviation(fitted.error) }
        }
    }
}

/// A direction moved onto the nearest axis when a line of this length hardly moves by it.
fn on_axis(d: Vec2, length: f64, tolerance: Tolerance) -> Vec2 {
    let off = d.x.abs().min(d.y.abs());
    if off > AXIS || off * length * 0.5 > (1.2 * tolerance.fit).max(0.3) {
        return d;
    }
    if d.x.abs() > d.y.abs() { Vec2::new(d.x.signum(), 0.0) } else { Vec2::new(0.0, d.y.signum()) }
}

fn loose(draft: &Draft, at_start: bool, fixed: Option<Point>) -> Joint {
    let own = if at_start { draft.start } else { draft.end };
    let Some(point) = fixed else { return Joint { point: own, tangent: None } };
    if draft.piece.kind == Kind::Line {
        // A line keeps its direction; the end slides along it.
        let d = draft.start_tangent;
        return Joint { point: draft.on_line + d * (point - draft.on_line).dot(d), tangent: None };
    }
    Joint { point, tangent: None }
}

fn meet(samples: &Samples, a: &Draft, b: &Draft, tolerance: Tolerance) -> Joint {
    let turn = a.end_tangent.cross(b.start_tangent).atan2(a.end_tangent.dot(b.start_tangent));
    let middle = a.end.midpoint(b.start);
    let (line_a, line_b) = (a.piece.kind == Kind::Line, b.piece.kind == Kind::Line);
    if turn.abs() > CORNER || (line_a && line_b) {
        return Joint { point: corner(a, b, middle, tolerance), tangent: None };
    }
    let foot = |d: &Draft, tangent: Vec2| d.on_line + tangent * (middle - d.on_line).dot(tangent);
    match (line_a, line_b) {
        (true, _) => Joint { point: foot(a, a.end_tangent), tangent: Some(a.end_tangent) },
        (_, true) => Joint { point: foot(b, b.start_tangent), tangent: Some(b.start_tangent) },
        _ if let Some((point, tangent)) = course(samples, a, b, tolerance) => Joint { point, tangent: Some(tangent) },
        _ => {
            let length = |d: &Draft| ((d.piece.to - d.piece.from) as f64).sqrt();
            let sum = a.end_tangent * length(a) + b.start_tangent * length(b);
            Joint { point: middle, tangent: Some(sum.normalize()) }
        }
    }
}

/// Where a smooth line goes at the joint of two curves. The points around it know more of its direction there than the
/// ends of two curves do.
fn course(samples: &Samples, a: &Draft, b: &Draft, tolerance: Tolerance) -> Option<(Point, Vec2)> {
    let at = samples.arc[a.piece.to];
    let reach = (COURSE * tolerance.width).min(at - samples.arc[a.piece.from]).min(samples.arc[b.piece.to] - at);
    if a.piece.to == b.piece.from { samples.course(a.piece.to, reach) } else { None }
}

/// Where two pieces meet at an angle: the crossing of their tangents, if it is near.
fn corner(a: &Draft, b: &Draft, middle: Point, tolerance: Tolerance) -> Point {
    let det = a.end_tangent.cross(b.start_tangent);
    if det.abs() < 0.02 {
        return middle;
    }
    let t = (b.start - a.end).cross(b.start_tangent) / det;
    let crossing = a.end + a.end_tangent * t;
    if (crossing - middle).hypot() < 1.5 * tolerance.width { crossing } else { middle }
}

/// A line's final direction is that between its joints: smooth joints take it over.
fn align_tangents(draft: &Draft, k: usize, closed: bool, joints: &mut [Joint]) {
    if draft.piece.kind != Kind::Line {
        return;
    }
    let d = joints[k + 1].point - joints[k].point;
    if d.hypot() < 1e-6 {
        return;
    }
    let d = d.normalize();
    for j in [k, k + 1] {
        change(joints, j, closed, |joint| joint.tangent = joint.tangent.map(|_| d));
    }
}

/// Changes a joint; the first and the last of a closed section are one.
pub(super) fn change(joints: &mut [Joint], k: usize, closed: bool, f: impl Fn(&mut Joint)) {
    let n = joints.len() - 1;
    f(&mut joints[k]);
    if closed && (k == 0 || k == n) {
        f(&mut joints[n - k]);
    }
}

/// Lets every arc between two lines, smooth at both ends, start and end where it touches them.
fn round_corners(samples: &Samples, drafts: &[Draft], closed: bool, joints: &mut [Joint]) {
    let n = drafts.len();
    for k in (0..n).filter(|&k| drafts[k].piece.kind == Kind::Arc && (closed || (k > 0 && k + 1 < n))) {
        let (before, after) = ((k + n - 1) % n, (k + 1) % n);
        let are_lines = [before, after].iter().all(|&j| drafts[j].piece.kind == Kind::Line);
        let (Some(d), Some(e)) = (joints[k].tangent, joints[k + 1].tangent) else { continue };
        if !are_lines {
            continue;
        }
        let lines = [(drafts[before].on_line, d), (drafts[after].on_line, e)];
        let Some(Fillet { start, end, .. }) = fit_fillet(samples, lines, drafts[k].piece.from, drafts[k].piece.to)
        else {
            continue;
        };
        // Each line keeps some of itself.
        let leaves = |from: Point, to: Point, d: Vec2| (to - from).dot(d) > 0.0;
        if leaves(joints[before].point, start, d) && leaves(end, joints[after + 1].point, e) {
            change(joints, k, closed, |joint| joint.point = start);
            change(joints, k + 1, closed, |joint| joint.point = end);
        }
    }
}

/// The segments of one piece between its joints: one, or several where a cubic cannot turn so far.
pub(super) fn segments(
    samples: &Samples,
    draft: &Draft,
    from: Joint,
    to: Joint,
    tolerance: Tolerance,
    deviation: f64,
) -> Vec<Segment> {
    let piece = draft.piece;
    if piece.kind == Kind::Line {
        return vec![Segment::Line(Line::new(from.point, to.point))];
    }
    let circle = if piece.kind == Kind::Arc { fit_circle(samples, piece.from, piece.to) } else { None };
    let Some(circle) = circle else { return vec![cubic(samples, piece, from, to)] };
    if let Some(arc) = smooth_arc(samples, draft, from, to, tolerance, deviation) {
        return vec![arc];
    }
    let length = samples.arc[piece.to] - samples.arc[piece.from];
    let count = (length / circle.radius / QUARTER).ceil().max(1.0) as usize;
    let turn = draft.start_tangent.cross(circle.centre - draft.start).signum();
    let mut bounds = vec![(piece.from, from)];
    for k in 1..count {
        let at = samples.arc[piece.from] + length * k as f64 / count as f64;
        let index = samples.arc.partition_point(|&a| a < at);
        let p = samples.points[index];
        bounds.push((index, Joint { point: circle.foot(p), tangent: Some(circle.tangent(p) * turn) }));
    }
    bounds.push((piece.to, to));
    let pairs = bounds.windows(2);
    pairs.map(|b| cubic(samples, Piece { from: b[0].0, to: b[1].0, ..piece }, b[0].1, b[1].1)).collect()
}

/// The cubic of one piece between its joints. Where points are no line at all, as in a tangle, least squares may want
/// handles that lead far away: they are shortened until the curve stays where its samples are.
fn cubic(samples: &Samples, piece: Piece, from: Joint, to: Joint) -> Segment {
    let ends = Ends { start: from.point, end: to.point, start_tangent: from.tangent, end_tangent: to.tangent };
    let mut curve = fit_cubic(samples, piece.from, piece.to, &ends, 8).curve;
    let points = samples.points[piece.from..=piece.to].iter();
    let spread = points.fold(Rect::from_points(curve.p0, curve.p3), |spread, &p| spread.union_pt(p));
    let room = spread.inflate(ASTRAY, ASTRAY);
    // Without handles it is the chord, but for rounding.
    for _ in 0..SHORTENED {
        if room.contains_rect(curve.bounding_box()) {
            break;
        }
        (curve.p1, curve.p2) = (curve.p0.lerp(curve.p1, 0.75), curve.p3.lerp(curve.p2, 0.75));
    }
    Segment::Cubic(curve)
}

/// The arc between two joints, if it keeps to their tangents and to the samples.
fn smooth_arc(
    samples: &Samples,
    draft: &Draft,
    from: Joint,
    to: Joint,
    tolerance: Tolerance,
    deviation: f64,
) -> Option<Segment> {
    // The chord turns half of the arc's angle away from each tangent: the mean of what both ends ask for.
    let chord = to.point - from.point;
    // All the way around there is none.
    let chord = (chord.hypot() > 0.0).then(|| chord.normalize())?;
    let half = |tangent: Vec2, sign: f64| sign * tangent.cross(chord).atan2(tangent.dot(chord));
    let at_start = half(from.tangent.unwrap_or(draft.start_tangent), 1.0);
    let at_end = half(to.tangent.unwrap_or(draft.end_tangent), -1.0);
    let angle = match (from.tangent, to.tangent) {
        (Some(_), None) => at_start,
        (None, Some(_)) => at_end,
        _ => 0.5 * (at_start + at_end),
    };
    let tangent = Vec2::from_angle(chord.atan2() - angle);
    let arc = arc_from_tangent(from.point, tangent, to.point)?;
    let kink = |a: Vec2, b: Option<Vec2>| b.is_some_and(|b| a.cross(b).abs() > ARC_KINK || a.dot(b) < 0.0);
    if kink(tangent, from.tangent) || kink(end_tangent(&arc), to.tangent) {
        return None;
    }
    let run = draft.piece.from..=draft.piece.to;
    let off = |k: usize| ((samples.points[k] - arc.center).hypot() - arc.radii.x).abs() * samples.weights[k];
    let worst = run.map(off).fold(0.0, f64::max);
    (worst < (2.0 * tolerance.fit).max(WORST * deviation.max(draft.deviation))).then_some(Segment::Arc(arc))
}
