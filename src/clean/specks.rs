//! Specks of dust and grain are not ink.

use super::runs::runs;
use crate::raster::{Mask, Raster};
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
    let runs = runs(mask);
    let mut area = vec![0usize; runs.len()];
    runs.iter().for_each(|run| area[run.region] += run.to - run.from);
    let width = mask.width();
    for run in runs.iter().filter(|run| area[run.region] as f64 <= limit) {
        let pixels = run.y * width + run.from..run.y * width + run.to;
        mask.data_mut()[pixels.clone()].fill(false);
        ink.data_mut()[pixels].fill(0.0);
    }
}
