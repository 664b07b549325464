//! A drawing as DXF (AutoCAD Release 2004, text): Autodesk, *DXF Reference*.
//!
//! Lengths are millimetres with y up where the drawing knows its resolution, else pixels. Each pen is a layer of its colour
//! and name. A stroke of one piece is a LINE, ARC or CIRCLE, of several an LWPOLYLINE with bulges, a dot a POINT; cubic
//! curves are arcs within the tolerance, or SPLINEs where Bezier curves are asked for. Dashes are line types, solid regions
//! HATCHes.

mod entities;
mod frame;
mod pairs;

use super::curves::with_curves;
use super::document::{Curves, Document, MILLIMETRES, WriteOptions, known_dpi};
use super::layers::layers;
use super::{Format, Rounding};
use crate::drawing::{Dashes, Drawing};
use crate::error::Result;
use entities::Entities;
use kurbo::Affine;
use pairs::Pairs;

/// DXF text.
pub(super) struct Dxf;

impl Format for Dxf {
    fn name(&self) -> &'static str {
        "dxf"
    }

    fn encode(&self, document: &Document, options: &WriteOptions) -> Result<Vec<u8>> {
        let page = Page::of(document.drawing);
        let curves = options.curves.unwrap_or(Curves::Arcs);
        let drawing = with_curves(document.drawing, curves, options.tolerance);
        let layers = layers(&drawing);
        let mut line_types: Vec<[f64; 2]> = Vec::new();
        let mut entities = Entities::new(&page, frame::MODEL_SPACE);
        for layer in &layers {
            layer.fills.iter().for_each(|fill| entities.hatch(layer, fill, options.tolerance));
            for stroke in &layer.strokes {
                let line_type = stroke.dashes.map(|dashes| line_type(&mut line_types, page.pattern(dashes)));
                entities.stroke(layer, stroke, line_type);
            }
        }
        let mut pairs = Pairs::new();
        pairs.text(999, &options.origin());
        frame::before(&mut pairs, &page, &layers, &line_types, entities.next_handle());
        pairs.append(entities.into_pairs());
        frame::after(&mut pairs);
        Ok(pairs.into_bytes())
    }
}

/// The number of a pattern of dash and gap among those of the file.
fn line_type(known: &mut Vec<[f64; 2]>, pattern: [f64; 2]) -> usize {
    known.iter().position(|p| *p == pattern).unwrap_or_else(|| {
        known.push(pattern);
        known.len() - 1
    })
}

/// The name of a line type.
fn line_type_name(number: usize) -> String {
    format!("Dashes{}", number + 1)
}

/// From pixels to the file's lengths.
struct Page {
    scale: f64,
    /// Whether lengths are millimetres.
    metric: bool,
    width: f64,
    height: f64,
}

impl Page {
    fn of(drawing: &Drawing) -> Self {
        let dpi = known_dpi(drawing);
        let scale = dpi.map_or(1.0, |dpi| MILLIMETRES / dpi);
        Self { scale, metric: dpi.is_some(), width: scale * drawing.width, height: scale * drawing.height }
    }

    /// From pixels with y down to lengths with y up.
    fn map(&self) -> Affine {
        Affine::new([self.scale, 0.0, 0.0, -self.scale, 0.0, self.height])
    }

    /// Lengths of dash and gap, rounded so that nearly equal patterns share a line type.
    fn pattern(&self, dashes: Dashes) -> [f64; 2] {
        // Patterns repeat, so their errors add up.
        let rounding = Rounding::new(5);
        [dashes.dash, dashes.gap].map(|length| rounding.round(self.scale * length).max(rounding.step()))
    }
}
