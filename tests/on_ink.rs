//! No stroke lies where there is no ink, and no solid region covers what is none.

mod common;

use common::draw::{arc, circle, color_scan, cubic, line, on_paper, scan, scan_of, sheet};
use common::paper::Paper;
use fieldtrace::clean::LineImage;
use fieldtrace::drawing::{Centreline, Color, Drawing};
use fieldtrace::hooks::Observer;
use fieldtrace::inspect::{NO_DRAWING, edge_share};
use fieldtrace::load::Scan;
use fieldtrace::options::{Ink, Options};
use fieldtrace::pipeline::Vectorizer;
use fieldtrace::raster::Raster;
use kurbo::{ParamCurve, Point, Shape};
use std::f64::consts::FRAC_PI_8;

const SIDE: usize = 180;

/// Keeps what strokes were made of, and how much of that were edges of tones.
#[derive(Default)]
struct Kept {
    image: Option<LineImage>,
    edges: f64,
    scan: Option<Scan>,
}

impl Observer for Kept {
    fn on_line_image(&mut self, image: &mut LineImage) -> fieldtrace::Result<()> {
        self.image = Some(image.clone());
        Ok(())
    }

    fn on_graph(&mut self, image: &LineImage, graph: &mut fieldtrace::graph::StrokeGraph) -> fieldtrace::Result<()> {
        self.edges = self.scan.as_ref().map_or(0.0, |scan| edge_share(scan, image, graph));
        Ok(())
    }
}

/// The farthest that a point of a stroke lies from ink, in widths of its line or of a typical one, and where.
fn farthest(image: &LineImage, drawing: &Drawing) -> (f64, Point) {
    let layers: Vec<&LineImage> = std::iter::once(image).chain(image.broad.as_deref()).collect();
    let is_ink = |p: Point| {
        layers.iter().any(|layer| {
            let at = (p.to_vec2() * layer.scale).to_point();
            layer.mask.at(at) == Some(true) || layer.solid.at(at) == Some(true)
        })
    };
    let mut most = (0.0, Point::ZERO);
    for stroke in drawing.strokes.iter().filter(|stroke| !matches!(stroke.centreline, Centreline::Dot(_))) {
        let width = stroke.width.max(image.line_width / image.scale);
        for piece in stroke.centreline.to_path().segments() {
            let count = (piece.to_cubic().perimeter(0.5) / 2.0).ceil().max(1.0) as usize;
            for p in (0..=count).map(|k| piece.eval(k as f64 / count as f64)) {
                let ring =
                    |reach: f64| (0..16).map(move |k| p + kurbo::Vec2::from_angle(f64::from(k) * FRAC_PI_8) * reach);
                let reach = (0..60).map(|k| 0.1 * f64::from(k)).find(|reach| ring(reach * width).any(is_ink));
                let reach = reach.unwrap_or(6.0);
                if reach > most.0 {
                    most = (reach, p);
                }
            }
        }
    }
    most
}

/// Random lines, arcs, circles and curves.
fn scribble(seed: u64) -> Drawing {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    let mut random = |low: f64, high: f64| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        low + (high - low) * (state >> 11) as f64 / (1u64 << 53) as f64
    };
    let count = random(3.0, 12.0) as usize;
    let width = random(1.5, 5.0);
    let strokes = (0..count).map(|_| {
        let mut place = || (random(5.0, 175.0), random(5.0, 175.0));
        let [a, b, c, d] = [place(), place(), place(), place()];
        match random(0.0, 4.0) as usize {
            0 => line(a, b, width),
            1 => circle(a, random(6.0, 50.0), width),
            2 => arc(a, random(10.0, 60.0), random(0.0, 6.0), random(1.0, 5.0), width),
            _ => cubic([a, b, c, d], width),
        }
    });
    sheet(SIDE, SIDE, strokes.collect())
}

#[track_caller]
fn check(what: &str, scan: &Scan, ink: Ink) {
    let vectorizer = Vectorizer::new(Options::default().with(|o| o.ink = ink)).unwrap();
    let mut kept = Kept { scan: Some(scan.clone()), ..Kept::default() };
    let drawing = vectorizer.trace_observed(scan, &mut kept).unwrap();
    let image = kept.image.unwrap();
    let (far, at) = farthest(&image, &drawing);
    assert!(far <= 1.0, "{what}, {ink:?}: a stroke at {at} is {far:.1} widths off the ink");
    let covered = drawing.fills.iter().map(|fill| fill.outline.area().abs()).sum::<f64>();
    let solid = image.solid.count() as f64 / image.scale.powi(2);
    assert!(covered <= 1.2 * solid + 20.0, "{what}, {ink:?}: {covered:.0} pixels filled, {solid:.0} solid");
    if what != "tones" {
        assert!(kept.edges < NO_DRAWING, "{what}, {ink:?}: {:.2} edges", kept.edges);
    }
}

