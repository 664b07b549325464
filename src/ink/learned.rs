//! Ink as a network sees it, at the size of lines that the network knows.

use super::{InkEstimator, mean_coverage, widened};
use crate::cancel::Cancel;
use crate::clean::runs;
use crate::error::Result;
use crate::load::Scan;
use crate::raster::Raster;
use crate::unet::InkNet;
use image::imageops::{FilterType, resize};
use std::sync::OnceLock;

/// The longer side of the page at a first look, in pixels.
const FIRST_LOOK: f64 = 1100.0;
/// The width of lines that the network knows best, in pixels.
const LINE_WIDTH: f64 = 3.0;
/// Another look is not worth it where lines differ from that by less than this factor.
const ALIKE: f64 = 1.25;
/// The most that a page is enlarged, and the size to which it is enlarged at most, in pixels.
const LARGEST: f64 = 2.0;
const MOST_PIXELS: f64 = 6e6;
/// What the network gives less than the first is no ink, and from the second on it is sure: ruling and the rims of stains lie
/// below. Empirical.
const INK: [f32; 2] = [0.6, 0.9];
/// Of solid ink at least this share is seen from near too; empirical, guarded by
/// `the_network_tells_ink_from_a_shadow_and_squares`.
const SEEN_NEAR: f64 = 0.2;
/// A place has lines where at least so many of its pixels are ink; places are squares of so many pixels a side.
const PLACE: usize = 32;
const LEAST_INK: f32 = 16.0;

/// The ink network, shown a page at a size at which it knows the lines. By default it is the one that the program carries,
/// which is unpacked for the first page that asks for it.
#[derive(Clone, Debug, Default)]
pub struct LearnedInk {
    network: OnceLock<InkNet>,
}

impl LearnedInk {
    /// With a network.
    pub fn new(network: InkNet) -> Self {
        Self { network: network.into() }
    }

    fn network(&self) -> Result<&InkNet> {
        if let Some(network) = self.network.get() {
            return Ok(network);
        }
        let built_in = InkNet::built_in()?;
        Ok(self.network.get_or_init(|| built_in))
    }

    /// The coverage of a page looked at by a factor of its size, at that size.
    fn look(&self, scan: &Scan, factor: f64, cancel: &Cancel) -> Result<Raster<f32>> {
        let network = self.network()?;
        if factor == 1.0 { network.coverage(scan, cancel) } else { network.coverage(&scaled(scan, factor), cancel) }
    }
}

impl LearnedInk {
    /// The page at a size of which its lines are not too broad: the factor, the width of lines there, and what is seen.
    fn best_look(&self, scan: &Scan, cancel: &Cancel) -> Result<(f64, Option<f64>, Raster<f32>)> {
        let first = (FIRST_LOOK / scan.gray.width().max(scan.gray.height()) as f64).min(1.0);
        let coverage = self.look(scan, first, cancel)?;
        let seen = line_width(&coverage);
        match seen.filter(|seen| first < 1.0 && *seen > ALIKE * LINE_WIDTH) {
            Some(broad) => {
                let factor = first * LINE_WIDTH / broad;
                Ok((factor, Some(LINE_WIDTH), self.look(scan, factor, cancel)?))
            }
            None => Ok((first, seen, coverage)),
        }
    }
}

impl InkEstimator for LearnedInk {
    fn estimate(&self, scan: &Scan) -> Result<Raster<f32>> {
        self.estimate_until(scan, &Cancel::default())
    }

    /// A page is looked at as a whole first; how broad its lines then are says at what size they are known best. Of hairlines
    /// the network sees little, and nothing says how much too fine they are: the page is enlarged until they are seen, and
    /// what is ink at any of these sizes is ink. Other lines are seen from twice as far too, where specks and grain are not:
    /// only what both looks take for ink is. Solids fill the network's whole sight from near; from afar they do not.
    fn estimate_until(&self, scan: &Scan, cancel: &Cancel) -> Result<Raster<f32>> {
        let (width, height) = scan.gray.size();
        let full = |coverage: Raster<f32>| resized(coverage, (width, height));
        let (mut factor, mut seen, nearest) = self.best_look(scan, cancel)?;
        let half = self.look(scan, 0.5 * factor, cancel)?;
        let quarter = self.look(scan, 0.25 * factor, cancel)?;
        let solids = solids(&nearest, &half, &quarter);
        let mut ink = full(sure(&nearest));
        if !is_hairline(seen) {
            let half = full(half);
            ink.data_mut().iter_mut().zip(half.data()).for_each(|(ink, half)| *ink *= (half / INK[0]).min(1.0));
        }
        ink = most(ink, &full(solids));
        let largest = (MOST_PIXELS / (width * height) as f64).sqrt().clamp(1.0, LARGEST);
        while is_hairline(seen) && ALIKE * factor < largest {
            factor = (2.0 * factor).min(largest);
            let closer = self.look(scan, factor, cancel)?;
            seen = line_width(&closer);
            // A hairline between two rows covers half of each, and is as sure as one in a row.
            ink = most(ink, &full(sure(&closer)).mapped(0.0, |c| (2.0 * c).min(1.0)));
        }
        Ok(ink)
    }
}

