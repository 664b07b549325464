//! 3x3 convolutions by fewer products: Winograd's minimal filtering, F(2x2, 3x3) (Lavin & Gray 2016).
//!
//! A square of 2x2 outputs takes 16 products for each pair of channels instead of 36: with its 4x4 inputs `d` and the
//! weights `g` it is `A' [(G g G') . (B' d B)] A`, the dot being the product place by place. The sums over channels are
//! taken before the outer `A' .. A`.

use super::conv::Conv;
use super::plane::{BLOCK, Cells, Plane};
use pulp::{Simd, WithSimd};

/// Places of a transformed square.
const PLACES: usize = 16;

/// Squares that are computed together.
const GROUP: usize = 4;

/// The rows of `B'`: the difference, or the sum, of two of four.
const INPUT: [(usize, usize, f32); 4] = [(0, 2, -1.0), (1, 2, 1.0), (2, 1, -1.0), (1, 3, -1.0)];

/// `G g G'` of one 3x3 kernel.
pub(super) fn transformed(g: &[f32]) -> [f32; PLACES] {
    let spread = |[a, b, c]: [f32; 3]| [a, 0.5 * (a + b + c), 0.5 * (a - b + c), c];
    // Down the columns, then along the rows.
    let columns = [0, 1, 2].map(|j| spread([g[j], g[3 + j], g[6 + j]]));
    let rows = [0, 1, 2, 3].map(|i| spread([columns[0][i], columns[1][i], columns[2][i]]));
    std::array::from_fn(|place| rows[place / 4][place % 4])
}

/// A convolution of the active pixels of a plane whose cells have an even number of pixels to a side.
pub(super) struct Squares<'a> {
    pub conv: &'a Conv,
    /// The transformed weights, `[output / BLOCK, PLACES, input, BLOCK]`.
    pub weights: &'a [f32],
    pub from: &'a Plane,
    pub to: &'a mut Plane,
    pub cells: &'a Cells,
    pub side: usize,
}

impl WithSimd for Squares<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        match S::F32_LANES {
            16 => self.groups::<S, 1>(simd),
            8 => self.groups::<S, 2>(simd),
            4 => self.groups::<S, 4>(simd),
            _ => self.groups::<S, 16>(simd),
        }
    }
}

impl Squares<'_> {
    // As for the other convolutions, no closure may stand between here and the arithmetic.
    #[inline(always)]
    fn groups<S: Simd, const V: usize>(self, simd: S) {
        let Self { conv, weights, from, to, cells, side } = self;
        let squares = cells.squares(side);
        let square = PLACES * conv.input;
        let mut inputs = vec![0.0; GROUP * square];
        let mut rows = vec![0.0; 4 * conv.input];
        let mut products = [[0.0; PLACES * BLOCK]; GROUP];
        for group in squares.chunks(GROUP) {
            for (&(x, y), inputs) in group.iter().zip(inputs.chunks_exact_mut(square)) {
                transform(simd, from, (x.into(), y.into()), &mut rows, inputs);
            }
            for (block, weights) in weights.chunks_exact(square * BLOCK).enumerate() {
                multiply::<S, V>(simd, weights, &inputs, &mut products);
                for (&(x, y), products) in group.iter().zip(&products) {
                    put::<S, V>(simd, conv, products, to, block, (x.into(), y.into()));
                }
            }
        }
    }
}

/// `B' d B` of the square at a place, `[PLACES, input]`; `rows` is room for `B' d`.
#[inline(always)]
fn transform<S: Simd>(simd: S, from: &Plane, at: (usize, usize), rows: &mut [f32], inputs: &mut [f32]) {
    let c = from.channels;
    for (i, inputs) in inputs.chunks_exact_mut(4 * c).enumerate() {
        let (a, b, sign) = INPUT[i];
        combine(simd, from.bordered(at.0, at.1 + a, 4), from.bordered(at.0, at.1 + b, 4), sign, rows);
        for (j, inputs) in inputs.chunks_exact_mut(c).enumerate() {
            let (a, b, sign) = INPUT[j];
            combine(simd, &rows[a * c..(a + 1) * c], &rows[b * c..(b + 1) * c], sign, inputs);
        }
    }
}

/// `a + sign b`.
#[inline(always)]
fn combine<S: Simd>(simd: S, a: &[f32], b: &[f32], sign: f32, to: &mut [f32]) {
    let ((a, a_rest), (b, b_rest)) = (S::as_simd_f32s(a), S::as_simd_f32s(b));
    let (to, to_rest) = S::as_mut_simd_f32s(to);
    let signs = simd.splat_f32s(sign);
    for ((to, a), b) in to.iter_mut().zip(a).zip(b) {
        *to = simd.mul_add_e_f32s(signs, *b, *a);
    }
    for ((to, a), b) in to_rest.iter_mut().zip(a_rest).zip(b_rest) {
        *to = a + sign * b;
    }
}

