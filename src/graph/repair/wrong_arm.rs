//! Lines that took the wrong arm are cut.
//!
//! Where two lines run into one at a small angle, the walk that comes first goes on along either. Once the other
//! arm is known, the three are compared: when the stem continues one side of the body better than the body's
//! other side does, the body is cut there, and its parts are paired anew with the stem. So it is where two corners share
//! their vertex, and a walk ran by from one to the other.

use crate::clean::LineImage;
use crate::graph::lines::course::{course, run};
use crate::graph::lines::end::End;
use crate::graph::resolve::contacts::Place;
use crate::graph::resolve::node::{Node, continuation, two_corners};
use crate::streamline::{STEP, Stop, Streamline};

/// What the stem must gain over the body's own continuation, radians.
const MARGIN: f64 = 0.1;
/// An arm that turns by more than this (35 degrees) does not continue another.
const LARGEST_TURN: f64 = 0.61;
/// Course of a body beside a node: from this many line widths away, over that many.
const AWAY: f64 = 2.0;
const OVER: f64 = 5.0;
/// Neither is more than this share of a closed line.
const ROUND: f64 = 0.125;

/// The places at which bodies should be cut.
pub(in crate::graph) fn cuts(
    image: &LineImage,
    lines: &[Streamline],
    ends: &[Option<End>],
    nodes: &[Node],
) -> Vec<Place> {
    nodes.iter().filter_map(|node| cut(image, lines, ends, node)).collect()
}

fn cut(image: &LineImage, lines: &[Streamline], ends: &[Option<End>], node: &Node) -> Option<Place> {
    let [body] = node.bodies[..] else { return None };
    let (line, at) = (&lines[body.line], body.at.round() as i64);
    let round = if line.closed { ROUND * line.points.len() as f64 * STEP } else { f64::INFINITY };
    let [away, over] = [AWAY, OVER].map(|widths| (widths * image.line_width).min(round));
    let sides = [-1, 1].map(|step| course(line, &run(line, at, step, away, over)));
    let [Some(back), Some(ahead)] = sides else { return None };
    let stems: Vec<&End> = node.ends.iter().filter_map(|&e| ends[e].as_ref()).collect();
    if let [a, b] = stems[..]
        && two_corners([&back, &ahead, &a.tail, &b.tail], node.position, image.line_width).is_some()
    {
        return Some(body);
    }
    let through = continuation(&back, &ahead, node.position, image.line_width);
    let best = stems
        .into_iter()
        .flat_map(|stem| [back, ahead].map(|side| continuation(&stem.tail, &side, node.position, image.line_width)))
        .min_by(f64::total_cmp)?;
    (best + MARGIN < through && best < LARGEST_TURN).then_some(body)
}

/// The lines with the given places cut; every part keeps the line's own stops at its outer ends.
pub(in crate::graph) fn cut_lines(lines: &[Streamline], places: &[Place]) -> Vec<Streamline> {
    let mut of_line = vec![Vec::new(); lines.len()];
    for place in places {
        of_line[place.line].push((place.at.round() as usize).min(lines[place.line].points.len() - 1));
    }
    let mut parts = Vec::new();
    for (line, mut at) in lines.iter().zip(of_line) {
        let n = line.points.len();
        at.sort_unstable();
        at.dedup();
        if at.is_empty() {
            parts.push(line.clone());
        } else if line.closed {
            let around: Vec<usize> = (0..=n).map(|k| (at[0] + k) % n).collect();
            let inner: Vec<usize> = at.iter().map(|a| a - at[0]).collect();
            parts.extend(split(line, &around, &inner, [Stop::Cut; 2]));
        } else {
            let all: Vec<usize> = (0..n).collect();
            parts.extend(split(line, &all, &at, line.stops));
        }
    }
    parts
}

fn split(line: &Streamline, order: &[usize], at: &[usize], stops: [Stop; 2]) -> Vec<Streamline> {
    let last = order.len() - 1;
    let mut bounds: Vec<usize> = at.iter().copied().filter(|&k| k > 0 && k < last).collect();
    bounds.insert(0, 0);
    bounds.push(last);
    let part = |b: &[usize]| {
        let run = &order[b[0]..=b[1]];
        Streamline {
            points: run.iter().map(|&k| line.points[k]).collect(),
            widths: run.iter().map(|&k| line.widths[k]).collect(),
            closed: false,
            stops: [if b[0] == 0 { stops[0] } else { Stop::Cut }, if b[1] == last { stops[1] } else { Stop::Cut }],
        }
    };
    bounds.windows(2).map(part).collect()
}
