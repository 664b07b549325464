//! Errors of seen ink on pages that were not trained on, by kind.

use super::super::config::TrainConfig;
use super::super::data::{Sample, stream};
use super::super::source::Source;
use super::pictures;
use super::sample::page;
use crate::error::Result;
use crate::synth::{Kind, Page};
use crate::unet::UNet;
use burn::tensor::activation::sigmoid;
use burn::tensor::{Device, Tensor, TensorData};
use rayon::prelude::*;
use std::path::Path;

/// Coverage from which a pixel counts as ink.
const INK: f32 = 0.5;

/// Pages that are run through the network together.
const TOGETHER: usize = 16;

/// Pages of each kind that are drawn.
const EXAMPLES: usize = 2;

/// How far seen ink is from the true one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct InkError {
    /// Share of the pixels taken for ink that are ink.
    pub precision: f64,
    /// Share of the pixels of ink that are taken for it.
    pub recall: f64,
    /// Mean of how far the coverage is off, over all pixels.
    pub mae: f64,
    /// How much ink is seen, of 1 that is there: above 1 lines are too thick.
    pub seen: f64,
}

impl InkError {
    /// The harmonic mean of precision and recall.
    pub fn f1(&self) -> f64 {
        2.0 * self.precision * self.recall / (self.precision + self.recall).max(1e-9)
    }

    pub(in super::super) fn figures(&self) -> [(&'static str, f64); 5] {
        let Self { precision, recall, mae, seen } = *self;
        [("precision", precision), ("recall", recall), ("f1", self.f1()), ("mae", mae), ("seen", seen)]
    }
}

/// Errors on pages of every kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InkValidation {
    /// In the order of [`Kind::ALL`].
    errors: [InkError; Kind::ALL.len()],
}

impl InkValidation {
    /// The errors with the kinds they are of.
    pub fn kinds(&self) -> impl Iterator<Item = (Kind, &InkError)> {
        Kind::ALL.into_iter().zip(&self.errors)
    }

    /// One number to keep the best network by, the smaller the better: what F1 lacks, mean over kinds.
    pub fn score(&self) -> f64 {
        self.errors.iter().map(|e| 1.0 - e.f1()).sum::<f64>() / self.errors.len() as f64
    }
}

/// The fixed pages of a run's validation.
pub struct InkValidator {
    /// Pages of each kind, in the order of [`Kind::ALL`].
    kinds: Vec<Vec<Page>>,
}

impl InkValidator {
    /// Draws the pages; they depend on the configuration's seed but on none of the training data.
    pub fn new(config: &TrainConfig, source: &Source) -> Self {
        let of_kind = |(number, kind): (usize, Kind)| {
            let pages = (0..config.validation_sheets as u64).into_par_iter().map(|n| {
                let mut rng = stream(config.seed ^ 0x5eed_1a4b, (number as u64) << 32 | n);
                page(&mut rng, source, config, kind)
            });
            pages.collect()
        };
        Self { kinds: Kind::ALL.into_iter().enumerate().map(of_kind).collect() }
    }

    /// Runs a network that is on a plain device.
    pub fn run(&self, model: &UNet, device: &Device) -> InkValidation {
        let mut errors = [InkError::default(); Kind::ALL.len()];
        for (errors, pages) in errors.iter_mut().zip(&self.kinds) {
            let mut sums = Sums::default();
            for some in pages.chunks(TOGETHER) {
                some.iter().zip(predict(model, device, some)).for_each(|(page, seen)| sums.add(page, &seen));
            }
            *errors = sums.mean();
        }
        InkValidation { errors }
    }

    /// Draws the first pages of each kind, each with its ink and what a network sees, to a PNG.
    ///
    /// # Errors
    /// [`Error::Write`](crate::Error::Write).
    pub fn draw_examples(&self, model: &UNet, device: &Device, out: &Path) -> Result<()> {
        let first = self.kinds.iter().flat_map(|pages| pages.iter().take(EXAMPLES));
        let of = |page| (page, predict(model, device, std::slice::from_ref(page)).pop());
        pictures::draw(&first.map(of).collect::<Vec<_>>(), out)
    }

    /// Draws pages of each kind, each with its ink, to a PNG.
    ///
    /// # Errors
    /// [`Error::Write`](crate::Error::Write).
    pub fn draw_pages(&self, out: &Path) -> Result<()> {
        pictures::draw(&self.kinds.iter().flatten().map(|page| (page, None)).collect::<Vec<_>>(), out)
    }
}

/// The coverage that a network sees on pages of one size.
fn predict(model: &UNet, device: &Device, pages: &[Page]) -> Vec<Vec<f32>> {
    let Some(first) = pages.first() else { return Vec::new() };
    let (width, height) = first.ink.size();
    let input: Vec<f32> = pages.iter().flat_map(|page| Sample::of_page(&page.color, &page.ink).input).collect();
    let data = TensorData::new(input, [pages.len(), 3, height, width]);
    let seen = sigmoid(model.forward(Tensor::<4>::from_data(data, device))).into_data();
    let seen = seen.try_into_vec::<f32>().expect("the network computes in f32");
    seen.chunks_exact(width * height).map(<[f32]>::to_vec).collect()
}

#[derive(Default)]
struct Sums {
    both: f64,
    taken: f64,
    true_ink: f64,
    off: f64,
    seen: f64,
    there: f64,
    pixels: f64,
}

impl Sums {
    /// Adds one page.
    fn add(&mut self, page: &Page, seen: &[f32]) {
        let count = |is: bool| if is { 1.0 } else { 0.0 };
        for (&truth, &seen) in page.ink.data().iter().zip(seen) {
            self.both += count(truth >= INK && seen >= INK);
            self.taken += count(seen >= INK);
            self.true_ink += count(truth >= INK);
            self.off += f64::from((truth - seen).abs());
            self.seen += f64::from(seen);
            self.there += f64::from(truth);
            self.pixels += 1.0;
        }
    }

    fn mean(&self) -> InkError {
        InkError {
            precision: self.both / self.taken.max(1.0),
            recall: self.both / self.true_ink.max(1.0),
            mae: self.off / self.pixels.max(1.0),
            seen: self.seen / self.there.max(1.0),
        }
    }
}
