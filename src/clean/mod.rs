//! From a scan to the ink that is to be traced: evenly lit, thresholded, despeckled, at a known line width, with paper
//! between lines that are close together.

mod blur;
mod broad;
mod colors;
mod distance;
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
pub(crate) use runs::runs;
pub(crate) use threshold::LEAST_GRAIN;
pub(crate) use width::is_ridge;

use crate::cancel::Cancel;
use crate::drawing::Fill;
use crate::error::{Error, Result};
use crate::load::Scan;
use crate::options::{Invert, Options, Threshold};
use crate::raster::{Mask, Raster};
use distance::distance;
use imageproc::filter::gaussian_blur_f32;
use kurbo::{Point, Vec2};
use rayon::prelude::*;
use resample::Resampling;
use std::borrow::Cow;
use std::f64::consts::TAU;
use width::Ridge;

/// The ink of a drawing, evenly lit and at a size that the later stages know.
#[derive(Clone, Debug)]
pub struct LineImage {
    /// How much of each pixel is inked: 0 on paper, 1 in the middle of a typical line; anti-aliased edges are
    /// kept. On a scan, the darkest ink has up to 2.
    pub ink: Raster<f32>,
    /// The pixels that count as ink of lines; solid regions are not among them.
    pub mask: Mask,
    /// Distance of each mask pixel's centre to the nearest paper pixel's centre; 0 off the mask.
    pub depth: Raster<f32>,
    /// Typical line width in pixels of this raster.
    pub line_width: f64,
    /// Pixels of this raster per pixel of the scan.
    pub scale: f64,
    /// Standard deviation of the paper's grain as a share of the ink; 0 for a clean render.
    pub noise: f64,
    /// Standard deviation of the blur of a scan's lines, in pixels of this raster; 0 for a clean render, unless it was
    /// enlarged.
    pub blur: f64,
    /// Standard deviation of the ink's edge about a smooth line, in pixels of this raster: where a scan has two levels
    /// alone, that of a pixel's side. 0 where greys tell more.
    pub edge_noise: f64,
    /// Regions too wide to be lines, in pixels of this raster.
    pub solids: Vec<Fill>,
    /// Lines too broad to be traced beside these, as an image of their own.
    pub broad: Option<Box<LineImage>>,
    /// On a page in colour, the colour of each pixel *of the scan* with the paper's own taken off; `None` where all
    /// ink is grey.
    pub colors: Option<Raster<[u8; 3]>>,
}

/// A page whose lightest and darkest pixels are nearer than this is blank.
const LEAST_CONTRAST: f32 = 0.02;
/// Ink beyond this many times that of a typical line is cut off.
const DARKEST: f32 = 2.0;
/// On a clean render, lines that touch show no gap longer than this, in pixels of the scan.
const CLEAN_GAP: f64 = 0.15;
/// On a noisy scan, the grain of a line that touches another looks like a gap of at most this length, in pixels.
const NOISY_GAP: f64 = 0.65;
/// Standard deviation of an edge that is told to one pixel of the scan, in pixels: `1 / sqrt 12`.
const QUANTISATION: f64 = 0.29;
/// Bounds of the sizes of a line image, in pixels: far beyond those of any drawing.
const LEAST_SIZE: f64 = 1e-3;
const LARGEST_SIZE: f64 = 1e4;
/// The middle of a line that is averaged over to see past its grain, as a share of its width to either side.
const CORE_BAND: f64 = 0.35;

impl LineImage {
    /// Whether the ink of a line, `core` in its middle, runs from one point to another without a break.
    ///
    /// The ink that is missing along the way adds up to the length of the gap, however it lies on the pixels and
    /// however much it is blurred.
    pub(crate) fn is_inked(&self, a: Point, b: Point, core: f32) -> bool {
        let length = (b - a).hypot();
        let count = (length / 0.25).ceil().max(1.0) as usize;
        let along = (0..=count).map(|k| a.lerp(b, k as f64 / count as f64));
        if self.noise > 0.0 {
            let heading = if length > 1e-9 { (b - a) / length } else { return true };
            let profile = GapProfile::of(self);
            return !along.map(|p| profile.gap(self, p, heading, core)).any(|gap| gap > NOISY_GAP);
        }
        let missing: f64 = along.map(|p| (1.0 - f64::from(self.ink.sample(p) / core)).max(0.0)).sum();
        missing * length / count as f64 <= CLEAN_GAP * self.scale.max(1.0)
    }

    /// Ink in the middle of a line: on a noisy scan the mean across it, since single pixels are mostly grain.
    pub(crate) fn core(&self, p: Point, heading: Vec2) -> f32 {
        if self.noise == 0.0 {
            return self.ink.sample(p);
        }
        let step = heading.turn_90() * (0.5 * CORE_BAND * self.line_width);
        (-2..=2).map(|k| self.ink.sample(p + step * f64::from(k))).sum::<f32>() / 5.0
    }
}

/// The ink that a gap of unit length lacks along a line, once the scan has blurred it.
struct GapProfile {
    /// Distance from the gap's middle in pixels, and the share that is missing there.
    samples: Vec<(f64, f64)>,
    /// Sum of the squared shares.
    whole: f64,
}

