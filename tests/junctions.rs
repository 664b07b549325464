//! Simple figures whose truth is known, over angles, widths and positions between the pixels.
//!
//! What counts as right is the same in every case of a sweep. Where a share below one is asked for, it is the share
//! that was measured, less a case: the rest are known faults, printed by `cargo test --test junctions -- --nocapture`.

mod common;

use common::compare::{apart, body_apart, bow, ends_apart, ends_of, lines, straight_pieces};
use common::draw::{Pen, SPECKLESS, arc, circle, dot, line, on_paper, polar, polyline, scan, scan_by, sheet, trace};
use common::sweep::{ensure, pairs, steps, sweep};
use fieldtrace::drawing::{Centreline, Drawing, Fill, Stroke};
use kurbo::{BezPath, Circle, Point, Rect, Shape, Vec2};
use std::f64::consts::FRAC_PI_2;
use tiny_skia::LineCap;

const CENTER: Point = Point::new(48.0, 48.0);
const WIDTHS: [f64; 5] = [2.0, 3.0, 4.0, 6.0, 8.0];
const OFFSETS: [Vec2; 3] = [Vec2::new(0.0, 0.0), Vec2::new(0.5, 0.5), Vec2::new(0.27, 0.81)];

/// Angle in degrees, width and shift of a figure.
type Case = (f64, f64, Vec2);

fn cases(angles: &[f64], widths: &[f64], offsets: &[Vec2]) -> Vec<Case> {
    pairs(&pairs(angles, widths), offsets).into_iter().map(|((a, w), o)| (a, w, o)).collect()
}

/// Traces strokes drawn on 96 x 96 pixels.
fn traced(strokes: &[Stroke]) -> Drawing {
    trace(&scan(&sheet(96, 96, strokes.to_vec())))
}

/// As many strokes as were drawn, near them.
fn like(truth: &[Stroke], result: &Drawing, mean: f64, max: f64) -> Result<(), String> {
    let count = result.strokes.len();
    ensure(count == truth.len(), || format!("{count} strokes for {}", truth.len()))?;
    ensure(result.fills.is_empty(), || "a filled region".into())?;
    near(truth, result, mean, max)
}

/// Near the strokes that were drawn; their ends have a sweep of their own.
fn near(truth: &[Stroke], result: &Drawing, mean: f64, max: f64) -> Result<(), String> {
    let apart = body_apart(&sheet(96, 96, truth.to_vec()), result, 1.5);
    ensure(apart.mean <= mean && apart.max <= max, || format!("{apart:.3?}"))
}

fn widths_like(width: f64, result: &Drawing, tolerance: f64) -> Result<(), String> {
    let off = result.strokes.iter().map(|s| (s.width - width).abs()).fold(0.0, f64::max);
    ensure(off <= tolerance, || format!("a width is off by {off:.2}"))
}

/// Every stroke bows at most so much.
fn straight(result: &Drawing, tolerance: f64) -> Result<(), String> {
    let bow = result.strokes.iter().map(|s| bow(&s.centreline)).fold(0.0, f64::max);
    ensure(bow <= tolerance, || format!("a stroke bows by {bow:.2}"))
}

#[test]
fn a_line_is_one_line_at_every_angle() {
    let cases = cases(&steps(0.0, 175.0, 5.0), &WIDTHS, &OFFSETS);
    sweep("single lines", 0.998, &cases, |&(angle, width, offset)| {
        let (a, b) = (polar(CENTER, angle, -36.0) + offset, polar(CENTER, angle, 36.0) + offset);
        let truth = [line(a, b, width)];
        let result = traced(&truth);
        like(&truth, &result, 0.15, 0.5)?;
        ensure(straight_pieces(&result.strokes[0].centreline) == Some(1), || "more than one piece".into())?;
        widths_like(width, &result, 0.3)
    });
}

#[test]
fn a_line_ends_half_a_width_before_its_ink() {
    let cases = cases(&steps(0.0, 175.0, 5.0), &WIDTHS, &OFFSETS);
    sweep("free ends", 1.0, &cases, |&(angle, width, offset)| {
        let (a, b) = (polar(CENTER, angle, -36.0) + offset, polar(CENTER, angle, 36.0) + offset);
        let result = traced(&[line(a, b, width)]);
        let length = result.length() - a.distance(b);
        let ends = ends_apart(&result, &[a, b]);
        ensure(ends <= 0.5, || format!("an end is off by {ends:.2}, the length by {length:.2}"))
    });
}

