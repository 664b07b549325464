//! Cubic Beziers by least squares, ends fixed, tangents fixed or free.
//!
//! A first solution takes arc length for parameters (Schneider 1990). Moving parameters to the nearest points and
//! solving again converges slowly, since samples resist sliding along the curve; so later rounds count only the
//! distance across the curve (tangent distance minimisation: Wang, Pottmann & Liu 2006), which converges in a
//! few steps.

use super::price::Offset;
use super::samples::{CLOSER, Samples};
use kurbo::{CubicBez, ParamCurve, ParamCurveDeriv, Point, Vec2};

/// At most this many samples carry a fit; more add nothing that the ink knows.
const CARRIERS: usize = 40;
/// Pieces of a table of a curve's length.
const TABLE: usize = 32;

/// What is known about a cubic's ends.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ends {
    pub start: Point,
    pub end: Point,
    /// Unit tangent at the start, forwards; free when `None`.
    pub start_tangent: Option<Vec2>,
    /// Unit tangent at the end, forwards; free when `None`.
    pub end_tangent: Option<Vec2>,
}

/// A fitted cubic.
#[derive(Clone, Copy, Debug)]
pub(super) struct FittedCubic {
    pub curve: CubicBez,
    /// Weighted sum of squared distances over all samples, estimated from those that carry the fit.
    pub error: f64,
}

/// Share of the distance along the curve that still counts in later rounds, so that each is well posed.
const ALONG: f64 = 0.01;

/// The cubic between given ends with the least weighted squared distance to samples `from..=to`, after `rounds`
/// improvements.
pub(super) fn fit_cubic(samples: &Samples, from: usize, to: usize, ends: &Ends, rounds: usize) -> FittedCubic {
    let stride = (to - from).div_ceil(CARRIERS).max(1);
    let indices: Vec<usize> = (from..to).step_by(stride).skip(1).collect();
    let (first, total) = (samples.arc[from], (samples.arc[to] - samples.arc[from]).max(1e-9));
    let mut parameters: Vec<f64> = indices.iter().map(|&k| (samples.arc[k] - first) / total).collect();
    let mut curve = solve(samples, &indices, &parameters, ends, None, 1e-4);
    reparametrise(samples, &indices, &mut parameters, &curve);
    let mut error = squared_distance(samples, &indices, &parameters, &curve);
    let mut damping = 1e-3;
    for _ in 0..rounds {
        let candidate = solve(samples, &indices, &parameters, ends, Some(&curve), damping);
        let mut moved = parameters.clone();
        reparametrise(samples, &indices, &mut moved, &candidate);
        let candidate_error = squared_distance(samples, &indices, &moved, &candidate);
        if candidate_error < error {
            (curve, parameters, error) = (candidate, moved, candidate_error);
            damping *= 0.2;
        } else {
            damping *= 10.0;
        }
    }
    FittedCubic { curve, error: error * stride as f64 }
}

impl FittedCubic {
    /// The weighted sum of squared distances over samples `from..=to`, told from more of them than carry a fit: what repeats
    /// along a line can fall between those.
    pub fn closer_error(&self, samples: &Samples, from: usize, to: usize) -> f64 {
        if to - from <= 2 * CARRIERS {
            return self.error;
        }
        self.offsets(samples, from, to).iter().map(|o| o.weight * o.count * o.by * o.by).sum()
    }

    /// Where samples `from..=to` lie beside the curve.
    pub fn offsets(&self, samples: &Samples, from: usize, to: usize) -> Vec<Offset> {
        let stride = (to - from).div_ceil(CLOSER).max(1);
        let indices: Vec<usize> = (from..to).step_by(stride).skip(1).collect();
        let points = (0..=TABLE).map(|i| self.curve.eval(i as f64 / TABLE as f64));
        let along = Samples::lengths(&points.collect::<Vec<Point>>());
        let (first, total) = (samples.arc[from], (samples.arc[to] - samples.arc[from]).max(1e-9));
        let parameter = |&k: &usize| {
            let wanted = along[TABLE] * (samples.arc[k] - first) / total;
            let i = along.partition_point(|&a| a < wanted).clamp(1, TABLE);
            let part = (wanted - along[i - 1]) / (along[i] - along[i - 1]).max(1e-12);
            (i as f64 - 1.0 + part.clamp(0.0, 1.0)) / TABLE as f64
        };
        let mut parameters: Vec<f64> = indices.iter().map(parameter).collect();
        reparametrise(samples, &indices, &mut parameters, &self.curve);
        let slope = self.curve.deriv();
        let offset = |(&k, &t): (&usize, &f64)| {
            let off = samples.points[k] - self.curve.eval(t);
            let side = slope.eval(t).to_vec2().cross(off).signum();
            Offset { weight: samples.weights[k], count: stride as f64, by: side * off.hypot() }
        };
        indices.iter().zip(&parameters).map(offset).collect()
    }
}

