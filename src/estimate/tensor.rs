//! A field from local gradients, without a network.
//!
//! Around a pixel, an edge of direction `t` (unit complex, normal to the gradient) should be a root of
//! `t^4 + c2 t^2 + c0`. Dividing by `t^2` and writing `p = t^2`, the weighted least squares over all edges
//! nearby, `min sum g |p + c2 + c0 conj(p)|^2`, needs only the moments `m0 = sum g`, `m2 = sum g p`,
//! `m4 = sum g p^2`: a structure tensor (`m0`, `m2`) carried to fourth order. It finds both directions at a
//! crossing where the plain tensor finds their mean. With one direction only, the problem is singular, and a
//! small prior pulls the second root to the normal of the first.

use super::FieldEstimator;
use crate::cancel::Cancel;
use crate::clean::LineImage;
use crate::error::Result;
use crate::field::PolyVectorField;
use crate::raster::Raster;
use num_complex::Complex32;
use rayon::prelude::*;

/// The fourth-order structure tensor.
#[derive(Clone, Debug)]
pub struct StructureTensor {
    /// Standard deviation of the neighbourhood in line widths.
    pub reach: f64,
    /// Weight of the prior that the second direction is normal to the first, as a share of the gradient energy.
    pub prior: f32,
}

impl Default for StructureTensor {
    fn default() -> Self {
        Self { reach: 0.55, prior: 0.06 }
    }
}

/// Sum of squared gradients and its second and fourth moments: `[m0, Re m2, Im m2, Re m4, Im m4]`.
type Moments = [f32; 5];

impl FieldEstimator for StructureTensor {
    fn name(&self) -> &str {
        "tensor"
    }

    fn estimate(&self, image: &LineImage) -> Result<PolyVectorField> {
        self.estimate_until(image, &Cancel::default())
    }

    fn estimate_until(&self, image: &LineImage, cancel: &Cancel) -> Result<PolyVectorField> {
        cancel.check()?;
        let sigma = (self.reach * image.line_width).max(1.2) as f32;
        let gradients = gradient_moments(&image.ink);
        cancel.check()?;
        let moments = blur_on(&gradients, &image.mask, sigma, cancel)?;
        let solved: Vec<_> = moments.data().par_iter().map(|m| self.solve(m)).collect();
        let (width, height) = image.ink.size();
        let field = |f: fn(&(Complex32, Complex32, f32)) -> Complex32| {
            Raster::from_vec(width, height, solved.iter().map(f).collect()).expect("one solution per pixel")
        };
        let confidence = Raster::from_vec(width, height, solved.iter().map(|s| s.2).collect()).expect("likewise");
        PolyVectorField::new(field(|s| s.0), field(|s| s.1), confidence)
    }
}

impl StructureTensor {
    /// The coefficients that fit the moments best, and a confidence; zeros without gradients.
    fn solve(&self, m: &Moments) -> (Complex32, Complex32, f32) {
        let zero = Complex32::new(0.0, 0.0);
        let m0 = m[0];
        if m0 < 1e-9 {
            return (zero, zero, 0.0);
        }
        let (m2, m4) = (Complex32::new(m[1], m[2]) / m0, Complex32::new(m[3], m[4]) / m0);
        let coherence = m2.norm();
        // The prior's c0 is -p^2 for the one direction p: the root -p is the normal. It fades where the
        // plain tensor has no direction to offer.
        let single = if coherence > 1e-6 { -(m2 / coherence) * (m2 / coherence) } else { zero };
        let prior = self.prior * coherence * coherence;
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
}

/// Moments of each pixel's own gradient (Scharr's 3x3 derivative), weighted by its square.
fn gradient_moments(ink: &Raster<f32>) -> Raster<Moments> {
    let (width, height) = ink.size();
    let rows: Vec<Vec<Moments>> = (0..height)
        .into_par_iter()
        .map(|y| {
            let row = |dy: i64| ink.row((y as i64 + dy).clamp(0, height as i64 - 1) as usize);
            let (above, here, below) = (row(-1), row(0), row(1));
            (0..width)
                .map(|x| {
                    let (l, r) = (x.saturating_sub(1), (x + 1).min(width - 1));
                    let gx = 3.0 * (above[r] - above[l] + below[r] - below[l]) + 10.0 * (here[r] - here[l]);
                    let gy = 3.0 * (below[l] - above[l] + below[r] - above[r]) + 10.0 * (below[x] - above[x]);
                    let energy = gx * gx + gy * gy;
                    if energy < 1e-6 {
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

/// Gaussian blur of the moments, computed where the mask is set only.
fn blur_on(
    moments: &Raster<Moments>,
    mask: &crate::raster::Mask,
    sigma: f32,
    cancel: &Cancel,
) -> Result<Raster<Moments>> {
    let radius = (2.5 * sigma).ceil() as i64;
    let kernel: Vec<f32> = (-radius..=radius).map(|d| (-0.5 * (d as f32 / sigma).powi(2)).exp()).collect();
    let (width, height) = moments.size();
    let add = |sum: &mut Moments, m: &Moments, k: f32| sum.iter_mut().zip(m).for_each(|(s, v)| *s += k * v);
    let columns: Vec<Vec<bool>> = (0..height).into_par_iter().map(|y| near_in_column(mask, y, radius)).collect();
    let horizontal: Vec<Moments> = (0..height)
        .into_par_iter()
        .flat_map_iter(|y| {
            let (row, needed, kernel) = (moments.row(y), &columns[y], &kernel);
            (0..width).map(move |x| {
                let mut sum = [0.0; 5];
                if needed[x] {
                    let (from, to) = ((x as i64 - radius).max(0), (x as i64 + radius).min(width as i64 - 1));
                    for i in from..=to {
                        add(&mut sum, &row[i as usize], kernel[(i - x as i64 + radius) as usize]);
                    }
                }
                sum
            })
        })
        .collect();
    cancel.check()?;
    let vertical: Vec<Moments> = (0..height)
        .into_par_iter()
        .flat_map_iter(|y| {
            let (kernel, horizontal, mask) = (&kernel, &horizontal, mask.row(y));
            (0..width).map(move |x| {
                let mut sum = [0.0; 5];
                if mask[x] {
                    let (from, to) = ((y as i64 - radius).max(0), (y as i64 + radius).min(height as i64 - 1));
                    for i in from..=to {
                        add(&mut sum, &horizontal[i as usize * width + x], kernel[(i - y as i64 + radius) as usize]);
                    }
                }
                sum
            })
        })
        .collect();
    cancel.check()?;
    Ok(Raster::from_vec(width, height, vertical).expect("the blur keeps the size"))
}

/// Which pixels of a row have a mask pixel within `radius` rows in their column.
fn near_in_column(mask: &crate::raster::Mask, y: usize, radius: i64) -> Vec<bool> {
    let (from, to) = ((y as i64 - radius).max(0), (y as i64 + radius).min(mask.height() as i64 - 1));
    let mut near = vec![false; mask.width()];
    for row in from..=to {
        near.iter_mut().zip(mask.row(row as usize)).for_each(|(n, &m)| *n |= m);
    }
    near
}
