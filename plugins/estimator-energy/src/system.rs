//! The normal equations of the energy over one connected piece of ink.
//!
//! Unknown `x_i = (c2, c0)` at pixel `i`. With the moments of its edges, the normal's weight `a` and the smoothness `b`,
//! setting the derivative of the energy by `conj(x_i)` to zero gives
//!
//! ```text
//! (1 + a) m0 c2 + (1 - a) conj(m2) c0 + b sum_j (c2_i - c2_j) = -(1 - a) m2
//! (1 - a) m2 c2 + (1 + a) m0       c0 + b sum_j (c0_i - c0_j) = -(1 + a) m4
//! ```
//!
//! over the up to four neighbours `j`: a Hermitian matrix of 2x2 blocks, `D_i` on the diagonal and `-b I` beside it.

use crate::components::{Component, NONE};
use crate::gradient::Moments;
use num_complex::Complex64;
use std::array;

/// `(c2, c0)` of one pixel.
pub(crate) type Pair = [Complex64; 2];

/// `p + k q`.
#[inline]
pub(crate) fn add(p: Pair, k: f64, q: Pair) -> Pair {
    array::from_fn(|i| p[i] + q[i] * k)
}

/// A Hermitian 2x2 matrix `[[a, b], [conj(b), d]]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Block {
    pub(crate) a: f64,
    pub(crate) d: f64,
    pub(crate) b: Complex64,
}

impl Block {
    /// The product with a pair.
    #[inline]
    pub(crate) fn times(&self, p: Pair) -> Pair {
        [p[0] * self.a + self.b * p[1], self.b.conj() * p[0] + p[1] * self.d]
    }

    /// The inverse; the block must be positive definite.
    pub(crate) fn inverse(&self) -> Self {
        let k = 1.0 / (self.a * self.d - self.b.norm_sqr());
        Self { a: self.d * k, d: self.a * k, b: -self.b * k }
    }
}

/// Weights of the energy's terms, in units of the mean edge weight at a side of a pixel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Weights {
    pub(crate) smoothness: f64,
    pub(crate) normal: f64,
}

/// A linear system over one piece.
pub(crate) struct System<'a> {
    /// The neighbours before each pixel.
    pub(crate) before: &'a [[u32; 2]],
    /// The blocks on the diagonal.
    pub(crate) diagonal: Vec<Block>,
    /// `-b`: what couples neighbours is `-smoothness` times the identity.
    pub(crate) smoothness: f64,
    /// The right-hand side.
    pub(crate) right: Vec<Pair>,
}

/// Keeps the matrix positive definite where a piece has no edge at all.
const RIDGE: f64 = 1e-9;

impl<'a> System<'a> {
    /// The system of a piece whose pixels have these edges.
    pub(crate) fn new(piece: &'a Component, edges: &[Moments], weights: &Weights) -> Self {
        let (more, less) = (1.0 + weights.normal, 1.0 - weights.normal);
        let block = |m: &Moments| Block { a: more * m.m0 + RIDGE, d: more * m.m0 + RIDGE, b: m.m2.conj() * less };
        let mut diagonal: Vec<Block> = edges.iter().map(block).collect();
        for (i, before) in piece.before.iter().enumerate() {
            for &j in before.iter().filter(|&&j| j != NONE) {
                for k in [i, j as usize] {
                    diagonal[k].a += weights.smoothness;
                    diagonal[k].d += weights.smoothness;
                }
            }
        }
        let right = edges.iter().map(|m| [m.m2 * -less, m.m4 * -more]).collect();
        Self { before: &piece.before, diagonal, smoothness: weights.smoothness, right }
    }

    /// The product of the matrix with `x`.
    pub(crate) fn apply(&self, x: &[Pair], product: &mut [Pair]) {
        for i in 0..x.len() {
            let mut sum = self.diagonal[i].times(x[i]);
            for &j in self.before[i].iter().filter(|&&j| j != NONE) {
                let j = j as usize;
                sum = add(sum, -self.smoothness, x[j]);
                product[j] = add(product[j], -self.smoothness, x[i]);
            }
            product[i] = sum;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_block_times_its_inverse_is_the_identity() {
        let block = Block { a: 3.0, d: 2.0, b: Complex64::new(0.5, -1.5) };
        let p = [Complex64::new(1.0, 2.0), Complex64::new(-0.3, 0.7)];
        let back = block.times(block.inverse().times(p));
        assert!(back.iter().zip(p).all(|(a, b)| (a - b).norm() < 1e-12));
    }
}
