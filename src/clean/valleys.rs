//! Paper between lines that run side by side.
//!
//! Where less than two pixels of paper lie between two lines, blur or the pixels' own size leaves a shallow valley of grey
//! there, and at half of full ink both lines are one. Along the valley its depth is certain nevertheless: the mean
//! profile over a few line widths has two ridges, each as wide as a line. The ink between them is stretched until the
//! bottom is paper.

use super::noise::NoiseMap;
use super::threshold::level;
use crate::raster::{Mask, Raster, floor};
use kurbo::{Point, Vec2};
use rayon::prelude::*;
use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// The edges around a point have a common direction where this share of their gradients' squares agree on it, in so many
/// places to each side; empirical, guarded by the tests below.
const COHERENT: f64 = 0.6;
const EDGES: i64 = 4;
/// A valley is looked for in the nearest multiple of so many radians, and in so many to either side.
const TURN: f64 = PI / 16.0;
const TURNS: i32 = 2;
/// How far along a valley its profile is averaged, to either side, in line widths; and the least of it in pixels.
const ALONG: f64 = 1.5;
const LEAST_ALONG: f64 = 4.0;
/// Distance between samples along and across, in pixels.
const STEP: f64 = 1.0;
const FINE: f64 = 0.5;
/// So many samples along, and across a line's width, are enough: those of wider lines lie further apart, so that no pixel
/// costs more than at a width of 5 and 14 pixels.
const MOST_ALONG: f64 = 8.0;
const FINEST: f64 = 28.0;
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
    let straight_across = (normal(ink, p, line_width)?.atan2() / TURN).round();
    let across = |turn: i32| {
        let normal = Vec2::from_angle(TURN * (straight_across + f64::from(turn)));
        if !is_lower(ink, p, normal, line_width) {
            return None;
        }
        let half = |along: Vec2| valley(|s| mean_along(ink, p + normal * s, along, line_width), line_width);
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
    (-TURNS..=TURNS).filter_map(across).max_by(|a, b| a.depth().total_cmp(&b.depth()))
}

/// The direction across the edges around a point, by the structure tensor of the ink within a line width; `None` where they
/// have no common direction, as in texture, of which a page can be full.
fn normal(ink: &Raster<f32>, p: Point, line_width: f64) -> Option<Vec2> {
    let spacing = (line_width / EDGES as f64).max(1.0);
    let (x, y) = (floor(p.x), floor(p.y));
    // Twice the angle of a gradient, weighted by its square, and the sum of the weights.
    let (mut double, mut whole) = (Vec2::ZERO, 0.0);
    for (i, j) in (-EDGES..=EDGES).flat_map(|j| (-EDGES..=EDGES).map(move |i| (i, j))) {
        if i * i + j * j <= EDGES * EDGES {
            let place = |k: i64| (spacing * k as f64).round() as i64;
            let g = gradient(ink, x + place(i), y + place(j));
            double += Vec2::new(g.x * g.x - g.y * g.y, 2.0 * g.x * g.y);
            whole += g.hypot2();
        }
    }
    (double.hypot() > COHERENT * whole).then(|| Vec2::from_angle(0.5 * double.atan2()))
}

/// Sobel's.
fn gradient(ink: &Raster<f32>, x: i64, y: i64) -> Vec2 {
    let at = |dx: i64, dy: i64| ink.get(x + dx, y + dy).unwrap_or(0.0);
    let (falling, rising) = (at(1, 1) - at(-1, -1), at(1, -1) - at(-1, 1));
    let (gx, gy) = (2.0 * (at(1, 0) - at(-1, 0)), 2.0 * (at(0, 1) - at(0, -1)));
    Vec2::new(f64::from(gx + falling + rising), f64::from(gy + falling - rising))
}

/// Whether there is more ink to both sides along the normal, and enough for ridges, as a few samples tell.
fn is_lower(ink: &Raster<f32>, p: Point, normal: Vec2, line_width: f64) -> bool {
    let along = normal.turn_90() * (0.5 * ALONG * line_width);
    let mean = |q: Point| (-1..=1).map(|k| ink.sample(q + along * f64::from(k))).sum::<f32>() / 3.0;
    let most = |side: f64| BESIDE.map(|at| mean(p + normal * (side * at * line_width))).into_iter().fold(0.0, f32::max);
    let ridge = most(1.0).min(most(-1.0));
    ridge > 0.8 * RIDGE && mean(p) < ridge
}

