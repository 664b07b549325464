//! Streamlines and the stroke graph.

use super::overlay::{DECIMALS, Overlay, chain, color, entry, path_data};
use crate::graph::{DOUBTFUL, JunctionKind, StrokeGraph};
use crate::load::Scan;
use crate::streamline::Streamline;
use crate::write::Rounding;
use kurbo::{Affine, BezPath, Point, Rect, Shape};
use svg::node::element::{Group, Path};

/// Streamlines, each in a colour of its own, with a dot where it starts. `scale` is pixels of the line
/// image per pixel of the scan.
pub fn streamlines_overlay(scan: &Scan, scale: f64, streamlines: &[Streamline]) -> String {
    let mut overlay = Overlay::over(scan);
    let unit = overlay.unit();
    let to_scan = Affine::scale(1.0 / scale);
    let mut lines = line_group(0.8 * unit);
    let mut starts = Group::new();
    for (i, streamline) in streamlines.iter().enumerate() {
        let Some(&first) = streamline.points.first() else { continue };
        let path = to_scan * chain(streamline.points.iter().copied(), streamline.closed);
        lines = lines.add(Path::new().set("d", path_data(&path)).set("stroke", color(i)));
        let dot = disc(to_scan * first, 1.1 * unit);
        starts = starts.add(Path::new().set("d", path_data(&dot)).set("fill", color(i)));
    }
    overlay.add(lines);
    overlay.add(starts);
    let closed = streamlines.iter().filter(|s| s.closed).count();
    overlay.finish(&[entry("#555", format!("{} streamlines, {closed} closed; a dot at each start", streamlines.len()))])
}

/// The graph: edges in the colour of their trail, nodes with a mark of their kind, dots as rings.
pub fn graph_overlay(scan: &Scan, scale: f64, graph: &StrokeGraph) -> String {
    let mut overlay = Overlay::over(scan);
    let unit = overlay.unit();
    let to_scan = Affine::scale(1.0 / scale);
    let mut edges = line_group(0.8 * unit);
    for (i, trail) in graph.trails.iter().enumerate() {
        for edge in trail.edges.iter().filter_map(|&(edge, _)| graph.graph.edge_weight(edge)) {
            let path = to_scan * chain(edge.points.iter().copied(), false);
            edges = edges.add(Path::new().set("d", path_data(&path)).set("stroke", color(i)));
        }
    }
    overlay.add(edges);
    let mut rings = line_group(0.6 * unit).set("stroke", "#c000c0");
    for dot in &graph.dots {
        rings = rings.add(Path::new().set("d", path_data(&disc(to_scan * dot.centre, 0.5 * dot.diameter / scale))));
    }
    overlay.add(rings);
    let mut legend = vec![entry("#555", format!("{} trails", graph.trails.len()))];
    for (kind, fill, label) in KINDS {
        let nodes: Vec<Point> =
            graph.graph.node_weights().filter(|n| n.kind == kind).map(|n| to_scan * n.position).collect();
        overlay.add(marks(kind, fill, &nodes, 2.2 * unit));
        legend.push(entry(fill, format!("{} {label}", nodes.len())));
    }
    legend.push(entry("#c000c0", format!("{} dots", graph.dots.len())));
    let doubtful: Vec<Point> =
        graph.graph.node_weights().filter(|n| n.confidence < DOUBTFUL).map(|n| to_scan * n.position).collect();
    let mut halos = line_group(0.7 * unit).set("stroke", DOUBT);
    for &p in &doubtful {
        halos = halos.add(Path::new().set("d", path_data(&disc(p, 4.5 * unit))));
    }
    overlay.add(halos);
    legend.push(entry(DOUBT, format!("{} doubtful (wide ring)", doubtful.len())));
    overlay.finish(&legend)
}

/// The ring around a node of low confidence.
const DOUBT: &str = "#ff0090";

/// Every kind of node with its colour and the words of the legend.
const KINDS: [(JunctionKind, &str, &str); 7] = [
    (JunctionKind::FreeEnd, "#00a040", "free ends (disc)"),
    (JunctionKind::Corner, "#f08000", "corners (square)"),
    (JunctionKind::Tee, "#0060e0", "tees (triangle)"),
    (JunctionKind::Crossing, "#e00000", "crossings (x)"),
    (JunctionKind::Branch, "#9000c0", "branches (diamond)"),
    (JunctionKind::Seam, "#707070", "seams (ring)"),
    (JunctionKind::Gap, "#00a0b0", "ends at gaps (small disc)"),
];

/// Marks of one kind as one path.
fn marks(kind: JunctionKind, color: &str, nodes: &[Point], radius: f64) -> Path {
    let mut path = BezPath::new();
    nodes.iter().for_each(|&p| path.extend(mark(kind, p, radius)));
    let text = |value: f64| Rounding::new(DECIMALS).text(value);
    let mark = Path::new().set("d", path_data(&path));
    if matches!(kind, JunctionKind::Crossing | JunctionKind::Seam) {
        mark.set("fill", "none").set("stroke", color).set("stroke-width", text(0.35 * radius))
    } else {
        mark.set("fill", color).set("stroke", "#fff").set("stroke-width", text(0.12 * radius))
    }
}

fn mark(kind: JunctionKind, p: Point, r: f64) -> BezPath {
    let corners =
        |offsets: &[(f64, f64)]| chain(offsets.iter().map(|&(x, y)| p + kurbo::Vec2::new(x * r, y * r)), true);
    match kind {
        JunctionKind::FreeEnd => disc(p, 0.7 * r),
        JunctionKind::Corner => Rect::from_center_size(p, (1.5 * r, 1.5 * r)).to_path(1e-3),
        JunctionKind::Tee => corners(&[(0.0, -1.0), (0.87, 0.6), (-0.87, 0.6)]),
        JunctionKind::Crossing => {
            let mut path = corners(&[(-0.8, -0.8), (0.8, 0.8)]);
            path.extend(corners(&[(-0.8, 0.8), (0.8, -0.8)]));
            path
        }
        JunctionKind::Branch => corners(&[(0.0, -1.0), (1.0, 0.0), (0.0, 1.0), (-1.0, 0.0)]),
        JunctionKind::Seam => disc(p, 0.8 * r),
        JunctionKind::Gap => disc(p, 0.45 * r),
    }
}

pub(super) fn disc(center: Point, radius: f64) -> BezPath {
    kurbo::Circle::new(center, radius).to_path(1e-2 * radius.max(1e-6))
}

pub(super) fn line_group(width: f64) -> Group {
    Group::new()
        .set("fill", "none")
        .set("stroke-width", Rounding::new(DECIMALS).text(width))
        .set("stroke-linecap", "round")
        .set("stroke-linejoin", "round")
}
