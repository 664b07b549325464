//! Inks told apart by their colour.
//!
//! Of the light of a channel, paper keeps its level and ink takes a share: the absorbance, which grows evenly with how
//! much of the pixel is inked. Its largest channel is how strong the ink is, whatever its colour: yellow ink takes all
//! of the blue. So inks are grouped by hue, black and grey being one group, and each group is measured against its own
//! full strength: a light blue line is as much ink as a black one beside it.
//!
//! A pixel's hue need not be its ink's: sub-pixel rendering, channels that are out of register, a lens and the coarse
//! chroma of JPEG give grey lines flanks of opposite hues, and coloured ones pale middles and a halo. All of them move ink
//! across the line and take none away. So hues are measured by the sum of the ink across a line ([`across`]), and what
//! lies beside the middle of a line has the hue of that middle.

use super::across::{Cores, is_known};
use super::paper;
use crate::raster::Raster;
use image::RgbImage;
use kurbo::Vec2;
use std::f64::consts::TAU;

/// Ink of less saturation than this, as the share of its strength by which channels differ, is grey.
const LEAST_SATURATION: f64 = 0.3;
/// Ink of less strength than this, as a share of full ink, tells nothing of its hue.
const LEAST_INK: f32 = 0.12;
/// Channels of ink that differ by less than this, as a share of full ink, do not tell that it has a hue of its own.
const LEAST_CHROMA: f64 = 0.15;
/// Hues are counted in steps of 5 degrees, and those within 25 degrees of a peak are one ink.
const BINS: usize = 72;
const SPREAD: usize = 5;
/// A hue is an ink's when it has this many pixels, and this share of all ink.
const LEAST_PIXELS: f64 = 30.0;
const LEAST_SHARE: f64 = 0.005;
/// Ink of less than this share of the strongest ink's strength is printed on the paper, such as its squares.
const FAINTEST: f32 = 0.33;

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
            let inked = near(x, y, 3).filter(|&(i, j)| ink.get(i, j).is_some_and(|v| v > 0.6));
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

/// Tells inks apart; `None` where all ink is grey. `grey` is the ink as it is without colour. On a dark ground light is
/// ink.
pub(super) fn separate(rgb: &RgbImage, grey: &Raster<f32>, dark_ground: bool) -> Option<ColorPage> {
    let absorbance = absorbance(rgb, dark_ground);
    let mut cores = Cores::of(&absorbance, LEAST_INK);
    let (width, height) = grey.size();
    let at = |x: usize, y: usize| [0, 1, 2].map(|c| absorbance[c][(x, y)]);
    let hues = Hues::of(&cores, |x, y| at(x, y).into_iter().fold(0.0, f32::max));
    if hues.peaks.is_empty() {
        return None;
    }
    cores.spread();
    let group = cores.tone.mapped(0, |tone| hues.group(tone));
    let strength = Raster::from_rows(width, height, 0.0, |y, row| {
        row.iter_mut().enumerate().for_each(|(x, strength)| {
            *strength = if group[(x, y)] == 0 { grey[(x, y)] } else { amount(at(x, y), cores.tone[(x, y)]) };
        });
    });
    let byte = |share: f32| (255.0 * share).round() as u8;
    let colors = Raster::from_rows(width, height, [255; 3], |y, row| {
        row.iter_mut().enumerate().for_each(|(x, color)| {
            let (strength, tone) = (strength[(x, y)], cores.tone[(x, y)]);
            *color = match (group[(x, y)], dark_ground) {
                (0, _) => [byte(1.0 - strength); 3],
                (_, true) => tone.map(|channel| byte(strength * channel)),
                (_, false) => tone.map(|channel| byte(1.0 - strength * channel)),
            };
        });
    });
    Some(ColorPage { strength, colors, group, groups: hues.groups() as u8, has_grey: hues.has_grey })
}

/// How much ink of a tone makes an absorbance: the least squares.
fn amount(absorbance: [f32; 3], tone: [f32; 3]) -> f32 {
    let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    (dot(absorbance, tone) / dot(tone, tone)).clamp(0.0, 1.0)
}

/// The light that the paper's level has lost, of each channel.
fn absorbance(rgb: &RgbImage, dark_ground: bool) -> [Raster<f32>; 3] {
    let light = [0, 1, 2].map(|channel| {
        Raster::from_rows(rgb.width() as usize, rgb.height() as usize, 0.0, |y, row| {
            row.iter_mut().enumerate().for_each(|(x, light)| {
                let value = f32::from(rgb.get_pixel(x as u32, y as u32)[channel]) / 255.0;
                *light = if dark_ground { 1.0 - value } else { value };
            });
        })
    });
    let [r, g, b] = paper::paper_levels(light.each_ref());
    let mut papers = [r, g, b].into_iter();
    light.map(|light| paper::divide(&light, &papers.next().expect("one for each channel")))
}

