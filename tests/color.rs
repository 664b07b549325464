//! Drawings in several colours.

mod common;

use common::compare::strokes_apart;
use common::draw::{circle, color_scan, line, polar, polyline, scan, scan_of_rgb, sheet, trace, trace_under};
use common::paper::Paper;
use common::sweep::{ensure, pairs, steps, sweep};
use fieldtrace::drawing::{Color, Drawing, Fill, Stroke};
use fieldtrace::load::Scan;
use fieldtrace::options::{Ink, Options};
use fieldtrace::raster::Raster;
use fieldtrace::write::{WriteOptions, to_svg};
use image::{Rgb, RgbImage};
use kurbo::{Circle, Point, Shape};

const CENTER: Point = Point::new(48.0, 48.0);
const WHITE: Color = Color([255; 3]);
const RED: Color = Color([220, 20, 30]);
const BLUE: Color = Color([30, 60, 210]);
const YELLOW: Color = Color([255, 235, 0]);
const PALE_BLUE: Color = Color([165, 195, 255]);
const GREEN: Color = Color([20, 140, 60]);
const INKS: [Color; 6] = [Color::BLACK, RED, BLUE, YELLOW, PALE_BLUE, GREEN];

fn inked(stroke: Stroke, color: Color) -> Stroke {
    Stroke { color, ..stroke }
}

/// All ordered pairs of inks but those of one hue and two strengths, which stain one another.
fn pairs_of_inks() -> Vec<(Color, Color)> {
    let blues = [BLUE, PALE_BLUE];
    let apart = |(a, b): &(Color, Color)| a != b && !(blues.contains(a) && blues.contains(b));
    pairs(&INKS, &INKS).into_iter().filter(apart).collect()
}

/// Largest difference of a channel.
fn off(a: Color, b: Color) -> u8 {
    a.0.iter().zip(b.0).map(|(a, b)| a.abs_diff(b)).max().unwrap()
}

/// As many strokes as were drawn in each colour, each where it was drawn.
fn like(truth: &Drawing, result: &Drawing, color: u8, max: f64) -> Result<(), String> {
    let found: Vec<Color> = result.strokes.iter().map(|s| s.color).collect();
    ensure(found.len() == truth.strokes.len(), || format!("{found:?}"))?;
    for stroke in &truth.strokes {
        let own = |d: &Drawing| {
            let strokes = d.strokes.iter().filter(|s| off(s.color, stroke.color) <= color).cloned();
            sheet(96, 96, strokes.collect())
        };
        let apart = strokes_apart(&own(truth), &own(result));
        ensure(apart.max <= max, || format!("{:?}: {apart:.2?} among {found:?}", stroke.color))?;
    }
    Ok(())
}

/// The colours on paper under a lamp, with grain.
fn on_paper(scan: &Scan, paper: Paper, seed: u64) -> Scan {
    let rgb = scan.rgb.as_ref().unwrap();
    let (width, height) = scan.gray.size();
    let channels = [0, 1, 2].map(|c| {
        let light = Raster::from_fn(width, height, |x, y| f32::from(rgb.get_pixel(x as u32, y as u32)[c]) / 255.0);
        // The same paper under every channel, its grain a little coloured.
        let (own, shared) = (paper.scan(&light, seed + c as u64), paper.scan(&light, seed));
        Raster::from_fn(width, height, |x, y| 0.3 * own[(x, y)] + 0.7 * shared[(x, y)])
    });
    let byte = |v: f32| (255.0 * v.clamp(0.0, 1.0)).round() as u8;
    scan_of_rgb(RgbImage::from_fn(width as u32, height as u32, |x, y| {
        Rgb([0, 1, 2].map(|c| byte(channels[c][(x as usize, y as usize)])))
    }))
}

#[test]
fn crossing_lines_keep_their_colours() {
    let angles = steps(0.0, 150.0, 30.0);
    let cases = pairs(&pairs(&pairs_of_inks(), &angles), &[(2.0, 60.0), (4.0, 90.0)]);
    sweep("crossings of two colours", 0.889, &cases, |&(((a, b), angle), (width, between))| {
        let across = |turn: f64| line(polar(CENTER, angle + turn, 40.0), polar(CENTER, angle + turn, -40.0), width);
        let truth = sheet(96, 96, vec![inked(across(0.0), a), inked(across(between), b)]);
        like(&truth, &trace(&color_scan(&truth, WHITE)), 12, 0.8)
    });
}

#[test]
fn a_stroke_ends_where_its_colour_does() {
    let turns = [0.0, 20.0, 90.0];
    sweep(
        "lines that go on in another colour",
        0.928,
        &pairs(&pairs(&pairs_of_inks(), &turns), &[2.0, 4.0]),
        |&(((a, b), turn), width)| {
            let (start, end) = (polar(CENTER, 190.0, 40.0), polar(CENTER, 10.0 + turn, 40.0));
            let truth = sheet(96, 96, vec![inked(line(start, CENTER, width), a), inked(line(CENTER, end, width), b)]);
            like(&truth, &trace(&color_scan(&truth, WHITE)), 12, 0.8 * width)
        },
    );
}

