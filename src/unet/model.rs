//! The network: Taktasheva et al. 2019, section 4.

use super::config::{EPSILON, UNetConfig};
use burn::module::{Initializer, Module, Param};
use burn::nn::conv::{Conv2d, Conv2dConfig};
use burn::nn::{BatchNorm, BatchNormConfig, PaddingConfig2d};
use burn::tensor::activation::relu;
use burn::tensor::module::{interpolate, max_pool2d};
use burn::tensor::ops::{InterpolateMode, InterpolateOptions, MaxPoolOptions};
use burn::tensor::{Device, Tensor, TensorData};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

impl UNetConfig {
    /// A network with fresh weights, the same for the same seed whatever else draws random numbers.
    pub fn init(&self, device: &Device, seed: u64) -> UNet {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let down = self.down().into_iter().map(|channels| Block::new(self, channels, device, &mut rng)).collect();
        let joined = |[low, skip, output]: [usize; 3]| [low + skip, output];
        let up = self.up().into_iter().map(|all| Block::new(self, joined(all), device, &mut rng)).collect();
        let head = Conv2dConfig::new([self.channels(0), self.outputs()], [1, 1]).with_initializer(Initializer::Zeros);
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
        let norm = || BatchNormConfig::new(output).with_epsilon(EPSILON).with_momentum(config.momentum).init(device);
        Self { conv1: conv([input, output]), norm1: norm(), conv2: conv([output, output]), norm2: norm() }
    }

    fn forward(&self, x: Tensor<4>, seen: &mut impl FnMut(Tensor<4>) -> Tensor<4>) -> Tensor<4> {
        let x = seen(relu(self.norm1.forward(self.conv1.forward(x))));
        seen(relu(self.norm2.forward(self.conv2.forward(x))))
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
    /// From features to what is said of each pixel, 1x1.
    pub head: Conv2d,
    patch: usize,
}

impl UNet {
    /// From `[batch, channels, height, width]` to `[batch, outputs, height, width]`: `Re c0`, `Im c0`, `Re c2`, `Im c2`,
    /// less the field that [`super::Features`] starts from, or the log-odds of ink. Sides are multiples of
    /// [`UNetConfig::multiple`].
    pub fn forward(&self, x: Tensor<4>) -> Tensor<4> {
        self.forward_seen(x, &mut |x| x)
    }

    /// The same, every feature map but the head's being replaced by what `seen` makes of it.
    fn forward_seen(&self, x: Tensor<4>, seen: &mut impl FnMut(Tensor<4>) -> Tensor<4>) -> Tensor<4> {
        let mut x = seen(unshuffle(x, self.patch));
        let mut skips = Vec::new();
        for (level, block) in self.down.iter().enumerate() {
            if level > 0 {
                skips.push(x.clone());
                x = max_pool2d(x, MaxPoolOptions::new([2, 2]).with_stride([2, 2]));
            }
            x = block.forward(x, seen);
        }
        for block in &self.up {
            let [_, _, height, width] = x.dims();
            let skip = skips.pop().expect("one skip a level");
            x = block.forward(Tensor::cat(vec![resized(x, [2 * height, 2 * width]), skip], 1), seen);
        }
        shuffle(self.head.forward(x), self.patch)
    }
}

/// A network that computes only where it is told to and takes the rest for blank paper, as the engine does.
#[derive(Clone, Debug)]
pub struct Within {
    model: UNet,
    /// What each feature map holds on blank paper, `[1, channels, 1, 1]`, in the order in which they come about.
    blank: Vec<Tensor<4>>,
}

impl Within {
    /// For a network, its input having `channels`, and images whose sides are multiples of `multiple`.
    pub fn new(model: UNet, config: &UNetConfig, device: &Device) -> Self {
        // Three pixels a side at the lowest level, of which the middle one sees no border.
        let side = 3 * config.multiple();
        let mut blank = Vec::new();
        model.forward_seen(Tensor::zeros([1, config.input.channels(), side, side], device), &mut |x| {
            let [_, _, height, width] = x.dims();
            let middle = x.narrow(2, height / 2, 1).narrow(3, width / 2, 1);
            blank.push(middle.clone());
            middle.repeat(&[1, 1, height, width])
        });
        Self { model, blank }
    }

    /// Like [`UNet::forward`] on one image; `active`, `[1, 1, _, _]`, is 1 on the cells of [`UNetConfig::multiple`] pixels
    /// that are computed and else 0. The output elsewhere means nothing.
    pub fn forward(&self, x: Tensor<4>, active: &Tensor<4>) -> Tensor<4> {
        let mut blank = self.blank.iter();
        self.model.forward_seen(x, &mut |x| {
            let [_, _, height, width] = x.dims();
            let blank = blank.next().expect("one a feature map").clone();
            (x - blank.clone()) * resized(active.clone(), [height, width]) + blank
        })
    }
}

/// Each pixel repeated, up to a height and a width.
fn resized(x: Tensor<4>, size: [usize; 2]) -> Tensor<4> {
    let mut options = InterpolateOptions::new(InterpolateMode::Nearest);
    options.output_size = Some(size);
    interpolate(x, options)
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
    use crate::unet::Input;
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
        let x = Tensor::random([1, 3, 32, 64], Distribution::Default, &device);
        let net = UNetConfig::ink().init(&device, 1);
        assert_eq!(net.forward(x).dims(), [1, 1, 32, 64]);
        assert!((250_000..300_000).contains(&net.num_params()), "{}", net.num_params());
    }
}
