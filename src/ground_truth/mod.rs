//! The exact field of a drawing, to train on and to measure against.
//!
//! Taktasheva et al. 2019, section 3, leaves three rules: `u` is the tangent of the stroke; `v` is the tangent of
//! the other curve where two curves share a pixel; `v` is the normal far from any intersection, with an
//! interpolation between. Here that means:
//!
//! * Tangents come from the curves' own derivatives, at the point of the centreline nearest the pixel's centre.
//! * A pixel is shared when both centrelines are within half a width and half a pixel of its centre. A corner
//!   within one stroke is where its two arms share pixels.
//! * Between a shared pixel and [`REACH`] widths from it, `v^2` goes linearly from the other curve's squared tangent
//!   to the squared normal. As `f` is a product of `w - u^2` and `w - v^2`, this is the linear blend of the
//!   two polynomials: `u` stays exact, and the decoded `v` turns the short way round.
//! * `c0` and `c2` are then smoothed by a Gaussian of [`SMOOTHING`] pixels, over ink pixels only.

mod cover;
mod curve;
#[cfg(test)]
mod tests;

use crate::drawing::Drawing;
use crate::field::PolyVectorField;
use crate::raster::{Mask, Raster};
use cover::{Covers, cover, line_angle, span};
use curve::{CORNER, Curve, curves};
use num_complex::Complex32;

/// Line widths from a shared pixel to where `v` is the normal.
pub const REACH: f64 = 1.5;

/// Standard deviation in pixels of the smoothing of the coefficients inside the ink.
pub const SMOOTHING: f64 = 0.45;

/// What holds at a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// No stroke touches the pixel.
    Paper,
    /// One stroke, far from any intersection.
    Far,
    /// One stroke, near an intersection.
    Between,
    /// Two strokes, or two arms of a corner.
    Shared,
}

/// The field of a drawing with what it was made from; all grids `[height, width]`.
#[derive(Clone, Debug)]
pub struct FieldTruth {
    /// The smoothed coefficients; confidence 1 where a stroke touches the pixel, else 0.
    pub field: PolyVectorField,
    /// Squared tangent of the nearest curve, before smoothing.
    pub tangent: Raster<Complex32>,
    /// Squared second direction, before smoothing; under unit length on [`Place::Between`].
    pub other: Raster<Complex32>,
    /// Which rule gave `other`.
    pub place: Raster<Place>,
    /// Pixels whose centre is inside a stroke.
    pub ink: Mask,
    /// Pixels within two line widths of a crossing, a branching or a corner of over 15 degrees.
    pub near_junction: Mask,
}

/// The field of a drawing on its own pixel grid.
pub fn field(drawing: &Drawing) -> FieldTruth {
    let (width, height) = (drawing.width.ceil().max(1.0) as usize, drawing.height.ceil().max(1.0) as usize);
    let curves = curves(drawing);
    let covers = cover(&curves, width, height);
    let mut truth = unsmoothed(&curves, &covers, width, height);
    interpolate(&curves, &covers, &mut truth);
    let (c0, c2) = coefficients(&truth);
    truth.field = smooth(&c0, &c2, &truth.place);
    truth
}

/// Applies the first two rules and, everywhere else on the ink, the third.
fn unsmoothed(curves: &[Curve], covers: &[Covers], width: usize, height: usize) -> FieldTruth {
    let zero = Raster::filled(width, height, Complex32::default());
    let mut truth = FieldTruth {
        field: PolyVectorField::from_directions(width, height, |_, _| None),
        tangent: zero.clone(),
        other: zero,
        place: Raster::filled(width, height, Place::Paper),
        ink: Raster::filled(width, height, false),
        near_junction: Raster::filled(width, height, false),
    };
    for (i, covers) in covers.iter().enumerate() {
        let Some(first) = covers.nearest() else { continue };
        let second = covers.second(curves);
        let u = squared(first.angle);
        truth.tangent.data_mut()[i] = u;
        truth.other.data_mut()[i] = second.map_or(-u, |c| squared(c.angle));
        truth.place.data_mut()[i] = if second.is_some() { Place::Shared } else { Place::Far };
        truth.ink.data_mut()[i] = covers.iter().any(|c| c.distance <= 0.5 * curves[c.curve as usize].width);
    }
    truth
}

