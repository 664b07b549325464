//! The ink across a line.

use crate::raster::Raster;
use kurbo::{Point, Vec2};

/// Sampling distance across the line, in pixels.
const SPACING: f64 = 0.25;
/// A profile whose highest sample is below this has no ink.
const PEAK_MIN: f32 = 0.25;

/// Where the ink around a point ends to both sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Profile {
    /// Distance from the point to the half-intensity edge against the normal; `None` when out of reach.
    pub left: Option<f64>,
    /// Distance from the point to the half-intensity edge along the normal; `None` when out of reach.
    pub right: Option<f64>,
}

impl Profile {
    /// Ink width, when both edges are within reach.
    pub fn width(&self) -> Option<f64> {
        Some(self.left? + self.right?)
    }

    /// Signed distance along the normal from the point to the middle of the ink.
    pub fn middle(&self) -> Option<f64> {
        Some(0.5 * (self.right? - self.left?))
    }

    /// Whether the profile is that of one line of about the given width.
    pub fn is_single(&self, width: f64) -> bool {
        self.width().is_some_and(|w| w < 1.3 * width + 0.35 && w > 0.5 * width - 0.35)
    }

    /// How far to move along the normal to sit in the middle of a line of the given width.
    ///
    /// Where two lines run into one another only the outer edge belongs to this line: it alone is used when it
    /// lies about where it should. `None` where neither edge says anything.
    pub fn shift(&self, width: f64) -> Option<f64> {
        if self.is_single(width) {
            return self.middle();
        }
        let nearest = match (self.shift_by_left(width), self.shift_by_right(width)) {
            (Some(l), Some(r)) => Some(if l.abs() < r.abs() { l } else { r }),
            (one, other) => one.or(other),
        };
        nearest.filter(|s| s.abs() < 0.3 * width)
    }

    /// The same by the edge against the normal alone.
    pub fn shift_by_left(&self, width: f64) -> Option<f64> {
        self.left.map(|left| 0.5 * width - left)
    }

    /// The same by the edge along the normal alone.
    pub fn shift_by_right(&self, width: f64) -> Option<f64> {
        self.right.map(|right| right - 0.5 * width)
    }
}

/// Measures the ink across a line through `p` with unit normal `normal`, up to `reach` to both sides.
///
/// Edges are the half-intensity crossings of the run of ink at the point, interpolated between samples.
/// `None` when there is no ink at the point.
pub(crate) fn cross_profile(ink: &Raster<f32>, p: Point, normal: Vec2, reach: f64) -> Option<Profile> {
    let at = |k: i32| ink.sample(p + normal * (f64::from(k) * SPACING));
    let count = (reach / SPACING).ceil() as i32;
    // The point may sit beside the ridge: take the run of ink around the best sample near it.
    let near = (count / 4).clamp(1, 4);
    let (mut top, mut peak) = (0, at(0));
    for k in (1..=near).flat_map(|k| [-k, k]) {
        let value = at(k);
        if value > peak + 0.02 {
            (top, peak) = (k, value);
        }
    }
    if peak < PEAK_MIN {
        return None;
    }
    let half = 0.5 * peak;
    let edge = |direction: i32| {
        let mut inside = peak;
        let mut k = top;
        while k.abs() <= count {
            k += direction;
            let value = at(k);
            if value < half {
                let part = f64::from((inside - half) / (inside - value));
                return Some((f64::from(k * direction) - 1.0 + part) * SPACING);
            }
            inside = value;
        }
        None
    };
    Some(Profile { left: edge(-1), right: edge(1) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_of_an_oblique_band_are_found_below_a_pixel() {
        for (angle, width, offset) in [(0.0f64, 3.0, 0.2), (0.4, 4.0, -0.6), (1.2, 6.0, 0.9), (2.5, 2.5, 0.0)] {
            let normal = Vec2::from_angle(angle);
            let middle = Point::new(20.3, 19.8);
            let ink = Raster::from_fn(40, 40, |x, y| {
                let d = (Point::new(x as f64 + 0.5, y as f64 + 0.5) - middle).dot(normal);
                (0.5 * width - d.abs() + 0.5).clamp(0.0, 1.0) as f32
            });
            let profile = cross_profile(&ink, middle + normal * offset, normal, 6.0).unwrap();
            assert!((profile.width().unwrap() - width).abs() < 0.12, "{profile:?}");
            assert!((profile.middle().unwrap() + offset).abs() < 0.1, "{profile:?}");
        }
    }

    #[test]
    fn one_edge_is_enough_beside_another_line() {
        let ink = Raster::from_fn(40, 40, |x, _| if (10..13).contains(&x) || x >= 13 { 1.0 } else { 0.0 });
        let profile = cross_profile(&ink, Point::new(11.7, 20.0), Vec2::new(1.0, 0.0), 4.0).unwrap();
        assert_eq!(profile.right, None);
        assert!((profile.shift(3.0).unwrap() + 0.2).abs() < 0.05, "{profile:?}");
    }
}