/// A tone seen along the grey axis of the space of colours: opponents of red, and of green against blue.
fn opponents(tone: [f32; 3]) -> Vec2 {
    let [r, g, b] = tone.map(f64::from);
    Vec2::new(r - 0.5 * (g + b), 0.75f64.sqrt() * (g - b))
}

/// The bin of the hue of ink of a tone; `None` where it is grey.
fn hue(tone: [f32; 3]) -> Option<usize> {
    let v = opponents(tone);
    (v.hypot() > LEAST_SATURATION).then(|| ((v.atan2() / TAU).rem_euclid(1.0) * BINS as f64) as usize % BINS)
}

/// The hues of a page's inks.
struct Hues {
    /// The most common first, and the group of each: 0 where the ink is too faint to be drawn with.
    peaks: Vec<(usize, u8)>,
    /// Whether there is black or grey ink.
    has_grey: bool,
}

impl Hues {
    /// Counts the tones of the middles of lines of some strength.
    fn of(cores: &Cores, strength: impl Fn(usize, usize) -> f32) -> Self {
        let (mut of_bins, mut grey, mut ink) = (vec![Vec::new(); BINS], Vec::new(), 0);
        for y in 0..cores.tone.height() {
            for (x, &tone) in cores.tone.row(y).iter().enumerate().filter(|(_, tone)| is_known(**tone)) {
                let strength = strength(x, y);
                ink += 1;
                let Some(bin) = hue(tone) else {
                    grey.push(strength);
                    continue;
                };
                let saturation = opponents(cores.around(x, y)).hypot();
                if saturation > LEAST_SATURATION && saturation * f64::from(strength) > LEAST_CHROMA {
                    of_bins[bin].push(strength);
                }
            }
        }
        let least = LEAST_PIXELS.max(LEAST_SHARE * f64::from(ink)) as usize;
        let has_grey = grey.len() >= least;
        let mut found: Vec<(usize, f32)> = Vec::new();
        loop {
            let around = |b: usize, reach: usize| (0..=2 * reach).map(move |k| (b + BINS + k - reach) % BINS);
            let count = |b: usize, reach: usize| around(b, reach).map(|k| of_bins[k].len()).sum::<usize>();
            let top = (0..BINS).max_by_key(|&b| (count(b, 1), BINS - b)).unwrap_or(0);
            if count(top, SPREAD) < least {
                break;
            }
            let own: Vec<f32> = around(top, SPREAD).flat_map(|k| std::mem::take(&mut of_bins[k])).collect();
            found.push((top, full(own)));
        }
        let strongest = found.iter().map(|f| f.1).fold(if has_grey { full(grey) } else { 0.0 }, f32::max);
        let mut groups = 0;
        let group = |(top, strength): (usize, f32)| {
            let is_pen = strength >= FAINTEST * strongest;
            groups += u8::from(is_pen);
            (top, if is_pen { groups } else { 0 })
        };
        let peaks: Vec<(usize, u8)> = found.into_iter().map(group).collect();
        let any = peaks.iter().any(|peak| peak.1 > 0);
        Self { peaks: if any { peaks } else { Vec::new() }, has_grey }
    }

    /// The group of ink of a tone: that of the nearest of the hues, or 0 for grey.
    fn group(&self, tone: [f32; 3]) -> u8 {
        let Some(bin) = hue(tone) else { return 0 };
        let apart = |peak: usize| peak.abs_diff(bin).min(BINS - peak.abs_diff(bin));
        self.peaks.iter().min_by_key(|peak| apart(peak.0)).map_or(0, |peak| peak.1)
    }

    /// The number of groups, grey included.
    fn groups(&self) -> usize {
        1 + self.peaks.iter().filter(|peak| peak.1 > 0).count()
    }
}

/// The strength of an ink where no blur thins it: an upper quantile.
fn full(mut values: Vec<f32>) -> f32 {
    let k = values.len() * 9 / 10;
    if values.is_empty() { 0.0 } else { *values.select_nth_unstable_by(k, f32::total_cmp).1 }
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

    fn separated(rgb: &RgbImage) -> Option<ColorPage> {
        let light = Raster::from_fn(rgb.width() as usize, rgb.height() as usize, |x, y| {
            rgb.get_pixel(x as u32, y as u32).0.map(f32::from).iter().sum::<f32>() / 765.0
        });
        separate(rgb, &paper::divide(&light, &paper::paper_level(&light)), false)
    }

    #[test]
    fn each_hue_is_a_group_and_grey_is_none() {
        let inks = [[0.0; 3], [1.0, 0.0, 0.0], [0.1, 0.2, 0.9], [1.0, 0.95, 0.1], [0.7, 0.8, 1.0], [0.5; 3]];
        for paper in [[1.0; 3], [0.96, 0.93, 0.85]] {
            let page = separated(&bars(&inks, paper)).unwrap();
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
            assert!(separated(&bars(&[[0.1; 3], [0.5, 0.48, 0.47]], paper)).is_none());
        }
    }
}
