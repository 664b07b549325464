//! The ends of strokes in the open, and which of them face one another over paper or under a broad line.

use super::confidence::course;
use super::dashes::median;
use crate::graph::lines::arm_line;
use crate::graph::point_index::PointIndex;
use crate::graph::{JunctionKind, StrokeGraph, Trail};
use crate::streamline::{Tail, angle_between};
use kurbo::Point;
use petgraph::stable_graph::{EdgeIndex, NodeIndex};

/// How far an end may lie beside the other's course: in line widths, and as a share of the distance.
pub(super) const BESIDE: f64 = 0.25;
const BESIDE_SHARE: f64 = 0.15;
/// Courses turn by less than this (26 degrees) over a gap, beyond what their curvature makes of it.
const TURN: f64 = 0.45;
/// A stroke of less than this many of its widths is straight as far as its course can be told.
const SHORT: f64 = 4.0;
/// The two ends of one stroke close it when it is longer than this many times the gap.
const CLOSING: f64 = 4.0;

/// One end of an open stroke, in the open.
pub(super) struct FreeEnd {
    pub node: NodeIndex,
    pub point: Point,
    /// Where its course leads to beside the end.
    pub aim: Point,
    pub course: Tail,
    pub width: f64,
    /// Length of its stroke.
    pub length: f64,
}

/// The ends of all strokes, two for each: where it starts and where it ends; `None` where that is not in the open.
pub(super) fn free_ends(graph: &StrokeGraph) -> Vec<Option<FreeEnd>> {
    graph.trails.iter().flat_map(|trail| [0, 1].map(|side| free_end(graph, trail, side))).collect()
}

/// Some of the ends, findable by place.
pub(super) fn index_of(ends: &[Option<FreeEnd>], some: impl Iterator<Item = usize>) -> PointIndex {
    PointIndex::new(some.filter_map(|i| Some((i, ends[i].as_ref()?.point))))
}

/// Keeps of pairs of ends, of which there are `count`, those whose ends are in none before them.
pub(super) fn retain_first<T>(pairs: &mut Vec<T>, count: usize, ends: impl Fn(&T) -> [usize; 2]) {
    let mut taken = vec![false; count];
    pairs.retain(|pair| {
        let free = ends(pair).iter().all(|&end| !taken[end]);
        if free {
            ends(pair).into_iter().for_each(|end| taken[end] = true);
        }
        free
    });
}

/// How far two ends lie beside each other's course, if they agree: one line of one pen with a gap.
pub(super) fn facing(graph: &StrokeGraph, ends: &[Option<FreeEnd>], [i, j]: [usize; 2]) -> Option<f64> {
    let (a, b) = (ends[i].as_ref()?, ends[j].as_ref()?);
    let distance = (b.point - a.point).hypot();
    // The two ends of one stroke close it only when it is far longer than the gap.
    let closes = i / 2 == j / 2 && a.length < CLOSING * distance;
    if closes || graph.trails[i / 2].color != graph.trails[j / 2].color {
        return None;
    }
    let beside = |from: &FreeEnd, to: &FreeEnd| {
        let d = to.point - from.point;
        let s = d.dot(from.course.heading);
        let off = d.dot(from.course.heading.turn_90()) - 0.5 * from.course.curvature * s * s;
        (s > 0.0).then_some(off.abs())
    };
    let misfit = beside(a, b)?.max(beside(b, a)?);
    // Both head into the gap, so the second curves the other way.
    let bend = 0.5 * (a.course.curvature - b.course.curvature) * distance;
    let turn = angle_between(a.course.heading, -b.course.heading) - bend;
    (misfit <= BESIDE * graph.page.line_width + BESIDE_SHARE * distance && turn.abs() <= TURN).then_some(misfit)
}

/// The end of a stroke at its start (0) or its last point (1), where it is in the open.
fn free_end(graph: &StrokeGraph, trail: &Trail, side: usize) -> Option<FreeEnd> {
    if trail.closed {
        return None;
    }
    let &(edge, reversed) = if side == 0 { trail.edges.first()? } else { trail.edges.last()? };
    let at_source = (side == 0) != reversed;
    let (source, target) = graph.graph.edge_endpoints(edge)?;
    let node = if at_source { source } else { target };
    if graph.graph[node].kind != JunctionKind::FreeEnd {
        return None;
    }
    let finite: Vec<f64> = graph.graph[edge].widths.iter().copied().filter(|w| w.is_finite()).collect();
    let width = if finite.is_empty() { graph.page.line_width } else { median(&finite) };
    let point = graph.graph[node].position;
    let course = course(graph, edge, at_source)?;
    let length = length(graph, trail);
    let (aim, course) = if length < SHORT * width && trail.edges.len() == 1 {
        // Of a dash, the chord says most.
        let chord = point - graph.graph[if at_source { target } else { source }].position;
        (point, Tail { heading: chord / chord.hypot().max(1e-9), curvature: 0.0, ..course })
    } else {
        // The course was measured a little before the end.
        let (aim, heading) = arm_line(&course, point, graph.page.line_width);
        (aim, Tail { heading, ..course })
    };
    Some(FreeEnd { node, point, aim, course, width, length })
}

/// Length of a stroke in pixels.
pub(super) fn length(graph: &StrokeGraph, trail: &Trail) -> f64 {
    let of_edge = |e: EdgeIndex| graph.graph[e].points.windows(2).map(|w: &[Point]| (w[1] - w[0]).hypot()).sum::<f64>();
    trail.edges.iter().map(|&(e, _)| of_edge(e)).sum()
}

/// Strokes in chains over their gaps; `true` walks a stroke backwards.
pub(super) fn chains(strokes: usize, partner: &[Option<(usize, usize)>]) -> Vec<Vec<(usize, bool)>> {
    let mut used = vec![false; strokes];
    let open = (0..partner.len()).filter(|&e| partner[e].is_none());
    let mut chains = Vec::new();
    for start in open.chain(0..partner.len()) {
        let (mut chain, mut entry) = (Vec::new(), Some(start));
        while let Some(end) = entry.filter(|e| !used[e / 2]) {
            used[end / 2] = true;
            chain.push((end / 2, end % 2 == 1));
            entry = partner[end ^ 1].map(|(other, _)| other);
        }
        if !chain.is_empty() {
            chains.push(chain);
        }
    }
    chains
}
