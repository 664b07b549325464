//! The field of drawings whose field has a closed form.

use super::*;
use crate::drawing::{Centreline, Segment, Stroke};
use crate::field::FrameField;
use kurbo::{Arc, Circle, Line, Point, Vec2};
use std::f64::consts::PI;

fn stroke(segments: Vec<Segment>, width: f64) -> Stroke {
    Stroke::new(Centreline::Path { segments, closed: false }, width)
}

fn line(x0: f64, y0: f64, x1: f64, y1: f64, width: f64) -> Stroke {
    stroke(vec![Segment::Line(Line::new((x0, y0), (x1, y1)))], width)
}

fn drawing(strokes: Vec<Stroke>) -> Drawing {
    Drawing { strokes, ..Drawing::new(64.0, 64.0) }
}

/// Mean and largest angle in degrees, over pixels that `pick` takes, between the nearer root and a direction.
fn root_error(truth: &FieldTruth, pick: impl Fn(usize, usize) -> Option<f64>) -> (f64, f64) {
    let frames = FrameField::new(truth.field.clone());
    let (mut sum, mut worst, mut n) = (0.0, 0.0f64, 0.0);
    for y in 0..64 {
        for x in 0..64 {
            if let (Some(frame), Some(angle)) = (frames.at_pixel(x, y), pick(x, y)) {
                let e = line_angle(frame.u.atan2(), angle).min(line_angle(frame.v.atan2(), angle)).to_degrees();
                (sum, worst, n) = (sum + e, worst.max(e), n + 1.0);
            }
        }
    }
    assert!(n > 0.0, "no pixel was picked");
    (sum / n, worst)
}

#[test]
fn a_line_has_its_tangent_and_normal() {
    for degrees in [0.0f64, 17.0, 45.0, 90.0, 133.0] {
        let d = 25.0 * Vec2::from_angle(degrees.to_radians());
        let truth = field(&drawing(vec![line(32.0 - d.x, 32.0 - d.y, 32.0 + d.x, 32.0 + d.y, 3.0)]));
        assert!(truth.ink.count() > 120);
        for angle in [degrees.to_radians(), degrees.to_radians() + PI / 2.0] {
            let (_, worst) = root_error(&truth, |_, _| Some(angle));
            assert!(worst < 0.01, "{degrees}: {worst}");
        }
        assert!(truth.place.data().iter().all(|&p| p == Place::Paper || p == Place::Far));
    }
}

#[test]
fn a_circle_has_the_perpendicular_to_its_radius() {
    let circle = Centreline::Circle(Circle::new((31.3, 32.8), 20.0));
    let truth = field(&drawing(vec![Stroke::new(circle, 4.0)]));
    let (mean, worst) = root_error(&truth, |x, y| {
        Some((Point::new(x as f64 + 0.5, y as f64 + 0.5) - Point::new(31.3, 32.8)).atan2() + PI / 2.0)
    });
    assert!(mean < 0.06 && worst < 0.5, "{mean} {worst}");
    assert!(truth.place.data().iter().all(|&p| p != Place::Shared));
}

#[test]
fn two_crossing_lines_have_both_tangents_where_they_share_pixels() {
    for degrees in [5.0f64, 10.0, 20.0, 45.0, 70.0, 90.0] {
        let d = 40.0 * Vec2::from_angle(degrees.to_radians());
        let lines = vec![line(2.0, 32.0, 62.0, 32.0, 3.0), line(32.0 - d.x, 32.0 - d.y, 32.0 + d.x, 32.0 + d.y, 3.0)];
        let truth = field(&drawing(lines));
        assert_eq!(truth.place[(32, 32)], Place::Shared);
        // Deep inside the shared region, smoothing sees nothing else.
        let frames = FrameField::new(truth.field.clone());
        let frame = frames.at_pixel(31, 31).unwrap();
        let angles = [0.0, degrees.to_radians()];
        let match_of = |a: f64| line_angle(frame.u.atan2(), a).min(line_angle(frame.v.atan2(), a)).to_degrees();
        // Rounding moves nearly equal roots by the square root of its size.
        angles.iter().for_each(|&a| assert!(match_of(a) < 1.5, "{degrees}: {a} is off by {}", match_of(a)));
        // Everywhere on the ink one root is the nearest line's tangent.
        let (mean, _) = root_error(&truth, |x, y| Some(f64::from(truth.tangent[(x, y)].arg()) / 2.0));
        assert!(mean < 1.0, "{degrees}: {mean}");
        // Far from the crossing the second root is the normal.
        if degrees >= 20.0 {
            let (_, worst) = root_error(&truth, |x, y| (x < 8 && y.abs_diff(32) < 3).then_some(PI / 2.0));
            assert!(worst < 0.01, "{degrees}: {worst}");
        }
    }
}

