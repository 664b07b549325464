//! How wide the lines are.

use super::solids::half_width_of_wide;
use crate::profile::cross_profile;
use crate::raster::{Mask, Raster};
use kurbo::{Point, Vec2};
use rayon::prelude::*;
use std::f64::consts::PI;

/// At most about this many places are measured.
const SAMPLES: usize = 4000;
/// Directions tried across a line; the narrowest is within 2 % of the true width.
const DIRECTIONS: usize = 8;

/// Lines are fine among broad ones when they are at least this share of all.
const FINE_SHARE: f64 = 0.12;

/// Whether a pixel lies on the medial ridge of the mask: no neighbour is deeper.
pub(crate) fn is_ridge(depth: &Raster<f32>, x: usize, y: usize) -> bool {
    let here = depth[(x, y)];
    if here <= 0.0 {
        return false;
    }
    let (x, y) = (x as i64, y as i64);
    let around = [(-1, -1), (0, -1), (1, -1), (-1, 0), (1, 0), (-1, 1), (0, 1), (1, 1)];
    around.iter().all(|&(dx, dy)| depth.get(x + dx, y + dy).is_none_or(|d| d <= here))
}

/// The pixels of the medial ridge, row by row.
pub(super) fn ridge_pixels(mask: &Mask, depth: &Raster<f32>) -> Vec<(usize, usize)> {
    let of_row = |y: usize| {
        let inked = mask.row(y).iter().enumerate().filter(|(_, m)| **m).map(move |(x, _)| (x, y));
        inked.filter(|&(x, y)| is_ridge(depth, x, y))
    };
    (0..mask.height()).into_par_iter().flat_map_iter(of_row).collect()
}

/// A place on the ridge of a line.
#[derive(Clone, Copy, Debug)]
pub(super) struct RidgePlace {
    pub point: Point,
    /// Unit vector across the line.
    pub normal: Vec2,
    /// Ink width in pixels: the narrowest of the cross profiles.
    pub width: f64,
    /// The ink itself.
    pub ink: f32,
}

/// What is measured at places spread over the ridge.
pub(super) struct Ridge {
    /// The places, row by row.
    pub places: Vec<RidgePlace>,
    /// Their widths, sorted.
    pub widths: Vec<f64>,
    /// Their ink, sorted.
    pub ink: Vec<f32>,
}

impl Ridge {
    /// Measures the ridge of a mask of some depth.
    pub fn of(ink: &Raster<f32>, mask: &Mask, depth: &Raster<f32>) -> Self {
        let ridge = ridge_pixels(mask, depth);
        let sampled = ridge.par_iter().step_by((ridge.len() / SAMPLES).max(1));
        let place = |&(x, y): &(usize, usize)| {
            let point = Point::new(x as f64 + 0.5, y as f64 + 0.5);
            let (normal, width) = narrowest_direction(ink, point, depth[(x, y)])?;
            Some(RidgePlace { point, normal, width, ink: ink[(x, y)] })
        };
        let places: Vec<RidgePlace> = sampled.filter_map(place).collect();
        let mut widths: Vec<f64> = places.iter().map(|place| place.width).collect();
        let mut ink: Vec<f32> = places.iter().map(|place| place.ink).collect();
        widths.sort_by(f64::total_cmp);
        ink.sort_by(f32::total_cmp);
        Self { places, widths, ink }
    }

    /// The median width in pixels; 1 without ink.
    pub fn median_width(&self) -> f64 {
        self.widths.get(self.widths.len() / 2).copied().unwrap_or(1.0)
    }

    /// Typical line width in pixels: the median, or, where most lines are too broad to be traced beside fine ones, that
    /// of the fine ones; 1 without ink.
    pub fn line_width(&self) -> f64 {
        let median = self.median_width();
        let fine = self.widths.partition_point(|&width| half_width_of_wide(width) < 0.5 * median);
        if fine as f64 > FINE_SHARE * self.widths.len() as f64 { self.widths[fine / 2] } else { median }
    }
}

/// The direction in which the ink at a ridge point is narrowest, and its width there.
pub(super) fn narrowest_direction(ink: &Raster<f32>, p: Point, depth: f32) -> Option<(Vec2, f64)> {
    let reach = 1.5 * f64::from(depth) + 2.0;
    (0..DIRECTIONS)
        .filter_map(|k| {
            let direction = Vec2::from_angle(PI * k as f64 / DIRECTIONS as f64);
            Some((direction, cross_profile(ink, p, direction, reach)?.width()?))
        })
        .min_by(|a, b| a.1.total_cmp(&b.1))
}
