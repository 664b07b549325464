//! The result with its control points.

use super::graph::{disc, line_group};
use super::overlay::{DECIMALS, Overlay, chain, color, entry, path_data};
use crate::drawing::{Centreline, Drawing, Segment};
use crate::load::Scan;
use crate::write::Rounding;
use kurbo::{BezPath, Point, Rect, Shape};
use svg::node::element::{Group, Path};

/// Strokes, each in a colour of its own at its measured width, with its centreline; squares where pieces
/// meet, discs at control points with their handles, crosses at the centres of arcs and circles.
pub fn drawing_overlay(scan: &Scan, drawing: &Drawing) -> String {
    let mut overlay = Overlay::over(scan);
    let unit = overlay.unit();
    for fill in &drawing.fills {
        let path = Path::new().set("d", path_data(&fill.outline)).set("fill-rule", "evenodd");
        overlay.add(path.set("fill", "#f08c00").set("fill-opacity", 0.5));
    }
    let (bodies, lines) = stroke_groups(drawing, unit);
    overlay.add(bodies);
    overlay.add(lines);
    add_points(&mut overlay, drawing, unit);
    overlay.finish(&[
        entry("#555", format!("{} strokes, {} pieces", drawing.strokes.len(), drawing.segment_count())),
        entry(KNOT, "ends of pieces"),
        entry(HANDLE, "control points"),
        entry(CENTER, "centres of arcs"),
        entry("#f08c00", format!("{} solid regions", drawing.fills.len())),
    ])
}

const KNOT: &str = "#000";
const HANDLE: &str = "#0060e0";
const CENTER: &str = "#d000a0";

/// The strokes at their widths, pale, and their centrelines.
fn stroke_groups(drawing: &Drawing, unit: f64) -> (Group, Group) {
    let mut bodies = line_group(1.0).set("stroke-opacity", 0.35);
    let mut lines = line_group(0.5 * unit);
    for (i, stroke) in drawing.strokes.iter().enumerate() {
        let mut path = stroke.centreline.to_path();
        if let Centreline::Dot(p) = stroke.centreline {
            path = chain([p, p + kurbo::Vec2::new(0.01, 0.0)], false);
        }
        let line = Path::new().set("d", path_data(&path)).set("stroke", color(i));
        let width = Rounding::new(DECIMALS).text(stroke.width);
        bodies = bodies.add(line.clone().set("stroke-width", width));
        lines = lines.add(line);
    }
    (bodies, lines)
}

fn add_points(overlay: &mut Overlay, drawing: &Drawing, unit: f64) {
    let points = ControlPoints::of(drawing);
    let mut handles = BezPath::new();
    let mut discs = BezPath::new();
    for &(knot, control) in &points.handles {
        handles.extend(chain([knot, control], false));
        discs.extend(disc(control, 0.8 * unit));
    }
    let mut squares = BezPath::new();
    points.knots.iter().for_each(|&p| squares.extend(Rect::from_center_size(p, (1.5 * unit, 1.5 * unit)).to_path(0.1)));
    let mut crosses = BezPath::new();
    for &p in &points.centers {
        crosses.extend(chain([p - kurbo::Vec2::new(unit, 0.0), p + kurbo::Vec2::new(unit, 0.0)], false));
        crosses.extend(chain([p - kurbo::Vec2::new(0.0, unit), p + kurbo::Vec2::new(0.0, unit)], false));
    }
    overlay.add(line_group(0.25 * unit).set("stroke", HANDLE).add(Path::new().set("d", path_data(&handles))));
    overlay.add(line_group(0.3 * unit).set("stroke", CENTER).add(Path::new().set("d", path_data(&crosses))));
    overlay.add(Path::new().set("d", path_data(&discs)).set("fill", HANDLE));
    overlay.add(Path::new().set("d", path_data(&squares)).set("fill", KNOT));
}

/// The points that an editor would show.
#[derive(Default)]
struct ControlPoints {
    knots: Vec<Point>,
    handles: Vec<(Point, Point)>,
    centers: Vec<Point>,
}

impl ControlPoints {
    fn of(drawing: &Drawing) -> Self {
        let mut points = Self::default();
        for stroke in &drawing.strokes {
            match &stroke.centreline {
                Centreline::Path { segments, .. } => {
                    points.knots.push(stroke.centreline.start());
                    segments.iter().for_each(|s| points.push(s));
                }
                Centreline::Circle(c) => points.centers.push(c.center),
                Centreline::Dot(p) => points.knots.push(*p),
            }
        }
        points
    }

    fn push(&mut self, segment: &Segment) {
        self.knots.push(segment.end());
        match segment {
            Segment::Line(_) => {}
            Segment::Arc(a) => self.centers.push(a.center),
            Segment::Cubic(c) => self.handles.extend([(c.p0, c.p1), (c.p3, c.p2)]),
        }
    }
}
