//! Colour that is no ink's, and ink whose colour hardly shows: fringes, compression, blur, thin lines and printed squares.
//!
//! Floors below one are the shares that were measured, less a case.

mod common;

use common::compare::strokes_apart;
use common::draw::{
    arc, circle, color_scan, line, on_paper, polar, polyline, scan, scan_of, scan_of_rgb, sheet, trace,
};
use common::paper::Paper;
use common::sweep::{ensure, pairs, steps, sweep};
use fieldtrace::drawing::{Color, Drawing, Fill, Stroke};
use fieldtrace::load::Scan;
use fieldtrace::raster::Raster;
use image::codecs::jpeg::JpegEncoder;
use image::imageops::{FilterType, fast_blur, resize};
use image::{Rgb, RgbImage};
use kurbo::{Circle, Point, Rect, Shape, Vec2};
use std::collections::BTreeSet;

const CENTER: Point = Point::new(60.0, 60.0);
const WHITE: Color = Color([255; 3]);
const RED: Color = Color([210, 31, 43]);
const BLUE: Color = Color([31, 79, 210]);

/// What gives grey ink coloured edges.
#[derive(Clone, Copy, Debug)]
enum Fringe {
    /// Red and blue are seen this far to the left and to the right, and as far up and down times the second.
    Shifted(f64, f64),
    /// Red is, and neither of the others.
    OneShifted(f64),
    /// The sub-pixels of a screen, each over a pixel and two thirds.
    SubPixels,
    /// Red and blue are larger and smaller by so many pixels at the border.
    Lens(f64),
}

const FRINGES: [Fringe; 8] = [
    Fringe::Shifted(0.33, 0.0),
    Fringe::Shifted(0.5, 0.0),
    Fringe::Shifted(0.5, 1.0),
    Fringe::Shifted(0.8, 0.0),
    Fringe::OneShifted(0.5),
    Fringe::OneShifted(1.0),
    Fringe::SubPixels,
    Fringe::Lens(0.7),
];

/// How an image is stored.
#[derive(Clone, Copy, Debug)]
enum Stored {
    AsIs,
    /// As JPEG of a quality, chroma at half the size.
    Jpeg(u8),
    Blurred(f32),
}

/// A page of 120 pixels: lines at several angles, and figures as small as letters.
fn page(angle: f64, width: f64) -> Drawing {
    let at = |turn: f64, reach: f64| polar(CENTER, angle + turn, reach);
    let small = 4.0 * width;
    let letters = (0..3).flat_map(|k| {
        let top = Point::new(16.0 + (2.6 * small + 8.0) * f64::from(k), 100.0);
        [circle(top, 0.9 * small, width), arc(top + Vec2::new(0.0, -1.8 * small), 0.9 * small, 1.0, 4.2, width)]
    });
    let lines = [line(at(0.0, 50.0), at(180.0, 20.0), width), line(at(100.0, 40.0), at(260.0, 48.0), width)];
    sheet(120, 120, lines.into_iter().chain(letters).collect())
}

fn rgb(size: u32, at: impl Fn(usize, Point) -> f32) -> RgbImage {
    RgbImage::from_fn(size, size, |x, y| {
        let p = Point::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
        Rgb([0, 1, 2].map(|c| (255.0 * at(c, p).clamp(0.0, 1.0)).round() as u8))
    })
}

fn fringed(gray: &Raster<f32>, fringe: Fringe) -> RgbImage {
    let side = gray.width() as f64;
    let paper = |p: Point| gray.sample(Point::new(p.x.clamp(0.5, side - 0.5), p.y.clamp(0.5, side - 0.5)));
    rgb(side as u32, |channel, p| {
        let sign = channel as f64 - 1.0;
        match fringe {
            Fringe::Shifted(by, down) => paper(p + Vec2::new(by, by * down) * sign),
            Fringe::OneShifted(by) => paper(p + Vec2::new(by * f64::from(u8::from(channel == 0)), 0.0)),
            Fringe::SubPixels => {
                let tap = |k: i32| (3.0 - f64::from(k.abs())) / 9.0;
                let at = |k: i32| f64::from(paper(p + Vec2::new((sign + f64::from(k)) / 3.0, 0.0)));
                (-2..=2).map(|k| tap(k) * at(k)).sum::<f64>() as f32
            }
            Fringe::Lens(by) => paper(p + (p - CENTER) * (sign * by / (0.5 * side))),
        }
    })
}

