//! Paper between lines that run side by side.
//!
//! Where less than two pixels of paper lie between two lines, blur or the pixels' own size leaves a shallow valley of grey
//! there, and at half of full ink both lines are one. Along the valley its depth is certain nevertheless: the mean
//! profile over a few line widths has two ridges, each as wide as a line. The ink between them is stretched until the
//! bottom is paper.

use super::noise::NoiseMap;
use super::threshold::level;
use crate::raster::{Mask, Raster};
use kurbo::{Point, Vec2};
use rayon::prelude::*;
use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// Directions tried across a valley.
const DIRECTIONS: usize = 16;
/// How far along a valley its profile is averaged, to either side, in line widths; and the least of it in pixels.
const ALONG: f64 = 1.5;
const LEAST_ALONG: f64 = 4.0;
/// Distance between samples along and across, in pixels.
const STEP: f64 = 1.0;
const FINE: f64 = 0.5;
/// How far from the bottom of its valley a pixel lies at most, in line widths.
const SLOPE: f64 = 0.25;
/// Distance of a ridge from the valley's bottom: at least, in line widths; at most, in line widths and in pixels of paper.
const NEAREST: f64 = 0.25;
const FARTHEST: f64 = 0.75;
const PAPER: f64 = 0.75;
/// Where ridges are first looked for, in line widths.
const BESIDE: [f64; 3] = [0.35, 0.6, 0.85];
/// Ink on both ridges, at least.
const RIDGE: f32 = 0.6;
/// How much less than on the lower ridge, as a share of it, there is at the bottom, at least.
const SHALLOWEST: f32 = 0.14;
/// Depth before a point as a share of the depth behind it, or the other way round, at least: lines side by side.
const EVEN: f32 = 0.75;
/// How far the ink at a point may be above the mean along the valley, as a share of the way up to the ridge: above that,
/// a line crosses.
const CROSSED: f32 = 0.5;
/// A bottom with less than this share of the ridge's ink is paper already.
const DEEP: f32 = 0.25;
/// Share of the ridge's ink that a stretched bottom keeps.
const BOTTOM: f32 = 0.15;

/// Where a pixel lies in the profile of a valley.
struct Valley {
    /// Ink of the lower ridge.
    ridge: f32,
    /// Ink at the bottom.
    bottom: f32,
    /// Ink at the pixel.
    here: f32,
}

/// Takes the ink out of valleys; where less than the mask's level is left, it counts as paper. Whether there were any.
pub(super) fn deepen(ink: &mut Raster<f32>, mask: &mut Mask, line_width: f64, noise: &NoiseMap) -> bool {
    let between = deepened(ink, line_width);
    for &(x, y, left) in &between {
        ink[(x, y)] = left;
        mask[(x, y)] &= left > level(noise.at_pixel(x, y));
    }
    !between.is_empty()
}

/// The pixels in valleys, row by row, and the ink that is left in each.
fn deepened(ink: &Raster<f32>, line_width: f64) -> Vec<(usize, usize, f32)> {
    let of_row = |y: usize| {
        let candidates = (0..ink.width()).filter(move |&x| is_candidate(ink, x, y, line_width));
        candidates.filter_map(move |x| {
            let valley = deepest(ink, Point::new(x as f64 + 0.5, y as f64 + 0.5), line_width)?;
            Some((x, y, valley.stretched(ink[(x, y)])))
        })
    };
    (0..ink.height()).into_par_iter().flat_map_iter(of_row).collect()
}

/// Whether there is more ink on two opposite sides of a grey pixel: a cheap test before the careful one.
fn is_candidate(ink: &Raster<f32>, x: usize, y: usize, line_width: f64) -> bool {
    let here = ink[(x, y)];
    if !(DEEP * RIDGE..1.0 - 0.25 * SHALLOWEST).contains(&here) {
        return false;
    }
    let radius = (0.5 * line_width + 0.5).max(1.0);
    let at = |dx: f64, dy: f64| {
        let (dx, dy) = ((radius * dx).round() as i64, (radius * dy).round() as i64);
        ink.get(x as i64 + dx, y as i64 + dy).unwrap_or(0.0)
    };
    let diagonal = FRAC_1_SQRT_2;
    [(1.0, 0.0), (0.0, 1.0), (diagonal, diagonal), (diagonal, -diagonal)].into_iter().any(|(dx, dy)| {
        let sides = [at(dx, dy), at(-dx, -dy)];
        sides.iter().all(|&side| side > RIDGE) && sides[0] + sides[1] - 2.0 * here > SHALLOWEST * RIDGE
    })
}

/// The deepest valley in whose slopes a point lies.
///
/// It goes on to both sides of the point: between lines that part, or in the corner of two that meet, it does not.
fn deepest(ink: &Raster<f32>, p: Point, line_width: f64) -> Option<Valley> {
    let across = |k: usize| {
        let normal = Vec2::from_angle(PI * k as f64 / DIRECTIONS as f64);
        if !is_lower(ink, p, normal, line_width) {
            return None;
        }
        let half = |along: Vec2| valley(&mean_profile(ink, p, normal, along, line_width), line_width);
        let (a, b) = (half(normal.turn_90())?, half(-normal.turn_90())?);
        if a.depth().min(b.depth()) < EVEN * a.depth().max(b.depth()) {
            return None;
        }
        let mean = |of: fn(&Valley) -> f32| 0.5 * (of(&a) + of(&b));
        let found = Valley { ridge: mean(|v| v.ridge), bottom: mean(|v| v.bottom), here: mean(|v| v.here) };
        let along = normal.turn_90() * (0.5 * STEP);
        let here = (ink.sample(p - along) + ink.sample(p + along)) * 0.5;
        (here < CROSSED * found.ridge + (1.0 - CROSSED) * found.here).then_some(found)
    };
    (0..DIRECTIONS).filter_map(across).max_by(|a, b| a.depth().total_cmp(&b.depth()))
}

