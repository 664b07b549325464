//! What depends on what a network is trained for: its loss and its errors.

use super::config::TrainConfig;
use super::data::Sample;
use super::ink::{InkLoss, InkValidation, InkValidator};
use super::loss::{Batch, Loss};
use super::source::Source;
use super::validate::{Validation, Validator};
use crate::error::Result;
use crate::unet::{Output, UNet};
use burn::tensor::{Device, Tensor};
use std::fmt;
use std::path::Path;

/// The loss of a batch.
pub(super) struct Cost {
    /// What training makes small.
    pub total: Tensor<1>,
    /// It and its parts as numbers; [`Cost::names`] says which.
    pub parts: [f64; 4],
}

impl Cost {
    /// Runs a network on a batch.
    pub fn new(model: &UNet, sample: Sample, config: &TrainConfig, device: &Device) -> Self {
        match config.network.output {
            Output::Field => {
                let batch = Batch::new(sample, config.batch, config.crop, device);
                let loss = Loss::new(model.forward(batch.input.clone()), &batch);
                let total = loss.total(config);
                let [first, alignment, angle, smoothness] =
                    [total.clone(), loss.alignment, loss.angle, loss.smoothness].map(|t| t.into_scalar::<f64>());
                Self { total, parts: [first, alignment, angle.to_degrees(), smoothness] }
            }
            Output::Ink => {
                let loss = InkLoss::of(model, sample, config, device);
                let total = loss.total(config);
                let parts = [total.clone(), loss.entropy, loss.dice, loss.seen].map(|t| t.into_scalar::<f64>());
                Self { total, parts }
            }
        }
    }

    /// What the parts are called in the metrics.
    pub fn names(output: Output) -> [&'static str; 4] {
        match output {
            Output::Field => ["loss", "alignment", "angle_deg", "smoothness"],
            Output::Ink => ["loss", "entropy", "dice", "seen"],
        }
    }
}

/// Errors of a network on what it was not trained on.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// Of a field.
    Field(Validation),
    /// Of ink.
    Ink(Box<InkValidation>),
}

impl Verdict {
    /// One number to keep the best network by, the smaller the better.
    pub fn score(&self) -> f64 {
        match self {
            Self::Field(validation) => validation.score(),
            Self::Ink(validation) => validation.score(),
        }
    }

    /// All errors with their names in the metrics.
    pub fn figures(&self) -> Vec<(String, f64)> {
        let named = |kind: &'static str| move |(name, value): (&str, f64)| (format!("{kind}_{name}"), value);
        match self {
            Self::Field(Validation { clean, scan, paper }) => {
                let kinds = [("clean", Some(clean)), ("scan", scan.as_ref()), ("paper", paper.as_ref())];
                let kinds = kinds.into_iter().filter_map(|(kind, errors)| Some((kind, errors?)));
                kinds.flat_map(|(kind, errors)| errors.figures().map(named(kind))).collect()
            }
            Self::Ink(validation) => {
                validation.kinds().flat_map(|(kind, errors)| errors.figures().map(named(kind.name()))).collect()
            }
        }
    }
}

/// In short, as for a line of progress.
impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Field(Validation { clean, scan, paper }) => {
                write!(f, "clean {:.2} deg on ink, {:.2} near junctions", clean.ink, clean.junction)?;
                let others = [("scan", scan), ("paper", paper)].into_iter().filter_map(|(view, e)| Some((view, (*e)?)));
                others.into_iter().try_for_each(|(view, e)| write!(f, "; {view} {:.2}, {:.2}", e.ink, e.junction))
            }
            Self::Ink(validation) => {
                write!(f, "f1")?;
                validation.kinds().try_for_each(|(kind, errors)| write!(f, " {} {:.3}", kind.name(), errors.f1()))
            }
        }
    }
}

/// What a run is validated with.
pub(super) enum Judge {
    Field(Validator),
    Ink(InkValidator),
}

impl Judge {
    /// Draws the drawings or pages of a run's validation.
    pub fn new(config: &TrainConfig, source: &Source) -> Self {
        match config.network.output {
            Output::Field => Self::Field(Validator::new(config, source)),
            Output::Ink => Self::Ink(InkValidator::new(config, source)),
        }
    }

    /// Runs a network that is on a plain device.
    pub fn run(&self, model: &UNet, device: &Device) -> Verdict {
        match self {
            Self::Field(validator) => Verdict::Field(validator.run(model, device)),
            Self::Ink(validator) => Verdict::Ink(Box::new(validator.run(model, device))),
        }
    }

    /// Draws some examples with what the network makes of them to a PNG.
    ///
    /// # Errors
    /// [`Error::Write`](crate::Error::Write).
    pub fn draw_examples(&self, model: &UNet, device: &Device, out: &Path) -> Result<()> {
        match self {
            Self::Field(validator) => validator.draw_examples(model, device, out),
            Self::Ink(validator) => validator.draw_examples(model, device, out),
        }
    }
}