/// The sums over channels of the products of a group with one block of output channels, `[GROUP][PLACES, BLOCK]`.
#[inline(always)]
fn multiply<S: Simd, const V: usize>(
    simd: S,
    weights: &[f32],
    inputs: &[f32],
    products: &mut [[f32; PLACES * BLOCK]; GROUP],
) {
    let square = inputs.len() / GROUP;
    let channels = square / PLACES;
    for (place, weights) in weights.chunks_exact(channels * BLOCK).enumerate() {
        let mut sums = [[simd.splat_f32s(0.0); V]; GROUP];
        let mut values: [&[f32]; GROUP] = [&[]; GROUP];
        for p in 0..GROUP {
            values[p] = &inputs[p * square + place * channels..p * square + (place + 1) * channels];
        }
        for (j, w) in weights.chunks_exact(BLOCK).enumerate() {
            let (w, _) = S::as_simd_f32s(w);
            for p in 0..GROUP {
                let value = simd.splat_f32s(values[p][j]);
                for v in 0..V {
                    sums[p][v] = simd.mul_add_e_f32s(value, w[v], sums[p][v]);
                }
            }
        }
        for p in 0..GROUP {
            let (out, _) = S::as_mut_simd_f32s(&mut products[p][place * BLOCK..(place + 1) * BLOCK]);
            out[..V].copy_from_slice(&sums[p]);
        }
    }
}

/// Writes one block of output channels of a square: `A' m A`, the bias and the ReLU.
#[inline(always)]
fn put<S: Simd, const V: usize>(
    simd: S,
    conv: &Conv,
    products: &[f32],
    to: &mut Plane,
    block: usize,
    at: (usize, usize),
) {
    let (m, _) = S::as_simd_f32s(products);
    let (bias, _) = S::as_simd_f32s(&conv.bias[block * BLOCK..(block + 1) * BLOCK]);
    let zero = simd.splat_f32s(0.0);
    for row in 0..2 {
        let target = to.pixels_mut(at.0, at.1 + row, 2);
        let (left, right) = target.split_at_mut(conv.output);
        let (left, _) = S::as_mut_simd_f32s(&mut left[block * BLOCK..(block + 1) * BLOCK]);
        let (right, _) = S::as_mut_simd_f32s(&mut right[block * BLOCK..(block + 1) * BLOCK]);
        for v in 0..V {
            let mut s = [zero; 4];
            for j in 0..4 {
                let (b, c) = (m[(4 + j) * V + v], m[(8 + j) * V + v]);
                s[j] = if row == 0 {
                    simd.add_f32s(simd.add_f32s(m[j * V + v], b), c)
                } else {
                    simd.sub_f32s(simd.sub_f32s(b, c), m[(12 + j) * V + v])
                };
            }
            let sums = [simd.add_f32s(simd.add_f32s(s[0], s[1]), s[2]), simd.sub_f32s(simd.sub_f32s(s[1], s[2]), s[3])];
            let [a, b] = [simd.add_f32s(sums[0], bias[v]), simd.add_f32s(sums[1], bias[v])];
            left[v] = if conv.relu { simd.max_f32s(a, zero) } else { a };
            right[v] = if conv.relu { simd.max_f32s(b, zero) } else { b };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_transforms_undo_one_another() {
        // One channel, by the formula with plain numbers.
        let d: [f32; 16] = std::array::from_fn(|i| ((i * 7) % 11) as f32 - 4.0);
        let g: [f32; 9] = std::array::from_fn(|i| ((i * 5) % 7) as f32 - 2.0);
        let weights = transformed(&g);
        let input = |k: usize, of: &dyn Fn(usize) -> f32| of(INPUT[k].0) + INPUT[k].2 * of(INPUT[k].1);
        let m = |i: usize, j: usize| weights[4 * i + j] * input(i, &|row| input(j, &|column| d[4 * row + column]));
        let output = |k: usize, of: &dyn Fn(usize) -> f32| {
            if k == 0 { of(0) + of(1) + of(2) } else { of(1) - of(2) - of(3) }
        };
        for (y, x) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let found = output(y, &|i| output(x, &|j| m(i, j)));
            let taps = (0..9).map(|k| g[k] * d[4 * (y + k / 3) + x + k % 3]);
            assert!((found - taps.sum::<f32>()).abs() < 1e-4, "({x}, {y}): {found}");
        }
    }
}
