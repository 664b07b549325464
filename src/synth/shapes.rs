//! Centrelines of single shapes.

use super::noise::gaussian;
use crate::drawing::{Centreline, Segment};
use kurbo::{Arc, Circle, CubicBez, Line, Point, QuadBez, Vec2};
use rand::Rng;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// A number between two.
pub(super) fn within(rng: &mut impl Rng, low: f64, high: f64) -> f64 {
    low + (high - low) * rng.random::<f64>()
}

/// Any direction; one time in three a multiple of 45 degrees, as drawings like them.
pub(super) fn heading(rng: &mut impl Rng) -> f64 {
    if rng.random_bool(0.33) { FRAC_PI_2 * 0.5 * f64::from(rng.random_range(0..8)) } else { within(rng, 0.0, TAU) }
}

/// An open chain.
pub(super) fn open(segments: Vec<Segment>) -> Centreline {
    Centreline::Path { segments, closed: false }
}

/// A straight line.
pub(super) fn line(p0: Point, p1: Point) -> Centreline {
    open(vec![Segment::Line(Line::new(p0, p1))])
}

/// A straight line on both sides of its middle.
pub(super) fn line_through(middle: Point, angle: f64, length: f64) -> Centreline {
    let half = 0.5 * length * Vec2::from_angle(angle);
    line(middle - half, middle + half)
}

/// A circular arc that leaves a point in a direction and bends by a signed angle over its length.
pub(super) fn arc_from(start: Point, angle: f64, length: f64, bend: f64) -> Segment {
    if bend.abs() < 0.02 {
        return Segment::Line(Line::new(start, start + length * Vec2::from_angle(angle)));
    }
    let radius = length / bend.abs();
    let side = FRAC_PI_2 * bend.signum();
    let centre = start + radius * Vec2::from_angle(angle + side);
    Segment::Arc(Arc::new(centre, (radius, radius), angle - side, bend, 0.0))
}

/// Tangent angle at the end of what [`arc_from`] gives.
pub(super) fn arc_end_angle(angle: f64, bend: f64) -> f64 {
    if bend.abs() < 0.02 { angle } else { angle + bend }
}

/// A gently bent stroke: a line, an arc, a quadratic or a cubic.
pub(super) fn bent(rng: &mut impl Rng, start: Point, angle: f64, length: f64) -> Centreline {
    let along = length * Vec2::from_angle(angle);
    let across = length * Vec2::from_angle(angle + FRAC_PI_2);
    let end = start + along + across * within(rng, -0.4, 0.4);
    match rng.random_range(0..10) {
        0..3 => line(start, start + along),
        3..5 => {
            let bend = within(rng, -2.5, 2.5);
            open(vec![arc_from(start, angle, length, bend)])
        }
        5..7 => {
            let middle = start + along * within(rng, 0.3, 0.7) + across * within(rng, -0.5, 0.5);
            open(vec![Segment::Cubic(QuadBez::new(start, middle, end).raise())])
        }
        _ => {
            let a = start + along * within(rng, 0.1, 0.6) + across * within(rng, -0.6, 0.6);
            let b = end - along * within(rng, 0.1, 0.6) + across * within(rng, -0.6, 0.6);
            open(vec![Segment::Cubic(CubicBez::new(start, a, b, end))])
        }
    }
}

/// A smooth chain of arcs and lines that join without a corner.
pub(super) fn smooth_chain(rng: &mut impl Rng, start: Point, angle: f64, scale: f64) -> Centreline {
    let (mut p, mut angle, mut segments) = (start, angle, Vec::new());
    for _ in 0..rng.random_range(2..5) {
        let bend = if rng.random_bool(0.3) { 0.0 } else { within(rng, -2.2, 2.2) };
        let segment = arc_from(p, angle, scale * within(rng, 0.3, 1.0), bend);
        p = segment.end();
        angle = arc_end_angle(angle, bend);
        segments.push(segment);
    }
    open(segments)
}

/// Straight pieces with corners between them.
pub(super) fn polyline(rng: &mut impl Rng, start: Point, angle: f64, scale: f64) -> Centreline {
    let (mut p, mut angle, mut segments) = (start, angle, Vec::new());
    for _ in 0..rng.random_range(2..6) {
        let next = p + scale * within(rng, 0.2, 0.9) * Vec2::from_angle(angle);
        segments.push(Segment::Line(Line::new(p, next)));
        p = next;
        let turn = within(rng, 0.35, 2.6);
        angle += if rng.random_bool(0.3) { FRAC_PI_2 } else { turn } * if rng.random_bool(0.5) { 1.0 } else { -1.0 };
    }
    open(segments)
}

