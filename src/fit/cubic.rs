//! Cubic Beziers by least squares (Schneider 1990), ends fixed, tangents fixed or free.

use super::samples::Samples;
use kurbo::{CubicBez, ParamCurve, ParamCurveDeriv, Point, Vec2};

/// At most this many samples carry a fit; more add nothing that the ink knows.
const CARRIERS: usize = 40;

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

/// The cubic between given ends with the least weighted squared distance to samples `from..=to`.
///
/// Parameters start as arc length and are moved to the nearest points of the curve `rounds` times.
pub(super) fn fit_cubic(samples: &Samples, from: usize, to: usize, ends: &Ends, rounds: usize) -> FittedCubic {
    let stride = (to - from).div_ceil(CARRIERS).max(1);
    let indices: Vec<usize> = (from..to).step_by(stride).skip(1).collect();
    let (first, total) = (samples.arc[from], (samples.arc[to] - samples.arc[from]).max(1e-9));
    let mut parameters: Vec<f64> = indices.iter().map(|&k| (samples.arc[k] - first) / total).collect();
    let mut curve = solve(samples, &indices, &parameters, ends);
    for _ in 0..rounds {
        reparametrise(samples, &indices, &mut parameters, &curve);
        curve = solve(samples, &indices, &parameters, ends);
    }
    let each = indices.iter().zip(&parameters);
    let error: f64 = each.map(|(&k, &t)| samples.weights[k] * (curve.eval(t) - samples.points[k]).hypot2()).sum();
    FittedCubic { curve, error: error * stride as f64 }
}

/// Least squares for the inner control points.
fn solve(samples: &Samples, indices: &[usize], parameters: &[f64], ends: &Ends) -> CubicBez {
    let chord = ends.end - ends.start;
    let third = chord.hypot() / 3.0;
    // Unknowns: along a fixed tangent one length, at a free end both coordinates; solved as one 4x4 system in
    // (p1, p2) with fixed tangents as stiff constraints across them.
    let mut system = [[0.0; 5]; 4];
    for (&k, &t) in indices.iter().zip(parameters) {
        let w = samples.weights[k];
        let s = 1.0 - t;
        let (b0, b1, b2, b3) = (s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t);
        let fixed = ends.start.to_vec2() * b0 + ends.end.to_vec2() * b3;
        let rest = samples.points[k].to_vec2() - fixed;
        for (row, (a, r)) in [(b1, rest.x), (b1, rest.y), (b2, rest.x), (b2, rest.y)].into_iter().enumerate() {
            let axis = row % 2;
            system[row][axis] += w * a * b1;
            system[row][2 + axis] += w * a * b2;
            system[row][4] += w * a * r;
        }
    }
    let scale = system.iter().enumerate().map(|(i, row)| row[i]).fold(1e-9, f64::max);
    // A weak pull to the thirds of the chord keeps short pieces from degenerating.
    let thirds = [ends.start + chord / 3.0, ends.end - chord / 3.0];
    for (i, p) in thirds.iter().enumerate() {
        for (axis, v) in [p.x, p.y].into_iter().enumerate() {
            system[2 * i + axis][2 * i + axis] += 1e-4 * scale;
            system[2 * i + axis][4] += 1e-4 * scale * v;
        }
    }
    for (i, (tangent, anchor)) in [(ends.start_tangent, ends.start), (ends.end_tangent, ends.end)].into_iter().enumerate() {
        if let Some(t) = tangent {
            let n = Vec2::new(-t.y, t.x);
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
            for c in i..5 {
                m[r][c] -= f * m[i][c];
            }
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
