//! Short names for what is drawn at random.

use super::super::noise::{gaussian, smooth};
use super::super::shapes::within;
use super::canvas::Rgb;
use crate::raster::Raster;
use kurbo::Point;
use rand::Rng;

/// A number of a range, as `f32`.
pub(super) fn amount(rng: &mut impl Rng, (low, high): (f64, f64)) -> f32 {
    within(rng, low, high) as f32
}

/// A number of a range of positive ones, small ones as often as large ones.
pub(super) fn spread(rng: &mut impl Rng, low: f64, high: f64) -> f64 {
    within(rng, low.ln(), high.ln()).exp()
}

/// One of some things; there is at least one.
pub(super) fn pick<'a, T>(rng: &mut impl Rng, all: &'a [T]) -> &'a T {
    &all[rng.random_range(0..all.len())]
}

/// A colour near another.
pub(super) fn near(rng: &mut impl Rng, color: Rgb, deviation: f64) -> Rgb {
    let all = deviation * gaussian(rng);
    color.map(|c| (f64::from(c) + all + 0.5 * deviation * gaussian(rng)).clamp(0.0, 1.0) as f32)
}

/// A place on a square of a side, or up to a share of it outside.
pub(super) fn place(rng: &mut impl Rng, side: f64, outside: f64) -> Point {
    let mut coordinate = || within(rng, -outside, 1.0 + outside) * side;
    Point::new(coordinate(), coordinate())
}

/// A colour near one of some.
pub(super) fn like(rng: &mut impl Rng, colors: &[Rgb], deviation: f64) -> Rgb {
    let color = *pick(rng, colors);
    near(rng, color, deviation)
}

/// Smooth noise, about -1 to 1, in cells of some size.
pub(super) fn clouds(rng: &mut impl Rng, (width, height): (usize, usize), cells: (f64, f64)) -> Raster<f32> {
    let cell = within(rng, cells.0, cells.1);
    smooth(rng, width, height, cell)
}
