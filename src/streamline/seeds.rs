//! Where walks begin: on the ridge of the ink, where its direction is most certain.

use crate::clean::{LineImage, is_ridge};
use crate::field::FrameField;
use crate::raster::runs;
use kurbo::{Point, Vec2};
use rayon::prelude::*;

/// A place to start from, and the direction of the line there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Seed {
    pub point: Point,
    pub tangent: Vec2,
}

/// How far the ink is followed along a direction to judge it, in line widths.
const LOOK: f64 = 4.0;

/// All seeds, most certain first: where the ink is long in one direction of the frame and short in the other.
pub(super) fn seeds(image: &LineImage, frames: &FrameField) -> Vec<Seed> {
    let rank = |x: usize, y: usize| {
        let point = Point::new(x as f64 + 0.5, y as f64 + 0.5);
        let frame = frames.at_pixel(x, y)?;
        let (along_u, along_v) = (run(image, point, frame.u), run(image, point, frame.v));
        let tangent = if along_u >= along_v { frame.u } else { frame.v };
        // Quantised, so that equal certainty falls back on the order of pixels.
        Some((((along_u - along_v).abs() * 4.0).round() as i64, Seed { point, tangent }))
    };
    let of_row = |y: usize| {
        let ridge = runs(image.mask.row(y)).flatten().filter(move |&x| is_ridge(&image.depth, x, y));
        ridge.filter_map(move |x| rank(x, y))
    };
    let mut ranked: Vec<(i64, Seed)> = (0..image.mask.height()).into_par_iter().flat_map_iter(of_row).collect();
    ranked.sort_by_key(|(certainty, _)| std::cmp::Reverse(*certainty));
    ranked.into_iter().map(|(_, seed)| seed).collect()
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
