//! A page before its ink is told from paper, and after.

use super::colors::{ColorPage, separate};
use super::line_image::Decisions;
use super::noise::NoiseMap;
use super::paper;
use super::smooth;
use super::threshold::{Paper, Told, binarise};
use crate::load::Scan;
use crate::options::{Invert, Threshold};
use crate::raster::Raster;
use rayon::prelude::*;
use std::borrow::Cow;

/// A page whose lightest and darkest pixels are nearer than this is blank.
const LEAST_CONTRAST: f32 = 0.02;
/// Deviation of the blur that joins the grain of a pencil line, in pixels of the scan: half of a pixel's own footprint.
pub(crate) const JOINING: f64 = 0.7;

/// A page, dark on light.
pub(super) struct Page {
    /// Whether it was light on dark.
    inverted: bool,
    /// What is to be seen of its paper, and of that of its scan, from which all but the ink may have been taken.
    paper: Paper,
    pub scanned: Paper,
    /// Its ink, grey, as the share of light that is lost.
    ink: Raster<f32>,
    /// Its inks, where they have hues of their own.
    inks: Option<ColorPage>,
}

impl Page {
    /// The page that was scanned.
    pub fn of(scan: &Scan, invert: Invert) -> Self {
        let inverted = match invert {
            Invert::Yes => true,
            Invert::No => false,
            Invert::Auto => is_light_on_dark(&scan.gray),
        };
        let ink = ink_of_gray(&scan.gray, inverted);
        let inks = scan.rgb.as_ref().and_then(|rgb| separate(rgb, &ink, inverted));
        let paper = Paper::of(inks.as_ref().map_or(&ink, |inks| &inks.strength));
        Self { inverted, paper, scanned: paper, ink, inks }
    }

    /// The page that was scanned, from whose scan all but the ink has been taken.
    pub fn of_drawn(drawn: &Scan, as_it_was: &Scan, invert: Invert) -> Self {
        let page = Self::of(drawn, invert);
        let scanned = Paper::of(&ink_of_gray(&as_it_was.gray, page.inverted));
        Self { scanned: Paper { shades: page.paper.shades, ..scanned }, ..page }
    }

    /// The ink, scaled, and its mask, where it can be trusted so far.
    pub fn inked(&self, noise: &NoiseMap, threshold: Threshold) -> Told {
        match &self.inks {
            Some(inks) => inks_of_groups(inks, self.paper, noise, threshold),
            None => binarise(&joined(&self.ink, noise), self.paper, noise, threshold, false),
        }
    }

    /// What was decided about it, and the darkness from which a pixel is ink.
    pub fn decisions(&self, threshold: Option<f64>) -> Decisions {
        let hues = self.inks.as_ref().map_or(0, |inks| usize::from(inks.groups) - 1);
        Decisions { inverted: self.inverted, grain: self.scanned.grain, threshold, hues }
    }

    /// The colour of each pixel with the paper's own taken off.
    pub fn colors(self) -> Raster<[u8; 3]> {
        let shade = |ink: f32| [(255.0 * (1.0 - ink)).round() as u8; 3];
        self.inks.map_or_else(|| self.ink.mapped([255; 3], shade), |inks| inks.colors)
    }
}

/// Ink by the light that the paper's level has lost.
fn ink_of_gray(gray: &Raster<f32>, inverted: bool) -> Raster<f32> {
    if !has_contrast(gray) {
        return Raster::filled(gray.width(), gray.height(), 0.0);
    }
    let light = if inverted { Cow::Owned(gray.mapped(0.0, |g| 1.0 - g)) } else { Cow::Borrowed(gray) };
    paper::divide(&light, &paper::paper_level(&light))
}

/// Smooths where ink is unsure, just enough to join the grain of a pencil line.
fn joined<'a>(ink: &'a Raster<f32>, noise: &NoiseMap) -> Cow<'a, Raster<f32>> {
    let [least, most] = noise.grains();
    if most == 0.0 {
        return Cow::Borrowed(ink);
    }
    let smoothed = smooth(ink.clone(), JOINING as f32);
    if least == 1.0 {
        return Cow::Owned(smoothed);
    }
    Cow::Owned(Raster::from_rows(ink.width(), ink.height(), 0.0, |y, row| {
        for (x, to) in row.iter_mut().enumerate() {
            let share = noise.at_pixel(x, y).grain() as f32;
            *to = ink[(x, y)] + share * (smoothed[(x, y)] - ink[(x, y)]);
        }
    }))
}

/// Each group of inks scaled and told from paper by itself, and all laid over one another.
fn inks_of_groups(page: &ColorPage, paper: Paper, noise: &NoiseMap, threshold: Threshold) -> Told {
    let (width, height) = page.strength.size();
    let (mut ink, mut mask) = (Raster::filled(width, height, 0.0), Raster::filled(width, height, false));
    for group in 0..page.groups {
        let own = Raster::from_rows(width, height, 0.0, |y, row| {
            for ((own, &of), &strength) in row.iter_mut().zip(page.group.row(y)).zip(page.strength.row(y)) {
                *own = if of == group { strength } else { 0.0 };
            }
        });
        if group == 0 && !page.has_grey {
            // Grain, and where two colours mix.
            ink = own;
            continue;
        }
        let own = binarise(&joined(&own, noise), paper, noise, threshold, group > 0);
        // What smoothing took from one ink where it meets another, it put into the other.
        ink.data_mut().iter_mut().zip(own.ink.data()).for_each(|(i, &o)| *i += o);
        mask.data_mut().iter_mut().zip(own.mask.data()).for_each(|(m, &o)| *m |= o);
    }
    let seams = page.seams(&ink);
    for ((x, y), full) in seams {
        ink[(x, y)] = full;
    }
    mask.data_mut().iter_mut().zip(ink.data()).for_each(|(m, &i)| *m |= i > 0.5);
    Told { ink, mask, threshold: None }
}

/// Whether there is anything on the page: a scan of one tone has no ink, whatever the tone.
fn has_contrast(gray: &Raster<f32>) -> bool {
    let low = gray.data().par_iter().copied().reduce(|| f32::MAX, f32::min);
    let high = gray.data().par_iter().copied().reduce(|| f32::MIN, f32::max);
    high - low > LEAST_CONTRAST
}

/// Lines cover little, so the more common side of the middle of the tonal range is the paper.
fn is_light_on_dark(gray: &Raster<f32>) -> bool {
    let mut values: Vec<f32> = gray.data().iter().step_by((gray.data().len() / 20_000).max(1)).copied().collect();
    if values.is_empty() {
        return false;
    }
    values.sort_by(f32::total_cmp);
    let at = |q: f64| values[((values.len() - 1) as f64 * q) as usize];
    let (low, middle, high) = (at(0.002), at(0.5), at(0.998));
    // A photographed page may be dim; only a page near the dark end of its own range, and dark, is inverted.
    middle < 0.5 && middle - low < 0.4 * (high - low)
}
