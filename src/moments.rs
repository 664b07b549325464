//! Moments of gradients to fourth order, and the 2-PolyVector field that fits them best.
//!
//! Around a pixel, an edge of direction `t` (unit complex, normal to the gradient) should be a root of
//! `t^4 + c2 t^2 + c0`. Dividing by `t^2` and writing `p = t^2`, the weighted least squares over all edges
//! nearby, `min sum g |p + c2 + c0 conj(p)|^2`, needs only the moments `m0 = sum g`, `m2 = sum g p`,
//! `m4 = sum g p^2`: a structure tensor (`m0`, `m2`) carried to fourth order. It finds both directions at a
//! crossing where the plain tensor finds their mean. With one direction only, the problem is singular, and a
//! small prior pulls the second root to the normal of the first.

use crate::raster::{Raster, runs};
use num_complex::Complex32;
use std::ops::Range;

/// Sum of squared gradients and its second and fourth moments: `[m0, Re m2, Im m2, Re m4, Im m4]`.
pub(crate) type Moments = [f32; 5];

/// Squared gradients below this are paper.
const FLAT: f32 = 4e-9;

/// Stretches of a row that lie no further apart than this are computed as one.
const NEAR: usize = 8;

/// Averages of moments in Gaussian windows, computed only where they are wanted. Its buffers are reused from image to
/// image.
#[derive(Clone, Debug)]
pub(crate) struct Windows {
    scales: Vec<Scale>,
    /// The moments of one row's own gradients, with a margin.
    gradients: Vec<Moments>,
    /// Whether a pixel of one row is in the column of a window.
    near: Vec<bool>,
    /// A row of what lies outside of the image.
    outside: Vec<Moments>,
    averages: Vec<Moments>,
}

#[derive(Clone, Debug)]
struct Scale {
    /// The window's weights from its middle outwards.
    kernel: Vec<f32>,
    /// Averages along the rows.
    across: Vec<Moments>,
}

impl Windows {
    /// Windows of some standard deviations in pixels, cut at `reach` deviations.
    pub fn new(deviations: &[f64], reach: f64) -> Self {
        let scale = |&sigma: &f64| {
            let last = (reach * sigma).ceil() as usize;
            let weight = |d: usize| (-0.5 * (d as f64 / sigma).powi(2)).exp() as f32;
            let mut kernel: Vec<f32> = (0..=last).map(weight).collect();
            let total = kernel[0] + 2.0 * kernel[1..].iter().sum::<f32>();
            kernel.iter_mut().for_each(|k| *k /= total);
            Scale { kernel, across: Vec::new() }
        };
        let scales = deviations.iter().map(scale).collect();
        Self { scales, gradients: Vec::new(), near: Vec::new(), outside: Vec::new(), averages: Vec::new() }
    }

    /// How far the largest window reaches, in pixels.
    pub fn reach(&self) -> usize {
        self.scales.iter().map(|s| s.kernel.len() - 1).max().unwrap_or(0)
    }

    /// Calls `put(scale, x, y, averages)` for stretches of rows that cover what is wanted: `wanted[y]` are ranges of
    /// columns, in order. Outside of the image there are no gradients.
    pub fn average(
        &mut self,
        ink: &Raster<f32>,
        wanted: &[Vec<Range<usize>>],
        mut put: impl FnMut(usize, usize, usize, &[Moments]),
    ) {
        let (width, height) = ink.size();
        self.outside.resize(width, [0.0; 5]);
        self.averages.resize(width, [0.0; 5]);
        self.scales.iter_mut().for_each(|scale| scale.across.resize(width * height, [0.0; 5]));
        (0..height).for_each(|y| self.along_row(ink, wanted, y));
        let Self { scales, outside, averages, .. } = self;
        let outside: &[Moments] = outside;
        for (y, ranges) in wanted.iter().enumerate() {
            for (k, scale) in scales.iter().enumerate() {
                let row = |v: Option<usize>| match v.filter(|&v| v < height) {
                    Some(v) => &scale.across[v * width..(v + 1) * width],
                    None => outside,
                };
                for range in ranges {
                    let to = &mut averages[..range.len()];
                    weigh(&scale.kernel, to, |d| {
                        let pair = [row(y.checked_sub(d)), row(Some(y + d))];
                        pair.map(|row| &row[range.clone()])
                    });
                    put(k, range.start, y, to);
                }
            }
        }
    }

