//! Pages with their ink and what a network sees, as a picture.

use crate::error::Result;
use crate::raster::Raster;
use crate::synth::Page;
use crate::write::write_png;
use image::{ImageBuffer, Rgb, RgbImage};
use std::path::Path;

/// Pages side by side.
const COLUMNS: usize = 12;
/// Pixels between panels.
const GAP: usize = 4;
/// A background that no page has.
const BETWEEN: Rgb<u8> = Rgb([180, 60, 180]);

/// Draws pages, each over its true ink and, where there is one, the coverage that is seen, to a PNG.
///
/// # Errors
/// [`crate::Error::Write`].
pub fn draw(examples: &[(&Page, Option<Vec<f32>>)], out: &Path) -> Result<()> {
    let stacks: Vec<Vec<RgbImage>> = examples.iter().map(|(page, seen)| panels(page, seen.as_deref())).collect();
    let side = |of: &dyn Fn(&RgbImage) -> u32| stacks.iter().flatten().map(of).max().unwrap_or(0) as usize + GAP;
    let (wide, high) = (side(&RgbImage::width), side(&RgbImage::height));
    let rows = stacks.iter().map(Vec::len).max().unwrap_or(1);
    let lines = stacks.len().div_ceil(COLUMNS);
    let size = ((COLUMNS * wide) as u32, (lines * (rows * high + 2 * GAP)) as u32);
    let mut whole = ImageBuffer::from_pixel(size.0, size.1.max(1), BETWEEN);
    for (i, stack) in stacks.iter().enumerate() {
        let (x, y) = (i % COLUMNS * wide, i / COLUMNS * (rows * high + 2 * GAP));
        for (k, panel) in stack.iter().enumerate() {
            image::imageops::replace(&mut whole, panel, x as i64, (y + k * high) as i64);
        }
    }
    write_png(out, &whole.into())
}

fn panels(page: &Page, seen: Option<&[f32]>) -> Vec<RgbImage> {
    let (width, height) = page.ink.size();
    let byte = |v: f32| (v.clamp(0.0, 1.0) * 255.0).round() as u8;
    let shown = |color: &dyn Fn(usize) -> [f32; 3]| {
        RgbImage::from_fn(width as u32, height as u32, |x, y| Rgb(color(y as usize * width + x as usize).map(byte)))
    };
    let planes: [&[f32]; 3] = [0, 1, 2].map(|c| Raster::data(&page.color[c]));
    let mut all = vec![shown(&|i| planes.map(|p| p[i])), shown(&|i| [1.0 - page.ink.data()[i]; 3])];
    all.extend(seen.map(|seen| shown(&|i| [1.0 - seen[i]; 3])));
    all
}
