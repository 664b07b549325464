//! Very thick and very thin drawings are brought to a width that the later stages know.

use super::smooth;
use crate::raster::Raster;
use image::imageops::{FilterType, resize as resize_image};

/// Lines wider than this many pixels carry no more detail for it: they are traced at about half this width.
const THICK: f64 = 14.0;
/// Lines thinner than this many pixels are enlarged, so that edges and directions can be told apart; with the lines of a
/// scan its grain is enlarged as well, so there only thinner ones are.
const THIN: f64 = 2.4;
const THIN_ON_SCAN: f64 = 1.75;
/// The largest raster that is enlarged, in pixels.
const ENLARGE_LIMIT: usize = 30_000_000;

/// The factor by which to resample a drawing of a size, from its grain and the sorted widths of its lines; 1 for most.
pub(super) fn scale_for((width, height): (usize, usize), noise: f64, widths: &[f64], line_width: f64) -> f64 {
    let thin = if noise > 0.0 { THIN_ON_SCAN } else { THIN };
    if line_width < thin && 4 * width * height <= ENLARGE_LIMIT {
        return 2.0;
    }
    let Some(&thin) = widths.get(widths.len() / 10) else { return 1.0 };
    // A fine line among thick ones keeps at least four pixels.
    let block = (2.0 * line_width / THICK).round().min((thin / 4.0).floor());
    let shrinks = line_width > THICK && block >= 2.0 && width.min(height) as f64 / block >= 16.0;
    if shrinks { block.recip() } else { 1.0 }
}

/// Standard deviation, in pixels of the enlarged raster, of the blur that takes the staircase of pixels out of a clean
/// render's lines that are hardly wider than a pixel.
pub(super) const SOFTENING: f64 = 0.8;

/// Resamples ink by a factor of [`scale_for`]: every pixel becomes four, or a block of them becomes one.
pub(super) fn resize(ink: Raster<f32>, noise: f64, scale: f64) -> Raster<f32> {
    if scale < 1.0 {
        return averaged(&ink, scale.recip().round() as usize);
    }
    let (width, height) = (2 * ink.width() as u32, 2 * ink.height() as u32);
    let resized = Raster::from_image(resize_image(&ink.into_image(), width, height, FilterType::CatmullRom));
    let resized = if noise == 0.0 { smooth(resized, SOFTENING as f32) } else { resized };
    resized.map(|i| i.clamp(0.0, 1.0))
}

/// The means of square blocks; those at the right and at the bottom are cut off by the border.
fn averaged(ink: &Raster<f32>, block: usize) -> Raster<f32> {
    let (width, height) = ink.size();
    Raster::from_fn(width.div_ceil(block), height.div_ceil(block), |x, y| {
        let (columns, rows) = (x * block..width.min((x + 1) * block), y * block..height.min((y + 1) * block));
        let count = columns.len() * rows.len();
        rows.map(|y| ink.row(y)[columns.clone()].iter().sum::<f32>()).sum::<f32>() / count as f32
    })
}
