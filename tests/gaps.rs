//! Lines with gaps in them, and dashes.

mod common;

use common::compare::{apart, bow, common_ink, lines};
use common::draw::{arc, line, on_paper, polar, polyline, rendered, scan, scan_of, sheet, trace_under};
use common::paper::Paper;
use common::sweep::{ensure, pairs, steps, sweep};
use fieldtrace::drawing::{Dashes, Drawing, Stroke};
use fieldtrace::load::Scan;
use fieldtrace::options::{Dashing, Options};
use fieldtrace::pipeline::Vectorizer;
use fieldtrace::render::render;
use fieldtrace::write::graph_json::{from_json, to_json};
use fieldtrace::write::{WriteOptions, to_svg};
use kurbo::{BezPath, ParamCurve, ParamCurveArclen, Point, RoundedRect, Shape, Vec2};

const CENTER: Point = Point::new(80.3, 79.8);

fn page(strokes: Vec<Stroke>) -> Drawing {
    sheet(160, 160, strokes)
}

fn traced(scan: &Scan, gap: Option<f64>, dashes: Dashing) -> Drawing {
    let options = Options::default().with(|o| {
        o.gap = gap;
        o.dashes = dashes;
    });
    trace_under(options, scan)
}

/// A line in two parts with so much paper between them, in line widths.
fn broken(angle: f64, width: f64, paper: f64) -> Vec<Stroke> {
    let half = 0.5 * (paper + 1.0) * width;
    let at = |reach: f64| polar(CENTER, angle, reach);
    vec![line(at(-60.0), at(-half), width), line(at(half), at(60.0), width)]
}

/// A line as one stroke.
fn whole(result: &Drawing, angle: f64, width: f64) -> Result<(), String> {
    let truth = page(vec![line(polar(CENTER, angle, -60.0), polar(CENTER, angle, 60.0), width)]);
    ensure(result.strokes.len() == 1, || format!("{} strokes", result.strokes.len()))?;
    let apart = apart(&lines(&truth), &lines(result));
    ensure(apart.max < 2.0 && apart.mean < 0.4, || format!("{apart:.2?}"))?;
    ensure(bow(&result.strokes[0].centreline) < 0.6, || "it bows".into())
}

#[test]
fn a_pencil_line_goes_on_behind_a_short_break() {
    let cases = pairs(&pairs(&steps(0.0, 170.0, 17.0), &[3.0, 4.5]), &[0.6, 1.0]);
    sweep("breaks in pencil", 1.0, &cases, |&((angle, width), paper)| {
        let scan = on_paper(&page(broken(angle, width, paper)), Paper::PENCIL, angle as u64);
        whole(&traced(&scan, None, Dashing::Keep), angle, width)
    });
}

#[test]
fn a_clean_render_keeps_apart_what_it_shows_apart() {
    let cases = pairs(&pairs(&steps(0.0, 170.0, 17.0), &[2.0, 4.0]), &[0.5, 1.0, 2.0]);
    sweep("gaps that were meant", 1.0, &cases, |&((angle, width), paper)| {
        let result = traced(&scan(&page(broken(angle, width, paper))), None, Dashing::Keep);
        ensure(result.strokes.len() == 2, || format!("{} strokes", result.strokes.len()))
    });
    sweep("gaps bridged when asked for", 1.0, &cases, |&((angle, width), paper)| {
        let scan = scan(&page(broken(angle, width, paper)));
        whole(&traced(&scan, Some(2.5), Dashing::Keep), angle, width)?;
        let apart = traced(&scan, Some(0.6 * paper), Dashing::Keep).strokes.len();
        ensure(apart == 2, || format!("{apart} strokes where less was asked for"))
    });
}

#[test]
fn arcs_are_bridged_along_their_course_and_circles_close() {
    sweep("gaps in circles", 1.0, &pairs(&steps(0.0, 340.0, 20.0), &[20.0, 40.0]), |&(angle, radius)| {
        let (width, paper) = (3.0, 1.5);
        let opening = (paper + 1.0) * width / radius;
        let strokes = vec![arc(CENTER, radius, angle.to_radians(), 2.0 * std::f64::consts::PI - opening, width)];
        let result = traced(&scan(&page(strokes)), Some(2.0), Dashing::Keep);
        let [Stroke { centreline, .. }] = &result.strokes[..] else { return Err("several strokes".into()) };
        ensure(centreline.is_closed(), || "it is open".into())?;
        let truth = page(vec![common::draw::circle(CENTER, radius, width)]);
        let apart = apart(&lines(&truth), &lines(&result));
        ensure(apart.max < 0.5, || format!("{apart:.2?}"))
    });
}

