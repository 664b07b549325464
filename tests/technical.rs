//! What plans and technical drawings are made of: near-parallel lines, hatching, arrow heads, rectangles, long lines.
//!
//! Floors below one are the shares that were measured, less one case, for the network's last digits depend on the
//! processor: `cargo test --test technical -- --nocapture` prints what fails. Each sweep leaves a sheet in `tmp/sheets` of
//! Cargo's target directory, with what was drawn beside what was traced.

mod common;

use common::compare::{apart, bow, lines, straight_pieces};
use common::draw::{SPECKLESS, circle, line, on_paper, polar, polyline, rendered, sheet};
use common::figures::{figures, figures_on, like_stroke, nearest, nearest_end, same_length, same_strokes, straight};
use common::sweep::{ensure, pairs, steps};
use fieldtrace::drawing::{Centreline, Color, Drawing, Fill, Segment, Stroke};
use kurbo::{Arc, BezPath, Line, ParamCurve, Point, Shape, Vec2};
use std::f64::consts::{FRAC_PI_2, SQRT_2};
use std::slice::from_ref;

const CENTER: Point = Point::new(60.0, 60.0);
const WIDTHS: [f64; 4] = [2.0, 3.0, 4.5, 7.0];
const TURNS: [f64; 4] = [0.0, 17.0, 45.0, 90.0];

/// Strokes on 120 x 120 pixels.
fn page(strokes: Vec<Stroke>) -> Drawing {
    sheet(120, 120, strokes)
}

/// A pencil's scan of a drawing; `seed` makes each its own.
fn pencil(drawing: &Drawing, seed: f64) -> fieldtrace::load::Scan {
    on_paper(drawing, SPECKLESS, seed.to_bits() >> 32)
}

/// A frame turned about a point.
fn frame(center: Point, degrees: f64) -> impl Fn(f64, f64) -> Point {
    let along = Vec2::from_angle(degrees.to_radians());
    move |x, y| center + along * x + along.turn_90() * y
}

#[test]
fn near_parallel_lines_stay_two() {
    // Degrees between them, and the paper left where they are nearest.
    let cases = pairs(&pairs(&pairs(&[0.5, 1.0, 2.0, 4.0], &[1.5, 2.0, 3.0]), &WIDTHS), &TURNS);
    figures(
        "near-parallel lines",
        0.994,
        &cases,
        |&(((between, gap), width), turn)| {
            let at = frame(CENTER, turn);
            let spread = 100.0 * f64::to_radians(between).tan();
            let half = 0.5 * (width + gap);
            page(vec![
                line(at(-50.0, -half), at(50.0, -half - spread), width),
                line(at(-50.0, half), at(50.0, half), width),
            ])
        },
        |&((_, width), _), truth, traced| {
            same_strokes(truth, traced, 0.1 * width + 0.5)?;
            straight(traced, 0.5)
        },
    );
}

/// Two lines with so many pixels of paper between them.
fn close((paper, width): (f64, f64), turn: f64) -> Drawing {
    let (at, half) = (frame(CENTER + Vec2::new(0.3, 0.1), turn), 0.5 * (width + paper));
    page([-half, half].map(|y| line(at(-45.0, y), at(45.0, y), width)).to_vec())
}

#[test]
fn lines_with_hardly_any_paper_between_them_are_two() {
    let cases = pairs(&pairs(&[0.75, 1.0, 1.25], &WIDTHS), &steps(0.0, 90.0, 7.5));
    figures(
        "close lines",
        0.974,
        &cases,
        |&(place, turn)| close(place, turn),
        |&((_, width), _), truth, traced| {
            same_strokes(truth, traced, 0.1 * width + 0.5)?;
            straight(traced, 0.5)
        },
    );
}

#[test]
fn pencil_lines_with_little_paper_between_them_are_two() {
    let cases = pairs(&pairs(&[1.25, 1.6, 2.0, 2.5], &WIDTHS[..3]), &steps(0.0, 90.0, 7.5));
    figures_on(
        "close lines in pencil",
        0.884,
        &cases,
        |&(place, turn)| close(place, turn),
        |&((paper, width), turn), drawing| pencil(drawing, paper + 10.0 * width + turn),
        |&((_, width), _), truth, traced| {
            same_strokes(truth, traced, 0.2 * width + 0.6)?;
            straight(traced, 0.7)
        },
    );
}

