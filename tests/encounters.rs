//! How lines meet, beyond the plain crossings, tees and corners of `junctions.rs`: sweeps with known truth.
//!
//! Floors below one are the shares that were measured, less one case, for the network's last digits depend on the
//! processor: `cargo test --test encounters -- --nocapture` prints what fails. Each sweep leaves a sheet in `tmp/sheets` of
//! Cargo's target directory, with what was drawn beside what was traced.

mod common;

use common::compare::{body_apart, bow, straight_pieces};
use common::draw::{arc, circle, cubic, line, polar, polyline, sheet};
use common::figures::{figures, like_stroke, nearest, same_length, same_nodes, same_strokes, straight};
use common::sweep::{ensure, pairs, steps};
use fieldtrace::drawing::{Centreline, Drawing, Stroke};
use fieldtrace::metrics::nodes;
use kurbo::{Point, Vec2};

const CENTER: Point = Point::new(60.0, 60.0);
const WIDTHS: [f64; 5] = [1.5, 3.0, 4.0, 6.0, 10.0];
const TURNS: [f64; 3] = [0.0, 17.0, 45.0];

/// Strokes on 120 x 120 pixels.
fn page(strokes: Vec<Stroke>) -> Drawing {
    sheet(120, 120, strokes)
}

/// A line through a point, at an angle in degrees.
fn bar(center: Point, angle: f64, reach: f64, width: f64) -> Stroke {
    line(polar(center, angle, -reach), polar(center, angle, reach), width)
}

/// An arc that leaves a line at an angle in degrees along its tangent, to one side (1) or the other (-1).
fn leaving(from: Point, angle: f64, radius: f64, side: f64, width: f64) -> Stroke {
    let center = polar(from, angle + side * 90.0, radius);
    arc(center, radius, (angle - side * 90.0).to_radians(), side * f64::min(50.0 / radius, 1.3), width)
}

/// How far a stroke may be off at a junction: the ink of two lines is one there.
fn slack(width: f64) -> f64 {
    0.25 * width + 0.5
}

#[test]
fn shallow_crossings_are_two_straight_strokes() {
    let cases = pairs(&pairs(&steps(10.0, 30.0, 4.0), &WIDTHS), &TURNS);
    figures(
        "shallow crossings",
        0.855,
        &cases,
        |&((between, width), turn)| {
            page(vec![bar(CENTER, turn, 54.0, width), bar(CENTER, turn + between, 54.0, width)])
        },
        |&((_, width), _), truth, traced| {
            same_strokes(truth, traced, slack(width))?;
            straight(traced, 0.6)
        },
    );
}

#[test]
fn a_crossing_beside_a_crossing_is_three_straight_strokes() {
    // Between the two crossings, in widths from centre to centre.
    let apart = [2.0, 2.5, 3.0, 4.0, 6.0];
    let slants = [(90.0, 90.0), (60.0, 60.0), (60.0, 120.0), (50.0, 90.0)];
    let cases = pairs(&pairs(&pairs(&apart, &slants), &WIDTHS[..4]), &TURNS);
    figures(
        "twin crossings",
        0.925,
        &cases,
        |&(((apart, slants), width), turn)| {
            let at = |side: f64| polar(CENTER, turn, side * 0.5 * apart * width);
            let first = bar(at(-1.0), turn + slants.0, 46.0, width);
            page(vec![bar(CENTER, turn, 54.0, width), first, bar(at(1.0), turn + slants.1, 46.0, width)])
        },
        |&((_, width), _), truth, traced| {
            same_strokes(truth, traced, slack(width))?;
            straight(traced, 0.6)
        },
    );
}

#[test]
fn three_lines_through_one_point_are_three_straight_strokes() {
    let gaps = [(60.0, 60.0), (45.0, 45.0), (30.0, 60.0), (40.0, 90.0), (30.0, 30.0)];
    let cases = pairs(&pairs(&gaps, &WIDTHS), &TURNS);
    figures(
        "three through a point",
        0.946,
        &cases,
        |&((gaps, width), turn)| {
            let angles = [turn, turn + gaps.0, turn + gaps.0 + gaps.1];
            page(angles.map(|angle| bar(CENTER, angle, 54.0, width)).to_vec())
        },
        |&((_, width), _), truth, traced| {
            same_strokes(truth, traced, slack(width))?;
            same_nodes(truth, traced, slack(width))?;
            straight(traced, 0.6)
        },
    );
}