/// A stroke as a hand draws it: bends that change as it goes, here and there a sharp turn, and straight pieces of a few
/// pixels between the points that were recorded.
pub(super) fn freehand(rng: &mut impl Rng, start: Point, angle: f64, scale: f64) -> Centreline {
    let step = within(rng, 1.5, 6.0);
    let length = scale * within(rng, 0.5, 3.0);
    // Lengths between sharp turns, and over which the bend changes.
    let sharp = if rng.random_bool(0.4) { f64::INFINITY } else { within(rng, 6.0, 0.7 * scale + 8.0) };
    let slow = within(rng, 6.0, 0.5 * scale + 8.0);
    let tremor = if rng.random_bool(0.5) { 0.0 } else { within(rng, 0.0, 0.12) };
    let (mut p, mut angle, mut bend, mut segments) = (start, angle, 0.0, Vec::new());
    for _ in 0..(length / step).ceil() as usize {
        let next = p + step * within(rng, 0.7, 1.3) * Vec2::from_angle(angle + tremor * gaussian(rng));
        segments.push(Segment::Line(Line::new(p, next)));
        p = next;
        bend += (step / slow) * (4.0 * gaussian(rng) / slow - bend);
        angle += bend * step;
        if rng.random_bool((step / sharp).min(1.0)) {
            angle += within(rng, 0.7, 2.9) * if rng.random_bool(0.5) { 1.0 } else { -1.0 };
            bend = 0.0;
        }
    }
    open(segments)
}

/// A closed polygon, regular or not.
pub(super) fn polygon(rng: &mut impl Rng, centre: Point, radius: f64, angle: f64) -> Centreline {
    let n = rng.random_range(3..8);
    let wobble = if rng.random_bool(0.5) { 0.0 } else { 0.35 };
    let corners: Vec<Point> = (0..n)
        .map(|i| {
            let a = angle + TAU * f64::from(i) / f64::from(n);
            centre + radius * (1.0 + wobble * within(rng, -1.0, 1.0)) * Vec2::from_angle(a)
        })
        .collect();
    closed_polyline(&corners)
}

fn closed_polyline(corners: &[Point]) -> Centreline {
    let next = corners.iter().cycle().skip(1);
    let segments = corners.iter().zip(next).map(|(a, b)| Segment::Line(Line::new(*a, *b))).collect();
    Centreline::Path { segments, closed: true }
}

/// A rectangle with round corners, or sharp ones at radius 0.
pub(super) fn rectangle(centre: Point, half: Vec2, radius: f64, angle: f64) -> Centreline {
    let axes = [Vec2::from_angle(angle), Vec2::from_angle(angle + FRAC_PI_2)];
    let at = |x: f64, y: f64| centre + axes[0] * x + axes[1] * y;
    if radius < 0.5 {
        return closed_polyline(&[at(-half.x, -half.y), at(half.x, -half.y), at(half.x, half.y), at(-half.x, half.y)]);
    }
    let inner = half - Vec2::new(radius, radius);
    let mut segments = Vec::new();
    for (i, (sx, sy)) in [(1.0, -1.0), (1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0)].into_iter().enumerate() {
        let corner = at(sx * inner.x, sy * inner.y);
        let from = angle - FRAC_PI_2 + FRAC_PI_2 * i as f64;
        let arc = Segment::Arc(Arc::new(corner, (radius, radius), from, FRAC_PI_2, 0.0));
        if let Some(last) = segments.last().map(Segment::end) {
            segments.push(Segment::Line(Line::new(last, arc.start())));
        }
        segments.push(arc);
    }
    let (last, first) = (segments[segments.len() - 1].end(), segments[0].start());
    segments.push(Segment::Line(Line::new(last, first)));
    Centreline::Path { segments, closed: true }
}

/// A full circle, or an arc of one.
pub(super) fn round(rng: &mut impl Rng, centre: Point, radius: f64) -> Centreline {
    if rng.random_bool(0.5) {
        return Centreline::Circle(Circle::new(centre, radius));
    }
    let sweep = within(rng, 0.5, 1.8) * PI;
    open(vec![Segment::Arc(Arc::new(centre, (radius, radius), heading(rng), sweep, 0.0))])
}

/// A smooth closed curve through points around a centre.
pub(super) fn blob(rng: &mut impl Rng, centre: Point, radius: f64) -> Centreline {
    let n = rng.random_range(4..8usize);
    let points: Vec<Point> = (0..n)
        .map(|i| centre + radius * within(rng, 0.55, 1.25) * Vec2::from_angle(TAU * i as f64 / n as f64))
        .collect();
    let tangent = |i: usize| (points[(i + 1) % n] - points[(i + n - 1) % n]) / 6.0;
    let piece = |i: usize| {
        let j = (i + 1) % n;
        Segment::Cubic(CubicBez::new(points[i], points[i] + tangent(i), points[j] - tangent(j), points[j]))
    };
    Centreline::Path { segments: (0..n).map(piece).collect(), closed: true }
}
