//! Lines that took the wrong arm are cut.
//!
//! Where two lines run into one at a small angle, the walk that comes first goes on along either. Once the other
//! arm is known, the three are compared: when the stem continues one side of the body better than the body's
//! other side does, the body is cut there, and its parts are paired anew with the stem. So it is where two corners share
//! their vertex, and a walk ran by from one to the other.

use crate::clean::LineImage;
use crate::graph::lines::{End, Lines, Place, continuation, course};
use crate::graph::resolve::{Node, two_corners};
use crate::streamline::STEP;

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
pub(in crate::graph) fn cuts(image: &LineImage, lines: &Lines, nodes: &[Node]) -> Vec<Place> {
    nodes.iter().filter_map(|node| cut(image, lines, node)).collect()
}

fn cut(image: &LineImage, lines: &Lines, node: &Node) -> Option<Place> {
    let [body] = node.bodies[..] else { return None };
    let (line, at) = (&lines[body.line], body.at.round() as i64);
    let round = if line.closed { ROUND * line.points.len() as f64 * STEP } else { f64::INFINITY };
    let [away, over] = [AWAY, OVER].map(|widths| (widths * image.line_width).min(round));
    let sides = [-1, 1].map(|step| course(line, &line.run(at, step, away, over)));
    let [Some(back), Some(ahead)] = sides else { return None };
    let ends = lines.ends(image);
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
