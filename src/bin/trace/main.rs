//! `trace`: turns raster line drawings into editable strokes.

mod args;
mod batch;
mod failure;
mod field;
mod report;
mod target;
mod vectorize;
mod watch;

use args::{Cli, Command};
use clap::Parser;
use failure::Failure;
use std::process::ExitCode;

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
        Some(Command::Batch(args)) => batch::run(&args),
        None if batch::is_meant(&cli.trace) => batch::run(&cli.trace),
        None => vectorize::run(&cli.trace),
    }
}
