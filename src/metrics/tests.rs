//! Figures against closed forms.

use super::*;
use crate::drawing::{Centreline, Segment, Stroke};
use crate::write::{WriteOptions, to_svg};
use kurbo::{Circle, Line, Point, Vec2};

const SIZE: (usize, usize) = (240, 200);
const MIDDLE: Point = Point::new(120.0, 100.0);

fn drawing(paths: &[Vec<Point>], width: f64) -> Drawing {
    let mut drawing = Drawing::new(SIZE.0 as f64, SIZE.1 as f64);
    let segments = |p: &Vec<Point>| p.windows(2).map(|p| Segment::Line(Line::new(p[0], p[1]))).collect();
    let stroke = |p| Stroke::new(Centreline::Path { segments: segments(p), closed: false }, width);
    drawing.strokes = paths.iter().map(stroke).collect();
    drawing
}

fn circle(radius: f64) -> Drawing {
    let mut drawing = drawing(&[], 3.0);
    let centreline = Centreline::Circle(Circle::new(MIDDLE, radius));
    drawing.strokes.push(Stroke::new(centreline, 3.0));
    drawing
}

/// A straight line through a point, at an angle in degrees. Lengths in these tests are none of a whole number of steps,
/// so that rounding does not change the number of samples.
fn line(centre: Point, degrees: f64, length: f64) -> Vec<Point> {
    let half = Vec2::from_angle(degrees.to_radians()) * (0.5 * length);
    vec![centre - half, centre + half]
}

fn truth(drawing: &Drawing) -> Truth {
    Truth::new(drawing, SIZE).unwrap()
}

fn svg(drawing: &Drawing) -> String {
    to_svg(drawing, &WriteOptions { precision: 6, ..WriteOptions::default() })
}

fn score(true_strokes: &Drawing, traced: &Drawing) -> LineScore {
    truth(true_strokes).score(&svg(traced)).unwrap()
}

fn close(a: f64, b: f64, tolerance: f64) -> bool {
    (a - b).abs() <= tolerance
}

#[test]
fn a_drawing_is_its_own_best_trace() {
    for degrees in [0.0, 17.0, 45.0, 88.0] {
        let cross = drawing(&[line(MIDDLE, degrees, 120.3), line(MIDDLE, degrees + 70.0, 90.3)], 3.0);
        for drawing in [cross, circle(40.0)] {
            let score = score(&drawing, &drawing);
            assert!(score.f1.iter().all(|f| close(*f, 1.0, 1e-9)) && score.chamfer < 1e-4, "{score:?}");
            let ones = [score.junction_f1, score.endpoint_f1, score.integrity, score.purity];
            assert!(ones.iter().all(|one| close(*one, 1.0, 1e-9)), "{score:?}");
            assert_eq!((score.paths_ratio, score.segs_ratio), (1.0, 1.0));
            assert!(score.iou > 0.93, "curves and chains of points are not rendered quite alike: {score:?}");
        }
    }
}

#[test]
fn a_shifted_line_is_that_far_away() {
    for degrees in [0.0f64, 12.0, 45.0, 90.0, 133.0] {
        for shift in [0.2f64, 0.45, 0.55, 0.95, 1.05, 1.9, 2.1] {
            let across = Vec2::from_angle(degrees.to_radians()).turn_90() * shift;
            let there = drawing(&[line(MIDDLE, degrees, 100.3)], 3.0);
            let here = drawing(&[line(MIDDLE + across, degrees, 100.3)], 3.0);
            for score in [score(&there, &here), score(&here, &there)] {
                assert!(close(score.chamfer, shift, 1e-3), "{degrees} degrees, {shift}: {score:?}");
                let expected = [0.5, 1.0, 2.0].map(|reach| if shift < reach { 1.0 } else { 0.0 });
                assert_eq!(score.f1, expected, "{degrees} degrees, {shift}");
            }
        }
    }
}

