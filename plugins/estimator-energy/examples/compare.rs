//! The estimators side by side: the angular error of their fields, the time that they take, and how the traces under
//! them do.
//!
//! `cargo run --release -p fieldtrace-estimator-energy --example compare -- FOLDER KIND`, the folder holding rasters
//! `NAME.KIND.EXT` and their true strokes as `NAME.gt.svg`.

use fieldtrace::estimate::{FieldEstimator, StructureTensor, UNet};
use fieldtrace::load::{LoadOptions, load};
use fieldtrace::metrics::{Measurement, Truth, measure};
use fieldtrace::options::Options;
use fieldtrace::pipeline::Vectorizer;
use fieldtrace_estimator_energy::EnergyEstimator;
use std::path::{Path, PathBuf};

fn main() -> anyhow::Result<()> {
    let mut words = std::env::args().skip(1);
    let (Some(folder), Some(kind)) = (words.next(), words.next()) else {
        anyhow::bail!("give a folder and a kind, such as clean");
    };
    let rasters = rasters(Path::new(&folder), &kind)?;
    anyhow::ensure!(!rasters.is_empty(), "{folder}: holds no NAME.{kind}.EXT");
    let estimators: [Box<dyn FieldEstimator>; 3] =
        [Box::new(StructureTensor::default()), Box::new(EnergyEstimator::default()), Box::new(UNet::built_in()?)];
    println!(
        "{:10} {:>9} {:>13} {:>15} {:>11} {:>9} {:>7}",
        kind, "ink, deg", "junction, deg", "field, s per MP", "junction_f1", "integrity", "purity"
    );
    for estimator in estimators {
        let name = estimator.name().to_owned();
        let vectorizer = Vectorizer::with(Options::default(), estimator)?;
        let all = rasters.iter().map(|raster| of(&vectorizer, raster, &kind)).collect::<anyhow::Result<Vec<_>>>()?;
        let mean = |figure: fn(&Measurement) -> f64| {
            let defined: Vec<f64> = all.iter().map(figure).filter(|v| v.is_finite()).collect();
            defined.iter().sum::<f64>() / defined.len() as f64
        };
        let total = |figure: fn(&Measurement) -> f64| all.iter().map(figure).sum::<f64>();
        let speed = total(|m| m.field_seconds) / total(|m| m.megapixels);
        let angles = format!("{:>9.3} {:>13.3}", mean(|m| m.field.ink), mean(|m| m.field.junction));
        let junction = mean(|m| m.lines.junction_f1);
        let (integrity, purity) = (mean(|m| m.lines.integrity), mean(|m| m.lines.purity));
        println!("{name:10} {angles} {speed:>15.3} {junction:>11.3} {integrity:>9.3} {purity:>7.3}");
    }
    Ok(())
}

/// The rasters of a kind in a folder, sorted.
fn rasters(folder: &Path, kind: &str) -> anyhow::Result<Vec<PathBuf>> {
    let mut all = Vec::new();
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        if path.file_stem().is_some_and(|stem| stem.to_string_lossy().ends_with(&format!(".{kind}"))) {
            all.push(path);
        }
    }
    all.sort();
    Ok(all)
}

/// The figures of a raster.
fn of(vectorizer: &Vectorizer, raster: &Path, kind: &str) -> anyhow::Result<Measurement> {
    let scan = load(raster, &LoadOptions::default())?.scan;
    let name = raster.with_extension("").to_string_lossy().into_owned();
    let truth = PathBuf::from(name.trim_end_matches(kind)).with_extension("gt.svg");
    let size = u32::try_from(scan.gray.width().max(scan.gray.height())).ok();
    let drawing = load(&truth, &LoadOptions::default().with(|o| o.size = size))?.drawing;
    let truth = drawing.and_then(|d| Truth::new(&d, scan.gray.size()));
    let truth = truth.ok_or_else(|| anyhow::anyhow!("{}: has no true strokes", raster.display()))?;
    Ok(measure(vectorizer, &scan, &truth)?)
}
