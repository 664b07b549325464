//! Writes the energy's field of a drawing, or the drawing traced under that field.
//!
//! `cargo run --release -p fieldtrace-estimator-energy --example energy_field -- IN -o F.npz` (or `OUT.svg`)

use clap::Parser;
use fieldtrace::field::write_npz;
use fieldtrace::load::{LoadOptions, load};
use fieldtrace::options::Options;
use fieldtrace::pipeline::Vectorizer;
use fieldtrace::write::{WriteOptions, to_svg, write_file};
use fieldtrace_estimator_energy::EnergyEstimator;
use std::io::Cursor;
use std::path::PathBuf;

/// The field of a drawing by energy minimisation, or the drawing traced under it.
#[derive(Parser)]
struct Args {
    /// The drawing.
    input: PathBuf,
    /// Where the result goes: `.npz` for the field, `.svg` for the traced drawing.
    #[arg(short, long)]
    output: PathBuf,
    /// Weight of the smoothness term.
    #[arg(long, default_value_t = EnergyEstimator::default().smoothness)]
    smoothness: f64,
    /// Weight of the term that asks for the normal as second direction.
    #[arg(long, default_value_t = EnergyEstimator::default().normal)]
    normal: f64,
}

fn main() -> anyhow::Result<()> {
    let args = Args::parse();
    let estimator = EnergyEstimator { smoothness: args.smoothness, normal: args.normal, ..EnergyEstimator::default() };
    let vectorizer = Vectorizer::new(Options::default())?.with_estimator(estimator);
    let scan = load(&args.input, &LoadOptions::default())?.scan;
    let bytes = match args.output.extension().and_then(|e| e.to_str()) {
        Some("npz") => {
            let mut bytes = Cursor::new(Vec::new());
            write_npz(&vectorizer.field(&scan)?, &mut bytes)?;
            bytes.into_inner()
        }
        Some("svg") => to_svg(&vectorizer.trace(&scan)?, &WriteOptions::default()).into_bytes(),
        _ => anyhow::bail!("{}: the output is .npz or .svg", args.output.display()),
    };
    write_file(&args.output, &bytes)?;
    Ok(())
}
