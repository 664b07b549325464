//! Moments of gradients to fourth order, and the 2-PolyVector field that fits them best.
//!
//! Around a pixel, an edge of direction `t` (unit complex, normal to the gradient) should be a root of
//! `t^4 + c2 t^2 + c0`. Dividing by `t^2` and writing `p = t^2`, the weighted least squares over all edges
//! nearby, `min sum g |p + c2 + c0 conj(p)|^2`, needs only the moments `m0 = sum g`, `m2 = sum g p`,
//! `m4 = sum g p^2`: a structure tensor (`m0`, `m2`) carried to fourth order. It finds both directions at a
//! crossing where the plain tensor finds their mean. With one direction only, the problem is singular, and a
//! small prior pulls the second root to the normal of the first.

use crate::raster::Raster;
use num_complex::Complex32;
use rayon::prelude::*;

/// Sum of squared gradients and its second and fourth moments: `[m0, Re m2, Im m2, Re m4, Im m4]`.
pub(crate) type Moments = [f32; 5];

/// Squared gradients below this are paper.
const FLAT: f32 = 4e-9;

/// Moments of each pixel's own gradient (Scharr's 3x3 derivative), weighted by its square; the edge pixels are
/// repeated outside.
pub(crate) fn gradients(ink: &Raster<f32>) -> Raster<Moments> {
    let (width, height) = ink.size();
    let rows: Vec<Vec<Moments>> = (0..height)
        .into_par_iter()
        .map(|y| {
            let row = |dy: i64| ink.row((y as i64 + dy).clamp(0, height as i64 - 1) as usize);
            let (above, here, below) = (row(-1), row(0), row(1));
            (0..width)
                .map(|x| {
                    let (l, r) = (x.saturating_sub(1), (x + 1).min(width - 1));
                    let gx = (3.0 * (above[r] - above[l] + below[r] - below[l]) + 10.0 * (here[r] - here[l])) / 16.0;
                    let gy = (3.0 * (below[l] - above[l] + below[r] - above[r]) + 10.0 * (below[x] - above[x])) / 16.0;
                    let energy = gx * gx + gy * gy;
                    if energy < FLAT {
                        return [0.0; 5];
                    }
                    // The tangent is the gradient turned by 90 degrees, t = i g, so t^2 = -g^2.
                    let t2 = -Complex32::new(gx, gy) * Complex32::new(gx, gy);
                    let t4 = t2 * t2 / energy;
                    [energy, t2.re, t2.im, t4.re, t4.im]
                })
                .collect()
        })
        .collect();
    Raster::from_vec(width, height, rows.concat()).expect("one row per row")
}

/// The coefficients that fit the moments best, and a confidence; zeros without gradients.
///
/// `prior` is the weight of the prior that the second direction is normal to the first, as a share of `m0`.
pub(crate) fn fit(m: &Moments, prior: f32) -> (Complex32, Complex32, f32) {
    let zero = Complex32::new(0.0, 0.0);
    let m0 = m[0];
    if m0 < FLAT {
        return (zero, zero, 0.0);
    }
    let (m2, m4) = (Complex32::new(m[1], m[2]) / m0, Complex32::new(m[3], m[4]) / m0);
    let coherence = m2.norm();
    // The prior's c0 is -p^2 for the one direction p: the root -p is the normal. It fades where the
    // plain tensor has no direction to offer.
    let single = if coherence > 1e-6 { -(m2 / coherence) * (m2 / coherence) } else { zero };
    let prior = prior * coherence * coherence;
    // Normal equations of sum |p + c2 + c0 conj(p)|^2 + prior (|c2|^2 + |c0 - single|^2):
    //   (1 + prior) c2 + conj(m2) c0 = -m2
    //   m2 c2 + (1 + prior) c0 = -m4 + prior single
    let a = 1.0 + prior;
    let determinant = a * a - m2.norm_sqr() + 1e-6;
    let (r2, r0) = (-m2, -m4 + single * prior);
    let c2 = (r2 * a - m2.conj() * r0) / determinant;
    let c0 = (r0 * a - m2 * r2) / determinant;
    (c0, c2, coherence.max(m4.norm()).clamp(0.05, 1.0))
}
