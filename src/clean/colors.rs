//! Inks told apart by their colour.
//!
//! Of the light of a channel, paper keeps its level and ink takes a share: the absorbance, which grows evenly with how
//! much of the pixel is inked. Its largest channel is how strong the ink is, whatever its colour: yellow ink takes all
//! of the blue. Its hue is the ink's own even on the grey edge of a line. So inks are grouped by hue, black and grey
//! being one group, and each group is measured against its own full strength: a light blue line is as much ink as a
//! black one beside it.

use super::paper;
use super::smooth;
use crate::raster::Raster;
use image::RgbImage;
use kurbo::Vec2;
use std::f64::consts::TAU;

/// Ink of less saturation than this, as the share of its strength by which channels differ, is grey.
const LEAST_SATURATION: f32 = 0.3;
/// Channels that differ by less than this say nothing of the hue: rounding, and a scanner's chroma noise.
const LEAST_CHROMA: f32 = 0.03;
/// The chroma of ink that tells of a hue of its own.
const SURE_CHROMA: f32 = 0.12;
/// Hues are counted in steps of 5 degrees, and those within 25 degrees of a peak are one ink.
const BINS: usize = 72;
const SPREAD: usize = 5;
/// A hue is an ink's when it has this many pixels, and this share of all ink.
const LEAST_PIXELS: f64 = 30.0;
const LEAST_SHARE: f64 = 0.005;
/// Hues are looked at through a Gaussian of this many pixels, so that a lone pixel's noise does not count.
const BLUR: f32 = 0.8;

/// A page that is drawn in colour.
pub(super) struct ColorPage {
    /// Strength of the ink per pixel, 0 to 1.
    pub strength: Raster<f32>,
    /// Colour per pixel with the paper's own taken off: of dark ink on white, of light ink as it is.
    pub colors: Raster<[u8; 3]>,
    /// Group of inks per pixel; 0 is black and grey.
    pub group: Raster<u8>,
    /// Number of groups.
    pub groups: u8,
    /// Whether there is black or grey ink.
    pub has_grey: bool,
}

impl ColorPage {
    /// Pixels between inks of two groups, and their ink as it is without the seam: where inks of different strength
    /// mix in one pixel, it measures up to neither. The seam is closed (dilation and erosion by a square of three).
    pub fn seams(&self, ink: &Raster<f32>) -> Vec<((usize, usize), f32)> {
        let near = |x: usize, y: usize, reach: i64| {
            let (x, y) = (x as i64, y as i64);
            (-reach..=reach).flat_map(move |dy| (-reach..=reach).map(move |dx| (x + dx, y + dy)))
        };
        let inked_groups = |x: usize, y: usize| {
            let inked = near(x, y, 2).filter(|&(i, j)| ink.get(i, j).is_some_and(|v| v > 0.6));
            inked.filter_map(|(i, j)| self.group.get(i, j)).fold(0u128, |seen, group| seen | 1 << group)
        };
        let dilated = |x: i64, y: i64| {
            let around = near(x as usize, y as usize, 1);
            around.filter_map(|(i, j)| ink.get(i, j)).fold(0.0, f32::max)
        };
        let (width, height) = ink.size();
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let seam = pixels.filter(|&(x, y)| ink[(x, y)] > 0.05 && inked_groups(x, y).count_ones() > 1);
        let closed = seam.map(|(x, y)| {
            let around = near(x, y, 1).filter(|&(i, j)| ink.get(i, j).is_some());
            ((x, y), around.map(|(i, j)| dilated(i, j)).fold(f32::INFINITY, f32::min))
        });
        closed.collect()
    }
}

/// Tells inks apart; `None` where all ink is grey. On a dark ground light is ink.
pub(super) fn separate(rgb: &RgbImage, dark_ground: bool) -> Option<ColorPage> {
    let (width, height) = (rgb.width() as usize, rgb.height() as usize);
    let absorbance = [0, 1, 2].map(|channel| {
        let light = Raster::from_fn(width, height, |x, y| {
            let value = f32::from(rgb.get_pixel(x as u32, y as u32)[channel]) / 255.0;
            if dark_ground { 1.0 - value } else { value }
        });
        paper::divide(&light, &paper::paper_level(&light))
    });
    let at = |x: usize, y: usize| [0, 1, 2].map(|c| absorbance[c][(x, y)]);
    let strength = Raster::from_fn(width, height, |x, y| at(x, y).into_iter().fold(0.0, f32::max));
    // The colour's plane seen along its grey axis: opponents of red, and of green against blue.
    let red = Raster::from_fn(width, height, |x, y| at(x, y)[0] - 0.5 * (at(x, y)[1] + at(x, y)[2]));
    let green = Raster::from_fn(width, height, |x, y| 0.75f32.sqrt() * (at(x, y)[1] - at(x, y)[2]));
    let hues = Hues { red: smooth(red, BLUR), green: smooth(green, BLUR), strength: smooth(strength.clone(), BLUR) };
    let peaks = hues.peaks();
    if peaks.is_empty() {
        return None;
    }
    let group = Raster::from_fn(width, height, |x, y| hues.group(x, y, &peaks));
    let colors = Raster::from_fn(width, height, |x, y| {
        at(x, y).map(|a| (255.0 * if dark_ground { a } else { 1.0 - a }).round() as u8)
    });
    let has_grey = has_grey(&group, &strength);
    Some(ColorPage { strength, colors, group, groups: peaks.len() as u8 + 1, has_grey })
}

