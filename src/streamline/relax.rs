//! A traced line is settled onto the middle of its ink.
//!
//! A walk sees only what lies behind it and lags in bends. With the whole line known, each point's normal
//! comes from both sides, and the point moves along it to the middle of the ink; points inside junctions are
//! carried along smoothly.

use super::{STEP, Streamline};
use crate::clean::LineImage;
use crate::profile::cross_profile;
use kurbo::{Point, Vec2};

const ROUNDS: usize = 3;

/// Settles a line in place and measures its widths anew.
pub(super) fn relax(image: &LineImage, line: &mut Streamline, width: f64) {
    let n = line.points.len();
    if n < 5 {
        return;
    }
    for _ in 0..ROUNDS {
        let moved: Vec<(Vec2, f64)> = (0..n).map(|k| correction(image, line, k, width)).collect();
        let shifts: Vec<Vec2> = moved.iter().map(|m| m.0).collect();
        for (k, &(_, measured)) in moved.iter().enumerate() {
            // The mean of neighbours' corrections: the middle of the ink is smoother than its pixels.
            line.points[k] += smoothed(&shifts, k, line.closed);
            line.widths[k] = measured;
        }
    }
}

/// How a point should move, and the ink width there (NaN when the line is not alone).
fn correction(image: &LineImage, line: &Streamline, k: usize, width: f64) -> (Vec2, f64) {
    let span = ((0.5 * width / STEP) as usize).max(2);
    let tangent = tangent(line, k, span);
    let normal = tangent.turn_90();
    let Some(profile) = cross_profile(&image.ink, line.points[k], normal, 0.85 * width + 1.0) else {
        return (Vec2::ZERO, f64::NAN);
    };
    let measured = if profile.is_single(width) { profile.width().unwrap_or(f64::NAN) } else { f64::NAN };
    let shift = profile.shift(width).unwrap_or(0.0).clamp(-0.3 * width, 0.3 * width);
    (normal * (0.7 * shift), measured)
}

/// Unit tangent from the points `span` before and after.
fn tangent(line: &Streamline, k: usize, span: usize) -> Vec2 {
    let n = line.points.len();
    let at = |i: i64| -> Point {
        let i = if line.closed { i.rem_euclid(n as i64) } else { i.clamp(0, n as i64 - 1) };
        line.points[i as usize]
    };
    let d = at((k + span) as i64) - at(k as i64 - span as i64);
    if d.hypot() > 1e-9 { d.normalize() } else { Vec2::new(1.0, 0.0) }
}

fn smoothed(shifts: &[Vec2], k: usize, closed: bool) -> Vec2 {
    let n = shifts.len() as i64;
    let at = |i: i64| shifts[if closed { i.rem_euclid(n) } else { i.clamp(0, n - 1) } as usize];
    let k = k as i64;
    (at(k - 2) + 2.0 * at(k - 1) + 3.0 * at(k) + 2.0 * at(k + 1) + at(k + 2)) / 9.0
}
