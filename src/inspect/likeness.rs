//! Whether what was traced is a line drawing at all.

use crate::clean::LineImage;
use crate::graph::{Edge, StrokeGraph};
use crate::load::Scan;
use kurbo::{Point, Vec2};

/// From this share of [`edge_share`] on, a page looks like no line drawing: drawings have up to .02, on bad paper too, a
/// photographed page of print .08, and most photographs more than .16.
pub const NO_DRAWING: f64 = 0.12;
/// Sides of a line are looked at so far beyond its edge, in pixels of the scan: beyond its blur.
const BESIDE: f64 = 1.5;
/// Every so many points of a line are looked at.
const STRIDE: usize = 4;

/// The share, 0 to 1, of the length of a graph's lines that follows an edge between light and dark on a page, and no ink: the
/// two sides differ by more than the line does from the side that is nearer to it. `image` is what the graph was traced from.
/// A graph without lines has 0.
///
/// What lies beside other ink is left out: there one side is no paper.
pub fn edge_share(scan: &Scan, image: &LineImage, graph: &StrokeGraph) -> f64 {
    let (mut all, mut on_edges) = (0usize, 0usize);
    for edge in graph.graph.edge_weights() {
        for k in (1..edge.points.len().saturating_sub(1)).step_by(STRIDE) {
            if let Some(is_edge) = is_edge(scan, image, edge, k) {
                all += 1;
                on_edges += usize::from(is_edge);
            }
        }
    }
    on_edges as f64 / all.max(1) as f64
}

/// Whether a point of a line lies on an edge; `None` where that cannot be seen.
fn is_edge(scan: &Scan, image: &LineImage, edge: &Edge, k: usize) -> Option<bool> {
    let (p, width) = (edge.points[k], edge.widths[k]);
    let heading = edge.points[k + 1] - edge.points[k - 1];
    let reach = 0.5 * if width.is_finite() { width } else { image.line_width } + BESIDE * image.scale;
    let across: Vec2 = heading.turn_90() / heading.hypot().max(1e-9) * reach;
    let is_paper = |p: Point| image.mask.at(p) == Some(false) && image.solid.at(p) == Some(false);
    if heading == Vec2::ZERO || !is_paper(p + across) || !is_paper(p - across) {
        return None;
    }
    let light = |p: Point| f64::from(scan.gray.sample((p.to_vec2() / image.scale).to_point()));
    let (left, right, middle) = (light(p + across), light(p - across), light(p));
    let (a, b) = (left - middle, right - middle);
    Some(a * b <= 0.0 || (left - right).abs() > a.abs().min(b.abs()))
}
