//! What is written, and how.

use super::origin::with_check;
use crate::drawing::Drawing;
use crate::error::{Error, Result};
use crate::graph::StrokeGraph;
use crate::place::{Frame, Georeference};
use kurbo::Vec2;

/// What is written: a drawing, and the graph that it was made of where that is known.
#[derive(Clone, Copy, Debug)]
pub struct Document<'a> {
    /// Strokes and solid regions in pixels of the input.
    pub drawing: &'a Drawing,
    /// The stroke graph, which the format `json` writes.
    pub graph: Option<&'a StrokeGraph>,
}

/// The unit of coordinates, lengths and widths in formats that know none.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
pub enum Units {
    /// Pixels of the input.
    #[default]
    Pixels,
    /// Millimetres, by the drawing's dots per inch.
    Millimetres,
}

/// The elements that an SVG is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
pub enum Shapes {
    /// Each stroke in its plainest form: line, circle, rectangle or path.
    #[default]
    Plain,
    /// Paths alone, for programs that read no others.
    Path,
}

/// The kinds of pieces that strokes are written with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
pub enum Curves {
    /// Lines, arcs and cubic Bezier curves, as they were fitted.
    Bezier,
    /// Lines and arcs.
    Arcs,
    /// Lines alone.
    Lines,
}

/// How a drawing is written. Formats take from it what they know.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default, rename_all = "kebab-case"))]
#[non_exhaustive]
pub struct WriteOptions {
    /// Decimals of coordinates and widths.
    pub precision: usize,
    /// The document's title, such as the name of the input.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub title: Option<String>,
    /// The unit of coordinates in SVG and CSV; DXF and PDF have their own.
    pub units: Units,
    /// The elements of an SVG.
    pub shapes: Shapes,
    /// The pieces of strokes; `None` is what suits the format: arcs in DXF, Bezier curves in SVG and PDF.
    pub curves: Option<Curves>,
    /// How far arcs and lines may leave the curve that they are written for, in pixels of the input.
    pub tolerance: f64,
    /// Distance between the points of a CSV, in pixels of the input.
    pub step: f64,
    /// How an SVG says its size.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub frame: Option<Frame>,
    /// Where a GeoJSON lies on earth.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub georeference: Option<Georeference>,
    /// What the drawing was made from and how, as the text of a JSON object ([`super::Origin`]).
    #[cfg_attr(feature = "serde", serde(skip))]
    pub origin: Option<String>,
}

impl Default for WriteOptions {
    fn default() -> Self {
        Self {
            precision: 2,
            title: None,
            units: Units::Pixels,
            shapes: Shapes::Plain,
            curves: None,
            tolerance: 0.1,
            step: 1.0,
            frame: None,
            georeference: None,
            origin: None,
        }
    }
}

impl WriteOptions {
    /// The options with some of them set: `WriteOptions::default().with(|o| o.precision = 3)`.
    #[must_use]
    pub fn with(mut self, set: impl FnOnce(&mut Self)) -> Self {
        set(&mut self);
        self
    }

    /// Checks every range.
    ///
    /// # Errors
    /// [`Error::Option`] names the first option that is out of its range.
    pub fn validate(&self) -> Result<()> {
        let positive = |option, value: f64| {
            let reason = format!("{value} is not between 0.001 and 1000");
            if (0.001..=1000.0).contains(&value) { Ok(()) } else { Err(Error::Option { option, reason }) }
        };
        positive("tolerance", self.tolerance)?;
        positive("step", self.step)
    }

    /// What is said of the program and the input, on one line.
    pub(super) fn origin(&self) -> String {
        let program = || format!("{{\"program\":\"{PROGRAM}\"}}");
        with_check(&self.origin.clone().unwrap_or_else(program))
    }

    /// The drawing in the unit that was asked for.
    ///
    /// # Errors
    /// [`Error::Option`] where millimetres are asked for and the drawing does not know its size.
    pub(super) fn in_units(&self, drawing: &Drawing) -> Result<Drawing> {
        if self.units == Units::Pixels {
            return Ok(drawing.clone());
        }
        let scale = MILLIMETRES
            / known_dpi(drawing).ok_or_else(|| Error::Option {
                option: "units",
                reason: "millimetres need a resolution, which the input does not tell (give one with dpi)".into(),
            })?;
        Ok(drawing.scaled(scale))
    }
}

/// Name and version of the program.
pub(super) const PROGRAM: &str = concat!("fieldtrace ", env!("CARGO_PKG_VERSION"));
/// Millimetres in an inch.
pub(super) const MILLIMETRES: f64 = 25.4;

/// Dots per inch of a drawing that tells a usable number.
pub(super) fn known_dpi(drawing: &Drawing) -> Option<f64> {
    drawing.dpi.filter(|dpi| dpi.is_finite() && *dpi > 0.0)
}

/// The drawing in units of a view box, in its middle where the proportions differ.
pub(super) fn in_frame(frame: &Frame, drawing: &Drawing) -> Drawing {
    let [left, top, width, height] = frame.view_box;
    // The view box lies whole within the page, where proportions differ (`xMidYMid meet`).
    let scale = (width / drawing.width).max(height / drawing.height);
    let spare = Vec2::new(width - scale * drawing.width, height - scale * drawing.height);
    drawing.scaled(scale).shifted(Vec2::new(left, top) + 0.5 * spare)
}
