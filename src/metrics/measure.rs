//! A trace with its figures.

use super::{AngularError, LineScore, Truth};
use crate::clean::LineImage;
use crate::error::{Error, Result};
use crate::field::PolyVectorField;
use crate::hooks::Observer;
use crate::load::Scan;
use crate::pipeline::Vectorizer;
use crate::write::{WriteOptions, to_svg};
use std::time::Instant;

/// The figures of one trace; see [`crate::metrics`] for their definitions.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Measurement {
    /// Of the field.
    pub field: AngularError,
    /// Of the drawing.
    pub lines: LineScore,
    /// Seconds that the trace took.
    pub seconds: f64,
    /// Seconds of them that the field took.
    pub field_seconds: f64,
    /// Pixels of the scan, in millions.
    pub megapixels: f64,
}

impl Measurement {
    /// The names of the figures.
    pub const NAMES: [&str; 15] = [
        "ink_deg",
        "junction_deg",
        "f1_0.5",
        "f1_1",
        "f1_2",
        "chamfer",
        "junction_f1",
        "endpoint_f1",
        "integrity",
        "purity",
        "iou",
        "paths_ratio",
        "segs_ratio",
        "field_s_per_mp",
        "s_per_mp",
    ];

    /// The figures in the order of their names.
    pub fn values(&self) -> [f64; 15] {
        let Self { field, lines, .. } = self;
        let [half, one, two] = lines.f1;
        [
            field.ink,
            field.junction,
            half,
            one,
            two,
            lines.chamfer,
            lines.junction_f1,
            lines.endpoint_f1,
            lines.integrity,
            lines.purity,
            lines.iou,
            lines.paths_ratio,
            lines.segs_ratio,
            self.field_seconds / self.megapixels,
            self.seconds / self.megapixels,
        ]
    }
}

/// Traces a scan and compares the field and the drawing with the truth.
///
/// # Errors
/// Whatever the estimator says, and [`Error::FieldSize`] where the truth is of another raster.
pub fn measure(vectorizer: &Vectorizer, scan: &Scan, truth: &Truth) -> Result<Measurement> {
    let mut seen = Seen::default();
    let start = Instant::now();
    let drawing = vectorizer.trace_observed(scan, &mut seen)?;
    let seconds = start.elapsed().as_secs_f64();
    let (width, height) = scan.gray.size();
    let field = seen.field.map(|f| f.resized(width, height));
    let field = field.ok_or(Error::FieldSize { field: (0, 0), image: (width, height) })?;
    Ok(Measurement {
        field: truth.angular_error(&field)?,
        lines: truth.score(&to_svg(&drawing, &WriteOptions::default()))?,
        seconds,
        field_seconds: seen.field_seconds,
        megapixels: (width * height) as f64 / 1e6,
    })
}

/// Keeps the field and how long it took.
#[derive(Default)]
struct Seen {
    cleaned: Option<Instant>,
    field: Option<PolyVectorField>,
    field_seconds: f64,
}

impl Observer for Seen {
    fn on_line_image(&mut self, _: &mut LineImage) -> Result<()> {
        self.cleaned = Some(Instant::now());
        Ok(())
    }

    fn on_field(&mut self, _: &LineImage, field: &mut PolyVectorField) -> Result<()> {
        self.field_seconds = self.cleaned.map_or(0.0, |start| start.elapsed().as_secs_f64());
        self.field = Some(field.clone());
        Ok(())
    }
}
