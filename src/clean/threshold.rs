//! Ink from paper.

use super::noise::{Noise, NoiseMap};
use super::smooth;
use crate::options::Threshold;
use crate::raster::{Mask, Raster};
use image::GrayImage;
use imageproc::contrast::otsu_level;
use imageproc::morphology::Mask as Structure;
use imageproc::morphology::grayscale_dilate;
use rayon::prelude::*;

/// Lighter than this share of full ink is paper.
const PAPER: f32 = 0.1;
/// A pixel of flat paper deviates by less than this: the rounding of 8-bit values.
const FLAT: f32 = 0.008;
/// Ink stands out from the paper's middle tone by so many of its deviations, and by no more than this share of the darkest
/// ink.
const WANDER: f32 = 4.5;
const DARK_SHARE: f32 = 0.45;
/// A page has light lines if this share of its inked cells, of so many pixels a side, and at least so many of them have
/// less than this share of the common core's ink.
const CELL: usize = 8;
const LIGHTER_SHARE: f64 = 0.08;
const FEWEST_LIGHTER: usize = 8;
const LIGHTER: f32 = 0.75;
/// Ink of less than this share of Otsu's level makes no lines, not even light ones.
const LIGHTEST: f32 = 0.8;
/// The grain that a scan has at least; less cannot be told from rounding.
const LEAST_GRAIN: f64 = 0.01;

/// What is to be seen of the paper before any line is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Paper {
    /// Spread of its grain, as a share of full ink; 0 where it is flat.
    pub grain: f64,
    /// Whether there are shades between it and full ink.
    pub shades: bool,
}

impl Paper {
    pub fn of(ink: &Raster<f32>) -> Self {
        let [paper, flat, full] = counts(ink, [|i| i < PAPER, |i| i < FLAT, |i| i > 1.0 - PAPER]);
        // The paper's level is an upper quantile: of grainy paper, most lies below it.
        if 5 * flat >= 4 * paper {
            let between = ink.data().len() - paper - full;
            return Self { grain: 0.0, shades: 50 * between >= full };
        }
        Self { grain: grain(ink), shades: true }
    }
}

/// Spread of grain.
fn grain(ink: &Raster<f32>) -> f64 {
    // From neighbours, so that uneven light does not count; of these the median, so that lines do not.
    let mut steps: Vec<f32> = Vec::new();
    for y in (0..ink.height()).step_by(3) {
        steps.extend(ink.row(y).windows(2).step_by(2).map(|w| (w[1] - w[0]).abs()));
    }
    if steps.is_empty() {
        return LEAST_GRAIN;
    }
    let middle = steps.len() / 2;
    let median = *steps.select_nth_unstable_by(middle, f32::total_cmp).1;
    // 1.4826 / sqrt(2): the normal law's factor for differences of neighbours.
    (1.05 * f64::from(median)).max(LEAST_GRAIN)
}

/// How many pixels meet each condition.
fn counts<const N: usize>(ink: &Raster<f32>, conditions: [fn(f32) -> bool; N]) -> [usize; N] {
    let of = |part: &[f32]| conditions.map(|is_met| part.iter().filter(|&&i| is_met(i)).count());
    let sum = |a: [usize; N], b: [usize; N]| std::array::from_fn(|k| a[k] + b[k]);
    ink.data().par_chunks(1 << 14).map(of).reduce(|| [0; N], sum)
}

/// The coverage from which a normalised pixel counts as ink. A clean render's thin lines spread over two
/// pixels, so the level of sure ink lies lower.
pub(super) fn level(noise: Noise) -> f32 {
    noise.between(0.4, 0.5) as f32
}

/// The pixels of at least the level where they lie.
pub(super) fn mask(ink: &Raster<f32>, noise: &NoiseMap) -> Mask {
    let [least, most] = noise.grains();
    if least == most {
        let level = level(noise.mean());
        return ink.mapped(false, |i| i > level);
    }
    Raster::from_rows(ink.width(), ink.height(), false, |y, row| {
        row.iter_mut().enumerate().for_each(|(x, to)| *to = ink[(x, y)] > level(noise.at_pixel(x, y)));
    })
}

/// Ink that was told from paper.
pub(super) struct Told {
    /// The ink, a line's typical core being 1.
    pub ink: Raster<f32>,
    pub mask: Mask,
    /// The darkness from which a pixel is in the mask, where it is one for the page.
    pub threshold: Option<f64>,
}

/// Scales the ink so that a line's typical core is 1, the darkest more, and tells ink from paper.
///
/// One level serves the whole page when its lines are about equally dark; otherwise each place is measured
/// against the darkest ink near it, so that light pencil lines hold beside dark ones. On a clean render what is far
/// lighter than the lines is no line, unless its ink may come in `shades`.
pub(super) fn binarise(ink: &Raster<f32>, paper: Paper, noise: &NoiseMap, threshold: Threshold, shades: bool) -> Told {
    if let Threshold::Fixed(t) = threshold {
        let mask = ink.mapped(false, |i| f64::from(i) > t);
        return Told { ink: scaled(ink, (2.0 * t) as f32), mask, threshold: Some(t) };
    }
    let floor = floor(ink, paper.grain);
    let Some((otsu, core)) = global_levels(ink, floor) else {
        let mask = Raster::filled(ink.width(), ink.height(), false);
        return Told { ink: ink.clone(), mask, threshold: Some(floor.into()) };
    };
    let level = level(noise.mean());
    if noise.mean().grain() < 0.5 && core > 0.8 && !shades {
        return Told { ink: ink.clone(), mask: mask(ink, noise), threshold: Some(level.into()) };
    }
    // At the level of the mask, ink still stands out.
    let least = floor / level;
    let core = core.max(least);
    let nearby = nearby_core(ink, (LIGHTEST * otsu).max(least));
    if is_even(ink, &nearby, otsu, core) && !has_light_lines(ink, &nearby, level * otsu, core) {
        let ink = scaled(ink, core);
        return Told { mask: mask(&ink, noise), ink, threshold: Some((level * core).into()) };
    }
    let ink = Raster::from_rows(ink.width(), ink.height(), 0.0, |y, row| {
        row.iter_mut().zip(ink.row(y)).zip(nearby.row(y)).for_each(|((to, &i), &core)| *to = i / core);
    });
    Told { mask: mask(&ink, noise), ink, threshold: None }
}

