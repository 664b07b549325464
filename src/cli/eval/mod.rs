//! `trace eval IN...`: how good traces are.

mod cases;
mod pages;
mod report;

use crate::cli::args::{self, EvalArgs};
use crate::cli::failure::Failure;
use crate::cli::source;
use crate::cli::target;
use crate::drawing::Drawing;
use crate::inspect::{comparison_overlay, to_png};
use crate::load::{LoadOptions, Scan, load};
use crate::metrics::{Truth, measure};
use crate::pipeline::Vectorizer;
use crate::write::write_file;
use cases::Case;
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
    if let Some(folder) = &args.report {
        pages::write(folder, &report, args.worst, |row| picture(row, &vectorizers, args))?;
    }
    Ok(())
}

/// A trace, made once more, over its truth.
fn picture(row: &Row, vectorizers: &[(String, Vectorizer)], args: &EvalArgs) -> Result<Vec<u8>, Failure> {
    let Loaded { scan, drawing, truth } = read(&row.case, &args.load.options()).map_err(Failure::File)?;
    let ran = vectorizers.iter().find(|(name, _)| *name == row.estimator);
    let (_, vectorizer) = ran.expect("an estimator with a row");
    let picture = vectorizer.trace(&scan).and_then(|t| to_png(&comparison_overlay(&scan, &drawing, &t, truth.pen())));
    picture.map_err(|e| Failure::of(&target::name(row.case.input()), &e))
}

/// The tracers to compare, with the names of their estimators.
fn vectorizers(args: &EvalArgs) -> Result<Vec<(String, Vectorizer)>, Failure> {
    let options = args::options(&args.clean, Some(&args.fit));
    let mut all = Vec::new();
    for &kind in &args.estimators {
        let estimator = source::estimator(kind, &args.network);
        let named = |e: Box<dyn crate::estimate::FieldEstimator>| {
            let name = e.name().to_owned();
            Vectorizer::with(options.clone(), e).map(|v| (name, v))
        };
        all.push(estimator.and_then(named).map_err(|e| Failure::of(&target::name(&args.inputs[0]), &e))?);
    }
    Ok(all)
}

/// The figures of one drawing under each estimator, or why there are none.
fn rows(case: &Case, vectorizers: &[(String, Vectorizer)], args: &EvalArgs) -> Result<Vec<Row>, String> {
    let Loaded { scan, truth, .. } = read(case, &args.load.options())?;
    let row = |(estimator, vectorizer): &(String, Vectorizer)| {
        let measurement = measure(vectorizer, &scan, &truth).map_err(|e| reason(case.input(), &e))?;
        Ok(Row { case: case.clone(), estimator: estimator.clone(), measurement })
    };
    vectorizers.iter().map(row).collect()
}

/// What is traced, and the true strokes at its size.
struct Loaded {
    scan: Scan,
    drawing: Drawing,
    truth: Truth,
}

/// Reads a case, or tells why it cannot be compared.
fn read(case: &Case, options: &LoadOptions) -> Result<Loaded, String> {
    let of = |path: &Path, options: &LoadOptions| load(path, options).map_err(|e| reason(case.input(), &e));
    let (scan, drawing) = match &case.raster {
        None => {
            let input = of(&case.truth, options)?;
            (input.scan, input.drawing)
        }
        Some(raster) => {
            let scan = of(raster, options)?.scan;
            let (width, height) = scan.gray.size();
            let size = u32::try_from(width.max(height)).ok();
            (scan, of(&case.truth, &LoadOptions { size, ..options.clone() })?.drawing)
        }
    };
    let drawing = drawing.unwrap_or_default();
    let truth = Truth::new(&drawing, scan.gray.size());
    let truth = truth.ok_or_else(|| format!("{}: has no strokes", target::name(&case.truth)))?;
    Ok(Loaded { scan, drawing, truth })
}

fn reason(input: &Path, error: &crate::Error) -> String {
    Failure::of(&target::name(input), error).to_string()
}
