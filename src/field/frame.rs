//! Directions read from a field, at pixels and between them.

use super::{PolyVectorField, decode};
use crate::raster::floor;
use kurbo::{Point, Vec2};
use num_complex::Complex32;

/// Two unit directions; each stands for a line, so its sign carries no meaning.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// The direction of the stronger root.
    pub u: Vec2,
    /// The direction of the weaker root; equal to `u` at a double root.
    pub v: Vec2,
}

impl Frame {
    /// Whichever of `u`, `v`, `-u`, `-v` is nearest to a heading.
    pub fn nearest(&self, heading: Vec2) -> Vec2 {
        let (du, dv) = (self.u.dot(heading), self.v.dot(heading));
        let (root, dot) = if du.abs() >= dv.abs() { (self.u, du) } else { (self.v, dv) };
        if dot < 0.0 { -root } else { root }
    }
}

/// A decoded field that can be asked for directions at any point.
///
/// Labels `u` and `v` are not consistent from pixel to pixel, and on some fields cannot be: match them
/// along the walk with [`FrameField::along`].
#[derive(Clone, Debug)]
pub struct FrameField {
    field: PolyVectorField,
}

impl FrameField {
    /// Decodes a field.
    pub fn new(field: PolyVectorField) -> Self {
        Self { field }
    }

    /// The field that is decoded.
    pub fn field(&self) -> &PolyVectorField {
        &self.field
    }

    /// The frame of one pixel; `None` off the ink.
    pub fn at_pixel(&self, x: usize, y: usize) -> Option<Frame> {
        if self.field.confidence()[(x, y)] <= 0.0 {
            return None;
        }
        decode(self.field.c0()[(x, y)], self.field.c2()[(x, y)])
    }

    /// The frame at a point: the coefficients of the four nearest defined pixels, weighted bilinearly and
    /// by confidence, then decoded. `None` where no defined pixel is near.
    pub fn at(&self, p: Point) -> Option<Frame> {
        let (fx, fy) = (p.x - 0.5, p.y - 0.5);
        let (x0, y0) = (floor(fx), floor(fy));
        let (tx, ty) = ((fx - x0 as f64) as f32, (fy - y0 as f64) as f32);
        let (mut c0, mut c2, mut total) = (Complex32::default(), Complex32::default(), 0.0);
        for (dx, dy, weight) in
            [(0, 0, (1.0 - tx) * (1.0 - ty)), (1, 0, tx * (1.0 - ty)), (0, 1, (1.0 - tx) * ty), (1, 1, tx * ty)]
        {
            let (x, y) = (x0 + dx, y0 + dy);
            let Some(confidence) = self.field.confidence().get(x, y) else { continue };
            let weight = weight * confidence;
            if weight > 0.0 {
                let i = (x as usize, y as usize);
                c0 += self.field.c0()[i] * weight;
                c2 += self.field.c2()[i] * weight;
                total += weight;
            }
        }
        if total <= 1e-6 { None } else { decode(c0 / total, c2 / total) }
    }

    /// The direction at a point that continues a heading best; `None` where the field is undefined.
    pub fn along(&self, p: Point, heading: Vec2) -> Option<Vec2> {
        Some(self.at(p)?.nearest(heading))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn interpolation_keeps_a_constant_field_and_skips_undefined_pixels() {
        let (u, v) = (Vec2::from_angle(0.3), Vec2::from_angle(1.4));
        let field = FrameField::new(PolyVectorField::from_directions(6, 6, |x, _| (x < 3).then_some((u, v))));
        for p in [Point::new(1.2, 2.9), Point::new(2.9, 3.3), Point::new(3.3, 1.0)] {
            let heading = field.along(p, -v).unwrap();
            assert!((heading + v).hypot() < 1e-4, "{heading:?}");
        }
        assert!(field.at(Point::new(5.0, 3.0)).is_none());
    }
}