fn squared_distance(samples: &Samples, indices: &[usize], parameters: &[f64], curve: &CubicBez) -> f64 {
    let each = indices.iter().zip(parameters);
    each.map(|(&k, &t)| samples.weights[k] * (curve.eval(t) - samples.points[k]).hypot2()).sum()
}

/// Least squares for the inner control points.
///
/// With the `last` curve, distances count across it; without, in all directions. `damping` holds the control
/// points to the last curve's (Levenberg-Marquardt).
fn solve(
    samples: &Samples,
    indices: &[usize],
    parameters: &[f64],
    ends: &Ends,
    last: Option<&CubicBez>,
    damping: f64,
) -> CubicBez {
    let chord = ends.end - ends.start;
    let third = chord.hypot() / 3.0;
    // Unknowns: along a fixed tangent one length, at a free end both coordinates; solved as one 4x4 system in
    // (p1, p2) with fixed tangents as stiff constraints across them.
    let slope = last.map(ParamCurveDeriv::deriv);
    // For `b1 b1`, `b1 b2` and `b2 b2`: their sums times the parts of the projection; then the right-hand sides.
    let (mut products, mut seen) = ([[0.0; 3]; 3], [Vec2::ZERO; 2]);
    for (&k, &t) in indices.iter().zip(parameters) {
        let w = samples.weights[k];
        let s = 1.0 - t;
        let (b0, b1, b2, b3) = (s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t);
        let fixed = ends.start.to_vec2() * b0 + ends.end.to_vec2() * b3;
        let rest = samples.points[k].to_vec2() - fixed;
        let (xx, xy, yy) = match &slope {
            None => (1.0, 0.0, 1.0),
            Some(slope) => {
                let d = slope.eval(t).to_vec2();
                let d = if d.hypot2() > 1e-18 { d } else { chord };
                let along = (1.0 - ALONG) / d.hypot2();
                (1.0 - along * d.x * d.x, -along * d.x * d.y, 1.0 - along * d.y * d.y)
            }
        };
        for (sums, b) in products.iter_mut().zip([b1 * b1, b1 * b2, b2 * b2]) {
            let weight = w * b;
            *sums = [sums[0] + weight * xx, sums[1] + weight * xy, sums[2] + weight * yy];
        }
        let projected = Vec2::new(xx * rest.x + xy * rest.y, xy * rest.x + yy * rest.y);
        seen = [seen[0] + projected * (w * b1), seen[1] + projected * (w * b2)];
    }
    let mut system = [[0.0; 5]; 4];
    for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
        let [xx, xy, yy] = products[i + j];
        (system[2 * i][2 * j], system[2 * i][2 * j + 1]) = (xx, xy);
        (system[2 * i + 1][2 * j], system[2 * i + 1][2 * j + 1]) = (xy, yy);
        (system[2 * i][4], system[2 * i + 1][4]) = (seen[i].x, seen[i].y);
    }
    let scale = system.iter().enumerate().map(|(i, row)| row[i]).fold(1e-9, f64::max);
    // A weak pull to the last curve, or to the thirds of the chord, keeps the system well posed.
    let anchors = last.map_or([ends.start + chord / 3.0, ends.end - chord / 3.0], |c| [c.p1, c.p2]);
    for (i, p) in anchors.iter().enumerate() {
        for (axis, v) in [p.x, p.y].into_iter().enumerate() {
            system[2 * i + axis][2 * i + axis] += damping * scale;
            system[2 * i + axis][4] += damping * scale * v;
        }
    }
    for (i, (tangent, anchor)) in
        [(ends.start_tangent, ends.start), (ends.end_tangent, ends.end)].into_iter().enumerate()
    {
        if let Some(t) = tangent {
            let n = t.turn_90();
            let (stiff, offset) = (1e6 * scale, n.dot(anchor.to_vec2()));
            let (x, y) = (2 * i, 2 * i + 1);
            system[x][x] += stiff * n.x * n.x;
            system[x][y] += stiff * n.x * n.y;
            system[y][x] += stiff * n.x * n.y;
            system[y][y] += stiff * n.y * n.y;
            system[x][4] += stiff * n.x * offset;
            system[y][4] += stiff * n.y * offset;
        }
    }
    let [x1, y1, x2, y2] = eliminate(system);
    let mut p1 = Point::new(x1, y1);
    let mut p2 = Point::new(x2, y2);
    // Handles on a fixed tangent point forwards and keep to it exactly.
    if let Some(t) = ends.start_tangent {
        p1 = ends.start + t * (p1 - ends.start).dot(t).clamp(0.05 * third, 9.0 * third);
    }
    if let Some(t) = ends.end_tangent {
        p2 = ends.end - t * (ends.end - p2).dot(t).clamp(0.05 * third, 9.0 * third);
    }
    CubicBez::new(ends.start, p1, p2, ends.end)
}