/// The least ink that stands out from the paper.
///
/// Grain is told from neighbouring pixels, and where a camera or its compression has smoothed it, the paper wanders by
/// more: by what its lighter half does. Where ink covers most of the page that says nothing, so the darkest ink sets a
/// limit.
fn floor(ink: &Raster<f32>, grain: f64) -> f32 {
    let least = (6.0 * grain).max(0.06) as f32;
    let mut values: Vec<f32> = ink.data().iter().step_by((ink.data().len() / 50_000).max(1)).copied().collect();
    if grain == 0.0 || values.is_empty() {
        return least;
    }
    let n = values.len() as f64 - 1.0;
    let mut quantile = |q: f64| *values.select_nth_unstable_by((n * q) as usize, f32::total_cmp).1;
    let (light, middle, dark) = (quantile(0.16), quantile(0.5), quantile(0.999));
    least.max((middle + WANDER * (middle - light)).min(DARK_SHARE * dark))
}

/// The ink in 256 steps.
fn in_bytes(ink: &Raster<f32>) -> GrayImage {
    // Of a positive number, cutting off after adding a half is rounding.
    ink.mapped(0, |i| (i * 255.0 + 0.5) as u8).into_image()
}

fn scaled(ink: &Raster<f32>, core: f32) -> Raster<f32> {
    ink.mapped(0.0, |i| i / core)
}

/// Otsu's level and the ink of a line's core (an upper quantile above that level); `None` without ink.
fn global_levels(ink: &Raster<f32>, floor: f32) -> Option<(f32, f32)> {
    let otsu = (f32::from(otsu_level(&in_bytes(ink))) / 255.0).max(floor);
    let mut above: Vec<f32> = ink.data().par_iter().copied().filter(|&i| i > otsu).collect();
    if above.is_empty() {
        return None;
    }
    let k = (above.len() - 1) * 3 / 4;
    let core = *above.select_nth_unstable_by(k, f32::total_cmp).1;
    Some((otsu, core))
}

/// The darkest ink within a few pixels of each place, smoothed, and no less than `floor`.
fn nearby_core(ink: &Raster<f32>, floor: f32) -> Raster<f32> {
    let dilated = grayscale_dilate(&in_bytes(ink), &Structure::square(6));
    let core = Raster::from_rows(ink.width(), ink.height(), 0.0, |y, row| {
        for (x, core) in row.iter_mut().enumerate() {
            *core = (f32::from(dilated.get_pixel(x as u32, y as u32)[0]) / 255.0).max(floor);
        }
    });
    smooth(core, 3.0)
}

/// Whether the lines of the page are about equally dark: the lower decile of the cores near ink is over half
/// of the common core.
fn is_even(ink: &Raster<f32>, nearby: &Raster<f32>, otsu: f32, core: f32) -> bool {
    let mut cores: Vec<f32> =
        ink.data().iter().zip(nearby.data()).filter(|(i, _)| **i > 0.7 * otsu).map(|(_, c)| *c).collect();
    if cores.is_empty() {
        return true;
    }
    let k = cores.len() / 10;
    *cores.select_nth_unstable_by(k, f32::total_cmp).1 > 0.55 * core
}

/// Whether the page has lines that are lighter than the common core, and thinner perhaps: broad lines have most of the ink,
/// but not of the cells with more of it than `least`.
fn has_light_lines(ink: &Raster<f32>, nearby: &Raster<f32>, least: f32, core: f32) -> bool {
    let (columns, rows) = (ink.width().div_ceil(CELL), ink.height().div_ceil(CELL));
    let darkest = |column: usize, row: usize| {
        let (x0, y0) = (column * CELL, row * CELL);
        let (x1, y1) = ((x0 + CELL).min(ink.width()), (y0 + CELL).min(ink.height()));
        let inked = (y0..y1).flat_map(|y| (x0..x1).map(move |x| (x, y))).filter(|&p| ink[p] > least);
        let darkest = inked.clone().max_by(|&a, &b| ink[a].total_cmp(&ink[b]))?;
        // Less is a speck.
        (inked.count() >= CELL).then(|| nearby[darkest])
    };
    let of_row = |row: usize| (0..columns).filter_map(move |column| darkest(column, row));
    let cores: Vec<f32> = (0..rows).into_par_iter().flat_map_iter(of_row).collect();
    let lighter = cores.iter().filter(|&&c| c < LIGHTER * core).count();
    lighter > FEWEST_LIGHTER && lighter as f64 > LIGHTER_SHARE * cores.len() as f64
}
