//! The network: Taktasheva et al. 2019, section 4.

use super::features::Input;
use burn::module::{Initializer, Module, Param};
use burn::nn::conv::{Conv2d, Conv2dConfig};
use burn::nn::{BatchNorm, BatchNormConfig, PaddingConfig2d};
use burn::tensor::activation::relu;
use burn::tensor::module::{interpolate, max_pool2d};
use burn::tensor::ops::{InterpolateMode, InterpolateOptions, MaxPoolOptions};
use burn::tensor::{Device, Tensor, TensorData};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};

/// Shape of a network.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct UNetConfig {
    /// Channels of the first level; each level down has twice as many.
    pub width: usize,
    /// Number of poolings.
    pub levels: usize,
    /// Side of the square of pixels that the first level takes as one, 1 or 2: input pixels become channels, and
    /// the head gives each its own coefficients. 1 is the paper's network; 2 costs a quarter.
    pub patch: usize,
    /// What the network is shown.
    pub input: Input,
    /// Share of the newest batch in the norms' running statistics. Crops differ much from one another, so the
    /// default averages over many batches; 1 fits training on one image.
    pub momentum: f64,
}

impl Default for UNetConfig {
    fn default() -> Self {
        Self { width: 16, levels: 3, patch: 2, input: Input::Tensor, momentum: 0.03 }
    }
}

impl UNetConfig {
    /// The network of the paper.
    pub fn paper() -> Self {
        Self { width: 16, levels: 4, patch: 1, input: Input::Ink, ..Self::default() }
    }

    /// Image sides have to be multiples of this many pixels.
    pub fn multiple(&self) -> usize {
        self.patch << self.levels
    }

    /// A network with fresh weights, the same for the same seed whatever else draws random numbers.
    pub fn init(&self, device: &Device, seed: u64) -> UNet {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let width = |level: usize| self.width << level;
        let cells = self.patch * self.patch;
        let mut down = vec![Block::new(self, [self.input.channels() * cells, width(0)], device, &mut rng)];
        down.extend((1..=self.levels).map(|l| Block::new(self, [width(l - 1), width(l)], device, &mut rng)));
        let mut up = Vec::new();
        up.extend(
            (0..self.levels).rev().map(|l| Block::new(self, [width(l + 1) + width(l), width(l)], device, &mut rng)),
        );
        let head = Conv2dConfig::new([width(0), 4 * cells], [1, 1]).with_initializer(Initializer::Zeros);
        let head = filled(head.init(device), device, &mut rng);
        UNet { down, up, head, patch: self.patch }
    }
}

/// Two 3x3 convolutions, each with batch norm and ReLU.
#[derive(Module, Debug)]
pub struct Block {
    /// First convolution, `[out, in, 3, 3]`.
    pub conv1: Conv2d,
    /// Its norm.
    pub norm1: BatchNorm,
    /// Second convolution, `[out, out, 3, 3]`.
    pub conv2: Conv2d,
    /// Its norm.
    pub norm2: BatchNorm,
}

impl Block {
    fn new(config: &UNetConfig, [input, output]: [usize; 2], device: &Device, rng: &mut ChaCha8Rng) -> Self {
        let mut conv = |channels| {
            let config = Conv2dConfig::new(channels, [3, 3]).with_bias(false).with_initializer(Initializer::Zeros);
            filled(config.with_padding(PaddingConfig2d::Explicit(1, 1, 1, 1)).init(device), device, rng)
        };
        let norm = || BatchNormConfig::new(output).with_momentum(config.momentum).init(device);
        Self { conv1: conv([input, output]), norm1: norm(), conv2: conv([output, output]), norm2: norm() }
    }

    fn forward(&self, x: Tensor<4>) -> Tensor<4> {
        let x = relu(self.norm1.forward(self.conv1.forward(x)));
        relu(self.norm2.forward(self.conv2.forward(x)))
    }
}

