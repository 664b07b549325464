//! Where a line leaves another at a small angle, the line that goes straight on is made one.
//!
//! Long before two inks part, a walk cannot tell the one from the other: it goes on along either, or ends in the crotch
//! between them. The walks that come after it, back from the arms, stop at its ink. Here, of the arms of each such fork
//! the one that best continues the stem is joined to it, so that the other is what leaves ([`super::tangent_end`]).

use super::tangent_end::bodies;
use crate::clean::LineImage;
use crate::graph::lines::{End, EndState, Line, Lines, Place, THIN, bridge, course, departure};
use crate::streamline::{STEP, Tail};
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

/// Joins the straightest arm of every fork to its stem. Returns how many there are.
pub(in crate::graph) fn straighten(image: &LineImage, lines: &mut Lines) -> usize {
    let mut joined = 0;
    for _ in 0..ROUNDS {
        let mut forks = forks(image, lines);
        if forks.is_empty() {
            break;
        }
        forks.sort_by(|a, b| a.turn.total_cmp(&b.turn).then((a.line, a.side).cmp(&(b.line, b.side))));
        let mut taken = vec![false; lines.len()];
        for fork in forks {
            if !taken[fork.line] && !taken[fork.body.line] {
                (taken[fork.line], taken[fork.body.line]) = (true, true);
                fork.apply(image, lines.edit());
                joined += 1;
            }
        }
        lines.edit().retain(|line| !line.points.is_empty());
    }
    joined
}

/// The ends of lines that go on in the stem of a fork.
fn forks(image: &LineImage, lines: &Lines) -> Vec<Fork> {
    if !lines.iter().any(|line| line.ends.contains(&EndState::RanIn)) {
        return Vec::new();
    }
    let ran_in = |end: &&End| end.state == EndState::RanIn;
    let fork = |end: &End| {
        let bodies = bodies(lines, end, NEAR * image.line_width);
        let forks = bodies.into_iter().filter_map(|body| fork(image, lines, end, body));
        forks.min_by(|a, b| a.turn.total_cmp(&b.turn))
    };
    let all: Vec<Fork> = lines.ends(image).par_iter().flatten().filter(ran_in).filter_map(fork).collect();
    // A single line that runs into the end of another is met there.
    let meet = |a: &Fork, b: &Fork| (a.body.line, a.forward) == (b.body.line, b.forward);
    let count = |fork: &Fork| all.iter().filter(|other| !other.has_arm && meet(fork, other)).count();
    let is_fork: Vec<bool> = all.iter().map(|fork| fork.has_arm || count(fork) > 1).collect();
    all.into_iter().zip(is_fork).filter_map(|(fork, is_fork)| is_fork.then_some(fork)).collect()
}

/// The fork of a body at which an end lies, if the end goes on in the stem.
fn fork(image: &LineImage, lines: &Lines, end: &End, body: Place) -> Option<Fork> {
    let line = &lines[body.line];
    if line.closed {
        return None;
    }
    let lw = image.line_width.max(THIN);
    let forward = lines.direction(body).dot(end.tail.heading) > 0.0;
    let (at, step) = (body.at.round() as i64, if forward { 1 } else { -1 });
    let own = lines[end.line].run(end.tip as i64, if end.side == 0 { 1 } else { -1 }, 0.0, OVER * lw);
    let tail = course(&lines[end.line], &own)?;
    let stem = course(line, &line.run(at, step, AWAY * lw, OVER * lw))?;
    let turn = departure(&tail, &stem);
    if turn > STRAIGHT {
        return None;
    }
    let ahead = line.run(at, -step, 0.0, (APART + OVER) * lw);
    let lasting = ((LASTING * lw / STEP) as usize).max(1);
    let alone = ahead.windows(lasting).position(|w| w.iter().all(|&k| line.is_alone(k)));
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
    fn apply(self, image: &LineImage, lines: &mut [Line]) {
        // The end's line towards the fork, the stem away from it.
        let end = std::mem::take(&mut lines[self.line]);
        let tip = end.inwards(1 - self.side, self.tip);
        let end = end.oriented(1 - self.side);
        let body = std::mem::take(&mut lines[self.body.line]);
        let side = usize::from(!self.forward);
        let from = body.inwards(side, self.body.at.round() as usize);
        let body = body.oriented(side);
        let last = body.points.len() - 1;
        let away = (from + (AWAY * image.line_width.max(THIN) / STEP) as usize).min(last);
        let stem = body.part(away..=last, body.ends);
        let mut joined = end.part(0..=tip, end.ends);
        let tail = Tail { point: end.points[tip], ..self.tail };
        joined.lead_on(bridge(&tail, &Tail { point: stem.points[0], ..self.stem }));
        joined.append(stem);
        lines[self.line] = joined;
        if self.has_arm {
            lines[self.body.line] = body.part(0..from, [body.ends[0], EndState::RanIn]);
        }
    }
}
