//! How sure each junction is.
//!
//! Two things can be wrong at a junction: its place, and which of its arms are one stroke. The place is as sure as
//! the extensions of the arms meet there, against the line width: `exp(-(misfit / reach)^2)` of their root mean
//! square distance. The pairing is as sure as the next best one is worse: every exchange of one arm of a pair for an
//! arm of another pair, or for one that is left over, is tried, and the least it adds to the strokes' turns counts.
//! The confidence is the product. A free end may have been meant to touch what it ends near; it is as sure as the
//! paper between is wide.

use crate::graph::lines::{arm_line, continuation};
use crate::graph::{JunctionKind, StrokeGraph};
use crate::streamline::{STEP, Tail};
use kurbo::Point;
use petgraph::stable_graph::{EdgeIndex, NodeIndex};
use petgraph::visit::EdgeRef;
use rayon::prelude::*;
use rstar::RTree;
use rstar::primitives::GeomWithData;
use std::collections::BTreeMap;

/// Junctions of less confidence are worth a look.
pub const DOUBTFUL: f64 = 0.5;
/// How far arms may miss their node, in line widths, and the pixels that are added for the raster's sake.
const MISS: f64 = 0.5;
const MISS_PIXELS: f64 = 0.25;
/// A pairing that is better than any other by this turn (30 degrees) is beyond doubt.
const CLEAR: f64 = 0.52;
/// An arm's course is measured from this many line widths away from the node, over that many.
const INSIDE: f64 = 0.75;
const COURSE: f64 = 5.0;

/// An edge, and whether it is its source's end.
type EdgeEnd = (EdgeIndex, bool);

/// One end of an edge at a node.
#[derive(Clone, Copy)]
struct Arm {
    edge: EdgeIndex,
    at_source: bool,
    tail: Tail,
}

/// Sets the confidence of every node. Returns how many are doubtful.
pub(in crate::graph) fn rate(graph: &mut StrokeGraph) -> usize {
    let (points, links) = (points_of_edges(graph), links(graph));
    let nodes: Vec<NodeIndex> = graph.graph.node_indices().collect();
    let ratings: Vec<(NodeIndex, f64)> = nodes
        .into_par_iter()
        .map(|node| {
            let confidence = match graph.graph[node].kind {
                JunctionKind::Seam => 1.0,
                JunctionKind::Gap => graph.graph[node].confidence,
                JunctionKind::FreeEnd => end_confidence(graph, node, &points),
                _ => junction_confidence(graph, node, links.get(&node).map_or(&[], Vec::as_slice)),
            };
            (node, confidence)
        })
        .collect();
    for (node, confidence) in ratings {
        graph.graph[node].confidence = confidence;
    }
    graph.graph.node_weights().filter(|node| node.confidence < DOUBTFUL).count()
}

pub(super) type PointsOfEdges = RTree<GeomWithData<[f64; 2], EdgeIndex>>;

/// Points of all edges, findable by place; empty where no line ends free.
pub(super) fn points_of_edges(graph: &StrokeGraph) -> PointsOfEdges {
    if !graph.graph.node_weights().any(|n| n.kind == JunctionKind::FreeEnd) {
        return RTree::new();
    }
    let of_edge = |e: EdgeIndex| graph.graph[e].points.iter().map(move |p| GeomWithData::new([p.x, p.y], e));
    RTree::bulk_load(graph.graph.edge_indices().flat_map(of_edge).collect())
}

/// The paper between an end and the nearest other edge, in line widths and at most 1.
fn end_confidence(graph: &StrokeGraph, node: NodeIndex, points: &PointsOfEdges) -> f64 {
    let (p, width) = (graph.graph[node].position, graph.page.line_width);
    let own = |e: EdgeIndex| graph.graph.edges(node).any(|edge| edge.id() == e);
    let near = points.locate_within_distance([p.x, p.y], 4.0 * width * width);
    let others = near.filter(|q| !own(q.data)).map(|q| (Point::new(q.geom()[0], q.geom()[1]) - p).hypot());
    let nearest = others.fold(2.0 * width, f64::min);
    ((nearest - width) / width).clamp(0.0, 1.0)
}

