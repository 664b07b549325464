//! The command line: `trace` turns raster line drawings into editable strokes.

mod args;
mod batch;
mod eval;
mod failure;
mod field;
mod help;
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
use std::ffi::OsString;
use std::process::ExitCode;

/// Runs the command on the program's arguments.
pub fn main() -> ExitCode {
    main_with(std::env::args_os())
}

/// Runs the command on arguments, of which the first is the program's name; the process ends where they ask for help or
/// cannot be understood.
pub fn main_with(args: impl IntoIterator<Item = OsString>) -> ExitCode {
    match run(Cli::parse_from(args)) {
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
        Some(Command::Eval(args)) => eval::run(&args),
        #[cfg(feature = "train")]
        Some(Command::Train(args)) => train::run(&args),
        #[cfg(not(feature = "train"))]
        Some(Command::Train(_)) => Err(Failure::Usage(args::NO_TRAINING.into())),
        Some(Command::Completions { shell }) => help::completions(shell),
        Some(Command::Man) => help::man(),
        None => {
            help::refuse_misspelt(&cli.trace.inputs)?;
            if batch::is_meant(&cli.trace) { batch::run(&cli.trace) } else { vectorize::run(&cli.trace) }
        }
    }
}
