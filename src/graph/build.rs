//! The loop over the passes.

use super::assemble::assemble;
use super::lines::Line;
use super::passes::{Draft, FINISHES, Pass, Passes, REPAIRS};
use super::resolve::resolve;
use super::{Page, StrokeGraph};
use crate::cancel::Cancel;
use crate::clean::LineImage;
use crate::error::Result;
use crate::options::Options;
use crate::streamline::Streamline;
use web_time::Instant;

/// What a pass worked on, as it left it.
#[derive(Clone, Copy, Debug)]
pub enum Work<'a> {
    /// The lines, after a repair.
    Lines(&'a [Line]),
    /// The graph, after a finish.
    Graph(&'a StrokeGraph),
}

/// A pass that ran.
#[derive(Clone, Copy, Debug)]
pub struct Ran {
    /// Which.
    pub pass: &'static Pass,
    /// How much it changed: ends, places, strokes, as its documentation says.
    pub changes: usize,
    /// Seconds that it took.
    pub seconds: f64,
}

/// Told of each pass that ran, and what there is now.
pub type Watch<'a> = dyn FnMut(&Ran, Work) -> Result<()> + 'a;

/// Builds the stroke graph.
///
/// # Errors
/// The token's.
pub fn build(image: &LineImage, streamlines: &[Streamline], options: &Options, cancel: &Cancel) -> Result<StrokeGraph> {
    Passes::default().build(image, streamlines, options, cancel, &mut |_, _| Ok(()))
}

impl Passes {
    /// Builds the stroke graph by these passes.
    ///
    /// # Errors
    /// The token's, which is polled before each pass, and the watch's.
    pub fn build(
        &self,
        image: &LineImage,
        streamlines: &[Streamline],
        options: &Options,
        cancel: &Cancel,
        watch: &mut Watch,
    ) -> Result<StrokeGraph> {
        let lines: Vec<Line> = streamlines.iter().map(Line::from).collect();
        let (nodes, dots, pens) = (None, Vec::new(), None);
        let mut draft = Draft { image, options, lines: lines.into(), nodes, dots, pens, graph: StrokeGraph::default() };
        for pass in self.due(&REPAIRS) {
            cancel.check()?;
            draft.nodes = None;
            if let Some(ran) = ran(pass, &mut draft) {
                watch(&ran, Work::Lines(&draft.lines))?;
            }
        }
        cancel.check()?;
        let nodes = draft.nodes.take().unwrap_or_else(|| resolve(image, &draft.lines));
        cancel.check()?;
        let (dots, fills) = (std::mem::take(&mut draft.dots), image.solids.clone());
        let assembled = assemble(image, &draft.lines, &nodes, options);
        draft.graph = StrokeGraph { page: Page::of(image), dots, fills, ..assembled };
        for pass in self.due(&FINISHES) {
            cancel.check()?;
            if let Some(ran) = ran(pass, &mut draft) {
                watch(&ran, Work::Graph(&draft.graph))?;
            }
        }
        cancel.check()?;
        Ok(draft.graph)
    }

    fn due(&self, passes: &'static [Pass]) -> impl Iterator<Item = &'static Pass> {
        passes.iter().filter(|pass| self.has(pass))
    }
}

/// Runs a pass where it is due.
fn ran(pass: &'static Pass, draft: &mut Draft) -> Option<Ran> {
    let start = Instant::now();
    let changes = pass.when.holds(draft).then(|| (pass.run)(draft))?;
    Some(Ran { pass, changes, seconds: start.elapsed().as_secs_f64() })
}
