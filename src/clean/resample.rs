//! Very thick and very thin drawings are brought to a width that the later stages know.

use super::distance::distance;
use super::noise::Noise;
use super::smooth;
use super::width::Ridge;
use crate::raster::{Mask, Raster};
use image::imageops::{FilterType, resize as resize_image};
use kurbo::Point;

/// Lines wider than this many pixels carry no more detail for it: they are traced at about half this width.
const THICK: f64 = 14.0;
/// Lines thinner than this many pixels are enlarged, so that edges and directions can be told apart; with the lines of a
/// scan its grain is enlarged as well, so there only thinner ones are.
const THIN: f64 = 2.4;
const THIN_ON_SCAN: f64 = 1.75;
/// The largest raster that is enlarged, in pixels.
const ENLARGE_LIMIT: usize = 30_000_000;

/// Standard deviation, in pixels of the enlarged raster, of the blur that takes the staircase of pixels out of a clean
/// render's lines that are hardly wider than a pixel.
const SOFTENING: f64 = 0.8;
/// Lines that measure less than this many pixels are hairlines, as are those with less ink in their middle than this: they
/// fill no pixel,
const HAIRLINE: f64 = 1.7;
const FULL: f32 = 0.75;
/// and this is theirs.
const SOFTENING_OF_HAIRLINES: f64 = 1.0;
/// Standard deviation of the blur that an enlarged hairline has anyway: of a pixel's own square and of interpolation.
const INTERPOLATED: f64 = 0.82;

/// The finest lines of a drawing are one in so many.
const FINEST: usize = 8;

/// How a drawing is resampled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Resampling {
    /// Pixels of the new raster per pixel of the old: 2, 1 or the inverse of a whole number.
    pub scale: f64,
    /// Whether the lines of a clean render are smoothed once they are enlarged, and how wide they are.
    smoothed: Option<Thin>,
}

/// Lines of a clean render that is enlarged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Thin {
    Line,
    Hairline,
}

impl Resampling {
    /// What suits a drawing, from its grain, the sorted widths of its lines and the ink on their ridge; none for most.
    pub fn of(ridge: &Ridge, (width, height): (usize, usize), noise: Noise, line_width: f64) -> Self {
        let by = |scale: f64| Self { scale, smoothed: None };
        let widths = &ridge.widths;
        let thin = noise.between(THIN, THIN_ON_SCAN);
        if line_width < thin && 4 * width * height <= ENLARGE_LIMIT {
            let finest = widths.get(widths.len() / FINEST).copied().unwrap_or(line_width);
            let faint = ridge.ink.get(ridge.ink.len() / FINEST).is_some_and(|&ink| ink < FULL);
            let kind = if finest < HAIRLINE || faint { Thin::Hairline } else { Thin::Line };
            return Self { scale: 2.0, smoothed: (noise.grain() < 0.5).then_some(kind) };
        }
        let Some(&thin) = widths.get(widths.len() / 10) else { return by(1.0) };
        // A fine line among thick ones keeps at least four pixels.
        let block = (2.0 * line_width / THICK).round().min((thin / 4.0).floor());
        let shrinks = line_width > THICK && block >= 2.0 && width.min(height) as f64 / block >= 16.0;
        by(if shrinks { block.recip() } else { 1.0 })
    }

    /// Standard deviation of the blur of a clean render's lines once it is resampled, in pixels of the new raster.
    pub fn blur(&self) -> f64 {
        match self.smoothed {
            None => 0.0,
            Some(Thin::Line) => SOFTENING,
            Some(Thin::Hairline) => SOFTENING_OF_HAIRLINES.hypot(INTERPOLATED),
        }
    }

