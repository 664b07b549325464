//! From a scan to the ink that is to be traced: evenly lit, thresholded, despeckled, at a known line width, with paper
//! between lines that are close together.

mod blur;
mod broad;
mod colors;
mod distance;
mod line_image;
mod noise;
mod paper;
mod resample;
mod runs;
mod solids;
mod specks;
mod threshold;
mod valleys;
mod width;

pub(crate) use blur::{profile_at, unblurred_width};
pub(crate) use broad::RIM;
pub use line_image::LineImage;
pub use noise::{Noise, NoiseMap};
pub(crate) use runs::runs;
pub(crate) use width::is_ridge;

use crate::cancel::Cancel;
use crate::error::Result;
use crate::load::Scan;
use crate::options::{Invert, Options, Threshold};
use crate::raster::{Mask, Raster};
use distance::distance;
use imageproc::filter::gaussian_blur_f32;
use rayon::prelude::*;
use resample::Resampling;
use std::borrow::Cow;
use width::Ridge;

/// A page whose lightest and darkest pixels are nearer than this is blank.
const LEAST_CONTRAST: f32 = 0.02;
/// Deviation of the blur that joins the grain of a pencil line, in pixels of the scan: half of a pixel's own footprint.
const JOINING: f64 = 0.7;
/// Ink beyond this many times that of a typical line is cut off.
const DARKEST: f32 = 2.0;

/// Cleans a scan.
///
/// A scan without ink gives an empty mask and a line width of 1.
pub fn clean(scan: &Scan, options: &Options) -> LineImage {
    clean_until(scan, options, &Cancel::default()).expect("nobody else holds the token")
}

/// Cleans a scan unless told to stop.
///
/// # Errors
/// The token's.
pub fn clean_until(scan: &Scan, options: &Options, cancel: &Cancel) -> Result<LineImage> {
    let inverted = match options.invert {
        Invert::Yes => true,
        Invert::No => false,
        Invert::Auto => is_light_on_dark(&scan.gray),
    };
    cancel.check()?;
    let page = scan.rgb.as_ref().and_then(|rgb| colors::separate(rgb, inverted));
    cancel.check()?;
    let paper = match &page {
        Some(page) => threshold::Paper::of(&page.strength),
        None => threshold::Paper::of(&ink_of_gray(&scan.gray, inverted)),
    };
    cancel.check()?;
    let inked = |noise: &NoiseMap| match &page {
        Some(page) => inks_of_groups(page, paper, noise, options.threshold),
        None => threshold::binarise(
            joined(ink_of_gray(&scan.gray, inverted), noise),
            paper,
            noise,
            options.threshold,
            false,
        ),
    };
    // Lines are looked at as if all ink were sure before that is known.
    let (mut ink, mut mask) = inked(&NoiseMap::even(Noise::default()));
    let mut depth = distance(&mask);
    cancel.check()?;
    let mut ridge = Ridge::of(&ink, &mask, &depth);
    let noise = NoiseMap::of(&ink, &ridge, paper);
    cancel.check()?;
    if !noise.is_sure() {
        (ink, mask) = inked(&noise);
        depth = distance(&mask);
        cancel.check()?;
        ridge = Ridge::of(&ink, &mask, &depth);
    }
    let mut line_width = ridge.line_width();
    let resampling = Resampling::of(&ridge, mask.size(), noise.mean(), line_width);
    let scale = resampling.scale;
    let noise = noise.scaled(scale);
    if scale != 1.0 {
        ink = resampling.apply(ink, &depth);
        cancel.check()?;
        mask = threshold::mask(&ink, &noise);
        (depth, line_width) = measured(&ink, &mask);
    }
    cancel.check()?;
    if valleys::deepen(&mut ink, &mut mask, line_width, &noise) {
        (depth, line_width) = measured(&ink, &mask);
    }
    cancel.check()?;
    specks::remove(&mut mask, &mut ink, line_width, &noise, options.despeckle);
    cancel.check()?;
    let blur = blur_of(&ink, &mask, &depth, line_width, &noise, resampling);
    let broad = solids::take_broad(&mut mask, &depth, unblurred_width(line_width, blur));
    let broad = broad.map(|region| (broad::take(&mut ink, &mut mask, &region, &noise), region));
    if broad.is_some() {
        depth = distance(&mask);
    }
    cancel.check()?;
    let solids = solids::take(&mut mask, &ink, &depth, line_width);
    let depth = if solids.is_empty() { depth } else { distance(&mask) };
    cancel.check()?;
    ink.data_mut().par_iter_mut().for_each(|i| *i = i.min(DARKEST));
    let colors = page.map(|page| page.colors);
    let mut image = LineImage { ink, mask, depth, line_width, scale, noise, blur, solids, broad: None, colors };
    image.broad = broad.map(|(ink, mask)| Box::new(broad::image(ink, mask, &image)));
    Ok(image)
}

