//! What a trace shows while it runs: pictures of the stages, and their seconds and counts.

use crate::clean::{Decisions, LineImage, Noise, NoiseMap};
use crate::cli::args::TalkArgs;
use crate::drawing::Drawing;
use crate::error::Result;
use crate::field::PolyVectorField;
use crate::graph::{Line, Ran, StrokeGraph};
use crate::hooks::{Observer, Stage};
use crate::inspect::{DebugDir, edge_share};
use crate::load::Scan;
use crate::raster::Raster;
use crate::streamline::Streamline;
use indicatif::ProgressBar;
use std::collections::BTreeMap;
use std::time::{Duration, Instant};

/// Seconds and counts of the stages so far, printed where the user asked for it.
pub(crate) struct Stages {
    verbose: bool,
    since: Instant,
}

impl Stages {
    /// Starts the clock.
    pub(crate) fn start(verbose: bool) -> Self {
        Self { verbose, since: Instant::now() }
    }

    /// Ends a stage.
    pub(crate) fn done(&mut self, stage: &str, what: impl FnOnce() -> String) {
        if self.verbose {
            eprintln!("{stage:<12}{:>8.3} s  {}", self.since.elapsed().as_secs_f64(), what());
        }
        self.since = Instant::now();
    }

    /// Tells what was decided.
    fn tell(&self, what: &str, decided: impl FnOnce() -> String) {
        if self.verbose {
            eprintln!("  {what:<23}{}", decided());
        }
    }

    /// Takes a time that was just spent out of the stage.
    fn leave_out(&mut self, time: Duration) {
        self.since += time;
    }
}

/// The step that a trace is at, on a terminal, where it takes long.
pub(crate) struct Progress {
    line: ProgressBar,
}

impl Progress {
    /// Begins to tell, unless nothing or everything is to be told.
    pub(crate) fn start(talk: &TalkArgs) -> Self {
        let line = if talk.quiet || talk.verbose { ProgressBar::hidden() } else { ProgressBar::new_spinner() };
        line.enable_steady_tick(Duration::from_millis(150));
        Self { line }
    }

    /// What tells each stage.
    pub(crate) fn teller(&self) -> impl Fn(Stage) + Send + Sync + 'static {
        let line = self.line.clone();
        move |stage| line.set_message(stage.to_string())
    }

    /// Tells the page.
    pub(crate) fn page(&self, number: usize, pages: usize) {
        self.line.set_prefix(format!("page {number} of {pages}"));
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.line.finish_and_clear();
    }
}

/// What is paper.
fn ground(Decisions { inverted, grain, .. }: &Decisions) -> String {
    let tone = if *inverted { "dark, light is ink" } else { "light, dark is ink" };
    if *grain > 0.0 { format!("{tone}; grain of {:.1} % of full ink", 100.0 * grain) } else { format!("{tone}; flat") }
}

/// What is ink, and how many inks there are.
fn threshold(Decisions { threshold, hues, .. }: &Decisions) -> String {
    let from = match threshold {
        Some(threshold) => format!("from a darkness of {threshold:.2}"),
        None => "by the darkest ink near each place".into(),
    };
    match hues {
        0 => format!("{from}; all of it grey"),
        hues => format!("{from}; {hues} of a hue of their own"),
    }
}

/// How far the ink is trusted, and why.
fn edges(noise: &NoiseMap) -> String {
    let Noise { across, along, blur } = noise.mean();
    let [least, most] = noise.grains();
    let kind = match (least, most) {
        (_, 0.0) => "sure, as a renderer's".into(),
        (1.0, _) => "unsure, as on paper".into(),
        _ => format!("unsure in part, {:.0} to {:.0} %", 100.0 * least, 100.0 * most),
    };
    format!("{kind}: middles to {across:.2} pixels, ink to {:.0} %, blur {blur:.1} pixels", 100.0 * along)
}

/// The colours of the strokes, and how many have each.
fn pens(drawing: &Drawing) -> String {
    let mut counts = BTreeMap::new();
    drawing.strokes.iter().for_each(|stroke| *counts.entry(stroke.color.0).or_insert(0) += 1);
    let pens = counts.iter().map(|([r, g, b], count)| format!("#{r:02x}{g:02x}{b:02x} {count}"));
    pens.collect::<Vec<_>>().join(", ")
}

