//! Solid regions beside lines: no stroke goes through one, whatever its rim is like, and lines that run into one end at it.
//!
//! Floors below one are the shares that were measured, less one case; `cargo test --test solids -- --nocapture` prints
//! what fails. Each sweep leaves a sheet in `tmp/sheets` of Cargo's target directory.

mod common;

use common::draw::{line, on_paper, polar, polyline, scan, sheet};
use common::figures::figures_on;
use common::paper::{Paper, uniform};
use common::sweep::{ensure, pairs};
use fieldtrace::drawing::{Centreline, Color, Drawing, Fill, Stroke};
use fieldtrace::load::Scan;
use kurbo::{BezPath, ParamCurve, ParamCurveArclen, Point, Shape};

const MIDDLE: Point = Point::new(120.3, 118.8);
/// Width of the lines.
const WIDTH: f64 = 4.0;
/// Points of an outline.
const POINTS: usize = 360;

/// A star-like blob: a radius for each degree, wavy by its seed and ragged by so many pixels.
fn blob(seed: u64, ragged: f64) -> Vec<Point> {
    let dice = |k: usize, n: usize| f64::from(uniform(seed, k, n)) - 0.5;
    let wave = |k: usize, angle: f64| 26.0 / k as f64 * dice(k, 1) * (k as f64 * angle + 6.3 * dice(k, 2)).sin();
    let radius = |degree: usize| {
        let angle = (degree as f64).to_radians();
        let teeth = f64::from(uniform(seed, degree / 6, 3)).powi(3) + 0.5 * dice(degree / 2, 4);
        48.0 + (2..7).map(|k| wave(k, angle)).sum::<f64>() + ragged * teeth
    };
    (0..POINTS).map(|degree| polar(MIDDLE, degree as f64, radius(degree))).collect()
}

fn fill(points: &[Point]) -> Fill {
    let mut outline = BezPath::new();
    outline.move_to(points[0]);
    points[1..].iter().for_each(|&p| outline.line_to(p));
    outline.close_path();
    Fill { outline, color: Color::BLACK }
}

/// Crumbs of ink along an outline, up to some pixels from it.
fn crumbs(seed: u64, points: &[Point]) -> Vec<Stroke> {
    let crumb = |k: usize| {
        let dice = |n: usize| f64::from(uniform(seed, k, n));
        let p = polar(points[k], k as f64, 6.0 * dice(7) - 1.0);
        polyline(&[p, polar(p, 360.0 * dice(8), 1.0 + 9.0 * dice(9))], false, 1.5 + 4.0 * dice(10))
    };
    (0..POINTS).filter(|&k| uniform(seed, k, 6) < 0.12).map(crumb).collect()
}

/// How deep inside the filled regions of a drawing a point lies, in pixels; negative outside.
fn depth(drawing: &Drawing, p: Point) -> f64 {
    let of = |fill: &Fill| {
        let near = fill.outline.segments().map(|s| kurbo::ParamCurveNearest::nearest(&s, p, 1e-3).distance_sq);
        let distance = near.fold(f64::INFINITY, f64::min).sqrt();
        if fill.outline.contains(p) { distance } else { -distance }
    };
    drawing.fills.iter().map(of).fold(f64::NEG_INFINITY, f64::max)
}

/// Points along a stroke, two pixels apart.
fn along(stroke: &Stroke) -> Vec<Point> {
    if let Centreline::Dot(p) = stroke.centreline {
        return vec![p];
    }
    let path = stroke.centreline.to_path();
    let points = path.segments().flat_map(|segment| {
        let count = (segment.arclen(1e-2) / 2.0).ceil();
        (0..=count as usize).map(move |k| segment.eval(k as f64 / count.max(1.0)))
    });
    points.collect()
}

/// No stroke lies deeper in what was filled than a line's width.
fn no_stroke_inside(truth: &Drawing, traced: &Drawing) -> Result<(), String> {
    ensure(!traced.fills.is_empty(), || "nothing is filled".into())?;
    let deepest = |stroke: &Stroke| along(stroke).into_iter().map(|p| depth(truth, p)).fold(f64::MIN, f64::max);
    let worst = traced.strokes.iter().map(deepest).fold(f64::MIN, f64::max);
    ensure(worst <= WIDTH + 1.0, || format!("a stroke is {worst:.1} pixels inside"))
}

/// Every line that was drawn into the region is a stroke, from where it begins to the rim.
fn lines_end_at_it(truth: &Drawing, traced: &Drawing, lines: &[Stroke]) -> Result<(), String> {
    for line in lines {
        // Between the teeth of a ragged rim it is part of the region.
        let outside = along(line).into_iter().filter(|&p| depth(truth, p) < -1.5 && depth(traced, p) < 0.0);
        let strokes: Vec<BezPath> = traced.strokes.iter().map(|s| s.centreline.to_path()).collect();
        let off = |p: Point| {
            let segments = strokes.iter().flat_map(|path| path.segments());
            segments.map(|s| kurbo::ParamCurveNearest::nearest(&s, p, 1e-3).distance_sq.sqrt()).fold(f64::MAX, f64::min)
        };
        let worst = outside.map(off).fold(0.0, f64::max);
        ensure(worst <= 2.0, || format!("{worst:.1} pixels of a line are missing"))?;
    }
    Ok(())
}