/// Depth of the mask and typical width of its lines.
fn measured(ink: &Raster<f32>, mask: &Mask) -> (Raster<f32>, f64) {
    let depth = distance(mask);
    let line_width = Ridge::of(ink, mask, &depth).line_width();
    (depth, line_width)
}

/// Ink by the light that the paper's level has lost.
fn ink_of_gray(gray: &Raster<f32>, inverted: bool) -> Raster<f32> {
    if !has_contrast(gray) {
        return Raster::filled(gray.width(), gray.height(), 0.0);
    }
    let light = if inverted { Cow::Owned(gray.mapped(0.0, |g| 1.0 - g)) } else { Cow::Borrowed(gray) };
    paper::divide(&light, &paper::paper_level(&light))
}

/// Standard deviation of the lines' blur: sure ink has none but that of resampling.
fn blur_of(
    ink: &Raster<f32>,
    mask: &Mask,
    depth: &Raster<f32>,
    line_width: f64,
    noise: &NoiseMap,
    resampling: Resampling,
) -> f64 {
    let noise = noise.mean();
    if noise.grain() < 0.5 {
        return resampling.blur();
    }
    blur::estimate(ink, mask, depth, line_width, noise.blur.hypot(noise.between(0.0, JOINING * resampling.scale)))
}

/// Smooths where ink is unsure, just enough to join the grain of a pencil line.
fn joined(ink: Raster<f32>, noise: &NoiseMap) -> Raster<f32> {
    let [least, most] = noise.grains();
    if most == 0.0 {
        return ink;
    }
    let smoothed = smooth(ink.clone(), JOINING as f32);
    if least == 1.0 {
        return smoothed;
    }
    Raster::from_rows(ink.width(), ink.height(), 0.0, |y, row| {
        for (x, to) in row.iter_mut().enumerate() {
            let share = noise.at_pixel(x, y).grain() as f32;
            *to = ink[(x, y)] + share * (smoothed[(x, y)] - ink[(x, y)]);
        }
    })
}

/// Each group of inks scaled and told from paper by itself, and all laid over one another.
fn inks_of_groups(
    page: &colors::ColorPage,
    paper: threshold::Paper,
    noise: &NoiseMap,
    threshold: Threshold,
) -> (Raster<f32>, Mask) {
    let (width, height) = page.strength.size();
    let (mut ink, mut mask) = (Raster::filled(width, height, 0.0), Raster::filled(width, height, false));
    for group in 0..page.groups {
        let own = Raster::from_fn(
            width,
            height,
            |x, y| {
                if page.group[(x, y)] == group { page.strength[(x, y)] } else { 0.0 }
            },
        );
        if group == 0 && !page.has_grey {
            // Grain, and where two colours mix.
            ink = own;
            continue;
        }
        let (own, own_mask) = threshold::binarise(joined(own, noise), paper, noise, threshold, true);
        // What smoothing took from one ink where it meets another, it put into the other.
        ink.data_mut().iter_mut().zip(own.data()).for_each(|(i, &o)| *i += o);
        mask.data_mut().iter_mut().zip(own_mask.data()).for_each(|(m, &o)| *m |= o);
    }
    let seams = page.seams(&ink);
    for ((x, y), full) in seams {
        ink[(x, y)] = full;
    }
    mask.data_mut().iter_mut().zip(ink.data()).for_each(|(m, &i)| *m |= i > 0.5);
    (ink, mask)
}

/// Whether there is anything on the page: a scan of one tone has no ink, whatever the tone.
fn has_contrast(gray: &Raster<f32>) -> bool {
    let low = gray.data().par_iter().copied().reduce(|| f32::MAX, f32::min);
    let high = gray.data().par_iter().copied().reduce(|| f32::MIN, f32::max);
    high - low > LEAST_CONTRAST
}

/// Lines cover little, so the more common side of the middle of the tonal range is the paper.
fn is_light_on_dark(gray: &Raster<f32>) -> bool {
    let mut values: Vec<f32> = gray.data().iter().step_by((gray.data().len() / 20_000).max(1)).copied().collect();
    if values.is_empty() {
        return false;
    }
    values.sort_by(f32::total_cmp);
    let at = |q: f64| values[((values.len() - 1) as f64 * q) as usize];
    let (low, middle, high) = (at(0.002), at(0.5), at(0.998));
    // A photographed page may be dim; only a page near the dark end of its own range, and dark, is inverted.
    middle < 0.5 && middle - low < 0.4 * (high - low)
}

/// Gaussian blur.
fn smooth(raster: Raster<f32>, sigma: f32) -> Raster<f32> {
    Raster::from_image(gaussian_blur_f32(&raster.into_image(), sigma))
}
