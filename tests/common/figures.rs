//! Sweeps over figures: each is drawn, traced and compared with what was drawn.

use super::compare::{apart, bow, ends_of};
use super::draw::{scan, trace_under};
use super::sheet::{self, Figure};
use super::sweep::{ensure, report, require};
use fieldtrace::drawing::{Drawing, Stroke};
use fieldtrace::load::Scan;
use fieldtrace::metrics::nodes;
use fieldtrace::options::{Ink, Options};
use kurbo::Point;
use rayon::prelude::*;
use std::fmt::Debug;

/// Traces the clean rendering of every case's drawing and requires that at least `floor` of the cases, as a share, keep
/// a rule, which is given the case, what was drawn and what was traced.
#[track_caller]
pub fn figures<C: Debug + Sync>(
    name: &str,
    floor: f64,
    cases: &[C],
    draw: impl Fn(&C) -> Drawing + Sync,
    rule: impl Fn(&C, &Drawing, &Drawing) -> Result<(), String> + Sync,
) {
    figures_on(name, floor, cases, draw, |_, drawing| scan(drawing), rule);
}

/// The same on scans of one's own. They are about what becomes of the ink, which is told by darkness alone: what a network
/// makes of a page is for `tests/ink.rs`.
#[track_caller]
pub fn figures_on<C: Debug + Sync>(
    name: &str,
    floor: f64,
    cases: &[C],
    draw: impl Fn(&C) -> Drawing + Sync,
    scan: impl Fn(&C, &Drawing) -> Scan + Sync,
    rule: impl Fn(&C, &Drawing, &Drawing) -> Result<(), String> + Sync,
) {
    let figure = |case: &C| {
        let truth = draw(case);
        let options = Options::default().with(|o| o.ink = Ink::Threshold);
        let traced = trace_under(options, &scan(case, &truth));
        let fault = rule(case, &truth, &traced).err();
        Figure { label: format!("{case:?}"), truth, traced, fault }
    };
    let figures: Vec<Figure> = cases.par_iter().map(figure).collect();
    sheet::write(name, &figures);
    let results: Vec<Result<(), String>> = figures.into_iter().map(|f| f.fault.map_or(Ok(()), Err)).collect();
    require(name, floor, report(name, cases, &results));
}

/// Every drawn stroke is one traced stroke that keeps within a distance of it from end to end, and nothing else is
/// traced.
pub fn same_strokes(truth: &Drawing, traced: &Drawing, tolerance: f64) -> Result<(), String> {
    let (drawn, found) = (truth.strokes.len(), traced.strokes.len());
    ensure(traced.fills.len() == truth.fills.len(), || format!("{} filled regions", traced.fills.len()))?;
    ensure(found == drawn, || format!("{found} strokes for {drawn}"))?;
    let mut left: Vec<&Stroke> = traced.strokes.iter().collect();
    for stroke in &truth.strokes {
        let off = |other: &Stroke| apart(&[stroke.centreline.to_path()], &[other.centreline.to_path()]).max;
        let offs: Vec<f64> = left.iter().map(|other| off(other)).collect();
        let best = (0..left.len()).min_by(|&a, &b| offs[a].total_cmp(&offs[b])).ok_or("no stroke")?;
        ensure(offs[best] <= tolerance, || format!("a stroke is off by {:.2}", offs[best]))?;
        left.remove(best);
    }
    Ok(())
}

/// The traced stroke that keeps within a distance of a drawn one from end to end.
pub fn like_stroke<'a>(stroke: &Stroke, traced: &'a Drawing, tolerance: f64) -> Result<&'a Stroke, String> {
    let path = [stroke.centreline.to_path()];
    let off = |other: &Stroke| apart(&path, &[other.centreline.to_path()]).max;
    let offs: Vec<f64> = traced.strokes.iter().map(off).collect();
    let best = (0..offs.len()).min_by(|&a, &b| offs[a].total_cmp(&offs[b])).ok_or("no stroke")?;
    ensure(offs[best] <= tolerance, || format!("the nearest to a stroke is off by {:.2}", offs[best]))?;
    Ok(&traced.strokes[best])
}

/// As many junctions and ends as were drawn, each within a distance of its own.
pub fn same_nodes(truth: &Drawing, traced: &Drawing, tolerance: f64) -> Result<(), String> {
    let pen = truth.strokes.iter().map(|s| s.width).fold(0.0, f64::max);
    let (a, b) = (nodes(truth, pen), nodes(traced, pen));
    for (what, drawn, found) in [("junctions", &a.junctions, &b.junctions), ("ends", &a.ends, &b.ends)] {
        ensure(found.len() == drawn.len(), || format!("{} {what} for {}", found.len(), drawn.len()))?;
        let off = drawn.iter().map(|p| nearest(*p, found)).fold(0.0, f64::max);
        ensure(off <= tolerance, || format!("{what} are off by {off:.2}"))?;
    }
    Ok(())
}

/// Distance to the nearest of some points.
pub fn nearest(p: Point, points: &[Point]) -> f64 {
    points.iter().map(|q| p.distance(*q)).fold(f64::INFINITY, f64::min)
}

/// Distance to the nearest end of an open stroke.
pub fn nearest_end(p: Point, traced: &Drawing) -> f64 {
    nearest(p, &ends_of(traced))
}

/// Every stroke bows at most so much.
pub fn straight(result: &Drawing, tolerance: f64) -> Result<(), String> {
    let bow = result.strokes.iter().map(|s| bow(&s.centreline)).fold(0.0, f64::max);
    ensure(bow <= tolerance, || format!("a stroke bows by {bow:.2}"))
}

/// As much line as was drawn, so that nothing is there twice.
pub fn same_length(truth: &Drawing, traced: &Drawing, tolerance: f64) -> Result<(), String> {
    let ratio = traced.length() / truth.length();
    ensure((ratio - 1.0).abs() <= tolerance, || format!("{ratio:.3} of the length"))
}
