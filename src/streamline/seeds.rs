//! Where walks begin: on the ridge of the ink, where its direction is most certain; then in ink that is left over.

use super::coverage::Coverage;
use crate::clean::{LineImage, is_ridge};
use crate::field::FrameField;
use crate::profile::cross_profile;
use crate::raster::{floor, runs};
use kurbo::{Point, Vec2};
use rayon::prelude::*;

/// A place to start from, and the direction of the line there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Seed {
    pub point: Point,
    pub tangent: Vec2,
}

impl Seed {
    /// Whether it is one of a fifth of all seeds, of which long lines and large circles have enough.
    pub fn is_of_sample(&self) -> bool {
        let (x, y) = pixel(self.point);
        // Along a line of any slope, all remainders follow one another.
        (x + 2 * y) % 5 == 0
    }

    /// The middle of the line's ink and its width, in pixels; `None` where the ink is not one line's.
    pub fn line(&self, image: &LineImage) -> Option<(Point, f64)> {
        let normal = self.tangent.turn_90();
        let depth = f64::from(image.depth.at(self.point).unwrap_or(1.0));
        let profile = cross_profile(&image.ink, self.point, normal, 1.5 * depth + 2.0)?;
        let width = profile.width().filter(|width| *width < 2.5 * depth + 0.5)?;
        Some((self.point + normal * profile.middle()?, width.max(1.0)))
    }
}

/// Column and row of the pixel around a point.
pub(super) fn pixel(p: Point) -> (i64, i64) {
    (floor(p.x), floor(p.y))
}

/// How far the ink is followed along a direction to judge it, in line widths.
const LOOK: f64 = 4.0;
/// Radius in line widths of the discs of ink that count as left over.
const LEFT_OVER: f64 = 0.3;
/// Within so many line widths of a line, in nearly its direction (10 degrees) and with so much ink between, lies its flank.
const BESIDE: f64 = 1.5;
const PARALLEL_COS: f64 = 0.985;
const SOLID: f32 = 0.75;

/// All seeds on the ridge of the ink, most certain first.
pub(super) fn seeds(image: &LineImage, frames: &FrameField) -> Vec<Seed> {
    let of_row = |y: usize| {
        let ridge = runs(image.mask.row(y)).flatten().filter(move |&x| is_ridge(&image.depth, x, y));
        ridge.filter_map(move |x| seed(image, frames, x, y))
    };
    ranked((0..image.mask.height()).into_par_iter().flat_map_iter(of_row).collect())
}

/// Seeds in a part of the ink, left, top, right and bottom in pixels, where a disc of [`LEFT_OVER`] lies in ink that nothing
/// covers yet: lines so close to others that their ridge is not their own.
pub(super) fn leftover(image: &LineImage, frames: &FrameField, coverage: &Coverage, part: [usize; 4]) -> Vec<Seed> {
    let [left, top, right, bottom] = part;
    let radius = (LEFT_OVER * image.line_width).max(1.0);
    let reach = radius.floor() as i64;
    let left_over = |x: i64, y: i64| {
        image.mask.get(x, y) == Some(true) && !coverage.is_painted(Point::new(x as f64 + 0.5, y as f64 + 0.5))
    };
    let disc = |x: usize, y: usize| {
        let inside = |dx: i64, dy: i64| ((dx * dx + dy * dy) as f64) <= radius * radius;
        let mut offsets = (-reach..=reach).flat_map(|dy| (-reach..=reach).map(move |dx| (dx, dy)));
        offsets.all(|(dx, dy)| !inside(dx, dy) || left_over(x as i64 + dx, y as i64 + dy))
    };
    // Ink that leads to a line of the same direction without a break is that line's, however wide.
    let is_flank = |seed: &Seed| {
        let near = BESIDE * image.line_width;
        let line = coverage
            .nearest(seed.point, seed.tangent, near, |mark| mark.heading.dot(seed.tangent).abs() > PARALLEL_COS);
        line.is_some_and(|mark| {
            (1..8).all(|k| image.ink.sample(seed.point.lerp(mark.point, f64::from(k) / 8.0)) > SOLID)
        })
    };
    let of_row = |y: usize| {
        let inked = runs(&image.mask.row(y)[left..right]).flatten().map(move |x| x + left);
        let seeds = inked.filter(move |&x| disc(x, y)).filter_map(move |x| seed(image, frames, x, y));
        seeds.filter(move |(_, seed)| !is_flank(seed))
    };
    ranked((top..bottom).flat_map(of_row).collect())
}

/// A seed in the middle of a pixel and how certain it is: it is where the ink is long in one direction of the frame and
/// short in the other. Certainty is quantised, so that equal certainty falls back on the order of pixels.
fn seed(image: &LineImage, frames: &FrameField, x: usize, y: usize) -> Option<(i64, Seed)> {
    let point = Point::new(x as f64 + 0.5, y as f64 + 0.5);
    let frame = frames.at_pixel(x, y)?;
    let (along_u, along_v) = (run(image, point, frame.u), run(image, point, frame.v));
    let tangent = if along_u >= along_v { frame.u } else { frame.v };
    Some((((along_u - along_v).abs() * 4.0).round() as i64, Seed { point, tangent }))
}

fn ranked(mut seeds: Vec<(i64, Seed)>) -> Vec<Seed> {
    seeds.sort_by_key(|(certainty, _)| std::cmp::Reverse(*certainty));
    seeds.into_iter().map(|(_, seed)| seed).collect()
}

/// Length of ink through a point along a direction, both ways, up to [`LOOK`] each.
fn run(image: &LineImage, p: Point, direction: Vec2) -> f64 {
    let limit = LOOK * image.line_width;
    let one_way = |d: Vec2| {
        let mut length = 0.0;
        while length < limit && image.mask.at(p + d * (length + 1.0)) == Some(true) {
            length += 1.0;
        }
        length
    };
    one_way(direction) + one_way(-direction)
}