/// An observer that tells and draws what each stage made.
pub(crate) struct Watch<'a> {
    /// The clock.
    pub(crate) stages: &'a mut Stages,
    /// Where the pictures go.
    pub(crate) debug: Option<DebugDir<'a>>,
    /// Streamlines so far.
    pub(crate) streamlines: usize,
    /// What is traced, where it is an image.
    pub(crate) scan: Option<&'a Scan>,
    /// How much of its lines is none.
    pub(crate) edge_share: f64,
}

impl Watch<'_> {
    /// Has the stage drawn, off the clock.
    fn draw(&mut self, stage: impl FnOnce(&mut DebugDir) -> Result<()>) -> Result<()> {
        let start = Instant::now();
        let drawn = self.debug.as_mut().map_or(Ok(()), stage);
        self.stages.leave_out(start.elapsed());
        drawn
    }
}

impl Observer for Watch<'_> {
    fn on_ink(&mut self, scan: &Scan, coverage: &mut Raster<f32>) -> Result<()> {
        self.stages.done("ink", || {
            let covered = coverage.data().iter().filter(|&&c| c > 0.5).count();
            format!("{:.1} % of the page by the network", 100.0 * covered as f64 / coverage.data().len() as f64)
        });
        self.draw(|debug| debug.on_ink(scan, coverage))
    }

    fn on_line_image(&mut self, image: &mut LineImage) -> Result<()> {
        self.stages.done("clean", || {
            let (ink, solids) = (image.mask.count(), image.solids.len());
            let broad = image.broad.as_ref().map_or(String::new(), |broad| {
                format!(", broad lines {:.1} wide", broad.line_width * image.scale / broad.scale)
            });
            let (width, scale) = (image.line_width, image.scale);
            format!("{ink} ink pixels, lines {width:.1} wide{broad}, scale {scale:.2}, {solids} solids")
        });
        self.stages.tell("ground (--invert)", || ground(&image.decisions));
        self.stages.tell("ink (--threshold)", || threshold(&image.decisions));
        self.stages.tell("edges", || edges(&image.noise));
        self.draw(|debug| debug.on_line_image(image))
    }

    fn on_field(&mut self, image: &LineImage, field: &mut PolyVectorField) -> Result<()> {
        let defined = || field.confidence().data().iter().filter(|&&c| c > 0.0).count();
        self.stages.done("estimate", || format!("{} pixels with directions", defined()));
        self.draw(|debug| debug.on_field(image, field))
    }

    fn on_streamline(&mut self, image: &LineImage, streamline: &mut Streamline) -> Result<bool> {
        if self.streamlines == 0 {
            self.stages.done("streamline", || "traced".into());
        }
        self.streamlines += 1;
        if let Some(debug) = &mut self.debug {
            debug.on_streamline(image, streamline)?;
        }
        Ok(true)
    }

    fn on_lines(&mut self, image: &LineImage, ran: &Ran, lines: &[Line]) -> Result<()> {
        self.stages.tell(ran.pass.name, || format!("{} changed in {:.3} s", ran.changes, ran.seconds));
        self.draw(|debug| debug.on_lines(image, ran, lines))
    }

    fn on_finish(&mut self, image: &LineImage, ran: &Ran, graph: &StrokeGraph) -> Result<()> {
        self.stages.tell(ran.pass.name, || format!("{} changed in {:.3} s", ran.changes, ran.seconds));
        self.draw(|debug| debug.on_finish(image, ran, graph))
    }

    fn on_graph(&mut self, image: &LineImage, graph: &mut StrokeGraph) -> Result<()> {
        let streamlines = self.streamlines;
        self.stages.done("graph", || {
            let (nodes, edges) = (graph.graph.node_count(), graph.graph.edge_count());
            let (trails, dots) = (graph.trails.len(), graph.dots.len());
            format!("{streamlines} streamlines, {nodes} nodes, {edges} edges, {trails} trails, {dots} dots")
        });
        self.edge_share = self.scan.map_or(0.0, |scan| edge_share(scan, image, graph));
        self.stages.tell("edges of tones", || format!("{:.0} % of the lines' length", 100.0 * self.edge_share));
        self.draw(|debug| debug.on_graph(image, graph))
    }

    fn on_drawing(&mut self, drawing: &mut Drawing) -> Result<()> {
        self.stages.done("fit", || {
            let (strokes, pieces) = (drawing.strokes.len(), drawing.segment_count());
            format!("{strokes} strokes of {pieces} pieces, {} solid regions", drawing.fills.len())
        });
        self.stages.tell("pens", || pens(drawing));
        self.draw(|debug| debug.on_drawing(drawing))
    }
}
