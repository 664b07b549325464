//! The ink of a drawing as the later stages see it.

use super::noise::NoiseMap;
use crate::drawing::Fill;
use crate::error::{Error, Result};
use crate::raster::{Mask, Raster};
use kurbo::{Point, Vec2};
use std::f64::consts::TAU;

/// The ink of a drawing, evenly lit and at a size that the later stages know.
#[derive(Clone, Debug)]
pub struct LineImage {
    /// How much of each pixel is inked: 0 on paper, 1 in the middle of a typical line; anti-aliased edges are
    /// kept. On a scan, the darkest ink has up to 2. Of solid regions it has only the rim.
    pub ink: Raster<f32>,
    /// The pixels that count as ink of lines; solid regions are not among them.
    pub mask: Mask,
    /// Distance of each mask pixel's centre to the nearest paper pixel's centre; 0 off the mask.
    pub depth: Raster<f32>,
    /// Typical line width in pixels of this raster.
    pub line_width: f64,
    /// Pixels of this raster per pixel of the scan.
    pub scale: f64,
    /// Pixels of this raster per pixel of the page that was cleaned: the scan, unless its lines were so broad that it was
    /// reduced first.
    pub page_scale: f64,
    /// How far the ink of lines can be trusted, by place in this raster; lengths are in pixels of the scan.
    pub noise: NoiseMap,
    /// Standard deviation of the blur of a scan's lines, in pixels of this raster; 0 for a clean render, unless it was
    /// enlarged.
    pub blur: f64,
    /// Regions too wide to be lines, in pixels of this raster.
    pub solids: Vec<Fill>,
    /// The pixels of these regions.
    pub solid: Mask,
    /// Lines too broad to be traced beside these, as an image of their own.
    pub broad: Option<Box<LineImage>>,
    /// The colour of each pixel *of the page that was cleaned* with the paper's own taken off, and on a dark ground grey for
    /// dark ink on white; `None` is black ink.
    pub colors: Option<Raster<[u8; 3]>>,
    /// What was decided about the page.
    pub decisions: Decisions,
}

/// What was decided about a page, so that a user knows which option to move.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Decisions {
    /// Whether light was taken for ink.
    pub inverted: bool,
    /// Standard deviation of the paper's grain as a share of full ink; 0 where it is flat.
    pub grain: f64,
    /// The darkness from which a pixel is ink, as [`crate::options::Threshold::Fixed`] takes it; `None` where that depends on
    /// the place or on the ink.
    pub threshold: Option<f64>,
    /// How many inks have a hue of their own.
    pub hues: usize,
}

/// Where lines that touch are sure, they show no gap longer than this, in pixels of the scan.
const SURE_GAP: f64 = 0.15;
/// Where ink is unsure, the grain of a line that touches another looks like a gap of at most this length, in pixels.
const UNSURE_GAP: f64 = 0.65;
/// A line that goes on is whole for this far around each of its points where ink is sure, in pixels, but for this share of the
/// ink. Where it is unsure only the point itself is looked at, and half may be missing: at the end of a blurred line it is.
const WHOLE: f64 = 1.0;
const SURE_LOSS: f64 = 1.0 / 15.0;
const UNSURE_LOSS: f64 = 0.5;
/// A line of this many pixels has full ink in its middle wherever it lies between the pixels; of a finer one as much is missing
/// there, in places, as half of what its width is less. Empirical, guarded by `fine_lines_beside_broad_ones_stay_whole`.
const FULL_WIDTH: f64 = 2.2;
/// Distance between samples along a line, in pixels, at most.
const SPACING: f64 = 0.25;
/// Bounds of the sizes of a line image, in pixels: far beyond those of any drawing.
const LEAST_SIZE: f64 = 1e-3;
const LARGEST_SIZE: f64 = 1e4;
/// The middle of a line that is averaged over to see past its grain, as a share of its width to either side.
const CORE_BAND: f64 = 0.35;

