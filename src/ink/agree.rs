//! Whether darkness alone tells the same ink as an estimator.

use super::widened;
use crate::clean::{LineImage, distance};
use crate::raster::{Mask, Raster};
use kurbo::Point;

/// Coverage from which ink is sure.
const SURE: f32 = 0.9;
/// How far the rims of the same ink may lie apart, in pixels of the page.
const APART: i64 = 2;
/// What is further from all ink that an estimator sees, in pixels of the page, is not the ink of a faint stretch in a line that
/// it sees.
const STRETCH: i64 = 6;
/// The most of one's ink that the other may take for none, as a share of it: of gentle scans it is nothing, and of pages with
/// shadows, stains or ruling more.
const MOST: f64 = 0.002;

/// Ink that is deeper than this somewhere, in pixels of the page, is left out with its rim: half of the broadest pen that the
/// network was trained on. Of broader ones it may see no more than dark paper.
const DEEP: f32 = 4.0;

/// Whether the ink of a cleaned page, lines and solid regions, is that of a coverage, which has the size of the page.
pub(crate) fn agree(image: &LineImage, coverage: &Raster<f32>) -> bool {
    let inked = in_page(image, coverage.size());
    let to_deep = distance(&distance(&inked).mapped(true, |depth| depth <= DEEP));
    let sure = coverage.mapped(false, |c| c >= SURE);
    let near_ink = widened(&inked.mapped(0.0, |inked| f32::from(u8::from(inked))), APART);
    let near_coverage = widened(coverage, STRETCH);
    let known = inked.data().iter().zip(to_deep.data()).map(|(inked, d)| *inked && *d > 1.5 * DEEP);
    let is_seen = near_coverage.data().iter().map(|c| *c > 0.0);
    let is_told = near_ink.data().iter().map(|c| *c > 0.0);
    missed(known, is_seen) <= MOST && missed(sure.data().iter().copied(), is_told) <= MOST
}

/// The share of some pixels that is not among others.
fn missed(pixels: impl Iterator<Item = bool>, others: impl Iterator<Item = bool>) -> f64 {
    let own = pixels.zip(others).filter(|(own, _)| *own);
    let (all, missed) = own.fold((0usize, 0usize), |(all, missed), (_, other)| (all + 1, missed + usize::from(!other)));
    missed as f64 / all.max(1) as f64
}

/// Where a page has ink.
fn in_page(image: &LineImage, (width, height): (usize, usize)) -> Mask {
    let is_inked = |image: &LineImage, x: usize, y: usize| {
        let p = Point::new((x as f64 + 0.5) * image.scale, (y as f64 + 0.5) * image.scale);
        image.mask.at(p) == Some(true) || image.solid.at(p) == Some(true)
    };
    Raster::from_rows(width, height, false, |y, row| {
        for (x, to) in row.iter_mut().enumerate() {
            *to = is_inked(image, x, y) || image.broad.as_ref().is_some_and(|broad| is_inked(broad, x, y));
        }
    })
}