#[test]
fn lines_that_run_together_are_two() {
    // Two lines that meet at their ends under an angle that no corner has.
    let cases = pairs(&pairs(&[6.0, 9.0, 12.0, 16.0], &WIDTHS), &TURNS);
    figures(
        "wedges",
        0.906,
        &cases,
        |&((between, width), turn)| {
            let tip = polar(CENTER, turn, -54.0);
            page(vec![polyline(&[polar(tip, turn, 108.0), tip, polar(tip, turn + between, 108.0)], false, width)])
        },
        |&((between, width), _), truth, traced| {
            // The inside of the tip is ink up to here.
            let tip = 0.5 * width / (0.5 * f64::to_radians(between)).tan();
            ensure((1..=2).contains(&traced.strokes.len()), || format!("{} strokes", traced.strokes.len()))?;
            let ends = [truth.strokes[0].centreline.start(), truth.strokes[0].centreline.end()];
            let off = ends.iter().map(|p| nearest_end(*p, traced)).fold(0.0, f64::max);
            ensure(off <= 0.75, || format!("an end is off by {off:.2}"))?;
            let apart = apart(&lines(truth), &lines(traced));
            ensure(apart.max <= 0.5 * width + 0.5, || format!("{apart:.3?}"))?;
            let longest = truth.length() + 1.0;
            let shortest = truth.length() - tip - 1.0;
            let length = traced.length();
            ensure((shortest..=longest).contains(&length), || {
                format!("{length:.1} long, not {shortest:.1} to {longest:.1}")
            })
        },
    );
}

/// Lines at even distances inside a rectangle, at an angle to it, from edge to edge.
fn hatching(center: Point, half: f64, angle: f64, gap: f64) -> Vec<Line> {
    let normal = Vec2::from_angle(angle.to_radians()).turn_90();
    let along = normal.turn_90();
    let corners = [(-half, -half), (half, -half), (half, half), (-half, half)].map(|c| center + Vec2::from(c));
    let reach = corners.iter().map(|c| (*c - center).dot(normal)).fold(0.0, f64::max);
    let square = kurbo::Rect::from_center_size(center, (2.0 * half, 2.0 * half));
    let count = (reach / gap).floor() as i32;
    let clipped = |i: i32| {
        let middle = center + normal * (gap * f64::from(i));
        // Where the line leaves the square, both ways.
        let exit = |direction: Vec2| {
            let side = |c: f64, v: f64, low: f64, high: f64| {
                if v.abs() < 1e-9 { f64::INFINITY } else { ((if v > 0.0 { high } else { low }) - c) / v }
            };
            side(middle.x, direction.x, square.x0, square.x1).min(side(middle.y, direction.y, square.y0, square.y1))
        };
        Line::new(middle - along * exit(-along), middle + along * exit(along))
    };
    // Those that cut off a corner alone are left out.
    (-count..=count).map(clipped).filter(|l| l.p0.distance(l.p1) > 3.0 * gap && square.contains(l.eval(0.5))).collect()
}

#[test]
fn hatching_stays_separate_lines() {
    let cases = pairs(&pairs(&[1.6, 2.0, 3.0, 4.0], &[0.0, 30.0, 45.0, 70.0]), &WIDTHS[..3]);
    // Paper between the lines.
    let cases: Vec<_> = cases.into_iter().filter(|&((gap, _), width)| (gap - 1.0) * width >= 1.5).collect();
    figures(
        "free hatching",
        1.0,
        &cases,
        |&((gap, angle), width)| {
            page(hatching(CENTER, 44.0, angle, gap * width).iter().map(|l| line(l.p0, l.p1, width)).collect())
        },
        |&((_, _), width), truth, traced| {
            same_strokes(truth, traced, 0.1 * width + 0.6)?;
            straight(traced, 0.5)
        },
    );
}

