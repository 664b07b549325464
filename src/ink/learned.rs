//! Ink as a network sees it, at the size of lines that the network knows.

use super::InkEstimator;
use crate::cancel::Cancel;
use crate::error::Result;
use crate::load::Scan;
use crate::raster::Raster;
use crate::unet::InkNet;
use image::imageops::{FilterType, resize};
use std::sync::OnceLock;

/// The longer side of the page at a first look, in pixels.
const FIRST_LOOK: f64 = 1100.0;
/// The width that lines are brought to on a page that has to be looked at smaller than it is, in pixels: well within what
/// the network is trained on.
const LINE_WIDTH: f64 = 3.0;
/// A second look is not worth it where its size would differ by less than this factor.
const ALIKE: f64 = 1.3;
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
        if factor == 1.0 { network.coverage(scan, cancel) } else { network.coverage(&smaller(scan, factor), cancel) }
    }
}

impl InkEstimator for LearnedInk {
    fn estimate(&self, scan: &Scan) -> Result<Raster<f32>> {
        self.estimate_until(scan, &Cancel::default())
    }

    /// A large page is looked at as a whole first; how broad its lines then are says at what size they are known best.
    fn estimate_until(&self, scan: &Scan, cancel: &Cancel) -> Result<Raster<f32>> {
        let (width, height) = scan.gray.size();
        let first = (FIRST_LOOK / width.max(height) as f64).min(1.0);
        let mut coverage = self.look(scan, first, cancel)?;
        let second = line_width(&coverage).map_or(first, |seen| (first * LINE_WIDTH / seen).min(1.0));
        if first < 1.0 && (second / first).ln().abs() > ALIKE.ln() {
            coverage = self.look(scan, second, cancel)?;
        }
        Ok(resized(coverage, width, height))
    }
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

/// A page at a factor of its size, each pixel the mean of those that it stands for.
fn smaller(scan: &Scan, factor: f64) -> Scan {
    let side = |n: usize| ((n as f64 * factor).round() as usize).max(1);
    let (width, height) = (side(scan.gray.width()), side(scan.gray.height()));
    let rgb = scan.rgb.as_ref().map(|rgb| resize(rgb, width as u32, height as u32, FilterType::Triangle));
    Scan { gray: resized(scan.gray.clone(), width, height), rgb, dpi: None }
}

fn resized(raster: Raster<f32>, width: usize, height: usize) -> Raster<f32> {
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
