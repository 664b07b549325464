//! One file of a batch.

use super::plan::Job;
use crate::cancel::Cancel;
use crate::clean::LineImage;
use crate::drawing::Drawing;
use crate::error::{Error, Result};
use crate::graph::{JunctionKind, StrokeGraph};
use crate::hooks::Observer;
use crate::inspect::{NO_DRAWING, edge_share};
use crate::load::{Input, LoadOptions, Pages, Scan, for_scan, georeference, load_pages, pages_of_bytes, read_bytes};
use crate::pipeline::Vectorizer;
use crate::place::Frame;
use crate::write::{
    Document, Format, Origin, Units, WriteOptions, encode, format_named, is_untouched_output, write_file,
};
use serde_json::json;
use std::fs;
use std::path::{Path, PathBuf};

/// Reads, traces and writes files under one set of options.
pub struct FileTracer {
    /// What traces them, one for all.
    pub vectorizer: Vectorizer,
    /// How inputs are read.
    pub load: LoadOptions,
    /// What kind of files the outputs are.
    pub format: &'static dyn Format,
    /// How they are written; the title and the origin are those of each input.
    pub write: WriteOptions,
    /// Whether to trace again what has an output already, and to overwrite files that are none.
    pub force: bool,
}

/// What was made of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Traced {
    /// A drawing, or one for each page; the numbers are those of all.
    Drawn {
        /// Number of strokes.
        strokes: usize,
        /// Number of filled regions.
        fills: usize,
        /// Number of points at which lines meet.
        junctions: usize,
        /// Whether a page looks like no line drawing ([`crate::inspect::edge_share`]).
        unlike: bool,
        /// The files that were written, in the order of the pages.
        outputs: Vec<PathBuf>,
        /// What the first was made from, and how.
        origin: Box<Origin>,
    },
    /// Nothing: there is an output that is no older than the input and was made under the same options.
    Skipped,
}

impl FileTracer {
    /// With the defaults of everything but the trace: SVGs.
    pub fn new(vectorizer: Vectorizer) -> Self {
        let format = format_named("svg").expect("SVG is always written");
        Self { vectorizer, load: LoadOptions::default(), format, write: WriteOptions::default(), force: false }
    }

    /// Traces one file, unless that has been done before: to the job's output, or to one for each page where there are
    /// several ([`page_path`]). Folders on the way to the output are made.
    ///
    /// # Errors
    /// Why the file could not be read, traced or written, or the token's; the output is then as it was, and
    /// [`Error::Exists`] where that is a file that this program did not write.
    pub fn trace(&self, job: &Job, cancel: &Cancel) -> Result<Traced> {
        if !self.force && self.is_done(job) {
            return Ok(Traced::Skipped);
        }
        let bytes = read_bytes(&job.input)?;
        let pages = pages_of_bytes(&job.input.display().to_string(), &bytes, &self.load)?;
        let mut sum = Count::default();
        let mut outputs = Vec::new();
        // The hash of a long document is taken once.
        let whole = self.origin(&bytes, None);
        let mut first = None;
        for (number, page) in pages.iter() {
            let Input { scan, frame, .. } = page?;
            let (several, output) = output_of(&pages, number, &job.output);
            let origin = Origin { page: several, ..whole.clone() };
            let mut watch = Watch { scan: &scan, count: Count::default(), cancel: cancel.clone() };
            let graph = self.vectorizer.graph(&scan, &mut watch)?;
            let drawing = self.vectorizer.draw(&graph, &mut watch)?;
            cancel.check()?;
            if let Some(folder) = output.parent().filter(|folder| !folder.as_os_str().is_empty()) {
                fs::create_dir_all(folder).map_err(|cause| Error::Write { path: folder.to_owned(), cause })?;
            }
            let source = self.source(&job.input, &bytes, &scan, frame, &origin);
            self.put(&output, &Document { drawing: &drawing, graph: Some(&graph) }, source)?;
            sum.add(watch.count, &drawing);
            outputs.push(output);
            first.get_or_insert(origin);
        }
        let origin = Box::new(first.unwrap_or(whole));
        let Count { strokes, fills, junctions, unlike } = sum;
        Ok(Traced::Drawn { strokes, fills, junctions, unlike, outputs, origin })
    }

    /// What is said of the making of a drawing that is traced from the bytes of an input, and from which of its pages.
    pub fn origin(&self, input: &[u8], page: Option<usize>) -> Origin {
        let options = json!({
            "trace": self.vectorizer.options(),
            "estimator": self.vectorizer.estimator_name(),
            "load": &self.load,
            "write": &self.write,
        });
        Origin::new(input, page, options)
    }

