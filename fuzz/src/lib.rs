//! What the fuzz targets do with their bytes, and what must hold of the results.
//!
//! `tests/fuzz_corpus.rs` includes this file and replays the corpora, so everything here works on stable Rust.

use fieldtrace::clean::LineImage;
use fieldtrace::drawing::{Centreline, Color, Drawing};
use fieldtrace::field::{PolyVectorField, encode};
use fieldtrace::hooks::Observer;
use fieldtrace::load::{LoadOptions, Scan, load_bytes};
use fieldtrace::options::{Dashing, Ink, Invert, Options, StrokeWidth, Threshold};
use fieldtrace::pipeline::Vectorizer;
use fieldtrace::raster::Raster;
use fieldtrace::write::graph_json::{from_json, to_json};
use fieldtrace::write::{WriteOptions, to_svg};
use kurbo::{Shape, Vec2};
use num_complex::Complex32;

/// Most pixels of an input file.
const MAX_PIXELS: u64 = 1 << 18;
/// Longest side of a raster that is traced.
const LONGEST: u8 = 64;

/// The reader of raster files.
pub fn image(bytes: &[u8]) {
    read(bytes);
}

/// The reader of SVGs: what does not begin like one is made to.
pub fn svg(bytes: &[u8]) {
    if bytes.starts_with(b"<") || bytes.starts_with(b"\x1F\x8B") {
        read(bytes);
    } else {
        read(&[b"<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 40 40'>", bytes, b"</svg>"].concat());
    }
}

fn read(bytes: &[u8]) {
    let options = LoadOptions::default().with(|o| o.max_pixels = MAX_PIXELS);
    let Ok(input) = load_bytes("fuzz", bytes, &options) else { return };
    let (width, height) = input.scan.gray.size();
    assert!(width > 0 && height > 0 && (width * height) as u64 <= MAX_PIXELS);
    assert!(input.scan.gray.data().iter().all(|v| (0.0..=1.0).contains(v)));
    assert!(input.scan.rgb.is_none_or(|rgb| (rgb.width() as usize, rgb.height() as usize) == (width, height)));
    assert!(input.scan.dpi.is_none_or(|dpi| dpi.is_finite() && dpi > 0.0));
    if let Some(drawing) = input.drawing {
        to_svg(&drawing, &WriteOptions::default());
    }
}

/// The reader of stroke graphs, and the fit of what it reads.
pub fn graph(bytes: &[u8]) {
    let Ok(graph) = from_json("fuzz", bytes) else { return };
    from_json("again", to_json(&graph).as_bytes()).expect("what is written can be read");
    let drawing = vectorizer(Options::default()).draw(&graph, &mut ()).expect("a graph that was read can be drawn");
    assert_finite(&drawing);
}

/// The whole way from a small raster, grey or in colour.
pub fn pipeline(bytes: &[u8]) {
    let mut bytes = Bytes(bytes);
    let (width, height) = (bytes.side(), bytes.side());
    let options = bytes.options();
    let scan = if bytes.next().is_multiple_of(2) { bytes.gray(width, height) } else { bytes.color(width, height) };
    let drawing = vectorizer(options).trace(&scan).expect("a trace");
    assert_sane(&drawing, &scan);
}

/// Decoding, streamlines, graph and fit under any field and any mask.
pub fn field(bytes: &[u8]) {
    let mut bytes = Bytes(bytes);
    let (width, height) = (bytes.side(), bytes.side());
    let options = bytes.options();
    let keep_mask = bytes.next().is_multiple_of(2);
    let pixels: Vec<[u8; 3]> = (0..width * height).map(|_| [bytes.next(), bytes.next(), bytes.next()]).collect();
    let pixels = Raster::from_vec(width, height, pixels).expect("one sample a pixel");
    let scan = Scan { gray: pixels.map(|[ink, ..]| f32::from(ink) / 255.0), rgb: None, dpi: None };
    let part = |i: usize| pixels.map(|[_, a, b]| coefficients(a, b)[i]);
    let confidence = pixels.map(|[_, a, b]| f32::from(a ^ b) / 128.0);
    let field = PolyVectorField::new(part(0), part(1), confidence).expect("grids of one size");
    let mut mask = OwnMask((!keep_mask).then_some(&pixels));
    let drawing = vectorizer(options).trace_with_field(&scan, &field, &mut mask).expect("a trace");
    assert_sane(&drawing, &scan);
}

/// Two directions in steps of 1/256 of a half turn, or values that are no field's.
fn coefficients(a: u8, b: u8) -> [Complex32; 2] {
    let odd = |value: f32| [Complex32::new(value, 0.0), Complex32::new(0.0, value)];
    let direction = |byte: u8| Vec2::from_angle(f64::from(byte) * std::f64::consts::PI / 256.0);
    match (a, b) {
        (0, 1) => odd(f32::NAN),
        (0, 2) => odd(f32::INFINITY),
        (0, 3) => odd(f32::MAX),
        (0, 4) => odd(1e-30),
        (0, 5) => odd(0.0),
        _ => encode(direction(a), direction(b)).into(),
    }
}