#[test]
fn lines_are_on_average_as_long_as_they_were_drawn() {
    let cases = pairs(&WIDTHS[1..], &[false, true]);
    sweep("mean lengths", 1.0, &cases, |&(width, pencil)| {
        let off = |&angle: &f64| {
            let (a, b) = (polar(CENTER, angle, -36.0), polar(CENTER, angle, 36.0));
            let drawing = sheet(96, 96, vec![line(a, b, width)]);
            let seen = if pencil { on_paper(&drawing, SPECKLESS, angle as u64) } else { scan(&drawing) };
            trace(&seen).length() - a.distance(b)
        };
        let angles = steps(0.0, 175.0, 5.0);
        let mean = angles.iter().map(off).sum::<f64>() / angles.len() as f64;
        let most = if pencil { 0.3 } else { 0.1 };
        ensure(mean.abs() <= most, || format!("lines are {mean:.3} longer"))
    });
}

#[test]
fn an_arc_ends_half_a_width_before_its_ink() {
    let cases = pairs(&steps(45.0, 315.0, 45.0), &WIDTHS);
    sweep("ends of arcs", 1.0, &cases, |&(sweep, width)| {
        let (start, end) = (17.2, 17.2 + sweep);
        let truth = arc(CENTER, 32.0, f64::to_radians(start), f64::to_radians(sweep), width);
        let ends = ends_apart(&traced(&[truth]), &[polar(CENTER, start, 32.0), polar(CENTER, end, 32.0)]);
        ensure(ends <= 0.5, || format!("an end is off by {ends:.2}"))
    });
}

#[test]
fn a_line_without_grey_edges_is_one_line() {
    let cases = cases(&steps(0.0, 175.0, 5.0), &WIDTHS, &OFFSETS[..2]);
    sweep("bilevel lines", 0.997, &cases, |&(angle, width, offset)| {
        let truth = [line(polar(CENTER, angle, -36.0) + offset, polar(CENTER, angle, 36.0) + offset, width)];
        let pen = Pen { anti_alias: false, ..Pen::default() };
        like(&truth, &trace(&scan_by(&sheet(96, 96, truth.to_vec()), pen)), 0.55, 1.0)
    });
}

#[test]
fn a_flat_ended_line_is_one_line() {
    let cases = cases(&steps(0.0, 175.0, 5.0), &WIDTHS, &OFFSETS[..1]);
    sweep("flat ends", 1.0, &cases, |&(angle, width, offset)| {
        let truth = [line(polar(CENTER, angle, -36.0) + offset, polar(CENTER, angle, 36.0) + offset, width)];
        let pen = Pen { cap: LineCap::Butt, ..Pen::default() };
        // A round cap over a flat end: half a width may be missing, no more.
        like(&truth, &trace(&scan_by(&sheet(96, 96, truth.to_vec()), pen)), 0.35, 0.5 * width + 0.5)
    });
}

#[test]
fn a_pencil_line_is_one_line() {
    let cases = cases(&steps(0.0, 170.0, 10.0), &WIDTHS, &OFFSETS[..1]);
    sweep("pencil lines", 1.0, &cases, |&(angle, width, offset)| {
        let truth = [line(polar(CENTER, angle, -36.0) + offset, polar(CENTER, angle, 36.0) + offset, width)];
        like(&truth, &trace(&on_paper(&sheet(96, 96, truth.to_vec()), SPECKLESS, angle as u64)), 0.4, 1.5)
    });
}

#[test]
fn a_circle_is_one_closed_stroke() {
    let cases = cases(&[6.0, 8.0, 12.0, 20.0, 30.0, 42.0], &WIDTHS, &OFFSETS);
    let cases: Vec<Case> = cases.into_iter().filter(|&(radius, width, _)| radius >= 2.0 * width).collect();
    sweep("circles", 0.986, &cases, |&(radius, width, offset)| {
        let truth = [circle(CENTER + offset, radius, width)];
        let result = traced(&truth);
        like(&truth, &result, 0.15, 0.4)?;
        ensure(result.strokes[0].centreline.is_closed(), || "open".into())?;
        ensure(matches!(result.strokes[0].centreline, Centreline::Circle(_)), || "not a circle".into())?;
        widths_like(width, &result, 0.35)
    });
}

