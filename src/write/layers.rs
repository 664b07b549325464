//! What each pen draws, the same in every format that has layers.

use super::pen_order;
use crate::drawing::{Centreline, Color, Drawing, Fill, Segment, Stroke};
use std::borrow::Cow;
use std::collections::BTreeMap;

/// What one pen draws.
pub(super) struct Layer<'a> {
    /// Counted from 1, from the lightest pen to the darkest.
    pub number: usize,
    /// The pen's colour.
    pub color: Color,
    /// Its solid regions.
    pub fills: Vec<&'a Fill>,
    /// Its strokes in [`pen_order`], with a width that is a number.
    pub strokes: Vec<Cow<'a, Stroke>>,
}

impl Layer<'_> {
    /// The layer's name. Plotter programs take the number that it begins with for the pen's.
    pub(super) fn name(&self) -> String {
        format!("{} Pen {}", self.number, self.color)
    }
}

/// The layers of a drawing, lighter ones first, since they lie below darker ones. Strokes and regions with a coordinate that
/// is not finite are left out.
pub(super) fn layers(drawing: &Drawing) -> Vec<Layer<'_>> {
    let spare_width = median_width(drawing);
    let mut by_color = BTreeMap::<Color, (Vec<&Fill>, Vec<&Stroke>)>::new();
    for fill in drawing.fills.iter().filter(|f| f.outline.is_finite() && !f.outline.elements().is_empty()) {
        by_color.entry(fill.color).or_default().0.push(fill);
    }
    for stroke in drawing.strokes.iter().filter(|s| is_drawable(&s.centreline)) {
        by_color.entry(stroke.color).or_default().1.push(stroke);
    }
    let mut layers = Vec::with_capacity(by_color.len());
    for (color, (fills, strokes)) in by_color.into_iter().rev() {
        let in_order = pen_order(&strokes).into_iter();
        let strokes = in_order.map(|(i, reversed)| drawn(strokes[i], reversed, spare_width)).collect();
        layers.push(Layer { number: layers.len() + 1, color, fills, strokes });
    }
    layers
}

/// A stroke as it is drawn.
fn drawn(stroke: &Stroke, reversed: bool, spare_width: f64) -> Cow<'_, Stroke> {
    let mut stroke = if reversed { Cow::Owned(stroke.reversed()) } else { Cow::Borrowed(stroke) };
    if !stroke.width.is_finite() {
        stroke.to_mut().width = spare_width;
    }
    stroke
}

fn is_drawable(centreline: &Centreline) -> bool {
    let finite = |s: &Segment| match s {
        Segment::Line(l) => l.is_finite(),
        Segment::Arc(a) => {
            a.center.is_finite() && a.radii.is_finite() && a.start_angle.is_finite() && a.sweep_angle.is_finite()
        }
        Segment::Cubic(c) => c.is_finite(),
    };
    match centreline {
        Centreline::Path { segments, .. } => !segments.is_empty() && segments.iter().all(finite),
        Centreline::Circle(c) => c.is_finite(),
        Centreline::Dot(p) => p.is_finite(),
    }
}

/// The width for strokes whose own is not a number.
fn median_width(drawing: &Drawing) -> f64 {
    let mut widths: Vec<f64> = drawing.strokes.iter().map(|s| s.width).filter(|w| w.is_finite()).collect();
    widths.sort_by(f64::total_cmp);
    widths.get(widths.len() / 2).copied().unwrap_or(1.0)
}