fn framed_hatching(&((gap, angle), width): &((f64, f64), f64)) -> Drawing {
    let corners = [(-44.0, -44.0), (44.0, -44.0), (44.0, 44.0), (-44.0, 44.0)].map(|c| CENTER + Vec2::from(c));
    let mut strokes = vec![polyline(&corners, true, width)];
    strokes.extend(hatching(CENTER, 44.0, angle, gap * width).iter().map(|l| line(l.p0, l.p1, width)));
    page(strokes)
}

/// The frame, drawn first, is one stroke of four straight lines.
fn has_its_frame(width: f64, truth: &Drawing, traced: &Drawing) -> Result<(), String> {
    let frame = like_stroke(&truth.strokes[0], traced, 0.3 * width + 0.5)?;
    ensure(straight_pieces(&frame.centreline) == Some(4), || "the frame is not four straight lines".into())
}

#[test]
fn hatching_in_a_frame_ends_on_the_frame() {
    let cases = pairs(&pairs(&[2.0, 3.0, 4.0], &[30.0, 45.0, 70.0]), &WIDTHS[..3]);
    figures("hatching in a frame", 0.518, &cases, framed_hatching, |&(_, width), truth, traced| {
        same_strokes(truth, traced, 0.3 * width + 0.5)?;
        has_its_frame(width, truth, traced)
    });
}

#[test]
fn a_frame_of_hatching_in_pencil_is_straight() {
    let cases = pairs(&pairs(&[2.5, 3.5], &[30.0, 45.0, 60.0]), &WIDTHS[..3]);
    figures_on(
        "frames of hatching in pencil",
        0.333,
        &cases,
        framed_hatching,
        |&((gap, angle), width), drawing| pencil(drawing, gap + angle + width),
        |&(_, width), truth, traced| has_its_frame(width, truth, traced),
    );
}

/// A shaft with an open head at its end: half its opening in degrees, its size in line widths.
fn open_arrow((((opening, size), width), turn): (((f64, f64), f64), f64)) -> Drawing {
    let tip = polar(CENTER, turn, 46.0);
    let barb = |side: f64| polar(tip, turn + 180.0 + side * opening, size * width);
    page(vec![line(polar(CENTER, turn, -50.0), tip, width), polyline(&[barb(-1.0), tip, barb(1.0)], false, width)])
}

/// The shaft is straight, the head is there, and ends are within so many pixels of where they were drawn.
fn is_open_arrow(width: f64, truth: &Drawing, traced: &Drawing, tolerance: f64) -> Result<(), String> {
    let tip = truth.strokes[0].centreline.end();
    let shaft = like_stroke(&truth.strokes[0], traced, 0.5 * width + 0.5)?;
    let bowed = bow(&shaft.centreline);
    ensure(bowed <= 0.6, || format!("the shaft bows by {bowed:.2}"))?;
    // The head is one stroke or two.
    ensure((2..=3).contains(&traced.strokes.len()), || format!("{} strokes", traced.strokes.len()))?;
    let head = &truth.strokes[1].centreline;
    let free = [truth.strokes[0].centreline.start(), head.start(), head.end()];
    let off = free.iter().map(|p| nearest_end(*p, traced)).fold(0.0, f64::max);
    ensure(off <= tolerance, || format!("an end is off by {off:.2}"))?;
    let apart = apart(&lines(truth), &lines(traced));
    ensure(apart.max <= 0.5 * width + 0.5, || format!("{apart:.3?}"))?;
    let off = nearest_end(tip, traced);
    ensure(off <= 0.5 * width + 0.5, || format!("the nearest end to the tip is {off:.2} from it"))
}

#[test]
fn an_open_arrow_head_is_a_corner_at_the_end_of_a_shaft() {
    let cases = pairs(&pairs(&pairs(&[15.0, 20.0, 30.0, 45.0], &[5.0, 8.0]), &WIDTHS), &[0.0, 17.0, 90.0, 225.0]);
    let rule = |&((_, width), _): &_, truth: &_, traced: &_| is_open_arrow(width, truth, traced, 0.75);
    figures("open arrow heads", 0.82, &cases, |case| open_arrow(*case), rule);
}

