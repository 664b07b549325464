//! A section as the cheapest chain of lines, arcs and cubics.
//!
//! Dynamic programming over knots along the section. A piece costs a fixed price for its kind plus the
//! weighted squared distance of its points in units of the tolerance: a description length, so that neither
//! the number of pieces nor the error is bought at any price of the other.

use super::Tolerance;
use super::arc::fit_circle;
use super::cubic::{Ends, fit_cubic};
use super::line::fit_line;
use super::samples::Samples;
use kurbo::Point;

/// Price of a line, an arc and a cubic.
const LINE: f64 = 4.0;
const ARC: f64 = 5.5;
const CUBIC: f64 = 8.0;
/// A piece that is this much worse than its price is given up, and longer ones from the same knot with it.
const HOPELESS: f64 = 60.0;
/// A cubic that costs less than a line by no more than this is looked at more closely.
const DOUBTFUL: f64 = 80.0;
/// The most knots that a section is given.
const MOST_KNOTS: f64 = 140.0;

/// The kind of a piece.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Line,
    Arc,
    Cubic,
}

/// A piece over samples `from..=to`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece {
    pub from: usize,
    pub to: usize,
    pub kind: Kind,
}

/// The cheapest chain of pieces over all samples. Needs at least two samples.
pub(super) fn segment(samples: &Samples, tolerance: Tolerance) -> Vec<Piece> {
    let knots = knots(samples, tolerance);
    let deviation = tolerance.deviation(samples);
    let mut cost = vec![f64::INFINITY; knots.len()];
    let mut best: Vec<Option<(usize, Kind)>> = vec![None; knots.len()];
    cost[0] = 0.0;
    for i in 0..knots.len() - 1 {
        let mut misses = 0;
        for j in i + 1..knots.len() {
            let worth = cost[j] - cost[i];
            let (price, kind) = cheapest(samples, knots[i], knots[j], tolerance, deviation, worth);
            if cost[i] + price < cost[j] {
                cost[j] = cost[i] + price;
                best[j] = Some((i, kind));
            }
            misses = if price > HOPELESS && worth > CUBIC { misses + 1 } else { 0 };
            if misses >= 3 {
                break;
            }
        }
    }
    let mut pieces = Vec::new();
    let mut j = knots.len() - 1;
    while let Some((i, kind)) = best[j] {
        pieces.push(Piece { from: knots[i], to: knots[j], kind });
        j = i;
    }
    pieces.reverse();
    pieces
}

/// Indices of samples at which pieces may meet: about a line width apart.
fn knots(samples: &Samples, tolerance: Tolerance) -> Vec<usize> {
    let length = samples.length();
    let spacing = (0.8 * tolerance.width).max(1.5).max(length / MOST_KNOTS);
    let count = (length / spacing).round().max(1.0) as usize;
    let last = samples.len() - 1;
    let mut knots = vec![0];
    for k in 1..count {
        let at = length * k as f64 / count as f64;
        let index = samples.arc.partition_point(|&a| a < at);
        if index > knots[knots.len() - 1] && index < last {
            knots.push(index);
        }
    }
    knots.push(last);
    knots
}

/// The cheapest single piece over samples `from..=to`. Fitting a cubic takes by far the longest: it is not tried
/// where even a perfect one would cost more than the piece is worth.
fn cheapest(
    samples: &Samples,
    from: usize,
    to: usize,
    tolerance: Tolerance,
    deviation: f64,
    worth: f64,
) -> (f64, Kind) {
    // Neighbouring points share ink: about one in a line width is independent.
    let independent = (samples.length() / samples.len() as f64 / tolerance.width).min(1.0);
    let price = |base: f64, error: f64| base + error * independent / (deviation * deviation);
    let fitted = fit_line(samples, from, to);
    let mut line = price(LINE, fitted.error);
    if line > ARC
        && let Some(error) = fitted.error_beside_stairs(samples, from, to, tolerance)
    {
        line = line.min(price(LINE, error));
    }
    let mut cheapest = (line, Kind::Line);
    if line <= ARC {
        return cheapest;
    }
    if let Some(circle) = fit_circle(samples, from, to) {
        let length = samples.arc[to] - samples.arc[from];
        let sweep = length / circle.radius;
        let arc = price(ARC, circle.error);
        if arc < cheapest.0 && sweep < 5.5 && circle.radius > 0.3 * tolerance.width {
            cheapest = (arc, Kind::Arc);
        }
    }
    if cheapest.0 <= CUBIC || worth <= CUBIC {
        return cheapest;
    }
    let ends = Ends { start: near(samples, from), end: near(samples, to), start_tangent: None, end_tangent: None };
    let fitted = fit_cubic(samples, from, to, &ends, 2);
    let cubic = price(CUBIC, fitted.error);
    if cubic >= cheapest.0 {
        return cheapest;
    }
    // What repeats along a line must not make it a curve.
    let closely = line < cubic + DOUBTFUL;
    let cubic = if closely { cubic.max(price(CUBIC, fitted.closer_error(samples, from, to))) } else { cubic };
    if cubic < cheapest.0 { (cubic, Kind::Cubic) } else { cheapest }
}

/// A sample smoothed over its nearest neighbours.
pub(super) fn near(samples: &Samples, k: usize) -> Point {
    if k == 0 || k + 1 == samples.len() {
        return samples.points[k];
    }
    let (a, b, c) = (samples.points[k - 1], samples.points[k], samples.points[k + 1]);
    ((a.to_vec2() + 2.0 * b.to_vec2() + c.to_vec2()) / 4.0).to_point()
}
