//! Straight lines by total least squares.

use super::Tolerance;
use super::samples::Samples;
use kurbo::{Point, Vec2};

/// A fitted line.
#[derive(Clone, Copy, Debug)]
pub(super) struct FittedLine {
    pub point: Point,
    /// Unit direction, along increasing sample index.
    pub direction: Vec2,
    /// Weighted sum of squared distances.
    pub error: f64,
    /// Sum of the weights.
    weight: f64,
}

/// How far off a straight edge a rasteriser may put whole stretches of it, in pixels of the scan: one that looks at four
/// rows within a pixel draws an edge that is all but level in stairs of a quarter.
const STAIRS: f64 = 0.135;
/// The same for lines that are thinner than this and at less than this sine to an axis (6 degrees): few of their pixels are
/// full of ink, and tell less of where it is.
const STAIRS_THIN: f64 = 0.2;
const THIN: f64 = 2.75;
const LEVEL: f64 = 0.1;
/// Stairs lead from one side of the line to the other at least so often, by more than this many pixels of the scan: a bend
/// that is as flat does not.
const LEAST_STAIRS: usize = 3;
const STAIR: f64 = 0.02;
/// The running mean that tells stairs from what single points scatter by, in line widths.
const RUNNING: f64 = 3.0;

impl FittedLine {
    /// The weighted sum of squared distances but for the stairs that the line's ink was drawn in; `None` where samples
    /// `from..=to` show none.
    pub fn error_beside_stairs(&self, samples: &Samples, from: usize, to: usize, tolerance: Tolerance) -> Option<f64> {
        let Tolerance { width, pixel, .. } = tolerance;
        let is_level = self.direction.x.abs().min(self.direction.y.abs()) < LEVEL;
        let stairs = pixel * if is_level && width < THIN * pixel { STAIRS_THIN } else { STAIRS };
        if self.error > stairs * stairs * self.weight {
            return None;
        }
        let off = |k: usize| self.direction.cross(samples.points[k] - self.point);
        let weights = || samples.weights[from..=to].iter();
        let mut sums = Vec::with_capacity(to + 2 - from);
        sums.push((0.0, 0.0));
        for (k, weight) in (from..=to).zip(weights()) {
            let (sum, total) = sums[sums.len() - 1];
            sums.push((sum + weight * off(k), total + weight));
        }
        let spacing = (samples.arc[to] - samples.arc[from]) / (to - from).max(1) as f64;
        let half = (0.5 * RUNNING * width / spacing.max(1e-9)).ceil() as usize;
        let count = to + 1 - from;
        let (mut error, mut side, mut changes) = (0.0, 0.0, 0);
        for (k, weight) in weights().enumerate() {
            let (before, after) = (sums[k.saturating_sub(half)], sums[(k + half + 1).min(count)]);
            let mean = (after.0 - before.0) / (after.1 - before.1).max(1e-12);
            if mean.abs() > stairs {
                return None;
            }
            if mean.abs() > STAIR * pixel && mean.signum() != side {
                changes += usize::from(side != 0.0);
                side = mean.signum();
            }
            error += weight * (off(from + k) - mean).powi(2);
        }
        (changes >= LEAST_STAIRS).then_some(error)
    }
}

/// The line with the least weighted sum of squared distances to samples `from..=to`.
pub(super) fn fit_line(samples: &Samples, from: usize, to: usize) -> FittedLine {
    let m = samples.moments(from, to);
    let mean = Vec2::new(m.x, m.y) / m.w.max(1e-12);
    let (a, b, c) = (m.xx - m.w * mean.x * mean.x, m.xy - m.w * mean.x * mean.y, m.yy - m.w * mean.y * mean.y);
    let spread = (0.25 * (a - c) * (a - c) + b * b).sqrt();
    let angle = 0.5 * (2.0 * b).atan2(a - c);
    let chord = samples.points[to] - samples.points[from];
    let direction = Vec2::from_angle(angle);
    let direction = if direction.dot(chord) < 0.0 { -direction } else { direction };
    FittedLine { point: samples.centre() + mean, direction, error: (0.5 * (a + c) - spread).max(0.0), weight: m.w }
}
