//! What a training run is told, and where its data comes from.

use super::source::{Skipped, Source, View};
use crate::error::{Error, Result};
use crate::synth::Kind;
use crate::unet::{Output, UNetConfig};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// A training run. Everything that decides its result is in here.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TrainConfig {
    /// Seed of weights, data and everything else.
    pub seed: u64,
    /// Optimisation steps.
    pub steps: usize,
    /// Crops a step.
    pub batch: usize,
    /// Side of a crop in pixels.
    pub crop: usize,
    /// Largest learning rate; it rises over the first `warmup` steps and falls along a cosine to a hundredth.
    pub rate: f64,
    /// Steps of the rise.
    pub warmup: usize,
    /// Weight of the squared difference of the coefficients.
    pub alignment: f64,
    /// Weight of the angle between true and predicted roots; 0 in the paper.
    pub angle: f64,
    /// Weight of the smoothness of the prediction, the paper's gamma.
    pub gamma: f64,
    /// Weight of the soft Dice loss beside the cross-entropy of ink.
    pub dice: f64,
    /// Kinds of pages that ink is not trained on, though it is validated on them.
    pub held_out: Vec<Kind>,
    /// Shares of the data of a field that are scans, and pages of all kinds whose ink the network tells that is built in; the
    /// rest is clean.
    pub scans: f64,
    /// See `scans`.
    pub papers: f64,
    /// Side of the synthetic drawings that crops are cut from, in pixels.
    pub sheet: usize,
    /// Crops cut from each drawing.
    pub crops_a_sheet: usize,
    /// Sheets in the training set, each seen once an epoch and in another order every time, a crop of each; 0 draws
    /// new ones for every step.
    pub images: usize,
    /// Lay every crop down in one of the eight ways to, turned by quarters and mirrored, drawn anew each time: a set of
    /// images is learned by heart later. New sheets come in every direction without it.
    pub turns: bool,
    /// Draw this many lines and arcs on each sheet and nothing else; 0 draws of everything.
    pub primitives: usize,
    /// A folder of SVG drawings to mix in.
    pub svgs: Option<PathBuf>,
    /// Share of the sheets that show one of those.
    pub svg_share: f64,
    /// A folder of pages with their ink to mix in where ink is trained: [`Source::add_pages`].
    pub pages: Option<PathBuf>,
    /// Share of the crops that are of those.
    pub page_share: f64,
    /// Steps between validations.
    pub validate_every: usize,
    /// Drawings to validate on, each as clean and, where scans are trained on, as scan, or pages of each kind; 0 validates
    /// on the training set of `images`.
    pub validation_sheets: usize,
    /// Seconds between checkpoints.
    pub checkpoint_seconds: u64,
    /// Stop after this many validations without a better one; 0 never stops early.
    pub patience: usize,
    /// The network.
    pub network: UNetConfig,
}

impl Default for TrainConfig {
    fn default() -> Self {
        Self {
            seed: 1,
            steps: 10_000,
            batch: 16,
            crop: 64,
            rate: 3e-3,
            warmup: 100,
            alignment: 1.0,
            angle: 1.0,
            gamma: 1e-3,
            dice: 0.2,
            held_out: Vec::new(),
            scans: 0.65,
            papers: 0.0,
            sheet: 144,
            crops_a_sheet: 4,
            images: 0,
            turns: false,
            primitives: 0,
            svgs: None,
            svg_share: 0.5,
            pages: None,
            page_share: 0.5,
            validate_every: 500,
            validation_sheets: 48,
            checkpoint_seconds: 120,
            patience: 0,
            network: UNetConfig::default(),
        }
    }
}

impl TrainConfig {
    /// Reads a TOML file; what it does not name keeps its default.
    ///
    /// # Errors
    /// [`Error::Read`] or [`Error::Train`] when the file cannot be read or understood.
    pub fn read(path: &Path) -> Result<Self> {
        let input = path.display().to_string();
        let text = std::fs::read_to_string(path).map_err(|cause| Error::Read { input: input.clone(), cause })?;
        let config: Self =
            toml::from_str(&text).map_err(|e| Error::Train { reason: format!("{input}: {}", e.message()) })?;
        config.validate()?;
        Ok(config)
    }

