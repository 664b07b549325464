//! Ends that belong together become one node; its place is solved from its arms.

use super::contacts::{Contact, Touch};
use super::free_end::free_end;
use super::pairing::{Pair, Pairing};
use crate::clean::LineImage;
use crate::graph::lines::{End, EndState, Line, Lines, Place, arm_line, continuation};
use crate::graph::point_index::PointIndex;
use crate::streamline::STEP;
use kurbo::{Point, Vec2};
use petgraph::unionfind::UnionFind;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Nodes nearer to one another than this, in line widths, are one.
const MERGE: f64 = 0.8;
/// A line's own end sticks out of a tee on that line when it lies further from it than this, in line widths.
const STICKS_OUT: f64 = 0.6;
/// Ends that run along a body towards one another meet there when they are no further apart than this, in line widths.
const ALONG_BODY: f64 = 4.0;
/// They turn by less than this (20 degrees), from the body and from one to the other.
const TANGENTIAL: f64 = 0.35;
/// Two places on one line are one, where it passes, within this many line widths along it.
const SAME_PLACE: f64 = 4.0;
/// A node lies no further from what was observed than this, in line widths and pixels, and on this much ink.
const REACH: f64 = 1.2;
const REACH_PIXELS: f64 = 0.5;
const INKED: f32 = 0.3;
/// Weight of what was observed against one arm's line, in the least squares of a node's place: it decides only where the
/// arms say nothing, as along a straight line.
const PRIOR: f64 = 0.02;
/// A line that ran into another meets it within this many line widths.
const FOLLOWED: f64 = 6.0;
/// A line shorter than this many line widths has both of its ends at one node by mistake only.
const SHORT: f64 = 3.0;

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

impl Node {
    /// Whether a single end is here, in the open.
    pub fn is_free(&self) -> bool {
        self.ends.len() == 1 && self.bodies.is_empty()
    }
}

/// Groups ends by their contacts, solves each group's place and pairs its arms. Every end is in one node.
pub(super) fn nodes(image: &LineImage, lines: &Lines, contacts: &[Contact]) -> Vec<Node> {
    let ends = lines.ends(image);
    let mut of_end = vec![Vec::new(); ends.len()];
    contacts.iter().for_each(|c| of_end[c.end].push(*c));
    let solver = Solver { image, lines, ends, of_end };
    let mut groups = UnionFind::new(ends.len());
    for contact in contacts {
        if let Touch::End(other) = contact.touch {
            groups.union(contact.end, other);
        }
    }
    let first = solver.nodes(&mut groups);
    solver.unite(&first, &mut groups);
    let mut nodes = solver.nodes(&mut groups);
    for node in &mut nodes {
        node.pairs = Pairing { lines, ends, line_width: image.line_width, node }.pairs();
    }
    nodes
}