    /// Averages along a row, wherever a window that is wanted passes through it.
    fn along_row(&mut self, ink: &Raster<f32>, wanted: &[Vec<Range<usize>>], y: usize) {
        let (width, height) = ink.size();
        let margin = self.reach();
        self.near.clear();
        self.near.resize(width, false);
        let rows = &wanted[y.saturating_sub(margin)..(y + margin + 1).min(height)];
        rows.iter().flatten().for_each(|range| self.near[range.clone()].fill(true));
        let stretches = stretches(&self.near);
        if stretches.is_empty() {
            return;
        }
        self.gradients.clear();
        self.gradients.resize(width + 2 * margin, [0.0; 5]);
        for range in &stretches {
            let seen = range.start.saturating_sub(margin)..(range.end + margin).min(width);
            gradients(ink, y, seen.clone(), &mut self.gradients[margin + seen.start..margin + seen.end]);
        }
        for scale in &mut self.scales {
            for range in &stretches {
                let to = &mut scale.across[y * width + range.start..y * width + range.end];
                let shifted = |from: usize| &self.gradients[from + range.start..from + range.end];
                weigh(&scale.kernel, to, |d| [shifted(margin - d), shifted(margin + d)]);
            }
        }
    }
}

/// The runs of a row, those that are near to one another joined.
fn stretches(row: &[bool]) -> Vec<Range<usize>> {
    let mut stretches: Vec<Range<usize>> = Vec::new();
    for run in runs(row) {
        match stretches.last_mut() {
            Some(last) if run.start - last.end <= NEAR => last.end = run.end,
            _ => stretches.push(run),
        }
    }
    stretches
}

/// Weighs pairs of rows, `pair(d)` by `kernel[d]`, and adds them up; the pair of 0 is one row twice and counts once.
fn weigh<'a>(kernel: &[f32], to: &mut [Moments], pair: impl Fn(usize) -> [&'a [Moments]; 2]) {
    // Few enough pixels at a time that the sums stay in registers.
    const PIXELS: usize = 4;
    let whole = to.len() / PIXELS * PIXELS;
    for x in (0..whole).step_by(PIXELS) {
        weigh_some::<{ 5 * PIXELS }>(kernel, to, x, &pair);
    }
    for x in whole..to.len() {
        weigh_some::<5>(kernel, to, x, &pair);
    }
}

#[inline(always)]
fn weigh_some<'a, const N: usize>(
    kernel: &[f32],
    to: &mut [Moments],
    x: usize,
    pair: &impl Fn(usize) -> [&'a [Moments]; 2],
) {
    let numbers = |row: &'a [Moments]| -> &'a [f32; N] {
        row.as_flattened()[5 * x..5 * x + N].try_into().expect("as many numbers as were cut")
    };
    let middle = numbers(pair(0)[0]);
    let mut sum = middle.map(|m| kernel[0] * m);
    for (d, &k) in kernel.iter().enumerate().skip(1) {
        let [a, b] = pair(d).map(numbers);
        for i in 0..N {
            sum[i] += k * (a[i] + b[i]);
        }
    }
    to.as_flattened_mut()[5 * x..5 * x + N].copy_from_slice(&sum);
}

/// Moments of the own gradients of some pixels of a row (Scharr's 3x3 derivative), weighted by their squares; the edge
/// pixels are repeated outside.
fn gradients(ink: &Raster<f32>, y: usize, columns: Range<usize>, to: &mut [Moments]) {
    let (width, height) = ink.size();
    let (above, here, below) = (ink.row(y.saturating_sub(1)), ink.row(y), ink.row((y + 1).min(height - 1)));
    for (x, moments) in columns.zip(to) {
        let (l, r) = (x.saturating_sub(1), (x + 1).min(width - 1));
        let gx = (3.0 * (above[r] - above[l] + below[r] - below[l]) + 10.0 * (here[r] - here[l])) / 16.0;
        let gy = (3.0 * (below[l] - above[l] + below[r] - above[r]) + 10.0 * (below[x] - above[x])) / 16.0;
        let energy = gx * gx + gy * gy;
        if energy >= FLAT {
            // The tangent is the gradient turned by 90 degrees, t = i g, so t^2 = -g^2.
            let t2 = -Complex32::new(gx, gy) * Complex32::new(gx, gy);
            let t4 = t2 * t2 / energy;
            *moments = [energy, t2.re, t2.im, t4.re, t4.im];
        }
    }
}

