//! The ink that darkness alone tells, and what it has in common with that of an estimator.

use super::{mean_coverage, widened};
use crate::clean::{LineImage, distance, runs};
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
/// Ink that is deeper than this somewhere, in pixels of the page, is a solid: half of the broadest pen that the network was
/// trained on. Of what is broader it may see no more than dark paper, and a rim.
const DEEP: f32 = 4.0;
/// A solid is ink as a whole where an estimator sees this share of it.
const KNOWN: f64 = 0.5;

/// The ink that darkness tells.
pub(crate) struct Darkness {
    /// The pixels of the page that are ink.
    inked: Mask,
    /// Those of them that belong to solids.
    solid: Mask,
}

impl Darkness {
    /// The ink of a cleaned page, lines and solid regions, in pixels of the page.
    pub fn of(image: &LineImage, (width, height): (usize, usize)) -> Self {
        let is_inked = |image: &LineImage, x: usize, y: usize| {
            let p = Point::new((x as f64 + 0.5) * image.scale, (y as f64 + 0.5) * image.scale);
            image.mask.at(p) == Some(true) || image.solid.at(p) == Some(true)
        };
        let inked = Raster::from_rows(width, height, false, |y, row| {
            for (x, to) in row.iter_mut().enumerate() {
                *to = is_inked(image, x, y) || image.broad.as_ref().is_some_and(|broad| is_inked(broad, x, y));
            }
        });
        let to_deep = distance(&distance(&inked).mapped(true, |depth| depth <= DEEP));
        let solid = Raster::from_rows(width, height, false, |y, row| {
            for (x, to) in row.iter_mut().enumerate() {
                *to = inked[(x, y)] && to_deep[(x, y)] <= 1.5 * DEEP;
            }
        });
        Self { inked, solid }
    }

    /// Whether it is that of a coverage of the page, solids aside.
    pub fn agrees(&self, coverage: &Raster<f32>) -> bool {
        let sure = coverage.mapped(false, |c| c >= SURE);
        let near_ink = widened(&self.inked.mapped(0.0, |inked| f32::from(u8::from(inked))), APART);
        let near_coverage = widened(coverage, STRETCH);
        let lines = self.inked.data().iter().zip(self.solid.data()).map(|(inked, solid)| *inked && !solid);
        let is_seen = near_coverage.data().iter().map(|c| *c > 0.0);
        let is_told = near_ink.data().iter().map(|c| *c > 0.0);
        missed(lines, is_seen) <= MOST && missed(sure.data().iter().copied(), is_told) <= MOST
    }

    /// Fills a coverage of the page where solids are of which it knows the most.
    pub fn complete(&self, coverage: &mut Raster<f32>) {
        let solids = runs(&self.solid);
        let covered = mean_coverage(&solids, coverage);
        for run in solids.into_iter().filter(|run| covered[run.region] >= KNOWN) {
            (run.from..run.to).for_each(|x| coverage[(x, run.y)] = 1.0);
        }
    }
}

/// The share of some pixels that is not among others.
fn missed(pixels: impl Iterator<Item = bool>, others: impl Iterator<Item = bool>) -> f64 {
    let own = pixels.zip(others).filter(|(own, _)| *own);
    let (all, missed) = own.fold((0usize, 0usize), |(all, missed), (_, other)| (all + 1, missed + usize::from(!other)));
    missed as f64 / all.max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solids_are_filled_of_which_the_most_is_known() {
        let inside = |x: usize, y: usize| (20..80).contains(&x) && (10..50).contains(&y);
        let inked = Raster::from_fn(120, 60, inside);
        let dark = Darkness { solid: inked.clone(), inked };
        let of = |from: usize| Raster::from_fn(120, 60, |x, y| f32::from(u8::from(x >= from && inside(x, y))));
        for (from, filled) in [(30, true), (45, true), (55, false), (75, false)] {
            let mut coverage = of(from);
            dark.complete(&mut coverage);
            assert_eq!(coverage, if filled { of(0) } else { of(from) }, "{from}");
        }
    }
}
