//! The graph from resolved lines.

use super::lines::{End, EndState, Line, Lines, Place, end_id};
use super::point_index::PointIndex;
use super::resolve::Node;
use super::{Edge, Junction, JunctionKind, StrokeGraph, Trail};
use crate::clean::LineImage;
use crate::drawing::Color;
use crate::options::Options;
use crate::streamline::STEP;
use kurbo::Point;
use petgraph::stable_graph::{EdgeIndex, NodeIndex};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Points nearer to a node than this, in line widths, are inside the junction and do not speak for the line.
const INSIDE: f64 = 0.75;

/// A stroke that turns by less than this at a node (35 degrees) has no junction to be cut out.
const SMOOTH: f64 = 0.61;

/// Crossings at smaller angles than this sine's (8 degrees) are taken to overlap no further.
const LEAST_SINE: f64 = 0.14;

/// Parts of one line are taken for different lines when they are this many line widths apart along it.
const OWN: f64 = 4.0;
/// Lines that cross again within this many line widths graze each other, and cross once.
const AGAIN: f64 = 6.0;
/// A crossing within this many line widths of a node of both lines is that node.
const AT_NODE: f64 = 1.2;
/// A node lies no further inside a line's end than this many of its widths from where it was alone.
const INWARDS: f64 = 6.0;
/// A line that goes on through a node, or ends in the open, loses no more than the point at the node, in pixels.
const AT_POINT: f64 = 0.6 * STEP;

/// A cut of a line at a node.
#[derive(Clone, Copy, Debug)]
struct Cut {
    at: f64,
    node: NodeIndex,
}

/// Builds nodes, edges and trails.
pub(super) fn assemble(image: &LineImage, lines: &Lines, nodes: &[Node], options: &Options) -> StrokeGraph {
    let mut assembly = Assembly::new(image, lines, nodes);
    assembly.add_tees();
    assembly.add_crossings();
    let edges: Vec<Vec<EdgeIndex>> = (0..lines.len()).map(|i| assembly.add_edges(i)).collect();
    assembly.add_trails(&edges);
    assembly.drop_short(options.min_length * image.line_width);
    assembly.out
}

/// A crossing of two lines.
type Meeting = (Place, Place, Point);

struct Assembly<'a> {
    image: &'a LineImage,
    nodes: &'a [Node],
    node_of_end: Vec<Option<usize>>,
    /// Lines between their nodes, and how far their indices moved.
    lines: Lines,
    shift: Vec<f64>,
    cuts: Vec<Vec<Cut>>,
    indices: Vec<NodeIndex>,
    out: StrokeGraph,
}

impl<'a> Assembly<'a> {
    fn new(image: &'a LineImage, lines: &Lines, nodes: &'a [Node]) -> Self {
        let mut node_of_end = vec![None; 2 * lines.len()];
        for (k, node) in nodes.iter().enumerate() {
            node.ends.iter().for_each(|&e| node_of_end[e] = Some(k));
        }
        let mut out = StrokeGraph::default();
        let indices = nodes.iter().map(|n| out.graph.add_node(Junction::new(n.position, kind(n)))).collect();
        let between =
            |i: usize| between_nodes(image, lines, i, [0, 1].map(|side| Some(&nodes[node_of_end[end_id(i, side)]?])));
        let (between, shift): (Vec<Line>, Vec<f64>) = (0..lines.len()).map(between).unzip();
        let cuts = vec![Vec::new(); lines.len()];
        Self { image, nodes, node_of_end, lines: between.into(), shift, cuts, indices, out }
    }

    /// Bodies are cut where lines end at them.
    fn add_tees(&mut self) {
        for (node, &index) in self.nodes.iter().zip(&self.indices) {
            for body in &node.bodies {
                let last = self.lines[body.line].piece_count() as f64;
                let at = body.at - self.shift[body.line];
                if self.lines[body.line].closed || (at > 0.0 && at < last) {
                    self.cuts[body.line].push(Cut { at, node: index });
                }
            }
        }
    }

    /// Lines are cut where they cross, unless a node is there already.
    fn add_crossings(&mut self) {
        let mut lines = std::mem::take(&mut self.lines);
        let nodes = PointIndex::new(self.nodes.iter().map(|n| n.position).enumerate());
        let mut found: BTreeMap<(usize, usize), Vec<Meeting>> = BTreeMap::new();
        let crossed = |i: usize| self.crossed(&lines, i);
        let crossed: Vec<Meeting> = (0..lines.len()).into_par_iter().flat_map_iter(crossed).collect();
        for (here, place, point) in crossed {
            let known = found.entry((here.line, place.line)).or_default();
            if !self.is_again(known, here, place) && !self.is_at_node(&nodes, here, place, point) {
                known.push((here, place, point));
            }
        }
        for (a, b, position) in found.into_values().flatten() {
            let sine = lines.direction(a).cross(lines.direction(b)).abs();
            // Up to here the inks of the two lines overlap, and a cross profile shows their union.
            let overlap = self.image.line_width / sine.max(LEAST_SINE);
            let node = self.out.graph.add_node(Junction::new(position, JunctionKind::Crossing));
            for place in [a, b] {
                blank(&mut lines.edit()[place.line], place.at, overlap);
                self.cuts[place.line].push(Cut { at: place.at, node });
            }
        }
        self.lines = lines;
    }