#[test]
fn ends_that_do_not_continue_one_another_stay_ends() {
    let cases = pairs(&steps(0.0, 170.0, 17.0), &[(0.0, 40.0), (0.0, -70.0), (0.9, 0.0), (-1.2, 10.0)]);
    sweep("ends side by side or at an angle", 1.0, &cases, |&(angle, (shift, turn))| {
        let width = 4.0;
        let mut strokes = broken(angle, width, 1.5);
        let aside = Vec2::from_angle(angle.to_radians()).turn_90() * (shift * width);
        let start = polar(CENTER, angle, 5.0) + aside;
        strokes[1] = line(start, polar(start, angle + turn, 50.0), width);
        for (scan, gap) in [(scan(&page(strokes.clone())), Some(3.0)), (on_paper(&page(strokes), Paper::INK, 5), None)]
        {
            let count = traced(&scan, gap, Dashing::Join).strokes.len();
            ensure(count == 2, || format!("{count} strokes with a gap of {gap:?}"))?;
        }
        Ok(())
    });
}

#[test]
fn hatching_stays_separate_lines() {
    sweep("hatching", 1.0, &pairs(&steps(0.0, 165.0, 15.0), &[2.5, 4.0]), |&(angle, spacing)| {
        let width = 2.0;
        let along = Vec2::from_angle(angle.to_radians());
        let row = |k: i32| CENTER + along.turn_90() * (spacing * width * f64::from(k));
        let hatch = |k: i32| line(row(k) - along * 25.0, row(k) + along * 25.0, width);
        let strokes: Vec<Stroke> = (-4..=4).map(hatch).collect();
        let result = traced(&scan(&page(strokes)), Some(2.0), Dashing::Join);
        ensure(result.strokes.len() == 9, || format!("{} strokes", result.strokes.len()))
    });
}

/// A dashed line from 70 pixels before the centre to 70 pixels behind it.
fn dashed(angle: f64, width: f64, dashes: Dashes) -> Stroke {
    let stroke = line(polar(CENTER, angle, -70.0), polar(CENTER, angle, 70.0), width);
    Stroke { dashes: Some(dashes), ..stroke }
}

const PATTERNS: [(f64, f64); 4] = [(4.0, 4.0), (8.0, 4.0), (6.0, 3.0), (3.0, 5.0)];

/// Every dash of a line of 140 pixels is a stroke, but for one that its end may cut off.
fn all_kept(scan: &Scan, period: f64) -> Result<(), String> {
    let count = (140.0 / period).ceil() as usize;
    let kept = traced(scan, None, Dashing::Keep).strokes.len();
    ensure(kept.abs_diff(count) <= 1, || format!("{kept} of {count} dashes"))
}

#[test]
fn dashes_are_kept_or_joined() {
    let cases = pairs(&pairs(&steps(0.0, 165.0, 15.0), &[2.0, 3.0]), &PATTERNS);
    sweep("dashed lines", 1.0, &cases, |&((angle, width), (dash, gap))| {
        let truth = page(vec![dashed(angle, width, Dashes { dash: dash * width, gap: gap * width, offset: 0.0 })]);
        let scan = rendered(&truth);
        all_kept(&scan, (dash + gap) * width)?;
        let joined = traced(&scan, None, Dashing::Join);
        let [stroke] = &joined.strokes[..] else { return Err(format!("{} strokes", joined.strokes.len())) };
        let found = stroke.dashes.ok_or("no dashes")?;
        let off = (found.dash - dash * width).abs().max((found.gap - gap * width).abs());
        ensure(off < 0.8, || format!("{found:.2?}"))?;
        ensure(common_ink(&truth, &joined) > 0.8, || format!("{:.2} of the ink", common_ink(&truth, &joined)))
    });
}