/// Whether there is more ink to both sides along the normal, and enough for ridges, as a few samples tell.
fn is_lower(ink: &Raster<f32>, p: Point, normal: Vec2, line_width: f64) -> bool {
    let along = normal.turn_90() * (0.5 * ALONG * line_width);
    let mean = |q: Point| (-1..=1).map(|k| ink.sample(q + along * f64::from(k))).sum::<f32>() / 3.0;
    let most = |side: f64| BESIDE.map(|at| mean(p + normal * (side * at * line_width))).into_iter().fold(0.0, f32::max);
    let ridge = most(1.0).min(most(-1.0));
    ridge > 0.8 * RIDGE && mean(p) < ridge
}

/// Mean ink on lines through a point, samples [`FINE`] apart along the normal, the point in the middle.
fn mean_profile(ink: &Raster<f32>, p: Point, normal: Vec2, along: Vec2, line_width: f64) -> Vec<f32> {
    let reach = (3.0 * (FARTHEST * line_width + PAPER) / FINE).ceil() as i32;
    let length = ((ALONG * line_width).max(LEAST_ALONG) / STEP).ceil() as i32;
    let mean = |k: i32| {
        let q = p + normal * (FINE * f64::from(k));
        let sum: f32 = (0..=length).map(|s| ink.sample(q + along * (STEP * f64::from(s)))).sum();
        sum / (length + 1) as f32
    };
    (-reach..=reach).map(mean).collect()
}

/// The valley in whose slopes the middle of a profile lies, if it has a line's ridge on either side.
fn valley(profile: &[f32], line_width: f64) -> Option<Valley> {
    let middle = profile.len() / 2;
    let slope = (SLOPE * line_width / FINE).ceil() as usize;
    let lowest = (middle - slope..=middle + slope).min_by(|&a, &b| profile[a].total_cmp(&profile[b]))?;
    let near = (NEAREST * line_width / FINE).floor().max(1.0) as usize;
    let far = ((FARTHEST * line_width + PAPER) / FINE).ceil() as usize;
    // Ink of the ridge on one side, and how far away it is.
    let ridge = |side: i64| {
        let at = |k: usize| profile[(lowest as i64 + side * k as i64) as usize];
        let top = (1..=far).max_by(|&a, &b| at(a).total_cmp(&at(b)).then(b.cmp(&a)))?;
        let ends = (top..=2 * top + 2).any(|k| at(k) < (1.0 - SHALLOWEST) * at(top));
        (top >= near && ends && at(top) > RIDGE).then_some((at(top), top))
    };
    let (left, right) = (ridge(-1)?, ridge(1)?);
    let found = Valley { ridge: left.0.min(right.0), bottom: profile[lowest], here: profile[middle] };
    let between = (lowest - left.1..=lowest + right.1).contains(&middle) && found.here < found.ridge;
    (between && found.bottom > DEEP * found.ridge && found.depth() > SHALLOWEST * found.ridge).then_some(found)
}

impl Valley {
    fn depth(&self) -> f32 {
        self.ridge - self.bottom
    }

    /// What is left of a pixel's ink once the bottom is paper.
    fn stretched(&self, ink: f32) -> f32 {
        let gain = (1.0 - BOTTOM) * self.ridge / self.depth() - 1.0;
        (ink - gain * (self.ridge - self.here)).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::super::blur::profile_at;
    use super::*;

    const MIDDLE: Point = Point::new(40.2, 39.9);

    /// Two blurred lines of a width, so many pixels of paper between them, through the middle of a page of 80 x 80.
    fn pair(width: f64, paper: f64, blur: f64, angle: f64) -> Raster<f32> {
        let normal = Vec2::from_angle(angle);
        Raster::from_fn(80, 80, |x, y| {
            let d = (Point::new(x as f64 + 0.5, y as f64 + 0.5) - MIDDLE).dot(normal);
            let apart = 0.5 * (width + paper);
            (profile_at(d - apart, width, blur) + profile_at(d + apart, width, blur)) as f32
        })
    }

    #[test]
    fn paper_between_two_lines_comes_out_wherever_it_lies() {
        for (width, paper, blur) in [(2.0, 1.2, 0.6), (3.0, 1.0, 0.5), (3.0, 1.8, 0.8), (5.0, 2.0, 1.0)] {
            for angle in (0..12).map(|k| f64::from(k) * 0.26) {
                let mut ink = pair(width, paper, blur, angle);
                for (x, y, left) in deepened(&ink, width) {
                    ink[(x, y)] = left;
                }
                let (normal, along) = (Vec2::from_angle(angle), Vec2::from_angle(angle).turn_90());
                for s in (-20..=20).map(f64::from) {
                    let p = MIDDLE + along * s;
                    let name = format!("{width} {paper} {blur} {angle:.2} at {s}");
                    assert!(ink.sample(p) < 0.5, "{name}: {}", ink.sample(p));
                    for side in [-1.0, 1.0] {
                        let line = ink.sample(p + normal * (side * 0.5 * (width + paper)));
                        assert!(line > 0.7, "{name}: {line}");
                    }
                }
            }
        }
    }

    #[test]
    fn one_line_is_left_alone_whatever_its_width() {
        for width in [1.5, 3.0, 4.0, 6.0, 9.0] {
            for angle in (0..12).map(|k| f64::from(k) * 0.26) {
                // Two halves of it that touch.
                let ink = pair(0.5 * width, 0.0, 0.8, angle);
                for line_width in [3.0, width] {
                    assert_eq!(deepened(&ink, line_width), [], "{width} {angle:.2} {line_width}");
                }
            }
        }
    }
}
