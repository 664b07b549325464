//! Ends that stepped over a gap are taken back.
//!
//! Under the blur of a scan a narrow gap between an end and another line is not white, and a walk that has to bear
//! with grain runs across it, into the other line. The ink that is missing there tells the gap from grain.

use super::contacts::{LineIndex, Place, direction};
use super::ends::{End, ends};
use crate::clean::LineImage;
use crate::streamline::{STEP, Stop, Streamline};
use kurbo::{Line, Point};
use rayon::prelude::*;

/// The middle of a gap is looked for up to this many line widths and pixels before a crossed line's edge.
const BEFORE: f64 = 0.1;
const WIDEST: f64 = 1.5;
/// An end goes at most this many line widths past a line that it runs into.
const PAST: f64 = 1.4;
/// Nearer than this to its own end, in line widths, a crossed line may make a corner with the end.
const INNER: f64 = 2.0;

/// Missing ink, in pixels of gap, from which an end is cut: more than what keeps two lines apart that do not touch, since
/// here ink is given up.
const CLEAR_GAP: f64 = 0.9;

/// Cuts every end of a noisy line back to the gap that it stepped over, if there is one.
pub(super) fn withdraw(image: &LineImage, lines: &mut [Streamline]) {
    let index = LineIndex::new(lines);
    let ends = ends(image, lines);
    let cuts: Vec<(usize, usize, usize)> = ends
        .par_iter()
        .filter_map(|end| end.as_ref().filter(|end| !end.stop.is_cut_off()))
        .filter_map(|end| Some((end.line, end.side, gap(image, lines, &index, end)?)))
        .collect();
    for (line, side, count) in cuts {
        shorten(&mut lines[line], side, count);
    }
}

/// How many points of an end lie beyond a gap before the last line that it crosses.
fn gap(image: &LineImage, lines: &[Streamline], index: &LineIndex, end: &End) -> Option<usize> {
    let line = &lines[end.line];
    let n = line.points.len();
    let at = |k: usize| -> Point { line.points[if end.side == 0 { k } else { n - 1 - k }] };
    let count = |widths: f64| (widths * image.line_width / STEP) as usize;
    let last = count(PAST).min(n.saturating_sub(2));
    let crossed = |k: usize| -> Option<(usize, Place)> {
        let found = index.crossings(Line::new(at(k), at(k + 1)));
        let is_body = |place: &Place| place.line != end.line && is_inner(&lines[place.line], place.at, count(INNER));
        let (place, _, _) = found.into_iter().find(|(place, _, _)| is_body(place))?;
        Some((k, place))
    };
    let (from, place) = (0..last).find_map(crossed)?;
    let heading = (at(from) - at(from + 1)).normalize();
    let sine = heading.cross(direction(lines, place)).abs().max(0.5);
    let steps = |pixels: f64| (pixels / sine / STEP).round() as usize;
    let near = from + steps(0.45 * image.line_width);
    let far = (from + steps((0.5 + BEFORE) * image.line_width + WIDEST)).min(n.saturating_sub(3));
    let size = |k: usize| image.gap(at(k), heading, end.core);
    let widest = (near..=far).max_by(|&a, &b| size(a).total_cmp(&size(b)))?;
    (size(widest) > CLEAR_GAP).then_some(widest)
}

/// Whether a place is at least `margin` points away from both ends of a line.
fn is_inner(line: &Streamline, at: f64, margin: usize) -> bool {
    line.closed || (at >= margin as f64 && at + margin as f64 <= line.points.len() as f64 - 1.0)
}

/// Takes points off an end; two are left.
fn shorten(line: &mut Streamline, side: usize, count: usize) {
    let count = count.min(line.points.len().saturating_sub(2));
    if side == 0 {
        line.points.drain(..count);
        line.widths.drain(..count);
    } else {
        line.points.truncate(line.points.len() - count);
        line.widths.truncate(line.widths.len() - count);
    }
    line.stops[side] = Stop::InkEnd;
}
