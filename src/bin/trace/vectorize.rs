//! `trace IN`: a drawing to SVG.

use crate::args::{self, TraceArgs};
use crate::failure::Failure;
use crate::source;
use crate::target;
use crate::watch::{Stages, Watch};
use fieldtrace::drawing::Drawing;
use fieldtrace::inspect::DebugDir;
use fieldtrace::load::{Scan, load};
use fieldtrace::pipeline::Vectorizer;
use fieldtrace::write::{SvgOptions, to_svg, write_file};
use std::path::Path;

/// Reads, traces and writes one drawing.
pub(crate) fn run(args: &TraceArgs) -> Result<(), Failure> {
    let Some(input) = &args.input else { return Err(Failure::Usage("no input is given".into())) };
    let name = target::name(input);
    let failed = |e: fieldtrace::Error| Failure::of(&name, &e);
    let vectorizer = source::estimator(args.source.estimator, &args.source.network)
        .and_then(|source| Vectorizer::with(args::options(&args.clean, Some(&args.fit)), source))
        .map_err(failed)?;
    let output = target::svg_path(input, args.output.as_deref())?;

    let mut stages = Stages::start(args.talk.verbose);
    let scan = load(input, &args.load.options()).map_err(failed)?.scan;
    stages.done("load", || format!("{} x {} pixels", scan.gray.width(), scan.gray.height()));
    let drawing = trace(&vectorizer, &scan, args.debug_dir.as_deref(), &mut stages).map_err(failed)?;
    let svg = to_svg(&drawing, &SvgOptions { precision: args.precision, title: title(input) });
    write_file(&output, svg.as_bytes()).map_err(failed)?;
    stages.done("write", || format!("{} bytes to {}", svg.len(), target::name(&output)));
    if drawing.strokes.is_empty() && drawing.fills.is_empty() && !args.talk.quiet {
        eprintln!("trace: {name}: warning: no ink was found, the drawing is empty");
    }
    Ok(())
}

fn trace(
    vectorizer: &Vectorizer,
    scan: &Scan,
    debug_dir: Option<&Path>,
    stages: &mut Stages,
) -> fieldtrace::Result<Drawing> {
    let debug = debug_dir.map(|folder| DebugDir::create(folder, scan)).transpose()?;
    vectorizer.trace_observed(scan, &mut Watch { stages, debug, streamlines: 0 })
}

/// The document's title: the input's file name.
fn title(input: &Path) -> Option<String> {
    let name = input.file_name().filter(|_| !target::is_stream(input))?;
    Some(name.to_string_lossy().into_owned())
}