/// Gauss elimination with pivoting of a 4x4 system, right-hand side in the last column.
fn eliminate(mut m: [[f64; 5]; 4]) -> [f64; 4] {
    for i in 0..4 {
        let pivot = (i..4).max_by(|&a, &b| m[a][i].abs().total_cmp(&m[b][i].abs())).unwrap_or(i);
        m.swap(i, pivot);
        for r in i + 1..4 {
            let f = m[r][i] / m[i][i];
            let above = m[i];
            m[r].iter_mut().zip(above).skip(i).for_each(|(v, a)| *v -= f * a);
        }
    }
    let mut x = [0.0; 4];
    for i in (0..4).rev() {
        let sum: f64 = (i + 1..4).map(|c| m[i][c] * x[c]).sum();
        x[i] = (m[i][4] - sum) / m[i][i];
    }
    x
}

/// Moves each parameter to the foot of its sample on the curve, by one Newton step, keeping their order.
fn reparametrise(samples: &Samples, indices: &[usize], parameters: &mut [f64], curve: &CubicBez) {
    let derivative = curve.deriv();
    let second = derivative.deriv();
    let mut least = 0.0;
    for (&k, t) in indices.iter().zip(parameters) {
        let d = curve.eval(*t) - samples.points[k];
        let (d1, d2) = (derivative.eval(*t).to_vec2(), second.eval(*t).to_vec2());
        let slope = d1.dot(d1) + d.dot(d2);
        let moved = if slope > 1e-9 { *t - d.dot(d1) / slope } else { *t };
        *t = moved.clamp(least, 1.0);
        least = *t;
    }
}

/// Unit tangents at both ends of a cubic, forwards; short handles are passed over.
pub(super) fn tangents(curve: &CubicBez) -> (Vec2, Vec2) {
    let direction = |candidates: [Vec2; 3]| {
        candidates.into_iter().find(|d| d.hypot() > 1e-6).map_or(Vec2::new(1.0, 0.0), Vec2::normalize)
    };
    let start = direction([curve.p1 - curve.p0, curve.p2 - curve.p0, curve.p3 - curve.p0]);
    let end = direction([curve.p3 - curve.p2, curve.p3 - curve.p1, curve.p3 - curve.p0]);
    (start, end)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_of_a_cubic_give_the_cubic() {
        for curve in [
            CubicBez::new((0.0, 0.0), (30.0, 5.0), (60.0, -20.0), (100.0, -10.0)),
            CubicBez::new((0.0, 0.0), (10.0, 30.0), (60.0, 40.0), (70.0, 0.0)),
            CubicBez::new((0.0, 0.0), (2.0, 1.0), (90.0, 0.0), (100.0, 3.0)),
        ] {
            let points: Vec<Point> = (0..=200).map(|k| curve.eval(f64::from(k) / 200.0)).collect();
            let samples = Samples::new(points, vec![1.0; 201]);
            let (a, b) = tangents(&curve);
            for fixed in [false, true] {
                let ends = Ends {
                    start: curve.p0,
                    end: curve.p3,
                    start_tangent: fixed.then_some(a),
                    end_tangent: fixed.then_some(b),
                };
                let deviation = |rounds| (fit_cubic(&samples, 0, 200, &ends, rounds).error / 200.0).sqrt();
                let deviations = [1, 4, 12].map(deviation);
                assert!(deviations.is_sorted_by(|a, b| a > b) && deviations[2] < 0.1, "{fixed}: {deviations:?}");
            }
        }
    }
}
