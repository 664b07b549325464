//! The ends of lines: where each is heading, and how wide and dark it is there.

use super::line::{EndState, Line};
use crate::clean::LineImage;
use crate::streamline::{STEP, Tail};
use kurbo::{Point, Vec2};
use rayon::prelude::*;

/// How much of a line tells where its end is heading, in line widths.
const TAIL: f64 = 5.0;
/// How much of a line right before a junction is left out of that, in line widths.
const BLUR: f64 = 0.4;
/// The same where a line was parted because it had taken the wrong arm.
const PARTED_BLUR: f64 = 2.0;
/// A line that is not alone for this many of its widths before its end comes to a junction there.
const JUNCTION: f64 = 0.3;
/// For how many line widths a line must be alone before its end for that to be its course.
const LASTING: f64 = 0.5;
/// The standard deviation of a line's points about its course, in pixels.
const JITTER: f64 = 0.1;
/// As many of the first measured widths from an end, 20 pixels of it, tell the width there.
const WIDTHS: usize = 40;

/// One end of a line.
#[derive(Clone, Copy, Debug)]
pub(in crate::graph) struct End {
    /// Index of the line.
    pub line: usize,
    /// 0 for the first point, 1 for the last.
    pub side: usize,
    /// The line's last point.
    pub point: Point,
    /// Index of the last point at which the line was alone.
    pub tip: usize,
    /// The line's course up to the tip, heading outwards.
    pub tail: Tail,
    /// Line width near the end, in pixels.
    pub width: f64,
    /// Ink in the line's middle near the end, at most 1.
    pub core: f32,
    /// What is known of it.
    pub state: EndState,
}

impl End {
    /// Its number.
    pub fn id(&self) -> usize {
        end_id(self.line, self.side)
    }
}

/// Number of an end: two for each line.
pub(in crate::graph) fn end_id(line: usize, side: usize) -> usize {
    2 * line + side
}

/// The ends of all lines, by number; `None` for closed lines.
pub(super) fn ends(image: &LineImage, lines: &[Line]) -> Vec<Option<End>> {
    let both = |i: usize| [0, 1].map(|side| (!lines[i].closed).then(|| end(image, &lines[i], i, side)));
    (0..lines.len()).into_par_iter().flat_map_iter(both).collect()
}

fn end(image: &LineImage, line: &Line, i: usize, side: usize) -> End {
    let n = line.points.len();
    let width = median_width(line, side, image.line_width);
    let alone = |k: usize| line.is_alone(line.inwards(side, k));
    // Where several lines end, the corner of their ink can look like a line of its own.
    let lasting = (LASTING * width / STEP) as usize;
    let long = (0..n / 2).find(|&k| (k..(k + lasting).min(n)).all(alone));
    let tip = long.or_else(|| (0..n).find(|&k| alone(k))).unwrap_or(n / 2);
    let blur = match line.ends[side] {
        EndState::Parted => PARTED_BLUR,
        _ if tip as f64 * STEP > JUNCTION * width => BLUR,
        _ => 0.0,
    };
    let skip = (blur * width / STEP) as usize;
    let length = ((TAIL * width / STEP) as usize).max(3);
    let from = (tip + skip).min(n.saturating_sub(3));
    let run = (from..(from + length).min(n)).take_while(|&k| k < from + 3 || alone(k));
    let run: Vec<Point> = run.map(|k| line.at_end(side, k)).collect();
    let (tail, core) = (tail(line, side, &run), core(image, &run));
    End {
        line: i,
        side,
        point: line.at_end(side, 0),
        tip: line.inwards(side, tip),
        tail,
        width,
        core,
        state: line.ends[side],
    }
}

/// The course of the points before an end, the nearest first; that of the end itself where they have none.
fn tail(line: &Line, side: usize, run: &[Point]) -> Tail {
    let oldest_first: Vec<Point> = run.iter().rev().copied().collect();
    let point = line.at_end(side, 0);
    let outwards = point - line.at_end(side, (line.points.len() - 1).min(2));
    let heading = if outwards.hypot() > 1e-9 { outwards.normalize() } else { Vec2::new(1.0, 0.0) };
    Tail::fit(&oldest_first, JITTER).unwrap_or(Tail { point, heading, curvature: 0.0 })
}

/// The ink in the middle of a line along some of its points.
fn core(image: &LineImage, run: &[Point]) -> f32 {
    let moves = run.windows(2).filter(|w| (w[1] - w[0]).hypot2() > 1e-12);
    median(moves.map(|w| image.core(w[0], (w[1] - w[0]).normalize()))).map_or(1.0, |c| c.clamp(0.3, 1.0))
}

fn median_width(line: &Line, side: usize, typical: f64) -> f64 {
    let widths = (0..line.points.len()).map(|k| line.widths[line.inwards(side, k)]);
    median(widths.filter(|w| w.is_finite()).take(WIDTHS).map(|w| w as f32)).map_or(typical, f64::from)
}

fn median(values: impl Iterator<Item = f32>) -> Option<f32> {
    let mut values: Vec<f32> = values.collect();
    values.sort_by(f32::total_cmp);
    values.get(values.len() / 2).copied()
}
