//! From trails to strokes.
//!
//! A trail is split at its corners. Each section becomes the chain of lines, arcs and cubics that explains its
//! points best at the least cost (`segmentation`); then joints are made sharp or smooth, lines that nearly keep
//! to an axis are put on it, and every curve is fitted again between its final joints (`joints`).

mod arc;
mod cubic;
mod joints;
mod line;
mod samples;
mod segmentation;
mod solid;
mod stroke;

use crate::clean::{LineImage, unblurred_width};
use crate::drawing::{Centreline, Color, Drawing, Stroke};
use crate::graph::StrokeGraph;
use crate::options::{Options, StrokeWidth};
use rayon::prelude::*;

/// Deviation of points that is always taken for noise, as a share of the fit tolerance: on a clean render, and on a
/// scan, where grain moves whole stretches of a line and neighbouring points do not show it.
const STEADINESS: f64 = 0.26;
const STEADINESS_NOISY: f64 = 0.275;

/// How closely to fit, in pixels of the line image.
#[derive(Clone, Copy, Debug)]
struct Tolerance {
    /// Deviation that is accepted as the drawing's own unsteadiness.
    fit: f64,
    /// Line width, which sets the scale of features.
    width: f64,
    /// Deviation below which points always agree with a curve.
    steadiness: f64,
}

impl Tolerance {
    /// Deviation of a section's points from its curves that is taken for noise: a part of the tolerance, or what
    /// the points themselves scatter by.
    fn deviation(&self, samples: &samples::Samples) -> f64 {
        self.steadiness.max(samples.scatter(0.7 * self.width))
    }
}

/// Fits every trail of a graph. The drawing is in pixels of the line image.
pub fn fit(image: &LineImage, graph: &StrokeGraph, options: &Options) -> Drawing {
    let fit = (options.detail * image.line_width).max(0.1);
    let steadiness = if image.noise > 0.0 { STEADINESS_NOISY } else { STEADINESS } * fit;
    let tolerance = Tolerance { fit, width: image.line_width, steadiness };
    let mut drawing = Drawing::new(image.ink.width() as f64, image.ink.height() as f64);
    let fitted: Vec<Option<(Centreline, f64)>> = graph
        .trails
        .par_iter()
        .map(|trail| {
            let walk = graph.walk(trail);
            let centreline = stroke::fit_trail(&walk, trail.closed, tolerance)?;
            let measured = median_width(walk.iter().map(|p| p.width)).unwrap_or(image.line_width);
            Some((centreline, unblurred_width(measured, image.blur)))
        })
        .collect();
    let lines =
        fitted.into_iter().flatten().map(|(centreline, width)| Stroke { centreline, width, color: Color::BLACK });
    let dots = graph.dots.iter().map(|&(centre, diameter)| Stroke {
        centreline: Centreline::Dot(centre),
        width: diameter,
        color: Color::BLACK,
    });
    drawing.strokes = lines.chain(dots).collect();
    set_widths(&mut drawing, options.width, image.scale);
    drawing.fills = image.solids.iter().map(|s| solid::smooth(s, tolerance)).collect();
    drawing
}

/// Replaces measured widths where one width is asked for.
fn set_widths(drawing: &mut Drawing, width: StrokeWidth, scale: f64) {
    let all = match width {
        StrokeWidth::Measured => return,
        StrokeWidth::Uniform => median_width(drawing.strokes.iter().map(|s| s.width)),
        StrokeWidth::Fixed(px) => Some(px * scale),
    };
    if let Some(all) = all {
        drawing.strokes.iter_mut().for_each(|s| s.width = all);
    }
}

fn median_width(widths: impl Iterator<Item = f64>) -> Option<f64> {
    let mut widths: Vec<f64> = widths.filter(|w| w.is_finite()).collect();
    widths.sort_by(f64::total_cmp);
    widths.get(widths.len() / 2).copied()
}
