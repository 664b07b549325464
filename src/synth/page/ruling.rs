//! Ruled, squared, dotted, isometric and millimetre paper.

use super::super::noise::gaussian;
use super::super::shapes::within;
use super::random::spread;
use crate::raster::Raster;
use rand::Rng;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_3, PI};

/// Parallel lines at equal distances.
#[derive(Clone, Copy, Debug)]
struct Lines {
    /// Unit normal.
    normal: (f64, f64),
    step: f64,
    shift: f64,
    width: f64,
}

impl Lines {
    fn new(rng: &mut impl Rng, angle: f64, step: f64, width: f64) -> Self {
        let normal = angle + FRAC_PI_2;
        Self { normal: (normal.cos(), normal.sin()), step, shift: within(rng, 0.0, step), width }
    }

    /// Coverage of the pixel whose centre is at a place.
    fn at(&self, x: f64, y: f64) -> f32 {
        let across = x * self.normal.0 + y * self.normal.1 - self.shift;
        let distance = ((across / self.step).rem_euclid(1.0) - 0.5).abs();
        let distance = (0.5 - distance) * self.step;
        (0.5 * self.width + 0.5 - distance).clamp(0.0, self.width.min(1.0)) as f32
    }
}

/// Coverage by the lines of printed paper, 0 to 1.
pub(super) fn ruling(rng: &mut impl Rng, (width, height): (usize, usize)) -> Raster<f32> {
    let tilt = match rng.random_range(0..10) {
        0..5 => 0.0,
        5..9 => 0.05 * gaussian(rng),
        _ => within(rng, 0.0, PI),
    };
    let (step, pen, pattern) = (spread(rng, 7.0, 44.0), spread(rng, 0.5, 2.2), rng.random_range(0..8));
    let mut lines = |angle: f64, step: f64, width: f64| Lines::new(rng, tilt + angle, step, width);
    let (sets, dotted): (Vec<Lines>, bool) = match pattern {
        0 | 1 => (vec![lines(0.0, step, pen)], false),
        2..4 => (vec![lines(0.0, step, pen), lines(FRAC_PI_2, step, pen)], false),
        4 => (vec![lines(0.0, step, 2.2 * pen), lines(FRAC_PI_2, step, 2.2 * pen)], true),
        5 => ([0.0, FRAC_PI_3, 2.0 * FRAC_PI_3].map(|a| lines(a, step, pen)).to_vec(), false),
        6 => (millimetres(&mut lines, pen), false),
        // Ruled, with a margin.
        _ => (vec![lines(0.0, step, pen), lines(FRAC_PI_2, 400.0, 1.4 * pen)], false),
    };
    Raster::from_fn(width, height, |x, y| {
        let values = sets.iter().map(|set| set.at(x as f64 + 0.5, y as f64 + 0.5));
        if dotted { values.fold(1.0, |a, b| a * b) } else { values.fold(0.0, f32::max) }
    })
}

/// Fine lines and every fifth one bolder.
fn millimetres(lines: &mut impl FnMut(f64, f64, f64) -> Lines, pen: f64) -> Vec<Lines> {
    let step = 4.0 + pen;
    let mut sets = Vec::new();
    for angle in [0.0, FRAC_PI_2] {
        let fine = lines(angle, step, 0.5 * pen);
        sets.extend([Lines { step: 5.0 * step, width: pen.max(0.8), ..fine }, fine]);
    }
    sets
}

/// One line down the page.
pub(super) fn margin(rng: &mut impl Rng, (width, height): (usize, usize)) -> Raster<f32> {
    let (angle, pen) = (FRAC_PI_2 + 0.03 * gaussian(rng), within(rng, 0.7, 2.0));
    // So far apart that there is one at most.
    let line = Lines::new(rng, angle, 4.0 * width as f64, pen);
    Raster::from_fn(width, height, |x, y| line.at(x as f64 + 0.5, y as f64 + 0.5))
}
