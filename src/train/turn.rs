//! The eight ways to lay a square sheet down: turned by quarters, mirrored or not.
//!
//! Truth turns with the drawing. With directions as complex numbers, x to the right and y down, a quarter turn multiplies
//! them by `i`, and swapping x and y makes `w` of them `i conj(w)`. So what holds squares of directions (`c2`, roots, the
//! second moments) changes its sign with each quarter turn and becomes `-conj` when swapped; what holds fourth powers
//! (`c0`, the fourth moments) stays as it is with each quarter turn and becomes `conj`.

use super::data::Sample;
use crate::unet::{SWAPPED, signs};
use rand::Rng;

/// One of the eight.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Turn {
    /// Whether x and y are swapped, before anything is turned.
    pub swapped: bool,
    /// Quarter turns that take x to y.
    pub quarters: u8,
}

impl Turn {
    /// Any of the eight.
    pub fn draw(rng: &mut impl Rng) -> Self {
        Self { swapped: rng.random(), quarters: rng.random_range(0..4) }
    }

    /// Where a pixel of a square of `side` pixels goes.
    pub fn moved(self, (mut x, mut y): (usize, usize), side: usize) -> (usize, usize) {
        if self.swapped {
            (x, y) = (y, x);
        }
        for _ in 0..self.quarters {
            (x, y) = (side - 1 - y, x);
        }
        (x, y)
    }

    /// What the real and the imaginary part of squared directions and of their fourth powers are multiplied by.
    fn signs(self) -> [f32; 4] {
        let [re2, im2, re4, im4] = if self.swapped { SWAPPED } else { [1.0; 4] };
        let turn = if self.quarters % 2 == 1 { -1.0 } else { 1.0 };
        [turn * re2, turn * im2, re4, im4]
    }
}

impl Sample {
    /// A sample of a square of `side` pixels, laid down otherwise.
    #[must_use]
    pub fn turned(&self, turn: Turn, side: usize) -> Self {
        let [re2, im2, ..] = turn.signs();
        let (input, field) = signs(turn.signs());
        let roots = [re2, im2, re2, im2];
        // Colours and ink have no direction.
        let signs: [&[f32]; 5] =
            if self.roots.is_empty() { [&[1.0; 3]; 5] } else { [&input, &field, &field, &roots, &[1.0; 3]] };
        let place = |i: usize| {
            let (x, y) = turn.moved((i % side, i / side), side);
            y * side + x
        };
        let places: Vec<usize> = (0..side * side).map(place).collect();
        let mut out = Self::default();
        for ((from, to), signs) in self.planes().into_iter().zip(out.planes_mut()).zip(signs) {
            to.resize(from.len(), 0.0);
            let planes = from.chunks_exact(side * side).zip(to.chunks_exact_mut(side * side));
            for ((from, to), sign) in planes.zip(signs) {
                from.iter().zip(&places).for_each(|(value, &place)| to[place] = sign * value);
            }
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::Drawing;
    use crate::raster::Raster;
    use crate::render::render;
    use crate::unet::Input;
    use crate::{ground_truth, synth};
    use kurbo::Affine;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    const SIDE: usize = 32;

    fn all() -> impl Iterator<Item = Turn> {
        (0..8).map(|n| Turn { swapped: n >= 4, quarters: n % 4 })
    }

    /// A drawing laid down otherwise.
    fn turned(drawing: &Drawing, turn: Turn) -> Drawing {
        let swap = if turn.swapped { Affine::new([0.0, 1.0, 1.0, 0.0, 0.0, 0.0]) } else { Affine::IDENTITY };
        let quarter = Affine::new([0.0, 1.0, -1.0, 0.0, SIDE as f64, 0.0]);
        let map = (0..turn.quarters).fold(swap, |map, _| quarter * map);
        let mut drawing = drawing.clone();
        for stroke in &mut drawing.strokes {
            stroke.centreline = synth::mapped(&stroke.centreline, map);
        }
        drawing
    }

    /// Pixels of two samples, given by plane, that are not alike.
    fn unlike(a: &[f32], b: &[f32]) -> usize {
        assert_eq!(a.len(), b.len());
        let far = |i: &usize| (*i..a.len()).step_by(SIDE * SIDE).any(|k| (a[k] - b[k]).abs() > 2e-3);
        (0..SIDE * SIDE).filter(far).count()
    }

    #[test]
    fn truth_turns_with_the_drawing() {
        let (mut unlike_pixels, mut inked) = ([0; 5], 0);
        for seed in 0..24 {
            let drawing = synth::primitives(&mut ChaCha8Rng::seed_from_u64(seed), SIDE, 2);
            let ink = render(&drawing);
            let upright = turned(&drawing, Turn { swapped: false, quarters: 0 });
            let sample = Sample::new(&ink, &ground_truth::field(&upright), Input::Tensor);
            for turn in all() {
                let mut moved = Raster::filled(SIDE, SIDE, 0.0);
                for (i, &value) in ink.data().iter().enumerate() {
                    moved[turn.moved((i % SIDE, i / SIDE), SIDE)] = value;
                }
                let truth = ground_truth::field(&turned(&drawing, turn));
                let drawn = Sample::new(&moved, &truth, Input::Tensor);
                let planes = sample.turned(turn, SIDE);
                let counts = planes.planes().into_iter().zip(drawn.planes()).map(|(a, b)| unlike(a, b));
                unlike_pixels.iter_mut().zip(counts).for_each(|(sum, n)| *sum += n);
                inked += sample.weights[..SIDE * SIDE].iter().filter(|w| **w > 0.0).count();
            }
        }
        // A pixel just as far from two curves, or from two places of one, belongs to either.
        assert!(unlike_pixels.iter().all(|&n| 100 * n <= inked), "{unlike_pixels:?} of {inked}");
    }

    #[test]
    fn each_of_the_eight_is_drawn() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let drawn: Vec<Turn> = (0..100).map(|_| Turn::draw(&mut rng)).collect();
        assert!(all().all(|turn| drawn.contains(&turn)));
    }
}
