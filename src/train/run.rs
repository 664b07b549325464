//! The training loop.

use super::checkpoint::{self, State};
use super::config::TrainConfig;
use super::data::{Sample, batches};
use super::source::{Skipped, Source};
use super::subject::{Cost, Judge, Verdict};
use crate::error::{Error, Result};
use crate::unet::{Output, UNet, Weights, save};
use crate::write::write_file;
use burn::module::Module;
use burn::optim::{AdamConfig, GradientsParams, ModuleOptimizer};
use burn::tensor::Device;
use std::fs::{self, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

/// What a caller hears while training goes on.
#[derive(Clone, Debug)]
pub struct Progress {
    /// Steps done.
    pub step: usize,
    /// Steps in all.
    pub steps: usize,
    /// Mean of the loss and of its parts since the last validation: total, alignment, angle in degrees and smoothness; for
    /// ink total, cross-entropy, Dice loss, and how much ink is seen of 1 that is there.
    pub loss: [f64; 4],
    /// Seconds of training so far, over all resumed parts.
    pub seconds: f64,
    /// The validation after this step, where there was one.
    pub validation: Option<Verdict>,
}

/// A run: a network with its optimiser at some step, and the directory that it is kept in.
pub struct Trainer {
    config: TrainConfig,
    source: Arc<Source>,
    skipped: Vec<Skipped>,
    judge: Judge,
    dir: PathBuf,
    device: Device,
    model: UNet,
    optimizer: ModuleOptimizer,
    state: State,
}

/// Where a run starts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Start {
    /// With fresh weights.
    Fresh,
    /// From the weights that the program carries.
    BuiltIn,
    /// From the weights in a file.
    From(PathBuf),
    /// From the checkpoint in the run's directory.
    Resume,
}

impl Trainer {
    /// A run in a directory.
    ///
    /// # Errors
    /// [`Error::Train`] when the configuration is not sound, when the directory holds a run already and is not to be
    /// resumed, or when its checkpoint is missing or of another configuration; [`Error::Weights`] when the weights
    /// to start from cannot be read.
    pub fn new(config: TrainConfig, dir: &Path, device: &Device, start: &Start) -> Result<Self> {
        config.validate()?;
        let fail = |reason: String| Err(Error::Train { reason });
        if *start != Start::Resume && checkpoint::exists(dir) {
            return fail(format!("{}: holds a run already; resume it or name another folder", dir.display()));
        }
        let (source, skipped) = config.source()?;
        let device = device.clone().autodiff();
        let mut run = Self {
            judge: Judge::new(&config, &source),
            source: Arc::new(source),
            skipped,
            dir: dir.into(),
            model: config.network.init(&device, config.seed),
            optimizer: AdamConfig::new().with_epsilon(1e-8).init(),
            state: State::default(),
            device: device.clone(),
            config,
        };
        let weights = match start {
            Start::Resume => {
                let Some((saved, state, model, moments)) = checkpoint::load(dir, run.model, run.optimizer)? else {
                    return fail(format!("{}: holds no run to go on with", dir.display()));
                };
                if saved != run.config {
                    return fail(format!("{}: holds a run of another configuration", dir.display()));
                }
                forget_after(&dir.join(METRICS), state.step)?;
                return Ok(Self { state, model, optimizer: moments, ..run });
            }
            Start::Fresh => None,
            Start::BuiltIn => Some(match run.config.network.output {
                Output::Field => Weights::built_in()?,
                Output::Ink => Weights::built_in_ink()?,
            }),
            Start::From(path) => Some(Weights::read(path)?),
        };
        fs::create_dir_all(dir).map_err(|cause| Error::Write { path: dir.into(), cause })?;
        if let Some(weights) = weights {
            if weights.config() != run.config.network {
                return fail("the weights to start from are of a network of another shape".into());
            }
            run.model = weights.model(&device)?;
        }
        Ok(run)
    }

    /// What the run was told.
    pub fn config(&self) -> &TrainConfig {
        &self.config
    }

    /// The drawings that the run draws from.
    pub fn source(&self) -> &Source {
        &self.source
    }

    /// The SVGs that were left out, and why.
    pub fn skipped(&self) -> &[Skipped] {
        &self.skipped
    }

    /// Steps done.
    pub fn step(&self) -> usize {
        self.state.step
    }

    /// The network as it is, for a plain device.
    pub fn model(&self) -> UNet {
        self.model.valid()
    }

