//! Arcs that round the corner between two lines, as drawing programs make them.
//!
//! The centre of a circle that touches two lines is a radius away from both: two equations, linear in centre and radius,
//! that leave one degree of freedom, which the points between the lines decide.

use super::Tolerance;
use super::arc::fit_circle;
use super::line::fit_line;
use super::samples::Samples;
use super::segmentation::{Kind, MOST_SWEEP, Piece};
use kurbo::{Point, Vec2};

/// Points may lie this far off an arc, root mean square in pixels, whatever else is taken for noise: rasterisers draw
/// curves as chords.
pub(super) const CHORDS: f64 = 0.12;
/// Lines that turn by less than this (8 degrees) have no corner to round.
const LEAST_TURN: f64 = 0.14;
/// The most pieces that one fillet replaces.
const REPLACED: usize = 4;
const ROUNDS: usize = 6;

/// A line to touch: a point on it and its unit direction.
pub(super) type Tangent = (Point, Vec2);

/// A circle that touches two lines.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fillet {
    centre: Point,
    radius: f64,
    /// Where it leaves the first line and reaches the second.
    pub start: Point,
    pub end: Point,
}

/// The circle that touches both lines and best keeps to the samples between them, `from..=to`.
///
/// `None` where the lines hardly turn or no circle on the inner side of the corner touches them.
pub(super) fn fit_fillet(samples: &Samples, lines: [Tangent; 2], from: usize, to: usize) -> Option<Fillet> {
    let [(p, d), (q, e)] = lines;
    if d.cross(e).atan2(d.dot(e)).abs() < LEAST_TURN {
        return None;
    }
    let seed = fit_circle(samples, from, to)?;
    let side = d.cross(samples.points[(from + to) / 2] - p).signum();
    let (m, n) = (d.turn_90() * side, e.turn_90() * side);
    // m (c - p) = r and n (c - q) = r: the solution nearest to the free circle, and the direction of all others.
    let (off_p, off_q) = (m.dot(seed.centre - p) - seed.radius, n.dot(seed.centre - q) - seed.radius);
    let both = m.dot(n) + 1.0;
    let det = 4.0 - both * both;
    let (a, b) = ((both * off_q - 2.0 * off_p) / det, (both * off_p - 2.0 * off_q) / det);
    let (mut centre, mut radius) = (seed.centre + m * a + n * b, seed.radius - a - b);
    let (along, growth) = (Vec2::new(n.y - m.y, m.x - n.x), m.cross(n));
    let length = (along.hypot2() + growth * growth).sqrt();
    let (along, growth) = (along / length, growth / length);
    for _ in 0..ROUNDS {
        let (mut slope, mut curvature) = (0.0, 0.0);
        for k in from..=to {
            let out = samples.points[k] - centre;
            let distance = out.hypot().max(1e-9);
            let change = out.dot(along) / distance + growth;
            slope += samples.weights[k] * change * (distance - radius);
            curvature += samples.weights[k] * change * change;
        }
        let step = slope / curvature.max(1e-9);
        centre += along * step;
        radius += growth * step;
    }
    let fillet = Fillet { centre, radius, start: centre - m * radius, end: centre - n * radius };
    (radius > 0.0 && radius.is_finite()).then_some(fillet)
}

/// Replaces curves between two lines by one arc where a fillet explains the points, and all curves in a row by one where
/// a circle does.
pub(super) fn rounded(samples: &Samples, pieces: &[Piece], closed: bool, tolerance: Tolerance) -> Vec<Piece> {
    let limit = tolerance.deviation(samples).max(CHORDS);
    let mut pieces = pieces.to_vec();
    let mut k = 0;
    while k < pieces.len() {
        let curves = pieces[k + 1..].iter().take_while(|p| p.kind != Kind::Line).count();
        let next = k + 1 + curves;
        // A closed section starts with a line if it has any.
        let after = if next < pieces.len() { next } else { 0 };
        let has_corner = pieces[k].kind == Kind::Line && (1..=REPLACED).contains(&curves);
        if has_corner
            && (after > 0 || (closed && k > 0 && pieces[0].kind == Kind::Line))
            && let Some([start, end]) = replaced(samples, pieces[k], pieces[after], pieces[next - 1].to, limit)
        {
            pieces[k].to = start;
            if after > 0 {
                pieces[after].from = end;
            }
            pieces.splice(k + 1..next, [Piece { from: start, to: end, kind: Kind::Arc }]);
            k += 2;
        } else {
            let first = k + usize::from(pieces[k].kind == Kind::Line);
            if first < next && is_arc(samples, pieces[first].from, pieces[next - 1].to, limit) {
                let (from, to) = (pieces[first].from, pieces[next - 1].to);
                pieces.splice(first..next, [Piece { from, to, kind: Kind::Arc }]);
                k = first + 1;
            } else {
                k = next;
            }
        }
    }
    pieces
}

/// Whether one circle explains the samples `from..=to`.
fn is_arc(samples: &Samples, from: usize, to: usize, limit: f64) -> bool {
    let Some(circle) = fit_circle(samples, from, to) else { return false };
    let sweep = (samples.arc[to] - samples.arc[from]) / circle.radius;
    let off = |_, p: Point| (p - circle.centre).hypot() - circle.radius;
    sweep < MOST_SWEEP && samples.keep_to(from..=to, limit, off)
}

