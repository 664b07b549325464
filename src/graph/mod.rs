//! From streamlines to the stroke graph.

use kurbo::Point;
use petgraph::stable_graph::{EdgeIndex, StableUnGraph};

/// What meets at a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum JunctionKind {
    /// One line ends in the open.
    FreeEnd,
    /// Two lines end at each other and turn.
    Corner,
    /// One line ends at the body of another.
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

/// Builds the stroke graph.
pub fn build(
    _image: &crate::clean::LineImage,
    _frames: &crate::field::FrameField,
    _streamlines: &[crate::streamline::Streamline],
    _options: &crate::options::Options,
) -> StrokeGraph {
    StrokeGraph::default()
}
