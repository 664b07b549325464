//! Where walks begin: on the ridge of the ink, where its direction is most certain.

use crate::clean::{LineImage, is_ridge};
use crate::field::FrameField;
use kurbo::{Point, Vec2};

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
    let mut ranked = Vec::new();
    let (width, height) = image.mask.size();
    for y in 0..height {
        for x in 0..width {
            if image.mask[(x, y)] && is_ridge(&image.depth, x, y) {
                let point = Point::new(x as f64 + 0.5, y as f64 + 0.5);
                let Some(frame) = frames.at_pixel(x, y) else { continue };
                let (along_u, along_v) = (run(image, point, frame.u), run(image, point, frame.v));
                let tangent = if along_u >= along_v { frame.u } else { frame.v };
                // Quantised, so that equal certainty falls back on the order of pixels.
                ranked.push((((along_u - along_v).abs() * 4.0).round() as i64, Seed { point, tangent }));
            }
        }
    }
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