#[test]
fn a_missing_part_lowers_recall_alone() {
    for share in [0.25, 0.5, 0.8] {
        let whole = drawing(&[line(MIDDLE, 30.0, 160.3)], 3.0);
        let part = drawing(&[line(MIDDLE, 30.0, 160.3 * share)], 3.0);
        let expected = 2.0 * share / (1.0 + share);
        for score in [score(&whole, &part), score(&part, &whole)] {
            assert!(close(score.f1[0], expected, 0.01), "{share}: {score:?}");
        }
        let score = score(&whole, &part);
        assert!(close(score.integrity, share, 0.03) && close(score.purity, 1.0, 1e-9), "{share}: {score:?}");
    }
}

#[test]
fn a_stroke_in_two_keeps_its_longer_part() {
    for cut in [0.1, 0.3, 0.5, 0.9] {
        let [a, b] = line(MIDDLE, 20.0, 150.0)[..] else { unreachable!() };
        // Ends further apart than half a pen.
        let around = [-1.0, 1.0].map(|side| a.lerp(b, cut) + 1.2 * side * (b - a).normalize());
        let (one, two) = (drawing(&[vec![a, b]], 3.0), drawing(&[vec![a, around[0]], vec![around[1], b]], 3.0));
        let cut_in_two = score(&one, &two);
        assert!(close(cut_in_two.integrity, f64::max(cut, 1.0 - cut), 0.03), "{cut}: {cut_in_two:?}");
        assert!(close(cut_in_two.purity, 1.0, 1e-9) && cut_in_two.paths_ratio == 2.0);
        let joined = score(&two, &one);
        assert!(close(joined.purity, f64::max(cut, 1.0 - cut), 0.03) && joined.paths_ratio == 0.5, "{cut}: {joined:?}");
    }
}

#[test]
fn strokes_that_end_at_one_point_are_one_unless_another_passes_there() {
    let [a, b] = line(MIDDLE, 20.0, 150.0)[..] else { unreachable!() };
    let (middle, across) = (a.midpoint(b), line(MIDDLE, 110.0, 60.0));
    let two = || vec![vec![a, middle], vec![middle, b]];
    let joined = score(&drawing(&[vec![a, b]], 3.0), &drawing(&two(), 3.0));
    assert!(joined.integrity == 1.0 && joined.purity == 1.0 && joined.paths_ratio == 2.0, "{joined:?}");
    let crossed = |mut lines: Vec<Vec<Point>>| {
        lines.push(across.clone());
        drawing(&lines, 3.0)
    };
    let apart = score(&crossed(vec![vec![a, b]]), &crossed(two()));
    assert!(close(apart.integrity, (75.0 + 60.0) / 210.0, 0.03), "{apart:?}");
}

#[test]
fn a_line_across_another_does_not_follow_it() {
    for (degrees, follows) in [(20.0, true), (50.0, false), (90.0, false)] {
        let along = drawing(&[line(MIDDLE, 0.0, 5.0)], 6.0);
        let across = drawing(&[line(MIDDLE, degrees, 5.0)], 6.0);
        assert_eq!(score(&along, &across).integrity, if follows { 1.0 } else { 0.0 }, "{degrees}");
    }
}

#[test]
fn pieces_and_paths_are_counted() {
    let square = [(60.0, 50.0), (100.0, 50.0), (100.0, 90.0), (60.0, 90.0)].map(Point::from).to_vec();
    let three = drawing(&[square], 3.0);
    let one = drawing(&[line(MIDDLE, 5.0, 80.0)], 3.0);
    assert_eq!(score(&one, &three).segs_ratio, 3.0);
    assert_eq!(score(&one, &circle(30.0)).segs_ratio, 4.0, "a circle is four arcs");
    assert_eq!(score(&three, &one).segs_ratio, 1.0 / 3.0);
}

