//! Convolutions with the norm folded in.

use super::plane::{BLOCK, Cells, Plane};
use super::squares::{Squares, transformed};
use pulp::{Arch, Simd, WithSimd};

/// A 3x3 or 1x1 convolution, a bias, and a ReLU unless it is the head.
#[derive(Clone, Debug)]
pub(super) struct Conv {
    /// Side of the kernel, 1 or 3.
    side: usize,
    /// Input channels.
    pub input: usize,
    /// Output channels, rounded up to a multiple of [`BLOCK`].
    pub output: usize,
    /// `[output / BLOCK, side, side, input, BLOCK]`.
    weights: Vec<f32>,
    /// The weights of [`Squares`]; none for a side of 1.
    squares: Vec<f32>,
    /// `[output]`.
    pub bias: Vec<f32>,
    /// Whether negative outputs are cut off.
    pub relu: bool,
}

impl Conv {
    /// From weights `[output, input, side, side]` and a bias a channel. `source` names, for each stored input channel, the
    /// channel of the weights that reads it; `None` is padding.
    pub fn new(side: usize, weights: &[f32], bias: &[f32], source: &[Option<usize>], relu: bool) -> Self {
        let (taps, output) = (side * side, bias.len());
        let inputs = weights.len() / (output * taps);
        let padded = output.next_multiple_of(BLOCK);
        // `[output, input, places]` as `[output / BLOCK, places, input, BLOCK]`.
        let packed = |weights: &[f32], places: usize| {
            let mut packed = Vec::with_capacity(padded * source.len() * places);
            for (block, place) in (0..padded / BLOCK).flat_map(|block| (0..places).map(move |place| (block, place))) {
                for from in source {
                    packed.extend((0..BLOCK).map(|lane| {
                        let o = block * BLOCK + lane;
                        from.filter(|_| o < output).map_or(0.0, |i| weights[(o * inputs + i) * places + place])
                    }));
                }
            }
            packed
        };
        let squares: Vec<f32> =
            if side == 3 { weights.chunks_exact(taps).flat_map(transformed).collect() } else { Vec::new() };
        let squares = if side == 3 { packed(&squares, 16) } else { squares };
        let mut bias = bias.to_vec();
        bias.resize(padded, 0.0);
        Self { side, input: source.len(), output: padded, weights: packed(weights, taps), squares, bias, relu }
    }

    /// Computes the active pixels of `to`, both planes having cells of `side` pixels.
    pub fn run(&self, arch: Arch, from: &Plane, to: &mut Plane, cells: &Cells, side: usize) {
        debug_assert!(from.channels == self.input && to.channels == self.output);
        if self.side == 3 && side.is_multiple_of(2) {
            arch.dispatch(Squares { conv: self, weights: &self.squares, from, to, cells, side });
        } else {
            arch.dispatch(Run { conv: self, from, to, cells, side });
        }
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
        let places = cells.places(side);
        for block in 0..conv.output / BLOCK {
            let mut rest = places.as_slice();
            while let Some((group, others)) = rest.split_first_chunk::<4>() {
                pixels::<S, 4, V>(simd, conv, from, to, block, group);
                rest = others;
            }
            for &place in rest {
                pixels::<S, 1, V>(simd, conv, from, to, block, &[place]);
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
    places: &[(u16, u16); P],
) {
    let reach = conv.side * conv.input;
    let border = usize::from(conv.side == 1);
    let (bias, _) = S::as_simd_f32s(&conv.bias[block * BLOCK..(block + 1) * BLOCK]);
    let mut sums = [[simd.splat_f32s(0.0); V]; P];
    for pixel in &mut sums {
        pixel.copy_from_slice(&bias[..V]);
    }
    let size = conv.side * reach * BLOCK;
    let mut weights = conv.weights[block * size..(block + 1) * size].chunks_exact(reach * BLOCK);
    for row in 0..conv.side {
        let mut windows: [&[f32]; P] = [&[]; P];
        for p in 0..P {
            let (x, y) = (usize::from(places[p].0), usize::from(places[p].1));
            windows[p] = from.bordered(x + border, y + row + border, conv.side);
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
    for (pixel, &(x, y)) in sums.iter().zip(places) {
        let target = to.pixels_mut(x.into(), y.into(), 1);
        let (out, _) = S::as_mut_simd_f32s(&mut target[block * BLOCK..(block + 1) * BLOCK]);
        for v in 0..V {
            out[v] = if conv.relu { simd.max_f32s(pixel[v], zero) } else { pixel[v] };
        }
    }
}
