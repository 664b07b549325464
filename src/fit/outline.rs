//! Strokes as filled outlines that keep their taper.
//!
//! The width along a stroke is the measured one, interpolated where it cannot be measured and smoothed; both edges
//! lie half of it beside the centreline and are fitted like any line. Ends are round. A stroke is one outline for each
//! smooth section: at corners, and where it crosses itself, sections overlap with round ends.

use super::Tolerance;
use super::chain::join;
use super::profile::Profile;
use super::samples::Samples;
use super::segmentation::segment;
use crate::drawing::{Centreline, Fill, Segment, Stroke};
use kurbo::{Arc, BezPath, ParamCurve, ParamCurveArclen, ParamCurveDeriv, PathSeg, Point, Vec2};
use std::f64::consts::PI;

/// Distance between samples of the centreline, in pixels.
const SPACING: f64 = 0.5;
/// A turn of more than this between pieces (15 degrees) is a corner.
const CORNER: f64 = 0.26;
/// Widths are averaged over this many line widths to both sides, twice.
const SMOOTHING: f64 = 1.0;
/// No outline is thinner than this, in pixels.
const THINNEST: f64 = 0.3;
/// Accuracy of the round ends, in pixels.
const ROUND: f64 = 0.01;

/// A place on a centreline with its direction and the width there.
#[derive(Clone, Copy)]
struct Station {
    point: Point,
    tangent: Vec2,
    width: f64,
}

impl Station {
    /// The edge beside the place: `side` is 1 along the normal and -1 against it.
    fn edge(&self, side: f64) -> Point {
        self.point + self.tangent.turn_90() * (0.5 * side * self.width)
    }
}

/// The outlines of a stroke. `breaks` are shares of its length at which it is to be parted.
pub(super) fn outline(stroke: &Stroke, profile: &Profile, breaks: &[f64], tolerance: Tolerance) -> Vec<Fill> {
    let fill = |outline| Fill { outline, color: stroke.color };
    let sections = sections(&stroke.centreline, profile, breaks, tolerance.width);
    let whole = stroke.centreline.is_closed() && sections.len() == 1 && is_smooth_loop(&sections[0]);
    let outlines = sections.iter().map(|s| if whole { ring(s, tolerance) } else { band(s, tolerance) });
    outlines.map(fill).collect()
}

/// The smooth sections of a centreline, sampled, with smoothed widths.
fn sections(centreline: &Centreline, profile: &Profile, breaks: &[f64], line_width: f64) -> Vec<Vec<Station>> {
    let path = centreline.to_path();
    let pieces: Vec<PathSeg> = path.segments().filter(|s| s.arclen(1e-3) > 1e-6).collect();
    let total: f64 = pieces.iter().map(|s| s.arclen(1e-3)).sum();
    let mut sections: Vec<Vec<Station>> = Vec::new();
    let mut walked = 0.0;
    for piece in &pieces {
        let length = piece.arclen(1e-3);
        let count = (length / SPACING).ceil().max(1.0) as usize;
        for k in 0..=count {
            let t = k as f64 / count as f64;
            let share = (walked + t * length) / total;
            let Some(tangent) = tangent(piece, t) else { continue };
            let station = Station { point: piece.eval(t), tangent, width: profile.width(share).max(THINNEST) };
            let parted =
                breaks.iter().any(|b| *b > share - 0.5 * SPACING / total && *b <= share + 0.5 * SPACING / total);
            match sections.last_mut() {
                Some(section) if section.last().is_none_or(|s| s.tangent.dot(tangent) > CORNER.cos()) => {
                    section.push(station);
                    if parted && k > 0 {
                        sections.push(vec![station]);
                    }
                }
                _ => sections.push(vec![station]),
            }
        }
        walked += length;
    }
    let reach = ((SMOOTHING * line_width / SPACING) as usize).max(1);
    sections.retain(|section| section.len() > 1);
    for section in &mut sections {
        smooth(section, reach);
        smooth(section, reach);
    }
    sections
}

