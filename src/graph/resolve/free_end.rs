//! Where the pen's path ended: half a line width short of the end of the ink.

use crate::clean::{LineImage, unblurred_width};
use crate::graph::lines::{End, EndState, Lines};
use crate::profile::sharp_edge;
use crate::streamline::STEP;
use kurbo::Point;

/// Standard deviation of what pixels blur by themselves, in pixels of the scan: that of a square of one pixel. Where an
/// edge is told by area, the interpolation of pixels across the cap counts too.
const PIXEL: f64 = 0.29;
const PIXEL_BY_AREA: f64 = 0.65;
/// Ink that is a line behind a gap, as a share of full ink.
const BEHIND_GAP: f32 = 0.9;
/// How far past the last point of a walk its ink may go on, in pixels.
const LOOK_AHEAD: f64 = 2.5;

/// The end of the pen's path: half a line width short of the end of the ink.
pub(in crate::graph) fn free_end(image: &LineImage, lines: &Lines, end: &End) -> Point {
    let line = &lines[end.line];
    let n = line.points.len();
    let d = line.at_end(end.side, 0) - line.at_end(end.side, (n - 1).min(3));
    let heading = if d.hypot() > 1e-9 { d.normalize() } else { end.tail.heading };
    if end.state == EndState::CutOff {
        return end.point;
    }
    let ink = |s: f64| image.ink.sample(end.point + heading * s);
    let (edge, pixel) = edge_ahead(ink, end.width);
    let width = unblurred_width(end.width, image.blur);
    let drawn_in = blurred_cap(image.blur.max(pixel * image.page_scale), width);
    // Never past the middle of a short line.
    let half_length = 0.5 * (n as f64 - 1.0) * STEP;
    end.point + heading * (edge + drawn_in - 0.5 * width).max(-half_length + 0.25)
}

/// How far inside the edge of a round cap half of the ink is left under a blur of variance `v`: `v / w` to second order
/// for a pen of width `w`, less where the blur is as wide as the pen.
fn blurred_cap(blur: f64, width: f64) -> f64 {
    let (variance, width) = (blur.powi(2), width.max(1.0));
    variance / (width + 8.0 * variance / width)
}

/// Where the ink of an end `width` wide stops ahead of it, and how much the pixels blur the cap there, as a standard
/// deviation in pixels of the scan.
fn edge_ahead(ink: impl Fn(f64) -> f32, width: f64) -> (f64, f64) {
    let step = 0.125;
    let steps = ((width + LOOK_AHEAD) / step) as usize;
    let mut along = (0..steps).map(|k| step * k as f64 - width);
    match along.find(|&s| ink(s) < 0.5) {
        Some(s) => sharp_edge(&ink, s - 0.5 * step, 1.0).map_or((s, PIXEL), |edge| (edge, PIXEL_BY_AREA)),
        None => near_side_of_gap(ink),
    }
}

/// The same where another line lies so near behind the end that no paper shows between: the missing ink around the
/// lightest place is that of a gap of the same area and middle. Where it is not seen how the ink goes on behind it, half
/// of what is missing lies before the lightest place.
fn near_side_of_gap(ink: impl Fn(f64) -> f32) -> (f64, f64) {
    let (step, reach) = (0.125, 12);
    let along = (0..=20).map(|k| step * f64::from(k));
    let lightest = along.min_by(|&a, &b| ink(a).total_cmp(&ink(b))).unwrap_or(0.0);
    let around = (-reach..=reach).map(|k| lightest + step * f64::from(k));
    let missing = around.map(|s| (s, f64::from(1.0 - ink(s).min(1.0))));
    let (area, moment) = missing.fold((0.0, 0.0), |(area, moment), (s, m)| (area + m, moment + s * m));
    if area > 0.0 && ink(lightest + step * f64::from(reach)) > BEHIND_GAP {
        (moment / area - 0.5 * step * area, PIXEL_BY_AREA)
    } else {
        (lightest - 0.5 * step * area, PIXEL)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ink ahead of an end that stops at a place, as pixels of this width show it.
    fn ramp(edge: f64) -> impl Fn(f64) -> f32 {
        move |s: f64| (0.5 - (s - edge)).clamp(0.0, 1.0) as f32
    }

    #[test]
    fn an_edge_is_found_wherever_the_walk_stopped_before_it() {
        for width in [1.5f64, 3.0, 6.0] {
            for k in -8..=12 {
                let edge = 0.1 * f64::from(k) * width.min(1.5);
                let (found, _) = edge_ahead(ramp(edge), width);
                assert!((found - edge).abs() < 0.1, "{width} {edge}: {found}");
            }
        }
    }

    #[test]
    fn a_gap_without_paper_begins_before_its_lightest_place() {
        for half in [0.3, 0.5, 0.8] {
            // Half of the ink is missing over a gap of this half width around 1.2.
            let ink = move |s: f64| if (s - 1.2f64).abs() < half { 0.55 } else { 1.0 };
            let (near, blur) = near_side_of_gap(ink);
            assert!(near < 1.2 && near > 1.2 - half - 0.2, "{half}: {near}");
            assert_eq!(blur, PIXEL_BY_AREA);
        }
    }

    #[test]
    fn a_cap_is_drawn_in_the_more_the_more_it_is_blurred() {
        for width in [1.0, 3.0, 8.0] {
            let all = [0.0, 0.3, 0.6, 1.0, 2.0].map(|blur| blurred_cap(blur, width));
            assert_eq!(all[0], 0.0);
            assert!(all.windows(2).all(|w| w[1] > w[0]) && all[4] < width, "{width}: {all:?}");
        }
    }
}