    /// Resamples ink of a depth: every pixel becomes four, or a block of them becomes one.
    pub fn apply(&self, ink: Raster<f32>, depth: &Raster<f32>) -> Raster<f32> {
        if self.scale < 1.0 {
            return averaged(&ink, self.scale.recip().round() as usize);
        }
        let (width, height) = (2 * ink.width() as u32, 2 * ink.height() as u32);
        let resized = Raster::from_image(resize_image(&ink.into_image(), width, height, FilterType::CatmullRom));
        let resized = match self.smoothed {
            None => resized,
            Some(Thin::Line) => smooth(resized, SOFTENING as f32),
            Some(Thin::Hairline) => evened(&smooth(resized, SOFTENING_OF_HAIRLINES as f32), &wide(depth)),
        };
        resized.map(|i| i.clamp(0.0, 1.0))
    }
}

/// Side of the blocks over which the ink of thin lines is averaged, in pixels of the enlarged raster.
const BLOCK: usize = 8;
/// The contraharmonic mean of the ink across a thin line, whose profile is all but Gaussian, as a share of its peak:
/// the square root of 3/4.
const MEAN_OF_PEAK: f32 = 0.866;
/// Lines fainter than this are none.
const FAINTEST: f32 = 0.3;

/// Lines deeper than this many pixels are no hairlines, nor is what lies within so many pixels of them.
const WIDE: f32 = 2.75;
const BESIDE_WIDE: f32 = 0.75;

/// Lines too wide to be hairlines, and a margin, from the depth of the ink.
fn wide(depth: &Raster<f32>) -> Mask {
    if !depth.data().iter().any(|&d| d > WIDE) {
        return Mask::filled(depth.width(), depth.height(), false);
    }
    distance(&depth.mapped(false, |d| d <= WIDE)).mapped(false, |to_core| to_core <= WIDE + BESIDE_WIDE)
}

/// Enlarged ink as a share of that of the hairlines near it: their ink may fill no pixel. Wide lines stay as they are.
fn evened(ink: &Raster<f32>, wide: &Mask) -> Raster<f32> {
    let sums = |power: i32| {
        let (columns, rows) = (ink.width().div_ceil(BLOCK), ink.height().div_ceil(BLOCK));
        let sums = Raster::from_rows(columns, rows, 0.0, |row, sums| {
            for y in row * BLOCK..((row + 1) * BLOCK).min(ink.height()) {
                let own = ink.row(y).iter().zip(wide.row(y / 2).iter().flat_map(|w| [w, w]));
                for (x, (&i, _)) in own.enumerate().filter(|(_, (_, wide))| !**wide) {
                    sums[x / BLOCK] += i.powi(power);
                }
            }
        });
        smooth(sums, 1.0)
    };
    let (fourth, third) = (sums(4), sums(3));
    let core = Raster::from_fn(third.width(), third.height(), |x, y| {
        (fourth[(x, y)] / third[(x, y)].max(1e-6) / MEAN_OF_PEAK).clamp(FAINTEST, 1.0)
    });
    Raster::from_rows(ink.width(), ink.height(), 0.0, |y, row| {
        for (x, (to, &i)) in row.iter_mut().zip(ink.row(y)).enumerate() {
            let within = |at: usize, n: usize| ((at as f64 + 0.5) / BLOCK as f64).clamp(0.5, n as f64 - 0.5);
            let cell = Point::new(within(x, core.width()), within(y, core.height()));
            *to = if i > 0.0 && !wide[(x / 2, y / 2)] { i / core.sample(cell) } else { i };
        }
    })
}

/// The means of square blocks; those at the right and at the bottom are cut off by the border.
pub(super) fn averaged(ink: &Raster<f32>, block: usize) -> Raster<f32> {
    let (width, height) = ink.size();
    Raster::from_rows(width.div_ceil(block), height.div_ceil(block), 0.0, |y, row| {
        let rows = y * block..height.min((y + 1) * block);
        for (x, mean) in row.iter_mut().enumerate() {
            let columns = x * block..width.min((x + 1) * block);
            let sum = rows.clone().map(|y| ink.row(y)[columns.clone()].iter().sum::<f32>()).sum::<f32>();
            *mean = sum / (columns.len() * rows.len()) as f32;
        }
    })
}
