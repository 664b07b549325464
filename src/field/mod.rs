//! The 2-PolyVector field: two unordered, sign-free directions per ink pixel.
//!
//! A pair of directions `u`, `v`, as unit complex numbers, is held by the coefficients of
//! `f(z) = (z^2 - u^2)(z^2 - v^2) = z^4 + c2 z^2 + c0`, that is `c0 = u^2 v^2` and `c2 = -(u^2 + v^2)`.
//! The coefficients do not change when `u` and `v` swap or flip sign, so they can be averaged,
//! smoothed and regressed, which angles cannot (Taktasheva et al. 2019, section 3; Diamanti et al. 2014).

mod frame;
#[cfg(feature = "npz")]
mod npz;
mod smooth;

pub use frame::{Frame, FrameField};
#[cfg(feature = "npz")]
pub use npz::write_npz;

use crate::error::{Error, Result};
use crate::raster::Raster;
use kurbo::Vec2;
use num_complex::Complex32;

/// The coefficients `(c0, c2)` of a pair of unit directions; the order and the signs do not matter.
pub fn encode(u: Vec2, v: Vec2) -> (Complex32, Complex32) {
    let square = |d: Vec2| {
        let z = Complex32::new(d.x as f32, d.y as f32);
        z * z
    };
    let (uu, vv) = (square(u), square(v));
    (uu * vv, -(uu + vv))
}

/// The two unit directions whose squares are the roots of `w^2 + c2 w + c0`, the stronger root first.
///
/// A double root (`c2^2 = 4 c0`) gives the same direction twice. `None` where both roots are too
/// small to have a direction or a coefficient is not finite.
pub fn decode(c0: Complex32, c2: Complex32) -> Option<Frame> {
    let root = (c2 * c2 - 4.0 * c0).sqrt();
    // Of the two signs, the one without cancellation; the other root follows from w1 w2 = c0.
    let sum = if (c2.conj() * root).re > 0.0 { -c2 - root } else { -c2 + root };
    let w1 = 0.5 * sum;
    let strong = w1.norm();
    if !is_defined(c0, strong) {
        return None;
    }
    let w2 = c0 / w1;
    let u = direction(w1);
    let v = if w2.norm() < 1e-3 * strong { u } else { direction(w2) };
    Some(Frame { u, v })
}

/// Whether coefficients whose stronger root has this modulus have directions.
pub(crate) fn is_defined(c0: Complex32, strong: f32) -> bool {
    strong.is_finite() && c0.is_finite() && strong >= 1e-3
}

fn direction(w: Complex32) -> Vec2 {
    Vec2::from_angle(0.5 * f64::from(w.arg()))
}

/// The coefficients of one pixel, by its number row by row, and their confidence.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pixel {
    pub index: usize,
    pub c0: Complex32,
    pub c2: Complex32,
    pub confidence: f32,
}

/// A 2-PolyVector field over an image, undefined off the ink.
#[derive(Clone, Debug, PartialEq)]
pub struct PolyVectorField {
    c0: Raster<Complex32>,
    c2: Raster<Complex32>,
    confidence: Raster<f32>,
}

impl PolyVectorField {
    /// A field from its coefficients and a confidence in `[0, 1]`, 0 where the field is undefined.
    ///
    /// Pixels with a value that is not finite become undefined.
    ///
    /// # Errors
    /// [`Error::FieldSize`] when the three grids differ in size.
    pub fn new(c0: Raster<Complex32>, c2: Raster<Complex32>, confidence: Raster<f32>) -> Result<Self> {
        for size in [c2.size(), confidence.size()] {
            if size != c0.size() {
                return Err(Error::FieldSize { field: size, image: c0.size() });
            }
        }
        let mut field = Self { c0, c2, confidence };
        let coefficients = field.c0.data().iter().zip(field.c2.data());
        for (confidence, (c0, c2)) in field.confidence.data_mut().iter_mut().zip(coefficients) {
            let finite = c0.is_finite() && c2.is_finite() && confidence.is_finite();
            *confidence = if finite { confidence.clamp(0.0, 1.0) } else { 0.0 };
        }
        Ok(field)
    }

    /// A field that is defined at some pixels only.
    pub(crate) fn from_parts(width: usize, height: usize, parts: Vec<Vec<Pixel>>) -> Self {
        let (c0, c2) = (Raster::zeroed(width, height), Raster::zeroed(width, height));
        let mut field = Self { c0, c2, confidence: Raster::zeroed(width, height) };
        for pixel in parts.into_iter().flatten() {
            field.c0.data_mut()[pixel.index] = pixel.c0;
            field.c2.data_mut()[pixel.index] = pixel.c2;
            let finite = pixel.c0.is_finite() && pixel.c2.is_finite() && pixel.confidence.is_finite();
            field.confidence.data_mut()[pixel.index] = if finite { pixel.confidence.clamp(0.0, 1.0) } else { 0.0 };
        }
        field
    }

    /// A field from two directions per pixel; `None` where there is no ink.
    pub fn from_directions(width: usize, height: usize, f: impl Fn(usize, usize) -> Option<(Vec2, Vec2)>) -> Self {
        let zero = Complex32::new(0.0, 0.0);
        let mut field = Self {
            c0: Raster::filled(width, height, zero),
            c2: Raster::filled(width, height, zero),
            confidence: Raster::filled(width, height, 0.0),
        };
        for y in 0..height {
            for x in 0..width {
                if let Some((u, v)) = f(x, y) {
                    (field.c0[(x, y)], field.c2[(x, y)]) = encode(u, v);
                    field.confidence[(x, y)] = 1.0;
                }
            }
        }
        field
    }