/// Turns the normal towards the other curve's tangent on the pixels around each shared one.
fn interpolate(curves: &[Curve], covers: &[Covers], truth: &mut FieldTruth) {
    let (width, height) = truth.place.size();
    let mut nearest = vec![(f64::INFINITY, 0.0f64); width * height];
    for y in 0..height {
        for x in 0..width {
            let shared = &covers[y * width + x];
            let (Some(first), Some(second)) = (shared.nearest(), shared.second(curves)) else { continue };
            let [a, b] = [first, second].map(|c| curves[c.curve as usize].width);
            let pen = a.max(b);
            let sharp = line_angle(first.angle, second.angle) > CORNER;
            for qy in span(y as f64 + 0.5, 2.0 * pen, height) {
                for qx in span(x as f64 + 0.5, 2.0 * pen, width) {
                    let distance = (x as f64 - qx as f64).hypot(y as f64 - qy as f64);
                    let q = qy * width + qx;
                    if sharp && distance <= 1.5 * pen {
                        truth.near_junction.data_mut()[q] = true;
                    }
                    let t = distance / (REACH * pen);
                    if let (true, Some(own)) = (t < nearest[q].0.min(1.0), covers[q].nearest()) {
                        // The other of the pair is the one that the pixel itself does not lie on.
                        let on = |c: &cover::Cover| c.curve == own.curve;
                        let other = match (on(first), on(second)) {
                            (true, true) => far_direction(own, first, second),
                            (true, false) => second.angle,
                            (false, true) => first.angle,
                            (false, false) => continue,
                        };
                        nearest[q] = (t, other);
                    }
                }
            }
        }
    }
    for (i, &(t, angle)) in nearest.iter().enumerate() {
        if truth.place.data()[i] == Place::Far && t < 1.0 {
            let normal = -truth.tangent.data()[i];
            truth.other.data_mut()[i] = squared(angle) * (1.0 - t as f32) + normal * t as f32;
            truth.place.data_mut()[i] = Place::Between;
        }
    }
}

/// Of two branches of one curve, the direction of the one that is further along the curve from `own`.
fn far_direction(own: &cover::Cover, a: &cover::Cover, b: &cover::Cover) -> f64 {
    if (own.arc - a.arc).abs() < (own.arc - b.arc).abs() { b.angle } else { a.angle }
}

fn squared(angle: f64) -> Complex32 {
    Complex32::from_polar(1.0, (2.0 * angle) as f32)
}

fn coefficients(truth: &FieldTruth) -> (Raster<Complex32>, Raster<Complex32>) {
    let pairs = || truth.tangent.data().iter().zip(truth.other.data());
    let (width, height) = truth.place.size();
    let grid = |data| Raster::from_vec(width, height, data).expect("one sample a pixel");
    (grid(pairs().map(|(u, v)| u * v).collect()), grid(pairs().map(|(u, v)| -(u + v)).collect()))
}

/// Gaussian smoothing of both coefficients, weights renormalised over the ink pixels of the window.
fn smooth(c0: &Raster<Complex32>, c2: &Raster<Complex32>, place: &Raster<Place>) -> PolyVectorField {
    let (width, height) = place.size();
    let weight = |d: i64| (-(d * d) as f64 / (2.0 * SMOOTHING * SMOOTHING)).exp() as f32;
    let weights = [weight(2), weight(1), 1.0, weight(1), weight(2)];
    let average = |c: &Raster<Complex32>, x: usize, y: usize| {
        let (mut sum, mut total) = (Complex32::default(), 0.0);
        for (wy, dy) in weights.iter().zip(-2i64..) {
            for (wx, dx) in weights.iter().zip(-2i64..) {
                let (qx, qy) = (x as i64 + dx, y as i64 + dy);
                if place.get(qx, qy).is_some_and(|p| p != Place::Paper) {
                    sum += c[(qx as usize, qy as usize)] * (wx * wy);
                    total += wx * wy;
                }
            }
        }
        sum / total
    };
    let inked = |x: usize, y: usize| place[(x, y)] != Place::Paper;
    let smoothed = |c: &Raster<Complex32>| {
        Raster::from_fn(width, height, |x, y| if inked(x, y) { average(c, x, y) } else { Complex32::default() })
    };
    let confidence = place.map(|p| if p == Place::Paper { 0.0 } else { 1.0 });
    PolyVectorField::new(smoothed(c0), smoothed(c2), confidence).expect("all grids have one size")
}
