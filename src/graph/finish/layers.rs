//! Fine lines laid over broad ones that were traced apart from them.
//!
//! Where a fine line runs under a broad one its ink cannot be seen. What comes out on the other side as it went in is one
//! line that crosses; what ends at the broad line's edge is drawn out to its middle, as a pen would have been.

use super::ends::{FreeEnd, chains, facing, free_ends, index_of, retain_first};
use crate::clean::RIM;
use crate::drawing::Dashes;
use crate::graph::lines::{EndState, Line, Lines, Place};
use crate::graph::{Edge, Junction, JunctionKind, StrokeGraph, Trail, pens};
use crate::streamline::STEP;
use kurbo::{Affine, Line as Segment, Point};
use petgraph::stable_graph::{EdgeIndex, NodeIndex};
use std::collections::BTreeMap;

/// An end lies at a broad line's edge if it is no further from its rim than this many fine line widths.
const AT_EDGE: f64 = 2.0;
/// So many of its widths before the edge of a broad line, a fine one is drawn towards the other's ink.
const DRAWN: f64 = 2.0;
/// So many widths of a broad line lie at most between where a fine line goes under it and its middle, or, twice that,
/// where it comes out.
const UNDER: f64 = 1.6;

/// Joins the graph of a page's fine lines and that of its broad ones, whose image may have another scale.
pub(crate) fn join(mut fine: StrokeGraph, mut broad: StrokeGraph) -> StrokeGraph {
    pens::share(&mut fine, &broad);
    let factor = fine.page.scale / broad.page.scale;
    scale(&mut broad, factor);
    let edges: Vec<EdgeIndex> = broad.graph.edge_indices().collect();
    let lines: Lines = edges.iter().map(|&e| open_line(&broad.graph[e])).collect::<Vec<_>>().into();
    let mut out = StrokeGraph { page: fine.page, ..StrokeGraph::default() };
    let meetings = Meetings::of(&fine, &lines, broad.page.line_width, &mut out);
    let cuts = |line: usize| meetings.on_broad.get(&line).map_or(&[][..], |cuts| cuts);
    let of_broad = (0..lines.len()).map(|k| (edges[k], cuts(k))).collect();
    let of_fine = meetings.on_fine.iter().map(|(&edge, cuts)| (edge, &cuts[..])).collect();
    let broad_trails = copy(&broad, &BTreeMap::new(), &of_broad, &mut out);
    let fine_trails = copy(&fine, &meetings.nodes, &of_fine, &mut out);
    out.trails =
        chains(fine_trails.len(), &meetings.partner).iter().map(|chain| chained(&fine_trails, chain)).collect();
    out.trails.extend(broad_trails);
    out.dots = [fine.dots, broad.dots].concat();
    out.fills = [fine.fills, broad.fills].concat();
    out
}

/// Multiplies all lengths but the page's.
fn scale(graph: &mut StrokeGraph, factor: f64) {
    let scaled = |p: Point| (p.to_vec2() * factor).to_point();
    graph.page.line_width *= factor;
    graph.graph.node_weights_mut().for_each(|node| node.position = scaled(node.position));
    for edge in graph.graph.edge_weights_mut() {
        edge.points.iter_mut().for_each(|p| *p = scaled(*p));
        edge.widths.iter_mut().for_each(|w| *w *= factor);
        edge.noise *= factor;
    }
    for Dashes { dash, gap, offset } in graph.trails.iter_mut().filter_map(|trail| trail.dashes.as_mut()) {
        [dash, gap, offset].into_iter().for_each(|length| *length *= factor);
    }
    for dot in &mut graph.dots {
        (dot.centre, dot.diameter) = (scaled(dot.centre), dot.diameter * factor);
    }
    graph.fills.iter_mut().for_each(|fill| fill.outline.apply_affine(Affine::scale(factor)));
}

fn open_line(edge: &Edge) -> Line {
    let Edge { points, widths, .. } = edge.clone();
    Line { points, widths, closed: false, ends: [EndState::Open; 2] }
}

/// A node on an edge, at a fractional index of the edge's points.
#[derive(Clone, Copy)]
struct Cut {
    at: f64,
    node: NodeIndex,
}

/// Where fine lines meet broad ones.
struct Meetings {
    /// New nodes in place of fine lines' ends.
    nodes: BTreeMap<NodeIndex, NodeIndex>,
    /// New nodes on fine edges, and on broad ones by their number.
    on_fine: BTreeMap<EdgeIndex, Vec<Cut>>,
    on_broad: BTreeMap<usize, Vec<Cut>>,
    /// For each end of a fine stroke the other end of what lies under a broad line, and the number of that meeting.
    partner: Vec<Option<(usize, usize)>>,
}

