//! `trace train CONFIG -o DIR`: trains the field network or the one that sees ink.

use crate::Error;
use crate::cancel::Cancel;
use crate::cli::args::TrainArgs;
use crate::cli::failure::Failure;
use crate::cli::interrupt;
use crate::train::{InkValidator, Progress, Start, TrainConfig, Trainer};
use crate::unet::Backend;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::path::Path;

/// Trains from the start, from weights, or from where a run was stopped.
pub(crate) fn run(args: &TrainArgs) -> Result<(), Failure> {
    let failed = |e: Error| Failure::of(&args.output.display().to_string(), &e);
    let device = Backend::named(&args.device.device).map_err(failed)?.to_train();
    let config = config(args).map_err(failed)?;
    if args.show {
        return show_pages(&config, &args.output).map_err(failed);
    }
    let start = match (&args.from, args.resume) {
        (_, true) => Start::Resume,
        (None, false) => Start::Fresh,
        (Some(name), false) if name == Path::new("built-in") => Start::BuiltIn,
        (Some(path), false) => Start::From(path.clone()),
    };
    let mut trainer = Trainer::new(config, &args.output, &device, &start).map_err(failed)?;
    if !args.talk.quiet {
        introduce(&trainer);
    }
    // The run ends after its step, with a checkpoint.
    let stop = interrupt::token().unwrap_or_else(|e| {
        eprintln!("trace: warning: an interrupt will not leave a checkpoint: {e}");
        Cancel::default()
    });
    let bar = bar(&trainer, args.talk.quiet);
    let result = trainer.run(|progress| {
        show(&bar, progress, args.talk.quiet);
        stop.check().is_ok()
    });
    bar.finish_and_clear();
    result.map_err(failed)?;
    if !args.talk.quiet {
        let (step, steps) = (trainer.step(), trainer.config().steps);
        let whole = step == steps;
        let how = if whole { "done" } else { "stopped; --resume goes on from here" };
        eprintln!(
            "trace: step {step} of {steps}: {how}; best weights in {}",
            args.output.join("best.safetensors").display()
        );
    }
    Ok(())
}

/// The file's configuration, or that of the run that goes on, with what the flags change.
fn config(args: &TrainArgs) -> crate::Result<TrainConfig> {
    let mut config = match (&args.config, args.resume) {
        (Some(path), _) => TrainConfig::read(path)?,
        (None, true) => TrainConfig::of_run(&args.output)?,
        (None, false) => TrainConfig::default(),
    };
    config.seed = args.seed.unwrap_or(config.seed);
    config.steps = args.steps.unwrap_or(config.steps);
    config.batch = args.batch.unwrap_or(config.batch);
    config.rate = args.rate.unwrap_or(config.rate);
    config.patience = args.patience.unwrap_or(config.patience);
    if let Some(folder) = &args.svgs {
        config.svgs = Some(folder.clone());
    }
    if let Some(folder) = &args.pages {
        config.pages = Some(folder.clone());
    }
    config.validate()?;
    Ok(config)
}

/// Draws what ink is validated on to a file in a folder.
fn show_pages(config: &TrainConfig, folder: &Path) -> crate::Result<()> {
    let path = folder.join("pages.png");
    std::fs::create_dir_all(folder).map_err(|cause| Error::Write { path: path.clone(), cause })?;
    InkValidator::new(config, &config.source()?.0).draw_pages(&path)
}

fn introduce(trainer: &Trainer) {
    for (path, reason) in trainer.skipped() {
        eprintln!("trace: {}: left out: {reason}", path.display());
    }
    let (config, drawings) = (trainer.config(), trainer.source().len());
    let others = if drawings == 0 { String::new() } else { format!(" and of {drawings} drawings") };
    let (step, steps, seed) = (trainer.step(), config.steps, config.seed);
    eprintln!("trace: steps {step} to {steps} on synthetic sheets{others}, seed {seed}");
}

fn bar(trainer: &Trainer, quiet: bool) -> ProgressBar {
    let visible = !quiet && std::io::stderr().is_terminal();
    let target = if visible { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
    let bar = ProgressBar::with_draw_target(Some(trainer.config().steps as u64), target);
    let style = ProgressStyle::with_template("{bar:30} {pos}/{len}  {msg}  {eta} left");
    bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    bar.set_position(trainer.step() as u64);
    bar.reset_eta();
    bar
}

fn show(bar: &ProgressBar, progress: &Progress, quiet: bool) {
    bar.set_position(progress.step as u64);
    let loss = progress.loss[0];
    bar.set_message(format!("loss {loss:.4}"));
    let Some(validation) = &progress.validation else { return };
    if quiet {
        return;
    }
    let line = format!("step {}, {:.0} s: loss {loss:.4}; {validation}", progress.step, progress.seconds);
    if bar.is_hidden() { eprintln!("{line}") } else { bar.println(line) }
}
