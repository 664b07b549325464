//! How inputs are read.

use super::parse_number;
use clap::Args;
use fieldtrace::load::LoadOptions;

/// How the input is read.
#[derive(Debug, Args)]
#[command(next_help_heading = "Input")]
pub(crate) struct LoadArgs {
    /// Dots per inch, in place of what the input says; sizes the output in millimetres, and an SVG
    /// input's rendering in pixels
    #[arg(long, value_name = "DPI", value_parser = parse_dpi, allow_negative_numbers = true)]
    dpi: Option<f64>,
    /// Pixels along the longer side of an SVG input's rendering
    #[arg(long, value_name = "PX", value_parser = clap::value_parser!(u32).range(1..=65535))]
    size: Option<u32>,
    /// Refuse inputs of more pixels than this
    #[arg(long, value_name = "N", default_value_t = LoadOptions::default().max_pixels,
          value_parser = clap::value_parser!(u64).range(1..))]
    max_pixels: u64,
}

impl LoadArgs {
    /// The library's form.
    pub(crate) fn options(&self) -> LoadOptions {
        LoadOptions { max_pixels: self.max_pixels, dpi: self.dpi, size: self.size }
    }
}

fn parse_dpi(text: &str) -> Result<f64, String> {
    let dpi = parse_number(text)?;
    if (1.0..=100_000.0).contains(&dpi) { Ok(dpi) } else { Err("not between 1 and 100000".into()) }
}