    /// Trains to the end, or until `progress` says `false`; leaves a checkpoint in both cases.
    ///
    /// # Errors
    /// [`Error::Train`] when the loss is no longer a number; whatever writing says.
    pub fn run(&mut self, mut progress: impl FnMut(&Progress) -> bool) -> Result<()> {
        let plain = self.device.clone().inner();
        let feed = batches(&self.config, &self.source, self.state.step..self.config.steps);
        let mut saved = Instant::now();
        while self.state.step < self.config.steps {
            let begin = Instant::now();
            let sample = feed.recv().map_err(|_| Error::Train { reason: "the data generator stopped".into() })?;
            self.optimise(sample)?;
            let done = self.state.step;
            let due = done.is_multiple_of(self.config.validate_every) || done == self.config.steps;
            let validation = due.then(|| self.judge.run(&self.model.valid(), &plain));
            self.state.seconds += begin.elapsed().as_secs_f64();
            let report = self.report(validation);
            if let Some(validation) = &report.validation {
                self.keep(&report, validation)?;
            }
            let go_on = progress(&report) && !self.is_stale();
            let finished = !go_on || done == self.config.steps;
            if finished || saved.elapsed().as_secs() >= self.config.checkpoint_seconds {
                checkpoint::save(&self.dir, &self.config, &self.state, &self.model, &self.optimizer)?;
                saved = Instant::now();
            }
            if !go_on {
                break;
            }
        }
        Ok(())
    }

    /// One step of Adam.
    fn optimise(&mut self, sample: Sample) -> Result<()> {
        let Cost { total, parts } = Cost::new(&self.model, sample, &self.config, &self.device);
        if !parts[0].is_finite() {
            let reason = format!("the loss at step {} is not a number; try a lower rate", self.state.step);
            return Err(Error::Train { reason });
        }
        let gradients = GradientsParams::from_grads(total.backward(), &self.model);
        let rate = self.config.rate_at(self.state.step);
        self.model = self.optimizer.step(rate, self.model.clone(), gradients);
        self.state.step += 1;
        let (sums, n) = &mut self.state.sums;
        sums.iter_mut().zip(parts).for_each(|(s, p)| *s += p);
        *n += 1;
        Ok(())
    }

    fn report(&self, validation: Option<Verdict>) -> Progress {
        let (sums, n) = self.state.sums;
        Progress {
            step: self.state.step,
            steps: self.config.steps,
            loss: sums.map(|s| s / n.max(1) as f64),
            seconds: self.state.seconds,
            validation,
        }
    }

    fn is_stale(&self) -> bool {
        self.config.patience > 0 && self.state.stale >= self.config.patience
    }

    /// Writes a line of metrics, and the weights if they are the best so far; `last.safetensors` is always written.
    fn keep(&mut self, report: &Progress, validation: &Verdict) -> Result<()> {
        self.state.sums = Default::default();
        let model = self.model.valid();
        save(&self.dir.join("last.safetensors"), &self.config.network, &model)?;
        self.state.stale += 1;
        if self.state.best.is_none_or(|best| validation.score() < best) {
            self.state.best = Some(validation.score());
            self.state.stale = 0;
            save(&self.dir.join("best.safetensors"), &self.config.network, &model)?;
            let device = self.device.clone().inner();
            self.judge.draw_examples(&model, &device, &self.dir.join("examples.png"))?;
        }
        let path = self.dir.join(METRICS);
        let names = Cost::names(self.config.network.output);
        append_metrics(&path, names, report, validation).map_err(|cause| Error::Write { path: path.clone(), cause })?;
        super::curves::draw(&path, &self.dir.join("curves.svg"))
    }
}

/// The file of metrics in a run's directory.
const METRICS: &str = "metrics.csv";

/// Drops the lines of metrics that a killed run wrote after its last checkpoint: those steps are done again.
fn forget_after(path: &Path, step: usize) -> Result<()> {
    let Ok(text) = fs::read_to_string(path) else { return Ok(()) };
    let done = |line: &&str| line.split(',').next().and_then(|n| n.parse().ok()).is_none_or(|n: usize| n <= step);
    let kept: String = text.lines().filter(done).flat_map(|line| [line, "\n"]).collect();
    write_file(path, kept.as_bytes())
}

/// Adds a line to the metrics, with names above the first.
fn append_metrics(path: &Path, names: [&str; 4], report: &Progress, validation: &Verdict) -> std::io::Result<()> {
    let fresh = !path.exists();
    let figures = validation.figures();
    let mut file = OpenOptions::new().create(true).append(true).open(path)?;
    if fresh {
        let of_validation = figures.iter().map(|(name, _)| name.as_str());
        let names: String = names.into_iter().chain(of_validation).flat_map(|name| [",", name]).collect();
        writeln!(file, "step,seconds{names}")?;
    }
    let values = report.loss.into_iter().chain(figures.iter().map(|(_, value)| *value));
    let values: String = values.map(|v| format!(",{v:.4e}")).collect();
    writeln!(file, "{},{:.0}{values}", report.step, report.seconds)
}
