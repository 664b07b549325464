//! The same drawing under every kind of paper and every way into the machine gives the same strokes.

mod common;

use common::draw::{arc, circle, cubic, line, on_paper, polyline, rendered, scan, scan_of, scan_of_rgb, sheet, trace};
use common::figures::{figures_on, same_strokes};
use common::paper::Paper;
use common::sweep::{ensure, pairs, sweep};
use fieldtrace::drawing::Drawing;
use fieldtrace::load::Scan;
use fieldtrace::raster::Raster;
use image::codecs::jpeg::JpegEncoder;
use image::{DynamicImage, GrayImage, ImageFormat, Luma, Rgb, RgbImage};
use kurbo::Point;

const SIDE: usize = 160;

/// The drawings, a stroke each way that lines meet: crossings, tees, corners, arcs and lone lines.
#[derive(Clone, Copy, Debug)]
enum Figure {
    Window,
    Target,
    Kite,
    Waves,
}

const FIGURES: [Figure; 4] = [Figure::Window, Figure::Target, Figure::Kite, Figure::Waves];

fn drawn(figure: Figure, pen: f64) -> Drawing {
    let p = Point::new;
    let frame = [p(30.4, 25.2), p(131.0, 31.7), p(124.6, 133.1), p(24.9, 127.4)];
    let strokes = match figure {
        Figure::Window => vec![
            polyline(&frame, true, pen),
            line(frame[0].midpoint(frame[1]), frame[2].midpoint(frame[3]), pen),
            line(frame[1].midpoint(frame[2]), frame[3].midpoint(frame[0]), pen),
        ],
        Figure::Target => vec![
            circle((80.3, 79.6), 38.0, pen),
            line((30.2, 72.4), (140.7, 88.3), pen),
            arc((80.3, 79.6), 62.0, 2.2, 1.6, pen),
        ],
        Figure::Kite => vec![
            polyline(&[p(80.2, 15.3), p(121.5, 60.8), p(79.4, 141.2), p(41.7, 58.9)], true, pen),
            line((12.1, 20.4), (33.0, 38.2), pen),
            line((131.4, 98.0), (146.2, 140.3), pen),
        ],
        Figure::Waves => vec![
            cubic([(14.0, 40.0), (60.0, -20.0), (100.0, 100.0), (146.0, 38.0)], pen),
            cubic([(14.0, 90.0), (70.0, 40.0), (90.0, 150.0), (146.0, 84.0)], pen),
            line((22.3, 132.0), (138.0, 126.4), pen),
        ],
    };
    sheet(SIDE, SIDE, strokes)
}

/// A way from the drawing into the machine.
#[derive(Clone, Copy, Debug)]
enum Way {
    /// A scan in shades of grey.
    Scan,
    /// Its paper clipped to white, as text modes of scanners do: what is lighter than this share of the paper.
    White(f32),
    /// Contrast turned up: paper to white and pencil to black.
    Gain(f32),
    /// Paper of a colour.
    Tinted([f32; 3]),
    /// White paper, then JPEG of a quality.
    Jpeg(u8),
}

const WAYS: [Way; 9] = [
    Way::Scan,
    Way::White(0.92),
    Way::White(0.85),
    Way::Gain(1.4),
    Way::Tinted([0.96, 0.9, 0.75]),
    Way::Tinted([0.7, 0.82, 0.95]),
    Way::Jpeg(90),
    Way::Jpeg(60),
    Way::Jpeg(30),
];

fn seen(way: Way, gray: Raster<f32>) -> Scan {
    let white = |level: f32| gray.map(|g| (g / level).min(1.0));
    match way {
        Way::Scan => scan_of(gray),
        Way::White(level) => scan_of(white(level)),
        Way::Gain(gain) => scan_of(gray.map(|g| (1.0 - gain * (0.92 - g)).clamp(0.0, 1.0))),
        Way::Tinted(paper) => {
            let channel = |g: f32, c: usize| (255.0 * g * paper[c]).round() as u8;
            scan_of_rgb(RgbImage::from_fn(SIDE as u32, SIDE as u32, |x, y| {
                let g = gray[(x as usize, y as usize)];
                Rgb([0, 1, 2].map(|c| channel(g, c)))
            }))
        }
        Way::Jpeg(quality) => scan_of(through_jpeg(&white(0.92), quality)),
    }
}

