//! Where a caller can look at, change or refuse what each stage made.

use crate::cancel::Cancel;
use crate::clean::LineImage;
use crate::drawing::Drawing;
use crate::error::Result;
use crate::field::PolyVectorField;
use crate::graph::{Line, Ran, StrokeGraph};
use crate::load::Scan;
use crate::raster::Raster;
use crate::streamline::Streamline;

/// A step of a trace that takes time; see [`crate::pipeline::Vectorizer::reporting`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Stage {
    /// Ink is told from paper and measured.
    Clean,
    /// Directions are estimated.
    Estimate,
    /// Streamlines are traced and become a graph.
    Trace,
    /// Curves are fitted.
    Fit,
}

impl Stage {
    /// All of them, in the order in which they come; the middle two come twice where broad lines are traced apart.
    pub const ALL: [Self; 4] = [Self::Clean, Self::Estimate, Self::Trace, Self::Fit];
}

/// In a word.
impl std::fmt::Display for Stage {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Clean => "ink",
            Self::Estimate => "directions",
            Self::Trace => "strokes",
            Self::Fit => "curves",
        })
    }
}

/// Sees each stage's result as it passes and may change it in place; an error stops the trace.
///
/// Every method does nothing unless overridden. To refuse a result, return
/// [`crate::Error::Vetoed`]; [`veto`] builds one.
#[allow(unused_variables)]
pub trait Observer {
    /// What the trace polls between and inside its stages; it stops with the token's error.
    fn cancel(&self) -> Cancel {
        Cancel::default()
    }
    /// After the ink of a page has been told from everything else on it, where that was asked of an estimator: the share of
    /// each pixel that is covered by it, 0 to 1. A large scan of broad lines was reduced before.
    ///
    /// # Errors
    /// Stops the trace; so for the other methods.
    fn on_ink(&mut self, scan: &Scan, coverage: &mut Raster<f32>) -> Result<()> {
        Ok(())
    }
    /// After cleaning.
    #[allow(clippy::missing_errors_doc)]
    fn on_line_image(&mut self, image: &mut LineImage) -> Result<()> {
        Ok(())
    }
    /// After estimation, or with the caller's own field: where lines are too broad to be traced beside others, first for
    /// the image of the broad ones ([`LineImage::broad`]), then for the rest. So are their streamlines.
    #[allow(missing_docs, clippy::missing_errors_doc)]
    fn on_field(&mut self, image: &LineImage, field: &mut PolyVectorField) -> Result<()> {
        Ok(())
    }
    /// For each streamline; `false` drops it.
    #[allow(clippy::missing_errors_doc)]
    fn on_streamline(&mut self, image: &LineImage, streamline: &mut Streamline) -> Result<bool> {
        Ok(true)
    }
    /// After each pass over the lines between streamlines and graph ([`crate::graph::REPAIRS`]): how much it changed, and
    /// the lines as they are now, which can be looked at only.
    #[allow(clippy::missing_errors_doc)]
    fn on_lines(&mut self, image: &LineImage, ran: &Ran, lines: &[Line]) -> Result<()> {
        Ok(())
    }
    /// After each pass over the graph of one image ([`crate::graph::FINISHES`]): how much it changed, and the graph as it is
    /// now.
    #[allow(clippy::missing_errors_doc)]
    fn on_finish(&mut self, image: &LineImage, ran: &Ran, graph: &StrokeGraph) -> Result<()> {
        Ok(())
    }
    /// After the streamlines, of fine lines and of broad ones, have become a graph.
    #[allow(clippy::missing_errors_doc)]
    fn on_graph(&mut self, image: &LineImage, graph: &mut StrokeGraph) -> Result<()> {
        Ok(())
    }
    /// After fitting, in pixels of the input.
    #[allow(clippy::missing_errors_doc)]
    fn on_drawing(&mut self, drawing: &mut Drawing) -> Result<()> {
        Ok(())
    }
}

/// An observer that lets everything pass.
impl Observer for () {}

/// The error that refuses a stage's result.
pub fn veto(stage: &'static str, reason: impl Into<String>) -> crate::Error {
    crate::Error::Vetoed { stage, reason: reason.into() }
}
