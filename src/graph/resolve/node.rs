//! Ends that belong together become one node; its place is solved from its arms.

use crate::clean::{LineImage, unblurred_width};
use crate::graph::lines::end::{End, end_id};
use crate::graph::point_index::PointIndex;
use crate::graph::resolve::contacts::{Contact, Place, Touch, around, direction, point_at};
use crate::profile::sharp_edge;
use crate::streamline::{STEP, Stop, Streamline, Tail, angle_between};
use kurbo::{Point, Vec2};
use petgraph::unionfind::UnionFind;
use rayon::prelude::*;

/// Nodes nearer to one another than this, in line widths, are one.
const MERGE: f64 = 0.8;
/// A line's own end sticks out of a tee on that line when it lies further from it than this, in line widths.
const STICKS_OUT: f64 = 0.6;
/// Ends that run along a body towards one another meet there when they are no further apart than this, in line widths.
const ALONG_BODY: f64 = 4.0;
/// They turn by less than this (20 degrees), from the body and from one to the other.
const TANGENTIAL: f64 = 0.35;
/// Ends on a body pair up across it when the stroke turns by less than this (35 degrees).
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
    pub ends: [usize; 2],
    /// How far the stroke turns, radians.
    pub turn: f64,
}

/// Standard deviation of what pixels blur by themselves, in pixels of the scan: that of a square of one pixel. Where an
/// edge is told by area, the interpolation of pixels across the cap counts too.
const PIXEL: f64 = 0.29;
const PIXEL_BY_AREA: f64 = 0.65;
/// Ink that is a line behind a gap.
const BEHIND_GAP: f32 = 0.9;
/// How far past the last point of a walk its ink may go on, in pixels.
const LOOK_AHEAD: f64 = 2.5;
/// A jump in curvature counts as the turn that it makes over this many line widths.
const CURVATURE_SPAN: f64 = 3.0;

/// A node at which at least one line ends.
#[derive(Clone, Debug)]
pub(in crate::graph) struct Node {
    pub position: Point,
    /// Numbers of the ends.
    pub ends: Vec<usize>,
    /// Lines that pass through.
    pub bodies: Vec<Place>,
    /// Ends that belong to one stroke.
    pub pairs: Vec<Pair>,
}

/// Groups ends by their contacts and solves each group's place.
pub(in crate::graph) fn resolve(
    image: &LineImage,
    lines: &[Streamline],
    ends: &[Option<End>],
    contacts: &[Contact],
) -> Vec<Node> {
    let mut of_end = vec![Vec::new(); ends.len()];
    contacts.iter().for_each(|c| of_end[c.end].push(*c));
    let solver = Solver { image, lines, ends, of_end };
    let mut groups = UnionFind::new(ends.len());
    for contact in contacts {
        if let Touch::End(other) = contact.touch {
            groups.union(contact.end, other);
        }
    }
    let first: Vec<Node> = solver.nodes(&mut groups);
    // Groups that were solved to the same place are one: stems that meet on a body, a corner beside a tee.
    let index = PointIndex::new(first.iter().map(|n| n.position).enumerate());
    for a in &first {
        for b in index.near(a.position, ALONG_BODY * image.line_width).map(|b| &first[b]) {
            if b.ends[0] >= a.ends[0] {
                continue;
            }
            let is_close = (a.position - b.position).hypot2() <= (MERGE * image.line_width).powi(2);
            let meet = if is_close { solver.may_merge(a, b) } else { solver.meet_along_body(a, b) };
            if meet {
                groups.union(a.ends[0], b.ends[0]);
            }
        }
    }
    let mut nodes = solver.nodes(&mut groups);
    for node in &mut nodes {
        node.pairs = solver.pairs(node);
    }
    nodes
}

struct Solver<'a> {
    image: &'a LineImage,
    lines: &'a [Streamline],
    ends: &'a [Option<End>],
    /// The contacts of each end.
    of_end: Vec<Vec<Contact>>,
}