#[test]
fn an_arc_is_one_stroke() {
    let cases = pairs(&steps(45.0, 315.0, 45.0), &WIDTHS);
    sweep("arcs", 1.0, &cases, |&(sweep, width)| {
        let truth = [arc(CENTER, 32.0, 0.3, sweep.to_radians(), width)];
        like(&truth, &traced(&truth), 0.15, 0.6)
    });
}

#[test]
fn a_corner_is_one_stroke_of_two_lines() {
    let cases = cases(&[30.0, 45.0, 60.0, 75.0, 90.0, 110.0, 130.0], &WIDTHS, &OFFSETS);
    let cases = pairs(&cases, &[0.0, 20.0, 45.0, 70.0]);
    sweep("corners", 0.995, &cases, |&((opening, width, offset), turn)| {
        let tip = CENTER + offset - Vec2::from_angle(f64::to_radians(turn + 0.5 * opening)) * 20.0;
        let truth = [polyline(&[polar(tip, turn, 50.0), tip, polar(tip, turn + opening, 50.0)], false, width)];
        let result = traced(&truth);
        like(&truth, &result, 0.2, 0.25 * width + 0.5)?;
        ensure(straight_pieces(&result.strokes[0].centreline) == Some(2), || "not two straight lines".into())
    });
}

#[test]
fn a_blunt_corner_is_one_stroke() {
    // Two arms and a short piece across, whose length is given in widths.
    let cases = pairs(&cases(&[10.0, 20.0, 40.0, 60.0], &[2.0, 2.5, 3.0, 4.0], &OFFSETS[..2]), &[0.4, 0.6, 0.8, 1.0]);
    let cases = pairs(&cases, &[0.0, 15.0, 45.0, 100.0]);
    sweep("blunt corners", 0.585, &cases, |&(((opening, width, offset), across), turn)| {
        let tip = |side: f64| polar(CENTER, turn + 90.0, side * 0.5 * across * width) + offset;
        let arm = |side: f64| polar(tip(side), turn + side * 0.5 * opening, 38.0);
        let truth = [polyline(&[arm(-1.0), tip(-1.0), tip(1.0), arm(1.0)], false, width)];
        like(&truth, &traced(&truth), 0.15 * width, 0.8 * width + 0.4)
    });
}

#[test]
fn a_rectangle_is_one_closed_stroke_of_four_lines() {
    let cases = cases(&[0.0, 5.0, 15.0, 30.0, 45.0], &WIDTHS, &OFFSETS);
    sweep("rectangles", 0.986, &cases, |&(turn, width, offset)| {
        let along = Vec2::from_angle(f64::to_radians(turn));
        let corner = |x: f64, y: f64| CENTER + offset + along * x + along.turn_90() * y;
        let corners = [corner(-32.0, -20.0), corner(32.0, -20.0), corner(32.0, 20.0), corner(-32.0, 20.0)];
        let truth = [polyline(&corners, true, width)];
        let result = traced(&truth);
        like(&truth, &result, 0.15, 0.6)?;
        let stroke = &result.strokes[0].centreline;
        ensure(stroke.is_closed(), || "open".into())?;
        ensure(straight_pieces(stroke) == Some(4), || "not four straight lines".into())
    });
}

#[test]
fn a_tee_is_a_bar_and_a_stem() {
    let cases = cases(&steps(0.0, 355.0, 15.0), &WIDTHS, &OFFSETS[..2]);
    sweep("tees", 1.0, &cases, |&(turn, width, offset)| {
        let center = CENTER + offset;
        let truth = [
            line(polar(center, turn, -38.0), polar(center, turn, 38.0), width),
            line(center, polar(center, turn + 90.0, 38.0), width),
        ];
        let result = traced(&truth);
        like(&truth, &result, 0.2, 0.3 * width + 0.4)?;
        straight(&result, 0.5)
    });
}

