//! Ends on a noisy page that face another line's body across a gap are taken back to where the pen stopped.
//!
//! Under the blur of a scan a narrow gap is not white, and a walk that has to bear with grain runs across it, into the
//! other line. What the pixels say of the gap decides (`approach`).

use super::approach::Approach;
use crate::clean::{LineImage, unblurred_width};
use crate::graph::lines::end::{End, ends};
use crate::graph::resolve::contacts::{LineIndex, Place, around, direction, piece, piece_count, width_at};
use crate::graph::resolve::node::arm_line;
use crate::streamline::{STEP, Stop, Streamline};
use kurbo::{Line, Point, Vec2};
use rayon::prelude::*;

/// A body is looked for among the last so many line widths of a line, and so many ahead of it.
const PAST: f64 = 1.4;
const AHEAD: f64 = 2.5;
/// Nearer than this to its own end, in line widths, a crossed line may make a corner with the end.
const INNER: f64 = 1.6;
/// How much of a body is looked at to either side, in line widths.
const AROUND: f64 = 5.0;
/// Of a thinner pen, in pixels, the cap is not seen.
const THINNEST: f64 = 2.4;
/// An end that comes in at a smaller angle than this sine's (30 degrees) hides its cap in the body's ink.
const LEAST_SINE: f64 = 0.5;

/// Settles every end of a noisy page that faces a body across a gap.
pub(in crate::graph) fn settle(image: &LineImage, lines: &mut [Streamline]) {
    let index = LineIndex::new(lines);
    let ends = ends(image, lines);
    let before_gap = |end: &End| Some((end.line, end.side, gap(image, lines, &index, end)?));
    let settled: Vec<(usize, usize, Point)> =
        ends.par_iter().filter_map(|end| before_gap(end.as_ref().filter(|end| !end.stop.is_cut_off())?)).collect();
    for (line, side, gap) in settled {
        shorten(&mut lines[line], side, gap);
    }
}

/// The middle of the gap between an end and the body that it faces, if there is one.
fn gap(image: &LineImage, lines: &[Streamline], index: &LineIndex, end: &End) -> Option<Point> {
    let (place, foot) = body(image, lines, index, end)?;
    let (_, heading) = arm_line(&end.tail, foot, image.line_width);
    if heading.cross(direction(lines, place)).abs() < LEAST_SINE {
        return None;
    }
    if unblurred_width(end.width, image.blur) < THINNEST {
        return None;
    }
    let reach = AROUND * image.line_width;
    let line = &lines[place.line];
    let of_body = around(line, place.at, reach).filter(|&k| k < piece_count(line));
    let near = index.near(foot, reach).into_iter().filter(|(p, ..)| p.line != place.line && p.line != end.line);
    let other = |p: Place| {
        let width = width_at(lines, p, image.line_width);
        (piece(&lines[p.line], (p.at as usize).min(piece_count(&lines[p.line]) - 1)), width)
    };
    let approach = Approach {
        foot,
        heading,
        widths: [end.width, width_at(lines, place, image.line_width)],
        body: of_body.map(|k| piece(line, k)).collect(),
        others: near.map(|(p, ..)| other(p)).collect(),
    };
    approach.gap(image)
}

/// The first body on the last stretch of an end or ahead of it, and where the end's course crosses it.
fn body(image: &LineImage, lines: &[Streamline], index: &LineIndex, end: &End) -> Option<(Place, Point)> {
    let line = &lines[end.line];
    let n = line.points.len();
    let at = |k: usize| -> Point { line.points[if end.side == 0 { k } else { n - 1 - k }] };
    let count = |widths: f64| (widths * image.line_width / STEP) as usize;
    let last = count(PAST).min(n.saturating_sub(2));
    let crossed = |piece: Line| -> Option<(Place, Point)> {
        let found = index.crossings(piece);
        let is_body = |place: &Place| place.line != end.line && is_inner(&lines[place.line], place.at, count(INNER));
        let (place, point, _) = found.into_iter().find(|(place, ..)| is_body(place))?;
        Some((place, point))
    };
    let ahead = Line::new(end.point, end.point + end.tail.heading * (AHEAD * image.line_width));
    let inner = (0..last).rev().find_map(|k| crossed(Line::new(at(k + 1), at(k))));
    inner.or_else(|| crossed(ahead))
}

/// Whether a place is at least `margin` points away from both ends of a line.
fn is_inner(line: &Streamline, at: f64, margin: usize) -> bool {
    line.closed || (at >= margin as f64 && at + margin as f64 <= line.points.len() as f64 - 1.0)
}

/// Lets a line end before a place among its last points; two are left.
fn shorten(line: &mut Streamline, side: usize, gap: Point) {
    let n = line.points.len();
    let at = |k: usize| line.points[if side == 0 { k } else { n - 1 - k }];
    let inner = at(n.min(3) - 1) - at(0);
    let heading = if inner.hypot() > 1e-9 { inner.normalize() } else { Vec2::ZERO };
    let count = (0..n).take_while(|&k| (at(k) - gap).dot(heading) < 0.0).count().min(n - 2);
    if side == 0 {
        line.points.drain(..count);
        line.widths.drain(..count);
    } else {
        line.points.truncate(n - count);
        line.widths.truncate(n - count);
    }
    line.stops[side] = Stop::Settled;
}