#[test]
fn dashes_on_paper_are_not_breaks() {
    let cases = pairs(&pairs(&steps(0.0, 160.0, 20.0), &[3.0, 4.0]), &[(6.0, 2.2), (5.0, 3.0)]);
    sweep("dashes on paper", 1.0, &cases, |&((angle, width), (dash, gap))| {
        let truth = page(vec![dashed(angle, width, Dashes { dash: dash * width, gap: gap * width, offset: 0.0 })]);
        let paper = scan_of(Paper::INK.scan(&rendered(&truth).gray, angle as u64));
        all_kept(&paper, (dash + gap) * width)?;
        let joined = traced(&paper, None, Dashing::Join).strokes.len();
        ensure(joined == 1, || format!("{joined} strokes when joined"))
    });
}

#[test]
fn dashes_with_a_line_width_of_paper_between_them_are_not_breaks() {
    let cases = pairs(&pairs(&steps(0.0, 160.0, 20.0), &[3.0, 4.0]), &[(6.0, 2.0), (4.0, 2.0)]);
    sweep("narrow gaps between dashes", 1.0, &cases, |&((angle, width), (dash, gap))| {
        let truth = page(vec![dashed(angle, width, Dashes { dash: dash * width, gap: gap * width, offset: 0.0 })]);
        let paper = scan_of(Paper::INK.scan(&rendered(&truth).gray, angle as u64));
        all_kept(&paper, (dash + gap) * width)
    });
}

#[test]
fn long_and_short_dashes_in_turns_are_not_breaks() {
    // Lengths of a long dash, a short one and the paper between them, in line widths.
    let cases = pairs(&pairs(&steps(0.0, 160.0, 20.0), &[3.0, 4.0]), &[(7.0, 1.5, 1.2), (9.0, 2.0, 1.4)]);
    sweep("centre lines on paper", 1.0, &cases, |&((angle, width), (long, short, paper))| {
        let (mut strokes, mut at) = (Vec::new(), -70f64);
        while at < 70.0 {
            for dash in [long, short] {
                let end = (at + dash * width).min(70.0);
                if end - at > width {
                    strokes.push(line(polar(CENTER, angle, at), polar(CENTER, angle, end), width));
                }
                at = end + (paper + 1.0) * width;
            }
        }
        let truth = page(strokes);
        let scan = scan_of(Paper::INK.scan(&rendered(&truth).gray, angle as u64));
        for dashes in [Dashing::Keep, Dashing::Join] {
            let kept = traced(&scan, None, dashes).strokes.len();
            ensure(kept == truth.strokes.len(), || format!("{kept} of {} dashes, {dashes:?}", truth.strokes.len()))?;
        }
        Ok(())
    });
}

#[test]
fn a_dashed_circle_is_one_closed_stroke() {
    sweep("dashed circles", 1.0, &pairs(&steps(0.0, 80.0, 20.0), &[10, 16]), |&(angle, count)| {
        let (radius, width) = (50.0, 3.0);
        let turn = 2.0 * std::f64::consts::PI / f64::from(count);
        let dash = |k: i32| arc(CENTER, radius, angle.to_radians() + turn * f64::from(k), 0.55 * turn, width);
        let truth = page((0..count).map(dash).collect());
        let joined = traced(&scan(&truth), None, Dashing::Join);
        let [stroke] = &joined.strokes[..] else { return Err(format!("{} strokes", joined.strokes.len())) };
        ensure(stroke.centreline.is_closed() && stroke.dashes.is_some(), || "not dashed and closed".into())?;
        let period = stroke.dashes.map_or(0.0, |d| d.dash + d.gap);
        ensure((period - radius * turn).abs() < 0.3, || format!("a period of {period:.2}"))?;
        let common = common_ink(&truth, &joined);
        ensure(common > 0.85, || format!("{common:.2} of the ink"))
    });
}