/// A bar and a stem on a pencil scan, the stem ending `gap` pixels of paper short of the bar; how far the traced
/// stem's end is from the bar's middle.
fn pencil_stem(turn: f64, width: f64, gap: Option<f64>) -> Result<f64, String> {
    let short = gap.map_or(0.0, |gap| width + gap);
    let bar = line(polar(CENTER, turn, -38.0), polar(CENTER, turn, 38.0), width);
    let stem = line(polar(CENTER, turn + 90.0, short), polar(CENTER, turn + 90.0, 38.0), width);
    let result = trace(&on_paper(&sheet(96, 96, vec![bar, stem]), SPECKLESS, turn as u64));
    ensure(result.strokes.len() == 2, || format!("{} strokes", result.strokes.len()))?;
    let normal = Vec2::from_angle(f64::to_radians(turn + 90.0));
    let heights = |s: &Stroke| [s.centreline.start(), s.centreline.end()].map(|p| (p - CENTER).dot(normal));
    let stem = result.strokes.iter().map(heights).max_by(|a, b| a[0].max(a[1]).total_cmp(&b[0].max(b[1])));
    stem.map(|ends| ends[0].min(ends[1])).ok_or_else(|| "no stem".into())
}

#[test]
fn a_pencil_stem_that_stops_short_stays_apart() {
    let cases = cases(&steps(0.0, 345.0, 15.0), &WIDTHS[1..4], &OFFSETS[..1]);
    sweep("gaps on pencil scans", 0.986, &pairs(&cases, &[0.75, 1.0, 1.25, 1.5, 2.0]), |&((turn, width, _), gap)| {
        let height = pencil_stem(turn, width, Some(gap))?;
        ensure((height - width - gap).abs() < 0.75, || format!("the stem ends {height:.2} from the bar"))
    });
}

#[test]
fn a_pencil_stem_that_touches_stays_joined() {
    let cases = cases(&steps(0.0, 345.0, 15.0), &WIDTHS[1..4], &OFFSETS[..1]);
    sweep("tees on pencil scans", 1.0, &cases, |&(turn, width, _)| {
        let height = pencil_stem(turn, width, None)?;
        ensure(height.abs() < 0.5, || format!("the stem ends {height:.2} from the bar"))
    });
}

#[test]
fn a_slanted_tee_is_a_bar_and_a_stem() {
    let cases = cases(&[30.0, 45.0, 60.0, 75.0, 105.0, 135.0], &WIDTHS, &OFFSETS);
    sweep("slanted tees", 0.977, &cases, |&(slant, width, offset)| {
        let center = CENTER + offset;
        let truth = [
            line(polar(center, 0.0, -38.0), polar(center, 0.0, 38.0), width),
            line(center, polar(center, slant, 38.0), width),
        ];
        let result = traced(&truth);
        like(&truth, &result, 0.25, 0.5 * width + 0.4)?;
        straight(&result, 0.6)
    });
}

#[test]
fn a_crossing_is_two_straight_strokes() {
    let cases = cases(&steps(20.0, 90.0, 5.0), &WIDTHS, &OFFSETS);
    let cases = pairs(&cases, &[0.0, 25.0]);
    sweep("crossings", 0.991, &cases, |&((between, width, offset), turn)| {
        let center = CENTER + offset;
        let bar = |angle| line(polar(center, angle, -40.0), polar(center, angle, 40.0), width);
        let truth = [bar(turn), bar(turn + between)];
        let result = traced(&truth);
        like(&truth, &result, 0.2, 0.2 * width + 0.5)?;
        straight(&result, 0.6)
    });
}

#[test]
fn a_star_keeps_every_arm() {
    let cases = cases(&[3.0, 4.0, 5.0, 6.0, 7.0, 8.0], &WIDTHS, &OFFSETS);
    let cases = pairs(&cases, &[0.0, 11.0, 30.0, 90.0]);
    sweep("stars", 0.938, &cases, |&((arms, width, offset), turn)| {
        let center = CENTER + offset;
        let tips: Vec<Point> =
            steps(0.0, arms - 1.0, 1.0).iter().map(|i| polar(center, turn + i * 360.0 / arms, 42.0)).collect();
        let truth: Vec<Stroke> = tips.iter().map(|&tip| line(center, tip, width)).collect();
        let result = traced(&truth);
        near(&truth, &result, 0.25, 0.5 * width + 0.5)?;
        // How arms pair into strokes is free; every arm is there, once.
        let length = result.length() / (42.0 * arms);
        ensure((length - 1.0).abs() < 0.08, || format!("{length:.2} of the length"))?;
        let most = arms as usize;
        ensure(result.strokes.len() <= most, || format!("{} strokes for {most} arms", result.strokes.len()))
    });
}