#[test]
fn between_crossing_and_far_the_second_direction_turns_the_short_way() {
    let truth = field(&drawing(vec![line(2.0, 32.5, 62.0, 32.5, 3.0), line(12.0, 12.5, 52.0, 52.5, 3.0)]));
    let turned: Vec<f64> = (0..64)
        .filter(|&x| truth.place[(x, 32)] == Place::Between && x > 32)
        .map(|x| f64::from(truth.other[(x, 32)].arg()).to_degrees() / 2.0)
        .collect();
    assert!(turned.len() >= 4, "{turned:?}");
    assert!(turned.is_sorted(), "{turned:?}");
    assert!(turned.iter().all(|a| (45.0..90.0).contains(a)), "{turned:?}");
}

#[test]
fn a_t_has_both_directions_on_the_body_over_the_stem() {
    let truth = field(&drawing(vec![line(4.0, 20.0, 60.0, 20.0, 4.0), line(32.0, 20.0, 32.0, 60.0, 4.0)]));
    let frames = FrameField::new(truth.field.clone());
    for (x, y) in [(31, 18), (32, 19), (31, 20), (32, 21)] {
        let frame = frames.at_pixel(x, y).unwrap();
        assert!(frame.u.dot(frame.v).abs() < 0.05, "{frame:?}");
        assert_eq!(truth.place[(x, y)], Place::Shared);
    }
    assert!(truth.near_junction[(32, 27)] && !truth.near_junction[(32, 40)] && !truth.near_junction[(10, 20)]);
}

#[test]
fn a_corner_of_one_stroke_has_both_arms() {
    let corner = vec![
        Segment::Line(Line::new((10.0, 50.0), (32.0, 20.0))),
        Segment::Line(Line::new((32.0, 20.0), (54.0, 50.0))),
    ];
    let truth = field(&drawing(vec![stroke(corner, 3.0)]));
    assert_eq!(truth.place[(32, 20)], Place::Shared);
    let arms = [Vec2::new(-22.0, 30.0).atan2(), Vec2::new(22.0, 30.0).atan2()];
    for arm in arms {
        let (_, worst) = root_error(&truth, |x, y| ((x, y) == (31, 20) || (x, y) == (32, 20)).then_some(arm));
        assert!(worst < 3.0, "{worst}");
    }
}

#[test]
fn a_tangential_touch_is_a_double_root_and_no_junction() {
    let arc = Segment::Arc(Arc::new((32.0, 52.0), (20.0, 20.0), PI, PI, 0.0));
    let truth = field(&drawing(vec![line(2.0, 32.0, 62.0, 32.0, 3.0), stroke(vec![arc], 3.0)]));
    let i = (32, 31);
    assert_eq!(truth.place[i], Place::Shared);
    let (c0, c2) = (truth.field.c0()[i], truth.field.c2()[i]);
    assert!((c2 * c2 - 4.0 * c0).norm() < 0.05, "{c0} {c2}");
    assert!(!truth.near_junction[i]);
    let (mean, _) = root_error(&truth, |x, y| Some(f64::from(truth.tangent[(x, y)].arg()) / 2.0));
    assert!(mean < 1.0, "{mean}");
}

#[test]
fn strokes_that_continue_each_other_are_one_line() {
    let truth = field(&drawing(vec![line(4.0, 30.0, 32.0, 30.0, 3.0), line(32.0, 30.0, 60.0, 30.0, 3.0)]));
    assert!(truth.place.data().iter().all(|&p| p == Place::Paper || p == Place::Far));
}

#[test]
fn a_loop_crosses_itself() {
    let loop_ = kurbo::CubicBez::new((8.0, 8.0), (100.0, 80.0), (-36.0, 80.0), (56.0, 8.0));
    let truth = field(&drawing(vec![stroke(vec![Segment::Cubic(loop_)], 3.0)]));
    let shared = truth.place.data().iter().filter(|&&p| p == Place::Shared).count();
    assert!((8..60).contains(&shared), "{shared}");
}