#[test]
fn strokes_lie_on_ink_on_any_page() {
    for seed in 0..12 {
        let drawing = scribble(seed);
        check(&format!("render {seed}"), &scan(&drawing), Ink::Auto);
        for (name, paper) in [("pencil", Paper::PENCIL), ("ink", Paper::INK)] {
            for ink in [Ink::Auto, Ink::Learned, Ink::Threshold] {
                check(&format!("{name} {seed}"), &on_paper(&drawing, paper, seed), ink);
            }
        }
        check(&format!("colour {seed}"), &color_scan(&drawing, Color([250, 240, 200])), Ink::Auto);
    }
}

/// Six tones in regions of any shape, as in a photograph.
fn tones(seed: usize) -> Scan {
    let dice = |i: usize, j: usize, cell: usize| {
        let v = (seed * 7919 + cell) * 1_000_003 + i * 1009 + j;
        let v = (v as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        ((v ^ (v >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9) >> 40) as f32 / (1u64 << 24) as f32
    };
    // Values on a lattice, and between them.
    let smooth = |x: usize, y: usize, cell: usize| {
        let (i, j, u, v) = (x / cell, y / cell, (x % cell) as f32 / cell as f32, (y % cell) as f32 / cell as f32);
        let across = |j: usize| dice(i, j, cell) * (1.0 - u) + dice(i + 1, j, cell) * u;
        across(j) * (1.0 - v) + across(j + 1) * v
    };
    scan_of(Raster::from_fn(SIDE, SIDE, |x, y| {
        (6.0 * (0.67 * smooth(x, y, 16) + 0.33 * smooth(x, y, 6))).floor() / 5.0
    }))
}

#[test]
fn a_page_of_tones_is_traced_on_its_ink_and_looks_like_no_drawing() {
    for seed in 0..6 {
        let page = tones(seed);
        check("tones", &page, Ink::Auto);
        let mut kept = Kept { scan: Some(page.clone()), ..Kept::default() };
        let by_darkness = Options::default().with(|o| o.ink = Ink::Threshold);
        Vectorizer::new(by_darkness).unwrap().trace_observed(&page, &mut kept).unwrap();
        assert!(kept.edges > NO_DRAWING, "{:.2} edges", kept.edges);
    }
}

#[test]
fn what_looks_like_no_line_drawing_is_said_to() {
    let folder = tempfile::tempdir().unwrap();
    for (name, scan) in [("tones.png", tones(1)), ("drawing.png", scan(&scribble(1)))] {
        let byte = |x: u32, y: u32| (255.0 * scan.gray[(x as usize, y as usize)]).round() as u8;
        image::GrayImage::from_fn(SIDE as u32, SIDE as u32, |x, y| image::Luma([byte(x, y)]))
            .save(folder.path().join(name))
            .unwrap();
    }
    let run = |words: &[&str]| {
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_trace"));
        let output = command.current_dir(&folder).args(words).args(["--ink", "threshold"]).output().unwrap();
        assert!(output.status.success());
        [output.stdout, output.stderr].map(|text| String::from_utf8(text).unwrap())
    };
    let [_, said] = run(&["tones.png"]);
    assert!(said.contains("looks like no line drawing"), "{said}");
    assert_eq!(run(&["drawing.png"])[1], "");
    let [records, _] = run(&["drawing.png", "tones.png", "-o", "out", "--json"]);
    let [drawing, tones] = records.lines().collect::<Vec<_>>()[..] else { panic!("{records}") };
    assert!(tones.contains("looks like no line drawing") && !drawing.contains("looks like"), "{records}");
}

#[test]
fn ink_is_chosen_by_its_colour() {
    let inked = |color, y: f64| fieldtrace::drawing::Stroke { color, ..line((20.0, y), (160.0, y + 20.0), 3.0) };
    let (red, blue) = (Color([200, 20, 20]), Color([20, 40, 190]));
    let page = color_scan(
        &sheet(SIDE, SIDE, vec![inked(red, 40.0), inked(blue, 80.0), inked(Color::BLACK, 120.0)]),
        Color([255; 3]),
    );
    let colors = |only: &[Color], ignore: &[Color], color_tolerance: f64| {
        let options = Options::default().with(|o| {
            o.only = only.into();
            o.ignore = ignore.into();
            o.color_tolerance = color_tolerance;
        });
        let drawing = Vectorizer::new(options).unwrap().trace(&page).unwrap();
        let mut near: Vec<usize> = drawing
            .strokes
            .iter()
            .map(|s| [red, blue, Color::BLACK].iter().position(|c| c.distance(s.color) < 0.1).unwrap())
            .collect();
        near.sort_unstable();
        near
    };
    assert_eq!(colors(&[], &[], 0.15), [0, 1, 2]);
    assert_eq!(colors(&[red], &[], 0.15), [0]);
    assert_eq!(colors(&[red, Color::BLACK], &[], 0.15), [0, 2]);
    assert_eq!(colors(&[], &[blue], 0.15), [0, 2]);
    assert_eq!(colors(&[Color([255, 80, 80])], &[], 0.02), [] as [usize; 0]);
    assert_eq!(colors(&[Color([255, 80, 80])], &[], 0.3), [0]);
    assert!(Vectorizer::new(Options::default().with(|o| o.color_tolerance = 1.5)).is_err());
}