#[test]
fn parallel_lines_stay_two() {
    let cases = cases(&steps(0.0, 165.0, 15.0), &WIDTHS, &[Vec2::new(0.0, 0.0), Vec2::new(0.3, 0.7)]);
    let cases = pairs(&cases, &[1.5, 2.0, 3.0]);
    sweep("parallel lines", 0.986, &cases, |&((angle, width, offset), gap)| {
        let apart = Vec2::from_angle(f64::to_radians(angle + 90.0)) * (0.5 * (width + gap));
        let bar = |c: Point| line(polar(c, angle, -36.0), polar(c, angle, 36.0), width);
        let truth = [bar(CENTER + offset + apart), bar(CENTER + offset - apart)];
        let result = traced(&truth);
        like(&truth, &result, 0.25, 1.0)?;
        straight(&result, 0.5)
    });
}

#[test]
fn dots_stay_dots() {
    let cases = cases(&[1.0, 1.2, 1.5], &WIDTHS[1..], &OFFSETS);
    sweep("dots", 1.0, &cases, |&(size, width, offset)| {
        let center = Point::new(30.0, 30.0) + offset;
        let diameter = size * width;
        let truth = [dot(center, diameter), line((20.0, 60.0), (80.0, 60.0), width)];
        let result = traced(&truth);
        like(&truth, &result, 0.3, 0.6)?;
        let found = result.strokes.iter().find_map(|s| match s.centreline {
            Centreline::Dot(p) => Some((p, s.width)),
            _ => None,
        });
        let (p, found) = found.ok_or("no dot")?;
        ensure(p.distance(center) < 0.4, || format!("off by {:.2}", p.distance(center)))?;
        ensure((found - diameter).abs() < 0.25 * diameter, || format!("{found:.2} wide for {diameter:.2}"))
    });
}

#[test]
fn lines_that_leave_the_picture_reach_its_edge() {
    let cases = cases(&steps(0.0, 170.0, 10.0), &WIDTHS, &OFFSETS[..2]);
    sweep("lines over the border", 0.977, &cases, |&(angle, width, offset)| {
        let center = CENTER + offset;
        let beyond = line(polar(center, angle, -80.0), polar(center, angle, 80.0), width);
        let result = traced(&[beyond]);
        ensure(result.strokes.len() == 1, || format!("{} strokes", result.strokes.len()))?;
        straight(&result, 0.5)?;
        // What can be seen of it: where it meets the canvas.
        let direction = Vec2::from_angle(angle.to_radians());
        let reach = |d: Vec2| {
            let side = |c: f64, v: f64| {
                if v > 1e-9 {
                    (96.0 - c) / v
                } else if v < -1e-9 {
                    -c / v
                } else {
                    f64::INFINITY
                }
            };
            center + d * side(center.x, d.x).min(side(center.y, d.y))
        };
        let ends = ends_apart(&result, &[reach(direction), reach(-direction)]);
        ensure(ends <= width + 1.0, || format!("an end is {ends:.2} from the border"))
    });
}