/// Whether lines of a width are too fine to be seen well.
fn is_hairline(width: Option<f64>) -> bool {
    width.is_some_and(|width| ALIKE * width < LINE_WIDTH)
}

/// What is surely ink, 0 to 1, of what the network says of it.
fn sure(coverage: &Raster<f32>) -> Raster<f32> {
    coverage.mapped(0.0, |c| ((c - INK[0]) / (INK[1] - INK[0])).clamp(0.0, 1.0))
}

/// What is solid ink from afar and at least here and there from near too, at the size of the last look: a shadow is ink from
/// afar alone.
fn solids(near: &Raster<f32>, half: &Raster<f32>, quarter: &Raster<f32>) -> Raster<f32> {
    let [near, half] = [near, half].map(|look| sure(&resized(look.clone(), quarter.size())));
    let mut solid = opened(&most(sure(quarter), &half));
    let parts = runs(&solid.mapped(false, |c| c > 0.0));
    let seen = mean_coverage(&parts, &near);
    for run in parts.into_iter().filter(|run| seen[run.region] < SEEN_NEAR) {
        (run.from..run.to).for_each(|x| solid[(x, run.y)] = 0.0);
    }
    solid
}

/// The greater of two coverages of one size.
fn most(mut a: Raster<f32>, b: &Raster<f32>) -> Raster<f32> {
    a.data_mut().iter_mut().zip(b.data()).for_each(|(a, b)| *a = a.max(*b));
    a
}

/// A coverage without what is narrower than three pixels: its least around each pixel, and the most of that around each.
fn opened(coverage: &Raster<f32>) -> Raster<f32> {
    let paper = coverage.mapped(0.0, |c| 1.0 - c);
    widened(&widened(&paper, 1).mapped(0.0, |p| 1.0 - p), 1)
}

/// Width of the lines of a coverage, in pixels: the median over its places; `None` where there is no ink.
///
/// The area of a long line is its width times its length, and the total variation of its coverage is twice its length.
fn line_width(coverage: &Raster<f32>) -> Option<f64> {
    let (width, height) = coverage.size();
    let mut widths: Vec<f32> = Vec::new();
    for (top, left) in (0..height).step_by(PLACE).flat_map(|y| (0..width).step_by(PLACE).map(move |x| (y, x))) {
        let (mut area, mut variation) = (0.0, 0.0);
        for y in top..(top + PLACE).min(height - 1) {
            for x in left..(left + PLACE).min(width - 1) {
                let here = coverage[(x, y)];
                area += here;
                variation += (coverage[(x + 1, y)] - here).hypot(coverage[(x, y + 1)] - here);
            }
        }
        if area >= LEAST_INK && variation > 0.0 {
            widths.push(2.0 * area / variation);
        }
    }
    let middle = widths.len() / 2;
    (!widths.is_empty()).then(|| f64::from(*widths.select_nth_unstable_by(middle, f32::total_cmp).1))
}

/// A page at a factor of its size; where that is smaller, each pixel is the mean of those that it stands for.
fn scaled(scan: &Scan, factor: f64) -> Scan {
    let side = |n: usize| ((n as f64 * factor).round() as usize).max(1);
    let (width, height) = (side(scan.gray.width()), side(scan.gray.height()));
    let rgb = scan.rgb.as_ref().map(|rgb| resize(rgb, width as u32, height as u32, FilterType::Triangle));
    Scan { gray: resized(scan.gray.clone(), (width, height)), rgb, dpi: None }
}

fn resized(raster: Raster<f32>, (width, height): (usize, usize)) -> Raster<f32> {
    if raster.size() == (width, height) {
        return raster;
    }
    Raster::from_image(resize(&raster.into_image(), width as u32, height as u32, FilterType::Triangle))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_width_of_lines_is_that_of_most_places() {
        for width in [1.5, 3.0, 6.0, 12.0] {
            for slope in [0.0, 0.3, 1.0] {
                let along = 1.0 / f32::hypot(1.0, slope);
                let coverage = Raster::from_fn(300, 300, |x, y| {
                    let across = ((y as f32 - slope * x as f32) * along).rem_euclid(40.0) - 20.0;
                    (0.5 * width + 0.5 - across.abs()).clamp(0.0, 1.0)
                });
                let seen = line_width(&coverage).unwrap();
                assert!((seen / f64::from(width) - 1.0).abs() < 0.25, "{seen} for {width} at {slope}");
            }
        }
        assert!(line_width(&Raster::filled(100, 100, 0.0)).is_none());
    }
}