#[test]
fn a_line_through_a_corner_stays_one_straight_stroke() {
    // The line's direction against the corner's middle: along its tip, slanted, or into the corner.
    let cases = pairs(&pairs(&pairs(&[60.0, 90.0, 120.0], &[90.0, 75.0, 0.0]), &WIDTHS), &TURNS);
    figures(
        "lines through corners",
        0.903,
        &cases,
        |&(((opening, slant), width), turn)| {
            let arm = |side: f64| polar(CENTER, turn + side * 0.5 * opening, 50.0);
            let corner = polyline(&[arm(-1.0), CENTER, arm(1.0)], false, width);
            page(vec![bar(CENTER, turn + slant, 50.0, width), corner])
        },
        |&((_, width), _), truth, traced| {
            let through = like_stroke(&truth.strokes[0], traced, slack(width))?;
            ensure(bow(&through.centreline) <= 0.6, || format!("it bows by {:.2}", bow(&through.centreline)))?;
            // The corner's arms may be one stroke or two.
            ensure(traced.strokes.len() <= 3, || format!("{} strokes", traced.strokes.len()))?;
            same_nodes(truth, traced, slack(width))?;
            near(truth, traced, width)
        },
    );
}

/// Near what was drawn everywhere, and nothing twice.
fn near(truth: &Drawing, traced: &Drawing, width: f64) -> Result<(), String> {
    let apart = body_apart(truth, traced, 1.5);
    ensure(apart.max <= slack(width) + 0.2, || format!("{apart:.3?}"))?;
    same_length(truth, traced, 0.06)
}

#[test]
fn a_corner_stays_sharp_at_every_opening() {
    let cases = pairs(&pairs(&steps(20.0, 160.0, 10.0), &WIDTHS), &TURNS);
    figures(
        "openings of corners",
        0.915,
        &cases,
        |&((opening, width), turn)| {
            let tip = CENTER - Vec2::from_angle(f64::to_radians(turn)) * 30.0;
            let arm = |side: f64| polar(tip, turn + side * 0.5 * opening, 60.0);
            page(vec![polyline(&[arm(-1.0), tip, arm(1.0)], false, width)])
        },
        |&((_, width), _), truth, traced| {
            same_strokes(truth, traced, 0.3 * width + 0.5)?;
            let pieces = straight_pieces(&traced.strokes[0].centreline);
            ensure(pieces == Some(2), || format!("{pieces:?} straight pieces"))
        },
    );
}

#[test]
fn corners_that_share_their_vertex_stay_two() {
    // Degrees between the arms that lie nearest, and by how much the arms opposite to them are off one line.
    let cases = pairs(&pairs(&pairs(&[20.0, 30.0, 40.0], &[18.0, 22.0, 26.0]), &WIDTHS[1..]), &TURNS);
    figures(
        "corners that share their vertex",
        0.935,
        &cases,
        |&(((between, bend), width), turn)| {
            let arm = |degrees: f64| polar(CENTER, turn + degrees, 52.0);
            let corner = |from: f64, to: f64| polyline(&[arm(from), CENTER, arm(to)], false, width);
            page(vec![corner(0.0, 90.0), corner(-between, 270.0 - bend)])
        },
        |&((_, width), _), truth, traced| same_strokes(truth, traced, 0.3 * width + 0.5),
    );
}

#[test]
fn a_corner_that_stands_on_a_line_is_one_stroke() {
    let cases = pairs(&pairs(&[40.0, 60.0, 90.0, 120.0], &WIDTHS[..4]), &TURNS);
    figures(
        "corners on a line",
        0.833,
        &cases,
        |&((opening, width), turn)| {
            let arm = |side: f64| polar(CENTER, turn + 90.0 + 0.5 * side * opening, 50.0);
            page(vec![bar(CENTER, turn, 54.0, width), polyline(&[arm(-1.0), CENTER, arm(1.0)], false, width)])
        },
        |&((_, width), _), truth, traced| same_strokes(truth, traced, slack(width)),
    );
}

