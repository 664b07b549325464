//! The circle or the slanting line by which a line leaves another, fitted to the edge of their ink.
//!
//! With `u = s - s0` after the place `s0` where they meet, the line is `y` away from the body: `y = (u^2 + y^2) / 2R` for a
//! circle that touches it, `y = m u + c u^2 / 2` for a line that meets it at an angle.

use crate::streamline::STEP;

/// A meeting at an angle has to explain the edge better than a touch by this factor.
const ANGLE: f64 = 2.0;
/// Rounds in which what the slope adds to the edge is found.
const ROUNDS: usize = 3;

/// A place beside the body: how far along it, and how far away.
#[derive(Clone, Copy)]
pub(super) struct Sample {
    pub s: f64,
    pub y: f64,
    /// Half the width of the line whose edge was measured, 0 where it was its middle: at a slope the edge is further away,
    /// by the secant.
    pub half: f64,
}

/// How a line leaves the body.
#[derive(Clone, Copy, Debug)]
pub(super) struct Leave {
    /// Where, along the body.
    pub s0: f64,
    pub slope: f64,
    curvature: f64,
    /// Sum of squares.
    pub error: f64,
}

impl Leave {
    /// How much further away the edge is measured than the middle and half a width, for the slope there.
    fn secant(&self, p: &Sample) -> f64 {
        let u = (p.s - self.s0).max(0.0);
        let k = self.curvature * u;
        let slope = if self.slope > 0.0 { self.slope + k } else { k / (1.0 - k * k).max(0.1).sqrt() };
        p.half * ((1.0 + slope * slope).sqrt() - 1.0)
    }

    /// From where on the line's edge lies outside the body's: a slanting line's is ahead of its middle.
    fn first(&self, half: f64) -> f64 {
        if self.slope <= 0.0 {
            return self.s0;
        }
        self.s0 - half * ((1.0 + self.slope * self.slope).sqrt() - 1.0) / self.slope
    }

    /// Distance from the body at a place.
    pub fn at(&self, s: f64) -> f64 {
        let u = s - self.s0;
        if self.slope > 0.0 {
            return self.slope * u + 0.5 * self.curvature * u * u.max(0.0);
        }
        // A circle, as far as it goes.
        let k = self.curvature;
        if k * u < 0.9 { k * u * u / (1.0 + (1.0 - k * k * u * u).sqrt()) } else { 0.5 * k * u * u }
    }
}

/// The best explanation of the samples; `rest` is what `y` measures where only the body is.
pub(super) fn leave(samples: &[Sample], rest: f64) -> Option<Leave> {
    let (first, last) = (samples.first()?.s, samples.iter().map(|s| s.s).fold(f64::MIN, f64::max));
    let count = ((last - first) / STEP) as i64 - 3;
    let starts = (2..count).map(|k| first + STEP * k as f64);
    let both: Vec<[Option<Leave>; 2]> = starts.map(|s0| [touch(samples, s0, rest), angle(samples, s0, rest)]).collect();
    let best = |which: usize| both.iter().filter_map(|l| l[which]).min_by(|a, b| a.error.total_cmp(&b.error));
    match (best(0), best(1)) {
        (Some(touch), Some(angle)) if angle.error * ANGLE < touch.error => Some(angle),
        (touch, angle) => touch.or(angle),
    }
}

/// A circle that touches the body at `s0`.
fn touch(samples: &[Sample], s0: f64, rest: f64) -> Option<Leave> {
    let mut leave = Leave { s0, slope: 0.0, curvature: 0.0, error: 0.0 };
    for _ in 0..ROUNDS {
        let (mut qq, mut qy) = (0.0, 0.0);
        for p in samples.iter().filter(|p| p.s > s0) {
            let y = p.y - leave.secant(p);
            let q = 0.5 * ((p.s - s0).powi(2) + y * y);
            (qq, qy) = (qq + q * q, qy + q * y);
        }
        leave.curvature = qy / qq;
        if leave.curvature.is_nan() || leave.curvature <= 0.0 {
            return None;
        }
    }
    Some(with_error(samples, rest, leave))
}

/// A line that meets the body at `s0` at an angle.
fn angle(samples: &[Sample], s0: f64, rest: f64) -> Option<Leave> {
    let mut leave = Leave { s0, slope: 0.0, curvature: 0.0, error: 0.0 };
    for _ in 0..ROUNDS {
        let (mut uu, mut uq, mut qq, mut uy, mut qy) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for p in samples.iter().filter(|p| p.s > leave.first(p.half)) {
            let (u, y) = (p.s - s0, p.y - leave.secant(p));
            let q = 0.5 * u * u;
            (uu, uq, qq, uy, qy) = (uu + u * u, uq + u * q, qq + q * q, uy + u * y, qy + q * y);
        }
        let det = uu * qq - uq * uq;
        if det < 1e-9 {
            return None;
        }
        (leave.slope, leave.curvature) = ((uy * qq - qy * uq) / det, (qy * uu - uy * uq) / det);
        if leave.slope <= 0.0 {
            return None;
        }
    }
    Some(with_error(samples, rest, leave))
}

fn with_error(samples: &[Sample], rest: f64, leave: Leave) -> Leave {
    let at = |p: &Sample| if p.s > leave.first(p.half) { (leave.at(p.s) + leave.secant(p)).max(rest) } else { rest };
    Leave { error: samples.iter().map(|p| (p.y - at(p)).powi(2)).sum(), ..leave }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The middle of a line beside a body of its own width, measured from before it leaves to well after.
    fn samples(y: impl Fn(f64) -> f64) -> Vec<Sample> {
        (-20..40).map(|k| STEP * f64::from(k)).map(|s| Sample { s, y: y(s), half: 0.0 }).collect()
    }

    #[test]
    fn a_circle_leaves_where_it_touches() {
        for radius in [25.0f64, 45.0, 90.0] {
            for s0 in [-3.0, 0.0, 2.2] {
                let found = samples(|s| radius - (radius.powi(2) - (s - s0).max(0.0).powi(2)).sqrt());
                let leave = leave(&found, 0.0).expect("a touch");
                assert!((leave.s0 - s0).abs() < 1.0 && leave.slope < 0.05, "{radius} {s0}: {leave:?}");
                assert!((leave.curvature * radius - 1.0).abs() < 0.15, "{radius} {s0}: {leave:?}");
            }
        }
    }

    #[test]
    fn a_slanting_line_leaves_at_its_angle() {
        for slope in [0.15, 0.3, 0.45] {
            for s0 in [-3.0, 0.0, 2.2] {
                let leave = leave(&samples(|s| slope * (s - s0).max(0.0)), 0.0).expect("a meeting");
                assert!((leave.s0 - s0).abs() < 0.5 && (leave.slope - slope).abs() < 0.05, "{slope} {s0}: {leave:?}");
            }
        }
    }

    #[test]
    fn a_line_that_stays_beside_leaves_nowhere() {
        let beside = samples(|_| 0.0);
        assert!(leave(&beside, 0.0).is_none_or(|leave| leave.at(19.0).abs() < 0.1));
        assert!(leave(&beside[..3], 0.0).is_none());
    }
}
