//! One file of a batch.

use super::plan::Job;
use crate::cancel::Cancel;
use crate::clean::LineImage;
use crate::error::{Error, Result};
use crate::graph::{JunctionKind, StrokeGraph};
use crate::hooks::Observer;
use crate::inspect::{NO_DRAWING, edge_share};
use crate::load::{LoadOptions, Scan, load};
use crate::pipeline::Vectorizer;
use crate::write::{SvgOptions, to_svg, write_file};
use std::fs;
use std::path::Path;

/// Reads, traces and writes files under one set of options.
pub struct FileTracer {
    /// What traces them, one for all.
    pub vectorizer: Vectorizer,
    /// How inputs are read.
    pub load: LoadOptions,
    /// Decimals in the output.
    pub precision: usize,
    /// Whether to trace again what has an output already.
    pub force: bool,
}

/// What was made of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Traced {
    /// A drawing.
    Drawn {
        /// Number of strokes.
        strokes: usize,
        /// Number of filled regions.
        fills: usize,
        /// Number of points at which lines meet.
        junctions: usize,
        /// Whether it looks like no line drawing ([`crate::inspect::edge_share`]).
        unlike: bool,
    },
    /// Nothing: there is an output that is no older than the input.
    Skipped,
}

impl FileTracer {
    /// With the defaults of everything but the trace.
    pub fn new(vectorizer: Vectorizer) -> Self {
        let (load, precision) = (LoadOptions::default(), SvgOptions::default().precision);
        Self { vectorizer, load, precision, force: false }
    }

    /// Traces one file, unless that has been done before. Folders on the way to the output are made.
    ///
    /// # Errors
    /// Why the file could not be read, traced or written, or the token's; the output is then as it was.
    pub fn trace(&self, job: &Job, cancel: &Cancel) -> Result<Traced> {
        if !self.force && is_current(job) {
            return Ok(Traced::Skipped);
        }
        let scan = load(&job.input, &self.load)?.scan;
        let mut count = Count { scan: &scan, junctions: 0, unlike: false, cancel: cancel.clone() };
        let drawing = self.vectorizer.trace_observed(&scan, &mut count)?;
        let title = job.input.file_name().map(|name| name.to_string_lossy().into_owned());
        let svg = to_svg(&drawing, &SvgOptions { precision: self.precision, title });
        cancel.check()?;
        if let Some(folder) = job.output.parent() {
            fs::create_dir_all(folder).map_err(|cause| Error::Write { path: folder.to_owned(), cause })?;
        }
        write_file(&job.output, svg.as_bytes())?;
        let Count { junctions, unlike, .. } = count;
        Ok(Traced::Drawn { strokes: drawing.strokes.len(), fills: drawing.fills.len(), junctions, unlike })
    }
}

/// Whether the output is there and no older than the input.
fn is_current(job: &Job) -> bool {
    let changed = |path: &Path| {
        let file = fs::metadata(path).ok().filter(|file| file.is_file() && file.len() > 0)?;
        file.modified().ok()
    };
    matches!((changed(&job.input), changed(&job.output)), (Some(input), Some(output)) if output >= input)
}

/// Counts junctions, sees whether there is a line drawing at all, and hands the token on.
struct Count<'a> {
    scan: &'a Scan,
    junctions: usize,
    unlike: bool,
    cancel: Cancel,
}

impl Observer for Count<'_> {
    fn cancel(&self) -> Cancel {
        self.cancel.clone()
    }

    fn on_graph(&mut self, image: &LineImage, graph: &mut StrokeGraph) -> Result<()> {
        self.unlike = edge_share(self.scan, image, graph) > NO_DRAWING;
        let meets = |kind| !matches!(kind, JunctionKind::FreeEnd | JunctionKind::Seam);
        self.junctions = graph.graph.node_weights().filter(|node| meets(node.kind)).count();
        Ok(())
    }
}
