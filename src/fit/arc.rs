//! Circular arcs by algebraic least squares (Kasa 1976).

use super::samples::Samples;
use kurbo::{Arc, Point, Vec2};
use std::f64::consts::TAU;

/// A fitted circle.
#[derive(Clone, Copy, Debug)]
pub(super) struct FittedCircle {
    pub centre: Point,
    pub radius: f64,
    /// Weighted sum of squared distances, to first order.
    pub error: f64,
}

impl FittedCircle {
    /// The point of the circle nearest to `p`.
    pub fn foot(&self, p: Point) -> Point {
        self.centre + (p - self.centre).normalize() * self.radius
    }

    /// How far `p` lies outside.
    pub fn offset(&self, p: Point) -> f64 {
        (p - self.centre).hypot() - self.radius
    }

    /// Unit tangent at the point nearest to `p`, turning from x towards y.
    pub fn tangent(&self, p: Point) -> Vec2 {
        (p - self.centre).normalize().turn_90()
    }
}

/// The circle with the least weighted sum of squared algebraic distances to samples `from..=to`: minimises
/// `sum w (z + A x + B y + C)^2` with `z = x^2 + y^2`. `None` when the samples lie on a line.
pub(super) fn fit_circle(samples: &Samples, from: usize, to: usize) -> Option<FittedCircle> {
    let m = samples.moments(from, to);
    if m.w <= 0.0 {
        return None;
    }
    // Central moments about the run's own mean keep the equations well conditioned.
    let (mx, my, mz) = (m.x / m.w, m.y / m.w, m.z / m.w);
    let (xx, xy, yy) = (m.xx / m.w - mx * mx, m.xy / m.w - mx * my, m.yy / m.w - my * my);
    let (xz, yz) = (m.xz / m.w - mx * mz, m.yz / m.w - my * mz);
    let zz = m.zz / m.w - mz * mz;
    let det = xx * yy - xy * xy;
    if det <= 1e-9 * (xx + yy) * (xx + yy) {
        return None;
    }
    let a = -(yy * xz - xy * yz) / det;
    let b = -(xx * yz - xy * xz) / det;
    let c = -(mz + a * mx + b * my);
    let centre = Vec2::new(-0.5 * a, -0.5 * b);
    let radius2 = centre.hypot2() - c;
    if radius2 <= 0.0 {
        return None;
    }
    let algebraic = (zz + a * xz + b * yz).max(0.0) * m.w;
    Some(FittedCircle {
        centre: samples.centre() + centre,
        radius: radius2.sqrt(),
        // z + Ax + By + C = (d - r)(d + r), about 2r times the distance.
        error: algebraic / (4.0 * radius2),
    })
}

/// The circular arc from `start` to `end` that leaves `start` along the unit vector `tangent`; `None` for a
/// straight line.
pub(super) fn arc_from_tangent(start: Point, tangent: Vec2, end: Point) -> Option<Arc> {
    let chord = end - start;
    let normal = tangent.turn_90();
    let height = chord.dot(normal);
    if height.abs() < 1e-6 * chord.hypot().max(1e-9) {
        return None;
    }
    // |start + r n - end| = |r|.
    let r = chord.hypot2() / (2.0 * height);
    let centre = start + normal * r;
    let angle = |p: Point| (p - centre).atan2();
    let start_angle = angle(start);
    let sweep = (angle(end) - start_angle).rem_euclid(TAU);
    let sweep_angle = if r > 0.0 { sweep } else { sweep - TAU };
    Some(Arc { center: centre, radii: Vec2::new(r.abs(), r.abs()), start_angle, sweep_angle, x_rotation: 0.0 })
}

/// Unit tangent at the end of an arc, in drawing direction.
pub(super) fn end_tangent(arc: &Arc) -> Vec2 {
    let radial = Vec2::from_angle(arc.start_angle + arc.sweep_angle);
    radial.turn_90() * arc.sweep_angle.signum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_of_a_circle_give_the_circle() {
        let at = |t: f64| Point::new(70.0, -20.0) + Vec2::from_angle(t) * 13.0;
        let points: Vec<Point> = (0..40).map(|k| at(0.05 * f64::from(k))).collect();
        let samples = Samples::new(points, vec![1.0; 40]);
        let circle = fit_circle(&samples, 3, 37).unwrap();
        assert!((circle.radius - 13.0).abs() < 1e-6 && circle.error < 1e-9);
        assert!((circle.centre - Point::new(70.0, -20.0)).hypot() < 1e-6);
    }

    #[test]
    fn an_arc_from_its_tangent_ends_where_it_should() {
        for end in [Point::new(5.0, 5.0), Point::new(5.0, -5.0), Point::new(-1.0, 4.0)] {
            let arc = arc_from_tangent(Point::ORIGIN, Vec2::new(1.0, 0.0), end).unwrap();
            let last = arc.center + arc.radii.x * Vec2::from_angle(arc.start_angle + arc.sweep_angle);
            assert!((last - end).hypot() < 1e-9);
        }
    }
}
