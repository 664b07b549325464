//! A section as the cheapest chain of lines, arcs and cubics.
//!
//! Dynamic programming over knots along the section. A piece costs a fixed price for its kind plus what it takes to tell
//! where its points lie beside it (`price`): a description length, so that neither the number of pieces nor the error is
//! bought at any price of the other.
//!
//! A hand trembles, and what it draws then falls into many pieces. So a section of more than a few is looked at again,
//! between the joints that were found: a wave beside a piece is told by its height where that is cheaper than its points.

use super::Tolerance;
use super::arc::fit_circle;
use super::cubic::{Ends, fit_cubic};
use super::line::fit_line;
use super::price::{Misfit, Offset, Prices};
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
/// One arc turns by less than this, radians.
pub(super) const MOST_SWEEP: f64 = 5.5;

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
    let prices = Prices::new(samples, tolerance);
    let (pieces, cost) = chain(samples, &knots(samples, &prices, tolerance), &prices, tolerance);
    if pieces.len() < 2 {
        return pieces;
    }
    let joints: Vec<usize> = pieces.iter().map(|p| p.from).chain([samples.len() - 1]).collect();
    let (calmer, less) = chain(samples, &joints, &prices.with_tremor(), tolerance);
    if less < cost { calmer } else { pieces }
}

/// The cheapest chain of pieces that meet at knots, and its cost.
fn chain(samples: &Samples, knots: &[usize], prices: &Prices, tolerance: Tolerance) -> (Vec<Piece>, f64) {
    let mut cost = vec![f64::INFINITY; knots.len()];
    let mut best: Vec<Option<(usize, Kind)>> = vec![None; knots.len()];
    cost[0] = 0.0;
    for i in 0..knots.len() - 1 {
        let mut misses = 0;
        for j in i + 1..knots.len() {
            let worth = cost[j] - cost[i];
            let (price, kind) = cheapest(samples, knots[i], knots[j], prices, tolerance, worth);
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
    (pieces, cost[knots.len() - 1])
}

/// Indices of samples at which pieces may meet: about a line width apart, or further on a long section. There, where no
/// piece fits between two, they are as near as on a short one.
fn knots(samples: &Samples, prices: &Prices, tolerance: Tolerance) -> Vec<usize> {
    let finest = (0.8 * tolerance.width).max(1.5);
    let length = samples.length();
    let count = (length / finest.max(length / MOST_KNOTS)).round().max(1.0) as usize;
    let last = samples.len() - 1;
    let mut coarse = vec![0];
    for k in 1..count {
        let at = length * k as f64 / count as f64;
        let index = samples.arc.partition_point(|&a| a < at);
        if index > coarse[coarse.len() - 1] && index < last {
            coarse.push(index);
        }
    }
    coarse.push(last);
    let mut knots = vec![0];
    coarse.windows(2).for_each(|w| halve(samples, [w[0], w[1]], prices, tolerance, finest, &mut knots));
    knots
}

/// Adds the end of an interval to the knots, and before it those of its halves if no piece fits it.
fn halve(
    samples: &Samples,
    [from, to]: [usize; 2],
    prices: &Prices,
    tolerance: Tolerance,
    finest: f64,
    knots: &mut Vec<usize>,
) {
    let (start, end) = (samples.arc[from], samples.arc[to]);
    let middle = samples.arc.partition_point(|&a| a < 0.5 * (start + end));
    let can = end - start > 2.0 * finest && from < middle && middle < to;
    if can && cheapest(samples, from, to, prices, tolerance, f64::INFINITY).0 > HOPELESS {
        halve(samples, [from, middle], prices, tolerance, finest, knots);
        halve(samples, [middle, to], prices, tolerance, finest, knots);
    } else {
        knots.push(to);
    }
}

/// The cheapest single piece over samples `from..=to`. Fitting a cubic takes by far the longest: it is not tried
/// where even a perfect one would cost more than the piece is worth.
fn cheapest(
    samples: &Samples,
    from: usize,
    to: usize,
    prices: &Prices,
    tolerance: Tolerance,
    worth: f64,
) -> (f64, Kind) {
    let weight = samples.moments(from, to).w;
    let price =
        |prices: &Prices, error: f64, offsets: &dyn Fn() -> Vec<Offset>| prices.of(Misfit { error, weight }, offsets);
    let fitted = fit_line(samples, from, to);
    let line = LINE + price(&prices.of_lines(), fitted.error, &|| samples.offsets(from, to, |p| fitted.offset(p)));
    let mut cheapest = (line, Kind::Line);
    if line <= ARC {
        return cheapest;
    }
    if let Some(circle) = fit_circle(samples, from, to)
        && circle.radius > 0.3 * tolerance.width
        && samples.arc[to] - samples.arc[from] < MOST_SWEEP * circle.radius
    {
        let arc = ARC + price(prices, circle.error, &|| samples.offsets(from, to, |p| circle.offset(p)));
        if arc < cheapest.0 {
            cheapest = (arc, Kind::Arc);
        }
    }
    if cheapest.0 <= CUBIC || worth <= CUBIC {
        return cheapest;
    }
    let ends = Ends { start: near(samples, from), end: near(samples, to), start_tangent: None, end_tangent: None };
    let fitted = fit_cubic(samples, from, to, &ends, 2);
    let of_error = |error: f64| CUBIC + price(prices, error, &|| fitted.offsets(samples, from, to));
    let cubic = of_error(fitted.error);
    if cubic >= cheapest.0 {
        return cheapest;
    }
    // What repeats along a line must not make it a curve.
    let closely = line < cubic + DOUBTFUL;
    let cubic = if closely { cubic.max(of_error(fitted.closer_error(samples, from, to))) } else { cubic };
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