    /// Width and height in pixels.
    pub fn size(&self) -> (usize, usize) {
        self.c0.size()
    }

    /// The constant coefficient `c0 = u^2 v^2`, `[height, width]`.
    pub fn c0(&self) -> &Raster<Complex32> {
        &self.c0
    }

    /// The quadratic coefficient `c2 = -(u^2 + v^2)`, `[height, width]`.
    pub fn c2(&self) -> &Raster<Complex32> {
        &self.c2
    }

    /// Confidence in `[0, 1]`; 0 where the field is undefined.
    pub fn confidence(&self) -> &Raster<f32> {
        &self.confidence
    }

    /// Takes the directions of another field of its size where it has none.
    pub(crate) fn fill_from(&mut self, other: &Self) {
        let ours = self.c0.data_mut().iter_mut().zip(self.c2.data_mut()).zip(self.confidence.data_mut());
        let theirs = other.c0.data().iter().zip(other.c2.data()).zip(other.confidence.data());
        for (((c0, c2), confidence), ((&other_c0, &other_c2), &other)) in ours.zip(theirs) {
            if *confidence == 0.0 {
                (*c0, *c2, *confidence) = (other_c0, other_c2, other);
            }
        }
    }

    /// The field on a grid of another size, by the nearest defined source pixel within one pixel.
    ///
    /// Directions do not change under a uniform scaling, so neither do the coefficients.
    pub fn resized(&self, width: usize, height: usize) -> Self {
        if self.size() == (width, height) {
            return self.clone();
        }
        let (w, h) = self.size();
        let source = |x: usize, y: usize| {
            let sx = ((x as f64 + 0.5) * w as f64 / width as f64) as i64;
            let sy = ((y as f64 + 0.5) * h as f64 / height as f64) as i64;
            let near = [(0, 0), (-1, 0), (1, 0), (0, -1), (0, 1), (-1, -1), (1, -1), (-1, 1), (1, 1)];
            let defined = |&(dx, dy): &(i64, i64)| self.confidence.get(sx + dx, sy + dy).is_some_and(|c| c > 0.0);
            let (dx, dy) = near.into_iter().find(defined).unwrap_or((0, 0));
            ((sx + dx) as usize, (sy + dy) as usize)
        };
        Self {
            c0: Raster::from_fn(width, height, |x, y| self.c0[source(x, y)]),
            c2: Raster::from_fn(width, height, |x, y| self.c2[source(x, y)]),
            confidence: Raster::from_fn(width, height, |x, y| self.confidence[source(x, y)]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn apart(a: Vec2, b: Vec2) -> f64 {
        a.cross(b).abs().atan2(a.dot(b).abs())
    }

    fn pair_error(a: Frame, u: Vec2, v: Vec2) -> f64 {
        let straight = apart(a.u, u).max(apart(a.v, v));
        let swapped = apart(a.u, v).max(apart(a.v, u));
        straight.min(swapped)
    }

    proptest! {
        #[test]
        fn decode_undoes_encode(a in -4.0..4.0f64, b in -4.0..4.0f64) {
            let (u, v) = (Vec2::from_angle(a), Vec2::from_angle(b));
            let (c0, c2) = encode(u, v);
            let frame = decode(c0, c2).unwrap();
            // f32 coefficients: near a double root the roots move by the square root of the rounding error.
            let tolerance = if apart(u, v) < 0.05 { 2e-3 } else { 2e-5 };
            prop_assert!(pair_error(frame, u, v) < tolerance);
        }

        #[test]
        fn coefficients_ignore_order_and_sign(a in -4.0..4.0f64, b in -4.0..4.0f64) {
            let (u, v) = (Vec2::from_angle(a), Vec2::from_angle(b));
            let (c0, c2) = encode(u, v);
            for (p, q) in [(v, u), (-u, v), (u, -v), (-v, -u)] {
                let (d0, d2) = encode(p, q);
                prop_assert!((c0 - d0).norm() < 1e-6 && (c2 - d2).norm() < 1e-6);
            }
        }

        #[test]
        fn a_double_root_is_one_direction(a in -4.0..4.0f64) {
            let u = Vec2::from_angle(a);
            let (c0, c2) = encode(u, u);
            let frame = decode(c0, c2).unwrap();
            prop_assert!(pair_error(frame, u, u) < 2e-3);
        }
    }

    #[test]
    fn nothing_decodes_to_nothing() {
        let zero = Complex32::new(0.0, 0.0);
        assert!(decode(zero, zero).is_none());
        assert!(decode(Complex32::new(f32::NAN, 0.0), zero).is_none());
        assert!(decode(zero, Complex32::new(f32::INFINITY, 0.0)).is_none());
    }

    #[test]
    fn values_that_are_not_finite_become_undefined() {
        let c0 = Raster::filled(2, 1, Complex32::new(f32::NAN, 0.0));
        let c2 = Raster::filled(2, 1, Complex32::new(0.0, 0.0));
        let field = PolyVectorField::new(c0, c2, Raster::filled(2, 1, 1.0)).unwrap();
        assert_eq!(field.confidence().data(), [0.0, 0.0]);
    }

    #[test]
    fn grids_of_different_sizes_are_refused() {
        let zero = Complex32::new(0.0, 0.0);
        let result =
            PolyVectorField::new(Raster::filled(2, 2, zero), Raster::filled(2, 3, zero), Raster::filled(2, 2, 1.0));
        assert!(matches!(result, Err(Error::FieldSize { .. })));
    }
}
