//! Straight lines by total least squares.

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
}

impl FittedLine {
    /// How far `p` lies to one side.
    pub fn offset(&self, p: Point) -> f64 {
        self.direction.cross(p - self.point)
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
    FittedLine { point: samples.centre() + mean, direction, error: (0.5 * (a + c) - spread).max(0.0) }
}
