//! Where two lines run into one and end there together, as the humps of a coil do, both go on to the end of the ink.
//!
//! Long before such a cusp the two inks are one, and what shows of the lines bends towards its axis. Drawn straight on,
//! they would meet too early, in a corner, and leave the tip bare.

use crate::clean::LineImage;
use crate::graph::lines::{End, EndState, Lead, Lines, arm_line, bridge, course};
use crate::graph::point_index::PointIndex;
use crate::graph::resolve::free_end;
use crate::profile::cross_profile;
use crate::streamline::{STEP, Tail, angle_between};
use kurbo::{Point, Vec2};
use std::iter;

/// The tip is no further than this from where the lines are alone, in line widths.
const LONGEST: f64 = 8.0;
/// The ink at the tip is as wide as one line: within these factors. That of a sharp corner is narrower.
const NARROWEST: f64 = 0.75;
const WIDEST: f64 = 1.35;
/// Both lines, bent on as they are, come by the tip within so many line widths, and within this cosine's angle (35 degrees)
/// of one another.
const BESIDE: f64 = 0.6;
const ALONG_COS: f64 = 0.82;
/// Each shows where it is so many line widths apart from the other; its course is that over so many.
const APART: f64 = 1.15;
const OVER: f64 = 3.0;
/// It turns by at least this on its way to the tip, radians, and bends by so much per line width: straight lines meet in a
/// corner.
const LEAST_TURN: f64 = 0.08;
const LEAST_BEND: f64 = 0.02;
/// Ink that both run through.
const INKED: f32 = 0.4;

/// Leads both lines of every cusp to its tip. Returns how many ends were led.
pub(in crate::graph) fn sharpen(image: &LineImage, lines: &mut Lines) -> usize {
    let ends: Vec<End> = lines.ends(image).iter().flatten().copied().collect();
    let index = PointIndex::new(ends.iter().map(|end| end.point).enumerate());
    let mut taken = vec![false; ends.len()];
    for (i, end) in ends.iter().enumerate().filter(|(_, end)| end.state == EndState::Open) {
        if taken[i] {
            continue;
        }
        let tip = free_end(image, lines, end);
        let others = index.near(end.point, LONGEST * image.line_width).filter(|&j| j != i && !taken[j]);
        let cusps = others.filter_map(|j| Some((j, cusp(image, lines, [end, &ends[j]], tip)?)));
        let Some((j, leads)) = cusps.min_by_key(|(j, _)| *j) else { continue };
        (taken[i], taken[j]) = (true, true);
        for (end, lead) in [end, &ends[j]].into_iter().zip(leads) {
            lines.lead(end.line, end.side, lead);
        }
    }
    taken.into_iter().filter(|&taken| taken).count()
}

/// How two lines end at a cusp, of which the first reaches the end of the ink, at `tip`.
fn cusp(image: &LineImage, lines: &Lines, [a, b]: [&End; 2], tip: Point) -> Option<[Lead; 2]> {
    if !matches!(b.state, EndState::Open | EndState::RanIn) {
        return None;
    }
    let lw = image.line_width;
    let arms = [arm(lines, a, b, lw)?, arm(lines, b, a, lw)?];
    let turns = arms.each_ref().map(|arm| arm.turn(tip, lw));
    if turns[0]? * turns[1]? > 0.0 {
        return None;
    }
    let there = arms.each_ref().map(|arm| arm_line(&arm.tail, tip, lw));
    let passes = |(point, heading): &(Point, Vec2)| heading.cross(tip - *point).abs() < BESIDE * a.width;
    if !there.iter().all(passes) || there[0].1.dot(there[1].1) < ALONG_COS {
        return None;
    }
    let axis = (there[0].1 + there[1].1).normalize();
    let width = cross_profile(&image.ink, tip, axis.turn_90(), a.width + 1.0)?.width()?;
    if !(NARROWEST * a.width..WIDEST * a.width).contains(&width) {
        return None;
    }
    let tip = Tail { point: tip, heading: -axis, curvature: 0.0 };
    let leads = arms.map(|arm| {
        let points = iter::once(tip.point).chain(bridge(&tip, &arm.tail)).collect();
        Lead { points, replaced: arm.hidden }
    });
    let is_inked = |lead: &Lead| lead.points.iter().all(|p| image.ink.sample(*p) > INKED);
    leads.iter().all(is_inked).then_some(leads)
}

/// A line that comes to a cusp.
struct Arm {
    /// How many of its last points lie in ink that it shares with the other.
    hidden: usize,
    /// Its course up to there.
    tail: Tail,
}

/// The part of an end's line that is apart from another's.
fn arm(lines: &Lines, end: &End, other: &End, line_width: f64) -> Option<Arm> {
    let inwards = |end: &End| {
        let line = &lines[end.line];
        let step = if end.side == 0 { 1 } else { -1 };
        line.run(line.inwards(end.side, 0) as i64, step, 0.0, (LONGEST + OVER) * line_width)
    };
    let (line, own) = (&lines[end.line], inwards(end));
    let others: Vec<Point> = inwards(other).into_iter().map(|k| lines[other.line].points[k]).collect();
    let is_apart = |k: &usize| {
        let apart = (APART * end.width).powi(2);
        others.iter().all(|p| (*p - line.points[*k]).hypot2() > apart)
    };
    // Before the other's last point, a line can be alone in the tip.
    let beside = own.iter().position(|k| !is_apart(k))?;
    let hidden = beside + own[beside..].iter().position(is_apart)?;
    let count = (OVER * line_width / STEP) as usize;
    let tail = course(line, &own[hidden..own.len().min(hidden + count)])?;
    Some(Arm { hidden, tail })
}

impl Arm {
    /// How far it turns on its way to a tip, if that is ahead of it and it bends that way.
    fn turn(&self, tip: Point, line_width: f64) -> Option<f64> {
        let way = tip - self.tail.point;
        let (turn, bend) = (angle_between(self.tail.heading, way), self.tail.curvature * line_width);
        let is_ahead = way.dot(self.tail.heading) > 0.0 && way.hypot() < LONGEST * line_width;
        let is_bent = turn * bend > 0.0 && turn.abs() > LEAST_TURN && bend.abs() > LEAST_BEND;
        (is_ahead && is_bent).then_some(turn)
    }
}
