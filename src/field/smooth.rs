//! Smoothing that keeps junctions: a bilateral filter (Tomasi and Manduchi 1998) on the coefficients, of first order.
//!
//! Along a line the coefficients change slowly, so what fits them over some line widths takes the noise out of the
//! directions. What crosses the line has other coefficients, and so little weight, however near it is. Fitted is a plane
//! instead of a mean (Cleveland 1979, locally weighted regression): where a bent line ends, all its neighbours lie on one
//! side, and their mean is the direction further in.

use super::PolyVectorField;
use crate::raster::{Mask, runs};
use num_complex::Complex32;
use rayon::prelude::*;
use std::ops::Range;

/// Entries of the table of weights by squared distance of coefficients, and the distance at its end, in standard deviations.
const STEPS: usize = 256;
const UNLIKE: f32 = 3.0;
/// Added to the variance of the neighbours' places along each axis, in square pixels, before slopes are taken: across a
/// thin line they lie too near one another to tell one.
const LEVEL: f32 = 0.5;
/// The window's half width in standard deviations.
const REACH: f64 = 1.5;

impl PolyVectorField {
    /// The field fitted to like coefficients on the mask nearby; `sigma` is the standard deviation in pixels, `alike` that of
    /// the distance of coefficients, `sqrt(|c0 - c0'|^2 + |c2 - c2'|^2)`.
    ///
    /// What lies off the mask stays as it is.
    #[must_use]
    pub fn smoothed(mut self, mask: &Mask, sigma: f64, alike: f32) -> Self {
        let width = mask.width();
        let filter = Filter::new(&self, mask, sigma, alike);
        let rows: Vec<Vec<(Complex32, Complex32)>> =
            (0..mask.height()).into_par_iter().map(|y| filter.row(y)).collect();
        for (y, row) in rows.iter().enumerate() {
            let pixels = runs(mask.row(y)).flatten().map(|x| y * width + x);
            for (i, &(c0, c2)) in pixels.zip(row) {
                (self.c0.data_mut()[i], self.c2.data_mut()[i]) = (c0, c2);
            }
        }
        self
    }
}

/// The filter at work on a field.
struct Filter<'a> {
    field: &'a PolyVectorField,
    /// The runs of the mask in each row.
    runs: Vec<Vec<Range<usize>>>,
    /// Weights by distance in pixels along an axis.
    near: Vec<f32>,
    /// Weights by squared distance of coefficients, and entries of this table per unit of it.
    alike: Vec<f32>,
    scale: f32,
}

impl<'a> Filter<'a> {
    fn new(field: &'a PolyVectorField, mask: &Mask, sigma: f64, alike: f32) -> Self {
        let radius = (REACH * sigma).ceil() as usize;
        let near = (0..=radius).map(|d| (-0.5 * (d as f64 / sigma).powi(2)).exp() as f32).collect();
        let weight = |i: usize| (-0.5 * (i as f32 + 0.5) / STEPS as f32 * UNLIKE * UNLIKE).exp();
        let weights = (0..STEPS).map(weight).collect();
        let scale = STEPS as f32 / (UNLIKE * alike).powi(2);
        let runs = (0..mask.height()).into_par_iter().map(|y| runs(mask.row(y)).collect()).collect();
        Self { field, runs, near, alike: weights, scale }
    }

    /// What fits at the mask's pixels of a row.
    fn row(&self, y: usize) -> Vec<(Complex32, Complex32)> {
        self.runs[y].iter().flat_map(|run| run.clone().map(|x| self.fitted(x, y))).collect()
    }

    fn fitted(&self, x: usize, y: usize) -> (Complex32, Complex32) {
        let (c0, c2) = (self.field.c0[(x, y)], self.field.c2[(x, y)]);
        let radius = self.near.len() - 1;
        let (left, right) = (x.saturating_sub(radius), x + radius + 1);
        let mut plane = Plane::default();
        for v in y.saturating_sub(radius)..(y + radius + 1).min(self.runs.len()) {
            let across = self.near[v.abs_diff(y)];
            let first = self.runs[v].partition_point(|run| run.end <= left);
            let inside = self.runs[v][first..].iter().take_while(|run| run.start < right);
            for u in inside.flat_map(|run| run.start.max(left)..run.end.min(right)) {
                let (a, b) = (self.field.c0[(u, v)], self.field.c2[(u, v)]);
                let step = ((a - c0).norm_sqr() + (b - c2).norm_sqr()) * self.scale;
                let Some(like) = self.alike.get(step as usize) else { continue };
                let weight = like * across * self.near[u.abs_diff(x)];
                plane.add([u as f32 - x as f32, v as f32 - y as f32], [a, b], weight);
            }
        }
        plane.here().unwrap_or((c0, c2))
    }
}

/// Weighted sums over neighbours, from which a plane through their coefficients is fitted in least squares.
#[derive(Default)]
struct Plane {
    weight: f32,
    /// Offsets, and their products `xx`, `xy`, `yy`.
    offset: [f32; 2],
    products: [f32; 3],
    /// `c0` and `c2`, alone and times the offsets.
    values: [Complex32; 2],
    tilted: [[Complex32; 2]; 2],
}

