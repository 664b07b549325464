//! What a trace must keep to on any drawing: turning, mirroring, scaling, inverting and redrawing the picture.

mod common;

use common::compare::{Apart, apart, lines, mapped, strokes_apart};
use common::draw::{arc, circle, cubic, dot, line, polyline, scan, scan_of, sheet, trace};
use common::paper::{Paper, uniform};
use common::sweep::{ensure, require, share};
use fieldtrace::drawing::{Drawing, Stroke};
use fieldtrace::load::Scan;
use fieldtrace::options::Options;
use fieldtrace::pipeline::Vectorizer;
use fieldtrace::raster::Raster;
use fieldtrace::render::render;
use fieldtrace::write::{WriteOptions, to_svg};
use kurbo::{Affine, Point};

/// A drawing with a name to know it by.
struct Sample {
    name: String,
    drawing: Drawing,
}

impl std::fmt::Debug for Sample {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.name)
    }
}

/// Drawings that differ in kind, on 128 x 112 pixels.
fn named() -> Vec<Sample> {
    let at = |p: &[(f64, f64)]| -> Vec<Point> { p.iter().copied().map(Point::from).collect() };
    let named: Vec<(&str, Vec<Stroke>)> = vec![
        ("cross", vec![line((12.0, 20.0), (112.0, 90.0), 4.0), line((20.0, 95.0), (105.0, 15.0), 4.0)]),
        (
            "house",
            vec![
                polyline(&at(&[(30.0, 50.0), (98.0, 50.0), (98.0, 98.0), (30.0, 98.0)]), true, 3.0),
                polyline(&at(&[(20.0, 50.0), (64.0, 14.0), (108.0, 50.0)]), false, 3.0),
                polyline(&at(&[(56.0, 98.0), (56.0, 72.0), (72.0, 72.0), (72.0, 98.0)]), false, 3.0),
            ],
        ),
        (
            "face",
            vec![
                circle((64.0, 56.0), 44.0, 4.0),
                arc((64.0, 56.0), 26.0, 0.5, 2.1, 4.0),
                dot((48.0, 44.0), 6.0),
                dot((80.0, 44.0), 6.0),
                line((64.0, 50.0), (64.0, 62.0), 4.0),
            ],
        ),
        (
            "wave",
            vec![
                cubic([(10.0, 60.0), (50.0, -20.0), (70.0, 130.0), (118.0, 40.0)], 3.0),
                cubic([(14.0, 100.0), (40.0, 80.0), (90.0, 110.0), (116.0, 92.0)], 3.0),
            ],
        ),
        (
            "plan",
            vec![
                polyline(&at(&[(10.0, 12.0), (118.0, 12.0), (118.0, 100.0), (10.0, 100.0)]), true, 5.0),
                line((60.0, 12.0), (60.0, 70.0), 5.0),
                line((60.0, 70.0), (118.0, 70.0), 5.0),
                arc((10.0, 50.0), 30.0, -0.5 * std::f64::consts::PI, 0.5 * std::f64::consts::PI, 2.0),
            ],
        ),
    ];
    let sample = |(name, strokes): (&str, _)| Sample { name: name.into(), drawing: sheet(128, 112, strokes) };
    named.into_iter().map(sample).collect()
}

/// Tangled drawings, many of them with lines that touch or nearly do.
fn tangled() -> Vec<Sample> {
    (0..24).map(|seed| Sample { name: format!("tangle {seed}"), drawing: random(seed) }).collect()
}

/// Sweeps a rule over the named and over the tangled drawings, with a floor for each.
#[track_caller]
fn on_all(name: &str, floors: [f64; 2], rule: impl Fn(&Drawing) -> Result<(), String> + Sync) {
    let names = [name.to_string(), format!("{name}, tangled")];
    let keeps = |sample: &Sample| rule(&sample.drawing);
    let shares = [share(&names[0], &named(), keeps), share(&names[1], &tangled(), keeps)];
    for ((name, floor), share) in names.iter().zip(floors).zip(shares) {
        require(name, floor, share);
    }
}

