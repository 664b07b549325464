//! Angular error of a network on drawings that it was not trained on.

use super::config::TrainConfig;
use super::data::observed;
use crate::field::decode;
use crate::ground_truth::{self, FieldTruth, Place};
use crate::render::render;
use crate::synth;
use crate::unet::{Features, UNet, features};
use burn::tensor::{Device, Tensor, TensorData};
use kurbo::Vec2;
use num_complex::Complex32;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};

/// Mean angular errors in degrees.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct AngularError {
    /// Between the nearest curve's tangent and the nearer root, on the ink.
    pub ink: f64,
    /// Within two line widths of junctions: where two curves share a pixel, each direction against a root of its
    /// own; elsewhere as on the ink.
    pub junction: f64,
    /// Mean square of the coefficients' error over ink pixels and the four channels.
    pub mse: f64,
}

/// Angular errors on clean drawings and on scans of the same.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Validation {
    /// On renders without noise.
    pub clean: AngularError,
    /// On synthetic scans.
    pub scan: AngularError,
}

impl Validation {
    /// One number to keep the best network by: errors relative to what they have to reach.
    pub fn score(&self) -> f64 {
        let part = |e: &AngularError, ink: f64, junction: f64| e.ink / ink + e.junction / junction;
        part(&self.clean, 0.5, 3.0) + part(&self.scan, 0.8, 4.5)
    }
}

/// The fixed drawings of a run's validation.
pub struct Validator {
    side: usize,
    sheets: Vec<(FieldTruth, [Features; 2])>,
}

impl Validator {
    /// Draws the sheets; they depend on the configuration's seed but on none of the training data.
    pub fn new(config: &TrainConfig) -> Self {
        let sheet = |n: usize| {
            let mut rng = ChaCha8Rng::seed_from_u64(config.seed ^ 0x5eed_07a1_1da7);
            rng.set_stream(n as u64);
            let drawing = synth::drawing(&mut rng, config.sheet);
            let truth = ground_truth::field(&drawing);
            let inputs = [false, true].map(|scanned| {
                let ink = if scanned { observed(&mut rng, &drawing, true) } else { render(&drawing) };
                features(&ink, config.network.input)
            });
            (truth, inputs)
        };
        Self { side: config.sheet, sheets: (0..config.validation_sheets).map(sheet).collect() }
    }

    /// Runs a network that is on a plain device.
    pub fn run(&self, model: &UNet, device: &Device) -> Validation {
        let [clean, scan] = [0, 1].map(|kind| {
            let mut sum = Sums::default();
            for (truth, inputs) in &self.sheets {
                let Features { channels, base } = &inputs[kind];
                let n = self.side * self.side;
                let data = TensorData::new(channels.clone(), [1, channels.len() / n, self.side, self.side]);
                let output = model.forward(Tensor::from_data(data, device));
                let mut field = output.into_data().try_into_vec::<f32>().unwrap_or_default();
                field.iter_mut().zip(base).for_each(|(f, b)| *f += b);
                sum.add(&field, truth);
            }
            sum.mean()
        });
        Validation { clean, scan }
    }
}

#[derive(Default)]
struct Sums {
    ink: (f64, f64),
    junction: (f64, f64),
    squares: f64,
}

impl Sums {
    /// Adds one image; `field` is `[4, height, width]`.
    fn add(&mut self, field: &[f32], truth: &FieldTruth) {
        let n = truth.place.data().len();
        for i in 0..n {
            if !truth.ink.data()[i] {
                continue;
            }
            let c0 = Complex32::new(field[i], field[n + i]);
            let c2 = Complex32::new(field[2 * n + i], field[3 * n + i]);
            self.squares += f64::from((c0 - truth.field.c0().data()[i]).norm_sqr());
            self.squares += f64::from((c2 - truth.field.c2().data()[i]).norm_sqr());
            let right = std::f64::consts::FRAC_PI_2;
            let [u, v] = [truth.tangent.data()[i], truth.other.data()[i]].map(|w| f64::from(w.arg()) / 2.0);
            let (single, pair) = decode(c0, c2).map_or((right, right), |frame| {
                let e = |root: Vec2, angle: f64| {
                    let d = Vec2::from_angle(angle);
                    root.cross(d).abs().atan2(root.dot(d).abs())
                };
                let straight = e(frame.u, u) + e(frame.v, v);
                let swapped = e(frame.u, v) + e(frame.v, u);
                (e(frame.u, u).min(e(frame.v, u)), straight.min(swapped) / 2.0)
            });
            self.ink = (self.ink.0 + single, self.ink.1 + 1.0);
            if truth.near_junction.data()[i] {
                let shared = truth.place.data()[i] == Place::Shared;
                self.junction = (self.junction.0 + if shared { pair } else { single }, self.junction.1 + 1.0);
            }
        }
    }

    fn mean(&self) -> AngularError {
        let degrees = |(sum, n): (f64, f64)| (sum / n.max(1.0)).to_degrees();
        let mse = self.squares / (4.0 * self.ink.1.max(1.0));
        AngularError { ink: degrees(self.ink), junction: degrees(self.junction), mse }
    }
}

/// How good no network is: the errors of the field that it would correct.
pub fn without_network(config: &TrainConfig) -> Validation {
    let validator = Validator::new(config);
    let [clean, scan] = [0, 1].map(|kind| {
        let mut sum = Sums::default();
        for (truth, inputs) in &validator.sheets {
            let mut field = inputs[kind].base.clone();
            field.resize(4 * validator.side * validator.side, 0.0);
            sum.add(&field, truth);
        }
        sum.mean()
    });
    Validation { clean, scan }
}
