//! Ends that run along another line are cut off.
//!
//! A walk that comes into another line at a small angle, or by a tight bend, may go on along that line before it notices
//! that the ink is taken. Once both are settled on the middle of their ink they coincide there, and only what is a
//! line's own says where it was going.

use crate::clean::LineImage;
use crate::graph::lines::{EndState, Lines};
use crate::streamline::STEP;

/// Lines nearer than this are one, in line widths, and at least in pixels.
const SAME: f64 = 0.35;
const SAME_PIXELS: f64 = 0.75;
/// Directions that differ by less than this cosine's angle (25 degrees) are one.
const ALONG_COS: f64 = 0.906;
/// A line that leaves the other for no more than this many line widths has not left it.
const APART: f64 = 0.5;
/// Overlaps shorter than this many line widths stay.
const SHORT: f64 = 0.75;

/// Cuts from every open line what its ends share with other lines, and drops lines that have nothing of their own. Returns
/// how many ends were cut.
pub(in crate::graph) fn cut_off(image: &LineImage, lines: &mut Lines) -> usize {
    let mut kept: Vec<(usize, usize)> = lines.iter().map(|line| (0, line.points.len())).collect();
    // Seeds come by certainty: what was traced last gives way first.
    for line in (0..lines.len()).rev().filter(|&i| !lines[i].closed) {
        for side in [0, 1] {
            let count = shared(image, lines, &kept, line, side);
            let (from, to) = &mut kept[line];
            if side == 0 {
                *from += count
            } else {
                *to -= count
            };
        }
    }
    let mut cut = 0;
    for (i, (from, to)) in kept.into_iter().enumerate() {
        let n = lines[i].points.len();
        let counts = if to - from < 2 && to - from < n { [n, 0] } else { [from, n - to] };
        for side in [1, 0].into_iter().filter(|&side| counts[side] > 0) {
            lines.shorten(i, side, counts[side], EndState::RanIn);
            cut += 1;
        }
    }
    lines.edit().retain(|line| !line.points.is_empty());
    cut
}

/// How many points at an end of a line lie along other lines.
fn shared(image: &LineImage, lines: &Lines, kept: &[(usize, usize)], line: usize, side: usize) -> usize {
    let (from, to) = kept[line];
    let count = |widths: f64| (widths * image.line_width / STEP).ceil() as usize;
    let radius = (SAME * image.line_width).max(SAME_PIXELS);
    let is_shared = |k: usize| {
        let heading = lines[line].direction_at(k);
        lines.near(lines[line].points[k], radius).iter().any(|(place, ..)| {
            let (a, b) = kept[place.line];
            let at = place.at.round() as usize;
            place.line != line
                && (lines[place.line].closed || (a..b).contains(&at))
                && lines[place.line].direction_at(at).dot(heading).abs() > ALONG_COS
        })
    };
    let mut last_shared = 0;
    for walked in 1..=to - from {
        let k = if side == 0 { from + walked - 1 } else { to - walked };
        if is_shared(k) {
            last_shared = walked;
        } else if walked - last_shared > count(APART) {
            break;
        }
    }
    if last_shared >= count(SHORT) { last_shared } else { 0 }
}
