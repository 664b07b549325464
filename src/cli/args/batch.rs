//! Many drawings in one go.

use super::parse_number;
use crate::batch::Share;
use clap::Args;
use std::path::PathBuf;
use std::time::Duration;

/// How drawings are traced in one go.
#[derive(Debug, Args)]
#[command(next_help_heading = "Batch")]
pub(crate) struct BatchArgs {
    /// Also take the folders in a folder, and keep their tree
    #[arg(short, long)]
    pub(crate) recursive: bool,
    /// Read more inputs from a file, one a line; `-` is standard input
    #[arg(long, value_name = "FILE")]
    pub(crate) manifest: Option<PathBuf>,
    /// Take share I of N of the sorted inputs
    #[arg(long, value_name = "I/N")]
    pub(crate) shard: Option<Share>,
    /// Threads [default: one for each core]
    #[arg(short, long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) jobs: Option<u16>,
    /// Give up on a file after this time
    #[arg(long, value_name = "SECONDS", value_parser = parse_seconds, allow_negative_numbers = true)]
    pub(crate) timeout: Option<Duration>,
    /// Write a record for each file to standard output, as JSON lines in the order of the inputs
    #[arg(long)]
    pub(crate) json: bool,
}

impl BatchArgs {
    /// Whether any was given that names several inputs.
    pub(crate) fn names_several(&self) -> bool {
        self.recursive || self.manifest.is_some() || self.shard.is_some()
    }

    /// Whether any was given that is about how a batch runs; one file is then a batch of one.
    pub(crate) fn is_about_running(&self) -> bool {
        self.json || self.jobs.is_some() || self.timeout.is_some()
    }
}

fn parse_seconds(text: &str) -> Result<Duration, String> {
    let seconds = parse_number(text)?;
    let time = Duration::try_from_secs_f64(seconds).ok().filter(|time| !time.is_zero());
    time.ok_or_else(|| "not a time in seconds".into())
}
