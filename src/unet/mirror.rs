//! The mirror image of a network.
//!
//! Let `S` swap x and y of a drawing or of a field. A network `N` is trained on drawings in every direction, and yet `N(X)`
//! and `S N(S X)` differ, by as much as chance has a part in either; their mean errs less. The second is `N` with its kernels
//! transposed, so that both see the same drawing.

use super::features::signs;
use super::weights::{CONFIG, Weights};
use crate::error::Result;
use safetensors::tensor::TensorView;
use std::borrow::Cow;

/// What the real and the imaginary part of squared directions, and of their fourth powers, are multiplied by when x and y
/// are swapped: `w` becomes `-conj w`, and its square `conj w^2`.
pub(crate) const SWAPPED: [f32; 4] = [-1.0, 1.0, 1.0, -1.0];

impl Weights {
    /// The network that makes of any drawing what this one makes of it when x and y are swapped, swapped back.
    ///
    /// # Errors
    /// [`crate::Error::Weights`] when the file cannot be read. Tensors of a wrong shape stay as they are, for those who use
    /// them to refuse.
    pub(crate) fn mirrored(&self) -> Result<Self> {
        let tensors = self.numbers()?.tensors;
        let all: Vec<(String, TensorView)> = tensors.tensors();
        let mirrored: Vec<Vec<u8>> = all.iter().map(|(name, tensor)| self.mirrored_tensor(name, tensor)).collect();
        let views = all.iter().zip(&mirrored).map(|((name, tensor), data)| {
            let view = TensorView::new(tensor.dtype(), tensor.shape().to_vec(), data);
            (name, view.expect("as many numbers as before"))
        });
        let shape = serde_json::to_string(&self.config()).map_err(|e| self.failed(e))?;
        // A map of the standard library or another, as the features of safetensors have it.
        let metadata = std::iter::once((CONFIG.to_string(), shape)).collect();
        let bytes = safetensors::serialize(views, Some(metadata)).map_err(|e| self.failed(e))?;
        Ok(self.with_bytes(Cow::Owned(bytes)))
    }

    /// Kernels are transposed, and so are the squares of pixels that the input and the output hold as channels.
    fn mirrored_tensor(&self, name: &str, tensor: &TensorView) -> Vec<u8> {
        let ((input, output), patch) = (signs(SWAPPED), self.config().patch);
        let side = tensor.shape().get(2).copied().unwrap_or(1);
        let (outputs, inputs) = match (tensor.shape(), name) {
            (&[o, i, h, w], "down.0.conv1.weight") if h == w => (plain(o), cells(i, patch, &input)),
            (&[o, i, h, w], "head.weight") if h == w => (cells(o, patch, &output), plain(i)),
            (&[o, i, h, w], _) if h == w => (plain(o), plain(i)),
            (&[o], "head.bias") => (cells(o, patch, &output), plain(1)),
            _ => return tensor.data().to_vec(),
        };
        let bytes = tensor.data().len() / (outputs.len() * inputs.len() * side * side).max(1);
        let mut data = Vec::with_capacity(tensor.data().len());
        for (o, from_output) in &outputs {
            for (i, from_input) in &inputs {
                for (x, y) in (0..side).flat_map(|x| (0..side).map(move |y| (x, y))) {
                    let at = ((o * inputs.len() + i) * side + y) * side + x;
                    data.extend_from_slice(&tensor.data()[at * bytes..(at + 1) * bytes]);
                    if from_output * from_input < 0.0 {
                        // Floats of any size have their sign in the highest bit, and little ends come first.
                        *data.last_mut().expect("a number") ^= 0x80;
                    }
                }
            }
        }
        data
    }
}

/// Channels that stay what they are: where each comes from, and its sign.
fn plain(channels: usize) -> Vec<(usize, f32)> {
    (0..channels).map(|c| (c, 1.0)).collect()
}

/// Planes of which each has the pixels of a square as channels.
fn cells(channels: usize, patch: usize, signs: &[f32]) -> Vec<(usize, f32)> {
    let square = patch * patch;
    if channels != signs.len() * square && channels != square {
        return plain(channels);
    }
    (0..channels)
        .map(|c| {
            let (plane, y, x) = (c / square, c % square / patch, c % patch);
            (plane * square + x * patch + y, signs[plane])
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::unet::engine::{Engine, Scratch, TileCells};

    /// The network's output `[4, side, side]`.
    fn output(weights: &Weights, input: &[f32], cells: usize, side: usize) -> Vec<f32> {
        let cells = TileCells::new(cells, cells, vec![true; cells * cells]);
        let mut out = vec![0.0; 4 * side * side];
        Engine::new(weights).unwrap().run(&mut Scratch::default(), input, &cells, |x, y, values: [f32; 4]| {
            values.into_iter().enumerate().for_each(|(k, value)| out[(k * side + y) * side + x] = value);
        });
        out
    }

    /// Planes with x and y swapped.
    fn swapped(planes: &[f32], side: usize, signs: &[f32]) -> Vec<f32> {
        let at = |i: usize| (i / (side * side), i / side % side, i % side);
        (0..planes.len()).map(at).map(|(k, y, x)| signs[k] * planes[(k * side + x) * side + y]).collect()
    }

    #[test]
    fn the_mirror_image_sees_in_a_drawing_what_the_network_sees_in_the_mirrored_one() {
        let weights = Weights::built_in().unwrap();
        let (cells, side) = (2, 2 * weights.config().multiple());
        let (input_signs, output_signs) = signs(SWAPPED);
        let input: Vec<f32> = (0..9 * side * side).map(|i| ((i * i + 7 * i) % 101) as f32 / 101.0 - 0.3).collect();
        let seen = output(&weights.mirrored().unwrap(), &input, cells, side);
        let mirrored = output(&weights, &swapped(&input, side, &input_signs), cells, side);
        let expected = swapped(&mirrored, side, &output_signs);
        let apart = seen.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        let plain = output(&weights, &input, cells, side);
        let differs = seen.iter().zip(&plain).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(apart < 1e-3 && differs > 10.0 * apart, "{apart} {differs}");
    }

    #[test]
    fn a_mirror_image_of_a_mirror_image_is_the_thing_itself() {
        let weights = Weights::built_in().unwrap();
        let twice = weights.mirrored().unwrap().mirrored().unwrap();
        let (a, b) = (weights.numbers().unwrap().tensors, twice.numbers().unwrap().tensors);
        assert_eq!(a.len(), b.len());
        assert!(a.tensors().iter().all(|(name, t)| b.tensor(name).unwrap().data() == t.data()));
    }
}
