//! What training makes small: Taktasheva et al. 2019, equation of section 4, over ink pixels.

use super::config::TrainConfig;
use super::data::Sample;
use burn::tensor::{Device, Tensor, TensorData};

/// Angles in radians below which the angle term is a square instead of an absolute value.
const SOFT: f64 = 0.002;

/// A batch on a device; all `[batch, _, side, side]`.
#[derive(Clone, Debug)]
pub struct Batch {
    /// Network input.
    pub input: Tensor<4>,
    base: Tensor<4>,
    target: Tensor<4>,
    roots: Tensor<4>,
    weights: Tensor<4>,
}

impl Batch {
    /// Moves `n` samples of a side to a device.
    pub fn new(sample: Sample, n: usize, side: usize, device: &Device) -> Self {
        let tensor = |data: Vec<f32>| {
            let channels = data.len() / (n * side * side);
            Tensor::from_data(TensorData::new(data, [n, channels, side, side]), device)
        };
        Self {
            input: tensor(sample.input),
            base: tensor(sample.base),
            target: tensor(sample.target),
            roots: tensor(sample.roots),
            weights: tensor(sample.weights),
        }
    }
}

/// The parts of the loss, each a mean over ink pixels, before their weights.
#[derive(Clone, Debug)]
pub struct Loss {
    /// `|c0 - c0*|^2 + |c2 - c2*|^2`.
    pub alignment: Tensor<1>,
    /// Angle in radians between each true direction and the root that moved from it, to first order.
    pub angle: Tensor<1>,
    /// `|grad c0|^2 + |grad c2|^2` between neighbours on the ink.
    pub smoothness: Tensor<1>,
}

impl Loss {
    /// From the network's output.
    pub fn new(output: Tensor<4>, batch: &Batch) -> Self {
        let ink = channel(&batch.weights, 0);
        let count = ink.clone().sum().clamp_min(1.0);
        let field = output + batch.base.clone();
        let error = (field.clone() - batch.target.clone()) * ink.clone();
        let smoothness = squared_steps(&field, &ink) / count.clone();
        let angle = angles(&error, batch) / count.clone();
        let alignment = error.clone().mul(error).sum() / count;
        Self { alignment, angle, smoothness }
    }

    /// The weighted sum.
    pub fn total(&self, config: &TrainConfig) -> Tensor<1> {
        let mut total = self.alignment.clone().mul_scalar(config.alignment);
        if config.angle > 0.0 {
            total = total + self.angle.clone().mul_scalar(config.angle);
        }
        if config.gamma > 0.0 {
            total = total + self.smoothness.clone().mul_scalar(config.gamma);
        }
        total
    }
}

fn channel(x: &Tensor<4>, k: usize) -> Tensor<4> {
    x.clone().narrow(1, k, 1)
}

/// Sum over ink pixels of how far, to first order, the errors `e0`, `e2` of the coefficients turn the two roots: the root
/// `r` of `w^2 + c2 w + c0` moves by `-(e0 + e2 r) / (r - r')`, and a direction turns by half of that.
fn angles(error: &Tensor<4>, batch: &Batch) -> Tensor<1> {
    let [e0r, e0i, e2r, e2i] = [0, 1, 2, 3].map(|k| channel(error, k));
    let turn = |k: usize| {
        let (r, i) = (channel(&batch.roots, 2 * k), channel(&batch.roots, 2 * k + 1));
        let weight = channel(&batch.weights, 1 + k).mul_scalar(0.5);
        let re = (e0r.clone() + e2r.clone() * r.clone() - e2i.clone() * i.clone()) * weight.clone();
        let im = (e0i.clone() + e2r.clone() * i + e2i.clone() * r) * weight;
        let square = re.clone() * re + im.clone() * im;
        (square.add_scalar(SOFT * SOFT).sqrt().sub_scalar(SOFT)).sum()
    };
    turn(0) + turn(1)
}

/// Sum of squared differences between horizontal and vertical neighbours that are both ink.
fn squared_steps(field: &Tensor<4>, ink: &Tensor<4>) -> Tensor<1> {
    let along = |dim: usize| {
        let n = field.dims()[dim] - 1;
        let pair = ink.clone().narrow(dim, 0, n) * ink.clone().narrow(dim, 1, n);
        let step = (field.clone().narrow(dim, 1, n) - field.clone().narrow(dim, 0, n)) * pair;
        step.clone().mul(step).sum()
    };
    along(2) + along(3)
}