/// Mean ink from a point on along a valley.
fn mean_along(ink: &Raster<f32>, p: Point, along: Vec2, line_width: f64) -> f32 {
    let length = ((ALONG * line_width).max(LEAST_ALONG) / STEP).ceil();
    let count = length.min(MOST_ALONG);
    let step = along * (STEP * length / count);
    let sum: f32 = (0..=count as i32).map(|s| ink.sample(p + step * f64::from(s))).sum();
    sum / (count as f32 + 1.0)
}

/// The valley in whose slopes the middle of a profile lies, if it has a line's ridge on either side; the profile is a
/// function of the distance from there in pixels.
fn valley(profile: impl Fn(f64) -> f32, line_width: f64) -> Option<Valley> {
    let spacing = FINE.max(line_width / FINEST);
    let at = |k: i32| (k, profile(spacing * f64::from(k)));
    let slope = (SLOPE * line_width / spacing).ceil() as i32;
    let (lowest, bottom) = (-slope..=slope).map(at).min_by(|a, b| a.1.total_cmp(&b.1))?;
    let near = (NEAREST * line_width / spacing).floor().max(1.0) as i32;
    let far = ((FARTHEST * line_width + PAPER) / spacing).ceil() as i32;
    // Ink of the ridge on one side, and how far away it is.
    let ridge = |side: i32| {
        let at = |k: i32| (k, at(lowest + side * k).1);
        let (top, ridge) = (1..=far).map(at).max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0)))?;
        let is_ridge = top >= near && ridge > RIDGE && bottom < (1.0 - SHALLOWEST) * ridge;
        let ends = || (top..=2 * top + 2).any(|k| at(k).1 < (1.0 - SHALLOWEST) * ridge);
        (is_ridge && ends()).then_some((ridge, top))
    };
    let (left, right) = (ridge(-1)?, ridge(1)?);
    let found = Valley { ridge: left.0.min(right.0), bottom, here: at(0).1 };
    let between = (lowest - left.1..=lowest + right.1).contains(&0) && found.here < found.ridge;
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
    use super::super::smooth;
    use super::*;
    use std::cell::Cell;

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

    #[test]
    fn a_profile_has_as_many_samples_for_the_widest_line_as_for_a_middling_one() {
        let samples = |width: f64| {
            let count = Cell::new(0);
            // Two ridges that do not end: every sample that may be needed is.
            let profile = |s: f64| {
                count.set(count.get() + 1);
                if s.abs() < 0.25 * width { 0.5 } else { 1.0 }
            };
            assert!(valley(profile, width).is_none());
            count.get()
        };
        let most = [5.0, 14.0].map(samples).into_iter().max();
        assert!([20.0, 60.0, 250.0, 4000.0].into_iter().all(|width| Some(samples(width)) <= most));
    }

    #[test]
    fn texture_has_no_direction_in_which_valleys_could_run() {
        for size in [1.5f32, 2.5, 4.0] {
            // A linear congruential generator, its upper bits.
            let mut dice = 1u32;
            let grain = Raster::from_fn(120, 120, |_, _| {
                dice = dice.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                (dice >> 8) as f32 / f32::from(1u16 << 15) / 256.0 - 1.0
            });
            let ink = smooth(grain, size).map(|i| (0.5 + size * i).clamp(0.0, 1.0));
            let places = (20..100).flat_map(|y| (20..100).map(move |x| (x, y)));
            let candidates: Vec<_> = places.filter(|&(x, y)| is_candidate(&ink, x, y, 2.0 * f64::from(size))).collect();
            let middle = |&(x, y): &(usize, usize)| Point::new(x as f64 + 0.5, y as f64 + 0.5);
            let looked_at =
                candidates.iter().filter(|p| normal(&ink, middle(p), 2.0 * f64::from(size)).is_some()).count();
            assert!(
                candidates.len() > 200 && 4 * looked_at < candidates.len(),
                "{size}: {looked_at} of {}",
                candidates.len()
            );
        }
    }
}