#[test]
fn two_crossing_lines_have_one_junction_and_four_ends() {
    for first in [0.0, 7.0, 45.0, 81.0] {
        for between in [25.0, 60.0, 90.0] {
            let cross = [line(MIDDLE, first, 120.0), line(MIDDLE + Vec2::new(4.0, -7.0), first + between, 120.0)];
            let found = nodes(&drawing(&cross, 3.0), 3.0);
            assert_eq!((found.junctions.len(), found.ends.len()), (1, 4), "{first}, {between}");
        }
    }
}

#[test]
fn lines_that_stop_within_a_pen_of_another_touch_it() {
    for degrees in [0.0, 30.0, 72.0] {
        for (gap, touches) in [(-1.5, true), (-0.5, true), (0.0, true), (1.0, true), (2.9, true), (3.1, false)] {
            let across = Vec2::from_angle(f64::to_radians(degrees)).turn_90();
            let bar = line(MIDDLE, degrees, 120.0);
            let stem = vec![MIDDLE + across * gap, MIDDLE + across * 60.0];
            let found = nodes(&drawing(&[bar, stem], 4.0), 3.0);
            let expected = if touches { (1, 3) } else { (0, 4) };
            assert_eq!((found.junctions.len(), found.ends.len()), expected, "{degrees} degrees, {gap}");
        }
    }
}

#[test]
fn ends_that_meet_are_no_ends() {
    for turn in [0.0, 35.0, 80.0] {
        for gap in [0.0, 1.0, 2.5] {
            let way = |degrees: f64| Vec2::from_angle(f64::to_radians(degrees));
            let first = vec![MIDDLE - way(10.0) * 70.0, MIDDLE];
            let start = MIDDLE + way(10.0) * gap;
            let second = vec![start, start + way(10.0 + turn) * 60.0];
            let found = nodes(&drawing(&[first, second], 3.0), 3.0);
            assert_eq!((found.junctions.len(), found.ends.len()), (0, 2), "{turn}, {gap}");
        }
    }
}

#[test]
fn a_line_that_comes_back_to_itself_touches_itself() {
    let loops = |turns: f64| {
        let at = |i: usize| MIDDLE + Vec2::from_angle(i as f64 * 0.05 * turns * std::f64::consts::TAU) * 40.0;
        let mut points: Vec<Point> = (0..=20).map(at).collect();
        points.push(points[20] + (points[20] - MIDDLE) * 0.5);
        nodes(&drawing(&[points], 3.0), 3.0)
    };
    assert_eq!((loops(1.0).junctions.len(), loops(1.0).ends.len()), (1, 1), "like a nine");
    assert_eq!((loops(0.8).junctions.len(), loops(0.8).ends.len()), (0, 2), "like a c");
    assert_eq!(nodes(&circle(40.0), 3.0), Nodes::default());
}

#[test]
fn what_is_drawn_twice_is_there_once() {
    for degrees in [0.0, 30.0, 90.0] {
        let there_and_back = [line(MIDDLE, degrees, 90.0), vec![MIDDLE]].concat();
        let found = nodes(&drawing(&[there_and_back], 3.0), 3.0);
        assert_eq!((found.junctions.len(), found.ends.len()), (0, 2), "{degrees}: {found:?}");
        let bar = line(MIDDLE, degrees, 100.0);
        let back = vec![bar[1], bar[0]];
        let found = nodes(&drawing(&[bar.clone(), bar, back], 3.0), 3.0);
        assert_eq!((found.junctions.len(), found.ends.len()), (0, 2), "{degrees}");
    }
}

#[test]
fn the_most_points_are_paired() {
    let at = |x: f64| Point::new(x, 7.0);
    // The nearest pair first would leave the other two alone.
    assert_eq!(f1(&[at(0.0), at(2.0)], &[at(1.9), at(4.0)], 2.0), 1.0);
    assert_eq!(f1(&[at(0.0), at(10.0)], &[at(1.0)], 2.0), 2.0 / 3.0);
    assert_eq!(f1(&[at(0.0)], &[at(2.1)], 2.0), 0.0);
    assert_eq!((f1(&[], &[], 2.0), f1(&[at(0.0)], &[], 2.0), f1(&[], &[at(0.0)], 2.0)), (1.0, 0.0, 0.0));
}

