//! How much the optics of a scan have blurred its lines, and the width that a line had before.
//!
//! A line of width `w` under a Gaussian blur of deviation `s` has the profile
//! `P(x) = (erf((x + w/2) / (s sqrt 2)) - erf((x - w/2) / (s sqrt 2))) / 2`; its width at half of its peak is more
//! than `w` when `w` is not large against `s`.

use super::width::{narrowest_direction, ridge_pixels};
use crate::profile::cross_profile;
use crate::raster::{Mask, Raster};
use kurbo::{Point, Vec2};
use std::f64::consts::SQRT_2;

/// At most about this many profiles are averaged.
const SAMPLES: usize = 1500;
/// Half the number of samples of a mean profile; they reach to one and a half line widths.
const HALF: usize = 24;
/// Below this share of the peak, a profile tells more of the paper than of the line.
const FOOT: f64 = 0.15;
/// Deviations that are tried, in pixels.
const LEAST: f64 = 0.3;
const MOST: f64 = 2.5;
const STEP: f64 = 0.05;
/// How much a square pixel off the expected deviation weighs against the squares of the shape's errors: thin lines have much
/// the same shape under any blur.
const LIKELY: f64 = 0.1;
/// Of the width that a line measures, the least that it is taken to have had: below, hardly any blur is enough of one.
const NARROWEST: f64 = 0.5;

/// The standard deviation of the blur, in pixels; 0 where there are too few lines to tell.
///
/// The mean profile of lines of typical width is compared with [`profile_at`]: for each deviation, the width is
/// the one that gives the measured half-peak width, and the best shape wins; the further from what the steepness of the edges
/// lets expect, the better it has to be.
pub(super) fn estimate(ink: &Raster<f32>, mask: &Mask, depth: &Raster<f32>, line_width: f64, expected: f64) -> f64 {
    let Some(mut mean) = mean_profile(ink, mask, depth, line_width) else { return 0.0 };
    // Grain darkens the paper a little on average.
    let paper = mean.iter().copied().fold(f64::MAX, f64::min);
    mean.iter_mut().for_each(|m| *m -= paper);
    let peak = mean[0].max(1e-9);
    let half = mean.windows(2).position(|w| w[1] < 0.5 * peak);
    let Some(k) = half else { return 0.0 };
    let spacing = spacing(line_width);
    let measured = 2.0 * spacing * (k as f64 + (mean[k] - 0.5 * peak) / (mean[k] - mean[k + 1]));
    let misfit = |blur: f64| -> f64 {
        let width = unblurred_width(measured, blur);
        let top = profile_at(0.0, width, blur);
        let off = |(i, m): (usize, &f64)| (m / peak - profile_at(i as f64 * spacing, width, blur) / top).powi(2);
        let shape: f64 = mean.iter().enumerate().filter(|(_, m)| **m > FOOT * peak).map(off).sum();
        shape + LIKELY * (blur - expected).powi(2)
    };
    let count = ((MOST - LEAST) / STEP) as usize;
    let tried = (0..=count).map(|i| LEAST + STEP * i as f64).filter(|&s| s < 0.55 * measured);
    tried.min_by(|&a, &b| misfit(a).total_cmp(&misfit(b))).unwrap_or(0.0)
}

fn spacing(line_width: f64) -> f64 {
    1.5 * line_width / HALF as f64
}

/// Mean ink at distances `0, spacing, ..` from the middle of lines of typical width, both sides together.
fn mean_profile(ink: &Raster<f32>, mask: &Mask, depth: &Raster<f32>, line_width: f64) -> Option<Vec<f64>> {
    let ridge = ridge_pixels(mask, depth);
    let mut sum = vec![0.0; HALF + 1];
    let mut count = 0;
    for &(x, y) in ridge.iter().step_by((ridge.len() / SAMPLES).max(1)) {
        let p = Point::new(x as f64 + 0.5, y as f64 + 0.5);
        let Some((normal, width)) = narrowest_direction(ink, p, depth[(x, y)]) else { continue };
        if (width - line_width).abs() > 0.25 * line_width {
            continue;
        }
        let Some(middle) = cross_profile(ink, p, normal, 1.5 * line_width).and_then(|c| c.middle()) else { continue };
        add(&mut sum, ink, p + normal * middle, normal, line_width);
        count += 1;
    }
    (count >= 20).then_some(sum)
}

fn add(sum: &mut [f64], ink: &Raster<f32>, centre: Point, normal: Vec2, line_width: f64) {
    for (i, s) in sum.iter_mut().enumerate() {
        let offset = normal * (i as f64 * spacing(line_width));
        *s += f64::from(ink.sample(centre + offset) + ink.sample(centre - offset));
    }
}

/// Ink of a blurred line of unit darkness at a distance from its middle.
pub(crate) fn profile_at(x: f64, width: f64, blur: f64) -> f64 {
    let edge = |d: f64| libm::erf(d / (blur * SQRT_2));
    0.5 * (edge(x + 0.5 * width) - edge(x - 0.5 * width))
}

/// The width of a line that measures `measured` pixels at half of its peak under a blur. By bisection: the
/// measured width grows with the true one.
pub(crate) fn unblurred_width(measured: f64, blur: f64) -> f64 {
    if blur <= 0.0 {
        return measured;
    }
    let half = 0.5 * measured;
    // Too wide a line still has more than half of its peak at half the measured width.
    let too_wide = |width: f64| profile_at(half, width, blur) > 0.5 * profile_at(0.0, width, blur);
    let (mut low, mut high) = (NARROWEST * measured, measured);
    for _ in 0..30 {
        let middle = 0.5 * (low + high);
        if too_wide(middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::super::width::Ridge;
    use super::*;

    #[test]
    fn a_blurred_line_gives_its_width_back() {
        for (width, blur) in [(3.0, 0.8), (3.0, 1.2), (5.0, 1.5), (2.5, 1.0), (8.0, 1.0)] {
            // The half-peak width by bisection on the profile itself.
            let peak = profile_at(0.0, width, blur);
            let (mut low, mut high) = (0.0, 4.0 * width);
            for _ in 0..60 {
                let x = 0.5 * (low + high);
                if profile_at(x, width, blur) > 0.5 * peak { low = x } else { high = x }
            }
            assert!((unblurred_width(2.0 * low, blur) - width).abs() < 0.01, "{width} {blur}");
        }
    }

    #[test]
    fn the_blur_is_read_off_the_lines_near_what_is_expected() {
        for (width, blur) in [(3.0, 1.2), (4.0, 1.0), (6.0, 1.6)] {
            let tilt = Vec2::from_angle(0.3);
            let ink = Raster::from_fn(120, 120, |x, y| {
                let d = (Point::new(x as f64 + 0.5, y as f64 + 0.5) - Point::new(60.0, 60.0)).dot(tilt);
                profile_at(d, width, blur) as f32
            });
            let mask = ink.map(|i| i > 0.5 * profile_at(0.0, width, blur) as f32);
            let depth = super::super::distance::distance(&mask);
            let measured = Ridge::of(&ink, &mask, &depth).line_width();
            for share in [0.85, 1.0, 1.15] {
                let found = estimate(&ink, &mask, &depth, measured, share * blur);
                let restored = unblurred_width(measured, found);
                let name = format!("{width} {blur} {share}: {found} {restored}");
                assert!((found - blur).abs() <= (share - 1.0).abs() * blur + 1.5 * STEP, "{name}");
                assert!((restored - width).abs() < if share == 1.0 { 0.25 } else { 0.4 }, "{name}");
            }
        }
    }
}