    /// The configuration of the run in a directory.
    ///
    /// # Errors
    /// [`Error::Train`] where there is none; [`Error::Read`] when it cannot be read.
    pub fn of_run(dir: &Path) -> Result<Self> {
        let found = super::checkpoint::state(dir)?.map(|(config, _)| config);
        found.ok_or_else(|| Error::Train { reason: format!("{}: holds no run to go on with", dir.display()) })
    }

    /// Checks that the numbers fit together.
    ///
    /// # Errors
    /// [`Error::Train`] names the first that does not.
    pub fn validate(&self) -> Result<()> {
        let fail = |reason: String| Err(Error::Train { reason });
        let multiple = self.network.multiple();
        if !self.network.is_sound() {
            let shape = "network.width is at least 1 and network.patch 1 or 2";
            return fail(format!("{shape}; input \"color\" and output \"ink\" go together"));
        }
        if self.network.output == Output::Ink && (self.images > 0 || self.primitives > 0) {
            return fail("images and primitives are not for ink".into());
        }
        if self.crop == 0 || !self.crop.is_multiple_of(multiple) {
            return fail(format!("crop is {} and has to be a multiple of {multiple}", self.crop));
        }
        if !self.sheet.is_multiple_of(multiple) || self.sheet < self.crop {
            return fail(format!("sheet is {} and has to be a multiple of {multiple}, at least crop", self.sheet));
        }
        if self.batch == 0 || self.crops_a_sheet == 0 || !self.batch.is_multiple_of(self.crops_a_sheet) {
            return fail("batch has to be a multiple of crops_a_sheet".into());
        }
        if self.images > 0 && self.crops_a_sheet != 1 {
            return fail("with a set of images, crops_a_sheet has to be 1".into());
        }
        if self.validation_sheets == 0 && self.images == 0 {
            return fail("validation_sheets is 0, which needs a set of images".into());
        }
        if [self.svg_share, self.page_share].iter().any(|share| !(0.0..=1.0).contains(share)) {
            return fail("svg_share and page_share are between 0 and 1".into());
        }
        if self.scans < 0.0 || self.papers < 0.0 || !(0.0..=1.0).contains(&(self.scans + self.papers)) {
            return fail("scans and papers are shares that make at most 1 together".into());
        }
        if self.rate.is_nan() || self.rate <= 0.0 {
            return fail("rate is positive".into());
        }
        Ok(())
    }

    /// What is drawn from, and the files that were left out.
    ///
    /// # Errors
    /// As [`Source::with_svgs`] and [`Source::add_pages`].
    pub fn source(&self) -> Result<(Source, Vec<Skipped>)> {
        let drawings = self.svgs.as_deref().map(Source::with_svgs).transpose()?;
        let (mut source, mut skipped) = drawings.unwrap_or_default();
        if let Some(folder) = &self.pages {
            skipped.extend(source.add_pages(folder, self.crop)?);
        }
        Ok((source, skipped))
    }

    /// The ways in which the data of a field is seen, and the share of each.
    pub fn views(&self) -> impl DoubleEndedIterator<Item = (View, f64)> {
        let clean = 1.0 - self.scans - self.papers;
        [(View::Clean, clean), (View::Scan, self.scans), (View::Paper, self.papers)].into_iter()
    }

    /// The learning rate of a step.
    pub fn rate_at(&self, step: usize) -> f64 {
        let rise = ((step + 1) as f64 / self.warmup.max(1) as f64).min(1.0);
        let progress = (step as f64 / self.steps.max(1) as f64).min(1.0);
        let cosine = 0.5 * (1.0 + (std::f64::consts::PI * progress).cos());
        self.rate * rise * (0.01 + 0.99 * cosine)
    }
}
