//! `trace eval IN...`: how good traces are.

mod cases;
mod report;

use crate::args::{self, EvalArgs};
use crate::failure::Failure;
use crate::source;
use crate::target;
use cases::Case;
use fieldtrace::drawing::Drawing;
use fieldtrace::load::{LoadOptions, Scan, load};
use fieldtrace::metrics::{Measurement, Truth, measure};
use fieldtrace::pipeline::Vectorizer;
use fieldtrace::write::write_file;
use report::{Report, Row};
use std::path::Path;

/// Traces every drawing under every estimator and tells the figures.
pub(crate) fn run(args: &EvalArgs) -> Result<(), Failure> {
    let cases = cases::find(&args.inputs, &args.kind)?;
    let vectorizers = vectorizers(args)?;
    let mut report = Report::default();
    for case in &cases {
        match rows(case, &vectorizers, args) {
            Ok(rows) => report.rows.extend(rows),
            Err(reason) => {
                if !args.quiet {
                    eprintln!("trace: {reason}: left out");
                }
                report.left_out.push(reason);
            }
        }
    }
    if report.rows.is_empty() {
        return Err(Failure::File(format!("{}: nothing could be compared", target::name(&args.inputs[0]))));
    }
    let write =
        |path: &Path, text: String| write_file(path, text.as_bytes()).map_err(|e| Failure::of(&target::name(path), &e));
    if !args.json.as_deref().is_some_and(target::is_stream) {
        write(Path::new("-"), report.table(args.files))?;
    }
    if let Some(path) = &args.json {
        write(path, report.json())?;
    }
    Ok(())
}

/// The tracers to compare, with the names of their estimators.
fn vectorizers(args: &EvalArgs) -> Result<Vec<(String, Vectorizer)>, Failure> {
    let options = args::options(&args.clean, Some(&args.fit));
    let mut all = Vec::new();
    for &kind in &args.estimators {
        let estimator = source::estimator(kind, &args.network);
        let named = |e: Box<dyn fieldtrace::estimate::FieldEstimator>| {
            let name = e.name().to_owned();
            Vectorizer::with(options.clone(), e).map(|v| (name, v))
        };
        all.push(estimator.and_then(named).map_err(|e| Failure::of(&target::name(&args.inputs[0]), &e))?);
    }
    Ok(all)
}

/// The figures of one drawing under each estimator, or why there are none.
fn rows(case: &Case, vectorizers: &[(String, Vectorizer)], args: &EvalArgs) -> Result<Vec<Row>, String> {
    let name = target::name(case.input());
    let reason = |e: fieldtrace::Error| Failure::of(&name, &e).to_string();
    let (scan, drawing) = read(case, &args.load.options()).map_err(reason)?;
    let truth = drawing.and_then(|d| Truth::new(&d, scan.gray.size()));
    let Some(truth) = truth else { return Err(format!("{}: has no strokes", target::name(&case.truth))) };
    let row = |(estimator, vectorizer): &(String, Vectorizer)| {
        let measurement: Measurement = measure(vectorizer, &scan, &truth).map_err(reason)?;
        Ok(Row { case: case.clone(), estimator: estimator.clone(), measurement })
    };
    vectorizers.iter().map(row).collect()
}

/// What is traced, and the true strokes at its size.
fn read(case: &Case, options: &LoadOptions) -> fieldtrace::Result<(Scan, Option<Drawing>)> {
    let Some(raster) = &case.raster else {
        let input = load(&case.truth, options)?;
        return Ok((input.scan, input.drawing));
    };
    let scan = load(raster, options)?.scan;
    let (width, height) = scan.gray.size();
    let size = u32::try_from(width.max(height)).ok();
    Ok((scan, load(&case.truth, &LoadOptions { size, ..options.clone() })?.drawing))
}
