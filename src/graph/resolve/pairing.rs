//! Which arms of a node are one stroke. This is where two ends become one.

use super::node::Node;
use crate::graph::lines::{End, Lines, arm_line, continuation};
use crate::streamline::{Tail, angle_between};
use kurbo::Point;

/// Ends on a body pair up across it when the stroke turns by less than this, radians (35 degrees): what turns more ends there.
const ACROSS_BODY: f64 = 0.61;
/// Two ends on one side of a body are a V that stands on it when their angles to it differ by less than this (10 degrees).
const AS_STEEP: f64 = 0.17;
/// Beyond the first pair at a branch, arms pair up when the stroke turns by less than this (60 degrees).
const LATER_PAIR: f64 = 1.05;
/// Arms never pair up when the stroke would turn by more than this (170 degrees).
const LARGEST_TURN: f64 = 2.97;
/// Of four arms, two that turn by less than this (15 degrees) are one line.
const STRAIGHT: f64 = 0.26;
/// A stroke folds back when it turns by more than this (130 degrees).
const FOLD: f64 = 2.27;
/// Corners that are likelier than a fold turn by less than this (120 degrees).
const CORNER: f64 = 2.09;

/// Two ends through which one stroke runs.
#[derive(Clone, Copy, Debug)]
pub(in crate::graph) struct Pair {
    /// Numbers of the ends.
    pub ends: [usize; 2],
    /// How far the stroke turns, radians.
    pub turn: f64,
}

/// The arms of a node.
pub(super) struct Pairing<'a> {
    pub lines: &'a Lines,
    pub ends: &'a [Option<End>],
    pub line_width: f64,
    pub node: &'a Node,
}

impl Pairing<'_> {
    /// Which ends continue in which: least turn first. Two ends that meet alone always do, since their courses can
    /// be misread where both walks went round the corner.
    pub fn pairs(&self) -> Vec<Pair> {
        let node = self.node;
        if let Ok(ends) = <[usize; 4]>::try_from(&node.ends[..])
            && node.bodies.is_empty()
            && let Some(corners) = two_corners(ends.map(|e| self.tail(e)), node.position, self.line_width)
        {
            return corners.map(|p| Pair { ends: p.ends.map(|k| ends[k]), ..p }).to_vec();
        }
        let alone = node.bodies.is_empty() && node.ends.len() == 2;
        let mut candidates = Vec::new();
        for (i, &a) in node.ends.iter().enumerate() {
            for &b in &node.ends[..i] {
                candidates.push((self.turn(a, b), b, a));
            }
        }
        candidates.sort_by(|x, y| x.0.total_cmp(&y.0).then((x.1, x.2).cmp(&(y.1, y.2))));
        let mut pairs: Vec<Pair> = Vec::new();
        for (turn, a, b) in candidates {
            let most = match (node.bodies.is_empty(), pairs.is_empty()) {
                _ if alone => f64::INFINITY,
                _ if self.stands(&pairs, [a, b]) => LARGEST_TURN,
                // A loop that hangs on a body comes back to where it began.
                (false, _) if a / 2 == b / 2 => LARGEST_TURN,
                (false, _) => ACROSS_BODY,
                (true, true) => LARGEST_TURN,
                (true, false) => LATER_PAIR,
            };
            let taken = pairs.iter().any(|p| p.ends.iter().any(|e| [a, b].contains(e)));
            if turn <= most && !taken {
                pairs.push(Pair { ends: [a, b], turn });
            }
        }
        pairs
    }

    /// Whether two ends stand on the only line through a node as a V does: on one side of it, each as steep as the other.
    fn stands(&self, pairs: &[Pair], [a, b]: [usize; 2]) -> bool {
        let arm = |end: usize| arm_line(self.tail(end), self.node.position, self.line_width).1;
        let along = match (self.node.ends.len(), &self.node.bodies[..], pairs) {
            (2, [body], []) => self.lines.direction(*body),
            (4, [], [line]) if line.turn < STRAIGHT => arm(line.ends[0]),
            _ => return false,
        };
        let mirrored = arm(b) - along * (2.0 * arm(b).dot(along));
        angle_between(arm(a), mirrored).abs() < AS_STEEP
    }

    /// The cost of a stroke that comes in by one end and leaves by another.
    fn turn(&self, a: usize, b: usize) -> f64 {
        continuation(self.tail(a), self.tail(b), self.node.position, self.line_width)
    }

    fn tail(&self, id: usize) -> &Tail {
        &self.ends[id].as_ref().expect("a node has existing ends only").tail
    }
}

/// The two corners of four arms, by the arms' places in the list, where corners share their vertex: without them, the
/// smoothest stroke bends all the same, and leaves two arms beside each other to fold back.
pub(in crate::graph) fn two_corners(arms: [&Tail; 4], at: Point, line_width: f64) -> Option<[Pair; 2]> {
    let lines = arms.map(|arm| arm_line(arm, at, line_width));
    if lines.iter().any(|(point, heading)| heading.cross(at - *point).abs() > line_width) {
        return None;
    }
    let mut around = [0, 1, 2, 3];
    let headings = lines.map(|(_, heading)| heading);
    around.sort_by(|&a, &b| headings[a].atan2().total_cmp(&headings[b].atan2()));
    let pairing = |k: [usize; 4]| {
        let pair = |a: usize, b: usize| Pair { ends: [a, b], turn: angle_between(headings[a], -headings[b]).abs() };
        let k = k.map(|k| around[k]);
        [pair(k[0], k[1]), pair(k[2], k[3])]
    };
    let least = |[a, b]: &[Pair; 2]| a.turn.min(b.turn);
    let most = |[a, b]: &[Pair; 2]| a.turn.max(b.turn);
    let (mut folded, mut corners, across) = (pairing([0, 1, 2, 3]), pairing([1, 2, 3, 0]), pairing([0, 2, 1, 3]));
    if least(&corners) < least(&folded) {
        std::mem::swap(&mut folded, &mut corners);
    }
    let bends = least(&folded) > STRAIGHT && least(&folded) < least(&across);
    (bends && most(&folded) > FOLD && most(&corners) < CORNER).then_some(corners)
}
