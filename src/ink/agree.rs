//! Whether darkness alone tells the same ink as an estimator.

use super::widened;
use crate::clean::LineImage;
use crate::raster::Raster;
use kurbo::Point;

/// Coverage below the first is no ink, and from the second on is sure to be.
const NO_INK: f32 = 0.3;
const SURE: f32 = 0.9;
/// How far the rims of the same ink may lie apart, in pixels of the page.
const APART: i64 = 2;
/// The most of one's ink that the other may take for none, as a share of it: of gentle scans it is nothing, and of pages with
/// shadows, stains or ruling more.
const MOST: f64 = 0.002;

/// Whether the ink of a cleaned page, lines and solid regions, is that of a coverage, which has the size of the page.
pub(crate) fn agree(image: &LineImage, coverage: &Raster<f32>) -> bool {
    let inked = in_page(image, coverage.size());
    let (near_ink, near_coverage) = (widened(&inked, APART), widened(coverage, APART));
    let share = |of: &Raster<f32>, least: f32, near: &Raster<f32>, none: f32| {
        let own = of.data().iter().zip(near.data()).filter(|(own, _)| **own >= least);
        let (all, stray) = own.fold((0usize, 0usize), |(all, stray), (_, n)| (all + 1, stray + usize::from(*n < none)));
        stray as f64 / all.max(1) as f64
    };
    share(&inked, 0.5, &near_coverage, NO_INK) <= MOST && share(coverage, SURE, &near_ink, 0.5) <= MOST
}

/// Where a page has ink, 1, and where not, 0.
fn in_page(image: &LineImage, (width, height): (usize, usize)) -> Raster<f32> {
    let is_inked = |image: &LineImage, x: usize, y: usize| {
        let p = Point::new((x as f64 + 0.5) * image.scale, (y as f64 + 0.5) * image.scale);
        image.mask.at(p) == Some(true) || image.solid.at(p) == Some(true)
    };
    Raster::from_rows(width, height, 0.0, |y, row| {
        for (x, to) in row.iter_mut().enumerate() {
            let broad = image.broad.as_ref().is_some_and(|broad| is_inked(broad, x, y));
            *to = f32::from(u8::from(broad || is_inked(image, x, y)));
        }
    })
}
