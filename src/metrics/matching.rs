//! Points that were found.

use super::cloud::at;
use kurbo::Point;
use petgraph::algo::maximum_matching;
use petgraph::graph::UnGraph;
use rstar::RTree;
use rstar::primitives::GeomWithData;

/// Harmonic mean of precision and recall of points: as many pairs as there can be of one of each side no further than
/// `radius` apart. 1 where both sides are empty.
pub(super) fn f1(truth: &[Point], traced: &[Point], radius: f64) -> f64 {
    if truth.is_empty() && traced.is_empty() {
        return 1.0;
    }
    if truth.is_empty() || traced.is_empty() {
        return 0.0;
    }
    let pairs = pairs(truth, traced, radius) as f64;
    harmonic_mean(pairs / traced.len() as f64, pairs / truth.len() as f64)
}

/// Zero where both are.
pub(super) fn harmonic_mean(a: f64, b: f64) -> f64 {
    if a + b > 0.0 { 2.0 * a * b / (a + b) } else { 0.0 }
}

fn pairs(truth: &[Point], traced: &[Point], radius: f64) -> usize {
    let mut graph = UnGraph::<(), ()>::default();
    let nodes: Vec<_> = traced.iter().map(|_| graph.add_node(())).collect();
    let located = traced.iter().zip(&nodes).map(|(p, n)| GeomWithData::new(at(*p), *n)).collect();
    let tree = RTree::bulk_load(located);
    for point in truth {
        let node = graph.add_node(());
        for near in tree.locate_within_distance(at(*point), radius * radius) {
            graph.add_edge(node, near.data, ());
        }
    }
    maximum_matching(&graph).len()
}