fn stored(image: &RgbImage, how: Stored) -> RgbImage {
    let Stored::Jpeg(quality) = how else {
        return if let Stored::Blurred(sigma) = how { fast_blur(image, sigma) } else { image.clone() };
    };
    let (width, height) = image.dimensions();
    let coarse =
        resize(&resize(image, width / 2, height / 2, FilterType::Triangle), width, height, FilterType::Triangle);
    let luma = |p: &Rgb<u8>| 0.299 * f32::from(p[0]) + 0.587 * f32::from(p[1]) + 0.114 * f32::from(p[2]);
    let halved = RgbImage::from_fn(width, height, |x, y| {
        let (own, coarse) = (image.get_pixel(x, y), coarse.get_pixel(x, y));
        let lighter = luma(own) - luma(coarse);
        Rgb(coarse.0.map(|v| (f32::from(v) + lighter).round().clamp(0.0, 255.0) as u8))
    });
    let mut bytes = Vec::new();
    JpegEncoder::new_with_quality(&mut bytes, quality).encode_image(&halved).expect("a JPEG");
    image::load_from_memory(&bytes).expect("an image").to_rgb8()
}

fn colors(drawing: &Drawing) -> BTreeSet<Color> {
    drawing.strokes.iter().map(|stroke| stroke.color).collect()
}

/// Largest difference of a channel.
fn off(a: Color, b: Color) -> u8 {
    a.0.iter().zip(b.0).map(|(a, b)| a.abs_diff(b)).max().unwrap()
}

fn inked(stroke: Stroke, color: Color) -> Stroke {
    Stroke { color, ..stroke }
}

/// A scan in colour gives the strokes of the same scan in grey, of one pen.
fn like_its_twin(colored: &Scan) -> Result<(), String> {
    let grey = trace(&scan_of(colored.gray.clone()));
    let found = trace(colored);
    ensure(colors(&found).len() == 1, || format!("{:?}", colors(&found)))?;
    ensure(found.strokes.len() == grey.strokes.len(), || {
        format!("{} strokes for {}", found.strokes.len(), grey.strokes.len())
    })?;
    let apart = strokes_apart(&grey, &found);
    ensure(apart.max <= 0.5, || format!("{apart:.2?}"))
}

#[test]
fn a_fringe_is_no_pen() {
    let stores = [Stored::AsIs, Stored::Jpeg(30), Stored::Jpeg(60), Stored::Jpeg(95)];
    let cases = pairs(&pairs(&[10.0], &[1.5, 2.5, 4.0]), &pairs(&FRINGES, &stores));
    sweep("grey lines with fringes", 0.99, &cases, |&((angle, width), (fringe, how))| {
        let image = fringed(&scan(&page(angle, width)).gray, fringe);
        like_its_twin(&scan_of_rgb(stored(&image, how)))
    });
}

#[test]
fn chroma_noise_and_a_scanner_out_of_register_make_no_pen() {
    let cases = pairs(&pairs(&[0.0, 40.0], &[2.5, 4.0]), &[(0.0, 0.06), (0.5, 0.03), (0.8, 0.0)]);
    sweep("grey lines on a scan with fringes", 1.0, &cases, |&((angle, width), (shift, noise))| {
        let paper = on_paper(&page(angle, width), Paper::INK, 5).gray;
        let blank = |seed: u64| on_paper(&sheet(120, 120, Vec::new()), Paper::INK, seed).gray;
        let grains = [7, 8, 9].map(blank);
        let shifted = fringed(&paper, Fringe::Shifted(shift, 0.0));
        let noisy = rgb(120, |c, p| {
            let own = shifted.get_pixel(p.x as u32, p.y as u32)[c];
            f32::from(own) / 255.0
                + noise * 20.0 * (grains[c].sample(p) - grains[(c + 1) % 3].sample(p)).clamp(-0.1, 0.1)
        });
        like_its_twin(&scan_of_rgb(noisy))
    });
}

