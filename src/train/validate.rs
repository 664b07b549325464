//! Angular error of a network on drawings that it was not trained on.

use super::config::TrainConfig;
use super::source::{Source, sight};
use crate::field::decode;
use crate::ground_truth::{FieldTruth, Place};
use crate::raster::Raster;
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
    /// For each sheet what is true and the network's input, clean and scanned.
    sheets: Vec<[(FieldTruth, Features); 2]>,
    multiple: usize,
}

impl Validator {
    /// Draws the sheets; they depend on the configuration's seed but on none of the training data.
    pub fn new(config: &TrainConfig, source: &Source) -> Self {
        let sheet = |n: usize| {
            [false, true].map(|scanned| {
                let mut rng = ChaCha8Rng::seed_from_u64(config.seed ^ 0x5eed_07a1_1da7);
                rng.set_stream(n as u64);
                let sight = sight(&mut rng, source, config, |_| scanned);
                let ink = padded(&sight.ink, config.network.multiple());
                (sight.truth, features(&ink, config.network.input))
            })
        };
        Self { multiple: config.network.multiple(), sheets: (0..config.validation_sheets).map(sheet).collect() }
    }

    /// Runs a network that is on a plain device.
    pub fn run(&self, model: &UNet, device: &Device) -> Validation {
        self.measure(|channels, [height, width]| {
            let data = TensorData::new(channels.to_vec(), [1, channels.len() / (width * height), height, width]);
            let output = model.forward(Tensor::from_data(data, device));
            output.into_data().try_into_vec::<f32>().unwrap_or_default()
        })
    }

    /// How good no network is: the errors of the field that it would correct.
    pub fn without_network(&self) -> Validation {
        self.measure(|_, [height, width]| vec![0.0; 4 * height * width])
    }

    fn measure(&self, network: impl Fn(&[f32], [usize; 2]) -> Vec<f32>) -> Validation {
        let [clean, scan] = [0, 1].map(|kind| {
            let mut sum = Sums::default();
            for (truth, Features { channels, base }) in self.sheets.iter().map(|s| &s[kind]) {
                let (width, height) = truth.place.size();
                let [width, height] = [width, height].map(|n| n.next_multiple_of(self.multiple));
                let mut field = network(channels, [height, width]);
                field.iter_mut().zip(base).for_each(|(f, b)| *f += b);
                sum.add(&field, width, truth);
            }
            sum.mean()
        });
        Validation { clean, scan }
    }
}

/// The ink with blank paper to the right and below, so that the network can take its size.
fn padded(ink: &Raster<f32>, multiple: usize) -> Raster<f32> {
    let (width, height) = ink.size();
    let size = [width, height].map(|n| n.next_multiple_of(multiple));
    Raster::from_fn(size[0], size[1], |x, y| if x < width && y < height { ink[(x, y)] } else { 0.0 })
}

#[derive(Default)]
struct Sums {
    ink: (f64, f64),
    junction: (f64, f64),
    squares: f64,
}

impl Sums {
    /// Adds one image; `field` is `[4, _, stride]` and covers it.
    fn add(&mut self, field: &[f32], stride: usize, truth: &FieldTruth) {
        let n = field.len() / 4;
        let width = truth.place.width();
        for i in (0..truth.ink.data().len()).filter(|i| truth.ink.data()[*i]) {
            let at = i / width * stride + i % width;
            let c0 = Complex32::new(field[at], field[n + at]);
            let c2 = Complex32::new(field[2 * n + at], field[3 * n + at]);
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
