//! The pieces of lines, findable by place.

use super::line::Line;
use kurbo::{Line as Segment, Point};
use rstar::primitives::GeomWithData;
use rstar::{AABB, RTree};

/// A line's place: index of the line and a fractional index of its points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::graph) struct Place {
    pub line: usize,
    pub at: f64,
}

type Piece = GeomWithData<rstar::primitives::Line<[f64; 2]>, (usize, usize)>;

/// The pieces of some lines; those that it was made of are given again with each question.
#[derive(Clone, Debug)]
pub(super) struct Index(RTree<Piece>);

impl Index {
    pub fn new(lines: &[Line]) -> Self {
        let mut pieces = Vec::new();
        for (i, line) in lines.iter().enumerate() {
            for k in 0..line.piece_count() {
                let piece = line.piece(k);
                let ends = rstar::primitives::Line::new([piece.p0.x, piece.p0.y], [piece.p1.x, piece.p1.y]);
                pieces.push(GeomWithData::new(ends, (i, k)));
            }
        }
        Self(RTree::bulk_load(pieces))
    }

    /// Crossings of a short segment with all lines: place, point, fraction along the segment. In a stable order.
    pub fn crossings(&self, lines: &[Line], segment: Segment) -> Vec<(Place, Point, f64)> {
        let envelope = AABB::from_corners([segment.p0.x, segment.p0.y], [segment.p1.x, segment.p1.y]);
        let mut found: Vec<_> = self
            .0
            .locate_in_envelope_intersecting(&envelope)
            .filter_map(|p| {
                let (line, k) = p.data;
                let (t, s) = intersect(segment, lines[line].piece(k))?;
                Some((Place { line, at: k as f64 + s }, segment.p0.lerp(segment.p1, t), t))
            })
            .collect();
        found.sort_by(|a, b| a.0.line.cmp(&b.0.line).then(a.0.at.total_cmp(&b.0.at)));
        found
    }

    /// The pieces of lines within `radius` of a point, each by its place nearest to the point, that place's point and its
    /// distance. The nearest first.
    pub fn near(&self, lines: &[Line], p: Point, radius: f64) -> Vec<(Place, Point, f64)> {
        let mut found: Vec<_> = self
            .0
            .locate_within_distance([p.x, p.y], radius * radius)
            .map(|candidate| {
                let (line, k) = candidate.data;
                let piece = lines[line].piece(k);
                let along = piece.p1 - piece.p0;
                let t = ((p - piece.p0).dot(along) / along.hypot2().max(1e-12)).clamp(0.0, 1.0);
                let foot = piece.p0 + along * t;
                (Place { line, at: k as f64 + t }, foot, (foot - p).hypot())
            })
            .collect();
        found.sort_by(|a, b| a.2.total_cmp(&b.2).then(a.0.line.cmp(&b.0.line)).then(a.0.at.total_cmp(&b.0.at)));
        found
    }
}

/// Parameters at which two segments cross.
fn intersect(a: Segment, b: Segment) -> Option<(f64, f64)> {
    let (da, db) = (a.p1 - a.p0, b.p1 - b.p0);
    let det = da.cross(db);
    if det.abs() < 1e-12 {
        return None;
    }
    let d = b.p0 - a.p0;
    let (t, s) = (d.cross(db) / det, d.cross(da) / det);
    ((0.0..=1.0).contains(&t) && (0.0..=1.0).contains(&s)).then_some((t, s))
}
