//! From trails to strokes.
//!
//! A trail is split at its corners. Each section becomes the chain of lines, arcs and cubics that explains its
//! points best at the least cost (`segmentation`, `price`); then joints are made sharp or smooth, lines that nearly keep
//! to an axis are put on it, and every curve is fitted again between its final joints (`joints`, `chain`). Where outlines are
//! asked for, the edges of each stroke are fitted in the same way (`outline`).

mod arc;
mod chain;
mod cubic;
mod dashes;
mod fillet;
mod joints;
mod line;
mod outline;
mod pens;
mod price;
mod profile;
mod rectangle;
mod samples;
mod segmentation;
mod shade;
mod solid;
mod stroke;
mod vertices;

use crate::cancel::Cancel;
use crate::clean::unblurred_width;
use crate::drawing::{Centreline, Dashes, Drawing, Fill, Stroke};
use crate::error::Result;
use crate::graph::{Dot, StrokeGraph, Trail};
use crate::options::{Options, StrokeWidth};
use price::QUARTER_STEPS;
use profile::Profile;
use rayon::prelude::*;
use samples::Samples;

/// Deviation of points that is always taken for noise, as a share of the fit tolerance.
const STEADINESS: f64 = 0.27;

/// How closely to fit, in pixels of the line image.
#[derive(Clone, Copy, Debug)]
struct Tolerance {
    /// Deviation that is accepted as the drawing's own unsteadiness.
    fit: f64,
    /// Line width, which sets the scale of features.
    width: f64,
    /// Deviation below which points always agree with a curve.
    steadiness: f64,
    /// Side of a pixel of the scan.
    pixel: f64,
}

impl Tolerance {
    /// Deviation of a section's points from its curves that is taken for noise: a part of the tolerance, or what
    /// the points themselves scatter by.
    fn scatter(&self, samples: &Samples) -> f64 {
        self.steadiness.max(samples.scatter(0.7 * self.width))
    }

    /// The same with what the ink itself cannot tell.
    fn deviation(&self, samples: &Samples) -> f64 {
        self.scatter(samples).hypot(samples.noise)
    }
}

/// What a trail becomes.
enum Drawn {
    Stroke(Stroke),
    Outlines(Vec<Fill>),
}

/// Fits every trail of a graph. The drawing is in pixels of the scan.
///
/// # Errors
/// The token's.
pub fn fit(graph: &StrokeGraph, options: &Options, cancel: &Cancel) -> Result<Drawing> {
    let page = &graph.page;
    let fit = (options.detail * page.line_width).max(0.1);
    let steadiness = (STEADINESS * fit).max(QUARTER_STEPS * page.scale);
    let tolerance = Tolerance { fit, width: page.line_width, steadiness, pixel: page.scale };
    let fitted: Vec<Option<Drawn>> = graph
        .trails
        .par_iter()
        .map(|trail| {
            cancel.check()?;
            Ok(drawn(graph, trail, options.width, tolerance))
        })
        .collect::<Result<_>>()?;
    let mut drawing =
        Drawing { fills: graph.fills.iter().map(|s| solid::smooth(s, tolerance)).collect(), ..Drawing::default() };
    for drawn in fitted.into_iter().flatten() {
        match drawn {
            Drawn::Stroke(stroke) => drawing.strokes.push(stroke),
            Drawn::Outlines(outlines) => drawing.fills.extend(outlines),
        }
    }
    vertices::meet(&mut drawing.strokes, tolerance);
    let dot = |dot: &Dot| Stroke { color: dot.color, ..Stroke::new(Centreline::Dot(dot.centre), dot.diameter) };
    drawing.strokes.extend(graph.dots.iter().map(dot));
    set_widths(&mut drawing, options.width, page.scale);
    let mut scaled = drawing.scaled(1.0 / page.scale);
    shade::treat(&mut scaled, options.solids);
    Ok(Drawing { width: page.width, height: page.height, dpi: page.dpi, ..scaled })
}

/// What a trail becomes; nothing where it has no extent.
fn drawn(graph: &StrokeGraph, trail: &Trail, width: StrokeWidth, tolerance: Tolerance) -> Option<Drawn> {
    let (page, walk) = (&graph.page, graph.walk(trail));
    let centreline = stroke::fit_trail(&walk, trail.closed, tolerance)?;
    let centreline = rectangle::regular(centreline, tolerance);
    let pattern = |d: Dashes| if trail.closed { dashes::along(d, &walk, &centreline) } else { d };
    let dashes = trail.dashes.map(pattern);
    let profile = Profile::new(&walk, page.blur, unblurred_width(page.line_width, page.blur));
    let mut stroke = Stroke { color: trail.color, dashes, ..Stroke::new(centreline, profile.mean()) };
    match width {
        StrokeWidth::Outline if stroke.dashes.is_none() => {
            let outlines = outline::outline(&stroke, &profile, &graph.revisits(trail), tolerance);
            return Some(Drawn::Outlines(outlines));
        }
        StrokeWidth::Profile => stroke.profile = profile.samples(&stroke.centreline, tolerance.width),
        _ => {}
    }
    Some(Drawn::Stroke(stroke))
}

/// Replaces measured widths where one width is asked for.
fn set_widths(drawing: &mut Drawing, width: StrokeWidth, scale: f64) {
    let all = match width {
        StrokeWidth::Pens => return pens::snap(&mut drawing.strokes, scale),
        StrokeWidth::Measured | StrokeWidth::Outline | StrokeWidth::Profile => return,
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