fn through_jpeg(gray: &Raster<f32>, quality: u8) -> Raster<f32> {
    let bytes = GrayImage::from_fn(gray.width() as u32, gray.height() as u32, |x, y| {
        Luma([(255.0 * gray[(x as usize, y as usize)]).round() as u8])
    });
    let mut file = Vec::new();
    bytes.write_with_encoder(JpegEncoder::new_with_quality(&mut file, quality)).unwrap();
    let read = image::load_from_memory_with_format(&file, ImageFormat::Jpeg).unwrap().into_luma8();
    Raster::from_fn(gray.width(), gray.height(), |x, y| f32::from(read.get_pixel(x as u32, y as u32)[0]) / 255.0)
}

#[test]
fn the_paper_does_not_change_the_strokes() {
    for (name, paper, floor) in [("pencil", Paper::PENCIL, 1.0), ("ink", Paper::INK, 0.944)] {
        let paper = Paper { shade: 0.06, specks: 0.0, ..paper };
        let cases = pairs(&pairs(&FIGURES, &[3.0, 4.0]), &WAYS);
        figures_on(
            &format!("{name} under every paper"),
            floor,
            &cases,
            |&((figure, pen), _)| drawn(figure, pen),
            |&((figure, pen), way), truth| {
                let seed = 10 * figure as u64 + pen as u64;
                seen(way, on_paper(truth, paper, seed).gray)
            },
            |_, truth, traced| same_strokes(truth, traced, 2.0),
        );
    }
}

#[test]
fn a_colour_image_of_grey_ink_is_its_grey_twin() {
    sweep("grey twins", 1.0, &pairs(&FIGURES, &[true, false]), |&(figure, clean)| {
        let truth = drawn(figure, 3.0);
        let gray = if clean { scan(&truth) } else { on_paper(&truth, Paper::PENCIL, 7) }.gray;
        let bytes = GrayImage::from_fn(SIDE as u32, SIDE as u32, |x, y| {
            Luma([(255.0 * gray[(x as usize, y as usize)]).round() as u8])
        });
        let (gray, color) = (DynamicImage::ImageLuma8(bytes.clone()), DynamicImage::ImageLuma8(bytes).into_rgb8());
        let gray = gray.into_luma8();
        let gray =
            scan_of(Raster::from_fn(SIDE, SIDE, |x, y| f32::from(gray.get_pixel(x as u32, y as u32)[0]) / 255.0));
        let color = Scan { gray: gray.gray.clone(), rgb: Some(color), dpi: None };
        ensure(trace(&gray) == trace(&color), || "they differ".into())
    });
}

/// Clean renders stay exact, whatever lies elsewhere on the page: what is sure is told place by place.
#[test]
fn sure_lines_stay_sure_beside_a_pencil_drawing() {
    sweep("renders beside pencil", 1.0, &pairs(&FIGURES, &FIGURES), |&(left, right)| {
        let (clean, pencil) = (drawn(left, 3.0), drawn(right, 3.0));
        let alone = trace(&scan(&clean));
        let pencil = seen(Way::White(0.9), on_paper(&pencil, Paper { shade: 0.0, ..Paper::PENCIL }, 3).gray);
        let clean = scan(&clean).gray;
        let gap = 100;
        let width = 2 * SIDE + gap;
        let page = Raster::from_fn(width, SIDE, |x, y| match x {
            x if x < SIDE => clean[(x, y)],
            x if x < SIDE + gap => 1.0,
            x => pencil.gray[(x - SIDE - gap, y)],
        });
        let mut traced = trace(&scan_of(page));
        traced.strokes.retain(|stroke| stroke.centreline.start().x < SIDE as f64);
        (traced.width, traced.height) = (alone.width, alone.height);
        same_strokes(&alone, &traced, 0.15)
    });
}

#[test]
fn two_levels_are_enough_at_the_resolutions_of_scanners() {
    // A pen of .4 mm.
    let cases = pairs(&FIGURES, &[200.0, 300.0, 400.0, 600.0]);
    figures_on(
        "two levels",
        1.0,
        &cases,
        |&(figure, dpi)| {
            let scale = dpi / 200.0;
            let drawing = drawn(figure, 0.4 / 25.4 * 200.0).scaled(scale);
            Drawing { width: SIDE as f64 * scale, height: SIDE as f64 * scale, ..drawing }
        },
        |_, truth| scan_of(rendered(truth).gray.map(|g| if g > 0.5 { 1.0 } else { 0.0 })),
        |_, truth, traced| same_strokes(truth, traced, 1.5),
    );
}