#[test]
fn an_open_arrow_head_in_pencil_is_a_corner_at_the_end_of_a_shaft() {
    let cases = pairs(&pairs(&pairs(&[20.0, 30.0, 45.0], &[5.0, 8.0]), &WIDTHS[1..]), &[0.0, 17.0, 90.0, 225.0]);
    figures_on(
        "open arrow heads in pencil",
        0.791,
        &cases,
        |case| open_arrow(*case),
        |&((_, width), turn), drawing| pencil(drawing, width + turn),
        |&((_, width), _), truth, traced| is_open_arrow(width, truth, traced, 1.25),
    );
}

/// A triangle with its tip at a point.
fn head(tip: Point, degrees: f64, length: f64, opening: f64) -> BezPath {
    let barb = |side: f64| polar(tip, degrees + 180.0 + side * opening, length / opening.to_radians().cos());
    let mut path = BezPath::new();
    path.move_to(tip);
    path.line_to(barb(-1.0));
    path.line_to(barb(1.0));
    path.close_path();
    path
}

#[test]
fn a_filled_arrow_head_is_a_filled_region_at_the_end_of_a_shaft() {
    let cases = pairs(&pairs(&pairs(&[15.0, 20.0, 30.0], &[7.0, 10.0]), &WIDTHS[..3]), &[0.0, 17.0, 90.0, 225.0]);
    // Heads that are clearly wider than their shaft.
    let cases: Vec<_> = cases
        .into_iter()
        .filter(|&(((opening, size), _), _)| 2.0 * size * f64::to_radians(opening).tan() >= 4.0)
        .collect();
    figures(
        "filled arrow heads",
        0.7,
        &cases,
        |&(((opening, size), width), turn)| {
            let tip = polar(CENTER, turn, 50.0);
            let mut drawing =
                page(vec![line(polar(CENTER, turn, -50.0), polar(tip, turn, -0.7 * size * width), width)]);
            // A second line says what a line is here.
            drawing.strokes.push(line(
                polar(CENTER, turn + 90.0, 45.0),
                polar(polar(CENTER, turn + 90.0, 45.0), turn, 30.0),
                width,
            ));
            drawing.fills.push(Fill { outline: head(tip, turn, size * width, opening), color: Color::BLACK });
            drawing
        },
        |&(((_, size), width), turn), truth, traced| {
            ensure(traced.fills.len() == 1, || format!("{} filled regions", traced.fills.len()))?;
            ensure(traced.strokes.len() == 2, || format!("{} strokes", traced.strokes.len()))?;
            straight(traced, 0.6)?;
            let (drawn, found) = (&truth.fills[0].outline, &traced.fills[0].outline);
            let area = found.area().abs() / drawn.area().abs();
            ensure((area - 1.0).abs() <= 0.2, || format!("{area:.2} of the head's area"))?;
            let apart = apart(from_ref(found), from_ref(drawn));
            ensure(apart.mean <= 0.6, || format!("the head's outline: {apart:.3?}"))?;
            // The shaft begins where it was drawn and reaches the head.
            let (start, along) = (truth.strokes[0].centreline.start(), Vec2::from_angle(f64::to_radians(turn)));
            let ends = traced.strokes.iter().map(|s| [s.centreline.start(), s.centreline.end()]);
            let shaft = ends.min_by(|a, b| nearest(start, a).total_cmp(&nearest(start, b))).ok_or("no shaft")?;
            ensure(nearest(start, &shaft) <= 0.5, || format!("its end is off by {:.2}", nearest(start, &shaft)))?;
            let reached = shaft.iter().map(|p| (*p - start).dot(along)).fold(0.0, f64::max);
            let short = 100.0 - size * width - reached;
            ensure(short <= 0.5 * width + 0.5, || format!("the shaft stops {short:.2} short of its head"))
        },
    );
}

/// An upright rectangle about the page's middle.
fn rectangle(shift: Vec2, width: f64) -> Drawing {
    let corners = [(-44.0, -30.0), (44.0, -30.0), (44.0, 30.0), (-44.0, 30.0)].map(|c| CENTER + Vec2::from(c) + shift);
    page(vec![polyline(&corners, true, width)])
}

