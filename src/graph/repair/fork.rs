//! Where a line leaves another at a small angle, the line that goes straight on is made one.
//!
//! Long before two inks part, a walk cannot tell the one from the other: it goes on along either, or ends in the crotch
//! between them. The walks that come after it, back from the arms, stop at its ink. Here, of the arms of each such fork
//! the one that best continues the stem is joined to it, so that the other is what leaves ([`super::tangent_end`]).

use crate::clean::LineImage;
use crate::graph::lines::course::{THIN, bridge, course, departure, run};
use crate::graph::lines::end::{End, ends};
use crate::graph::repair::tangent_end::bodies;
use crate::graph::resolve::contacts::{LineIndex, Place, direction};
use crate::streamline::{STEP, Stop, Streamline, Tail};
use rayon::prelude::*;

/// A body is looked for within this many line widths of an end.
const NEAR: f64 = 1.2;
/// The stem's course is that from this many line widths before the end on, over that many: nearer, the other's ink bulges.
const AWAY: f64 = 6.0;
const OVER: f64 = 5.0;
/// An arm is alone within this many line widths of the end, for that many at least, or there is none.
const APART: f64 = 8.0;
const LASTING: f64 = 0.5;
/// What goes on in the stem departs from it by less than this (a kink of 30 degrees), and by so much less than the body's arm.
const STRAIGHT: f64 = 0.26;
const MARGIN: f64 = 0.1;
/// Rounds, each of which takes up a line once.
const ROUNDS: usize = 4;

/// An end that continues the stem of a body better than the body does.
struct Fork {
    line: usize,
    side: usize,
    /// Index of the last point at which the end's line is alone, and its course there.
    tip: usize,
    tail: Tail,
    body: Place,
    /// Which way along the body the stem lies, and its course towards the fork.
    forward: bool,
    stem: Tail,
    /// Whether the body has an arm of its own.
    has_arm: bool,
    turn: f64,
}

/// Joins the straightest arm of every fork to its stem.
pub(in crate::graph) fn straighten(image: &LineImage, lines: &mut Vec<Streamline>) {
    for _ in 0..ROUNDS {
        let mut forks = forks(image, lines);
        if forks.is_empty() {
            return;
        }
        forks.sort_by(|a, b| a.turn.total_cmp(&b.turn).then((a.line, a.side).cmp(&(b.line, b.side))));
        let mut taken = vec![false; lines.len()];
        for fork in forks {
            if !taken[fork.line] && !taken[fork.body.line] {
                (taken[fork.line], taken[fork.body.line]) = (true, true);
                fork.apply(image, lines);
            }
        }
        lines.retain(|line| !line.points.is_empty());
    }
}

/// The ends of lines that go on in the stem of a fork.
fn forks(image: &LineImage, lines: &[Streamline]) -> Vec<Fork> {
    if !lines.iter().any(|line| line.stops.contains(&Stop::Merged)) {
        return Vec::new();
    }
    let index = LineIndex::new(lines);
    let ends = ends(image, lines);
    let merged = |end: &&End| end.stop == Stop::Merged;
    let fork = |end: &End| {
        let bodies = bodies(lines, &index, end, NEAR * image.line_width);
        let forks = bodies.into_iter().filter_map(|body| fork(image, lines, end, body));
        forks.min_by(|a, b| a.turn.total_cmp(&b.turn))
    };
    let all: Vec<Fork> = ends.par_iter().filter_map(|end| fork(end.as_ref().filter(merged)?)).collect();
    // A single line that runs into the end of another is met there.
    let meet = |a: &Fork, b: &Fork| (a.body.line, a.forward) == (b.body.line, b.forward);
    let count = |fork: &Fork| all.iter().filter(|other| !other.has_arm && meet(fork, other)).count();
    let is_fork: Vec<bool> = all.iter().map(|fork| fork.has_arm || count(fork) > 1).collect();
    all.into_iter().zip(is_fork).filter_map(|(fork, is_fork)| is_fork.then_some(fork)).collect()
}

/// The fork of a body at which an end lies, if the end goes on in the stem.
fn fork(image: &LineImage, lines: &[Streamline], end: &End, body: Place) -> Option<Fork> {
    let line = &lines[body.line];
    if line.closed {
        return None;
    }
    let lw = image.line_width.max(THIN);
    let forward = direction(lines, body).dot(end.tail.heading) > 0.0;
    let (at, step) = (body.at.round() as i64, if forward { 1 } else { -1 });
    let own = run(&lines[end.line], end.tip as i64, if end.side == 0 { 1 } else { -1 }, 0.0, OVER * lw);
    let tail = course(&lines[end.line], &own)?;
    let stem = course(line, &run(line, at, step, AWAY * lw, OVER * lw))?;
    let turn = departure(&tail, &stem);
    if turn > STRAIGHT {
        return None;
    }
    let ahead = run(line, at, -step, 0.0, (APART + OVER) * lw);
    let lasting = ((LASTING * lw / STEP) as usize).max(1);
    let alone = ahead.windows(lasting).position(|w| w.iter().all(|&k| line.widths[k].is_finite()));
    let arm = alone.and_then(|alone| {
        let count = (OVER * lw / STEP) as usize;
        course(line, &ahead[alone..ahead.len().min(alone + count)])
    });
    let ends_here = (ahead.len() as f64) * STEP < APART * lw;
    let bends = |arm: &Tail| departure(arm, &stem) > turn + MARGIN;
    let is_fork = arm.as_ref().map_or(ends_here, bends);
    let has_arm = arm.is_some();
    is_fork.then_some(Fork { line: end.line, side: end.side, tip: end.tip, tail, body, forward, stem, has_arm, turn })
}

impl Fork {
    /// Leads the end's line into the stem; the body keeps its arm, which ends at the fork.
    fn apply(self, image: &LineImage, lines: &mut [Streamline]) {
        let mut end = std::mem::replace(&mut lines[self.line], empty());
        let mut body = std::mem::replace(&mut lines[self.body.line], empty());
        let at = self.body.at.round() as usize;
        // The end's line towards the fork, the stem away from it.
        let tip = if self.side == 0 { end.points.len() - 1 - self.tip } else { self.tip };
        if self.side == 0 {
            end.reverse();
        }
        let from = if self.forward { at } else { body.points.len() - 1 - at };
        if !self.forward {
            body.reverse();
        }
        let away = (from + (AWAY * image.line_width.max(THIN) / STEP) as usize).min(body.points.len() - 1);
        let tail = Tail { point: end.points[tip], ..self.tail };
        let bridge = bridge(&tail, &Tail { point: body.points[away], ..self.stem });
        let mut joined = Streamline {
            points: end.points[..=tip].to_vec(),
            widths: end.widths[..=tip].to_vec(),
            closed: false,
            stops: [end.stops[0], body.stops[1]],
        };
        joined.widths.resize(joined.points.len() + bridge.len(), f64::NAN);
        joined.points.extend(bridge);
        joined.points.extend(&body.points[away..]);
        joined.widths.extend(&body.widths[away..]);
        lines[self.line] = joined;
        if self.has_arm {
            let stops = [body.stops[0], Stop::Merged];
            body.points.truncate(from);
            body.widths.truncate(from);
            lines[self.body.line] = Streamline { stops, ..body };
        }
    }
}

fn empty() -> Streamline {
    Streamline { points: Vec::new(), widths: Vec::new(), closed: false, stops: [Stop::Cut; 2] }
}