impl Meetings {
    fn of(fine: &StrokeGraph, broad: &Lines, broad_width: f64, out: &mut StrokeGraph) -> Self {
        let finder = Finder { fine, broad, broad_width, ends: free_ends(fine) };
        let mut found = Self {
            nodes: BTreeMap::new(),
            on_fine: BTreeMap::new(),
            on_broad: BTreeMap::new(),
            partner: vec![None; finder.ends.len()],
        };
        let at_edge: Vec<(usize, f64)> =
            (0..finder.ends.len()).filter_map(|end| Some((end, finder.body(end)?))).collect();
        for (number, ([a, b], place, point)) in finder.passages(&at_edge).into_iter().enumerate() {
            let node = found.add(out, JunctionKind::Crossing, place, point);
            (found.partner[a], found.partner[b]) = (Some((b, number)), Some((a, number)));
            found.nodes.extend([a, b].into_iter().flat_map(|end| &finder.ends[end]).map(|end| (end.node, node)));
        }
        for (end, width) in at_edge {
            if found.partner[end].is_none()
                && let Some(end) = &finder.ends[end]
                && let Some((place, point)) = finder.foot(end, width)
            {
                let node = found.add(out, JunctionKind::Tee, place, point);
                found.nodes.insert(end.node, node);
            }
        }
        for (edge, at, place, point) in finder.crossings() {
            let node = found.add(out, JunctionKind::Crossing, place, point);
            found.on_fine.entry(edge).or_default().push(Cut { at, node });
        }
        found
    }

    /// A new node on a broad line.
    fn add(&mut self, out: &mut StrokeGraph, kind: JunctionKind, place: Place, point: Point) -> NodeIndex {
        let node = out.graph.add_node(Junction::new(point, kind));
        self.on_broad.entry(place.line).or_default().push(Cut { at: place.at, node });
        node
    }
}

struct Finder<'a> {
    fine: &'a StrokeGraph,
    broad: &'a Lines,
    broad_width: f64,
    /// Two for each fine stroke; `None` where that is not in the open.
    ends: Vec<Option<FreeEnd>>,
}

impl Finder<'_> {
    /// The width of the broad line at whose edge an end lies.
    fn body(&self, end: usize) -> Option<f64> {
        let p = self.ends[end].as_ref()?.point;
        let slack = AT_EDGE * self.fine.page.line_width + RIM;
        let near = self.broad.near(p, 2.0 * self.broad_width + slack).into_iter();
        let widths = near.map(|(place, _, distance)| (self.broad.width(place, self.broad_width), distance));
        widths.filter(|(width, distance)| *distance <= 0.5 * width + slack).map(|(width, _)| width).next()
    }

    /// Where a line from one point to another first crosses a broad one.
    fn first_crossing(&self, way: Segment) -> Option<(Place, Point)> {
        let crossings = self.broad.crossings(way).into_iter();
        crossings.min_by(|a, b| a.2.total_cmp(&b.2)).map(|(place, point, _)| (place, point))
    }

    /// Where an end at the edge of a broad line of some width, drawn out, comes to its middle.
    fn foot(&self, end: &FreeEnd, width: f64) -> Option<(Place, Point)> {
        self.first_crossing(Segment::new(end.aim, end.aim + end.course.heading * (UNDER * width)))
    }

    /// Pairs of ends at the edges of broad lines, given with their widths, where one line goes under and comes out, the best
    /// first, and where it crosses the middle.
    fn passages(&self, at_edge: &[(usize, f64)]) -> Vec<([usize; 2], Place, Point)> {
        let index = index_of(&self.ends, at_edge.iter().map(|&(end, _)| end));
        let mut found = Vec::new();
        for &(i, width) in at_edge {
            let Some(a) = &self.ends[i] else { continue };
            for j in index.near(a.point, 2.0 * UNDER * width).filter(|&j| j > i) {
                if let Some(b) = &self.ends[j]
                    && let Some(misfit) = facing(self.fine, &self.ends, [i, j])
                    && let Some((place, point)) = self.first_crossing(Segment::new(a.aim, b.aim))
                {
                    found.push(((b.point - a.point).hypot() + misfit, [i, j], place, point));
                }
            }
        }
        found.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        retain_first(&mut found, self.ends.len(), |found| found.1);
        found.into_iter().map(|(_, ends, place, point)| (ends, place, point)).collect()
    }

    /// Where fine lines that were followed under broad ones cross their middle, once each time.
    fn crossings(&self) -> Vec<(EdgeIndex, f64, Place, Point)> {
        let mut found: Vec<(EdgeIndex, f64, Place, Point)> = Vec::new();
        for edge in self.fine.graph.edge_indices() {
            let points = &self.fine.graph[edge].points;
            for (k, pair) in points.windows(2).enumerate() {
                for (place, point, t) in self.broad.crossings(Segment::new(pair[0], pair[1])) {
                    let at = k as f64 + t;
                    let again = |&(e, before, other, _): &(EdgeIndex, f64, Place, Point)| {
                        e == edge && other.line == place.line && (at - before) * STEP < UNDER * self.broad_width
                    };
                    if !found.iter().rev().take_while(|found| found.0 == edge).any(again) {
                        found.push((edge, at, place, point));
                    }
                }
            }
        }
        found
    }
}