impl Plane {
    fn add(&mut self, [x, y]: [f32; 2], values: [Complex32; 2], weight: f32) {
        let [wx, wy] = [weight * x, weight * y];
        self.weight += weight;
        self.offset[0] += wx;
        self.offset[1] += wy;
        self.products[0] += wx * x;
        self.products[1] += wx * y;
        self.products[2] += wy * y;
        for ((sum, tilted), value) in self.values.iter_mut().zip(&mut self.tilted).zip(values) {
            *sum += value * weight;
            tilted[0] += value * wx;
            tilted[1] += value * wy;
        }
    }

    /// The plane's coefficients where offsets are 0; `None` without a neighbour.
    fn here(&self) -> Option<(Complex32, Complex32)> {
        if self.weight <= 0.0 {
            return None;
        }
        let [x, y] = self.offset.map(|o| o / self.weight);
        let [xx, xy, yy] = self.products.map(|p| p / self.weight);
        let (xx, xy, yy) = (xx - x * x + LEVEL, xy - x * y, yy - y * y + LEVEL);
        let det = xx * yy - xy * xy;
        let height = |k: usize| {
            let mean = self.values[k] / self.weight;
            let [tx, ty] = self.tilted[k].map(|t| t / self.weight);
            let (tx, ty) = (tx - mean * x, ty - mean * y);
            mean - ((tx * yy - ty * xy) * x + (ty * xx - tx * xy) * y) / det
        };
        Some((height(0), height(1)))
    }
}

#[cfg(test)]
mod tests {
    use super::super::{decode, encode};
    use super::*;
    use crate::raster::Raster;
    use kurbo::Vec2;

    /// A field of the directions `angle(x, y)` and its normal, with an error that alternates from pixel to pixel.
    fn noisy(size: usize, angle: impl Fn(usize, usize) -> f64) -> PolyVectorField {
        PolyVectorField::from_directions(size, size, |x, y| {
            let error = if (x * 7 + y * 3) % 5 < 2 { 0.03 } else { -0.03 };
            let u = Vec2::from_angle(angle(x, y) + error);
            Some((u, u.turn_90()))
        })
    }

    fn error(field: &PolyVectorField, x: usize, y: usize, angle: f64) -> f64 {
        let frame = decode(field.c0()[(x, y)], field.c2()[(x, y)]).unwrap();
        let d = Vec2::from_angle(angle);
        frame.u.cross(d).abs().min(frame.v.cross(d).abs())
    }

    #[test]
    fn noise_is_averaged_out_at_every_angle() {
        let mask = Raster::filled(40, 40, true);
        for step in 0..16 {
            let angle = 0.2 * f64::from(step);
            let field = noisy(40, |_, _| angle).smoothed(&mask, 4.0, 0.2);
            assert!(error(&field, 20, 20, angle) < 0.012, "{angle}");
        }
    }

    #[test]
    fn slow_turns_stay_where_they_are() {
        let turn = |x: usize, y: usize| 0.01 * (x as f64 - 20.0) + 0.004 * (y as f64 - 20.0);
        let field = noisy(40, turn).smoothed(&Raster::filled(40, 40, true), 4.0, 0.2);
        assert!(error(&field, 20, 20, 0.0) < 0.012);
    }

    #[test]
    fn the_end_of_a_bent_line_keeps_its_direction() {
        let mask = Raster::from_fn(40, 40, |_, y| y.abs_diff(20) <= 1);
        for bend in [0.005, 0.01, 0.02] {
            let turn = |x: usize| bend * x as f64;
            let field = noisy(40, |x, _| turn(x)).smoothed(&mask, 4.0, 0.2);
            for x in [0, 1, 38, 39] {
                let off = error(&field, x, 20, turn(x));
                assert!(off < 0.018, "{off} at {x}, {bend} a pixel");
            }
        }
    }

    #[test]
    fn unlike_neighbours_and_paper_have_no_say() {
        let half = |x: usize| if x < 20 { 0.1 } else { 0.8 };
        let field = noisy(40, |x, _| half(x));
        let mask = Raster::from_fn(40, 40, |_, y| y < 30);
        let smooth = field.clone().smoothed(&mask, 4.0, 0.2);
        for x in [17, 19, 20, 22] {
            assert!(error(&smooth, x, 15, half(x)) < 0.018, "{x}");
        }
        assert_eq!(smooth.c0()[(5, 35)], field.c0()[(5, 35)]);
        let (c0, _) = encode(Vec2::new(1.0, 0.0), Vec2::new(0.0, 1.0));
        let even = PolyVectorField::from_directions(9, 9, |_, _| Some((Vec2::new(1.0, 0.0), Vec2::new(0.0, 1.0))));
        assert!((even.smoothed(&Raster::filled(9, 9, true), 3.0, 0.2).c0()[(4, 4)] - c0).norm() < 1e-5);
    }
}