    /// What an output says of the input that a scan was read from, and how it follows it.
    pub fn source(
        &self,
        path: &Path,
        bytes: &[u8],
        scan: &Scan,
        frame: Option<Frame>,
        origin: &Origin,
    ) -> WriteOptions {
        let mut options = self.write.clone();
        options.title = title_of(path);
        options.origin = Some(origin.to_text());
        options.frame = frame.filter(|_| options.units == Units::Pixels);
        if self.format.is_on_earth() {
            let whole = georeference(path, bytes);
            options.georeference = whole.and_then(|whole| for_scan(whole, bytes, self.load.crop, scan.gray.size()));
        }
        options
    }

    /// Writes a drawing.
    ///
    /// # Errors
    /// [`Error::Exists`] where there is a file that this program did not write, unless it is to be overwritten;
    /// [`Error::Write`]; what the format cannot do.
    pub fn put(&self, output: &Path, document: &Document, options: WriteOptions) -> Result<usize> {
        self.put_as(self.format, output, document, options)
    }

    /// The same in a format of its own.
    ///
    /// # Errors
    /// Those of [`Self::put`].
    pub fn put_as(
        &self,
        format: &dyn Format,
        output: &Path,
        document: &Document,
        options: WriteOptions,
    ) -> Result<usize> {
        let bytes = encode(format, document, &options)?;
        self.keep_others(output)?;
        write_file(output, &bytes)?;
        Ok(bytes.len())
    }

    /// Refuses to write over a file that this program did not write.
    fn keep_others(&self, output: &Path) -> Result<()> {
        // An empty file is what a power cut leaves.
        let is_ours = |old: Vec<u8>| old.is_empty() || is_untouched_output(&old);
        let is_other = || output.is_file() && !fs::read(output).is_ok_and(is_ours);
        if !self.force && is_other() { Err(Error::Exists { path: output.to_owned() }) } else { Ok(()) }
    }

    /// Whether all outputs are there, none older than the input, made under these options.
    fn is_done(&self, job: &Job) -> bool {
        let wanted = self.origin(&[], None);
        let is_current = |output: &Path| {
            is_no_older(output, &job.input) && fs::read(output).is_ok_and(|output| wanted.is_of(&output))
        };
        if is_current(&job.output) {
            return true;
        }
        page_path(&job.output, 1).exists()
            && load_pages(&job.input, &self.load)
                .is_ok_and(|pages| pages.numbers().all(|number| is_current(&output_of(&pages, number, &job.output).1)))
    }
}

/// The number of a page where there are several, and where its drawing goes.
fn output_of(pages: &Pages, number: usize, output: &Path) -> (Option<usize>, PathBuf) {
    if pages.numbers().count() > 1 { (Some(number), page_path(output, number)) } else { (None, output.to_owned()) }
}

/// The title of what is made from an input: its name; none from standard input, `-`.
pub fn title_of(input: &Path) -> Option<String> {
    input.file_name().filter(|name| *name != "-").map(|name| name.to_string_lossy().into_owned())
}

/// Where the drawing of a page goes, counted from 1: `out-3.svg` for the third of `out.svg`.
pub fn page_path(output: &Path, number: usize) -> PathBuf {
    let stem = output.file_stem().unwrap_or_default().to_string_lossy();
    let extension = output.extension().map(|e| format!(".{}", e.to_string_lossy())).unwrap_or_default();
    output.with_file_name(format!("{stem}-{number}{extension}"))
}

fn is_no_older(output: &Path, input: &Path) -> bool {
    let changed = |path: &Path| {
        let file = fs::metadata(path).ok().filter(|file| file.is_file() && file.len() > 0)?;
        file.modified().ok()
    };
    matches!((changed(input), changed(output)), (Some(input), Some(output)) if output >= input)
}

/// How much was drawn.
#[derive(Default)]
struct Count {
    strokes: usize,
    fills: usize,
    junctions: usize,
    unlike: bool,
}

impl Count {
    fn add(&mut self, page: Self, drawing: &Drawing) {
        self.strokes += drawing.strokes.len();
        self.fills += drawing.fills.len();
        self.junctions += page.junctions;
        self.unlike |= page.unlike;
    }
}

/// Counts junctions, sees whether there is a line drawing at all, and hands the token on.
struct Watch<'a> {
    scan: &'a Scan,
    count: Count,
    cancel: Cancel,
}

impl Observer for Watch<'_> {
    fn cancel(&self) -> Cancel {
        self.cancel.clone()
    }

    fn on_graph(&mut self, image: &LineImage, graph: &mut StrokeGraph) -> Result<()> {
        self.count.unlike = edge_share(self.scan, image, graph) > NO_DRAWING;
        let meets = |kind| !matches!(kind, JunctionKind::FreeEnd | JunctionKind::Seam);
        self.count.junctions = graph.graph.node_weights().filter(|node| meets(node.kind)).count();
        Ok(())
    }
}
