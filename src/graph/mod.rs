//! From streamlines to the stroke graph.
//!
//! A streamline runs straight through crossings and, at its ends, over the middle of whatever stopped it up to
//! the far edge of the ink. Here each end is resolved: against the body of another line it is a tee, against
//! other ends a corner or a branch, in the open a free end half a width short of the edge. Then arms are paired
//! into strokes.

mod assemble;
mod contacts;
mod ends;
mod gaps;
mod nodes;
mod rejoin;

use crate::clean::LineImage;
use crate::options::Options;
use crate::streamline::Streamline;
use kurbo::Point;
use petgraph::stable_graph::{EdgeIndex, StableUnGraph};

/// What meets at a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
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
}

/// A node of the stroke graph.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Junction {
    /// Where the arms meet, in pixels of the line image.
    pub position: Point,
    /// What meets here.
    pub kind: JunctionKind,
}

/// An edge of the stroke graph: a piece of line between two nodes.
#[derive(Clone, Debug, PartialEq)]
pub struct Edge {
    /// Points from the edge's source node to its target node, both included.
    pub points: Vec<Point>,
    /// Ink width at each point in pixels; NaN where it cannot be measured.
    pub widths: Vec<f64>,
}

/// A stroke: a walk through the graph.
#[derive(Clone, Debug, PartialEq)]
pub struct Trail {
    /// The edges in order; `true` walks an edge from its target to its source.
    pub edges: Vec<(EdgeIndex, bool)>,
    /// Whether the walk ends where it started.
    pub closed: bool,
}

/// The topology of a drawing.
#[derive(Clone, Debug, Default)]
pub struct StrokeGraph {
    /// Nodes and edges.
    pub graph: StableUnGraph<Junction, Edge>,
    /// The strokes; every edge belongs to exactly one.
    pub trails: Vec<Trail>,
    /// Blobs of about a line width in both directions: centre and diameter.
    pub dots: Vec<(Point, f64)>,
}

impl StrokeGraph {
    /// Points and widths along a trail, and whether each point is a corner: a node at which two lines end.
    pub(crate) fn walk(&self, trail: &Trail) -> Vec<TrailPoint> {
        let mut walk: Vec<TrailPoint> = Vec::new();
        for &(edge, reversed) in &trail.edges {
            let (Some(e), Some((a, b))) = (self.graph.edge_weight(edge), self.graph.edge_endpoints(edge)) else {
                continue;
            };
            let points =
                e.points.iter().zip(&e.widths).map(|(&point, &width)| TrailPoint { point, width, corner: false });
            let mut piece: Vec<TrailPoint> = points.collect();
            let corner = |node: petgraph::graph::NodeIndex| {
                matches!(self.graph[node].kind, JunctionKind::Corner | JunctionKind::Branch)
            };
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
    /// Whether the line may turn sharply here.
    pub corner: bool,
}

/// Builds the stroke graph.
pub fn build(image: &LineImage, streamlines: &[Streamline], options: &Options) -> StrokeGraph {
    let (dots, mut lines) = ends::split_dots(image, streamlines);
    if image.noise > 0.0 {
        gaps::withdraw(image, &mut lines);
    }
    let mut resolved = Resolved::new(image, &lines);
    let cuts = rejoin::cuts(image, &lines, &resolved.ends, &resolved.nodes);
    if !cuts.is_empty() {
        lines = rejoin::cut_lines(&lines, &cuts);
        resolved = Resolved::new(image, &lines);
    }
    let mut graph = assemble::assemble(image, &lines, &resolved.ends, &resolved.nodes, options);
    graph.dots = dots;
    graph
}

/// Lines with their ends resolved.
struct Resolved {
    ends: Vec<Option<ends::End>>,
    nodes: Vec<nodes::Node>,
}

impl Resolved {
    fn new(image: &LineImage, lines: &[Streamline]) -> Self {
        let ends = ends::ends(image, lines);
        let contacts = contacts::contacts(image, lines, &ends);
        let nodes = nodes::resolve(image, lines, &ends, &contacts);
        Self { ends, nodes }
    }
}
