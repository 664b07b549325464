//! Errors of a network on drawings that it was not trained on.

use super::config::TrainConfig;
use super::data;
use super::pictures;
use super::source::{Sight, Source, View, sight};
use crate::error::Result;
use crate::field::{Frame, decode};
use crate::ground_truth::{FieldTruth, Place};
use crate::metrics::{pair, single};
use crate::raster::Raster;
use crate::unet::{Features, UNet, features};
use burn::tensor::{Device, Tensor, TensorData};
use kurbo::Vec2;
use num_complex::Complex32;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// How far a field is from the true one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FieldError {
    /// Mean angle in degrees between the nearest curve's tangent and the nearer root, on the ink.
    pub ink: f64,
    /// The same within two line widths of junctions; where two curves share a pixel, each direction against a root of
    /// its own.
    pub junction: f64,
    /// Mean of `|c_k - c_k*|^2` over the ink pixels and `k = 0, 2`.
    pub mse: f64,
    /// Mean of `|grad c_k|^2` over the ink pixels and `k = 0, 2`, differences between neighbours on the ink.
    pub smoothness: f64,
    /// Share of the pixels that are ink. Off the ink the field is masked, so a mean over all pixels is one over the ink
    /// times this.
    pub ink_share: f64,
}

impl FieldError {
    pub(super) fn figures(&self) -> [(&'static str, f64); 5] {
        let Self { ink, junction, mse, smoothness, ink_share } = *self;
        let degrees = [("ink_deg", ink), ("junction_deg", junction)];
        [degrees[0], degrees[1], ("mse", mse), ("smoothness", smoothness), ("ink_share", ink_share)]
    }
}

/// Errors on clean drawings and, where a run has them, on scans and on pages of all kinds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Validation {
    /// On renders without noise.
    pub clean: FieldError,
    /// On synthetic scans.
    pub scan: Option<FieldError>,
    /// On pages of all kinds.
    pub paper: Option<FieldError>,
}

impl Validation {
    /// One number to keep the best network by, the smaller the better: errors relative to what they have to reach.
    pub fn score(&self) -> f64 {
        let part = |e: &FieldError, ink: f64, junction: f64| e.ink / ink + e.junction / junction;
        let [scan, paper] = [self.scan, self.paper].map(|errors| errors.map_or(0.0, |e| part(&e, 0.8, 4.5)));
        part(&self.clean, 0.5, 3.0) + scan + paper
    }
}

/// Sheets of each view that are drawn.
const EXAMPLES: usize = 4;

/// Images that are run through the network together.
const TOGETHER: usize = 16;

/// A sheet to validate on.
pub(super) struct Sheet {
    /// What is true.
    pub(super) truth: FieldTruth,
    /// The ink, with blank paper to the right and below up to a size that the network can take.
    pub(super) ink: Raster<f32>,
    features: Features,
}

/// The fixed drawings of a run's validation.
pub struct Validator {
    /// The sheets of each view that the run has; clean ones always.
    views: Vec<(View, Vec<Sheet>)>,
}

impl Validator {
    /// Draws the sheets; they depend on the configuration's seed but, unless they are meant to be, on none of the
    /// training data.
    pub fn new(config: &TrainConfig, source: &Source) -> Self {
        let sheet = |sight: Sight| {
            let [width, height] =
                [sight.ink.width(), sight.ink.height()].map(|n| n.next_multiple_of(config.network.multiple()));
            let inside = |x, y| x < sight.ink.width() && y < sight.ink.height();
            let ink = Raster::from_fn(width, height, |x, y| if inside(x, y) { sight.ink[(x, y)] } else { 0.0 });
            let features = features(&ink, config.network.input);
            Sheet { truth: sight.truth, ink, features }
        };
        if config.validation_sheets == 0 {
            let own = |n| sheet(data::sheet(&mut data::stream(config.seed, n), source, config));
            return Self { views: vec![(View::Clean, (0..config.images as u64).map(own).collect())] };
        }
        let held_out = |n: u64, view| {
            let mut rng = data::stream(config.seed ^ 0x5eed_07a1_1da7, n);
            sheet(sight(&mut rng, source, config, |_| view))
        };
        let views = config.views().filter(|(view, share)| *view == View::Clean || *share > 0.0);
        let numbers = || (0..config.validation_sheets as u64).into_par_iter();
        Self { views: views.map(|(view, _)| (view, numbers().map(|n| held_out(n, view)).collect())).collect() }
    }

    /// Runs a network that is on a plain device.
    pub fn run(&self, model: &UNet, device: &Device) -> Validation {
        self.measure(|sheets| predict(model, device, sheets))
    }

    /// How good no network is: the errors of the field that it would correct.
    pub fn without_network(&self) -> Validation {
        self.measure(|sheets| sheets.iter().map(|s| corrected(vec![0.0; 4 * s.ink.data().len()], s)).collect())
    }