    /// Where a line crosses itself and those after it, along the line.
    fn crossed(&self, lines: &Lines, i: usize) -> Vec<Meeting> {
        let mut crossed = Vec::new();
        let line = &lines[i];
        for k in 0..line.piece_count() {
            for (place, point, t) in lines.crossings(line.piece(k)) {
                let here = Place { line: i, at: k as f64 + t };
                if self.is_crossing(lines, here, place) {
                    crossed.push((here, place, point));
                }
            }
        }
        crossed
    }

    /// Each pair once; on one line only between parts that are far apart along it.
    fn is_crossing(&self, lines: &Lines, a: Place, b: Place) -> bool {
        if a.line != b.line {
            return a.line < b.line;
        }
        let apart = (b.at - a.at).abs();
        let apart = if lines[a.line].closed { apart.min(lines[a.line].points.len() as f64 - apart) } else { apart };
        a.at < b.at && apart * STEP > OWN * self.image.line_width
    }

    /// Whether a pair of lines crosses again right after a crossing: lines that graze each other.
    fn is_again(&self, known: &[Meeting], a: Place, b: Place) -> bool {
        let near = |p: Place, q: Place| (p.at - q.at).abs() * STEP < AGAIN * self.image.line_width;
        known.iter().rev().any(|(c, d, _)| near(*c, a) && near(*d, b))
    }

    /// Whether both lines share a node here.
    fn is_at_node(&self, nodes: &PointIndex, a: Place, b: Place, point: Point) -> bool {
        nodes.near(point, AT_NODE * self.image.line_width).any(|near| {
            let n = &self.nodes[near];
            let has = |line: usize| n.bodies.iter().any(|p| p.line == line) || n.ends.iter().any(|e| e / 2 == line);
            has(a.line) && has(b.line)
        })
    }

    /// The edges of one line, in order.
    fn add_edges(&mut self, i: usize) -> Vec<EdgeIndex> {
        let line = self.lines[i].clone();
        let mut cuts = std::mem::take(&mut self.cuts[i]);
        let last = line.piece_count() as f64;
        if line.closed {
            if cuts.is_empty() {
                let seam = Junction::new(line.points[0], JunctionKind::Seam);
                cuts.push(Cut { at: 0.0, node: self.out.graph.add_node(seam) });
            }
            cuts.sort_by(|a, b| a.at.total_cmp(&b.at));
            let first = cuts[0];
            cuts.push(Cut { at: first.at + last, node: first.node });
        } else {
            for (side, at) in [(0, 0.0), (1, last)] {
                let node = self.node_of_end[end_id(i, side)].expect("every open line has two nodes");
                cuts.push(Cut { at, node: self.indices[node] });
            }
            cuts.sort_by(|a, b| a.at.total_cmp(&b.at));
        }
        let pieces = cuts.windows(2);
        pieces
            .map(|pair| self.out.graph.add_edge(pair[0].node, pair[1].node, self.edge(&line, pair[0], pair[1])))
            .collect()
    }

    fn edge(&self, line: &Line, from: Cut, to: Cut) -> Edge {
        let n = line.points.len();
        let position = |cut: Cut| self.out.graph[cut.node].position;
        let (mut points, mut widths) = (vec![position(from)], vec![f64::NAN]);
        let (first, end) = (from.at.floor() as usize + 1, to.at.ceil() as usize);
        for k in first..end {
            points.push(line.points[k % n]);
            widths.push(line.widths[k % n]);
        }
        points.push(position(to));
        widths.push(f64::NAN);
        let hidden = points.iter().map(|&p| self.image.noise.at(p).hidden()).sum::<f64>();
        let noise = self.image.scale * hidden / points.len() as f64;
        Edge { points, widths, noise }
    }