/// One closed stroke of four lines that keep to the axes exactly and meet at right angles.
fn upright(truth: &Drawing, traced: &Drawing, tolerance: f64) -> Result<(), String> {
    same_strokes(truth, traced, tolerance)?;
    let Centreline::Path { segments, closed: true } = &traced.strokes[0].centreline else { return Err("open".into()) };
    ensure(segments.len() == 4, || format!("{} pieces", segments.len()))?;
    let off_axis = |s: &Segment| match s {
        Segment::Line(l) => (l.p1.x - l.p0.x).abs().min((l.p1.y - l.p0.y).abs()),
        _ => f64::INFINITY,
    };
    let off = segments.iter().map(off_axis).fold(0.0, f64::max);
    // Exactly at any precision that is written, but for the arithmetic of scaling the line image back to the scan.
    ensure(off < 5e-5, || format!("a side is off its axis by {off:.1e}"))
}

#[test]
fn an_upright_rectangle_keeps_to_the_axes_exactly() {
    let shifts = [Vec2::ZERO, Vec2::new(0.5, 0.5), Vec2::new(0.27, 0.81), Vec2::new(0.1, 0.6)];
    let cases = pairs(&[1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0], &shifts);
    figures(
        "upright rectangles",
        0.972,
        &cases,
        |&(width, shift)| rectangle(shift, width),
        |&(width, _), truth, traced| upright(truth, traced, 0.05 * width + 0.35),
    );
}

#[test]
fn an_upright_rectangle_in_pencil_keeps_to_the_axes_exactly() {
    let shifts = [Vec2::ZERO, Vec2::new(0.5, 0.5), Vec2::new(0.27, 0.81), Vec2::new(0.1, 0.6)];
    let cases = pairs(&[2.0, 3.0, 4.0, 6.0, 8.0], &shifts);
    figures_on(
        "upright rectangles in pencil",
        0.85,
        &cases,
        |&(width, shift)| rectangle(shift, width),
        |&(width, shift), drawing| pencil(drawing, width + shift.x),
        |&(width, _), truth, traced| upright(truth, traced, 0.05 * width + 0.6),
    );
}

/// An upright rectangle about the middle whose corners are rounded.
fn rounded(shift: Vec2, radius: f64, width: f64) -> Drawing {
    let (inner, middle) = (Vec2::new(44.0 - radius, 30.0 - radius), CENTER + shift);
    let mut segments = Vec::new();
    let mut at = middle + Vec2::new(-inner.x, -30.0);
    for (x, y, start) in [(1.0, -1.0, -90.0), (1.0, 1.0, 0.0), (-1.0, 1.0, 90.0), (-1.0, -1.0, 180.0)] {
        let centre = middle + Vec2::new(x * inner.x, y * inner.y);
        segments.push(Segment::Line(Line::new(at, polar(centre, start, radius))));
        let start_angle = f64::to_radians(start);
        segments.push(Segment::Arc(Arc::new(centre, (radius, radius), start_angle, FRAC_PI_2, 0.0)));
        at = polar(centre, start + 90.0, radius);
    }
    let centreline = Centreline::Path { segments, closed: true };
    page(vec![Stroke::new(centreline, width)])
}

/// One exact rectangle with corners of about the radius.
fn is_rounded(radius: f64, truth: &Drawing, traced: &Drawing, tolerance: f64) -> Result<(), String> {
    same_strokes(truth, traced, tolerance)?;
    let rect = traced.strokes[0].centreline.as_rounded_rect(1e-6).ok_or("no rectangle")?;
    let found = rect.radii().top_left;
    // What moves the middle of a corner by less than the tolerance.
    ensure((found - radius).abs() <= tolerance / (SQRT_2 - 1.0), || format!("a radius of {found:.2} for {radius}"))
}

#[test]
fn a_rectangle_with_round_corners_is_one_exactly() {
    let shifts = [Vec2::ZERO, Vec2::new(0.5, 0.5), Vec2::new(0.27, 0.81)];
    let cases = pairs(&pairs(&[2.0, 3.0, 4.5, 7.0, 10.0], &[12.0, 18.0, 24.0, 29.9]), &shifts);
    figures(
        "round rectangles",
        1.0,
        &cases,
        |&((width, radius), shift)| rounded(shift, radius, width),
        |&((width, radius), _), truth, traced| is_rounded(radius, truth, traced, 0.02 * width + 0.2),
    );
}