#[test]
fn wider_lines_overlap_by_the_ratio_of_the_widths() {
    for (thin, wide) in [(4.0, 8.0), (6.0, 9.0), (5.0, 20.0)] {
        let [thin_line, wide_line] = [thin, wide].map(|width| drawing(&[line(MIDDLE, 0.0, 150.0)], width));
        for score in [score(&thin_line, &wide_line), score(&wide_line, &thin_line)] {
            assert!(close(score.iou, thin / wide, 0.05), "{thin}, {wide}: {score:?}");
        }
    }
}

#[test]
fn drawings_of_another_size_are_stretched() {
    let there = drawing(&[line(MIDDLE, 20.0, 130.2), line(MIDDLE, 100.0, 90.2)], 4.0);
    for factor in [0.25, 0.5, 3.0] {
        let score = score(&there, &there.scaled(factor));
        assert!(score.chamfer < 2e-3 && score.iou > 0.98 && score.endpoint_f1 == 1.0, "{factor}: {score:?}");
    }
    let twice = Truth::new(&there, (2 * SIZE.0, 2 * SIZE.1)).unwrap();
    assert!(close(twice.pen(), 8.0, 1e-9));
}

#[test]
fn no_strokes_are_no_truth_and_a_poor_trace() {
    let blank = drawing(&[], 3.0);
    assert!(Truth::new(&blank, SIZE).is_none());
    let score = score(&drawing(&[line(MIDDLE, 0.0, 50.0)], 3.0), &blank);
    assert!(score.chamfer.is_nan() && score.f1 == [0.0; 3] && score.iou == 0.0 && score.paths_ratio == 0.0);
    assert!(truth(&circle(20.0)).score("<svg").is_err());
}

/// A field of one pair of directions.
fn even_field(u: f64, v: f64) -> PolyVectorField {
    let way = |degrees: f64| Vec2::from_angle(degrees.to_radians());
    PolyVectorField::from_directions(SIZE.0, SIZE.1, |_, _| Some((way(u), way(v))))
}

#[test]
fn a_turned_field_is_wrong_by_its_turn() {
    for degrees in [0.0, 21.0, 90.0, 160.0] {
        let line = truth(&drawing(&[line(MIDDLE, degrees, 120.0)], 4.0));
        for turn in [0.0, 5.0, 30.0, 44.0] {
            let error = line.angular_error(&even_field(degrees + turn, degrees + turn + 90.0)).unwrap();
            assert!(close(error.ink, turn, 0.05) && error.junction.is_nan(), "{degrees}, {turn}: {error:?}");
        }
    }
}

#[test]
fn at_junctions_each_direction_wants_its_own_root() {
    for first in [0.0, 33.0, 110.0] {
        for between in [40.0, 90.0] {
            let cross = [line(MIDDLE, first, 120.0), line(MIDDLE, first + between, 120.0)];
            let cross = truth(&drawing(&cross, 4.0));
            let right = cross.angular_error(&even_field(first, first + between)).unwrap();
            assert!(right.ink < 0.05 && right.junction < 0.05, "{first}, {between}: {right:?}");
            let turned = cross.angular_error(&even_field(first + 6.0, first + between + 6.0)).unwrap();
            assert!(close(turned.ink, 6.0, 0.05) && close(turned.junction, 6.0, 0.05), "{turned:?}");
            let blind = cross.angular_error(&even_field(first, first)).unwrap();
            assert!(blind.junction > 0.2 * between, "{first}, {between}: {blind:?}");
        }
    }
}

#[test]
fn a_field_of_another_size_is_refused() {
    let small = PolyVectorField::from_directions(10, 10, |_, _| None);
    assert!(matches!(truth(&circle(20.0)).angular_error(&small), Err(Error::FieldSize { .. })));
}