/// The samples at which a fillet between two lines starts and ends, if it explains all between them up to `to`.
fn replaced(samples: &Samples, first: Piece, last: Piece, to: usize, limit: f64) -> Option<[usize; 2]> {
    let lines = [first, last].map(|line| fit_line(samples, line.from, line.to)).map(|l| (l.point, l.direction));
    let fillet = fit_fillet(samples, lines, first.to, to)?;
    let window = first.from..=last.to.max(to);
    let start = window.clone().find(|&k| (samples.points[k] - fillet.start).dot(lines[0].1) >= 0.0)?;
    let end = window.rev().find(|&k| (samples.points[k] - fillet.end).dot(lines[1].1) <= 0.0)?;
    if start <= first.from || end == last.to || end < start + 3 {
        return None;
    }
    let off = |k: usize, p: Point| match k {
        _ if k < start => (p - lines[0].0).cross(lines[0].1),
        _ if k > end => (p - lines[1].0).cross(lines[1].1),
        _ => (p - fillet.centre).hypot() - fillet.radius,
    };
    let fits = samples.keep_to(first.to.min(start)..=to.max(end), limit, off);
    fits.then_some([start, end])
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    const TOLERANCE: Tolerance = Tolerance { fit: 0.3, width: 3.0, steadiness: 0.08, pixel: 1.0 };

    /// Two lines that turn by an angle with an arc of a radius between them, points half a pixel apart, each off the
    /// course by up to `noise` as if rasterised; and where the arc starts and ends, as numbers of points.
    fn bend(turn: f64, radius: f64, noise: f64) -> (Samples, [usize; 2]) {
        let along = Vec2::from_angle(0.3);
        let centre = Point::ORIGIN + along.turn_90() * radius * turn.signum();
        let length = radius * turn.abs();
        let end = Vec2::from_angle(0.3 + turn);
        let at = |s: f64| match s {
            _ if s < 0.0 => (Point::ORIGIN + along * s, along.turn_90()),
            _ if s > length => (centre - end.turn_90() * radius * turn.signum() + end * (s - length), end.turn_90()),
            _ => {
                let normal = Vec2::from_angle(0.3 + turn * s / length).turn_90();
                (centre - normal * radius * turn.signum(), normal)
            }
        };
        let count = (length / 0.5) as i32 + 80;
        let point = |k: i32| {
            let (p, normal) = at(0.5 * f64::from(k));
            p + normal * noise * (1.7 * f64::from(k)).sin()
        };
        let points: Vec<Point> = (-80..count).map(point).collect();
        let n = points.len();
        (Samples::new(points, vec![1.0; n]), [80, n - 80])
    }

    #[test]
    fn a_fillet_touches_both_lines_at_any_turn() {
        for turn in [0.3, 0.8, 1.57, 2.4, 3.0, PI] {
            for radius in [8.0, 20.0, 60.0] {
                for (turn, noise) in [(turn, 0.0), (-turn, 0.1)] {
                    let (samples, [start, end]) = bend(turn, radius, noise);
                    let lines = [(0, start), (end, samples.len() - 1)].map(|(a, b)| fit_line(&samples, a, b));
                    let fillet = fit_fillet(&samples, lines.map(|l| (l.point, l.direction)), start, end).unwrap();
                    let off =
                        (fillet.start - samples.points[start]).hypot().max((fillet.end - samples.points[end]).hypot());
                    // At a small turn the place along the lines is hardly determined.
                    assert!((fillet.radius / radius - 1.0).abs() < 0.02 + noise * 0.6, "{turn} {radius}: {fillet:?}");
                    assert!(off < 0.6 + 2.0 * noise, "{turn} {radius} {noise}: {off}");
                }
            }
        }
    }

    #[test]
    fn curves_in_a_row_become_the_one_arc_that_they_are() {
        for turn in [0.8, 1.57, -2.4, PI] {
            let (samples, [start, end]) = bend(turn, 24.0, 0.08);
            let last = samples.len() - 1;
            let middle = (start + end) / 2;
            // As a segmentation finds them: the lines reach a little into the arc, which falls into two curves.
            let piece = |from, to, kind| Piece { from, to, kind };
            let (a, b) = (start + 3, end - 2);
            let found = [
                piece(0, a, Kind::Line),
                piece(a, middle, Kind::Cubic),
                piece(middle, b, Kind::Arc),
                piece(b, last, Kind::Line),
            ];
            let rounded = rounded(&samples, &found, false, TOLERANCE);
            let kinds: Vec<Kind> = rounded.iter().map(|p| p.kind).collect();
            assert_eq!(kinds, [Kind::Line, Kind::Arc, Kind::Line], "{turn}");
            assert!(rounded.windows(2).all(|w| w[0].to == w[1].from), "{turn}: {rounded:?}");
            assert!(rounded[1].from.abs_diff(start) <= 3 && rounded[1].to.abs_diff(end) <= 3, "{turn}: {rounded:?}");
            // And without lines beside it.
            let bare = super::rounded(&samples, &[found[1], found[2]], false, TOLERANCE);
            assert_eq!(bare.len(), 1, "{turn}: {bare:?}");
        }
    }

    #[test]
    fn an_ellipse_is_not_taken_for_an_arc() {
        let at = |k: i32| Point::new(40.0 * (0.02 * f64::from(k)).cos(), 25.0 * (0.02 * f64::from(k)).sin());
        let samples = Samples::new((0..100).map(at).collect(), vec![1.0; 100]);
        let halves = [(0, 50), (50, 99)].map(|(from, to)| Piece { from, to, kind: Kind::Cubic });
        assert_eq!(rounded(&samples, &halves, false, TOLERANCE).len(), 2);
    }
}
