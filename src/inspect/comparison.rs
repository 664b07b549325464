//! A trace over the strokes that were drawn.

use super::graph::{disc, line_group};
use super::overlay::{Overlay, chain, color, entry, path_data};
use crate::drawing::{Centreline, Drawing};
use crate::load::Scan;
use crate::metrics::{Nodes, nodes};
use kurbo::{BezPath, Point, Vec2};
use svg::node::element::Path;

const TRUE_NODE: &str = "#000";
const TRACED_NODE: &str = "#e000b0";
const SOLID: &str = "#f08c00";

/// The traced centrelines, each in a colour of its own with a dot at its ends, over the true ones, which are wide and
/// pale. Rings are where true lines meet, small rings where they end; crosses and small crosses are where traced ones
/// do, for a pen of `pen` pixels. Both drawings are in pixels of the scan.
pub fn comparison_overlay(scan: &Scan, truth: &Drawing, traced: &Drawing, pen: f64) -> String {
    let mut overlay = Overlay::over(scan);
    let unit = overlay.unit();
    let mut pale = line_group(2.5 * unit).set("stroke", "#9aa0a6").set("stroke-opacity", 0.7);
    for stroke in &truth.strokes {
        pale = pale.add(Path::new().set("d", path_data(&visible(&stroke.centreline))));
    }
    overlay.add(pale);
    let mut lines = line_group(0.7 * unit);
    for (i, stroke) in traced.strokes.iter().enumerate() {
        lines = lines.add(Path::new().set("d", path_data(&visible(&stroke.centreline))).set("stroke", color(i)));
        if !stroke.centreline.is_closed() {
            let mut ends = disc(stroke.centreline.start(), unit);
            ends.extend(disc(stroke.centreline.end(), unit));
            lines = lines.add(Path::new().set("d", path_data(&ends)).set("fill", color(i)).set("stroke", "none"));
        }
    }
    overlay.add(lines);
    for fill in &traced.fills {
        let path = Path::new().set("d", path_data(&fill.outline)).set("fill-rule", "evenodd");
        overlay.add(path.set("fill", SOLID).set("fill-opacity", 0.5));
    }
    let (true_nodes, traced_nodes) = (nodes(truth, pen), nodes(traced, pen));
    overlay.add(marks(&true_nodes, disc, unit).set("stroke", TRUE_NODE));
    overlay.add(marks(&traced_nodes, cross, unit).set("stroke", TRACED_NODE));
    let count = |nodes: &Nodes| format!("{} junctions, {} ends", nodes.junctions.len(), nodes.ends.len());
    overlay.finish(&[
        entry("#9aa0a6", format!("{} strokes drawn", truth.strokes.len())),
        entry(TRUE_NODE, format!("drawn (rings): {}", count(&true_nodes))),
        entry("#555", format!("{} strokes traced", traced.strokes.len())),
        entry(TRACED_NODE, format!("traced (crosses): {}", count(&traced_nodes))),
        entry(SOLID, format!("{} solid regions", traced.fills.len())),
    ])
}

/// A dot is a line too short to see, but with round caps.
fn visible(centreline: &Centreline) -> BezPath {
    match *centreline {
        Centreline::Dot(p) => chain([p, p + Vec2::new(0.01, 0.0)], false),
        _ => centreline.to_path(),
    }
}

/// Junctions by large marks and ends by small ones.
fn marks(nodes: &Nodes, mark: impl Fn(Point, f64) -> BezPath, unit: f64) -> Path {
    let mut path = BezPath::new();
    for (points, radius) in [(&nodes.junctions, 4.0), (&nodes.ends, 2.0)] {
        points.iter().for_each(|p| path.extend(mark(*p, radius * unit)));
    }
    Path::new().set("d", path_data(&path)).set("fill", "none").set("stroke-width", 0.5 * unit)
}

fn cross(p: Point, radius: f64) -> BezPath {
    let mut path = chain([p - Vec2::new(radius, 0.0), p + Vec2::new(radius, 0.0)], false);
    path.extend(chain([p - Vec2::new(0.0, radius), p + Vec2::new(0.0, radius)], false));
    path
}