    /// Draws the first sheets of each kind, each in a row with what is true and what a network says, to a PNG.
    ///
    /// # Errors
    /// [`Error::Write`](crate::Error::Write).
    pub fn draw_examples(&self, model: &UNet, device: &Device, out: &Path) -> Result<()> {
        let first = self.views.iter().flat_map(|(_, sheets)| sheets.iter().take(EXAMPLES));
        let of = |sheet| (sheet, predict(model, device, std::slice::from_ref(sheet)).swap_remove(0));
        pictures::draw(&first.map(of).collect::<Vec<_>>(), out)
    }

    fn measure(&self, fields: impl Fn(&[Sheet]) -> Vec<Vec<f32>>) -> Validation {
        let errors = |sheets: &Vec<Sheet>| {
            let mut sum = Sums::default();
            for same in sheets.chunk_by(|a, b| a.ink.size() == b.ink.size()).flat_map(|s| s.chunks(TOGETHER)) {
                for (sheet, field) in same.iter().zip(fields(same)) {
                    sum.add(&field, sheet);
                }
            }
            sum.mean()
        };
        let of = |view: View| self.views.iter().find(|(of, _)| *of == view).map(|(_, sheets)| errors(sheets));
        Validation { clean: of(View::Clean).unwrap_or_default(), scan: of(View::Scan), paper: of(View::Paper) }
    }
}

/// The fields of sheets of one size.
fn predict(model: &UNet, device: &Device, sheets: &[Sheet]) -> Vec<Vec<f32>> {
    let Some(first) = sheets.first() else { return Vec::new() };
    let (width, height) = first.ink.size();
    let channels = first.features.channels.len() / (width * height);
    let input: Vec<f32> = sheets.iter().flat_map(|s| s.features.channels.iter().copied()).collect();
    let data = TensorData::new(input, [sheets.len(), channels, height, width]);
    let output = model.forward(Tensor::from_data(data, device)).into_data();
    let output = output.try_into_vec::<f32>().expect("the network computes in f32");
    output.chunks_exact(4 * width * height).zip(sheets).map(|(field, sheet)| corrected(field.to_vec(), sheet)).collect()
}

/// Adds the field that the network corrects.
fn corrected(mut field: Vec<f32>, sheet: &Sheet) -> Vec<f32> {
    field.iter_mut().zip(&sheet.features.base).for_each(|(f, b)| *f += b);
    field
}

/// The coefficients at a pixel of a field `[4, _, _]`.
pub(super) fn coefficients(field: &[f32], at: usize) -> [Complex32; 2] {
    let n = field.len() / 4;
    [Complex32::new(field[at], field[n + at]), Complex32::new(field[2 * n + at], field[3 * n + at])]
}

/// Angles in radians between the true directions and the roots nearest to them: of the tangent alone, and the mean of both
/// where each has a root of its own.
pub(super) fn angles([c0, c2]: [Complex32; 2], truth: &FieldTruth, i: usize) -> (f64, f64) {
    let right = std::f64::consts::FRAC_PI_2;
    let [u, v] = [truth.tangent.data()[i], truth.other.data()[i]].map(|w| f64::from(w.arg()) / 2.0);
    decode(c0, c2).map_or((right, right), |Frame { u: first, v: second }| {
        let (roots, u, v) = ([first, second], Vec2::from_angle(u), Vec2::from_angle(v));
        (single(roots, u), pair(roots, u, v))
    })
}

#[derive(Default)]
struct Sums {
    ink: (f64, f64),
    junction: (f64, f64),
    squares: f64,
    steps: f64,
    pixels: f64,
}

impl Sums {
    /// Adds one image.
    fn add(&mut self, field: &[f32], sheet: &Sheet) {
        let (truth, stride) = (&sheet.truth, sheet.ink.width());
        let (width, height) = truth.place.size();
        self.pixels += (width * height) as f64;
        for (i, _) in truth.ink.data().iter().enumerate().filter(|(_, ink)| **ink) {
            let (x, y) = (i % width, i / width);
            let c = coefficients(field, y * stride + x);
            self.squares += f64::from((c[0] - truth.field.c0().data()[i]).norm_sqr());
            self.squares += f64::from((c[1] - truth.field.c2().data()[i]).norm_sqr());
            for (nx, ny) in [(x + 1, y), (x, y + 1)] {
                if nx < width && ny < height && truth.ink[(nx, ny)] {
                    let next = coefficients(field, ny * stride + nx);
                    self.steps += f64::from((c[0] - next[0]).norm_sqr() + (c[1] - next[1]).norm_sqr());
                }
            }
            let (single, pair) = angles(c, truth, i);
            self.ink = (self.ink.0 + single, self.ink.1 + 1.0);
            if truth.near_junction.data()[i] {
                let shared = truth.place.data()[i] == Place::Shared;
                self.junction = (self.junction.0 + if shared { pair } else { single }, self.junction.1 + 1.0);
            }
        }
    }

    fn mean(&self) -> FieldError {
        let degrees = |(sum, n): (f64, f64)| (sum / n.max(1.0)).to_degrees();
        let coefficients = 2.0 * self.ink.1.max(1.0);
        FieldError {
            ink: degrees(self.ink),
            junction: degrees(self.junction),
            mse: self.squares / coefficients,
            smoothness: self.steps / coefficients,
            ink_share: self.ink.1 / self.pixels.max(1.0),
        }
    }
}
