//! Lines too broad to be traced beside others become an image of their own.

use super::distance::distance;
use super::resample::Resampling;
use super::width::Ridge;
use super::{DARKEST, LineImage, blur, threshold};
use crate::raster::{Mask, Raster};
use rayon::prelude::*;

/// How far beyond its mask the ink of a broad line reaches, in pixels.
pub(crate) const RIM: f64 = 2.0;

/// Takes the ink of broad lines, a region that is not in the mask, and of its rim, in which fine lines end.
pub(super) fn take(ink: &mut Raster<f32>, mask: &mut Mask, region: &Mask, noise: f64) -> Raster<f32> {
    let level = threshold::level(noise);
    let to_region = distance(&region.mapped(false, |inside| !inside));
    let mut broad = Raster::filled(region.width(), region.height(), 0.0);
    let fine = ink.data_mut().iter_mut().zip(mask.data_mut());
    let pixels = fine.zip(broad.data_mut()).zip(region.data().iter().zip(to_region.data()));
    for (((fine, mask), broad), (&inside, &distance)) in pixels {
        if f64::from(distance) <= RIM {
            // Darker than a rim is a fine line that goes under here.
            *broad = if inside || *fine <= level { *fine } else { 0.0 };
            (*fine, *mask) = (0.0, false);
        }
    }
    broad
}

/// The image of broad lines that were taken from another.
pub(super) fn image(mut ink: Raster<f32>, mut mask: Mask, fine: &LineImage) -> LineImage {
    let noise = fine.noise;
    let mut depth = distance(&mask);
    let ridge = Ridge::of(&ink, &mask, &depth);
    let mut line_width = ridge.median_width();
    let resampling = Resampling::of(&ridge, mask.size(), noise, line_width);
    if resampling.scale != 1.0 {
        ink = resampling.apply(ink, &depth);
        mask = ink.mapped(false, |i| i > threshold::level(noise));
        depth = distance(&mask);
        line_width = Ridge::of(&ink, &mask, &depth).median_width();
    }
    let blur = if noise > 0.0 { blur::estimate(&ink, &mask, &depth, line_width) } else { resampling.blur() };
    ink.data_mut().par_iter_mut().for_each(|i| *i = i.min(DARKEST));
    let (scale, solids, colors) = (fine.scale * resampling.scale, Vec::new(), fine.colors.clone());
    let edge_noise = fine.edge_noise * resampling.scale;
    LineImage { ink, mask, depth, line_width, scale, noise, blur, edge_noise, solids, broad: None, colors }
}