#[test]
fn a_rectangle_with_round_corners_in_pencil_is_one_exactly() {
    let cases = pairs(&pairs(&[3.0, 4.5, 7.0], &[12.0, 18.0, 24.0]), &[Vec2::ZERO, Vec2::new(0.27, 0.81)]);
    figures_on(
        "round rectangles in pencil",
        1.0,
        &cases,
        |&((width, radius), shift)| rounded(shift, radius, width),
        |&((width, radius), shift), drawing| pencil(drawing, width + radius + shift.x),
        |&((width, radius), _), truth, traced| is_rounded(radius, truth, traced, 0.05 * width + 0.6),
    );
}

#[test]
fn a_long_pencil_line_does_not_wobble() {
    let cases = pairs(&steps(0.0, 175.0, 12.5), &[2.0, 3.0, 4.5, 7.0]);
    figures_on(
        "long pencil lines",
        0.983,
        &cases,
        |&(angle, width)| {
            let center = Point::new(150.0, 150.0);
            sheet(300, 300, vec![line(polar(center, angle, -138.0), polar(center, angle, 138.0), width)])
        },
        |&(angle, width), drawing| pencil(drawing, angle + width),
        |_, truth, traced| {
            ensure(traced.strokes.len() == 1, || format!("{} strokes", traced.strokes.len()))?;
            let pieces = straight_pieces(&traced.strokes[0].centreline);
            ensure(pieces == Some(1), || format!("{pieces:?} straight pieces"))?;
            same_strokes(truth, traced, 0.75)?;
            let body = common::compare::body_apart(truth, traced, 2.0);
            ensure(body.mean <= 0.15, || format!("{body:.3?}"))
        },
    );
}

#[test]
fn a_line_that_is_all_but_level_is_one_line() {
    // What looks at four rows of a pixel draws such lines in stairs.
    let slopes = [0.1, 0.2, 0.35, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 4.0];
    let cases = pairs(&pairs(&slopes, &[0.0, 90.0]), &[2.0, 2.5, 3.0, 4.0, 6.0]);
    figures_on(
        "lines all but level",
        0.89,
        &cases,
        |&((slope, turn), width)| {
            let (center, angle) = (Point::new(150.0, 150.2), slope + turn);
            sheet(300, 300, vec![line(polar(center, angle, -138.0), polar(center, angle, 138.0), width)])
        },
        |_, drawing| rendered(drawing),
        |&(_, width), truth, traced| {
            same_strokes(truth, traced, 0.1 * width + 0.5)?;
            let pieces = straight_pieces(&traced.strokes[0].centreline);
            ensure(pieces == Some(1), || format!("{pieces:?} straight pieces"))?;
            let body = common::compare::body_apart(truth, traced, 2.0);
            // A line this near to an axis may be put on it.
            ensure(body.max <= 0.3f64.max(0.1 * width), || format!("{body:.3?}"))
        },
    );
}

#[test]
fn a_belt_round_two_rings_leaves_each_once_around() {
    let cases = pairs(&pairs(&[50.0, 57.5, 65.0], &steps(0.0, 67.5, 22.5)), &WIDTHS);
    figures_on(
        "belts",
        0.979,
        &cases,
        |&((radius, turn), width)| {
            let at = frame(Point::new(160.0, 160.0), turn);
            let (small, apart) = (35.0, 80.0);
            // The outer tangents touch both rings at this angle from the line of centres.
            let touch = f64::acos((radius - small) / (2.0 * apart));
            let tangent = |side: f64| {
                let out = Vec2::new(touch.cos(), side * touch.sin());
                line(at(-apart + radius * out.x, radius * out.y), at(apart + small * out.x, small * out.y), width)
            };
            sheet(
                320,
                320,
                vec![
                    circle(at(-apart, 0.0), radius, width),
                    circle(at(apart, 0.0), small, width),
                    tangent(1.0),
                    tangent(-1.0),
                ],
            )
        },
        |&((radius, turn), width), drawing| pencil(drawing, radius + turn + width),
        |_, truth, traced| same_length(truth, traced, 0.06),
    );
}
