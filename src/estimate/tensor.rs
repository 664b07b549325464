//! A field from local gradients, without a network: the fourth-order structure tensor.

use super::FieldEstimator;
use crate::cancel::Cancel;
use crate::clean::LineImage;
use crate::error::Result;
use crate::field::PolyVectorField;
use crate::moments::{Moments, fit, gradients};
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
        let gradients = gradients(&image.ink);
        cancel.check()?;
        let moments = blur_on(&gradients, &image.mask, sigma, cancel)?;
        let solved: Vec<_> = moments.data().par_iter().map(|m| fit(m, self.prior)).collect();
        let (width, height) = image.ink.size();
        let field = |f: fn(&(Complex32, Complex32, f32)) -> Complex32| {
            Raster::from_vec(width, height, solved.iter().map(f).collect()).expect("one solution per pixel")
        };
        let confidence = Raster::from_vec(width, height, solved.iter().map(|s| s.2).collect()).expect("likewise");
        PolyVectorField::new(field(|s| s.0), field(|s| s.1), confidence)
    }
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
