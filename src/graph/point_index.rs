//! Numbered points, findable by place.

use kurbo::Point;
use rstar::RTree;
use rstar::primitives::GeomWithData;

/// Numbered points.
pub(super) struct PointIndex {
    tree: RTree<GeomWithData<[f64; 2], usize>>,
}

impl PointIndex {
    pub fn new(points: impl Iterator<Item = (usize, Point)>) -> Self {
        Self { tree: RTree::bulk_load(points.map(|(i, p)| GeomWithData::new([p.x, p.y], i)).collect()) }
    }

    /// The numbers of those within `radius` of a point, in no order.
    pub fn near(&self, p: Point, radius: f64) -> impl Iterator<Item = usize> {
        self.tree.locate_within_distance([p.x, p.y], radius * radius).map(|point| point.data)
    }

    /// The numbers of all, the nearest first.
    pub fn by_distance(&self, p: Point) -> impl Iterator<Item = usize> {
        self.tree.nearest_neighbor_iter(&[p.x, p.y]).map(|point| point.data)
    }
}