#[test]
fn filled_shapes_come_out_as_fills() {
    let cases = pairs(&[14.0, 20.0, 30.0], &OFFSETS);
    sweep("discs", 1.0, &cases, |&(radius, offset)| {
        let disc = Circle::new(CENTER + offset, radius);
        let mut drawing = Drawing::new(140.0, 96.0);
        // Lines beside it say what a line is here.
        drawing.strokes = vec![line((104.0, 10.0), (104.0, 86.0), 3.0), line((120.0, 10.0), (132.0, 86.0), 3.0)];
        drawing.fills.push(Fill { outline: disc.to_path(1e-3), color: fieldtrace::drawing::Color::BLACK });
        let result = trace(&scan(&drawing));
        ensure(result.fills.len() == 1, || format!("{} fills", result.fills.len()))?;
        ensure(result.strokes.len() == 2, || format!("{} strokes", result.strokes.len()))?;
        let outline: Vec<BezPath> = result.fills.iter().map(|f| f.outline.clone()).collect();
        let apart = apart(&outline, &[disc.to_path(1e-3)]);
        ensure(apart.mean <= 0.5 && apart.max <= 1.2, || format!("{apart:.3?}"))?;
        let area = outline[0].area().abs() / disc.area();
        ensure((area - 1.0).abs() < 0.05, || format!("{area:.3} of the area"))
    });
}

#[test]
fn a_hole_in_a_filled_shape_stays() {
    let mut outline = Rect::new(20.0, 20.0, 76.0, 76.0).to_path(1e-3);
    outline.extend(Circle::new((48.0, 48.0), 12.0).to_path(1e-3).reverse_subpaths());
    let mut drawing = Drawing::new(120.0, 96.0);
    drawing.strokes = vec![line((90.0, 10.0), (90.0, 86.0), 3.0), line((104.0, 10.0), (112.0, 86.0), 3.0)];
    drawing.fills.push(Fill { outline: outline.clone(), color: fieldtrace::drawing::Color::BLACK });
    let result = trace(&scan(&drawing));
    assert_eq!(result.fills.len(), 1);
    assert_eq!(result.strokes.len(), 2);
    let apart = apart(&[result.fills[0].outline.clone()], &[outline]);
    assert!(apart.mean < 0.6 && apart.max < 2.5, "{apart:?}");
}

#[test]
fn nothing_is_traced_where_nothing_is_drawn() {
    let result = trace(&scan(&sheet(64, 64, Vec::new())));
    assert!(lines(&result).is_empty() && result.fills.is_empty());
}

/// An arm that leaves a bar by an arc which touches it: the node is where arc and bar touch, however late their inks part.
#[test]
fn an_arm_that_leaves_by_an_arc_leaves_where_it_touches() {
    let cases = pairs(&pairs(&[24.0, 32.0, 40.0], &[2.0, 3.0, 4.0, 5.0]), &steps(0.0, 165.0, 15.0));
    sweep("arms that leave by an arc", 0.972, &cases, |&((radius, width), turn)| {
        let along = Vec2::from_angle(turn.to_radians());
        let touch = CENTER - along * 10.0;
        let bar = line(touch - along * 24.0, touch + along * 48.0, width);
        let arm = arc(touch + along.turn_90() * radius, radius, turn.to_radians() - FRAC_PI_2, 1.2, width);
        let truth = [bar, arm];
        let result = traced(&truth);
        like(&truth, &result, 0.25, 1.6)?;
        let start = ends_of(&result).into_iter().map(|end| end.distance(touch)).fold(f64::INFINITY, f64::min);
        ensure(start < (1.25 * width).max(3.0), || format!("the arm starts {start:.1} from where it touches"))
    });
}

/// Lines hardly wider than a pixel change their darkness with each pixel of their staircase and stay whole.
#[test]
fn hairlines_are_whole_at_every_angle() {
    let cases = cases(&steps(0.0, 175.0, 5.0), &[1.2, 1.5, 1.8], &OFFSETS);
    sweep("hairlines", 0.996, &cases, |&(angle, width, offset)| {
        let truth = [line(polar(CENTER, angle, -36.0) + offset, polar(CENTER, angle, 36.0) + offset, width)];
        let result = traced(&truth);
        like(&truth, &result, 0.2, 0.8)?;
        straight(&result, 0.4)
    });
}

/// The same for circles.
#[test]
fn thin_circles_are_whole() {
    let cases = pairs(&pairs(&[12.0, 20.0, 33.0], &[1.2, 1.5, 1.8]), &OFFSETS);
    sweep("thin circles", 0.962, &cases, |&((radius, width), offset)| {
        let truth = [circle(CENTER + offset, radius, width)];
        let result = traced(&truth);
        like(&truth, &result, 0.2, 0.8)?;
        ensure(result.strokes[0].centreline.is_closed(), || "not closed".into())
    });
}