fn junction_confidence(graph: &StrokeGraph, node: NodeIndex, links: &[[EdgeEnd; 2]]) -> f64 {
    let arms = arms(graph, node);
    if arms.len() < 2 {
        return 1.0;
    }
    let (at, width) = (graph.graph[node].position, graph.page.line_width);
    let miss = |arm: &Arm| {
        let (p, d) = arm_line(&arm.tail, at, width);
        (at - p).cross(d)
    };
    let squares: f64 = arms.iter().map(|arm| miss(arm).powi(2)).sum();
    let misfit = (squares / arms.len() as f64).sqrt() / (MISS * width + MISS_PIXELS);
    let clear = pairing_gap(&arms, links, at, width) / CLEAR;
    (-misfit * misfit).exp() * clear.clamp(0.0, 1.0)
}

/// The edges' ends at a node, each with its course towards it.
fn arms(graph: &StrokeGraph, node: NodeIndex) -> Vec<Arm> {
    let mut arms = Vec::new();
    for edge in graph.graph.edges(node).map(|e| e.id()) {
        let Some((source, target)) = graph.graph.edge_endpoints(edge) else { continue };
        // A loop's edge has both of its ends here.
        for (at_source, end) in [(true, source), (false, target)] {
            if end == node
                && let Some(tail) = course(graph, edge, at_source)
            {
                arms.push(Arm { edge, at_source, tail });
            }
        }
    }
    arms.sort_by_key(|arm| (arm.edge, arm.at_source));
    arms.dedup_by_key(|arm| (arm.edge, arm.at_source));
    arms
}

/// The course of an edge towards one of its ends.
pub(super) fn course(graph: &StrokeGraph, edge: EdgeIndex, at_source: bool) -> Option<Tail> {
    let edge = &graph.graph[edge];
    let n = edge.points.len();
    let index = |k: usize| if at_source { k } else { n - 1 - k };
    let node = edge.points[index(0)];
    let width = graph.page.line_width;
    let outside = |&k: &usize| (edge.points[index(k)] - node).hypot() > INSIDE * width;
    let measured = |&k: &usize| edge.widths[index(k)].is_finite() && outside(&k);
    let count = (COURSE * width / STEP) as usize;
    let from = (1..n).find(measured).or_else(|| (1..n).find(outside)).unwrap_or(0);
    let mut run: Vec<Point> = (from..n.min(from + count.max(3))).map(|k| edge.points[index(k)]).collect();
    if run.len() < 2 {
        run = (0..n).map(|k| edge.points[index(k)]).collect();
    }
    run.reverse();
    Tail::fit(&run, 0.1)
}

/// What the cheapest other pairing of the arms costs more than the strokes', in radians; endless where there is none.
fn pairing_gap(arms: &[Arm], links: &[[EdgeEnd; 2]], at: Point, width: f64) -> f64 {
    let find = |end: EdgeEnd| arms.iter().position(|arm| (arm.edge, arm.at_source) == end);
    let pairs: Vec<[usize; 2]> = links.iter().filter_map(|&[a, b]| Some([find(a)?, find(b)?])).collect();
    let cost = |a: usize, b: usize| continuation(&arms[a].tail, &arms[b].tail, at, width);
    let mut gap = f64::INFINITY;
    for (k, &[a, b]) in pairs.iter().enumerate() {
        let now = cost(a, b);
        for &[c, d] in &pairs[..k] {
            let both = now + cost(c, d);
            gap = gap.min(cost(a, c) + cost(b, d) - both).min(cost(a, d) + cost(b, c) - both);
        }
        let is_paired = |c: usize| pairs.iter().any(|p| p.contains(&c));
        for c in (0..arms.len()).filter(|&c| !is_paired(c)) {
            gap = gap.min(cost(a, c) - now).min(cost(b, c) - now);
        }
    }
    gap
}

