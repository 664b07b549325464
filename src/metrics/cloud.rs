//! Strokes as evenly spaced samples that can be searched.

use super::chain::Chain;
use kurbo::{Point, Vec2};
use rstar::RTree;
use rstar::primitives::GeomWithData;

/// Distance between samples in pixels, at most.
const STEP: f64 = 0.5;

/// A point of a stroke.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample {
    pub position: Point,
    /// Unit tangent; zero where the stroke is a dot.
    pub tangent: Vec2,
    /// Which stroke.
    pub stroke: usize,
    /// Which sample of the stroke.
    pub number: usize,
    /// The length in pixels that it stands for.
    pub weight: f64,
}

/// The samples of some strokes.
pub(super) struct Cloud {
    pub samples: Vec<Sample>,
    tree: RTree<GeomWithData<[f64; 2], usize>>,
}

impl Cloud {
    /// Samples every chain, its ends included.
    pub fn new(chains: &[Chain]) -> Self {
        let samples: Vec<Sample> = chains.iter().enumerate().flat_map(|(i, c)| sampled(c, i)).collect();
        let located = |(i, s): (usize, &Sample)| GeomWithData::new(at(s.position), i);
        let tree = RTree::bulk_load(samples.iter().enumerate().map(located).collect());
        Self { samples, tree }
    }

    /// The length of all strokes in pixels.
    pub fn length(&self) -> f64 {
        self.samples.iter().map(|s| s.weight).sum()
    }

    /// The sample nearest to a point.
    pub fn nearest(&self, p: Point) -> Option<&Sample> {
        self.tree.nearest_neighbor(&at(p)).map(|found| &self.samples[found.data])
    }

    /// The samples within some distance of a point.
    pub fn within(&self, p: Point, distance: f64) -> impl Iterator<Item = &Sample> {
        self.tree.locate_within_distance(at(p), distance * distance).map(|found| &self.samples[found.data])
    }
}

/// A point as search trees have it.
pub(super) fn at(p: Point) -> [f64; 2] {
    [p.x, p.y]
}

/// Samples of a chain at equal distances along it.
fn sampled(chain: &Chain, stroke: usize) -> Vec<Sample> {
    let points = &chain.points;
    let length: f64 = points.windows(2).map(|p| p[0].distance(p[1])).sum();
    if length < 1e-9 {
        return vec![Sample { position: points[0], tangent: Vec2::ZERO, stroke, number: 0, weight: 0.0 }];
    }
    let count = (length / STEP).ceil() as usize + 1;
    let positions = at_equal_distances(points, length, count);
    let tangent = |i: usize| {
        let chord = positions[(i + 1).min(count - 1)] - positions[i.saturating_sub(1)];
        if chord.hypot() > 0.0 { chord.normalize() } else { Vec2::ZERO }
    };
    let weight = length / count as f64;
    (0..count).map(|i| Sample { position: positions[i], tangent: tangent(i), stroke, number: i, weight }).collect()
}

fn at_equal_distances(points: &[Point], length: f64, count: usize) -> Vec<Point> {
    let step = length / (count - 1) as f64;
    let mut pieces = points.windows(2).map(|p| (p[0], p[1] - p[0])).filter(|(_, way)| way.hypot() > 0.0);
    let (mut piece, mut before) = (pieces.next(), 0.0);
    let mut positions = Vec::with_capacity(count);
    for n in 0..count - 1 {
        let along = step * n as f64;
        while let Some((_, way)) = piece.filter(|(_, way)| before + way.hypot() <= along) {
            before += way.hypot();
            piece = pieces.next();
        }
        // Rounding may use up the last piece a little early.
        positions
            .push(piece.map_or(points[points.len() - 1], |(from, way)| from + way / way.hypot() * (along - before)));
    }
    positions.push(points[points.len() - 1]);
    positions
}