/// Whether enough grey ink has grey ink all around it: the grey edges of coloured lines have none.
fn has_grey(group: &Raster<u8>, strength: &Raster<f32>) -> bool {
    let is_grey_ink =
        |x: i64, y: i64| group.get(x, y).is_none_or(|g| g == 0) && strength.get(x, y).is_none_or(|s| s > SURE_CHROMA);
    let (width, height) = group.size();
    let pixels = (0..height as i64).flat_map(|y| (0..width as i64).map(move |x| (x, y)));
    let inner = pixels.filter(|&(x, y)| {
        is_grey_ink(x, y) && [(1, 0), (0, 1), (1, 1)].iter().all(|&(dx, dy)| is_grey_ink(x + dx, y + dy))
    });
    let ink = strength.data().iter().filter(|&&s| s > SURE_CHROMA).count();
    inner.count() as f64 >= LEAST_PIXELS.max(LEAST_SHARE * ink as f64)
}

struct Hues {
    red: Raster<f32>,
    green: Raster<f32>,
    strength: Raster<f32>,
}

impl Hues {
    /// Chroma, and the bin of the hue of ink that is not grey.
    fn hue(&self, x: usize, y: usize) -> (f32, Option<usize>) {
        let v = Vec2::new(f64::from(self.red[(x, y)]), f64::from(self.green[(x, y)]));
        let chroma = v.hypot() as f32;
        let colored = chroma > LEAST_CHROMA && chroma > LEAST_SATURATION * self.strength[(x, y)];
        let bin = || ((v.atan2() / TAU).rem_euclid(1.0) * BINS as f64) as usize % BINS;
        (chroma, colored.then(bin))
    }

    /// The hues of the page's inks, the most common first.
    fn peaks(&self) -> Vec<usize> {
        let (mut counts, mut ink) = ([0.0f64; BINS], 0.0);
        let (width, height) = self.strength.size();
        for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
            let (chroma, bin) = self.hue(x, y);
            ink += f64::from(u8::from(self.strength[(x, y)] > SURE_CHROMA));
            if let Some(bin) = bin.filter(|_| chroma > SURE_CHROMA) {
                counts[bin] += 1.0;
            }
        }
        let mut peaks = Vec::new();
        loop {
            let around = |b: usize, reach: usize| -> f64 {
                (0..=2 * reach).map(|k| counts[(b + BINS + k - reach) % BINS]).sum()
            };
            let top = (0..BINS).max_by(|&a, &b| around(a, 1).total_cmp(&around(b, 1)).then(b.cmp(&a))).unwrap_or(0);
            if around(top, SPREAD) < LEAST_PIXELS.max(LEAST_SHARE * ink) {
                return peaks;
            }
            peaks.push(top);
            (0..=2 * SPREAD).for_each(|k| counts[(top + BINS + k - SPREAD) % BINS] = 0.0);
        }
    }

    /// The group of a pixel: the nearest of the hues, or 0 for grey.
    fn group(&self, x: usize, y: usize, peaks: &[usize]) -> u8 {
        let Some(bin) = self.hue(x, y).1 else { return 0 };
        let apart = |p: usize| {
            let d = p.abs_diff(bin);
            d.min(BINS - d)
        };
        let nearest = (0..peaks.len()).min_by_key(|&i| apart(peaks[i]));
        nearest.map_or(0, |i| i as u8 + 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgb;

    /// Vertical bars, six pixels wide with one grey edge pixel to each side, on paper of a colour.
    fn bars(inks: &[[f32; 3]], paper: [f32; 3]) -> RgbImage {
        RgbImage::from_fn(40 * inks.len() as u32, 60, |x, _| {
            let (bar, at) = ((x / 40) as usize, x % 40);
            let coverage = match at {
                16..22 => 1.0,
                15 | 22 => 0.4,
                _ => 0.0,
            };
            Rgb([0, 1, 2].map(|c| (255.0 * paper[c] * (1.0 - coverage * (1.0 - inks[bar][c]))).round() as u8))
        })
    }

    #[test]
    fn each_hue_is_a_group_and_grey_is_none() {
        let inks = [[0.0; 3], [1.0, 0.0, 0.0], [0.1, 0.2, 0.9], [1.0, 0.95, 0.1], [0.7, 0.8, 1.0], [0.5; 3]];
        for paper in [[1.0; 3], [0.96, 0.93, 0.85]] {
            let page = separate(&bars(&inks, paper), false).unwrap();
            // Both blues are one group; their strengths are told apart on the way.
            assert_eq!(page.groups, 4);
            let group = |bar: usize, x: usize| page.group[(40 * bar + x, 30)];
            assert_eq!((group(0, 18), group(5, 18), group(2, 18)), (0, 0, group(4, 18)));
            for (bar, ink) in inks.into_iter().enumerate() {
                assert!([15, 16, 18, 22].iter().all(|&x| group(bar, x) == group(bar, 18)), "bar {bar}");
                let strength = page.strength[(40 * bar + 18, 30)];
                let ink = 1.0 - ink.into_iter().fold(1.0, f32::min);
                assert!((strength - ink).abs() < 0.02, "bar {bar}: {strength}");
            }
        }
    }

    #[test]
    fn a_tinted_page_of_grey_ink_is_not_in_colour() {
        for paper in [[1.0, 0.97, 0.88], [0.8, 0.85, 0.9]] {
            assert!(separate(&bars(&[[0.1; 3], [0.5, 0.48, 0.47]], paper), false).is_none());
        }
    }
}