/// Curves and lines at random.
fn random(seed: u64) -> Drawing {
    let number = |i: usize, j: usize, low: f64, high: f64| low + (high - low) * f64::from(uniform(seed, i, j));
    let width = number(99, 0, 2.0, 6.0);
    let strokes = (0..4).map(|i| {
        let p = |j: usize| (number(i, 2 * j, 12.0, 116.0), number(i, 2 * j + 1, 12.0, 100.0));
        let (a, b) = (p(0), (0.5 * (p(1).0 + p(0).0), 0.5 * (p(1).1 + p(0).1)));
        let (d, c) = (p(3), (0.5 * (p(2).0 + p(3).0), 0.5 * (p(2).1 + p(3).1)));
        if i % 2 == 0 { line(a, d, width) } else { cubic([a, b, c, d], width) }
    });
    sheet(128, 112, strokes.collect())
}

/// The scan with its pixels moved: `from` gives the source of a pixel.
fn moved(scan: &Scan, width: usize, height: usize, from: impl Fn(usize, usize) -> (usize, usize)) -> Scan {
    scan_of(Raster::from_fn(width, height, |x, y| scan.gray[from(x, y)]))
}

/// Whether two traces are the same drawing: as many strokes and near each other.
fn same(count: (usize, usize), apart: Apart, mean: f64, max: f64) -> Result<(), String> {
    ensure(count.0 == count.1, || format!("{} strokes and {}", count.0, count.1))?;
    ensure(apart.mean <= mean && apart.max <= max, || format!("{apart:.3?}"))
}

fn same_under(map: Affine, before: &Drawing, after: &Drawing) -> Result<(), String> {
    let apart = apart(&mapped(before, map), &lines(after));
    same((before.strokes.len(), after.strokes.len()), apart, 0.1, 1.0)
}

#[test]
fn a_quarter_turn_turns_the_strokes() {
    on_all("quarter turns", [1.0, 0.541], |drawing| {
        let upright = scan(drawing);
        let (width, height) = upright.gray.size();
        let turned = moved(&upright, height, width, |x, y| (y, height - 1 - x));
        let map = Affine::new([0.0, 1.0, -1.0, 0.0, height as f64, 0.0]);
        same_under(map, &trace(&upright), &trace(&turned))
    });
}

#[test]
fn a_mirror_mirrors_the_strokes() {
    on_all("mirrors", [0.8, 0.583], |drawing| {
        let plain = scan(drawing);
        let (width, height) = plain.gray.size();
        let mirrored = moved(&plain, width, height, |x, y| (width - 1 - x, y));
        let map = Affine::new([-1.0, 0.0, 0.0, 1.0, width as f64, 0.0]);
        same_under(map, &trace(&plain), &trace(&mirrored))
    });
}

#[test]
fn a_shift_shifts_the_strokes() {
    on_all("shifts", [1.0, 1.0], |drawing| {
        let plain = scan(drawing);
        let (width, height) = plain.gray.size();
        let at = |x: usize, y: usize| plain.gray.get(x as i64 - 7, y as i64 - 11).unwrap_or(1.0);
        let shifted = scan_of(Raster::from_fn(width + 20, height + 20, at));
        same_under(Affine::translate((7.0, 11.0)), &trace(&plain), &trace(&shifted))
    });
}

#[test]
fn twice_the_size_is_twice_the_drawing() {
    on_all("twice the size", [0.8, 0.333], |drawing| {
        let (small, large) = (trace(&scan(drawing)), trace(&scan(&drawing.scaled(2.0))));
        let apart = strokes_apart(&small.scaled(2.0), &large);
        same((small.strokes.len(), large.strokes.len()), apart, 0.3, 2.5)?;
        let width = |d: &Drawing| d.strokes.iter().map(|s| s.width).sum::<f64>() / d.strokes.len() as f64;
        let ratio = width(&large) / width(&small);
        ensure((ratio - 2.0).abs() < 0.2, || format!("widths grow by {ratio:.2}"))
    });
}