#[test]
fn markers_of_three_colours_are_three_pens() {
    let stores = [Stored::AsIs, Stored::Blurred(0.8), Stored::Jpeg(40), Stored::Jpeg(75), Stored::Jpeg(95)];
    let cases = pairs(&pairs(&steps(0.0, 60.0, 20.0), &[2.5, 4.0, 7.0]), &stores);
    sweep("markers", 1.0, &cases, |&((angle, width), how)| {
        let at = |turn: f64, reach: f64| polar(CENTER, angle + turn, reach);
        let strokes = vec![
            inked(line(at(0.0, 50.0), at(180.0, 50.0), width), RED),
            inked(circle(at(60.0, 14.0), 24.0, width), BLUE),
            inked(line(at(90.0, 50.0), at(250.0, 50.0), width), Color::BLACK),
        ];
        let image = color_scan(&sheet(120, 120, strokes), WHITE).rgb.unwrap();
        let found = colors(&trace(&scan_of_rgb(stored(&image, how))));
        ensure(found.len() == 3, || format!("{found:?}"))?;
        // Thin lines show less than their full ink once they are blurred.
        let allowed = if width < 4.0 { 100 } else { 45 };
        let near = |ink: Color| found.iter().any(|&color| off(color, ink) <= allowed);
        ensure(found.contains(&Color::BLACK) && near(RED) && near(BLUE), || format!("{found:?}"))
    });
}

#[test]
fn black_is_black_however_thin() {
    let cases = pairs(&steps(0.0, 80.0, 10.0), &[1.0, 1.5, 2.0, 3.0, 5.0, 9.0]);
    sweep("black lines", 1.0, &cases, |&(angle, width)| {
        let found = colors(&trace(&scan(&page(angle, width))));
        ensure(found == BTreeSet::from([Color::BLACK]), || format!("{found:?}"))
    });
}

#[test]
fn blurred_black_is_black() {
    let cases = pairs(&pairs(&[10.0, 50.0], &[2.5, 4.0, 7.0]), &[Stored::Blurred(0.6), Stored::Blurred(1.0)]);
    sweep("blurred black lines", 1.0, &cases, |&((angle, width), how)| {
        let image = color_scan(&page(angle, width), WHITE).rgb.unwrap();
        let found = colors(&trace(&scan_of_rgb(stored(&image, how))));
        ensure(found.len() == 1 && found.iter().all(|&color| off(color, Color::BLACK) <= 8), || format!("{found:?}"))
    });
}

#[test]
fn grey_ink_has_its_own_grey() {
    let cases = pairs(&pairs(&[0.0, 30.0], &[2.5, 4.0, 7.0]), &[0x60, 0x80, 0x90]);
    sweep("grey lines", 1.0, &cases, |&((angle, width), shade)| {
        let grey = Color([shade; 3]);
        let drawing = page(angle, width);
        let strokes = drawing.strokes.iter().cloned().map(|stroke| inked(stroke, grey));
        let found = trace(&color_scan(&sheet(120, 120, strokes.collect()), WHITE));
        ensure(found.strokes.len() == trace(&scan(&drawing)).strokes.len(), || format!("{:?}", found.strokes.len()))?;
        let found = colors(&found);
        ensure(found.len() == 1 && found.iter().all(|&color| off(color, grey) <= 3), || format!("{found:?}"))
    });
}

#[test]
fn black_and_grey_lines_are_two_pens() {
    let cases = pairs(&pairs(&steps(0.0, 60.0, 15.0), &[3.0, 4.0, 7.0]), &[0x70, 0x90]);
    sweep("black and grey", 1.0, &cases, |&((angle, width), shade)| {
        let at = |turn: f64, reach: f64| polar(CENTER, angle + turn, reach);
        let grey = Color([shade; 3]);
        let strokes = vec![
            inked(line(at(20.0, 50.0), at(100.0, 50.0), width), Color::BLACK),
            inked(line(at(200.0, 50.0), at(280.0, 50.0), width), grey),
        ];
        let found = colors(&trace(&color_scan(&sheet(120, 120, strokes), WHITE)));
        ensure(found.len() == 2 && found.contains(&Color::BLACK), || format!("{found:?}"))?;
        ensure(found.iter().any(|&color| off(color, grey) <= 3), || format!("{found:?}"))
    });
}

