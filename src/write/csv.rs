//! Points along the strokes as comma-separated values.

use super::document::{Document, WriteOptions};
use super::layers::layers;
use super::{Format, Rounding};
use crate::drawing::Stroke;
use crate::error::Result;
use kurbo::{ParamCurve, ParamCurveArclen, PathSeg, Point};
use std::fmt::Write;

/// The first line.
pub(super) const HEADER: &str = "stroke,x,y,width,color";
/// Accuracy of lengths in units of the drawing.
const ACCURACY: f64 = 1e-3;

/// A line of text for each point: the stroke's number from 0 in drawing order, the place with y down, the width there and the
/// colour. Corners and ends are always among the points; solid regions are not written.
pub(super) struct Csv;

impl Format for Csv {
    fn name(&self) -> &'static str {
        "csv"
    }

    fn has_profiles(&self) -> bool {
        true
    }

    fn encode(&self, document: &Document, options: &WriteOptions) -> Result<Vec<u8>> {
        let drawing = options.in_units(document.drawing)?;
        let scale = drawing.width / document.drawing.width.max(f64::MIN_POSITIVE);
        let rounding = Rounding::new(options.precision);
        let mut text = format!("{HEADER}\n");
        for (number, stroke) in layers(&drawing).iter().flat_map(|layer| &layer.strokes).enumerate() {
            for (point, share) in points(stroke, options.step * scale) {
                let [x, y, width] = [point.x, point.y, stroke.width_at(share)].map(|v| rounding.text(v));
                let _ = writeln!(text, "{number},{x},{y},{width},{}", stroke.color);
            }
        }
        Ok(text.into_bytes())
    }
}

/// Points at even distances of at most `step` along each piece, each with its share of the stroke's length.
fn points(stroke: &Stroke, step: f64) -> Vec<(Point, f64)> {
    let path = stroke.centreline.to_path();
    let segments: Vec<(PathSeg, f64)> = path.segments().map(|s| (s, s.arclen(ACCURACY))).collect();
    let total = segments.iter().map(|s| s.1).sum::<f64>().max(f64::MIN_POSITIVE);
    let mut points = vec![(stroke.centreline.start(), 0.0)];
    let mut before = 0.0;
    for (segment, length) in segments.into_iter().filter(|s| s.1 > 0.0) {
        let count = (length / step).ceil().max(1.0);
        for k in 1..=count as usize {
            let along = length * k as f64 / count;
            points.push((segment.eval(segment.inv_arclen(along, ACCURACY)), ((before + along) / total).min(1.0)));
        }
        before += length;
    }
    points
}
