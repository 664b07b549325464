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

impl InkEstimator for LearnedInk {
    fn estimate(&self, scan: &Scan) -> Result<Raster<f32>> {
        self.estimate_until(scan, &Cancel::default())
    }

    /// A page is looked at as a whole first; how broad its lines then are says at what size they are known best. Of hairlines
    /// the network sees little, and nothing says how much too fine they are: the page is enlarged until they are seen, and
    /// what is ink at any of these sizes is ink.
    fn estimate_until(&self, scan: &Scan, cancel: &Cancel) -> Result<Raster<f32>> {
        let (width, height) = scan.gray.size();
        let largest = (MOST_PIXELS / (width * height) as f64).sqrt().clamp(1.0, LARGEST);
        let first = (FIRST_LOOK / width.max(height) as f64).min(1.0);
        let look = |factor| {
            let coverage = self.look(scan, factor, cancel)?;
            Ok((line_width(&coverage).unwrap_or(LINE_WIDTH), resized(sure(coverage), width, height)))
        };
        let (mut seen, mut ink) = look(first)?;
        if first < 1.0 && seen > ALIKE * LINE_WIDTH {
            return Ok(look(first * LINE_WIDTH / seen)?.1);
        }
        let mut factor = first;
        while ALIKE * seen < LINE_WIDTH && ALIKE * factor < largest {
            factor = (2.0 * factor).min(largest);
            let (closer, more) = look(factor)?;
            seen = closer;
            ink.data_mut().iter_mut().zip(more.data()).for_each(|(ink, more)| *ink = ink.max(*more));
        }
        Ok(ink)
    }
}

/// What is surely ink, 0 to 1, of what the network says of it.
fn sure(coverage: Raster<f32>) -> Raster<f32> {
    coverage.mapped(0.0, |c| ((c - INK[0]) / (INK[1] - INK[0])).clamp(0.0, 1.0))
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