/// The unit tangent of a piece of a path; `None` where its derivative vanishes.
pub(super) fn tangent(piece: &PathSeg, t: f64) -> Option<Vec2> {
    let derivative = match piece {
        PathSeg::Line(l) => l.p1 - l.p0,
        PathSeg::Quad(q) => q.deriv().eval(t).to_vec2(),
        PathSeg::Cubic(c) => c.deriv().eval(t).to_vec2(),
    };
    (derivative.hypot() > 1e-9).then(|| derivative.normalize())
}

/// Averages widths over `reach` stations to both sides, as many to the one as to the other.
fn smooth(section: &mut [Station], reach: usize) {
    let n = section.len();
    let mut sums = vec![0.0; n + 1];
    (0..n).for_each(|k| sums[k + 1] = sums[k] + section[k].width);
    for k in 0..n {
        let r = reach.min(k).min(n - 1 - k);
        section[k].width = (sums[k + r + 1] - sums[k - r]) / (2 * r + 1) as f64;
    }
}

fn is_smooth_loop(section: &[Station]) -> bool {
    let (first, last) = (section[0], section[section.len() - 1]);
    first.tangent.dot(last.tangent) > CORNER.cos() && (first.point - last.point).hypot() < SPACING
}

/// One edge of a section; where a bend is tighter than the stroke is wide, the edge does not turn back.
fn edge(section: &[Station], side: f64) -> Vec<Point> {
    let mut edge: Vec<Point> = vec![section[0].edge(side)];
    for station in &section[1..] {
        let p = station.edge(side);
        if (p - edge[edge.len() - 1]).dot(station.tangent) > 0.0 {
            edge.push(p);
        }
    }
    let last = section[section.len() - 1].edge(side);
    if edge.len() > 1 && edge[edge.len() - 1] != last {
        edge.pop();
    }
    if edge[edge.len() - 1] != last {
        edge.push(last);
    }
    edge
}

/// The curves along an edge.
fn fitted(points: Vec<Point>, closed: bool, tolerance: Tolerance) -> Vec<Segment> {
    let ends = [points[0], points[points.len() - 1]].map(|p| Some(p).filter(|_| !closed));
    let weights = vec![1.0; points.len()];
    let samples = Samples::new(points, weights);
    if samples.len() < 6 {
        let lines = samples.points.windows(2).map(|p| Segment::Line(kurbo::Line::new(p[0], p[1])));
        return lines.collect();
    }
    let pieces = segment(&samples, tolerance);
    join(&samples, &pieces, closed, ends, tolerance)
}

/// An open section: along one edge, round its end, back along the other and round its start.
fn band(section: &[Station], tolerance: Tolerance) -> BezPath {
    let (first, last) = (section[0], section[section.len() - 1]);
    let there = fitted(edge(section, 1.0), false, tolerance);
    let mut back: Vec<Point> = edge(section, -1.0);
    back.reverse();
    let back = fitted(back, false, tolerance);
    let mut path = BezPath::new();
    path.move_to(first.edge(1.0));
    there.iter().for_each(|s| s.append_to(&mut path));
    path.extend(cap(last, 1.0).append_iter(ROUND));
    back.iter().for_each(|s| s.append_to(&mut path));
    path.extend(cap(first, -1.0).append_iter(ROUND));
    path.close_path();
    path
}

/// Half a circle round an end: from the edge along the normal if `side` is 1, else from the other.
fn cap(station: Station, side: f64) -> Arc {
    let start = (station.tangent.turn_90() * side).atan2();
    let radius = 0.5 * station.width;
    Arc::new(station.point, (radius, radius), start, -PI, 0.0)
}

/// A closed section: its two edges, one inside the other.
fn ring(section: &[Station], tolerance: Tolerance) -> BezPath {
    let mut path = BezPath::new();
    for side in [1.0, -1.0] {
        let mut points = edge(section, side);
        if let Some(last) = points.last_mut() {
            *last = section[0].edge(side);
        }
        let segments = fitted(points, true, tolerance);
        if let Some(first) = segments.first() {
            path.move_to(first.start());
            segments.iter().for_each(|s| s.append_to(&mut path));
            path.close_path();
        }
    }
    path
}
