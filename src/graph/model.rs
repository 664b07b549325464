//! The stroke graph: nodes, edges, and strokes as trails of edges.

use crate::clean::LineImage;
use crate::drawing::{Color, Dashes, Fill};
use kurbo::Point;
use petgraph::stable_graph::{EdgeIndex, NodeIndex, StableUnGraph};
use serde::{Deserialize, Serialize};

/// What meets at a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum JunctionKind {
    /// One line ends in the open.
    FreeEnd,
    /// Two lines end at each other.
    Corner,
    /// One or more lines end at the body of another.
    Tee,
    /// Two lines pass through each other.
    Crossing,
    /// Three or more lines end at one point.
    Branch,
    /// A closed line's arbitrary first point.
    Seam,
    /// The ink ends, and the line goes on behind a gap.
    Gap,
}

/// A node of the stroke graph.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Junction {
    /// Where the arms meet, in pixels of the line image.
    pub position: Point,
    /// What meets here.
    pub kind: JunctionKind,
    /// How sure place and pairing are, from 0 to 1: how nearly the arms' extensions meet here, times how much worse
    /// the next best way of pairing them would be. A free end is as sure as the paper around it is wide.
    pub confidence: f64,
}

impl Junction {
    /// A node that nothing speaks against.
    pub fn new(position: Point, kind: JunctionKind) -> Self {
        Self { position, kind, confidence: 1.0 }
    }
}

/// An edge of the stroke graph: a piece of line between two nodes.
#[derive(Clone, Debug, PartialEq)]
pub struct Edge {
    /// Points from the edge's source node to its target node, both included.
    pub points: Vec<Point>,
    /// Ink width at each point in pixels; NaN where it cannot be measured.
    pub widths: Vec<f64>,
    /// Standard deviation of the ink's edge about a smooth line, in pixels: how far the ink can be trusted.
    pub noise: f64,
}

/// A stroke: a walk through the graph.
#[derive(Clone, Debug, PartialEq)]
pub struct Trail {
    /// The edges in order; `true` walks an edge from its target to its source.
    pub edges: Vec<(EdgeIndex, bool)>,
    /// Whether the walk ends where it started.
    pub closed: bool,
    /// Ink colour.
    pub color: Color,
    /// The pattern of a dashed line, in pixels of the line image.
    pub dashes: Option<Dashes>,
}

impl Trail {
    /// Goes on along another trail, from its end if `backwards`.
    pub(in crate::graph) fn append(&mut self, other: &Self, backwards: bool) {
        if backwards {
            self.edges.extend(other.edges.iter().rev().map(|&(edge, reversed)| (edge, !reversed)));
        } else {
            self.edges.extend(&other.edges);
        }
    }
}

/// A blob of about a line width in both directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dot {
    /// Its centre, in pixels of the line image.
    pub centre: Point,
    /// Its diameter, in pixels of the line image.
    pub diameter: f64,
    /// Ink colour.
    pub color: Color,
}

/// The page that a graph was traced from, as far as fitting has to know it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Page {
    /// Width of the scan in pixels.
    pub width: f64,
    /// Height of the scan in pixels.
    pub height: f64,
    /// Dots per inch of the scan, where known.
    pub dpi: Option<f64>,
    /// Pixels of the line image per pixel of the scan.
    pub scale: f64,
    /// Typical line width in pixels of the line image.
    pub line_width: f64,
    /// Standard deviation of the blur of the lines in pixels of the line image.
    pub blur: f64,
}

impl Default for Page {
    /// A page of no size with lines one pixel wide.
    fn default() -> Self {
        Self { width: 0.0, height: 0.0, dpi: None, scale: 1.0, line_width: 1.0, blur: 0.0 }
    }
}

impl Page {
    /// The page of a line image; its resolution is not known there.
    pub(in crate::graph) fn of(image: &LineImage) -> Self {
        let side = |pixels: usize| pixels as f64 / image.scale;
        let (width, height) = (side(image.ink.width()), side(image.ink.height()));
        Self { width, height, dpi: None, scale: image.scale, line_width: image.line_width, blur: image.blur }
    }
}

/// The topology of a drawing, with all that fitting takes.
#[derive(Clone, Debug, Default)]
pub struct StrokeGraph {
    /// The page.
    pub page: Page,
    /// Nodes and edges.
    pub graph: StableUnGraph<Junction, Edge>,
    /// The strokes; every edge belongs to exactly one.
    pub trails: Vec<Trail>,
    /// Dots.
    pub dots: Vec<Dot>,
    /// Outlines of solid regions, straight from point to point, in pixels of the line image.
    pub fills: Vec<Fill>,
}

impl StrokeGraph {
    /// Shares of a trail's length halfway between two visits of one node: there the trail can be parted so that no
    /// part crosses itself.
    pub(crate) fn revisits(&self, trail: &Trail) -> Vec<f64> {
        let mut visits: Vec<(NodeIndex, f64)> = Vec::new();
        let mut walked = 0.0;
        for &(edge, reversed) in &trail.edges {
            let (Some(e), Some((a, b))) = (self.graph.edge_weight(edge), self.graph.edge_endpoints(edge)) else {
                continue;
            };
            if visits.is_empty() {
                visits.push((if reversed { b } else { a }, 0.0));
            }
            walked += e.points.windows(2).map(|p| (p[1] - p[0]).hypot()).sum::<f64>();
            visits.push((if reversed { a } else { b }, walked));
        }
        let mut breaks = Vec::new();
        for (j, &(node, at)) in visits.iter().enumerate() {
            let before = visits[..j].iter().rposition(|v| v.0 == node);
            // That a closed trail comes home is no crossing.
            let home = |i: usize| trail.closed && i == 0 && j + 1 == visits.len();
            if let Some(i) = before.filter(|&i| !home(i)) {
                breaks.push(0.5 * (visits[i].1 + at) / walked.max(1e-9));
            }
        }
        breaks
    }

    /// Points and widths along a trail, and whether each point is a corner: a node at which two lines end.
    pub(crate) fn walk(&self, trail: &Trail) -> Vec<TrailPoint> {
        let mut walk: Vec<TrailPoint> = Vec::new();
        for &(edge, reversed) in &trail.edges {
            let (Some(e), Some((a, b))) = (self.graph.edge_weight(edge), self.graph.edge_endpoints(edge)) else {
                continue;
            };
            let point = |(&point, &width)| TrailPoint { point, width, noise: e.noise, corner: false };
            let mut piece: Vec<TrailPoint> = e.points.iter().zip(&e.widths).map(point).collect();
            let corner = |node: NodeIndex| matches!(self.graph[node].kind, JunctionKind::Corner | JunctionKind::Branch);
            if let [first, .., last] = piece.as_mut_slice() {
                (first.corner, last.corner) = (corner(a), corner(b));
            }
            if reversed {
                piece.reverse();
            }
            // The node is the last point of one edge and the first of the next.
            let skip = usize::from(!walk.is_empty());
            walk.extend(piece.into_iter().skip(skip));
        }
        walk
    }
}

/// A point along a trail.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TrailPoint {
    pub point: Point,
    /// Ink width in pixels; NaN where it cannot be measured.
    pub width: f64,
    /// Standard deviation of the ink's edge about a smooth line, in pixels.
    pub noise: f64,
    /// Whether the line may turn sharply here.
    pub corner: bool,
}
