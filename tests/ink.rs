//! What of a page is drawing.

mod common;

use common::compare::strokes_apart;
use common::draw::{line, on_paper, polyline, scan, sheet};
use common::paper::Paper;
use fieldtrace::Error;
use fieldtrace::drawing::Drawing;
use fieldtrace::hooks::Observer;
use fieldtrace::ink::{InkEstimator, LearnedInk, drawn};
use fieldtrace::load::Scan;
use fieldtrace::options::{Ink, Options};
use fieldtrace::pipeline::Vectorizer;
use fieldtrace::raster::Raster;
use fieldtrace::render::render;
use image::{Rgb, RgbImage};
use kurbo::Point;

const SIDE: usize = 160;

/// Two lines that cross, and a bent one.
fn figure() -> Drawing {
    let bent = [(20.0, 130.0), (60.0, 95.0), (140.0, 120.0)].map(Point::from);
    let strokes = vec![
        line((20.0, 20.0), (140.0, 90.0), 3.0),
        line((130.0, 15.0), (40.0, 80.0), 3.0),
        polyline(&bent, false, 3.0),
    ];
    sheet(SIDE, SIDE, strokes)
}

fn vectorizer(ink: Ink) -> Vectorizer {
    Vectorizer::new(Options::default().with(|o| o.ink = ink)).unwrap()
}

/// The figure in one colour of ink on a ground of any colours.
fn page(ink: [f32; 3], ground: impl Fn(usize, usize) -> [f32; 3]) -> Scan {
    let coverage = render(&figure());
    let rgb = RgbImage::from_fn(SIDE as u32, SIDE as u32, |x, y| {
        let (x, y) = (x as usize, y as usize);
        let (c, ground) = (coverage[(x, y)], ground(x, y));
        Rgb([0, 1, 2].map(|k| (255.0 * (ground[k] + c * (ink[k] - ground[k]))).round() as u8))
    });
    let gray = Raster::from_fn(SIDE, SIDE, |x, y| {
        let [r, g, b] = rgb.get_pixel(x as u32, y as u32).0.map(f32::from);
        (0.2126 * r + 0.7152 * g + 0.0722 * b) / 255.0
    });
    Scan { gray, rgb: Some(rgb), dpi: None }
}

/// A sharp shadow over squared paper with a stain, under ink that its darkest parts outdo.
fn ground(x: usize, y: usize) -> [f32; 3] {
    let shade = if x + y > 200 { 0.35 } else { 1.0 };
    let ruled = if x % 16 == 3 || y % 16 == 3 { 0.7 } else { 1.0 };
    let stain = if (x as f32 - 110.0).hypot(y as f32 - 50.0) < 25.0 { 0.8 } else { 1.0 };
    [0.95 * shade * ruled * stain, 0.92 * shade * ruled * stain, 0.85 * shade * stain]
}

#[test]
fn what_is_known_to_be_ink_is_traced_on_any_ground() {
    let truth = figure();
    let coverage = render(&truth);
    for ink in [[0.05; 3], [0.7, 0.1, 0.1]] {
        let drawing = vectorizer(Ink::Auto).trace_with_ink(&page(ink, ground), &coverage, &mut ()).unwrap();
        let apart = strokes_apart(&truth, &drawing);
        assert_eq!(drawing.strokes.len(), 3);
        assert!(apart.mean < 0.2 && apart.max < 1.5, "{apart:?}");
    }
    let light = vectorizer(Ink::Auto);
    let board = page([0.9; 3], |x, y| ground(x, y).map(|v| 0.4 * v));
    assert_eq!(light.trace_with_ink(&board, &coverage, &mut ()).unwrap().strokes.len(), 3);
}

#[test]
fn nothing_is_drawn_where_there_is_no_ink() {
    let blank = Raster::filled(SIDE, SIDE, 0.0);
    for seed in 0..4 {
        let noise = on_paper(&figure(), Paper::PENCIL, seed);
        let drawing = vectorizer(Ink::Auto).trace_with_ink(&noise, &blank, &mut ()).unwrap();
        assert!(drawing.strokes.is_empty() && drawing.fills.is_empty());
        assert!(drawn(&noise, &blank).unwrap().gray.data().iter().all(|g| *g == 1.0));
    }
}

#[test]
fn a_map_of_another_size_is_refused() {
    let small = Raster::filled(SIDE, SIDE - 1, 0.0);
    let error = vectorizer(Ink::Auto).trace_with_ink(&scan(&figure()), &small, &mut ()).unwrap_err();
    assert!(matches!(error, Error::InkSize { ink: (160, 159), page: (160, 160) }), "{error}");
}

/// Sees ink on the left half only, and counts how often it is asked.
struct LeftHalf;

impl InkEstimator for LeftHalf {
    fn estimate(&self, scan: &Scan) -> fieldtrace::Result<Raster<f32>> {
        let (width, height) = scan.gray.size();
        Ok(Raster::from_fn(width, height, |x, y| if x < width / 2 { 1.0 - scan.gray[(x, y)] } else { 0.0 }))
    }
}

#[test]
fn the_ink_may_be_told_by_the_caller() {
    let page = scan(&figure());
    let drawing = vectorizer(Ink::Auto).with_ink_estimator(LeftHalf).trace(&page).unwrap();
    assert!(!drawing.strokes.is_empty());
    let right = drawing.strokes.iter().map(|s| kurbo::Shape::bounding_box(&s.centreline.to_path()).x1);
    assert!(right.fold(0.0, f64::max) < 0.5 * SIDE as f64 + 3.0);
}

/// Takes all ink away.
struct Eraser(bool);

impl Observer for Eraser {
    fn on_ink(&mut self, _: &Scan, coverage: &mut Raster<f32>) -> fieldtrace::Result<()> {
        self.0 = true;
        coverage.data_mut().fill(0.0);
        Ok(())
    }
}

#[test]
fn an_observer_sees_the_ink_where_it_is_told() {
    let mut eraser = Eraser(false);
    assert!(vectorizer(Ink::Learned).trace_observed(&scan(&figure()), &mut eraser).unwrap().strokes.is_empty());
    assert!(eraser.0);
    // A clean render needs no telling, and who thresholds is not told.
    for (ink, page) in [(Ink::Auto, scan(&figure())), (Ink::Threshold, on_paper(&figure(), Paper::PENCIL, 1))] {
        let mut eraser = Eraser(false);
        assert_eq!(vectorizer(ink).trace_observed(&page, &mut eraser).unwrap().strokes.len(), 3);
        assert!(!eraser.0);
    }
}

#[test]
fn the_network_tells_ink_from_a_shadow_and_squares() {
    let truth = figure();
    let drawing = vectorizer(Ink::Auto).trace(&page([0.05; 3], ground)).unwrap();
    let apart = strokes_apart(&truth, &drawing);
    assert!(drawing.strokes.len() <= 5 && apart.mean < 0.8, "{} strokes, {apart:?}", drawing.strokes.len());
}

#[test]
fn the_ink_is_the_same_on_any_number_of_threads_and_in_any_size() {
    let page = on_paper(&figure(), Paper::PENCIL, 3);
    let ink = LearnedInk::default();
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| ink.estimate(&page).unwrap())
    };
    assert_eq!(on(1), on(4));
    for (width, height) in [(1, 1), (1, 300), (37, 5), (1500, 20)] {
        let blank = Scan { gray: Raster::filled(width, height, 0.9), rgb: None, dpi: None };
        assert_eq!(ink.estimate(&blank).unwrap().size(), (width, height));
    }
}
