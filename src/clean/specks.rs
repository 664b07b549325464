//! Specks of dust and grain are not ink.

use crate::raster::{Mask, Raster};
use imageproc::region_labelling::{Connectivity, connected_components};
use std::f64::consts::FRAC_PI_4;

/// Removes specks from the mask, and their ink with them.
///
/// Without a given size, a speck is what is well below a pen's dot; on clean renders almost nothing is.
pub(super) fn remove(mask: &mut Mask, ink: &mut Raster<f32>, line_width: f64, noise: f64, despeckle: Option<usize>) {
    let dot = FRAC_PI_4 * line_width * line_width;
    let share = if noise > 0.0 { 0.7 } else { 0.2 };
    let limit = despeckle.map_or(share * dot, |pixels| pixels as f64);
    if limit < 1.0 {
        return;
    }
    let labels = connected_components(&mask.to_gray_image(), Connectivity::Eight, image::Luma([0u8]));
    let count = labels.iter().copied().max().unwrap_or(0) as usize + 1;
    let mut area = vec![0usize; count];
    labels.iter().for_each(|&label| area[label as usize] += 1);
    let pixels = labels.iter().zip(mask.data_mut()).zip(ink.data_mut());
    for ((&label, mask), ink) in pixels {
        if *mask && area[label as usize] as f64 <= limit {
            *mask = false;
            *ink = 0.0;
        }
    }
}