/// Adds a graph's nodes, but for those that have become others, and its edges, parted where they are cut. Returns its
/// trails, over the new edges.
fn copy(
    graph: &StrokeGraph,
    replaced: &BTreeMap<NodeIndex, NodeIndex>,
    cuts: &BTreeMap<EdgeIndex, &[Cut]>,
    out: &mut StrokeGraph,
) -> Vec<Trail> {
    let mut nodes = replaced.clone();
    for node in graph.graph.node_indices() {
        nodes.entry(node).or_insert_with(|| out.graph.add_node(graph.graph[node]));
    }
    let mut pieces: BTreeMap<EdgeIndex, Vec<EdgeIndex>> = BTreeMap::new();
    for edge in graph.graph.edge_indices() {
        let Some((a, b)) = graph.graph.edge_endpoints(edge) else { continue };
        let last = graph.graph[edge].points.len() as f64 - 1.0;
        // The last points before a broad line were drawn towards its ink.
        let drawn = |node| {
            if replaced.contains_key(node) { (DRAWN * graph.page.line_width / STEP).min(0.4 * last) } else { 0.0 }
        };
        let mut stops = vec![Cut { at: drawn(&a), node: nodes[&a] }];
        stops.extend(cuts.get(&edge).into_iter().copied().flatten());
        stops.push(Cut { at: last - drawn(&b), node: nodes[&b] });
        stops.sort_by(|a, b| a.at.total_cmp(&b.at));
        for pair in stops.windows(2) {
            let piece = piece(&graph.graph[edge], pair[0], pair[1], out);
            pieces.entry(edge).or_default().push(out.graph.add_edge(pair[0].node, pair[1].node, piece));
        }
    }
    let trail = |trail: &Trail| {
        let of_edge = |&(edge, reversed): &(EdgeIndex, bool)| {
            let pieces = &pieces[&edge];
            let ordered: Vec<EdgeIndex> =
                if reversed { pieces.iter().rev().copied().collect() } else { pieces.clone() };
            ordered.into_iter().map(move |piece| (piece, reversed))
        };
        Trail { edges: trail.edges.iter().flat_map(of_edge).collect(), ..trail.clone() }
    };
    graph.trails.iter().map(trail).collect()
}

/// The part of an edge between two nodes, drawn out to them where they lie beyond it.
fn piece(edge: &Edge, from: Cut, to: Cut, out: &StrokeGraph) -> Edge {
    let [start, end] = [from, to].map(|cut| out.graph[cut.node].position);
    let inner = from.at.floor() as usize + 1..(to.at.ceil() as usize).max(1);
    let mut piece = Edge { points: vec![start], widths: vec![f64::NAN], noise: edge.noise };
    let mut reach = |p: Point, width: f64| {
        let before = piece.points[piece.points.len() - 1];
        let count = ((p - before).hypot() / STEP).round() as usize;
        for k in 1..count {
            piece.points.push(before.lerp(p, k as f64 / count as f64));
            piece.widths.push(f64::NAN);
        }
        piece.points.push(p);
        piece.widths.push(width);
    };
    inner.filter(|&k| k < edge.points.len()).for_each(|k| reach(edge.points[k], edge.widths[k]));
    reach(end, f64::NAN);
    piece
}

/// Strokes in a row as one.
fn chained(trails: &[Trail], chain: &[(usize, bool)]) -> Trail {
    let mut joined = Trail { edges: Vec::new(), ..trails[chain[0].0].clone() };
    for &(stroke, backwards) in chain {
        joined.append(&trails[stroke], backwards);
    }
    joined
}
