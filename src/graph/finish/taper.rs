//! Widths where a walk lost them.
//!
//! A walk knows the width of its line and takes much wider ink for a junction. Along a brush stroke that swells it can
//! lose the width for good, and goes on straight. For outlines such stretches are measured again: each point is put in
//! the middle of its own ink, across the stroke, and gets the width found there.

use crate::clean::LineImage;
use crate::graph::{Edge, JunctionKind, StrokeGraph};
use crate::profile::cross_profile;
use crate::streamline::STEP;
use kurbo::{Point, Vec2};
use petgraph::stable_graph::{EdgeIndex, NodeIndex};

/// Stretches without a width that are longer than this many line widths are no junctions.
const LONGEST_JUNCTION: f64 = 3.0;
/// Points to both sides that tell the direction.
const AROUND: usize = 6;
/// Ink is looked at this many times its depth, and so many pixels, to either side of a point.
const ACROSS: f64 = 2.5;
const ACROSS_PIXELS: f64 = 2.0;
/// Times that a point is moved to the middle of its ink.
const ROUNDS: usize = 3;
/// As many measured points at an end tell the width that its place was found by.
const NEAR: usize = 40;

/// Measures long stretches again, and sets free ends half of their new width short of the ink's. Returns how many
/// stretches there were.
pub(in crate::graph) fn measure(image: &LineImage, graph: &mut StrokeGraph) -> usize {
    let mut measured = 0;
    let edges: Vec<EdgeIndex> = graph.graph.edge_indices().collect();
    for e in edges {
        let Some((a, b)) = graph.graph.edge_endpoints(e) else { continue };
        let before = graph.graph[e].clone();
        let edge = &mut graph.graph[e];
        for (from, to) in lost(edge, LONGEST_JUNCTION * image.line_width) {
            (0..ROUNDS).for_each(|_| measure_stretch(image, edge, from, to));
            measured += 1;
        }
        for (node, reversed) in [(a, false), (b, true)] {
            if a != b && graph.graph[node].kind == JunctionKind::FreeEnd {
                set_end(graph, e, node, &before, reversed);
            }
        }
    }
    measured
}

/// Runs of points without a width, longer than `least` pixels; their first and last indices, nodes left out.
fn lost(edge: &Edge, least: f64) -> Vec<(usize, usize)> {
    let inner: Vec<usize> = (1..edge.points.len().saturating_sub(1)).collect();
    let runs = inner.chunk_by(|&k, _| edge.widths[k].is_nan() == edge.widths[k + 1].is_nan());
    let long = runs.filter(|run| edge.widths[run[0]].is_nan() && run.len() as f64 * STEP > least);
    long.map(|run| (run[0], run[run.len() - 1])).collect()
}

fn measure_stretch(image: &LineImage, edge: &mut Edge, from: usize, to: usize) {
    let points = edge.points.clone();
    for k in from..=to {
        let (a, b) = (points[k.saturating_sub(AROUND)], points[(k + AROUND).min(points.len() - 1)]);
        let along = b - a;
        if along.hypot() < 1e-6 {
            continue;
        }
        let normal: Vec2 = along.normalize().turn_90();
        let depth = f64::from(image.depth.at(points[k]).unwrap_or(0.0));
        let profile = cross_profile(&image.ink, points[k], normal, ACROSS * depth + ACROSS_PIXELS);
        if let Some((width, middle)) = profile.and_then(|p| Some((p.width()?, p.middle()?)))
            && middle.abs() < 0.5 * width
        {
            edge.points[k] = points[k] + normal * middle;
            edge.widths[k] = width;
        }
    }
}

/// Takes back an end whose line turned out wider than it was thought to be.
fn set_end(graph: &mut StrokeGraph, e: EdgeIndex, node: NodeIndex, before: &Edge, reversed: bool) {
    let (Some(old), Some(new)) = (width_near(before, reversed), width_near(&graph.graph[e], reversed)) else { return };
    let back = 0.5 * (new - old);
    if back < STEP {
        return;
    }
    let edge = &mut graph.graph[e];
    let end = |points: &[Point]| if reversed { points[points.len() - 1] } else { points[0] };
    let tip = end(&edge.points);
    while edge.points.len() > 2 * AROUND && (end(&edge.points) - tip).hypot() < back {
        let k = if reversed { edge.points.len() - 1 } else { 0 };
        edge.points.remove(k);
        edge.widths.remove(k);
    }
    let place = end(&edge.points);
    graph.graph[node].position = place;
}

/// The middle of the first measured widths from one end.
fn width_near(edge: &Edge, reversed: bool) -> Option<f64> {
    let n = edge.widths.len();
    let at = |k: usize| edge.widths[if reversed { n - 1 - k } else { k }];
    let mut near: Vec<f64> = (0..n).map(at).filter(|w| w.is_finite()).take(NEAR).collect();
    near.sort_by(f64::total_cmp);
    near.get(near.len() / 2).copied()
}