#[test]
fn colours_are_found_on_paper() {
    let cases = pairs(&pairs(&INKS, &[Paper::INK, Paper::PENCIL].map(|p| (p.darkness, p))), &[2.5, 4.0]);
    sweep("colours on paper", 0.916, &cases, |&((ink, (_, paper)), width)| {
        let strokes = vec![
            inked(line((12.0, 20.0), (84.0, 30.0), width), ink),
            inked(circle((40.0, 62.0), 20.0, width), if ink == RED { BLUE } else { RED }),
        ];
        let truth = sheet(96, 96, strokes);
        // A pale blue line beside a red one may pass for ruling: here it is a pen.
        let options = Options::default().with(|o| o.ink = Ink::Threshold);
        let result = trace_under(options, &on_paper(&color_scan(&truth, WHITE), paper, 7));
        let mut colors: Vec<Color> = result.strokes.iter().map(|s| s.color).collect();
        ensure(strokes_apart(&truth, &result).max < 1.5, || format!("{:.2?}", strokes_apart(&truth, &result)))?;
        colors.dedup();
        ensure(colors.len() == 2, || format!("{colors:?}"))?;
        ensure((ink == Color::BLACK) == colors.contains(&Color::BLACK), || format!("{colors:?}"))
    });
}

#[test]
fn edges_make_no_colours_and_layers_are_few() {
    sweep("layers", 1.0, &pairs(&steps(0.0, 165.0, 15.0), &[2.0, 3.0, 5.0]), |&(angle, width)| {
        let spokes = INKS.iter().enumerate().map(|(i, &ink)| {
            let at = |reach: f64| polar(CENTER, angle + 60.0 * i as f64, reach);
            inked(line(at(14.0), at(42.0), width), ink)
        });
        let truth = sheet(96, 96, spokes.collect());
        let result = trace(&color_scan(&truth, WHITE));
        let svg = to_svg(&result, &WriteOptions::default());
        let layers = svg.matches("inkscape:groupmode=\"layer\"").count();
        ensure(layers == INKS.len(), || {
            format!("{layers} layers of {:?}", result.strokes.iter().map(|s| s.color).collect::<Vec<_>>())
        })
    });
}

#[test]
fn light_lines_on_a_dark_ground_keep_their_colours() {
    let ground = Color([10, 12, 10]);
    sweep("dark ground", 1.0, &[RED, BLUE, YELLOW, GREEN], |&ink| {
        let strokes = vec![
            inked(line((12.0, 16.0), (84.0, 30.0), 4.0), ink),
            inked(line((12.0, 50.0), (84.0, 80.0), 4.0), WHITE),
        ];
        let result = trace(&color_scan(&sheet(96, 96, strokes), ground));
        let colors: Vec<Color> = result.strokes.iter().map(|s| s.color).collect();
        // White chalk is grey at its darkest, as on white paper.
        let black = colors.iter().filter(|&&c| c == Color::BLACK).count();
        ensure(colors.len() == 2 && black == 1, || format!("{colors:?}"))?;
        ensure(colors.iter().any(|&c| off(c, ink) < 30), || format!("{colors:?} for {ink:?}"))
    });
}

#[test]
fn regions_and_dots_have_their_colours() {
    let mut truth = sheet(96, 96, vec![inked(polyline(&[(10.0, 10.0).into(), (86.0, 10.0).into()], false, 3.0), BLUE)]);
    truth.fills.push(Fill { outline: Circle::new((40.0, 55.0), 22.0).to_path(1e-3), color: YELLOW });
    truth.fills.push(Fill { outline: Circle::new((80.0, 80.0), 2.5).to_path(1e-3), color: RED });
    let lines: Vec<Stroke> = (0..4)
        .map(|i| inked(line((70.0, 30.0 + 8.0 * f64::from(i)), (90.0, 30.0 + 8.0 * f64::from(i)), 3.0), RED))
        .collect();
    truth.strokes.extend(lines);
    let result = trace(&color_scan(&truth, WHITE));
    assert_eq!((result.fills.len(), result.strokes.len()), (1, 6));
    assert!(off(result.fills[0].color, YELLOW) < 12, "{:?}", result.fills[0].color);
    assert_eq!(result.strokes.iter().filter(|s| off(s.color, RED) < 12).count(), 5);
}

#[test]
fn a_grey_drawing_stays_as_it_is_when_stored_in_colour() {
    sweep("grey in colour", 1.0, &pairs(&steps(0.0, 80.0, 20.0), &[0u8, 9, 20]), |&(angle, tint)| {
        let at = |turn: f64| polar(CENTER, angle + turn, 40.0);
        let grey = scan(&sheet(96, 96, vec![line(at(0.0), at(180.0), 3.0), line(at(60.0), at(200.0), 3.0)]));
        let byte = |x: u32, y: u32| (255.0 * grey.gray[(x as usize, y as usize)]).round() as u8;
        let tinted = RgbImage::from_fn(96, 96, |x, y| {
            let v = byte(x, y);
            Rgb([v, v, v - (f32::from(tint) * f32::from(v) / 255.0) as u8])
        });
        let (plain, colored) = (trace(&grey), trace(&Scan { gray: grey.gray, rgb: Some(tinted), dpi: None }));
        ensure(plain == colored, || "the drawing changed".into())
    });
}