    /// Lines are chained through paired ends; every line is in one trail.
    fn add_trails(&mut self, edges: &[Vec<EdgeIndex>]) {
        let mut partner = vec![None; 2 * edges.len()];
        for [a, b] in self.nodes.iter().flat_map(|n| &n.pairs).map(|p| p.ends) {
            (partner[a], partner[b]) = (Some(b), Some(a));
        }
        let mut used = vec![false; edges.len()];
        // Open chains start at an end without a partner; what is left over is closed.
        let starts = (0..partner.len()).filter(|&e| partner[e].is_none()).chain(0..partner.len());
        for start in starts {
            if used[start / 2] {
                continue;
            }
            let closed = self.lines[start / 2].closed;
            let mut trail = Trail { edges: Vec::new(), closed, color: Color::BLACK, dashes: None };
            let mut entry = start;
            loop {
                let (line, side) = (entry / 2, entry % 2);
                used[line] = true;
                if side == 0 {
                    trail.edges.extend(edges[line].iter().map(|&e| (e, false)));
                } else {
                    trail.edges.extend(edges[line].iter().rev().map(|&e| (e, true)));
                }
                match partner[end_id(line, 1 - side)] {
                    Some(next) if next == start => {
                        trail.closed = true;
                        break;
                    }
                    Some(next) if !used[next / 2] => entry = next,
                    _ => break,
                }
            }
            self.out.trails.push(trail);
        }
    }

    /// Drops strokes shorter than `least` that have a free end, and what is left of lines that were cut within a node.
    fn drop_short(&mut self, least: f64) {
        let line_width = self.image.line_width;
        let graph = &mut self.out.graph;
        let mut trails = std::mem::take(&mut self.out.trails);
        trails.retain(|trail| {
            let length: f64 = trail.edges.iter().map(|(e, _)| length(&graph[*e].points)).sum();
            let mut ends = trail.edges.iter().filter_map(|(e, _)| graph.edge_endpoints(*e));
            let within = length < line_width && ends.clone().all(|(a, b)| a == b);
            let free = ends.any(|(a, b)| [a, b].iter().any(|&n| graph[n].kind == JunctionKind::FreeEnd));
            let keep = (length >= least || !free) && !within;
            if !keep {
                trail.edges.iter().for_each(|(e, _)| drop(graph.remove_edge(*e)));
            }
            keep
        });
        graph.retain_nodes(|graph, n| graph.neighbors_undirected(n).next().is_some());
        self.out.trails = trails;
    }
}

/// What meets at a node.
fn kind(node: &Node) -> JunctionKind {
    match (node.ends.len(), node.bodies.is_empty()) {
        (_, false) => JunctionKind::Tee,
        (1, true) => JunctionKind::FreeEnd,
        (2, true) => JunctionKind::Corner,
        _ => JunctionKind::Branch,
    }
}

/// Forgets the widths of a line within `reach` pixels along it from a place: there they tell of another line too.
fn blank(line: &mut Line, at: f64, reach: f64) {
    line.around(at, reach).for_each(|k| line.widths[k] = f64::NAN);
}

fn length(points: &[Point]) -> f64 {
    points.windows(2).map(|w| (w[1] - w[0]).hypot()).sum()
}

/// A line between its nodes: what lies beyond a node or inside its junction is cut off and the node is put in
/// its place. Also returns how much indices moved.
fn between_nodes(image: &LineImage, lines: &Lines, i: usize, nodes: [Option<&Node>; 2]) -> (Line, f64) {
    let (line, ends) = (&lines[i], lines.ends(image));
    let ([Some(first), Some(last)], [Some(a), Some(b)]) = (nodes, [0, 1].map(|side| ends[end_id(i, side)].as_ref()))
    else {
        return (line.clone(), 0.0);
    };
    let from = cut_off(image, line, a, first);
    let to = (line.points.len() - 1).saturating_sub(cut_off(image, line, b, last));
    let (mut points, mut widths) = (vec![first.position], vec![f64::NAN]);
    if to >= from {
        points.extend(&line.points[from..=to]);
        widths.extend(&line.widths[from..=to]);
    }
    points.push(last.position);
    widths.push(f64::NAN);
    (Line { points, widths, closed: false, ends: line.ends }, from as f64 - 1.0)
}

/// How many points at an end are to go: those beyond the node, and those inside its junction.
fn cut_off(image: &LineImage, line: &Line, end: &End, node: &Node) -> usize {
    if node.is_free() && end.state == EndState::CutOff {
        return 1;
    }
    // The place on the last stretch that comes nearest to the node.
    let last = line.points.len() - 1;
    let stretch = (line.inwards(end.side, end.tip) + (INWARDS * end.width / STEP) as usize).min(last);
    let distance = |k: usize| (line.at_end(end.side, k) - node.position).hypot();
    let nearest = (0..=stretch).min_by(|&a, &b| distance(a).total_cmp(&distance(b))).unwrap_or(0);
    let runs_on = node.pairs.iter().any(|p| p.ends.contains(&end.id()) && p.turn < SMOOTH);
    // Where a walk took another line's arm, its last points belong to neither.
    let radius = if end.state == EndState::Parted {
        image.line_width
    } else if node.is_free() || runs_on {
        AT_POINT
    } else {
        INSIDE * image.line_width
    };
    (nearest..last).find(|&k| distance(k) >= radius).unwrap_or(last)
}