/// Weights uniform within one over the root of the number of inputs (Kaiming, for a slope of root 5).
fn filled(mut conv: Conv2d, device: &Device, rng: &mut ChaCha8Rng) -> Conv2d {
    let shape: [usize; 4] = conv.weight.dims();
    let bound = 1.0 / ((shape[1] * shape[2] * shape[3]) as f32).sqrt();
    let numbers: Vec<f32> = (0..shape.iter().product()).map(|_| rng.random_range(-bound..bound)).collect();
    let fresh = Tensor::from_data(TensorData::new(numbers, shape), device);
    conv.weight = Param::from_tensor(fresh);
    conv
}

/// Encoder, decoder with skip concatenations, and a linear head.
#[derive(Module, Debug)]
pub struct UNet {
    /// Encoder blocks, full resolution first.
    pub down: Vec<Block>,
    /// Decoder blocks, lowest resolution first.
    pub up: Vec<Block>,
    /// From features to coefficients, 1x1.
    pub head: Conv2d,
    patch: usize,
}

impl UNet {
    /// From `[batch, channels, height, width]` to `[batch, 4, height, width]`: `Re c0`, `Im c0`, `Re c2`, `Im c2`, less
    /// the field that [`super::Features`] starts from. Sides are multiples of [`UNetConfig::multiple`].
    pub fn forward(&self, x: Tensor<4>) -> Tensor<4> {
        let mut x = unshuffle(x, self.patch);
        let mut skips = Vec::new();
        for (level, block) in self.down.iter().enumerate() {
            if level > 0 {
                skips.push(x.clone());
                x = max_pool2d(x, MaxPoolOptions::new([2, 2]).with_stride([2, 2]));
            }
            x = block.forward(x);
        }
        for block in &self.up {
            let [_, _, height, width] = x.dims();
            let mut options = InterpolateOptions::new(InterpolateMode::Nearest);
            options.output_size = Some([2 * height, 2 * width]);
            let skip = skips.pop().expect("one skip a level");
            x = block.forward(Tensor::cat(vec![interpolate(x, options), skip], 1));
        }
        shuffle(self.head.forward(x), self.patch)
    }
}

/// `[n, c, h, w]` to `[n, c p p, h / p, w / p]`: the pixels of a square become channels.
fn unshuffle(x: Tensor<4>, p: usize) -> Tensor<4> {
    if p == 1 {
        return x;
    }
    let [n, c, h, w] = x.dims();
    let cells: Tensor<6> = x.reshape([n, c, h / p, p, w / p, p]);
    cells.permute([0, 1, 3, 5, 2, 4]).reshape([n, c * p * p, h / p, w / p])
}

/// The reverse of [`unshuffle`].
fn shuffle(x: Tensor<4>, p: usize) -> Tensor<4> {
    if p == 1 {
        return x;
    }
    let [n, c, h, w] = x.dims();
    let cells: Tensor<6> = x.reshape([n, c / (p * p), p, p, h, w]);
    cells.permute([0, 1, 4, 2, 5, 3]).reshape([n, c / (p * p), h * p, w * p])
}

#[cfg(test)]
mod tests {
    use super::*;
    use burn::tensor::{Distribution, Int};

    #[test]
    fn shuffling_undoes_unshuffling() {
        let device = Device::flex();
        let x = Tensor::<1, Int>::arange(0..96, &device).float().reshape([1, 3, 4, 8]);
        let y = unshuffle(x.clone(), 2);
        assert_eq!(y.dims(), [1, 12, 2, 4]);
        assert_eq!(y.clone().slice([0..1, 1..2, 0..1, 0..1]).into_scalar::<f32>(), 1.0);
        assert_eq!(y.clone().slice([0..1, 2..3, 0..1, 0..1]).into_scalar::<f32>(), 8.0);
        assert_eq!(shuffle(y, 2).into_data(), x.into_data());
    }

    #[test]
    fn every_configuration_keeps_the_size() {
        let device = Device::flex();
        for (patch, levels, input) in [(1, 2, Input::Ink), (2, 2, Input::Tensor), (2, 3, Input::Ink)] {
            let config = UNetConfig { width: 4, levels, patch, input, ..UNetConfig::default() };
            let side = 2 * config.multiple();
            let x = Tensor::random([2, input.channels(), side, 2 * side], Distribution::Default, &device);
            assert_eq!(config.init(&device, 1).forward(x).dims(), [2, 4, side, 2 * side]);
        }
    }
}
