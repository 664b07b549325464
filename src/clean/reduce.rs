//! Large scans of broad lines are reduced before anything else is done with them.
//!
//! The place of a line is known from all of its ink, of which the means of blocks of pixels lose nothing, and its grain and
//! blur cover several pixels anyway. Renders are left as they are: their edges are sure to a share of a pixel.

use super::blur::unblurred_width;
use super::distance::distance;
use super::noise::{Noise, NoiseMap};
use super::page::{JOINING, Page};
use super::resample::averaged;
use super::threshold::Told;
use super::width::Ridge;
use crate::load::Scan;
use crate::options::Options;
use crate::raster::Raster;
use image::RgbImage;

/// Scans of fewer pixels are quick as they are.
const LARGE: usize = 4_000_000;
/// The longer side of a scan at a first look, in pixels, at most: its grain is in no pixel then.
const FIRST_LOOK: usize = 1000;
/// Lines keep so many pixels, of which the finest may be a little thinner.
const LEAST_WIDTH: f64 = 5.0;
const FINEST: f64 = 4.0;

/// Whether a scan is so large that it is worth a look whether it can be reduced.
pub(crate) fn is_large(scan: &Scan) -> bool {
    scan.gray.data().len() >= LARGE
}

/// Side of the blocks of pixels to which a scan that is no render can be reduced; 1 where it can not.
pub(crate) fn block(scan: &Scan, options: &Options) -> usize {
    // The size of specks is told in pixels of the scan.
    if options.despeckle.is_some() {
        return 1;
    }
    let (width, height) = scan.gray.size();
    let step = width.max(height).div_ceil(FIRST_LOOK);
    let look = Scan { gray: averaged(&scan.gray, step), rgb: None, dpi: None };
    let page = Page::of(&look, options.invert);
    let unsure = NoiseMap::even(Noise { along: f64::MAX, ..Noise::default() });
    let Told { ink, mask, .. } = page.inked(&unsure, options.threshold);
    let ridge = Ridge::of(&ink, &mask, &distance(&mask));
    let finest = ridge.widths.get(ridge.widths.len() / 10).copied().unwrap_or(1.0);
    let width = |measured: f64| step as f64 * unblurred_width(measured, JOINING);
    let block = (width(ridge.line_width()) / LEAST_WIDTH).min(width(finest) / FINEST);
    (block as usize).max(1)
}

/// A scan whose pixels are the means of blocks of another's.
pub(crate) fn reduced(scan: &Scan, block: usize) -> Scan {
    let dpi = scan.dpi.map(|dpi| dpi / block as f64);
    Scan { gray: averaged(&scan.gray, block), rgb: scan.rgb.as_ref().map(|rgb| averaged_rgb(rgb, block)), dpi }
}

fn averaged_rgb(rgb: &RgbImage, block: usize) -> RgbImage {
    let (width, height) = (rgb.width() as usize, rgb.height() as usize);
    let small = Raster::from_rows(width.div_ceil(block), height.div_ceil(block), [0; 3], |y, row| {
        let rows = y * block..height.min((y + 1) * block);
        for (x, mean) in row.iter_mut().enumerate() {
            let columns = x * block..width.min((x + 1) * block);
            let count = (columns.len() * rows.len()) as u32;
            let mut sum = [0; 3];
            for (x, y) in rows.clone().flat_map(|y| columns.clone().map(move |x| (x, y))) {
                sum.iter_mut().zip(rgb.get_pixel(x as u32, y as u32).0).for_each(|(sum, v)| *sum += u32::from(v));
            }
            *mean = sum.map(|sum| ((sum + count / 2) / count) as u8);
        }
    });
    small.into_rgb_image()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A page of slanted lines of a width, whose paper varies from pixel to pixel by so much.
    fn page(width: f32, grain: f32) -> Scan {
        let gray = Raster::from_rows(2400, 1800, 0.0, |y, row| {
            // A linear congruential generator, its upper bits.
            let mut dice = y as u32;
            for (x, to) in row.iter_mut().enumerate() {
                dice = dice.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                let across = ((y as f32 - 0.3 * x as f32) / 1.044).rem_euclid(150.0) - 75.0;
                let ink = (0.5 * width + 0.5 - across.abs()).clamp(0.0, 1.0);
                *to = 0.9 - 0.7 * ink + grain * ((dice >> 16) as f32 / 65536.0 - 0.5);
            }
        });
        Scan { gray, rgb: None, dpi: Some(600.0) }
    }

    #[test]
    fn lines_of_a_large_scan_keep_some_pixels_of_their_width() {
        let block = |width, grain| block(&page(width, grain), &Options::default());
        assert_eq!([3.0, 6.0, 12.0].map(|width| block(width, 0.1)), [1, 1, 2]);
        assert!((4..=6).contains(&block(25.0, 0.1)), "{}", block(25.0, 0.1));
    }

    #[test]
    fn each_pixel_is_the_mean_of_its_block_up_to_the_border() {
        let rgb = RgbImage::from_fn(5, 3, |x, y| image::Rgb([10 * x as u8, 20 * y as u8, 7]));
        let gray = Raster::from_fn(5, 3, |x, y| (x + 10 * y) as f32);
        let small = reduced(&Scan { gray, rgb: Some(rgb), dpi: Some(300.0) }, 2);
        assert_eq!(small.gray.data(), [5.5, 7.5, 9.0, 20.5, 22.5, 24.0]);
        let rgb = small.rgb.unwrap();
        assert_eq!((rgb.dimensions(), small.dpi), ((3, 2), Some(150.0)));
        assert_eq!([rgb.get_pixel(0, 0).0, rgb.get_pixel(2, 1).0], [[5, 10, 7], [40, 40, 7]]);
    }
}
