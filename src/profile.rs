//! The ink across a line.

use crate::raster::Raster;
use kurbo::{Point, Vec2};

/// Sampling distance across the line, in pixels.
const SPACING: f64 = 0.25;
/// The same where the darkest place is looked for, and the least ink there that is full.
const FINE: f64 = 0.0625;
const FULL: f32 = 0.95;
/// A profile whose highest sample is below this has no ink.
const PEAK_MIN: f32 = 0.25;
/// How far to both sides of an edge the ink is what it is inside and outside, in pixels.
const FLANK: f64 = 1.5;
/// Ink on the two flanks of an edge, of the peak, from which its place can be told by area: blur and grain hide it.
const INSIDE_MIN: f32 = 0.99;
const OUTSIDE_MAX: f32 = 0.01;

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
        self.width().is_some_and(|w| w < widest(width) && w > 0.5 * width - 0.35)
    }

    /// How far to move along the normal to sit in the middle of a line of the given width.
    ///
    /// Both edges of ink that is no wider are its own. Where two lines run into one another only the outer edge belongs to
    /// this line: it alone is used when it lies about where it should. `None` where neither edge says anything.
    pub fn shift(&self, width: f64) -> Option<f64> {
        if self.width().is_some_and(|w| w < widest(width)) {
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

/// The widest that one line of about a width may seem.
fn widest(width: f64) -> f64 {
    1.3 * width + 0.35
}

/// Measures the ink across a line through `p` with unit normal `normal`, up to `reach` to both sides.
///
/// Edges are those of the run of ink at the point, by area ([`sharp_edge`]) or else where interpolated samples cross half
/// of the peak. `None` when there is no ink at the point.
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
    let (left, right) = (edge(-1), edge(1));
    let along = |s: f64| ink.sample(p + normal * s);
    if let (Some(left), Some(right)) = (left, right)
        && left + right < 2.0 * FLANK
    {
        return Some(thin_line(along, left, right).unwrap_or(Profile { left: Some(left), right: Some(right) }));
    }
    let sharp =
        |crossing: f64, direction: f64| sharp_edge(|s| along(s * direction), crossing, peak).unwrap_or(crossing);
    Some(Profile { left: left.map(|s| sharp(s, -1.0)), right: right.map(|s| sharp(s, 1.0)) })
}

/// The edges of a line too thin for its ink to be even on both sides of where it is darkest, from crossings to both sides
/// of it: those that leave as much ink to either side of there. `None` where there is more ink beside it, or none that is
/// full.
fn thin_line(along: impl Fn(f64) -> f32, left: f64, right: f64) -> Option<Profile> {
    let (from, to) = (-left - FLANK, right + FLANK);
    if along(from).max(along(to)) > OUTSIDE_MAX {
        return None;
    }
    let inner = (-12..=12).map(|k| 0.5 * (right - left) + f64::from(k) * FINE);
    let darkest = inner.max_by(|&a, &b| along(a).total_cmp(&along(b))).filter(|&s| along(s) > FULL)?;
    let area = |end: f64| {
        let count = ((end - darkest).abs() / SPACING).ceil();
        let step = (end - darkest) / count;
        let between = (1..count as i32).map(|k| along(darkest + f64::from(k) * step)).sum::<f32>();
        step.abs() * f64::from(between + 0.5 * along(darkest))
    };
    Some(Profile { left: Some(area(from) - darkest), right: Some(area(to) + darkest) })
}

/// Where a sharp edge would leave as much ink as lies around the half-intensity crossing of a ray that leaves ink of
/// the given peak.
///
/// Pixels that an edge covers in part put the crossing of their interpolation up to .09 pixels off it, the same way
/// along all of an upright line; their sum is right. `None` where the ink is not even on both sides.
pub(crate) fn sharp_edge(along: impl Fn(f64) -> f32, crossing: f64, peak: f32) -> Option<f64> {
    let (inside, outside) = (along(crossing - FLANK), along(crossing + FLANK));
    if inside < INSIDE_MIN * peak || outside > OUTSIDE_MAX * peak {
        return None;
    }
    let count = (2.0 * FLANK / SPACING) as i32;
    let between = (1..count).map(|k| along(crossing - FLANK + f64::from(k) * SPACING) - outside).sum::<f32>();
    let area = between / (inside - outside) + 0.5;
    Some(crossing - FLANK + f64::from(area) * SPACING)
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
    fn edges_of_an_upright_band_are_exact_wherever_they_cut_their_pixels() {
        for width in [2.1, 2.5, 2.8, 3.0, 3.4, 5.0] {
            for phase in (0..16).map(|k| f64::from(k) / 16.0) {
                let (from, to) = (20.0 + phase - 0.5 * width, 20.0 + phase + 0.5 * width);
                let covered = |x: f64| ((x + 1.0).min(to) - x.max(from)).clamp(0.0, 1.0);
                let ink = Raster::from_fn(40, 8, |x, _| covered(x as f64) as f32);
                let profile = cross_profile(&ink, Point::new(20.2, 4.0), Vec2::new(1.0, 0.0), 5.0).unwrap();
                assert!((profile.width().unwrap() - width).abs() < 0.03, "{width} {phase}: {profile:?}");
                assert!((profile.middle().unwrap() - phase + 0.2).abs() < 0.03, "{width} {phase}: {profile:?}");
            }
        }
    }

    #[test]
    fn a_line_far_thinner_than_its_pen_is_found_in_its_middle() {
        for offset in [-0.6, 0.0, 0.4] {
            let profile = Profile { left: Some(1.1 + offset), right: Some(1.1 - offset) };
            assert_eq!(profile.shift(5.0), profile.middle(), "{offset}");
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
