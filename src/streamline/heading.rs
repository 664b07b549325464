//! Where a line is going, from where it has been.

use kurbo::{Point, Vec2};

/// Direction and curvature at the end of a run of points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Tail {
    /// Smoothed position at the end.
    pub point: Point,
    /// Unit tangent at the end, in walking direction.
    pub heading: Vec2,
    /// Signed curvature at the end, 1/px; positive turns from x towards y.
    pub curvature: f64,
}

impl Tail {
    /// Fits a parabola over the chord of the points, oldest first; `None` for fewer than two distinct points.
    ///
    /// `noise` is the expected deviation of a point in pixels: curvature that the noise explains is not kept.
    pub fn fit(points: &[Point], noise: f64) -> Option<Self> {
        let (&first, &last) = (points.first()?, points.last()?);
        let length = (last - first).hypot();
        if length < 1e-6 {
            return None;
        }
        let along = (last - first) / length;
        let across = along.turn_90();
        let n = points.len() as f64;
        // Coordinates in [-1, 1] about the middle of the chord.
        let half = 0.5 * length;
        let local = |p: &Point| {
            let d = *p - first;
            (d.dot(along) / half - 1.0, d.dot(across))
        };
        let (mut s1, mut s2, mut s3, mut s4, mut t0, mut t1, mut t2) = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
        for (x, y) in points.iter().map(local) {
            let xx = x * x;
            (s1, s2, s3, s4) = (s1 + x, s2 + xx, s3 + xx * x, s4 + xx * xx);
            (t0, t1, t2) = (t0 + y, t1 + y * x, t2 + y * xx);
        }
        // Gauss elimination of the normal equations of y = a + b x + c x^2.
        let (b11, b12, r1) = (s2 - s1 * s1 / n, s3 - s1 * s2 / n, t1 - s1 * t0 / n);
        let (b22, r2) = (s4 - s2 * s2 / n, t2 - s2 * t0 / n);
        let rest = b22 - b12 * b12 / b11;
        let mut c = if points.len() >= 6 && rest > 1e-9 { (r2 - b12 * r1 / b11) / rest } else { 0.0 };
        if rest > 1e-9 {
            // Wiener shrinkage; neighbouring points share pixels, so their errors count four times.
            let variance = 4.0 * noise * noise / rest;
            c *= c * c / (c * c + variance);
        }
        let b = if b11 > 1e-9 { (r1 - b12 * c) / b11 } else { 0.0 };
        let a = (t0 - b * s1 - c * s2) / n;
        let slope = (b + 2.0 * c) / half;
        let heading = (along + across * slope).normalize();
        let curvature = 2.0 * c / (half * half) / (1.0 + slope * slope).powf(1.5);
        Some(Self { point: last + across * (a + b + c), heading, curvature })
    }
}

/// A unit vector turned by an angle in radians, from x towards y.
pub(crate) fn turned(v: Vec2, angle: f64) -> Vec2 {
    v.rotate_scale(Vec2::from_angle(angle))
}

/// Signed angle from one direction to another, in `(-pi, pi]`.
pub(crate) fn angle_between(a: Vec2, b: Vec2) -> f64 {
    a.cross(b).atan2(a.dot(b))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_arc_gives_its_tangent_and_curvature() {
        for radius in [20.0f64, 30.0, -50.0] {
            let at = |s: f64| Point::new(radius * (s / radius).sin(), radius * (1.0 - (s / radius).cos()));
            let points: Vec<Point> = (0..20).map(|k| at(0.5 * f64::from(k))).collect();
            let tail = Tail::fit(&points, 0.02).unwrap();
            assert!((tail.curvature * radius - 1.0).abs() < 0.1, "{tail:?}");
            assert!(angle_between(tail.heading, Vec2::from_angle(9.5 / radius)).abs() < 0.02);
            assert!((tail.point - at(9.5)).hypot() < 0.05);
        }
    }

    #[test]
    fn jitter_on_a_straight_line_is_not_curvature() {
        let points: Vec<Point> =
            (0..24).map(|k| Point::new(0.5 * f64::from(k), 0.1 * f64::from(k * 7 % 5) - 0.2)).collect();
        let tail = Tail::fit(&points, 0.15).unwrap();
        assert!(tail.curvature.abs() < 0.01 && tail.heading.y.abs() < 0.04, "{tail:?}");
    }
}
