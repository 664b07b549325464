//! Inputs that nobody draws: each is traced to its end, and sanely.

mod common;

#[path = "../fuzz/src/lib.rs"]
#[allow(dead_code)] // what only the fuzzer needs
mod targets;

use common::compare::strokes_apart;
use common::draw::{line, polyline, scan, scan_of, sheet, trace, trace_under};
use fieldtrace::Error;
use fieldtrace::clean::{LineImage, Noise, NoiseMap};
use fieldtrace::drawing::{Drawing, Stroke};
use fieldtrace::field::{PolyVectorField, encode};
use fieldtrace::hooks::Observer;
use fieldtrace::load::Scan;
use fieldtrace::options::{Ink, Options};
use fieldtrace::pipeline::Vectorizer;
use fieldtrace::raster::Raster;
use fieldtrace::streamline::Streamline;
use kurbo::{ParamCurveArclen, Point, Vec2};
use num_complex::Complex32;
use targets::assert_sane;

fn vectorizer() -> Vectorizer {
    Vectorizer::new(Options::default()).unwrap()
}

/// The trace of a raster, which must be sane.
fn sane(gray: Raster<f32>) -> Drawing {
    let scan = scan_of(gray);
    let drawing = trace(&scan);
    assert_sane(&drawing, &scan);
    drawing
}

/// Black where a rule says so.
fn inked(width: usize, height: usize, ink: impl Fn(usize, usize) -> bool) -> Raster<f32> {
    Raster::from_fn(width, height, |x, y| if ink(x, y) { 0.0 } else { 1.0 })
}

/// Length of all strokes.
fn length(drawing: &Drawing) -> f64 {
    let paths = drawing.strokes.iter().map(|s| s.centreline.to_path());
    paths.map(|path| path.segments().map(|s| s.arclen(1e-2)).sum::<f64>()).sum()
}

/// Numbers that look random and are the same each time.
fn dice(x: usize, y: usize) -> u32 {
    let mut h = (x as u32).wrapping_mul(0x9E37_79B1) ^ (y as u32).wrapping_mul(0x85EB_CA77);
    for (shift, factor) in [(15, 0x2C1B_3C6D), (12, 0x297A_2D39), (15, 1)] {
        h = (h ^ (h >> shift)).wrapping_mul(factor);
    }
    h
}

/// A plus and a ring.
fn plain() -> Scan {
    let ring = common::draw::circle((70.0, 40.0), 18.0, 3.0);
    scan(&sheet(100, 80, vec![line((8.0, 40.0), (44.0, 40.0), 3.0), line((26.0, 12.0), (26.0, 68.0), 3.0), ring]))
}

#[test]
fn values_that_are_no_field() {
    let zero = Complex32::ZERO;
    let (c0, c2) = encode(Vec2::new(1.0, 0.0), Vec2::new(0.0, 1.0));
    let bad = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, f32::MIN_POSITIVE, 0.0, -0.0, 1e-20, 1e20];
    let values = bad.iter().flat_map(|&b| [Complex32::new(b, 0.0), Complex32::new(0.0, b), Complex32::new(b, b)]);
    let scan = plain();
    let (width, height) = scan.gray.size();
    for value in values {
        // Everywhere, or in every fifth pixel of a field that is else horizontal and vertical.
        for every in [1, 5] {
            let mix = |good: Complex32| {
                Raster::from_fn(width, height, |x, y| if dice(x, y).is_multiple_of(every) { value } else { good })
            };
            for (a, b) in [(mix(c0), mix(c2)), (mix(zero), Raster::filled(width, height, c2))] {
                for confidence in [1.0, f32::NAN, f32::INFINITY, -1.0, 1e-30] {
                    let confidence = Raster::filled(width, height, confidence);
                    let field = PolyVectorField::new(a.clone(), b.clone(), confidence).unwrap();
                    let drawing = vectorizer().trace_with_field(&scan, &field, &mut ()).unwrap();
                    assert_sane(&drawing, &scan);
                }
            }
        }
    }
}

/// Changes what it sees by a rule.
struct Change<F, G>(F, G);

impl<F: FnMut(&mut LineImage), G: FnMut(&mut PolyVectorField)> Observer for Change<F, G> {
    fn on_line_image(&mut self, image: &mut LineImage) -> fieldtrace::Result<()> {
        self.0(image);
        Ok(())
    }
    fn on_field(&mut self, _: &LineImage, field: &mut PolyVectorField) -> fieldtrace::Result<()> {
        self.1(field);
        Ok(())
    }
}