struct Solver<'a> {
    image: &'a LineImage,
    lines: &'a Lines,
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
        let mut members: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for id in self.ends.iter().flatten().map(End::id) {
            members.entry(groups.find_mut(id)).or_default().push(id);
        }
        let groups: Vec<Vec<usize>> = members.into_values().collect();
        groups.into_par_iter().map(|ends| self.node(ends)).collect()
    }

    /// Groups that were solved to the same place are one: stems that meet on a body, a corner beside a tee.
    fn unite(&self, nodes: &[Node], groups: &mut UnionFind<usize>) {
        let line_width = self.image.line_width;
        let index = PointIndex::new(nodes.iter().map(|n| n.position).enumerate());
        for a in nodes {
            let near = index.near(a.position, ALONG_BODY * line_width).map(|b| &nodes[b]);
            for b in near.filter(|b| b.ends[0] < a.ends[0]) {
                let is_close = (a.position - b.position).hypot2() <= (MERGE * line_width).powi(2);
                let meet = if is_close { self.may_merge(a, b) } else { self.meet_along_body(a, b) };
                if meet {
                    groups.union(a.ends[0], b.ends[0]);
                }
            }
        }
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
                other.line == place.line && (other.at - place.at).abs() * STEP < SAME_PLACE * self.image.line_width
            };
            let ends_here = ends.iter().any(|&other| {
                let End { line, side, .. } = *self.end(other);
                near(&Place { line, at: self.lines[line].inwards(side, 0) as f64 })
            });
            if !ends_here && !bodies.iter().any(near) {
                bodies.push(place);
            }
        }
        bodies
    }

    /// Least squares over the lines of all arms, drawn towards the mean of the observed contacts.
    fn meeting_point(&self, ends: &[usize], bodies: &[Place], contacts: &[&Contact]) -> Point {
        let led: Vec<Point> =
            ends.iter().map(|&e| self.end(e)).filter(|e| e.state == EndState::Led).map(|e| e.point).collect();
        if !led.is_empty() {
            return mean(&led);
        }
        if let ([end], [body]) = (ends, bodies)
            && self.end(*end).state == EndState::RanIn
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
            arms.push((self.lines.point(body), self.lines.direction(body)));
        }
        let mut solved = intersect_lines(&arms, centre, PRIOR);
        if let &[body, ..] = bodies {
            let (p, d) = (self.lines.point(body), self.lines.direction(body));
            solved = p + d * (solved - p).dot(d);
        }
        let reach = REACH * self.image.line_width + REACH_PIXELS;
        let good = (solved - centre).hypot() < reach && self.image.ink.sample(solved) > INKED;
        if good { solved } else { centre }
    }

    /// Where a line that runs into another at a small angle meets it: its course is followed until it crosses or
    /// comes nearest.
    fn merge_point(&self, end: &End, body: Place) -> Point {
        let (foot, d) = (self.lines.point(body), self.lines.direction(body));
        let tail = end.tail;
        let across = d.turn_90();
        let normal = tail.heading.turn_90();
        // Distance from the body along the tail's parabola: c + b s + a s^2.
        let c = (tail.point - foot).dot(across);
        let (b, a) = (tail.heading.dot(across), 0.5 * tail.curvature * normal.dot(across));
        let disc = b * b - 4.0 * a * c;
        let s = if disc < 0.0 { -b / (2.0 * a) } else { -2.0 * c / (b + b.signum() * disc.sqrt()) };
        let reach = FOLLOWED * self.image.line_width;
        let s = if s.is_finite() { s.clamp(0.0, reach) } else { 0.0 };
        let p = tail.point + tail.heading * s + normal * (0.5 * tail.curvature * s * s);
        nearest_on(&self.lines[body.line], body, p, reach)
    }

    /// Two groups are one unless that would fold a short line onto itself.
    fn may_merge(&self, a: &Node, b: &Node) -> bool {
        let short = |e: &End| (self.lines[e.line].points.len() as f64) * STEP < SHORT * self.image.line_width;
        let sticks_out = |end: &Node, tee: &Node| {
            let on_its_body = |&e: &usize| tee.bodies.iter().any(|place| place.line == self.end(e).line);
            let far = (end.position - tee.position).hypot() > STICKS_OUT * self.image.line_width;
            far && end.is_free() && end.ends.iter().all(on_its_body)
        };
        if sticks_out(a, b) || sticks_out(b, a) {
            return false;
        }
        let folds = a.ends.iter().any(|&x| b.ends.iter().any(|&y| x / 2 == y / 2 && short(self.end(x))));
        !(folds || a.is_free() && b.is_free())
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
            let sine = self.arm(end, middle).1.cross(self.lines.direction(*body));
            sine.abs() < TANGENTIAL.sin()
        };
        along(x, p)
            && along(y, q)
            && x.tail.heading.dot(y.tail.point - x.tail.point) > 0.0
            && continuation(&x.tail, &y.tail, middle, self.image.line_width) < TANGENTIAL
    }
}

/// The point of a line nearest to `p`, among those within `reach` pixels along it from a place.
fn nearest_on(line: &Line, place: Place, p: Point, reach: f64) -> Point {
    let points = line.around(place.at, reach).map(|k| line.points[k]);
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