#[test]
fn tracing_the_trace_changes_nothing() {
    on_all("traced twice", [1.0, 0.583], |drawing| {
        let once = trace(&scan(drawing));
        let twice = trace(&scan_of(render(&once).map(|ink| 1.0 - ink)));
        same((once.strokes.len(), twice.strokes.len()), strokes_apart(&once, &twice), 0.15, 1.2)
    });
}

#[test]
fn the_trace_has_the_ink_of_the_picture() {
    on_all("ink", [0.8, 0.916], |drawing| {
        let before = render(drawing);
        let after = render(&trace(&scan(drawing)));
        let both = before.data().iter().zip(after.data());
        let (common, all) = both.fold((0.0f32, 0.0f32), |(c, a), (p, q)| (c + p.min(*q), a + p.max(*q)));
        let share = common / all;
        ensure(share > 0.9, || format!("intersection over union {share:.3}"))
    });
}

#[test]
fn white_on_black_is_black_on_white() {
    on_all("inverted", [1.0, 1.0], |drawing| {
        let plain = scan(drawing);
        let inverted = scan_of(plain.gray.map(|g| 1.0 - g));
        same_under(Affine::IDENTITY, &trace(&plain), &trace(&inverted))
    });
}

#[test]
fn fainter_ink_is_the_same_drawing() {
    on_all("faint ink", [1.0, 0.958], |drawing| {
        let plain = scan(drawing);
        let faint = scan_of(plain.gray.map(|g| 0.9 - 0.3 * (1.0 - g)));
        same_under(Affine::IDENTITY, &trace(&plain), &trace(&faint))
    });
}

#[test]
fn paper_and_pencil_keep_the_drawing() {
    on_all("pencil", [1.0, 0.875], |drawing| {
        let clean = scan(drawing);
        let pencil = trace(&scan_of(Paper::PENCIL.scan(&clean.gray, 5)));
        let apart = strokes_apart(drawing, &pencil);
        ensure(apart.mean < 0.6 && apart.max < 5.0, || format!("{apart:.3?}"))
    });
}

/// The bytes of a trace with so many threads.
fn bytes(vectorizer: &Vectorizer, scan: &Scan, threads: usize) -> String {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
    let drawing = pool.install(|| vectorizer.trace(scan)).expect("a trace");
    to_svg(&drawing, &WriteOptions::default().with(|o| o.precision = 8))
}

#[test]
fn the_bytes_are_the_same_on_any_number_of_threads() {
    let vectorizer = Vectorizer::new(Options::default()).expect("the defaults are in range");
    for Sample { name, drawing } in named().iter().chain(&tangled()[..4]) {
        let clean = scan(drawing);
        let pencil = scan_of(Paper::PENCIL.scan(&clean.gray, 9));
        for scan in [clean, pencil] {
            let one = bytes(&vectorizer, &scan, 1);
            for threads in [1, 2, 7] {
                assert!(one == bytes(&vectorizer, &scan, threads), "{name} differs on {threads} threads");
            }
        }
    }
}

#[test]
fn nothing_that_is_traced_is_out_of_bounds() {
    on_all("bounds", [1.0, 1.0], |drawing| {
        let result = trace(&scan(drawing));
        for stroke in &result.strokes {
            let bounds = kurbo::Shape::bounding_box(&stroke.centreline.to_path());
            let inside = bounds.x0 > 0.0 && bounds.y0 > 0.0 && bounds.x1 < 128.0 && bounds.y1 < 112.0;
            ensure(inside, || format!("{bounds:?}"))?;
            ensure(stroke.width.is_finite() && stroke.width > 0.0, || format!("{} wide", stroke.width))?;
        }
        Ok(())
    });
}
