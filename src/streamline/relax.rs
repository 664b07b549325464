//! A traced line is settled onto the middle of its ink.
//!
//! A walk sees only what lies behind it and lags in bends. With the whole line known, each point's normal
//! comes from both sides, and the point moves along it to the middle of the ink; points inside junctions are
//! carried along smoothly.

use super::{STEP, Streamline};
use crate::clean::LineImage;
use crate::profile::{Profile, cross_profile};
use kurbo::{Point, Vec2};
use std::iter::once;

const ROUNDS: usize = 3;
/// Ink wider than this many times the line's width, and so many pixels, is not the line's alone.
const WIDENED: f64 = 1.12;
const WIDENED_PIXELS: f64 = 0.15;

/// Settles a line in place and measures its widths anew.
pub(super) fn relax(image: &LineImage, line: &mut Streamline, width: f64) {
    let n = line.points.len();
    if n < 5 {
        return;
    }
    let span = ((0.5 * width / STEP) as usize).max(2);
    for _ in 0..ROUNDS {
        let normals: Vec<Vec2> = (0..n).map(|k| tangent(line, k, span).turn_90()).collect();
        let profile = |k: usize| cross_profile(&image.ink, line.points[k], normals[k], 0.85 * width + 1.0);
        let profiles: Vec<Option<Profile>> = (0..n).map(profile).collect();
        let lateral = lateral(&profiles, width);
        let limit = 0.3 * width;
        let shifts: Vec<Vec2> =
            normals.iter().zip(&lateral).map(|(normal, shift)| *normal * (0.7 * shift.clamp(-limit, limit))).collect();
        for (k, profile) in profiles.iter().enumerate() {
            // The mean of neighbours' corrections: the middle of the ink is smoother than its pixels.
            line.points[k] += smoothed(&shifts, k, line.closed);
            let single = profile.filter(|p| p.is_single(width));
            line.widths[k] = single.and_then(|p| p.width()).unwrap_or(f64::NAN);
        }
    }
}

/// How far each point is from the middle of the line's ink, along its normal.
///
/// Where another line runs in at a small angle, the ink widens to one side long before it is two lines' ink. There only
/// the edge of the other side is the line's own: the one that runs on without a break, and most evenly.
fn lateral(profiles: &[Option<Profile>], width: f64) -> Vec<f64> {
    let mut shifts: Vec<f64> = profiles.iter().map(|p| p.and_then(|p| p.shift(width)).unwrap_or(0.0)).collect();
    let is_wide =
        |p: &Option<Profile>| p.is_some_and(|p| p.width().is_none_or(|w| w > WIDENED * width + WIDENED_PIXELS));
    let mut from = 0;
    for run in profiles.chunk_by(|a, b| is_wide(a) == is_wide(b)) {
        let to = from + run.len();
        // A line that widens to its end tapers.
        let is_inner = from > 0 && to < profiles.len();
        if is_inner && is_wide(&run[0]) && run.len() as f64 * STEP > width {
            let [left, right] = [Profile::shift_by_left, Profile::shift_by_right].map(|by| {
                let shift = |p: &Option<Profile>| p.and_then(|p| by(&p, width));
                let before = once(Some(shifts[from - 1]));
                let all: Vec<Option<f64>> = before.chain(run.iter().map(shift)).chain(once(Some(shifts[to]))).collect();
                let steps = all.windows(2).map(|w| w[0].zip(w[1]).map_or(f64::INFINITY, |(a, b)| (b - a).abs()));
                (steps.sum::<f64>(), run.iter().map(shift).collect::<Vec<_>>())
            });
            let (roughness, own) = if left.0 <= right.0 { left } else { right };
            if roughness < width {
                own.iter().zip(&mut shifts[from..to]).for_each(|(own, shift)| *shift = own.unwrap_or(*shift));
            }
        }
        from = to;
    }
    shifts
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