#[test]
fn a_field_that_an_observer_resized_is_refused() {
    for (width, height) in [(1, 1), (100, 79), (99, 80), (80, 100), (200, 160), (0, 0)] {
        let mut change = Change(
            |_: &mut LineImage| {},
            |field: &mut PolyVectorField| {
                *field = PolyVectorField::from_directions(width, height, |_, _| None);
            },
        );
        let error = vectorizer().trace_observed(&plain(), &mut change).unwrap_err();
        assert!(matches!(error, Error::FieldSize { field, image: (100, 80) } if field == (width, height)), "{error}");
    }
}

#[test]
fn a_line_image_that_an_observer_broke_is_refused() {
    type Change = fn(&mut LineImage);
    let breaks: [(&str, Change); 9] = [
        ("ink", |image| image.ink = Raster::filled(3, 3, 1.0)),
        ("mask", |image| image.mask = Raster::filled(100, 81, true)),
        ("depth", |image| image.depth = Raster::filled(0, 0, 1.0)),
        ("blur", |image| image.blur = 1e300),
        ("line width", |image| image.line_width = f64::NAN),
        ("line width", |image| image.line_width = 0.0),
        ("scale", |image| image.scale = -1.0),
        ("noise", |image| image.noise = NoiseMap::even(Noise { across: f64::INFINITY, ..Noise::default() })),
        ("blur", |image| image.blur = -0.5),
    ];
    for (what, change) in breaks {
        let error =
            vectorizer().trace_observed(&plain(), &mut Change(change, |_: &mut PolyVectorField| {})).unwrap_err();
        assert!(error.to_string().contains(what), "{what}: {error}");
    }
}

#[test]
fn a_streamline_that_an_observer_broke_is_refused() {
    struct Break(fn(&mut Streamline));
    impl Observer for Break {
        fn on_streamline(&mut self, _: &LineImage, streamline: &mut Streamline) -> fieldtrace::Result<bool> {
            (self.0)(streamline);
            Ok(true)
        }
    }
    type Change = fn(&mut Streamline);
    let breaks: [(&str, Change); 3] = [
        ("widths", |s| s.widths.truncate(1)),
        ("no points", |s| (s.points, s.widths) = (Vec::new(), Vec::new())),
        ("not finite", |s| s.points[0].x = f64::NAN),
    ];
    for (what, change) in breaks {
        let error = vectorizer().trace_observed(&plain(), &mut Break(change)).unwrap_err();
        assert!(error.to_string().contains(what), "{what}: {error}");
    }
    // Short and immeasurable ones will do.
    let poor: [fn(&mut Streamline); 4] = [
        |s| (s.points, s.widths) = (vec![s.points[0]], vec![s.widths[0]]),
        |s| (s.points, s.widths) = (vec![s.points[0]; 2], vec![s.widths[0]; 2]),
        |s| s.widths.fill(f64::NAN),
        |s| s.closed = true,
    ];
    for change in poor {
        let scan = plain();
        assert_sane(&vectorizer().trace_observed(&scan, &mut Break(change)).unwrap(), &scan);
    }
}

#[test]
fn a_mask_of_all_ink() {
    let all = |image: &mut LineImage| image.mask = image.mask.map(|_| true);
    for scan in [plain(), scan_of(Raster::filled(90, 70, 0.0)), scan_of(Raster::filled(90, 70, 1.0))] {
        let drawing = vectorizer().trace_observed(&scan, &mut Change(all, |_: &mut PolyVectorField| {})).unwrap();
        assert_sane(&drawing, &scan);
        // And under a field that goes round and round.
        let turning = PolyVectorField::from_directions(scan.gray.width(), scan.gray.height(), |x, y| {
            let round = (Point::new(x as f64, y as f64) - Point::new(45.0, 35.5)).turn_90();
            (round.hypot() > 0.0).then(|| (round.normalize(), round.turn_90().normalize()))
        });
        let mut change = Change(all, |_: &mut PolyVectorField| {});
        assert_sane(&vectorizer().trace_with_field(&scan, &turning, &mut change).unwrap(), &scan);
    }
    // A page of one tone has no lines, whatever the tone.
    for tone in [0.0, 0.3, 1.0] {
        assert!(sane(Raster::filled(300, 200, tone)).strokes.is_empty());
    }
}

#[test]
fn checkerboards_and_hatching_at_every_pitch() {
    for pitch in 1..6 {
        sane(inked(200, 160, |x, y| (x / pitch + y / pitch) % 2 == 0));
        sane(inked(200, 160, |x, _| x % (pitch + 1) == 0));
        sane(inked(200, 160, |x, y| (x + y) % (pitch + 2) == 0 || (x + 3 * y) % (2 * pitch + 3) == 0));
    }
}

