//! From a scan to the ink that is to be traced: evenly lit, thresholded, despeckled, at a known line width, with paper
//! between lines that are close together.

mod across;
mod blur;
mod broad;
mod colors;
mod distance;
mod line_image;
mod noise;
mod page;
mod paper;
mod reduce;
mod resample;
mod runs;
mod solids;
mod specks;
mod threshold;
mod valleys;
mod width;

pub(crate) use blur::{profile_at, unblurred_width};
pub(crate) use broad::RIM;
pub(crate) use distance::distance;
pub use line_image::{Decisions, LineImage};
pub use noise::{Noise, NoiseMap};
pub(crate) use page::JOINING;
pub(crate) use reduce::{block, is_large, reduced};
pub(crate) use runs::{Run, runs};
pub(crate) use width::is_ridge;

use crate::cancel::Cancel;
use crate::error::Result;
use crate::load::Scan;
use crate::options::{MaxWidth, Options};
use crate::raster::{Mask, Raster};
use imageproc::filter::gaussian_blur_f32;
use page::Page;
use rayon::prelude::*;
use resample::Resampling;
use threshold::Told;
use width::Ridge;

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
    cleaned(Page::of(scan, options.invert), options, cancel)
}

/// Cleans a scan from which all but the ink has been taken; how grainy its paper is, is to be seen on the scan `as_it_was`.
///
/// # Errors
/// The token's.
pub(crate) fn clean_drawn(drawn: Scan, as_it_was: &Scan, options: &Options, cancel: &Cancel) -> Result<LineImage> {
    let page = Page::of_drawn(&drawn, as_it_was, options.invert);
    // Large pages are kept no longer than they are needed.
    drop(drawn);
    cleaned(page, options, cancel)
}

fn cleaned(page: Page, options: &Options, cancel: &Cancel) -> Result<LineImage> {
    cancel.check()?;
    // Lines are looked at as if all ink were sure before that is known.
    let Told { mut ink, mut mask, mut threshold } = page.inked(&NoiseMap::even(Noise::default()), options.threshold);
    let mut depth = distance(&mask);
    cancel.check()?;
    let mut ridge = Ridge::of(&ink, &mask, &depth);
    let noise = NoiseMap::of(&ink, &ridge, page.scanned);
    cancel.check()?;
    if !noise.is_sure() {
        Told { ink, mask, threshold } = page.inked(&noise, options.threshold);
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
    let blur = blur_of(&ink, &mask, &depth, line_width, noise.mean(), resampling, scale);
    let widest = widest(options.max_width, scale);
    let broad = solids::take_broad(&mut mask, &depth, unblurred_width(line_width, blur), widest);
    let broad = broad.map(|region| (broad::take(&mut ink, &mut mask, &region, &noise), region));
    if broad.is_some() {
        depth = distance(&mask);
    }
    cancel.check()?;
    let (solid, solids) = solids::take(&mut mask, &mut ink, &depth, line_width, widest);
    let depth = if solids.is_empty() { depth } else { distance(&mask) };
    cancel.check()?;
    ink.data_mut().par_iter_mut().for_each(|i| *i = i.min(DARKEST));
    let decisions = page.decisions(threshold);
    let colors = Some(page.colors());
    let mut image = LineImage {
        ink,
        mask,
        depth,
        line_width,
        scale,
        page_scale: scale,
        noise,
        blur,
        solids,
        solid,
        broad: None,
        colors,
        decisions,
    };
    image.broad = broad.map(|(ink, mask)| Box::new(broad::image(ink, mask, &image)));
    Ok(image)
}

/// Half the width of the widest lines in a raster of a scale, where that is given.
fn widest(max_width: MaxWidth, scale: f64) -> Option<f64> {
    match max_width {
        MaxWidth::Auto | MaxWidth::Millimetres(_) => None,
        MaxWidth::Pixels(width) => Some(0.5 * width * scale),
        MaxWidth::Unlimited => Some(f64::INFINITY),
    }
}

/// Depth of the mask and typical width of its lines.
fn measured(ink: &Raster<f32>, mask: &Mask) -> (Raster<f32>, f64) {
    let depth = distance(mask);
    let line_width = Ridge::of(ink, mask, &depth).line_width();
    (depth, line_width)
}

/// Standard deviation of the lines' blur in a raster of a scale: sure ink has none but that of resampling.
fn blur_of(
    ink: &Raster<f32>,
    mask: &Mask,
    depth: &Raster<f32>,
    line_width: f64,
    noise: Noise,
    resampling: Resampling,
    scale: f64,
) -> f64 {
    if noise.grain() < 0.5 {
        return resampling.blur();
    }
    let expected = scale * noise.blur.hypot(noise.between(0.0, JOINING));
    blur::estimate(ink, mask, depth, line_width, expected)
}

/// Gaussian blur.
fn smooth(raster: Raster<f32>, sigma: f32) -> Raster<f32> {
    Raster::from_image(gaussian_blur_f32(&raster.into_image(), sigma))
}