/// The coefficients that fit the moments best, and a confidence; zeros without gradients.
///
/// `prior` is the weight of the prior that the second direction is normal to the first, as a share of `m0`.
pub(crate) fn fit(m: &Moments, prior: f32) -> (Complex32, Complex32, f32) {
    let zero = Complex32::new(0.0, 0.0);
    let m0 = m[0];
    if m0 < FLAT {
        return (zero, zero, 0.0);
    }
    let (m2, m4) = (Complex32::new(m[1], m[2]) / m0, Complex32::new(m[3], m[4]) / m0);
    let coherence = m2.norm();
    // The prior's c0 is -p^2 for the one direction p: the root -p is the normal. It fades where the
    // plain tensor has no direction to offer.
    let single = if coherence > 1e-6 { -(m2 / coherence) * (m2 / coherence) } else { zero };
    let prior = prior * coherence * coherence;
    // Normal equations of sum |p + c2 + c0 conj(p)|^2 + prior (|c2|^2 + |c0 - single|^2):
    //   (1 + prior) c2 + conj(m2) c0 = -m2
    //   m2 c2 + (1 + prior) c0 = -m4 + prior single
    let a = 1.0 + prior;
    let determinant = a * a - m2.norm_sqr() + 1e-6;
    let (r2, r0) = (-m2, -m4 + single * prior);
    let c2 = (r2 * a - m2.conj() * r0) / determinant;
    let c0 = (r0 * a - m2 * r2) / determinant;
    (c0, c2, coherence.max(m4.norm()).clamp(0.05, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn averages(ink: &Raster<f32>, wanted: &[Vec<Range<usize>>]) -> Vec<Raster<Moments>> {
        let blank = Raster::filled(ink.width(), ink.height(), [f32::NAN; 5]);
        let mut found = vec![blank.clone(), blank];
        Windows::new(&[1.3, 2.6], 3.0).average(ink, wanted, |scale, x, y, averages| {
            averages.iter().enumerate().for_each(|(i, m)| found[scale][(x + i, y)] = *m);
        });
        found
    }

    #[test]
    fn an_average_is_the_same_wherever_else_it_is_wanted() {
        let ink = Raster::from_fn(61, 40, |x, y| ((x * 37 + y * 91 + x * y) % 17) as f32 / 16.0);
        let everywhere = averages(&ink, &vec![std::iter::once(0..61).collect(); 40]);
        let mut wanted = vec![Vec::new(); 40];
        for (y, ranges) in
            [(0, vec![0..3, 50..61]), (7, vec![20..21, 30..31]), (8, vec![20..41, 44..45]), (39, vec![5..9, 12..17])]
        {
            wanted[y] = ranges;
        }
        for (found, all) in averages(&ink, &wanted).iter().zip(&everywhere) {
            for (x, y) in (0..40).flat_map(|y| (0..61).map(move |x| (x, y))) {
                if wanted[y].iter().any(|range| range.contains(&x)) {
                    assert_eq!(found[(x, y)], all[(x, y)], "({x}, {y})");
                } else {
                    assert!(found[(x, y)][0].is_nan());
                }
            }
        }
    }

    #[test]
    fn a_window_adds_up_to_one_inside_and_to_less_at_the_edge() {
        // An even slope has the same gradient everywhere but on the edge.
        let ink = Raster::from_fn(60, 60, |x, y| 0.01 * x as f32 + 0.005 * y as f32);
        for found in averages(&ink, &vec![std::iter::once(0..60).collect(); 60]) {
            let middle = found[(30, 30)];
            // Scharr's kernel takes the difference over two pixels with a weight of 16 in all.
            let energy = 4.0 * (0.01f32.powi(2) + 0.005f32.powi(2));
            assert!((middle[0] / energy - 1.0).abs() < 1e-4, "{middle:?} {energy}");
            assert!(found[(0, 0)][0] < 0.5 * middle[0]);
        }
    }
}