impl Solver<'_> {
    fn end(&self, id: usize) -> &End {
        self.ends[id].as_ref().expect("numbers of existing ends only")
    }

    /// An end's line as it passes a point, straight.
    fn arm(&self, end: &End, at: Point) -> (Point, Vec2) {
        arm_line(&end.tail, at, self.image.line_width)
    }

    fn nodes(&self, groups: &mut UnionFind<usize>) -> Vec<Node> {
        let mut members: std::collections::BTreeMap<usize, Vec<usize>> = std::collections::BTreeMap::new();
        for end in self.ends.iter().flatten() {
            let id = end_id(end.line, end.side);
            members.entry(groups.find_mut(id)).or_default().push(id);
        }
        let groups: Vec<Vec<usize>> = members.into_values().collect();
        groups.into_par_iter().map(|ends| self.node(ends)).collect()
    }

    fn node(&self, ends: Vec<usize>) -> Node {
        let contacts: Vec<&Contact> = ends.iter().flat_map(|&e| &self.of_end[e]).collect();
        let bodies = self.bodies(&ends, &contacts);
        let position = if contacts.is_empty() && ends.len() == 1 {
            free_end(self.image, self.lines, self.end(ends[0]))
        } else {
            self.meeting_point(&ends, &bodies, &contacts)
        };
        Node { position, ends, bodies, pairs: Vec::new() }
    }

    /// The bodies that a group's ends stop at: per end the most plausible one, each line once, and not a line
    /// that itself ends here.
    fn bodies(&self, ends: &[usize], contacts: &[&Contact]) -> Vec<Place> {
        let mut bodies: Vec<Place> = Vec::new();
        for &id in ends {
            let of_end = contacts.iter().filter(|c| c.end == id);
            let to_body = of_end.filter_map(|c| match c.touch {
                Touch::Body(place) => Some((c.misfit, place)),
                Touch::End(_) => None,
            });
            let Some((_, place)) = to_body.min_by(|a, b| a.0.total_cmp(&b.0)) else { continue };
            let near = |other: &Place| {
                other.line == place.line && (other.at - place.at).abs() * STEP < 4.0 * self.image.line_width
            };
            let ends_here = ends.iter().any(|&other| {
                let n = self.lines[self.end(other).line].points.len() as f64;
                let at = if self.end(other).side == 0 { 0.0 } else { n - 1.0 };
                near(&Place { line: self.end(other).line, at })
            });
            if !ends_here && !bodies.iter().any(near) {
                bodies.push(place);
            }
        }
        bodies
    }

    /// Least squares over the lines of all arms, drawn towards the mean of the observed contacts.
    fn meeting_point(&self, ends: &[usize], bodies: &[Place], contacts: &[&Contact]) -> Point {
        let joined: Vec<Point> =
            ends.iter().map(|&e| self.end(e)).filter(|e| e.stop == Stop::Joined).map(|e| e.point).collect();
        if !joined.is_empty() {
            return mean(&joined);
        }
        if let ([end], [body]) = (ends, bodies)
            && self.end(*end).stop == Stop::Merged
        {
            return self.merge_point(self.end(*end), *body);
        }
        let observed: Vec<Point> = if contacts.is_empty() {
            ends.iter().map(|&e| free_end(self.image, self.lines, self.end(e))).collect()
        } else {
            contacts.iter().map(|c| c.point).collect()
        };
        let centre = mean(&observed);
        let mut arms: Vec<(Point, Vec2)> = ends.iter().map(|&e| self.arm(self.end(e), centre)).collect();
        for &body in bodies {
            arms.push((point_at(&self.lines[body.line], body.at), direction(self.lines, body)));
        }
        let mut solved = intersect_lines(&arms, centre, 0.02);
        if let [body, ..] = bodies {
            let (p, d) = (point_at(&self.lines[body.line], body.at), direction(self.lines, *body));
            solved = p + d * (solved - p).dot(d);
        }
        let reach = 1.2 * self.image.line_width + 0.5;
        let good = (solved - centre).hypot() < reach && self.image.ink.sample(solved) > 0.3;
        if good { solved } else { centre }
    }

    /// Where a line that runs into another at a small angle meets it: its course is followed until it crosses or
    /// comes nearest.
    fn merge_point(&self, end: &End, body: Place) -> Point {
        let (foot, d) = (point_at(&self.lines[body.line], body.at), direction(self.lines, body));
        let tail = end.tail;
        let across = d.turn_90();
        let normal = tail.heading.turn_90();
        // Distance from the body along the tail's parabola: c + b s + a s^2.
        let c = (tail.point - foot).dot(across);
        let (b, a) = (tail.heading.dot(across), 0.5 * tail.curvature * normal.dot(across));
        let disc = b * b - 4.0 * a * c;
        let s = if disc < 0.0 { -b / (2.0 * a) } else { -2.0 * c / (b + b.signum() * disc.sqrt()) };
        let reach = 6.0 * self.image.line_width;
        let s = if s.is_finite() { s.clamp(0.0, reach) } else { 0.0 };
        let p = tail.point + tail.heading * s + normal * (0.5 * tail.curvature * s * s);
        nearest_on(&self.lines[body.line], body, p, reach)
    }

    /// Two groups are one unless that would fold a short line onto itself.
    fn may_merge(&self, a: &Node, b: &Node) -> bool {
        let short = |e: &End| (self.lines[e.line].points.len() as f64) * STEP < 3.0 * self.image.line_width;
        let touches_ink = |n: &Node| n.ends.len() > 1 || !n.bodies.is_empty();
        let sticks_out = |end: &Node, tee: &Node| {
            let on_its_body = |&e: &usize| tee.bodies.iter().any(|place| place.line == self.end(e).line);
            let far = (end.position - tee.position).hypot() > STICKS_OUT * self.image.line_width;
            far && end.ends.len() == 1 && end.bodies.is_empty() && end.ends.iter().all(on_its_body)
        };
        if sticks_out(a, b) || sticks_out(b, a) {
            return false;
        }
        let folds = a.ends.iter().any(|&x| b.ends.iter().any(|&y| x / 2 == y / 2 && short(self.end(x))));
        !folds && (touches_ink(a) || touches_ink(b))
    }

    /// Whether one stroke runs by two tees on one body that it touches, as a circle does a tangent.
    fn meet_along_body(&self, a: &Node, b: &Node) -> bool {
        let ([x], [y], [p], [q]) = (&a.ends[..], &b.ends[..], &a.bodies[..], &b.bodies[..]) else { return false };
        if p.line != q.line {
            return false;
        }
        let (x, y) = (self.end(*x), self.end(*y));
        let middle = a.position.midpoint(b.position);
        let along = |end: &End, body: &Place| {
            let sine = self.arm(end, middle).1.cross(direction(self.lines, *body));
            sine.abs() < TANGENTIAL.sin()
        };
        along(x, p)
            && along(y, q)
            && x.tail.heading.dot(y.tail.point - x.tail.point) > 0.0
            && continuation(&x.tail, &y.tail, middle, self.image.line_width) < TANGENTIAL
    }

    /// Which ends continue in which: least turn first. Two ends that meet alone always do, since their courses can
    /// be misread where both walks went round the corner.
    fn pairs(&self, node: &Node) -> Vec<Pair> {
        if let Ok(ends) = <[usize; 4]>::try_from(&node.ends[..])
            && node.bodies.is_empty()
            && let Some(corners) = two_corners(ends.map(|e| &self.end(e).tail), node.position, self.image.line_width)
        {
            return corners.map(|p| Pair { ends: p.ends.map(|k| ends[k]), ..p }).to_vec();
        }
        let alone = node.bodies.is_empty() && node.ends.len() == 2;
        let mut candidates = Vec::new();
        for (i, &a) in node.ends.iter().enumerate() {
            for &b in &node.ends[..i] {
                candidates.push((self.turn(a, b, node.position), b, a));
            }
        }
        candidates.sort_by(|x, y| x.0.total_cmp(&y.0).then((x.1, x.2).cmp(&(y.1, y.2))));
        let mut pairs: Vec<Pair> = Vec::new();
        for (turn, a, b) in candidates {
            let most = match (node.bodies.is_empty(), pairs.is_empty()) {
                _ if alone => f64::INFINITY,
                _ if self.stands(node, &pairs, [a, b]) => LARGEST_TURN,
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
    fn stands(&self, node: &Node, pairs: &[Pair], [a, b]: [usize; 2]) -> bool {
        let arm = |end: usize| self.arm(self.end(end), node.position).1;
        let along = match (node.ends.len(), &node.bodies[..], pairs) {
            (2, [body], []) => direction(self.lines, *body),
            (4, [], [line]) if line.turn < STRAIGHT => arm(line.ends[0]),
            _ => return false,
        };
        let mirrored = arm(b) - along * (2.0 * arm(b).dot(along));
        angle_between(arm(a), mirrored).abs() < AS_STEEP
    }

    /// The cost of a stroke that comes in by one end and leaves by another.
    fn turn(&self, a: usize, b: usize, at: Point) -> f64 {
        continuation(&self.end(a).tail, &self.end(b).tail, at, self.image.line_width)
    }
}

/// The end of the pen's path: half a line width short of the end of the ink.
pub(in crate::graph) fn free_end(image: &LineImage, lines: &[Streamline], end: &End) -> Point {
    let n = lines[end.line].points.len();
    let at = |k: usize| lines[end.line].points[if end.side == 0 { k } else { n - 1 - k }];
    let d = at(0) - at((n - 1).min(3));
    let heading = if d.hypot() > 1e-9 { d.normalize() } else { end.tail.heading };
    if end.stop.is_cut_off() {
        return end.point;
    }
    let ink = |s: f64| image.ink.sample(end.point + heading * s);
    let (edge, pixel) = edge_ahead(ink, end.width);
    let width = unblurred_width(end.width, image.blur);
    let drawn_in = blurred_cap(image.blur.max(pixel * image.scale), width);
    // Never past the middle of a short line.
    let half_length = 0.5 * (n as f64 - 1.0) * STEP;
    end.point + heading * (edge + drawn_in - 0.5 * width).max(-half_length + 0.25)
}

/// How far inside the edge of a round cap half of the ink is left under a blur of variance `v`: `v / w` to second order
/// for a pen of width `w`, less where the blur is as wide as the pen.
fn blurred_cap(blur: f64, width: f64) -> f64 {
    let (variance, width) = (blur.powi(2), width.max(1.0));
    variance / (width + 8.0 * variance / width)
}

/// Where the ink of an end `width` wide stops ahead of it, and how much the pixels blur the cap there, as a standard
/// deviation in pixels of the scan.
fn edge_ahead(ink: impl Fn(f64) -> f32, width: f64) -> (f64, f64) {
    let step = 0.125;
    let steps = ((width + LOOK_AHEAD) / step) as usize;
    let mut along = (0..steps).map(|k| step * k as f64 - width);
    match along.find(|&s| ink(s) < 0.5) {
        Some(s) => sharp_edge(&ink, s - 0.5 * step, 1.0).map_or((s, PIXEL), |edge| (edge, PIXEL_BY_AREA)),
        None => near_side_of_gap(ink),
    }
}

/// The same where another line lies so near behind the end that no paper shows between: the missing ink around the
/// lightest place is that of a gap of the same area and middle. Where it is not seen how the ink goes on behind it, half
/// of what is missing lies before the lightest place.
fn near_side_of_gap(ink: impl Fn(f64) -> f32) -> (f64, f64) {
    let (step, reach) = (0.125, 12);
    let along = (0..=20).map(|k| step * f64::from(k));
    let lightest = along.min_by(|&a, &b| ink(a).total_cmp(&ink(b))).unwrap_or(0.0);
    let around = (-reach..=reach).map(|k| lightest + step * f64::from(k));
    let missing = around.map(|s| (s, f64::from(1.0 - ink(s).min(1.0))));
    let (area, moment) = missing.fold((0.0, 0.0), |(area, moment), (s, m)| (area + m, moment + s * m));
    if area > 0.0 && ink(lightest + step * f64::from(reach)) > BEHIND_GAP {
        (moment / area - 0.5 * step * area, PIXEL_BY_AREA)
    } else {
        (lightest - 0.5 * step * area, PIXEL)
    }
}

/// An arm as a straight line: its course, bent by its curvature up to where it passes a point.
pub(in crate::graph) fn arm_line(tail: &Tail, towards: Point, line_width: f64) -> (Point, Vec2) {
    let normal = tail.heading.turn_90();
    let s = (towards - tail.point).dot(tail.heading).clamp(0.0, 5.0 * line_width);
    let point = tail.point + tail.heading * s + normal * (0.5 * tail.curvature * s * s);
    let d = tail.heading + normal * (tail.curvature * s);
    (point, d.normalize())
}

/// How badly one arm of a node continues another, both heading into it, in radians: the turn between them, and
/// the jump in curvature over a couple of line widths.
pub(in crate::graph) fn continuation(a: &Tail, b: &Tail, at: Point, line_width: f64) -> f64 {
    let (_, into) = arm_line(a, at, line_width);
    let (_, out) = arm_line(b, at, line_width);
    let jump = (CURVATURE_SPAN * line_width * (a.curvature + b.curvature)).abs().min(0.25);
    angle_between(into, -out).abs() + jump
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

/// The point of a line nearest to `p`, among those within `reach` pixels along it from a place.
fn nearest_on(line: &Streamline, place: Place, p: Point, reach: f64) -> Point {
    let points = around(line, place.at, reach).map(|k| line.points[k]);
    points.min_by(|a, b| (*a - p).hypot2().total_cmp(&(*b - p).hypot2())).unwrap_or(p)
}

fn mean(points: &[Point]) -> Point {
    let sum = points.iter().fold(Vec2::ZERO, |s, p| s + p.to_vec2());
    (sum / points.len().max(1) as f64).to_point()
}

/// The point with the least sum of squared distances to lines given by a point and a unit direction, drawn
/// towards `centre` with weight `prior`.
fn intersect_lines(lines: &[(Point, Vec2)], centre: Point, prior: f64) -> Point {
    let (mut a, mut b, mut c, mut r) = (prior, 0.0, prior, Vec2::ZERO);
    for (p, d) in lines {
        let n = d.turn_90();
        let distance = n.dot(*p - centre);
        (a, b, c) = (a + n.x * n.x, b + n.x * n.y, c + n.y * n.y);
        r += n * distance;
    }
    let det = a * c - b * b;
    if det.abs() < 1e-12 {
        return centre;
    }
    centre + Vec2::new(c * r.x - b * r.y, a * r.y - b * r.x) / det
}
