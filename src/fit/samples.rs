//! The points of a section with weights, and sums over runs of them in constant time.

use super::price::Offset;
use crate::graph::TrailPoint;
use kurbo::{Point, Vec2};
use std::ops::RangeInclusive;

/// Weight of a point inside a junction, where the ink does not tell where the line is.
const JUNCTION_WEIGHT: f64 = 0.01;
/// At most this many points tell where the others lie beside a curve.
pub(super) const CLOSER: usize = 160;
/// No point of a curve lies further off it than this many times what is taken for noise.
pub(super) const WORST: f64 = 3.0;

/// Points along a section.
#[derive(Clone, Debug)]
pub(super) struct Samples {
    pub points: Vec<Point>,
    pub weights: Vec<f64>,
    /// Arc length up to each point.
    pub arc: Vec<f64>,
    /// Standard deviation of the ink's edge about a smooth line, in pixels.
    pub noise: f64,
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
        let arc = Self::lengths(&points);
        let total = points.iter().fold(Vec2::ZERO, |s, p| s + p.to_vec2());
        let centre = (total / points.len().max(1) as f64).to_point();
        let mut sums = vec![Moments::default(); points.len() + 1];
        for k in 0..points.len() {
            sums[k + 1] = sums[k].each(Moments::of(points[k] - centre, weights[k]), |a, b| a + b);
        }
        Self { points, weights, arc, noise: 0.0, centre, sums }
    }

    /// Length of the way up to each of some points.
    pub fn lengths(points: &[Point]) -> Vec<f64> {
        let mut arc = vec![0.0; points.len()];
        for k in 1..points.len() {
            arc[k] = arc[k - 1] + (points[k] - points[k - 1]).hypot();
        }
        arc
    }

    /// Samples from points of a trail.
    pub fn from_trail(points: &[TrailPoint]) -> Self {
        let weight = |p: &TrailPoint| if p.width.is_finite() { 1.0 } else { JUNCTION_WEIGHT };
        let samples = Self::new(points.iter().map(|p| p.point).collect(), points.iter().map(weight).collect());
        let noise: f64 = points.iter().map(|p| weight(p) * p.noise).sum();
        Self { noise: noise / samples.weights.iter().sum::<f64>().max(JUNCTION_WEIGHT), ..samples }
    }

    /// Where points `from..=to`, or as many of them as tell enough, lie beside a curve.
    pub fn offsets(&self, from: usize, to: usize, off: impl Fn(Point) -> f64) -> Vec<Offset> {
        let stride = (to - from).div_ceil(CLOSER).max(1);
        let offset = |k: usize| Offset { weight: self.weights[k], count: stride as f64, by: off(self.points[k]) };
        (from..=to).step_by(stride).map(offset).collect()
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

    /// The place and the unit tangent of the line at point `k`: those of the parabola over their chord that fits the points
    /// within a reach along the line best. `None` where they are too few.
    pub fn course(&self, k: usize, reach: f64) -> Option<(Point, Vec2)> {
        let from = self.arc.partition_point(|&a| a < self.arc[k] - reach);
        let to = self.arc.partition_point(|&a| a <= self.arc[k] + reach).saturating_sub(1);
        let chord = *self.points.get(to)? - self.points[from];
        if to < from + 6 || chord.hypot() < 1e-6 {
            return None;
        }
        let along = chord.normalize();
        let near = || (from..=to).map(|i| (self.weights[i], self.points[i] - self.points[k]));
        let sum = |f: &dyn Fn(f64, f64) -> f64| near().map(|(w, d)| w * f(d.dot(along), along.cross(d))).sum::<f64>();
        let weight = sum(&|_, _| 1.0);
        let mean = |f: &dyn Fn(f64, f64) -> f64| sum(f) / weight;
        // The normal equations of y = a + b x + c x^2, central.
        let (mx, mz, my) = (mean(&|x, _| x), mean(&|x, _| x * x), mean(&|_, y| y));
        let (xx, xz) = (mean(&|x, _| (x - mx).powi(2)), mean(&|x, _| (x - mx) * (x * x - mz)));
        let zz = mean(&|x, _| (x * x - mz).powi(2));
        let (xy, zy) = (mean(&|x, y| (x - mx) * (y - my)), mean(&|x, y| (x * x - mz) * (y - my)));
        let det = xx * zz - xz * xz;
        if det <= 1e-9 * xx * zz {
            return None;
        }
        let (b, c) = ((xy * zz - zy * xz) / det, (zy * xx - xy * xz) / det);
        let place = self.points[k] + along.turn_90() * (my - b * mx - c * mz);
        Some((place, (along + along.turn_90() * b).normalize()))
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

    /// Whether points `run` lie no further off a curve than a limit, root mean square, and none by [`WORST`] times as much.
    pub fn keep_to(&self, run: RangeInclusive<usize>, limit: f64, off: impl Fn(usize, Point) -> f64) -> bool {
        let (mut sum, mut weight, mut worst) = (0.0, 0.0, 0.0_f64);
        for k in run {
            let (w, off) = (self.weights[k], off(k, self.points[k]).abs());
            (sum, weight, worst) = (sum + w * off * off, weight + w, worst.max(w * off));
        }
        sum <= limit * limit * weight && worst <= WORST * limit
    }

    /// The point that sums are taken about.
    pub fn centre(&self) -> Point {
        self.centre
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_course_of_a_noisy_arc_is_its_tangent() {
        for radius in [12.0, 40.0, 400.0] {
            for turned in [0.0, 1.0, 2.5, 4.0] {
                let at = |s: f64| Point::ORIGIN + radius * Vec2::from_angle(turned + s / radius);
                // Off by as much to either side in turn.
                let off = |k: i32| 0.05 * f64::from(k.rem_euclid(3) - 1);
                let point = |k: i32| at(0.5 * f64::from(k)) + Vec2::from_angle(turned) * off(k);
                let samples = Samples::new((-12..=12).map(point).collect(), vec![1.0; 25]);
                let (place, tangent) = samples.course(12, 5.0).unwrap();
                let truth = Vec2::from_angle(turned).turn_90();
                assert!((place - at(0.0)).hypot() < 0.06, "{radius} {turned}: {place:?}");
                assert!(
                    tangent.cross(truth).abs() < 0.01 && tangent.dot(truth) > 0.0,
                    "{radius} {turned}: {tangent:?}"
                );
            }
        }
    }
}