#[test]
fn a_loop_that_crosses_itself_is_one_stroke() {
    // The flatter the loop, the shallower its crossing; below a spread of 20 there is none.
    let cases = pairs(&pairs(&[32.0, 40.0, 60.0], &WIDTHS), &[0.0, 30.0, 90.0, 200.0]);
    figures(
        "ribbon loops",
        0.783,
        &cases,
        |&((spread, width), turn)| {
            let at = |x: f64, y: f64| {
                let along = Vec2::from_angle(f64::to_radians(turn));
                let p = CENTER + along * x + along.turn_90() * y;
                (p.x, p.y)
            };
            page(vec![cubic(
                [at(-40.0, 40.0), at(2.0 * spread, -90.0), at(-2.0 * spread, -90.0), at(40.0, 40.0)],
                width,
            )])
        },
        |&((_, width), _), truth, traced| {
            same_strokes(truth, traced, slack(width))?;
            same_nodes(truth, traced, slack(width))
        },
    );
}

#[test]
fn a_stroke_that_ends_on_its_own_body_is_one_stroke_or_a_stem_on_a_ring() {
    // Like the digit 6: a stem that rounds into a circle and comes back to where the circle began. A circle that a line
    // touches with its end looks the same.
    let cases = pairs(&pairs(&[14.0, 20.0, 26.0], &WIDTHS), &[0.0, 60.0, 150.0, 270.0]);
    let middle = |turn: f64| polar(CENTER, turn, 20.0);
    figures(
        "sixes",
        0.983,
        &cases,
        |&((radius, width), turn)| {
            let ring = arc(middle(turn), radius, (turn + 90.0).to_radians(), std::f64::consts::TAU, width);
            let stem = line(
                polar(polar(middle(turn), turn + 90.0, radius), turn, -60.0),
                polar(middle(turn), turn + 90.0, radius),
                width,
            );
            page(vec![joined(stem, ring)])
        },
        |&((radius, width), _), truth, traced| {
            // Where the two lines part cannot be seen until there is paper between them.
            let parting = (2.0 * radius * width).sqrt();
            let rings = traced.strokes.iter().filter(|s| s.centreline.is_closed()).count();
            ensure(traced.strokes.len() == 1 + rings, || format!("{} strokes", traced.strokes.len()))?;
            let (a, b) = (nodes(truth, width), nodes(traced, width));
            ensure(b.junctions.len() == 1 && b.ends.len() == 1, || format!("{:?}", (b.junctions.len(), b.ends.len())))?;
            let off = nearest(a.ends[0], &b.ends);
            ensure(off <= 0.5, || format!("the end is off by {off:.2}"))?;
            let off = nearest(b.junctions[0], &a.junctions);
            ensure(off <= parting, || format!("the junction is off by {off:.2}"))?;
            let apart = body_apart(truth, traced, 1.5);
            ensure(apart.max <= 0.5 * width + 0.5, || format!("{apart:.3?}"))
        },
    );
}

#[test]
fn humps_of_a_coil_meet_at_the_tip_between_them() {
    let cases = pairs(&pairs(&[12.0, 18.0, 26.0], &WIDTHS), &TURNS);
    figures(
        "humps of a coil",
        0.688,
        &cases,
        |&((radius, width), turn)| {
            let tip = polar(CENTER, turn, -0.5 * radius);
            let hump = |side: f64, from: f64| {
                let middle = polar(tip, turn + side * 90.0, radius);
                arc(middle, radius, (turn + from).to_radians(), f64::to_radians(150.0), width)
            };
            page(vec![joined(hump(-1.0, -60.0), hump(1.0, -90.0))])
        },
        |&((_, width), _), truth, traced| same_strokes(truth, traced, slack(width)),
    );
}

#[test]
fn two_arcs_that_leave_a_line_at_one_point_leave_it_whole() {
    let cases = pairs(&pairs(&[30.0, 45.0, 70.0], &WIDTHS[..4]), &TURNS);
    figures(
        "twin arcs from a line",
        0.555,
        &cases,
        |&((radius, width), turn)| {
            let center = polar(CENTER, turn, -10.0);
            let arc = |side| leaving(center, turn, radius, side, width);
            page(vec![bar(center, turn, 42.0, width), arc(1.0), arc(-1.0)])
        },
        |&((radius, width), _), truth, traced| {
            let parting = (2.0 * radius * width).sqrt();
            ensure(traced.strokes.len() == 3, || format!("{} strokes", traced.strokes.len()))?;
            let line = like_stroke(&truth.strokes[0], traced, slack(width))?;
            ensure(bow(&line.centreline) <= 0.6, || format!("the line bows by {:.2}", bow(&line.centreline)))?;
            let (a, b) = (nodes(truth, width), nodes(traced, width));
            ensure(b.junctions.len() == 1, || format!("{} junctions", b.junctions.len()))?;
            let off = nearest(b.junctions[0], &a.junctions);
            ensure(off <= 0.5 * parting, || format!("the junction is off by {off:.2}"))
        },
    );
}

