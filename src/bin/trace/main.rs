//! `trace`: turns raster line drawings into editable strokes.

mod args;
mod batch;
mod eval;
mod failure;
mod field;
mod ink;
mod interrupt;
mod report;
mod source;
mod target;
#[cfg(feature = "train")]
mod train;
mod vectorize;
mod watch;

use args::{Cli, Command};
use clap::Parser;
use failure::Failure;
use std::process::ExitCode;

/// The stages and training make many large temporaries, which this allocator keeps for the next.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> ExitCode {
    match run(Cli::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("trace: {failure}");
            ExitCode::from(failure.code())
        }
    }
}

fn run(cli: Cli) -> Result<(), Failure> {
    match cli.command {
        Some(Command::Field(args)) => field::run(&args),
        Some(Command::Ink(args)) => ink::run(&args),
        Some(Command::Batch(args)) => batch::run(&args),
        None if batch::is_meant(&cli.trace) => batch::run(&cli.trace),
        Some(Command::Eval(args)) => eval::run(&args),
        #[cfg(feature = "train")]
        Some(Command::Train(args)) => train::run(&args),
        None => vectorize::run(&cli.trace),
    }
}
