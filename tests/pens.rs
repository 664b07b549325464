//! Pens from one to 24 pixels, alone and together: ends, widths and meetings.
//!
//! Floors below one are the shares that were measured, less one case, for the network's last digits depend on the
//! processor: `cargo test --test pens -- --nocapture` prints what fails. Each sweep leaves a sheet in `tmp/sheets` of
//! Cargo's target directory, with what was drawn beside what was traced.

mod common;

use common::compare::ends_apart;
use common::draw::{arc, line, on_paper, polar, polyline, rendered, sheet};
use common::figures::{figures, figures_on, like_stroke, same_strokes, straight};
use common::paper::Paper;
use common::sweep::{ensure, pairs, steps};
use fieldtrace::drawing::{Drawing, Stroke};
use kurbo::Point;

const CENTER: Point = Point::new(100.0, 100.0);
const PENS: [f64; 10] = [1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0, 24.0];

/// Strokes on 200 x 200 pixels.
fn page(strokes: Vec<Stroke>) -> Drawing {
    sheet(200, 200, strokes)
}

/// Every drawn stroke's width is found.
fn same_widths(truth: &Drawing, traced: &Drawing, tolerance: f64) -> Result<(), String> {
    for stroke in &truth.strokes {
        let found = like_stroke(stroke, traced, f64::INFINITY)?.width;
        let allowed = 0.35f64.max(0.06 * stroke.width);
        ensure((found - stroke.width).abs() <= allowed.max(tolerance), || {
            format!("{found:.2} wide for {}", stroke.width)
        })?;
    }
    Ok(())
}

#[test]
fn a_line_ends_within_half_a_pixel_at_every_width() {
    let cases = pairs(&steps(0.0, 170.0, 10.0), &PENS);
    figures(
        "ends of lines of every width",
        0.988,
        &cases,
        |&(angle, width)| {
            let center = CENTER + kurbo::Vec2::new(0.3, 0.7);
            page(vec![line(polar(center, angle, -70.0), polar(center, angle, 70.0), width)])
        },
        |_, truth, traced| {
            ensure(traced.strokes.len() == 1, || format!("{} strokes", traced.strokes.len()))?;
            let stroke = &truth.strokes[0].centreline;
            let off = ends_apart(traced, &[stroke.start(), stroke.end()]);
            ensure(off <= 0.5, || format!("an end is off by {off:.2}"))?;
            same_widths(truth, traced, 0.0)?;
            straight(traced, 0.35)
        },
    );
}

/// Renderers draw a line of one pixel as one of its own: without caps, as much ink in each row or column, whichever it
/// crosses faster, and so thinner the nearer to a diagonal.
#[test]
fn a_renderers_hairline_is_one_line_to_its_ends() {
    let cases = pairs(&steps(0.0, 175.0, 5.0), &[(0.0, 0.0), (0.3, 0.7), (0.5, 0.5)]);
    figures_on(
        "hairlines of a renderer",
        0.99,
        &cases,
        |&(angle, offset)| {
            let center = CENTER + kurbo::Vec2::from(offset);
            page(vec![line(polar(center, angle, -70.0), polar(center, angle, 70.0), 1.0)])
        },
        |_, drawing| rendered(drawing),
        |_, truth, traced| {
            ensure(traced.strokes.len() == 1, || format!("{} strokes", traced.strokes.len()))?;
            let stroke = &truth.strokes[0].centreline;
            let off = ends_apart(traced, &[stroke.start(), stroke.end()]);
            ensure(off <= 0.75, || format!("an end is off by {off:.2}"))?;
            straight(traced, 0.35)
        },
    );
}

#[test]
fn an_arc_ends_within_half_a_pixel_at_every_width() {
    let cases = pairs(&steps(60.0, 300.0, 60.0), &PENS);
    figures(
        "ends of arcs of every width",
        0.98,
        &cases,
        |&(sweep, width)| page(vec![arc(CENTER, 64.0, 0.3, sweep.to_radians(), width)]),
        |_, truth, traced| {
            same_strokes(truth, traced, 0.5)?;
            let stroke = &truth.strokes[0].centreline;
            let off = ends_apart(traced, &[stroke.start(), stroke.end()]);
            ensure(off <= 0.5, || format!("an end is off by {off:.2}"))?;
            same_widths(truth, traced, 0.0)
        },
    );
}