#[test]
fn pencil_is_one_black_pen() {
    let pencil = |darkness: f32| Paper { darkness, ..common::draw::SPECKLESS };
    let cases = pairs(&pairs(&[0.0, 35.0], &[2.5, 4.0]), &[0.45, 0.6, 0.75]);
    sweep("pencil", 1.0, &cases, |&((angle, width), darkness)| {
        let found = colors(&trace(&on_paper(&page(angle, width), pencil(darkness), 3)));
        ensure(found == BTreeSet::from([Color::BLACK]), || format!("{found:?}"))
    });
}

#[test]
fn shapes_keep_their_colours() {
    let shades = [[0x72, 0x9f, 0xcf], [0x90, 0x90, 0x90], [0xf0, 0xd0, 0x60], [0xc0, 0x40, 0x40], [0x30, 0x30, 0x30]];
    let cases = pairs(&shades.map(Color), &[30.0, 60.0, 90.0]);
    sweep("fills", 1.0, &cases, |&(color, side)| {
        let mut truth = sheet(240, 160, vec![polyline(&[(10.0, 8.0).into(), (230.0, 8.0).into()], false, 3.0)]);
        truth.fills.push(Fill { outline: Rect::new(20.0, 30.0, 20.0 + side, 30.0 + side).to_path(0.1), color });
        truth.fills.push(Fill { outline: Circle::new((170.0, 80.0), 0.5 * side).to_path(0.1), color });
        let found = trace(&color_scan(&truth, WHITE));
        let apart: Vec<Color> = found.fills.iter().map(|fill| fill.color).collect();
        ensure(apart.len() == 2 && apart.iter().all(|&found| off(found, color) <= 3), || format!("{apart:?}"))?;
        ensure(colors(&found) == BTreeSet::from([Color::BLACK]), || format!("{:?}", colors(&found)))
    });
}

#[test]
fn fine_and_broad_lines_of_one_pen_have_one_colour() {
    let stores = [Stored::AsIs, Stored::Blurred(0.8), Stored::Jpeg(80)];
    sweep(
        "one pen of two widths",
        1.0,
        &pairs(&pairs(&[2.0, 3.0, 4.0], &[0.0, 20.0]), &stores),
        |&((fine, turn), how)| {
            let at = |angle: f64, reach: f64| polar(Point::new(120.0, 120.0), turn + angle, reach);
            let mut strokes: Vec<Stroke> = (0..5)
                .map(|k| line(at(30.0 + 25.0 * f64::from(k), 110.0), at(30.0 + 25.0 * f64::from(k), 40.0), fine))
                .collect();
            strokes.push(line(at(200.0, 90.0), at(340.0, 90.0), 34.0));
            let strokes = strokes.into_iter().map(|stroke| inked(stroke, RED)).collect();
            let image = color_scan(&sheet(240, 240, strokes), WHITE).rgb.unwrap();
            let found = colors(&trace(&scan_of_rgb(stored(&image, how))));
            ensure(found.len() == 1 && found.iter().all(|&color| off(color, RED) <= 8), || format!("{found:?}"))
        },
    );
}

#[test]
fn light_and_dark_lines_of_one_pen_have_one_colour() {
    sweep("pressure", 1.0, &pairs(&[RED, BLUE], &[3.0, 5.0]), |&(ink, width)| {
        let strokes = (0..5).map(|k| {
            let y = 16.0 + 22.0 * f64::from(k);
            let press = 1.0 - 0.08 * f64::from(k);
            let lighter = Color(ink.0.map(|v| (255.0 - press * f64::from(255 - v)) as u8));
            inked(line((12.0, y), (108.0, y + 8.0), width), lighter)
        });
        let found = colors(&trace(&color_scan(&sheet(120, 120, strokes.collect()), WHITE)));
        ensure(found.len() == 1, || format!("{found:?}"))
    });
}

#[test]
fn pale_printed_squares_are_paper() {
    let prints = [[190u8, 215, 240], [245, 205, 205]];
    sweep("squared paper", 1.0, &pairs(&pairs(&[0.0, 30.0], &[2.5, 4.0]), &prints), |&((angle, width), print)| {
        let gray = scan(&page(angle, width)).gray;
        let image = RgbImage::from_fn(120, 120, |x, y| {
            let paper = if x % 14 == 7 || y % 14 == 7 { print } else { [255; 3] };
            let light = gray[(x as usize, y as usize)];
            Rgb(paper.map(|v| (f32::from(v) * light).round() as u8))
        });
        like_its_twin(&scan_of_rgb(image))
    });
}