/// One stroke that goes on as the other.
fn joined(first: Stroke, second: Stroke) -> Stroke {
    let pieces = |stroke: &Stroke| match &stroke.centreline {
        Centreline::Path { segments, .. } => segments.clone(),
        _ => Vec::new(),
    };
    let segments = [pieces(&first), pieces(&second)].concat();
    Stroke { centreline: Centreline::Path { segments, closed: false }, ..first }
}

#[test]
fn a_circle_that_a_line_touches_stays_a_circle_and_a_line() {
    // How deep the line's ink reaches into the circle's, in widths: centreline on centreline, half, and ink to ink.
    let cases = pairs(&pairs(&pairs(&[14.0, 22.0, 32.0], &[1.0, 0.5, 0.0]), &WIDTHS), &TURNS);
    figures(
        "tangents of circles",
        0.992,
        &cases,
        |&(((radius, depth), width), turn)| {
            let middle = polar(CENTER, turn + 90.0, 0.5 * radius);
            let touch = polar(middle, turn - 90.0, radius + (1.0 - depth) * width);
            page(vec![circle(middle, radius, width), bar(touch, turn, 46.0, width)])
        },
        |&((_, width), _), truth, traced| {
            same_strokes(truth, traced, slack(width))?;
            let closed = traced.strokes.iter().filter(|s| s.centreline.is_closed()).count();
            ensure(closed == 1, || format!("{closed} closed strokes"))?;
            let line = like_stroke(&truth.strokes[1], traced, slack(width))?;
            ensure(bow(&line.centreline) <= 0.6, || format!("the line bows by {:.2}", bow(&line.centreline)))
        },
    );
}

#[test]
fn circles_that_touch_stay_circles() {
    let cases = pairs(&pairs(&pairs(&[14.0, 20.0], &[10.0, 18.0]), &WIDTHS[..4]), &TURNS);
    let cases = pairs(&cases, &[false, true]);
    figures(
        "circles that touch",
        0.989,
        &cases,
        |&((((large, small), width), turn), inside)| {
            let (large, small) = if inside { (large + 24.0, small) } else { (large, small) };
            let between = if inside { large - small } else { large + small };
            let center = polar(CENTER, turn, if inside { 0.0 } else { -0.5 * between });
            page(vec![circle(center, large, width), circle(polar(center, turn, between), small, width)])
        },
        |&(((_, width), _), _), truth, traced| {
            same_strokes(truth, traced, slack(width))?;
            let closed = traced.strokes.iter().filter(|s| s.centreline.is_closed()).count();
            ensure(closed == 2, || format!("{closed} closed strokes"))
        },
    );
}

#[test]
fn an_arc_that_leaves_a_line_is_a_branch_of_it() {
    let cases = pairs(&pairs(&[40.0, 70.0, 120.0], &WIDTHS), &[0.0, 17.0, 45.0, 100.0]);
    figures(
        "tangential merges",
        0.883,
        &cases,
        |&((radius, width), turn)| {
            let center = polar(CENTER, turn, -10.0);
            page(vec![bar(center, turn, 42.0, width), leaving(center, turn, radius, 1.0, width)])
        },
        |&((radius, width), _), truth, traced| {
            // Where the two part cannot be seen until there is paper between them.
            let parting = (2.0 * radius * width).sqrt();
            ensure(traced.strokes.len() == 2, || format!("{} strokes", traced.strokes.len()))?;
            let (a, b) = (nodes(truth, width), nodes(traced, width));
            ensure(b.junctions.len() == 1 && b.ends.len() == 3, || {
                format!("{} junctions and {} ends", b.junctions.len(), b.ends.len())
            })?;
            let off = a.ends.iter().map(|p| nearest(*p, &b.ends)).fold(0.0, f64::max);
            ensure(off <= 0.75, || format!("an end is off by {off:.2}"))?;
            let off = nearest(b.junctions[0], &a.junctions);
            ensure(off <= parting + width, || format!("the junction is off by {off:.2}"))?;
            let apart = body_apart(truth, traced, 1.5);
            ensure(apart.max <= 0.5 * width + 0.5, || format!("{apart:.3?}"))
        },
    );
}