impl GapProfile {
    fn of(image: &LineImage) -> Self {
        let deviation = image.blur.max(0.7);
        let spacing = 0.25;
        let reach = (2.0 * deviation / spacing).ceil() as i32;
        let missing = |offset: f64| (-0.5 * (offset / deviation).powi(2)).exp() / (deviation * TAU.sqrt());
        let samples = (-reach..=reach).map(|k| spacing * f64::from(k)).map(|offset| (offset, missing(offset)));
        let samples: Vec<(f64, f64)> = samples.collect();
        let whole = samples.iter().map(|(_, missing)| missing * missing).sum();
        Self { samples, whole }
    }

    /// Length of the gap at a point of a noisy line, in pixels: the least squares size of a gap that the scan has
    /// blurred.
    fn gap(&self, image: &LineImage, p: Point, heading: Vec2, core: f32) -> f64 {
        let missing = |offset: f64| 1.0 - f64::from(image.core(p + heading * offset, heading) / core);
        let seen: f64 = self.samples.iter().map(|&(offset, share)| share * missing(offset)).sum();
        seen / self.whole
    }
}

impl LineImage {
    /// Checks what the later stages rely on, after somebody else may have changed it.
    ///
    /// # Errors
    /// [`Error::Broken`].
    pub(crate) fn validate(&self) -> Result<()> {
        let broken = |reason: String| Err(Error::Broken { stage: "clean", reason });
        for (what, size) in [("mask", self.mask.size()), ("depth", self.depth.size())] {
            if size != self.ink.size() {
                return broken(format!("the {what} is {size:?} pixels and the ink {:?}", self.ink.size()));
            }
        }
        let positive = [("line width", self.line_width), ("scale", self.scale)].map(|(what, v)| (what, v, LEAST_SIZE));
        let others =
            [("noise", self.noise, 0.0), ("blur", self.blur, 0.0), ("noise of the edges", self.edge_noise, 0.0)];
        match positive.into_iter().chain(others).find(|(_, value, least)| !(*least..=LARGEST_SIZE).contains(value)) {
            Some((what, value, _)) => broken(format!("the {what} is {value}")),
            None => self.broad.as_ref().map_or(Ok(()), |broad| broad.validate()),
        }
    }
}

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
    let steps = if threshold::is_two_level(&scan.gray) { QUANTISATION } else { 0.0 };
    let page = scan.rgb.as_ref().and_then(|rgb| colors::separate(rgb, inverted));
    cancel.check()?;
    let noise;
    let (mut ink, mut mask) = match &page {
        Some(page) => {
            noise = threshold::grain(&page.strength);
            inks_of_groups(page, noise, options.threshold)
        }
        None => {
            let ink = ink_of_gray(&scan.gray, inverted);
            cancel.check()?;
            noise = threshold::grain(&ink);
            cancel.check()?;
            threshold::binarise(joined(ink, noise), noise, options.threshold, false)
        }
    };
    let mut depth = distance(&mask);
    cancel.check()?;
    let ridge = Ridge::of(&ink, &mask, &depth);
    let mut line_width = ridge.line_width();
    let resampling = Resampling::of(&ridge, mask.size(), noise, line_width);
    let scale = resampling.scale;
    if scale != 1.0 {
        ink = resampling.apply(ink, &depth);
        cancel.check()?;
        mask = ink.mapped(false, |i| i > threshold::level(noise));
        (depth, line_width) = measured(&ink, &mask);
    }
    cancel.check()?;
    if valleys::deepen(&mut ink, &mut mask, line_width, threshold::level(noise)) {
        (depth, line_width) = measured(&ink, &mask);
    }
    cancel.check()?;
    specks::remove(&mut mask, &mut ink, line_width, noise, options.despeckle);
    cancel.check()?;
    let blur = match noise > 0.0 {
        true => blur::estimate(&ink, &mask, &depth, line_width),
        false => resampling.blur(),
    };
    let broad = solids::take_broad(&mut mask, &depth, unblurred_width(line_width, blur));
    let broad = broad.map(|region| (broad::take(&mut ink, &mut mask, &region, noise), region));
    if broad.is_some() {
        depth = distance(&mask);
    }
    cancel.check()?;
    let solids = solids::take(&mut mask, &ink, &depth, line_width);
    let depth = if solids.is_empty() { depth } else { distance(&mask) };
    cancel.check()?;
    ink.data_mut().par_iter_mut().for_each(|i| *i = i.min(DARKEST));
    let colors = page.map(|page| page.colors);
    let edge_noise = steps * scale;
    let mut image =
        LineImage { ink, mask, depth, line_width, scale, noise, blur, edge_noise, solids, broad: None, colors };
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

/// Just enough smoothing to join the grain of a pencil line: the half-width of a pixel's own footprint.
fn joined(ink: Raster<f32>, noise: f64) -> Raster<f32> {
    if noise > 0.0 { smooth(ink, 0.7) } else { ink }
}

/// Each group of inks scaled and told from paper by itself, and all laid over one another.
fn inks_of_groups(page: &colors::ColorPage, noise: f64, threshold: Threshold) -> (Raster<f32>, Mask) {
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
        let (own, own_mask) = threshold::binarise(joined(own, noise), noise, threshold, true);
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
