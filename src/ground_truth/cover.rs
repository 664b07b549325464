//! Which curves cover a pixel, and in what direction.

use super::curve::{CORNER, Curve};
use kurbo::Point;

/// Curves kept per pixel; the nearest ones.
const SLOTS: usize = 4;

/// A curve over a pixel: its point nearest the pixel's centre.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cover {
    /// Distance from the pixel's centre to the centreline in pixels.
    pub distance: f64,
    /// Index of the curve.
    pub curve: u32,
    /// Arc length of the nearest point.
    pub arc: f64,
    /// Tangent angle there in radians.
    pub angle: f64,
}

/// Up to [`SLOTS`] covers of one pixel, nearest first.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Covers([Option<Cover>; SLOTS]);

impl Covers {
    /// The covers, nearest first.
    pub fn iter(&self) -> impl Iterator<Item = &Cover> {
        self.0.iter().flatten()
    }

    /// The nearest cover.
    pub fn nearest(&self) -> Option<&Cover> {
        self.0[0].as_ref()
    }

    /// The second direction where two curves share the pixel: the nearest that differs by a corner angle from
    /// the first; else one that runs along the first, if both really overlap on the pixel's centre.
    ///
    /// An end that another curve's end continues is no intersection.
    pub fn second(&self, curves: &[Curve]) -> Option<&Cover> {
        let first = self.nearest()?;
        let others = || self.0[1..].iter().flatten();
        let crossing = others().find(|c| line_angle(c.angle, first.angle) > CORNER);
        crossing.or_else(|| others().find(|c| overlaps(first, c, curves)))
    }

    /// Keeps a cover if it is the nearest of its branch so far. Two visits of one curve are one branch unless
    /// more than `separation` of arc length lies between.
    fn offer(&mut self, cover: Cover, curves: &[Curve], separation: f64) {
        let curve = &curves[cover.curve as usize];
        let same = |c: &Cover| c.curve == cover.curve && curve.between(c.arc, cover.arc) <= separation;
        if let Some(i) = self.0.iter().position(|s| s.as_ref().is_some_and(same)) {
            if self.0[i].is_some_and(|c| c.distance <= cover.distance) {
                return;
            }
            self.0.copy_within(i + 1.., i);
            self.0[SLOTS - 1] = None;
        }
        let at = self.0.iter().position(|s| s.is_none_or(|c| c.distance > cover.distance));
        if let Some(at) = at {
            self.0.copy_within(at..SLOTS - 1, at + 1);
            self.0[at] = Some(cover);
        }
    }
}

fn overlaps(a: &Cover, b: &Cover, curves: &[Curve]) -> bool {
    let (ca, cb) = (&curves[a.curve as usize], &curves[b.curve as usize]);
    let continued = ca.at_end(a.arc) && cb.at_end(b.arc);
    !continued && a.distance <= 0.5 * ca.width && b.distance <= 0.5 * cb.width
}

/// Angle between two lines in radians, 0 to pi/2.
pub(super) fn line_angle(a: f64, b: f64) -> f64 {
    let d = (a - b).rem_euclid(std::f64::consts::PI);
    d.min(std::f64::consts::PI - d)
}

/// The covers of every pixel whose centre is within half a width and half a pixel of a centreline.
pub(super) fn cover(curves: &[Curve], width: usize, height: usize) -> Vec<Covers> {
    let mut pixels = vec![Covers::default(); width * height];
    for (index, curve) in curves.iter().enumerate() {
        let radius = 0.5 * curve.width + 0.5;
        let separation = 2.5 * (curve.width + 1.0);
        for sample in &curve.samples {
            let (sx, sy) = (sample.position.x, sample.position.y);
            for y in span(sy, radius, height) {
                for x in span(sx, radius, width) {
                    let centre = Point::new(x as f64 + 0.5, y as f64 + 0.5);
                    let distance = (centre - sample.position).hypot();
                    if distance <= radius {
                        let angle = sample.tangent_near(centre);
                        let cover = Cover { distance, curve: index as u32, arc: sample.arc, angle };
                        pixels[y * width + x].offer(cover, curves, separation);
                    }
                }
            }
        }
    }
    pixels
}

/// The pixels of a row whose centres are within `radius` of a coordinate.
pub(super) fn span(centre: f64, radius: f64, size: usize) -> std::ops::Range<usize> {
    let low = (centre - radius - 0.5).ceil().max(0.0);
    let high = (centre + radius + 0.5).floor().clamp(0.0, size as f64);
    low as usize..(high as usize).max(low as usize)
}
