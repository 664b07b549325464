//! Strokes as outlines that keep their taper.

mod common;

use common::compare::common_ink;
use common::draw::{circle, cubic, line, polar, polyline, rendered, scan, sheet, trace_under};
use common::sweep::{ensure, pairs, steps, sweep};
use fieldtrace::drawing::{Color, Drawing, Fill};
use fieldtrace::load::Scan;
use fieldtrace::options::{Options, StrokeWidth};
use kurbo::{BezPath, Point, Vec2};

const CENTER: Point = Point::new(80.2, 79.7);

fn traced(scan: &Scan, width: StrokeWidth) -> Drawing {
    trace_under(Options::default().with(|o| o.width = width), scan)
}

/// A brush that grows evenly from one width to another along an arc that turns by `bend` degrees.
fn brush(angle: f64, widths: (f64, f64), bend: f64) -> Drawing {
    let (length, count) = (120.0, 480);
    let step = length / f64::from(count);
    let mut p = polar(CENTER, angle, -0.5 * length);
    let (mut there, mut back) = (Vec::new(), Vec::new());
    for k in 0..=count {
        let t = f64::from(k) / f64::from(count);
        let heading = Vec2::from_angle((angle + (t - 0.5) * bend).to_radians());
        let radius = 0.5 * (widths.0 + t * (widths.1 - widths.0));
        // At both ends the brush is round.
        let turns = if k == 0 || k == count { 90 } else { 0 };
        let outwards = if k == 0 { 1.0 } else { -1.0 };
        for turn in (0..=turns).step_by(10) {
            let turn = f64::from(if k == 0 { turns - turn } else { turn }).to_radians() * outwards;
            let normal = heading.turn_90() * radius;
            there.push(p + normal.rotate_scale(Vec2::from_angle(turn)));
            back.push(p - normal.rotate_scale(Vec2::from_angle(-turn)));
        }
        p += heading * step;
    }
    let mut outline = BezPath::new();
    outline.move_to(there[0]);
    there.iter().skip(1).chain(back.iter().rev()).for_each(|&q| outline.line_to(q));
    outline.close_path();
    let mut drawing = Drawing::new(160.0, 160.0);
    drawing.fills.push(Fill { outline, color: Color::BLACK });
    drawing
}

const TAPERS: [(f64, f64); 4] = [(2.0, 7.0), (3.0, 6.0), (8.0, 4.0), (5.0, 5.0)];

#[test]
fn a_taper_is_kept_with_few_pieces() {
    let cases = pairs(&pairs(&steps(0.0, 330.0, 30.0), &TAPERS), &[0.0, 50.0]);
    sweep("tapers", 0.989, &cases, |&((angle, widths), bend)| {
        let truth = brush(angle, widths, bend);
        let result = traced(&rendered(&truth), StrokeWidth::Outline);
        ensure(result.strokes.is_empty() && result.fills.len() == 1, || {
            format!("{} strokes, {} outlines", result.strokes.len(), result.fills.len())
        })?;
        let ink = common_ink(&truth, &result);
        ensure(ink > 0.94, || format!("{ink:.3} of the ink"))?;
        let pieces = result.fills[0].outline.segments().count();
        ensure(pieces <= 16, || format!("{pieces} pieces"))
    });
}

#[test]
fn a_tapering_stroke_has_a_width_in_between() {
    sweep("widths of tapers", 0.833, &pairs(&steps(0.0, 330.0, 30.0), &TAPERS), |&(angle, (first, last))| {
        let result = traced(&rendered(&brush(angle, (first, last), 0.0)), StrokeWidth::Measured);
        ensure(result.strokes.len() == 1, || format!("{} strokes", result.strokes.len()))?;
        let (width, middle) = (result.strokes[0].width, 0.5 * (first + last));
        ensure((width - middle).abs() < 0.3 * middle + 0.3, || format!("{width:.2} for {first} to {last}"))
    });
}

#[test]
fn outlines_of_even_strokes_cover_them() {
    let at = |angle: f64, reach: f64| polar(CENTER, angle, reach);
    sweep("even strokes", 0.944, &pairs(&steps(0.0, 160.0, 20.0), &[2.5, 5.0]), |&(angle, width)| {
        let figures = [
            vec![circle(CENTER, 40.0, width)],
            vec![polyline(&[at(angle, 60.0), CENTER, at(angle + 70.0, 60.0)], false, width)],
            vec![polyline(&[at(angle, 50.0), at(angle + 120.0, 50.0), at(angle + 240.0, 50.0)], true, width)],
            vec![
                line(at(angle, 60.0), at(angle, -60.0), width),
                line(at(angle + 60.0, 60.0), at(angle + 60.0, -60.0), width),
            ],
            // A loop that crosses itself: the crossing is not a hole.
            vec![cubic([(20.0, 130.0), (190.0, 20.0), (-30.0, 20.0), (140.0, 130.0)], width)],
        ];
        for (i, figure) in figures.into_iter().enumerate() {
            let truth = sheet(160, 160, figure);
            let result = traced(&scan(&truth), StrokeWidth::Outline);
            ensure(result.strokes.is_empty(), || format!("figure {i}: {} strokes", result.strokes.len()))?;
            let ink = common_ink(&truth, &result);
            ensure(ink > 0.93, || format!("figure {i}: {ink:.3} of the ink"))?;
        }
        Ok(())
    });
}