#[test]
fn a_corner_is_sharp_at_every_width() {
    let cases = pairs(&pairs(&[45.0, 90.0, 135.0], &PENS), &[0.0, 25.0]);
    figures(
        "corners of every width",
        0.966,
        &cases,
        |&((opening, width), turn)| {
            let tip = polar(CENTER, turn, -40.0);
            let arm = |side: f64| polar(tip, turn + side * 0.5 * opening, 100.0);
            page(vec![polyline(&[arm(-1.0), tip, arm(1.0)], false, width)])
        },
        |&((_, width), _), truth, traced| same_strokes(truth, traced, 0.1 * width + 0.5),
    );
}

/// Pairs of different pens, the first the wider.
fn two_pens() -> Vec<(f64, f64)> {
    let pens = [1.0, 1.5, 2.0, 4.0, 8.0, 16.0, 24.0];
    pairs(&pens, &pens).into_iter().filter(|(a, b)| a > b).collect()
}

#[test]
fn lines_of_two_widths_side_by_side_keep_theirs() {
    figures(
        "two pens side by side",
        0.714,
        &pairs(&two_pens(), &[0.0, 30.0]),
        |&((wide, thin), turn)| {
            let bar = |side: f64, width: f64| {
                let center = polar(CENTER, turn + 90.0, side);
                line(polar(center, turn, -70.0), polar(center, turn, 70.0), width)
            };
            page(vec![bar(-30.0, wide), bar(30.0, thin)])
        },
        |&((wide, _), _), truth, traced| {
            same_strokes(truth, traced, 0.5 + 0.02 * wide)?;
            same_widths(truth, traced, 0.0)
        },
    );
}

#[test]
fn lines_of_two_widths_cross_straight() {
    figures(
        "two pens that cross",
        0.857,
        &pairs(&two_pens(), &[90.0, 50.0]),
        |&((wide, thin), between)| {
            let bar = |angle, width| line(polar(CENTER, angle, -80.0), polar(CENTER, angle, 80.0), width);
            page(vec![bar(10.0, wide), bar(10.0 + between, thin)])
        },
        |&((wide, _), _), truth, traced| {
            same_strokes(truth, traced, 0.5 + 0.05 * wide)?;
            same_widths(truth, traced, 0.5)?;
            straight(traced, 0.6)
        },
    );
}

#[test]
fn a_thin_line_that_ends_on_a_wide_one_is_a_tee() {
    figures(
        "two pens in a tee",
        0.857,
        &pairs(&two_pens(), &[90.0, 60.0]),
        |&((wide, thin), slant)| {
            let bar = line(polar(CENTER, 10.0, -80.0), polar(CENTER, 10.0, 80.0), wide);
            page(vec![bar, line(CENTER, polar(CENTER, 10.0 + slant, 80.0), thin)])
        },
        |&((wide, _), _), truth, traced| {
            same_strokes(truth, traced, 0.5 + 0.05 * wide)?;
            same_widths(truth, traced, 0.5)?;
            straight(traced, 0.6)
        },
    );
}

/// A frame of a broad pen on 200 x 200 pixels, with fine lines that end on it and one that crosses it.
fn framed(fine: f64, broad: f64, turn: f64) -> Drawing {
    let at = |x: f64, y: f64| polar(CENTER, turn, x) + (polar(CENTER, turn + 90.0, y) - CENTER);
    let frame = polyline(&[at(-60.0, -45.0), at(60.0, -45.0), at(60.0, 45.0), at(-60.0, 45.0)], true, broad);
    let rung = |x: f64| line(at(x, -45.0), at(x, 45.0), fine);
    page(vec![frame, rung(-30.0), rung(0.0), line(at(30.0, -70.0), at(30.0, 70.0), fine)])
}

fn frames() -> Vec<((f64, f64), f64)> {
    pairs(&[(1.5, 8.0), (2.0, 8.0), (2.0, 12.0), (2.5, 10.0), (3.0, 12.0)], &[0.0, 20.0, 45.0])
}

fn same_frame(&((_, broad), _): &((f64, f64), f64), truth: &Drawing, traced: &Drawing) -> Result<(), String> {
    same_strokes(truth, traced, 0.5 + 0.12 * broad)?;
    same_widths(truth, traced, 0.75)
}

#[test]
fn fine_lines_end_on_a_broad_frame_and_cross_it() {
    let draw = |&((fine, broad), turn): &((f64, f64), f64)| framed(fine, broad, turn);
    figures("fine lines in a broad frame", 0.866, &frames(), draw, same_frame);
}

#[test]
fn fine_lines_end_on_a_broad_frame_in_ink_on_paper_too() {
    let draw = |&((fine, broad), turn): &((f64, f64), f64)| framed(fine, broad, turn);
    let scan = |_: &((f64, f64), f64), drawing: &Drawing| on_paper(drawing, Paper::INK, 5);
    figures_on("fine lines in a broad frame on paper", 0.8, &frames(), draw, scan, same_frame);
}