#[test]
fn a_dashed_rectangle_with_round_corners_keeps_its_dashes_where_they_are() {
    sweep("dashed rectangles", 0.875, &pairs(&steps(0.0, 14.0, 2.0), &[30.0, 40.0, 48.0]), |&(start, radius)| {
        let rect = RoundedRect::new(20.0, 30.0, 140.0, 130.0, radius);
        let length = rect.perimeter(1e-3);
        let (count, dash) = (30.0, 0.55 * length / 30.0);
        // Each dash as a line of its own, so that what is drawn owes nothing to dash arrays.
        let at = |s: f64| point_along(&rect.to_path(1e-3), s.rem_euclid(length));
        let piece = |k: i32| {
            let from = start + f64::from(k) * length / count;
            let points: Vec<Point> = (0..=16).map(|i| at(from + dash * f64::from(i) / 16.0)).collect();
            polyline(&points, false, 3.0)
        };
        let truth = page((0..count as i32).map(piece).collect());
        let joined = traced(&scan(&truth), None, Dashing::Join);
        let [stroke] = &joined.strokes[..] else { return Err(format!("{} strokes", joined.strokes.len())) };
        ensure(stroke.centreline.is_closed() && stroke.dashes.is_some(), || "not dashed and closed".into())?;
        let common = common_ink(&truth, &joined);
        ensure(common > 0.85, || format!("{common:.2} of the ink"))
    });
}

/// The point of a path at a distance from its start.
fn point_along(path: &BezPath, distance: f64) -> Point {
    let mut left = distance;
    for piece in path.segments() {
        let length = piece.arclen(1e-3);
        if left <= length {
            return piece.eval(piece.inv_arclen(left, 1e-3));
        }
        left -= length;
    }
    path.segments().next().expect("a path").start()
}

#[test]
fn uneven_pieces_are_no_dashes() {
    sweep("uneven pieces", 1.0, &steps(0.0, 165.0, 15.0), |&angle| {
        let at = |reach: f64| polar(CENTER, angle, reach);
        let pieces = [(-70.0, -62.0), (-50.0, -20.0), (-12.0, -6.0), (2.0, 30.0), (52.0, 70.0)];
        let strokes = pieces.map(|(a, b)| line(at(a), at(b), 2.0)).to_vec();
        let result = traced(&scan(&page(strokes)), None, Dashing::Join);
        ensure(result.strokes.len() == 5, || format!("{} strokes", result.strokes.len()))
    });
}

#[test]
fn a_pattern_survives_the_way_through_files() {
    let pattern = Dashes { dash: 12.0, gap: 8.0, offset: 5.0 };
    let truth = page(vec![dashed(20.0, 3.0, pattern)]);
    let options = Options::default().with(|o| o.dashes = Dashing::Join);
    let vectorizer = Vectorizer::new(options).unwrap();
    let graph = vectorizer.graph(&rendered(&truth), &mut ()).unwrap();
    let read = from_json("graph.json", to_json(&graph).as_bytes()).unwrap();
    let drawing = vectorizer.draw(&read, &mut ()).unwrap();
    assert!(common_ink(&truth, &drawing) > 0.85, "{:?}", drawing.strokes);
    let svg = to_svg(&drawing, &WriteOptions::default());
    let tree = usvg::Tree::from_str(&svg, &usvg::Options::default()).unwrap();
    let mut pixmap = tiny_skia::Pixmap::new(160, 160).unwrap();
    resvg::render(&tree, tiny_skia::Transform::identity(), &mut pixmap.as_mut());
    let ink = render(&truth);
    let (mut common, mut all) = (0.0, 0.0);
    for (p, t) in pixmap.pixels().iter().zip(ink.data()) {
        let drawn = f64::from(p.alpha()) / 255.0;
        common += drawn.min(f64::from(*t));
        all += drawn.max(f64::from(*t));
    }
    assert!(common / all > 0.85, "{}: {svg}", common / all);
}

#[test]
fn a_pattern_seen_from_the_other_end_is_the_same_pattern() {
    sweep("reversed patterns", 1.0, &pairs(&steps(0.0, 19.0, 1.0), &[97.0, 100.0, 111.5]), |&(offset, length)| {
        let pattern = Dashes { dash: 12.0, gap: 8.0, offset };
        let reversed = pattern.reversed(length);
        let on = |d: Dashes, s: f64| (s + d.offset).rem_euclid(20.0) < 12.0;
        let wrong = steps(0.25, length - 0.25, 0.5).into_iter().find(|&s| on(pattern, s) != on(reversed, length - s));
        ensure(wrong.is_none(), || format!("it differs at {wrong:?}"))
    });
}
