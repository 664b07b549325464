//! A field from local gradients, without a network: the fourth-order structure tensor.

use super::FieldEstimator;
use crate::cancel::Cancel;
use crate::clean::LineImage;
use crate::error::Result;
use crate::field::{Pixel, PolyVectorField};
use crate::moments::{Windows, fit};
use crate::raster::{Raster, runs};
use rayon::prelude::*;
use std::ops::Range;

/// How many standard deviations the neighbourhood reaches.
const REACH: f64 = 2.5;

/// Side of the tiles that are computed one by one, in pixels: what they need stays in a core's cache.
const TILE: usize = 128;

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
        let sigma = (self.reach * image.line_width).max(1.2);
        let windows = Windows::new(&[sigma], REACH);
        let tile = |windows: &mut Windows, at| {
            if cancel.check().is_ok() { self.tile(windows, image, at) } else { Vec::new() }
        };
        let (width, height) = image.ink.size();
        let across = |y: usize| (0..width).step_by(TILE).map(move |x| (x, y));
        let tiles: Vec<(usize, usize)> = (0..height).step_by(TILE).flat_map(across).collect();
        let parts = tiles.par_iter().map_with(windows, |windows, &at| tile(windows, at)).collect();
        cancel.check()?;
        Ok(PolyVectorField::from_parts(width, height, parts))
    }
}

impl StructureTensor {
    /// The field of the ink in one tile, from the ink in it and around it.
    fn tile(&self, windows: &mut Windows, image: &LineImage, at: (usize, usize)) -> Vec<Pixel> {
        let (width, height) = image.ink.size();
        // Gradients are taken from pixels around those that a window sees.
        let margin = windows.reach() + 1;
        let span = |at: usize, n: usize| at.saturating_sub(margin)..(at + TILE + margin).min(n);
        let (columns, rows) = (span(at.0, width), span(at.1, height));
        let (right, bottom) = ((at.0 + TILE).min(width), (at.1 + TILE).min(height));
        let wanted = |y: usize| -> Vec<Range<usize>> {
            if !(at.1..bottom).contains(&y) {
                return Vec::new();
            }
            let left = at.0 - columns.start;
            runs(&image.mask.row(y)[at.0..right]).map(|run| run.start + left..run.end + left).collect()
        };
        let wanted: Vec<_> = rows.clone().map(wanted).collect();
        let mut pixels = Vec::new();
        if wanted.iter().all(Vec::is_empty) {
            return pixels;
        }
        let ink = Raster::from_fn(columns.len(), rows.len(), |x, y| image.ink[(columns.start + x, rows.start + y)]);
        windows.average(&ink, &wanted, |_, x, y, moments| {
            let first = (rows.start + y) * width + columns.start + x;
            pixels.extend(moments.iter().enumerate().map(|(i, m)| {
                let (c0, c2, confidence) = fit(m, self.prior);
                Pixel { index: first + i, c0, c2, confidence }
            }));
        });
        pixels
    }
}
