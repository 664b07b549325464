//! Conjugate gradients, preconditioned by an incomplete factorisation.
//!
//! The stencil links a pixel to its left and its upper neighbour only, so the factorisation without fill-in,
//! `(P + L) P^-1 (P + L)^H` with the matrix's own strict lower part `L`, has one 2x2 block `P_i` a pixel to store:
//! `P_i = D_i - b^2 sum_j P_j^-1` over the neighbours `j` before `i`.

use crate::components::NONE;
use crate::system::{Block, Pair, System, add};
use num_complex::Complex64;

/// Solves a system to a residual of `accuracy` times the right-hand side, or as far as `most` iterations go.
/// Returns the solution and the number of iterations.
pub(crate) fn solve(system: &System, accuracy: f64, most: usize) -> (Vec<Pair>, usize) {
    let zero = [Complex64::ZERO; 2];
    let n = system.right.len();
    let factor = Factor::new(system);
    let mut x = vec![zero; n];
    let mut residual = system.right.clone();
    let mut z = vec![zero; n];
    factor.solve(&residual, &mut z);
    let (mut direction, mut product) = (z.clone(), vec![zero; n]);
    let mut rho = dot(&residual, &z);
    let goal = accuracy * accuracy * dot(&residual, &residual);
    for iteration in 0..most {
        if dot(&residual, &residual) <= goal {
            return (x, iteration);
        }
        system.apply(&direction, &mut product);
        let step = rho / dot(&direction, &product);
        for i in 0..n {
            x[i] = add(x[i], step, direction[i]);
            residual[i] = add(residual[i], -step, product[i]);
        }
        factor.solve(&residual, &mut z);
        let next = dot(&residual, &z);
        for (d, z) in direction.iter_mut().zip(&z) {
            *d = add(*z, next / rho, *d);
        }
        rho = next;
    }
    (x, most)
}

/// The real part of the inner product; its imaginary part is 0 wherever it is used here.
fn dot(p: &[Pair], q: &[Pair]) -> f64 {
    let real = |a: Complex64, b: Complex64| a.re * b.re + a.im * b.im;
    p.iter().zip(q).map(|(p, q)| real(p[0], q[0]) + real(p[1], q[1])).sum()
}

/// The incomplete factorisation.
struct Factor<'a> {
    system: &'a System<'a>,
    /// `P_i^-1`.
    inverse: Vec<Block>,
}

impl<'a> Factor<'a> {
    fn new(system: &'a System<'a>) -> Self {
        let mut inverse: Vec<Block> = Vec::with_capacity(system.diagonal.len());
        let k = system.smoothness * system.smoothness;
        for (block, before) in system.diagonal.iter().zip(system.before) {
            let mut p = *block;
            for &j in before.iter().filter(|&&j| j != NONE) {
                let q = inverse[j as usize];
                p = Block { a: p.a - k * q.a, d: p.d - k * q.d, b: p.b - q.b * k };
            }
            inverse.push(p.inverse());
        }
        Self { system, inverse }
    }

    /// `z` such that the factorisation times `z` is `r`: one sweep forward, one back.
    fn solve(&self, r: &[Pair], z: &mut [Pair]) {
        let System { before, smoothness, .. } = *self.system;
        for i in 0..r.len() {
            let mut sum = r[i];
            for &j in before[i].iter().filter(|&&j| j != NONE) {
                sum = add(sum, smoothness, z[j as usize]);
            }
            z[i] = self.inverse[i].times(sum);
        }
        for i in (0..r.len()).rev() {
            // By now every later pixel has sent z[i] what it owes: z_i = y_i + b P_i^-1 sum z_j.
            let z_i = z[i];
            for &j in before[i].iter().filter(|&&j| j != NONE) {
                let j = j as usize;
                z[j] = add(z[j], smoothness, self.inverse[j].times(z_i));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::components::components;
    use crate::gradient::Moments;
    use crate::system::Weights;
    use fieldtrace::raster::Mask;

    #[test]
    fn the_solution_satisfies_the_equations() {
        let mask = Mask::from_fn(40, 30, |x, y| (x + 2 * y) % 7 < 5 && (x, y) != (11, 12));
        for piece in components(&mask) {
            let edge = |&(x, y): &(u32, u32)| {
                let p = Complex64::cis(f64::from(x * 31 + y * 17));
                let w = f64::from((x + 3 * y) % 4);
                Moments { m0: w, m2: p * w, m4: p * p * w }
            };
            let edges: Vec<Moments> = piece.pixels.iter().map(edge).collect();
            let system = System::new(&piece, &edges, &Weights { smoothness: 6.0, normal: 0.01 });
            let (x, iterations) = solve(&system, 1e-10, 1000);
            assert!(iterations < 200, "{iterations}");
            let mut product = vec![[Complex64::ZERO; 2]; x.len()];
            system.apply(&x, &mut product);
            for (a, b) in product.iter().zip(&system.right) {
                assert!((a[0] - b[0]).norm() + (a[1] - b[1]).norm() < 1e-6);
            }
        }
    }

    #[test]
    fn nothing_asked_is_nothing_done() {
        let mask = Mask::filled(1, 1, true);
        let piece = &components(&mask)[0];
        let system = System::new(piece, &[Moments::default()], &Weights { smoothness: 6.0, normal: 0.01 });
        assert_eq!(solve(&system, 1e-4, 10), (vec![[Complex64::ZERO; 2]], 0));
    }
}
