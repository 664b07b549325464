//! Specks of dust and grain are not ink.

use super::noise::{Noise, NoiseMap};
use super::runs::{Run, runs};
use crate::raster::{Mask, Raster};
use kurbo::Point;
use std::f64::consts::FRAC_PI_4;

/// A speck has less than this share of the ink of a pen's dot, where ink is sure and where it is not.
const SURE: f64 = 0.2;
const UNSURE: f64 = 0.7;

/// Removes specks from the mask, and their ink with them.
///
/// Without a given size, a speck is what is well below a pen's dot; where ink is sure almost nothing is.
pub(super) fn remove(
    mask: &mut Mask,
    ink: &mut Raster<f32>,
    line_width: f64,
    noise: &NoiseMap,
    despeckle: Option<usize>,
) {
    let dot = FRAC_PI_4 * line_width * line_width;
    let limit = |noise: Noise| despeckle.map_or(noise.between(SURE, UNSURE) * dot, |pixels| pixels as f64);
    let most = Noise { along: f64::MAX, ..Noise::default() };
    if limit(most) < 1.0 || (noise.is_sure() && limit(noise.mean()) < 1.0) {
        return;
    }
    let runs = runs(mask);
    // Pixels of each region, and its first run's middle.
    let mut regions = vec![(0usize, Point::ZERO); runs.len()];
    for Run { y, from, to, region } in &runs {
        let (area, place) = &mut regions[*region];
        if *area == 0 {
            *place = Point::new(0.5 * (from + to) as f64, *y as f64 + 0.5);
        }
        *area += to - from;
    }
    let width = mask.width();
    for run in runs.iter().filter(|run| {
        let (area, place) = regions[run.region];
        area as f64 <= limit(noise.at(place))
    }) {
        let pixels = run.y * width + run.from..run.y * width + run.to;
        mask.data_mut()[pixels.clone()].fill(false);
        ink.data_mut()[pixels].fill(0.0);
    }
}
