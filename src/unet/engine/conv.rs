//! Convolutions with the norm folded in.

use super::plane::{BLOCK, Cells, Plane};
use pulp::{Arch, Simd, WithSimd};

/// A 3x3 or 1x1 convolution, a bias, and a ReLU unless it is the head.
#[derive(Clone, Debug)]
pub(super) struct Conv {
    /// Side of the kernel, 1 or 3.
    side: usize,
    input: usize,
    /// Output channels, rounded up to a multiple of [`BLOCK`].
    pub output: usize,
    /// `[output / BLOCK, side, side, input, BLOCK]`.
    weights: Vec<f32>,
    /// `[output]`.
    bias: Vec<f32>,
    relu: bool,
}

impl Conv {
    /// From weights `[output, input, side, side]` and a bias a channel. `source` names, for each stored input channel, the
    /// channel of the weights that reads it; `None` is padding.
    pub fn new(side: usize, weights: &[f32], bias: &[f32], source: &[Option<usize>], relu: bool) -> Self {
        let (taps, output) = (side * side, bias.len());
        let inputs = weights.len() / (output * taps);
        let padded = output.next_multiple_of(BLOCK);
        let mut packed = Vec::with_capacity(padded * source.len() * taps);
        for block in 0..padded / BLOCK {
            for tap in 0..taps {
                for from in source {
                    packed.extend((0..BLOCK).map(|lane| {
                        let o = block * BLOCK + lane;
                        from.filter(|_| o < output).map_or(0.0, |i| weights[(o * inputs + i) * taps + tap])
                    }));
                }
            }
        }
        let mut bias = bias.to_vec();
        bias.resize(padded, 0.0);
        Self { side, input: source.len(), output: padded, weights: packed, bias, relu }
    }

    /// What it gives where all pixels around read the same.
    pub fn of_constant(&self, input: &[f32]) -> Vec<f32> {
        let mut output = self.bias.clone();
        let blocks = self.weights.chunks_exact(self.side * self.side * self.input * BLOCK);
        for (sums, block) in output.chunks_exact_mut(BLOCK).zip(blocks) {
            for (weights, value) in block.chunks_exact(BLOCK).zip(input.iter().cycle()) {
                sums.iter_mut().zip(weights).for_each(|(s, w)| *s += w * value);
            }
        }
        if self.relu {
            output.iter_mut().for_each(|o| *o = o.max(0.0));
        }
        output
    }

    /// Computes the active pixels of `to`, both planes having cells of `side` pixels.
    pub fn run(&self, arch: Arch, from: &Plane, to: &mut Plane, cells: &Cells, side: usize) {
        debug_assert!(from.channels == self.input && to.channels == self.output);
        arch.dispatch(Run { conv: self, from, to, cells, side });
    }
}

struct Run<'a> {
    conv: &'a Conv,
    from: &'a Plane,
    to: &'a mut Plane,
    cells: &'a Cells,
    side: usize,
}

impl WithSimd for Run<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        match S::F32_LANES {
            16 => self.rows::<S, 1>(simd),
            8 => self.rows::<S, 2>(simd),
            4 => self.rows::<S, 4>(simd),
            _ => self.rows::<S, 16>(simd),
        }
    }
}

impl Run<'_> {
    #[inline(always)]
    fn rows<S: Simd, const V: usize>(self, simd: S) {
        let Self { conv, from, to, cells, side } = self;
        // No closure may stand between here and the arithmetic: a call would leave the wide instructions behind.
        let runs = cells.list(side);
        for block in 0..conv.output / BLOCK {
            for &(x, y, n) in &runs {
                let mut done = 0;
                while done + 4 <= n {
                    pixels::<S, 4, V>(simd, conv, from, to, block, x + done, y);
                    done += 4;
                }
                while done < n {
                    pixels::<S, 1, V>(simd, conv, from, to, block, x + done, y);
                    done += 1;
                }
            }
        }
    }
}

/// `P` pixels of one block of output channels, held in `P x V` registers of `BLOCK / V` channels.
#[inline(always)]
fn pixels<S: Simd, const P: usize, const V: usize>(
    simd: S,
    conv: &Conv,
    from: &Plane,
    to: &mut Plane,
    block: usize,
    x: usize,
    y: usize,
) {
    let c = conv.input;
    let reach = conv.side * c;
    let border = usize::from(conv.side == 1);
    let (bias, _) = S::as_simd_f32s(&conv.bias[block * BLOCK..(block + 1) * BLOCK]);
    let mut sums = [[simd.splat_f32s(0.0); V]; P];
    for pixel in &mut sums {
        pixel.copy_from_slice(&bias[..V]);
    }
    let size = conv.side * reach * BLOCK;
    let mut weights = conv.weights[block * size..(block + 1) * size].chunks_exact(reach * BLOCK);
    for row in 0..conv.side {
        let line = from.bordered(x + border, y + row + border, P + conv.side - 1);
        let mut windows: [&[f32]; P] = [&[]; P];
        for p in 0..P {
            windows[p] = &line[p * c..p * c + reach];
        }
        let Some(weights) = weights.next() else { return };
        for (j, w) in weights.chunks_exact(BLOCK).enumerate() {
            let (w, _) = S::as_simd_f32s(w);
            for p in 0..P {
                let value = simd.splat_f32s(windows[p][j]);
                for v in 0..V {
                    sums[p][v] = simd.mul_add_e_f32s(value, w[v], sums[p][v]);
                }
            }
        }
    }
    let zero = simd.splat_f32s(0.0);
    let target = to.pixels_mut(x, y, P);
    for (p, pixel) in sums.iter().enumerate() {
        let at = p * conv.output + block * BLOCK;
        let (out, _) = S::as_mut_simd_f32s(&mut target[at..at + BLOCK]);
        for v in 0..V {
            out[v] = if conv.relu { simd.max_f32s(pixel[v], zero) } else { pixel[v] };
        }
    }
}