/// Puts a mask of one's own in place of that of the ink.
struct OwnMask<'a>(Option<&'a Raster<[u8; 3]>>);

impl Observer for OwnMask<'_> {
    fn on_line_image(&mut self, image: &mut LineImage) -> fieldtrace::Result<()> {
        let Some(pixels) = self.0 else { return Ok(()) };
        let (width, height) = image.mask.size();
        image.mask = Raster::from_fn(width, height, |x, y| {
            pixels[(x * pixels.width() / width, y * pixels.height() / height)][0].is_multiple_of(2)
        });
        Ok(())
    }
}

/// What bytes mean; where they run out there is paper.
struct Bytes<'a>(&'a [u8]);

impl Bytes<'_> {
    fn next(&mut self) -> u8 {
        let Some((&first, rest)) = self.0.split_first() else { return 255 };
        self.0 = rest;
        first
    }

    fn side(&mut self) -> usize {
        usize::from(self.next() % LONGEST) + 1
    }

    fn options(&mut self) -> Options {
        let (how, what) = (self.next(), self.next());
        Options::default().with(|o| {
            o.detail = if how & 1 == 0 { 0.1 } else { 0.01 + f64::from(what) / 129.0 };
            o.min_length = if how & 2 == 0 { 0.5 } else { f64::from(what) / 32.0 };
            o.despeckle = (how & 4 != 0).then_some(what.into());
            o.ink = if what & 1 == 0 { Ink::Auto } else { Ink::Threshold };
            o.threshold =
                if how & 8 == 0 { Threshold::Auto } else { Threshold::Fixed((0.5 + f64::from(what)) / 256.0) };
            o.invert = if how & 16 == 0 { Invert::Auto } else { Invert::No };
            o.width = match how >> 5 & 3 {
                0 => StrokeWidth::Measured,
                1 => StrokeWidth::Uniform,
                2 => StrokeWidth::Fixed(2.0),
                _ => StrokeWidth::Outline,
            };
            o.gap = (how & 128 != 0).then_some(f64::from(what) / 16.0);
            o.dashes = if how & 128 == 0 { Dashing::Keep } else { Dashing::Join };
            o.ignore = if what & 2 == 0 { Vec::new() } else { vec![Color([255, 0, 0])] };
        })
    }

    fn gray(&mut self, width: usize, height: usize) -> Scan {
        Scan { gray: Raster::from_fn(width, height, |_, _| f32::from(self.next()) / 255.0), rgb: None, dpi: None }
    }

    fn color(&mut self, width: usize, height: usize) -> Scan {
        let pixels = (0..width * height * 3).map(|_| self.next()).collect();
        let rgb = image::RgbImage::from_raw(width as u32, height as u32, pixels).expect("three samples a pixel");
        let mean = |x: usize, y: usize| rgb.get_pixel(x as u32, y as u32).0.iter().map(|&v| f32::from(v)).sum::<f32>();
        Scan { gray: Raster::from_fn(width, height, |x, y| mean(x, y) / 765.0), rgb: Some(rgb), dpi: None }
    }
}

fn vectorizer(options: Options) -> Vectorizer {
    Vectorizer::new(options).expect("options in their ranges")
}

/// A trace is finite, near the page, and no longer than its ink allows.
pub fn assert_sane(drawing: &Drawing, scan: &Scan) {
    assert_finite(drawing);
    let (width, height) = scan.gray.size();
    assert_eq!((drawing.width, drawing.height), (width as f64, height as f64));
    let page = kurbo::Rect::new(0.0, 0.0, drawing.width, drawing.height).inflate(8.0, 8.0);
    let mut length = 0.0;
    for stroke in &drawing.strokes {
        let path = stroke.centreline.to_path();
        let bounds = path.bounding_box();
        assert!(page.union(bounds) == page, "{:?} leaves the page", stroke.centreline);
        length += path.perimeter(0.1);
    }
    // Every pixel may be covered in two directions.
    assert!(length <= 4.0 * drawing.width * drawing.height + 16.0, "{length} pixels of line");
}

fn assert_finite(drawing: &Drawing) {
    for stroke in &drawing.strokes {
        assert!(stroke.width.is_finite() && stroke.width > 0.0, "a width of {}", stroke.width);
        assert!(stroke.centreline.to_path().is_finite(), "{:?}", stroke.centreline);
        if let Centreline::Path { segments, closed } = &stroke.centreline {
            assert!(segments.windows(2).all(|s| s[0].end().distance(s[1].start()) < 1e-6), "{segments:?}");
            let ends = segments[0].start().distance(segments[segments.len() - 1].end());
            assert!(!closed || ends < 1e-6, "not closed: {segments:?}");
        }
    }
    assert!(drawing.fills.iter().all(|fill| fill.outline.is_finite()));
    let svg = to_svg(drawing, &WriteOptions::default());
    assert!(svg.ends_with("</svg>\n") && !svg.contains("NaN") && !svg.contains("inf"));
}

/// A panic of our own code ends the process even where it would be caught; those of decoders are errors by design.
pub fn abort_on_own_panics() {
    let abort = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |info| {
        if !info.location().is_some_and(|place| place.file().contains("/registry/")) {
            abort(info);
        }
    }));
}