#[test]
fn salt_at_every_strength() {
    for share in [1, 4, 16, 64, 128, 200, 250, 255] {
        sane(inked(200, 160, |x, y| dice(x, y) >> 24 < share));
        sane(Raster::from_fn(
            200,
            160,
            |x, y| if dice(x, y) >> 24 < share { (dice(y, x) >> 24) as f32 / 255.0 } else { 1.0 },
        ));
    }
}

#[test]
fn fifty_thousand_blobs() {
    let (blobs, columns) = (50_000, 250);
    let scan =
        scan_of(inked(5 * columns, 5 * blobs / columns, |x, y| (1..3).contains(&(x % 5)) && (1..3).contains(&(y % 5))));
    // To the network, that many specks are a screen.
    let drawing = trace_under(Options::default().with(|o| o.ink = Ink::Threshold), &scan);
    assert_sane(&drawing, &scan);
    // A few neighbours in a row may be taken for one broken line.
    let count = drawing.strokes.len() + drawing.fills.len();
    assert!(count <= blobs && count * 100 >= blobs * 98, "{count}");
}

/// Archimedes' spiral of some length, its turns 8 pixels apart.
fn spiral(length: f64) -> (Drawing, f64) {
    let turn = |angle: f64| 4.0 / std::f64::consts::PI * angle;
    let (mut angle, mut walked) = (2.0 * std::f64::consts::PI, 0.0);
    let mut points = Vec::new();
    while walked < length {
        points.push((angle, turn(angle)));
        let step = 1.0 / turn(angle).max(1.0);
        walked += step * turn(angle);
        angle += step;
    }
    let side = (2.0 * turn(angle) + 16.0).ceil();
    let place = |&(angle, radius): &(f64, f64)| Point::new(0.5 * side, 0.5 * side) + Vec2::from_angle(angle) * radius;
    let points: Vec<Point> = points.iter().map(place).collect();
    (sheet(side as usize, side as usize, vec![polyline(&points, false, 3.0)]), walked)
}

#[test]
fn a_spiral_of_ten_thousand_pixels_is_one_stroke() {
    let (truth, walked) = spiral(10_000.0);
    let drawing = trace(&scan(&truth));
    assert_eq!(drawing.strokes.len(), 1);
    assert!((length(&drawing) - walked).abs() < 0.002 * walked, "{} of {walked}", length(&drawing));
    let apart = strokes_apart(&truth, &drawing);
    assert!(apart.mean < 0.1 && apart.max < 1.0, "{apart:?}");
}

#[test]
fn strokes_that_touch_the_border() {
    let (w, h) = (80.0, 60.0);
    let edges = [(0.0, 0.0), (w, 0.0), (w, h), (0.0, h)].map(Point::from);
    for width in [1.0, 2.0, 3.0, 5.0] {
        let mut pages: Vec<Vec<Stroke>> = vec![
            // Along the border, half of it outside; just inside; from border to border.
            vec![polyline(&edges, true, width)],
            vec![polyline(&edges.map(|p| p.lerp(Point::new(0.5 * w, 0.5 * h), 0.04)), true, width)],
            edges.iter().map(|&p| line(p, (0.5 * w, 0.5 * h), width)).collect(),
        ];
        pages.extend((0..8).map(|k| {
            let across = Vec2::from_angle(f64::from(k) * std::f64::consts::PI / 8.0) * 200.0;
            vec![line(Point::new(40.0, 30.0) - across, Point::new(40.0, 30.0) + across, width)]
        }));
        for (i, strokes) in pages.into_iter().enumerate() {
            let scan = scan(&sheet(80, 60, strokes));
            let drawing = trace(&scan);
            assert_sane(&drawing, &scan);
            if i > 2 {
                assert_eq!(drawing.strokes.len(), 1, "page {i}, width {width}: {:?}", drawing.strokes);
            }
        }
    }
}

#[test]
fn pages_of_a_pixel_or_a_row() {
    let rules: [fn(usize, usize) -> bool; 3] = [|_, _| true, |x, y| (x + y) % 2 == 0, |x, y| x == 0 || y == 0];
    for (width, height) in [(1, 1), (1, 2), (2, 1), (3, 3), (1, 300), (300, 1), (2, 300), (300, 3)] {
        for rule in rules {
            sane(inked(width, height, rule));
        }
    }
}
