//! Lines too broad to be traced beside others become an image of their own.

use super::distance::distance;
use super::noise::NoiseMap;
use super::resample::Resampling;
use super::width::Ridge;
use super::{DARKEST, LineImage, blur_of, threshold};
use crate::raster::{Mask, Raster};
use rayon::prelude::*;

/// How far beyond its mask the ink of a broad line reaches, in pixels.
pub(crate) const RIM: f64 = 2.0;

/// Takes the ink of broad lines, a region that is not in the mask, and of its rim, in which fine lines end.
pub(super) fn take(ink: &mut Raster<f32>, mask: &mut Mask, region: &Mask, noise: &NoiseMap) -> Raster<f32> {
    let level = threshold::level(noise.mean());
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
    let mut depth = distance(&mask);
    let ridge = Ridge::of(&ink, &mask, &depth);
    let mut line_width = ridge.median_width();
    let resampling = Resampling::of(&ridge, mask.size(), fine.noise.mean(), line_width);
    let noise = fine.noise.clone().scaled(resampling.scale);
    if resampling.scale != 1.0 {
        ink = resampling.apply(ink, &depth);
        mask = threshold::mask(&ink, &noise);
        depth = distance(&mask);
        line_width = Ridge::of(&ink, &mask, &depth).median_width();
    }
    let scale = fine.scale * resampling.scale;
    let blur = blur_of(&ink, &mask, &depth, line_width, noise.mean(), resampling, scale);
    ink.data_mut().par_iter_mut().for_each(|i| *i = i.min(DARKEST));
    let solid = Raster::zeroed(ink.width(), ink.height());
    LineImage {
        ink,
        mask,
        depth,
        line_width,
        scale,
        page_scale: scale,
        noise,
        blur,
        solids: Vec::new(),
        solid,
        broad: None,
        colors: fine.colors.clone(),
        decisions: fine.decisions,
    }
}