/// The ends of edges through which strokes run, by the node at which they do.
fn links(graph: &StrokeGraph) -> BTreeMap<NodeIndex, Vec<[EdgeEnd; 2]>> {
    let mut links: BTreeMap<NodeIndex, Vec<[EdgeEnd; 2]>> = BTreeMap::new();
    for trail in &graph.trails {
        let next = trail.edges.iter().skip(1).chain(trail.edges.first().filter(|_| trail.closed));
        for (&(before, back), &(after, reversed)) in trail.edges.iter().zip(next) {
            // A walk leaves an edge by its target, unless it is reversed.
            if let Some((source, target)) = graph.graph.edge_endpoints(before) {
                let node = if back { source } else { target };
                links.entry(node).or_default().push([(before, back), (after, !reversed)]);
            }
        }
    }
    links
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::Color;
    use crate::graph::{Edge, Junction, Trail};
    use kurbo::Vec2;

    /// Straight arms from the origin, the first two of them one stroke.
    fn star(degrees: &[f64], offset: Vec2) -> StrokeGraph {
        let mut graph = StrokeGraph::default();
        graph.page.line_width = 3.0;
        let kind = if degrees.len() == 2 { JunctionKind::Corner } else { JunctionKind::Branch };
        let centre = graph.graph.add_node(Junction::new(Point::ORIGIN, kind));
        let mut arms = Vec::new();
        for (i, degrees) in degrees.iter().enumerate() {
            let d = Vec2::from_angle(degrees.to_radians());
            // The first arm misses the node by the offset.
            let shift = if i == 0 { offset } else { Vec2::ZERO };
            let course = (5..80).map(|k| (shift + d * (0.5 * f64::from(k))).to_point());
            let points: Vec<Point> = std::iter::once(Point::ORIGIN).chain(course).collect();
            let tip = graph.graph.add_node(Junction::new(points[points.len() - 1], JunctionKind::FreeEnd));
            let widths = vec![3.0; points.len()];
            arms.push(graph.graph.add_edge(centre, tip, Edge { points, widths, noise: 0.0 }));
        }
        graph.trails.push(Trail {
            edges: vec![(arms[0], true), (arms[1], false)],
            closed: false,
            color: Color::BLACK,
            dashes: None,
        });
        for &arm in &arms[2..] {
            graph.trails.push(Trail { edges: vec![(arm, false)], closed: false, color: Color::BLACK, dashes: None });
        }
        rate(&mut graph);
        graph
    }

    fn confidence(degrees: &[f64], offset: Vec2) -> f64 {
        star(degrees, offset).graph.node_weights().next().unwrap().confidence
    }

    #[test]
    fn a_stem_on_a_straight_line_is_sure_and_less_so_the_more_it_leans() {
        let at = |lean: f64| confidence(&[0.0, 180.0, 90.0 - lean], Vec2::ZERO);
        assert!(at(0.0) > 0.95, "{}", at(0.0));
        let all: Vec<f64> = [0.0, 60.0, 70.0, 80.0, 88.0].map(at).to_vec();
        assert!(all.windows(2).all(|w| w[1] < w[0] + 1e-9), "{all:?}");
        assert!(all[4] < DOUBTFUL);
    }

    #[test]
    fn three_even_arms_leave_their_pairing_open() {
        for turn in [0.0, 17.0, 40.0, 90.0] {
            assert!(confidence(&[turn, turn + 120.0, turn + 240.0], Vec2::ZERO) < 0.1);
        }
    }

    #[test]
    fn arms_that_miss_their_node_make_it_doubtful() {
        let at = |miss: f64| confidence(&[0.0, 90.0], Vec2::new(0.0, miss));
        let all: Vec<f64> = [0.0, 0.5, 1.0, 2.0, 4.0].map(at).to_vec();
        assert!(all[0] > 0.95 && all[4] < DOUBTFUL, "{all:?}");
        assert!(all.windows(2).all(|w| w[1] < w[0]), "{all:?}");
    }

    #[test]
    fn an_end_is_as_sure_as_the_paper_around_it_is_wide() {
        let with_neighbour = |distance: f64| {
            let mut graph = star(&[0.0, 180.0], Vec2::ZERO);
            let tip = graph.graph.node_indices().nth(1).unwrap();
            let p = graph.graph[tip].position + Vec2::new(distance, 0.0);
            let ends = [-10.0, 10.0].map(|y| p + Vec2::new(0.0, y));
            let nodes = ends.map(|p| graph.graph.add_node(Junction::new(p, JunctionKind::FreeEnd)));
            let points = vec![ends[0], p, ends[1]];
            graph.graph.add_edge(nodes[0], nodes[1], Edge { points, widths: vec![3.0; 3], noise: 0.0 });
            rate(&mut graph);
            graph.graph[tip].confidence
        };
        assert!(with_neighbour(3.1) < 0.1 && (with_neighbour(4.5) - 0.5).abs() < 1e-9 && with_neighbour(7.0) == 1.0);
    }
}
