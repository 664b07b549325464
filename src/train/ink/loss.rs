//! What training makes small where ink is seen.

use super::super::config::TrainConfig;
use super::super::data::Sample;
use crate::unet::UNet;
use burn::tensor::activation::{relu, sigmoid};
use burn::tensor::{Device, Tensor, TensorData};

/// Pixels of ink that are added to both sides of a crop's Dice ratio, so that one without ink has one too.
const SMOOTH: f32 = 20.0;

/// The parts of the loss, before their weights.
pub(in super::super) struct InkLoss {
    /// Cross-entropy of the coverage, mean over all pixels.
    pub entropy: Tensor<1>,
    /// `1 - 2 sum(p y) / (sum(p^2) + sum(y^2))`, mean over crops: a crop with little and faint ink counts as much as one
    /// with a lot, and the least is at `p = y` for pixels that are ink in part, too.
    pub dice: Tensor<1>,
    /// How much ink is seen, of 1 that is there.
    pub seen: Tensor<1>,
}

impl InkLoss {
    /// Runs a network on a batch.
    pub fn of(model: &UNet, sample: Sample, config: &TrainConfig, device: &Device) -> Self {
        let (n, side) = (config.batch, config.crop);
        let tensor = |data: Vec<f32>, channels: usize| -> Tensor<4> {
            Tensor::from_data(TensorData::new(data, [n, channels, side, side]), device)
        };
        let input = tensor(sample.input, config.network.input.channels());
        Self::new(model.forward(input), tensor(sample.target, 1))
    }

    /// From log-odds and coverage, both `[batch, 1, height, width]`.
    pub fn new(logits: Tensor<4>, ink: Tensor<4>) -> Self {
        let [n, ..] = logits.dims();
        // ln(1 + e^x) - x y, in a way that does not overflow.
        let soft = logits.clone().abs().neg().exp().log1p();
        let entropy = (relu(logits.clone()) - logits.clone() * ink.clone() + soft).mean();
        let seen = sigmoid(logits);
        let sums = |x: Tensor<4>| -> Tensor<2> { x.reshape([n as i64, -1]).sum_dim(1) };
        let both = sums(seen.clone() * ink.clone()).mul_scalar(2.0).add_scalar(SMOOTH);
        let squares = sums(seen.clone() * seen.clone()) + sums(ink.clone() * ink.clone());
        let dice = (both / squares.add_scalar(SMOOTH)).neg().add_scalar(1.0).mean();
        Self { entropy, dice, seen: seen.sum() / ink.sum().clamp_min(1.0) }
    }

    /// The weighted sum.
    pub fn total(&self, config: &TrainConfig) -> Tensor<1> {
        self.entropy.clone() + self.dice.clone().mul_scalar(config.dice)
    }
}
