//! Smoothing that keeps junctions: a bilateral filter (Tomasi and Manduchi 1998) on the coefficients.
//!
//! Along a line the coefficients change slowly, so averaging over some line widths takes the noise out of the directions.
//! What crosses the line has other coefficients, and so little weight, however near it is.

use super::PolyVectorField;
use crate::raster::{Mask, runs};
use num_complex::Complex32;
use rayon::prelude::*;
use std::ops::Range;

/// Distance of coefficients, `sqrt(|c0 - c0'|^2 + |c2 - c2'|^2)`, that is one standard deviation of the filter.
const ALIKE: f32 = 0.3;
/// Entries of the table of weights by squared distance of coefficients, and the squared distance at its end.
const STEPS: usize = 256;
const UNLIKE: f32 = 9.0 * ALIKE * ALIKE;
/// The window's half width in standard deviations.
const REACH: f64 = 2.0;

impl PolyVectorField {
    /// The field averaged over like coefficients on the mask nearby; `sigma` is the standard deviation in pixels.
    ///
    /// What lies off the mask stays as it is.
    #[must_use]
    pub fn smoothed(mut self, mask: &Mask, sigma: f64) -> Self {
        let width = mask.width();
        let filter = Filter::new(&self, mask, sigma);
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
    /// Weights by squared distance of coefficients.
    alike: Vec<f32>,
}

impl<'a> Filter<'a> {
    fn new(field: &'a PolyVectorField, mask: &Mask, sigma: f64) -> Self {
        let radius = (REACH * sigma).ceil() as usize;
        let near = (0..=radius).map(|d| (-0.5 * (d as f64 / sigma).powi(2)).exp() as f32).collect();
        let weight = |i: usize| (-0.5 * (i as f32 + 0.5) / STEPS as f32 * UNLIKE / (ALIKE * ALIKE)).exp();
        let alike = (0..STEPS).map(weight).collect();
        let runs = (0..mask.height()).into_par_iter().map(|y| runs(mask.row(y)).collect()).collect();
        Self { field, runs, near, alike }
    }

    /// The averages at the mask's pixels of a row.
    fn row(&self, y: usize) -> Vec<(Complex32, Complex32)> {
        self.runs[y].iter().flat_map(|run| run.clone().map(|x| self.average(x, y))).collect()
    }

    fn average(&self, x: usize, y: usize) -> (Complex32, Complex32) {
        let (c0, c2) = (self.field.c0[(x, y)], self.field.c2[(x, y)]);
        let radius = self.near.len() - 1;
        let (left, right) = (x.saturating_sub(radius), x + radius + 1);
        let (mut sum0, mut sum2, mut total) = (Complex32::ZERO, Complex32::ZERO, 0.0);
        for v in y.saturating_sub(radius)..(y + radius + 1).min(self.runs.len()) {
            let across = self.near[v.abs_diff(y)];
            let first = self.runs[v].partition_point(|run| run.end <= left);
            let inside = self.runs[v][first..].iter().take_while(|run| run.start < right);
            for u in inside.flat_map(|run| run.start.max(left)..run.end.min(right)) {
                let (a, b) = (self.field.c0[(u, v)], self.field.c2[(u, v)]);
                let step = ((a - c0).norm_sqr() + (b - c2).norm_sqr()) * (STEPS as f32 / UNLIKE);
                let Some(like) = self.alike.get(step as usize) else { continue };
                let weight = like * across * self.near[u.abs_diff(x)];
                sum0 += a * weight;
                sum2 += b * weight;
                total += weight;
            }
        }
        if total > 0.0 { (sum0 / total, sum2 / total) } else { (c0, c2) }
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
            let error = if (x * 7 + y * 3) % 5 < 2 { 0.05 } else { -0.05 };
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
            let field = noisy(40, |_, _| angle).smoothed(&mask, 4.0);
            assert!(error(&field, 20, 20, angle) < 0.02, "{angle}");
        }
    }

    #[test]
    fn slow_turns_stay_where_they_are() {
        let turn = |x: usize, y: usize| 0.01 * (x as f64 - 20.0) + 0.004 * (y as f64 - 20.0);
        let field = noisy(40, turn).smoothed(&Raster::filled(40, 40, true), 4.0);
        assert!(error(&field, 20, 20, 0.0) < 0.02);
    }

    #[test]
    fn unlike_neighbours_and_paper_have_no_say() {
        let half = |x: usize| if x < 20 { 0.1 } else { 0.8 };
        let field = noisy(40, |x, _| half(x));
        let mask = Raster::from_fn(40, 40, |_, y| y < 30);
        let smooth = field.clone().smoothed(&mask, 4.0);
        for x in [17, 19, 20, 22] {
            assert!(error(&smooth, x, 15, half(x)) < 0.03, "{x}");
        }
        assert_eq!(smooth.c0()[(5, 35)], field.c0()[(5, 35)]);
        let (c0, _) = encode(Vec2::new(1.0, 0.0), Vec2::new(0.0, 1.0));
        let even = PolyVectorField::from_directions(9, 9, |_, _| Some((Vec2::new(1.0, 0.0), Vec2::new(0.0, 1.0))));
        assert!((even.smoothed(&Raster::filled(9, 9, true), 3.0).c0()[(4, 4)] - c0).norm() < 1e-5);
    }
}
