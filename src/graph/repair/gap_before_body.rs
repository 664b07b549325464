//! Ends in unsure ink that face another line's body across a gap are taken back to where the pen stopped.
//!
//! Under the blur of a scan a narrow gap is not white, and a walk that has to bear with grain runs across it, into the
//! other line. What the pixels say of the gap decides (`approach`).

use super::approach::Approach;
use crate::clean::{LineImage, unblurred_width};
use crate::graph::lines::{End, EndState, Line, Lines, Place, arm_line};
use crate::streamline::STEP;
use kurbo::{Line as Segment, Point, Vec2};
use rayon::prelude::*;

/// A body is looked for among the last so many line widths of a line, and so many ahead of it.
const PAST: f64 = 1.4;
const AHEAD: f64 = 2.5;
/// Nearer than this to its own end, in line widths, a crossed line may make a corner with the end.
const INNER: f64 = 1.6;
/// How much of a body is looked at to either side, in line widths.
const AROUND: f64 = 5.0;
/// Where the ink is surer than this, as a share of grain, a gap is seen by itself.
const GRAIN: f64 = 0.5;
/// Of a thinner pen, in pixels, the cap is not seen.
const THINNEST: f64 = 2.4;
/// An end that comes in at a smaller angle than this sine's (30 degrees) hides its cap in the body's ink.
const LEAST_SINE: f64 = 0.5;

/// Takes back every end in unsure ink that faces a body across a gap. Returns how many there are.
pub(in crate::graph) fn take_back(image: &LineImage, lines: &mut Lines) -> usize {
    let before_gap = |end: &End| Some((end.line, end.side, gap(image, lines, end)?));
    let ends = lines.ends(image).par_iter().flatten().filter(|end| end.state != EndState::CutOff);
    let found: Vec<(usize, usize, Point)> = ends.filter_map(before_gap).collect();
    for &(line, side, gap) in &found {
        lines.shorten(line, side, beyond(&lines[line], side, gap), EndState::Lifted);
    }
    found.len()
}

/// The middle of the gap between an end and the body that it faces, if there is one.
fn gap(image: &LineImage, lines: &Lines, end: &End) -> Option<Point> {
    if image.noise.at(end.point).grain() < GRAIN {
        return None;
    }
    let (place, foot) = body(image, lines, end)?;
    let (_, heading) = arm_line(&end.tail, foot, image.line_width);
    if heading.cross(lines.direction(place)).abs() < LEAST_SINE {
        return None;
    }
    if unblurred_width(end.width, image.blur) < THINNEST {
        return None;
    }
    let reach = AROUND * image.line_width;
    let line = &lines[place.line];
    let of_body = line.around(place.at, reach).filter(|&k| k < line.piece_count());
    let near = lines.near(foot, reach).into_iter().filter(|(p, ..)| p.line != place.line && p.line != end.line);
    let other = |p: Place| {
        let width = lines.width(p, image.line_width);
        let other = &lines[p.line];
        (other.piece((p.at as usize).min(other.piece_count() - 1)), width)
    };
    let approach = Approach {
        foot,
        heading,
        widths: [end.width, lines.width(place, image.line_width)],
        body: of_body.map(|k| line.piece(k)).collect(),
        others: near.map(|(p, ..)| other(p)).collect(),
    };
    approach.gap(image)
}

/// The first body on the last stretch of an end or ahead of it, and where the end's course crosses it.
fn body(image: &LineImage, lines: &Lines, end: &End) -> Option<(Place, Point)> {
    let line = &lines[end.line];
    let at = |k: usize| line.at_end(end.side, k);
    let count = |widths: f64| (widths * image.line_width / STEP) as usize;
    let last = count(PAST).min(line.points.len().saturating_sub(2));
    let crossed = |piece: Segment| -> Option<(Place, Point)> {
        let found = lines.crossings(piece);
        let is_body = |place: &Place| place.line != end.line && is_inner(&lines[place.line], place.at, count(INNER));
        let (place, point, _) = found.into_iter().find(|(place, ..)| is_body(place))?;
        Some((place, point))
    };
    let ahead = Segment::new(end.point, end.point + end.tail.heading * (AHEAD * image.line_width));
    let inner = (0..last).rev().find_map(|k| crossed(Segment::new(at(k + 1), at(k))));
    inner.or_else(|| crossed(ahead))
}

/// Whether a place is at least `margin` points away from both ends of a line.
fn is_inner(line: &Line, at: f64, margin: usize) -> bool {
    line.closed || (at >= margin as f64 && at + margin as f64 <= line.points.len() as f64 - 1.0)
}

/// How many of a line's last points lie beyond a place, but for two of the line.
fn beyond(line: &Line, side: usize, place: Point) -> usize {
    let n = line.points.len();
    let inner = line.at_end(side, n.min(3) - 1) - line.at_end(side, 0);
    let inwards = if inner.hypot() > 1e-9 { inner.normalize() } else { Vec2::ZERO };
    let beyond = (0..n).take_while(|&k| (line.at_end(side, k) - place).dot(inwards) < 0.0);
    beyond.count().min(n.saturating_sub(2))
}
