//! What each pass between streamlines and graph is worth: `cargo bench --bench passes -- FOLDER KIND ...`
//!
//! A folder holds truths NAME.gt.svg and rasters NAME.KIND of each kind, whatever follows. For each kind: the mean figures of
//! all drawings, and for each pass by how much they change, in thousandths, when it is left out, in how many drawings it did
//! something, and its milliseconds for a drawing.

use fieldtrace::clean::LineImage;
use fieldtrace::error::Result;
use fieldtrace::graph::{Line, Pass, Ran, StrokeGraph, passes};
use fieldtrace::hooks::Observer;
use fieldtrace::load::{LoadOptions, Scan, load};
use fieldtrace::metrics::Truth;
use fieldtrace::options::Options;
use fieldtrace::pipeline::Vectorizer;
use fieldtrace::write::{WriteOptions, to_svg};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// Figures of a trace: junction_f1, endpoint_f1, integrity, purity.
type Figures = [f64; 4];

/// A drawing with all passes, and without each that did something.
struct Case {
    all: Figures,
    without: BTreeMap<&'static str, Figures>,
    seconds: BTreeMap<&'static str, f64>,
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with("--")).collect();
    let [folder, kinds @ ..] = &words[..] else {
        println!("passes: no folder is given");
        return;
    };
    for kind in kinds {
        let inputs = inputs(Path::new(folder), kind);
        let cases: Vec<Case> = inputs.par_iter().filter_map(|(scan, truth)| case(scan, truth).ok()).collect();
        print(kind, &cases);
    }
}

/// The scans of a kind with their truths.
fn inputs(folder: &Path, kind: &str) -> Vec<(Scan, Truth)> {
    let mut names: Vec<String> = fs::read_dir(folder)
        .expect("a folder")
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .collect();
    names.sort();
    let of_name = |file: &String| {
        let (name, rest) = file.split_once('.')?;
        if !rest.starts_with(kind) {
            return None;
        }
        let scan = load(&folder.join(file), &LoadOptions::default()).ok()?.scan;
        let size = scan.gray.size();
        let options = LoadOptions::default().with(|o| o.size = u32::try_from(size.0.max(size.1)).ok());
        let drawing = load(&folder.join(format!("{name}.gt.svg")), &options).ok()?.drawing?;
        Some((scan, Truth::new(&drawing, size)?))
    };
    names.iter().filter_map(of_name).collect()
}

fn case(scan: &Scan, truth: &Truth) -> Result<Case> {
    let mut worked = Worked::default();
    let all = figures(&vectorizer()?, scan, truth, &mut worked)?;
    let changed = worked.0.iter().filter(|(_, (changes, _))| *changes > 0).map(|(name, _)| *name);
    let without = changed.map(|name| Ok((name, figures(&vectorizer()?.without(name)?, scan, truth, &mut ())?)));
    let without = without.collect::<Result<_>>()?;
    Ok(Case { all, without, seconds: worked.0.into_iter().map(|(name, (_, seconds))| (name, seconds)).collect() })
}

fn vectorizer() -> Result<Vectorizer> {
    Vectorizer::new(Options::default())
}

fn figures(vectorizer: &Vectorizer, scan: &Scan, truth: &Truth, observer: &mut dyn Observer) -> Result<Figures> {
    let drawing = vectorizer.trace_observed(scan, observer)?;
    let score = truth.score(&to_svg(&drawing, &WriteOptions::default()))?;
    Ok([score.junction_f1, score.endpoint_f1, score.integrity, score.purity])
}

/// How much each pass changed, and its seconds.
#[derive(Default)]
struct Worked(BTreeMap<&'static str, (usize, f64)>);

impl Worked {
    fn add(&mut self, ran: &Ran) -> Result<()> {
        let (changes, seconds) = self.0.entry(ran.pass.name).or_default();
        (*changes, *seconds) = (*changes + ran.changes, *seconds + ran.seconds);
        Ok(())
    }
}

impl Observer for Worked {
    fn on_lines(&mut self, _: &LineImage, ran: &Ran, _: &[Line]) -> Result<()> {
        self.add(ran)
    }

    fn on_finish(&mut self, _: &LineImage, ran: &Ran, _: &StrokeGraph) -> Result<()> {
        self.add(ran)
    }
}

fn print(kind: &str, cases: &[Case]) {
    let mean = |of: &dyn Fn(&Case) -> f64| cases.iter().map(of).sum::<f64>() / cases.len().max(1) as f64;
    println!("{kind:<18} drawings  junction_f1  endpoint_f1  integrity  purity      ms");
    let [j, e, i, p] = [0, 1, 2, 3].map(|k| mean(&|case| case.all[k]));
    println!("{:<18} {:>8}  {j:>11.3}  {e:>11.3}  {i:>9.3}  {p:>6.3}", "all", cases.len());
    for Pass { name, .. } in passes() {
        let change = |k: usize| mean(&|case| case.without.get(name).map_or(0.0, |of| 1e3 * (of[k] - case.all[k])));
        let [j, e, i, p] = [0, 1, 2, 3].map(change);
        let count = cases.iter().filter(|case| case.without.contains_key(name)).count();
        let ms = mean(&|case| 1e3 * case.seconds.get(name).copied().unwrap_or_default());
        println!("{name:<18} {count:>8}  {j:>+11.1}  {e:>+11.1}  {i:>+9.1}  {p:>+6.1}  {ms:>6.2}");
    }
}
