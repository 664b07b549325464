//! `trace IN`: a drawing to its output, or each page of a document to one of its own.

use super::args::TraceArgs;
use super::failure::Failure;
use super::source;
use super::target;
use super::watch::{Progress, Stages, Watch};
use crate::Error;
use crate::batch::{FileTracer, page_path, title_of};
use crate::drawing::Drawing;
use crate::graph::StrokeGraph;
use crate::inspect::{DebugDir, NO_DRAWING};
use crate::load::{Input, pages_of_bytes, read_bytes};
use crate::write::graph_json::{from_json, is_json};
use crate::write::{Document, WriteOptions, format_named};
use std::path::Path;

/// The warning about a drawing without strokes.
pub(crate) const EMPTY: &str = "no ink was found, the drawing is empty";
/// The warning about a photograph or a painting.
pub(crate) const UNLIKE: &str = "looks like no line drawing: its lines follow edges between light and dark, not ink";

/// Reads, traces and writes one drawing.
pub(crate) fn run(args: &TraceArgs) -> Result<(), Failure> {
    let [input] = args.inputs.as_slice() else { return Err(Failure::Usage("no input is given".into())) };
    let name = target::name(input);
    let failed = |e: Error| Failure::of(&name, &e);
    let format = args.out.format(args.output.as_deref())?;
    let output = target::output_path(input, args.output.as_deref(), format.name())?;
    let graph_path = target::graph_path(input, &output, args.out.graph.as_deref())?;
    let progress = Progress::start(&args.talk);
    let vectorizer = source::vectorizer(&args.source, &args.clean, Some((&args.fit, format))).map_err(failed)?;
    let vectorizer = vectorizer.reporting(progress.teller());
    let (load, write) = (args.load.options(), args.out.options());
    let tracer = FileTracer { load, format, write, force: args.out.force, ..FileTracer::new(vectorizer) };
    let mut job = Job { args, tracer: &tracer, input, name: &name, stages: Stages::start(args.talk.verbose) };

    let bytes = read_bytes(input).map_err(failed)?;
    if is_json(&bytes) {
        return job.graph(&bytes, &output, graph_path);
    }
    let pages = pages_of_bytes(&input.display().to_string(), &bytes, &tracer.load).map_err(failed)?;
    let several = pages.numbers().count() > 1;
    if several {
        job.refuse_for_several(&output, pages.count())?;
    }
    for (number, page) in pages.iter() {
        let page = page.map_err(failed)?;
        let scan = &page.scan;
        job.stages.done("load", || format!("{} x {} pixels", scan.gray.width(), scan.gray.height()));
        if several {
            progress.page(number, pages.count());
            let place = |path: &Path| page_path(path, number);
            job.scan(&page, &bytes, Some(number), &place(&output), graph_path.map(place).as_deref())?;
        } else {
            job.scan(&page, &bytes, None, &output, graph_path)?;
        }
    }
    if several && !args.talk.quiet {
        let [first, last] = [*pages.numbers().start(), *pages.numbers().end()].map(|n| page_path(&output, n));
        eprintln!("trace: {name}: {} pages, to {} to {}", pages.count(), target::name(&first), target::name(&last));
    }
    Ok(())
}

/// One input and what is done with it.
struct Job<'a> {
    args: &'a TraceArgs,
    tracer: &'a FileTracer,
    input: &'a Path,
    name: &'a str,
    stages: Stages,
}

impl<'a> Job<'a> {
    fn failed(&self) -> impl Fn(Error) -> Failure + Copy + use<'a> {
        let name = self.name;
        move |e| Failure::of(name, &e)
    }

    /// What cannot be done with more than one page.
    fn refuse_for_several(&self, output: &Path, pages: usize) -> Result<(), Failure> {
        let usage = |what: &str| Err(Failure::Usage(format!("{}: has {pages} pages, {what}", self.name)));
        if target::is_stream(output) {
            return usage("and standard output takes one: name it with --page");
        }
        if self.args.out.debug_dir.is_some() {
            return usage("and --debug-dir shows one: name it with --page");
        }
        Ok(())
    }

    /// Traces an image.
    fn scan(
        &mut self,
        input: &Input,
        bytes: &[u8],
        page: Option<usize>,
        output: &Path,
        graph_path: Option<&Path>,
    ) -> Result<(), Failure> {
        let failed = self.failed();
        let (scan, frame) = (&input.scan, input.frame.clone());
        let folder = self.args.out.debug_dir.as_deref();
        let debug = folder.map(|folder| DebugDir::create(folder, scan)).transpose().map_err(failed)?;
        let mut watch = Watch { stages: &mut self.stages, debug, streamlines: 0, scan: Some(scan), edge_share: 0.0 };
        let graph = self.tracer.vectorizer.graph(scan, &mut watch).map_err(failed)?;
        let drawing = self.tracer.vectorizer.draw(&graph, &mut watch).map_err(failed)?;
        let is_unlike = watch.edge_share > NO_DRAWING;
        let origin = self.tracer.origin(bytes, page);
        let options = self.tracer.source(self.input, bytes, scan, frame, &origin);
        self.write(&graph, &drawing, options, output, graph_path)?;
        let is_empty = drawing.strokes.is_empty() && drawing.fills.is_empty();
        let where_to = page.map_or(String::new(), |page| format!(", page {page}"));
        for (_, warning) in [(is_empty, EMPTY), (is_unlike, UNLIKE)].iter().filter(|(is_due, _)| *is_due) {
            if !self.args.talk.quiet {
                eprintln!("trace: {}{where_to}: warning: {warning}", self.name);
            }
        }
        Ok(())
    }

    /// Fits and writes a stroke graph.
    fn graph(&mut self, bytes: &[u8], output: &Path, graph_path: Option<&Path>) -> Result<(), Failure> {
        if self.args.out.debug_dir.is_some() {
            let what = "--debug-dir lays its pictures over an image, and this is a graph";
            return Err(Failure::Usage(format!("{}: {what}", self.name)));
        }
        let failed = self.failed();
        let mut graph = from_json(&self.input.display().to_string(), bytes).map_err(failed)?;
        graph.page.dpi = self.tracer.load.dpi.map(|dpi| dpi.x).or(graph.page.dpi);
        self.stages.done("load", || format!("{} strokes, {} nodes", graph.trails.len(), graph.graph.node_count()));
        let mut watch = Watch { stages: &mut self.stages, debug: None, streamlines: 0, scan: None, edge_share: 0.0 };
        let drawing = self.tracer.vectorizer.draw(&graph, &mut watch).map_err(failed)?;
        let origin = Some(self.tracer.origin(bytes, None).to_text());
        let options = WriteOptions { title: title_of(self.input), origin, ..self.tracer.write.clone() };
        self.write(&graph, &drawing, options, output, graph_path)
    }

    fn write(
        &mut self,
        graph: &StrokeGraph,
        drawing: &Drawing,
        options: WriteOptions,
        output: &Path,
        graph_path: Option<&Path>,
    ) -> Result<(), Failure> {
        let failed = self.failed();
        let document = Document { drawing, graph: Some(graph) };
        if let (Some(path), Some(json)) = (graph_path, format_named("json")) {
            let length = self.tracer.put_as(json, path, &document, options.clone()).map_err(failed)?;
            self.stages.done("write", || format!("{length} bytes to {}", target::name(path)));
        }
        let length = self.tracer.put(output, &document, options).map_err(failed)?;
        self.stages.done("write", || format!("{length} bytes to {}", target::name(output)));
        Ok(())
    }
}
