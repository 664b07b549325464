//! `trace IN`: a drawing to SVG, to its stroke graph, or to both.

use crate::args::TraceArgs;
use crate::failure::Failure;
use crate::source;
use crate::target;
use crate::watch::{Stages, Watch};
use fieldtrace::Error;
use fieldtrace::graph::StrokeGraph;
use fieldtrace::inspect::{DebugDir, NO_DRAWING};
use fieldtrace::load::{Scan, load_bytes, read_bytes};
use fieldtrace::write::graph_json::{from_json, is_json, to_json};
use fieldtrace::write::{SvgOptions, to_svg, write_file};
use std::path::Path;

/// The warning about a drawing without strokes.
pub(crate) const EMPTY: &str = "no ink was found, the drawing is empty";
/// The warning about a photograph or a painting.
pub(crate) const UNLIKE: &str = "looks like no line drawing: its lines follow edges between light and dark, not ink";

/// What is to be traced: an image, or a graph of an earlier trace.
enum Source {
    Scan(Scan),
    Graph(StrokeGraph),
}

/// Reads, traces and writes one drawing.
pub(crate) fn run(args: &TraceArgs) -> Result<(), Failure> {
    let [input] = args.inputs.as_slice() else { return Err(Failure::Usage("no input is given".into())) };
    let name = target::name(input);
    let failed = |e: Error| Failure::of(&name, &e);
    let vectorizer = source::vectorizer(&args.source, &args.clean, Some(&args.fit)).map_err(failed)?;
    let output = target::output_path(input, args.output.as_deref())?;
    let graph_path = target::graph_path(input, &output, args.graph.as_deref())?;

    let mut stages = Stages::start(args.talk.verbose);
    let source = read(input, args, &mut stages).map_err(failed)?;
    let debug = debug_dir(&source, args.debug_dir.as_deref(), &name)?;
    let scan = match &source {
        Source::Scan(scan) => Some(scan),
        Source::Graph(_) => None,
    };
    let mut watch = Watch { stages: &mut stages, debug, streamlines: 0, scan, edge_share: 0.0 };
    let graph = match &source {
        Source::Scan(scan) => vectorizer.graph(scan, &mut watch).map_err(failed)?,
        Source::Graph(graph) => graph.clone(),
    };
    let drawing = vectorizer.draw(&graph, &mut watch).map_err(failed)?;
    let edge_share = watch.edge_share;
    if let Some(path) = graph_path {
        put(path, &to_json(&graph), &mut stages).map_err(failed)?;
    }
    if target::extension(&output) == "json" {
        put(&output, &to_json(&graph), &mut stages).map_err(failed)?;
    } else {
        let svg = to_svg(&drawing, &SvgOptions { precision: args.precision, title: title(input) });
        put(&output, &svg, &mut stages).map_err(failed)?;
    }
    let is_empty = drawing.strokes.is_empty() && drawing.fills.is_empty();
    for warning in [(is_empty, EMPTY), (edge_share > NO_DRAWING, UNLIKE)].iter().filter(|(is_due, _)| *is_due) {
        if !args.talk.quiet {
            eprintln!("trace: {name}: warning: {}", warning.1);
        }
    }
    Ok(())
}

fn read(input: &Path, args: &TraceArgs, stages: &mut Stages) -> fieldtrace::Result<Source> {
    let (name, bytes, options) = (input.display().to_string(), read_bytes(input)?, args.load.options());
    if is_json(&bytes) {
        let mut graph = from_json(&name, &bytes)?;
        graph.page.dpi = options.dpi.or(graph.page.dpi);
        stages.done("load", || format!("{} strokes, {} nodes", graph.trails.len(), graph.graph.node_count()));
        return Ok(Source::Graph(graph));
    }
    let scan = load_bytes(&name, &bytes, &options)?.scan;
    stages.done("load", || format!("{} x {} pixels", scan.gray.width(), scan.gray.height()));
    Ok(Source::Scan(scan))
}

fn debug_dir<'a>(source: &'a Source, folder: Option<&Path>, name: &str) -> Result<Option<DebugDir<'a>>, Failure> {
    match (folder, source) {
        (None, _) => Ok(None),
        (Some(folder), Source::Scan(scan)) => {
            DebugDir::create(folder, scan).map(Some).map_err(|e| Failure::of(name, &e))
        }
        (Some(_), Source::Graph(_)) => {
            Err(Failure::Usage(format!("{name}: --debug-dir lays its pictures over an image, and this is a graph")))
        }
    }
}

fn put(path: &Path, text: &str, stages: &mut Stages) -> fieldtrace::Result<()> {
    write_file(path, text.as_bytes())?;
    stages.done("write", || format!("{} bytes to {}", text.len(), target::name(path)));
    Ok(())
}

/// The document's title: the input's file name.
fn title(input: &Path) -> Option<String> {
    let name = input.file_name().filter(|_| !target::is_stream(input))?;
    Some(name.to_string_lossy().into_owned())
}
