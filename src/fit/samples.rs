//! The points of a section with weights, and sums over runs of them in constant time.

use crate::graph::TrailPoint;
use kurbo::{Point, Vec2};

/// Weight of a point inside a junction, where the ink does not tell where the line is.
const JUNCTION_WEIGHT: f64 = 0.01;

/// Points along a section.
#[derive(Clone, Debug)]
pub(super) struct Samples {
    pub points: Vec<Point>,
    pub weights: Vec<f64>,
    /// Arc length up to each point.
    pub arc: Vec<f64>,
    centre: Point,
    sums: Vec<Moments>,
}

/// Weighted sums over the first points, about a common centre; `z = x^2 + y^2`.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Moments {
    pub w: f64,
    pub x: f64,
    pub y: f64,
    pub xx: f64,
    pub xy: f64,
    pub yy: f64,
    pub z: f64,
    pub xz: f64,
    pub yz: f64,
    pub zz: f64,
}

impl Moments {
    fn each(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        Self {
            w: f(self.w, other.w),
            x: f(self.x, other.x),
            y: f(self.y, other.y),
            xx: f(self.xx, other.xx),
            xy: f(self.xy, other.xy),
            yy: f(self.yy, other.yy),
            z: f(self.z, other.z),
            xz: f(self.xz, other.xz),
            yz: f(self.yz, other.yz),
            zz: f(self.zz, other.zz),
        }
    }

    fn of(d: Vec2, w: f64) -> Self {
        let (x, y, z) = (d.x, d.y, d.hypot2());
        let one = Self { w: 1.0, x, y, xx: x * x, xy: x * y, yy: y * y, z, xz: x * z, yz: y * z, zz: z * z };
        one.each(one, |a, _| a * w)
    }
}

impl Samples {
    pub fn new(points: Vec<Point>, weights: Vec<f64>) -> Self {
        let mut arc = vec![0.0; points.len()];
        for k in 1..points.len() {
            arc[k] = arc[k - 1] + (points[k] - points[k - 1]).hypot();
        }
        let total = points.iter().fold(Vec2::ZERO, |s, p| s + p.to_vec2());
        let centre = (total / points.len().max(1) as f64).to_point();
        let mut sums = vec![Moments::default(); points.len() + 1];
        for k in 0..points.len() {
            sums[k + 1] = sums[k].each(Moments::of(points[k] - centre, weights[k]), |a, b| a + b);
        }
        Self { points, weights, arc, centre, sums }
    }

    /// Samples from points of a trail.
    pub fn from_trail(points: &[TrailPoint]) -> Self {
        let weight = |p: &TrailPoint| if p.width.is_finite() { 1.0 } else { JUNCTION_WEIGHT };
        Self::new(points.iter().map(|p| p.point).collect(), points.iter().map(weight).collect())
    }

    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// Arc length of the whole section.
    pub fn length(&self) -> f64 {
        self.arc.last().copied().unwrap_or(0.0)
    }

    /// Sums over points `from..=to`, about [`Samples::centre`].
    pub fn moments(&self, from: usize, to: usize) -> Moments {
        self.sums[to + 1].each(self.sums[from], |a, b| a - b)
    }

    /// How far points scatter about a smooth line, in pixels: from third differences over spans of `span` pixels,
    /// which neither slope nor curvature moves.
    pub fn scatter(&self, span: f64) -> f64 {
        let n = self.len();
        let m = ((span * n as f64 / self.length().max(1e-9)) as usize).max(1);
        let third = |k: usize| {
            let [a, b, c, d] = [0, 1, 2, 3].map(|i| self.points[k + i * m].to_vec2());
            (3.0 * (b - c) + d - a).hypot()
        };
        let mut differences: Vec<f64> = (0..n.saturating_sub(3 * m)).map(third).collect();
        if differences.is_empty() {
            return 0.0;
        }
        let middle = differences.len() / 2;
        let median = *differences.select_nth_unstable_by(middle, f64::total_cmp).1;
        // The variance of the sum is 1 + 9 + 9 + 1 times a point's; 0.6745 is the normal law's median.
        median / (0.6745 * 20f64.sqrt())
    }

    /// The point that sums are taken about.
    pub fn centre(&self) -> Point {
        self.centre
    }
}