impl LineImage {
    /// The same of a scan of which each block of pixels, so many a side, was one of the page.
    pub(crate) fn of_finer(self, block: usize) -> Self {
        let broad = self.broad.map(|broad| Box::new(broad.of_finer(block)));
        Self { scale: self.scale / block as f64, noise: self.noise.of_finer(block), broad, ..self }
    }

    /// Whether the ink of a line, `core` in its middle, runs from one point to another without a break.
    ///
    /// The ink that is missing along the way adds up to the length of the gap, however it lies on the pixels and
    /// however much it is blurred.
    pub(crate) fn is_inked(&self, a: Point, b: Point, core: f32) -> bool {
        let noise = self.noise.at(a.midpoint(b));
        let longest = noise.between(SURE_GAP * self.scale.max(1.0), UNSURE_GAP);
        let length = (b - a).hypot();
        if noise.grain() == 0.0 {
            return self.missing(a, b, core) * (length + SPACING) <= longest;
        }
        let heading = if length > 1e-9 { (b - a) / length } else { return true };
        let profile = GapProfile::of(self);
        !way(a, b).any(|p| profile.gap(self, p, heading, core) > longest)
    }

    /// Whether a line of a width with `core` in its middle goes on through a point.
    pub(crate) fn goes_on(&self, p: Point, heading: Vec2, width: f64, core: f32) -> bool {
        let noise = self.noise.at(p);
        let around = heading * noise.between(WHOLE, 0.0);
        let core = noise.between(core.min(1.0).into(), core.into()) as f32;
        let sampling = (0.5 * (FULL_WIDTH - width)).max(0.0);
        let sure = (SURE_LOSS * self.scale.max(1.0)).max(sampling);
        self.missing(p - around, p + around, core) <= noise.between(sure, UNSURE_LOSS.max(sure))
    }

    /// Share of the ink that is missing on the way from one point to another.
    fn missing(&self, a: Point, b: Point, core: f32) -> f64 {
        let missing = way(a, b).map(|p| (1.0 - f64::from(self.ink.sample(p) / core)).max(0.0));
        let (sum, count) = missing.fold((0.0, 0), |(sum, count), missing| (sum + missing, count + 1));
        sum / f64::from(count)
    }

    /// Ink in the middle of a line: where it is unsure the mean across it, since single pixels are mostly grain.
    pub(crate) fn core(&self, p: Point, heading: Vec2) -> f32 {
        let grain = self.noise.at(p).grain();
        if grain == 0.0 {
            return self.ink.sample(p);
        }
        let step = heading.turn_90() * (0.5 * CORE_BAND * self.line_width * grain);
        (-2..=2).map(|k| self.ink.sample(p + step * f64::from(k))).sum::<f32>() / 5.0
    }
}

/// Points [`SPACING`] apart, both ends included.
fn way(a: Point, b: Point) -> impl Iterator<Item = Point> {
    let count = ((b - a).hypot() / SPACING).ceil().max(1.0) as usize;
    (0..=count).map(move |k| a.lerp(b, k as f64 / count as f64))
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
        for (what, size) in [("mask", self.mask.size()), ("depth", self.depth.size()), ("solid", self.solid.size())] {
            if size != self.ink.size() {
                return broken(format!("the {what} is {size:?} pixels and the ink {:?}", self.ink.size()));
            }
        }
        let positive = [("line width", self.line_width), ("scale", self.scale), ("page scale", self.page_scale)]
            .map(|(what, v)| (what, v, LEAST_SIZE));
        if !self.noise.is_valid() {
            return broken("the noise has impossible numbers".into());
        }
        match positive
            .into_iter()
            .chain([("blur", self.blur, 0.0)])
            .find(|(_, value, least)| !(*least..=LARGEST_SIZE).contains(value))
        {
            Some((what, value, _)) => broken(format!("the {what} is {value}")),
            None => self.broad.as_ref().map_or(Ok(()), |broad| broad.validate()),
        }
    }
}