/// Lines from outside to the middle of the page, so many.
fn rays(seed: u64, count: usize) -> Vec<Stroke> {
    let angle = |k: usize| 360.0 * (k as f64 + 0.4 * f64::from(uniform(seed, k, 12))) / count as f64;
    (0..count).map(|k| line(polar(MIDDLE, angle(k), 112.0), polar(MIDDLE, angle(k) + 4.0, 30.0), WIDTH)).collect()
}

/// A frame of lines, which tell how wide lines are.
fn frame() -> Vec<Stroke> {
    let corners = [(6.0, 6.0), (236.0, 6.0), (236.0, 234.0), (6.0, 234.0)].map(Point::from);
    vec![polyline(&corners, true, WIDTH), line((6.0, 20.0), (236.0, 20.0), WIDTH)]
}

fn page(fills: Vec<Fill>, strokes: Vec<Stroke>) -> Drawing {
    Drawing { fills, ..sheet(242, 240, strokes) }
}

/// The same as a clean render, a scan of ink, and a JPEG of it.
#[derive(Clone, Copy, Debug)]
enum Kind {
    Clean,
    Blurred,
    Jpeg,
}
const KINDS: [Kind; 3] = [Kind::Clean, Kind::Blurred, Kind::Jpeg];
const INK: Paper = Paper { darkness: 0.9, tooth: 0.1, shade: 0.1, blur: 1.1, grain: 0.015, specks: 0.0 };

fn as_kind(kind: Kind, drawing: &Drawing, seed: u64) -> Scan {
    match kind {
        Kind::Clean => scan(drawing),
        Kind::Blurred => on_paper(drawing, INK, seed),
        Kind::Jpeg => jpeg(&on_paper(drawing, INK, seed)),
    }
}

/// A scan after strong compression.
fn jpeg(scan: &Scan) -> Scan {
    let gray = scan.gray.map(|g| (g * 255.0).round() as u8).into_image();
    let mut bytes = Vec::new();
    image::codecs::jpeg::JpegEncoder::new_with_quality(&mut bytes, 40)
        .encode_image(&gray)
        .expect("memory can be written");
    let read = fieldtrace::load::load_bytes("page.jpg", &bytes, &Default::default()).expect("it was just written");
    read.scan
}

#[test]
fn no_stroke_goes_through_a_ragged_blob() {
    let seeds: Vec<u64> = (0..16).collect();
    figures_on(
        "ragged blobs",
        0.958,
        &pairs(&seeds, &KINDS),
        |&(seed, _)| {
            let rim = blob(seed, [2.0, 6.0, 12.0, 20.0][seed as usize % 4]);
            page(vec![fill(&rim)], [frame(), crumbs(seed, &rim)].concat())
        },
        |&(seed, kind), truth| as_kind(kind, truth, seed),
        |_, truth, traced| no_stroke_inside(truth, traced),
    );
}

#[test]
fn lines_that_run_into_a_blob_end_at_it() {
    let seeds: Vec<u64> = (0..12).collect();
    let lines = |seed: u64| rays(seed, 3 + seed as usize % 5);
    figures_on(
        "lines into blobs",
        1.0,
        &pairs(&seeds, &KINDS),
        |&(seed, _)| {
            let rim = blob(seed, [0.0, 3.0, 8.0][seed as usize % 3]);
            page(vec![fill(&rim)], [frame(), lines(seed)].concat())
        },
        |&(seed, kind), truth| as_kind(kind, truth, seed),
        |&(seed, _), truth, traced| {
            no_stroke_inside(truth, traced)?;
            lines_end_at_it(truth, traced, &lines(seed))
        },
    );
}

/// Black areas of a comic: one half black, with feathers or hatching out of it.
#[test]
fn feathers_and_hatching_end_at_the_black_that_they_come_from() {
    let cases = pairs(&[6.0, 9.0, 14.0], &[0.0, 20.0, 45.0]);
    let hatching = |&(apart, slope): &(f64, f64)| -> Vec<Stroke> {
        let count = (170.0 / apart) as usize;
        let y = |k: usize| 40.0 + apart * k as f64;
        let reach = |k: usize| 150.0 + 50.0 * f64::from(uniform(1, k, 1));
        let rise = |k: usize| (reach(k) - 100.0) * slope.to_radians().tan() * 0.5;
        (0..count).map(|k| line((60.0, y(k)), (reach(k), y(k) - rise(k)), 2.5)).collect()
    };
    let black = || {
        let wave = |k: usize| Point::new(110.0 + 10.0 * (k as f64 / 9.0).sin(), 25.0 + 5.0 * k as f64);
        let rim: Vec<Point> = (0..40).map(wave).collect();
        fill(&[vec![Point::new(15.0, 220.0), Point::new(15.0, 25.0)], rim].concat())
    };
    figures_on(
        "hatching out of black",
        1.0,
        &pairs(&cases, &KINDS),
        |(case, _)| page(vec![black()], [frame(), hatching(case)].concat()),
        |&(_, kind), truth| as_kind(kind, truth, 5),
        |_, truth, traced| no_stroke_inside(truth, traced),
    );
}
