//! What drawings are made of: single shapes, and ways for a new stroke to meet an old one.

use super::Sheet;
use super::shapes::{arc_from, bent, blob, freehand, heading, line, line_through, open, polygon, polyline};
use super::shapes::{rectangle, round, smooth_chain, within};
use crate::drawing::{Centreline, Segment};
use kurbo::{Circle, Line, ParamCurveDeriv, Point, Vec2};
use rand::Rng;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Adds one motif.
pub(super) fn motif(rng: &mut impl Rng, sheet: &mut Sheet) {
    if !sheet.drawing.strokes.is_empty() && rng.random_bool(0.45) {
        return meet(rng, sheet);
    }
    if sheet.style.freehand {
        return sketch(rng, sheet);
    }
    match rng.random_range(0..24) {
        20..24 => arrow(rng, sheet),
        0..11 => shape(rng, sheet),
        11 | 12 => star(rng, sheet),
        13 => arrow(rng, sheet),
        14 => shallow_crossing(rng, sheet),
        15 => parallels(rng, sheet),
        16 => dashes(rng, sheet),
        17 => hatch(rng, sheet),
        _ => details(rng, sheet),
    }
}

/// A shape of its own.
fn shape(rng: &mut impl Rng, sheet: &mut Sheet) {
    let (p, angle) = (sheet.place(rng), heading(rng));
    let scale = sheet.style.scale * within(rng, 12.0, 90.0);
    let centreline = match rng.random_range(0..12) {
        0..4 => bent(rng, p, angle, scale),
        4 => smooth_chain(rng, p, angle, scale),
        5..7 => polyline(rng, p, angle, scale),
        7 => polygon(rng, p, 0.5 * scale, angle),
        8..10 => {
            let half = Vec2::new(0.5 * scale, within(rng, 0.15, 0.5) * scale);
            let round = rng.random_bool(0.6);
            let radius = if round { within(rng, 0.1, 0.9) * half.y.min(half.x) } else { 0.0 };
            let angle = if rng.random_bool(0.6) { 0.0 } else { angle };
            rectangle(p, half, radius, angle)
        }
        10 => round(rng, p, 0.5 * scale),
        _ => blob(rng, p, 0.5 * scale),
    };
    sheet.add(rng, centreline);
}

/// A stroke by hand, small ones as often as large ones.
fn sketch(rng: &mut impl Rng, sheet: &mut Sheet) {
    let (p, angle) = (sheet.place(rng), heading(rng));
    let scale = sheet.style.scale * within(rng, 8f64.ln(), 90f64.ln()).exp();
    let centreline = freehand(rng, p, angle, scale);
    sheet.add(rng, centreline);
}

/// A point of a random stroke with the stroke's tangent angle there.
fn point_on(rng: &mut impl Rng, sheet: &Sheet) -> (Point, f64) {
    let strokes = &sheet.drawing.strokes;
    let t = within(rng, 0.02, 0.98);
    match &strokes[rng.random_range(0..strokes.len())].centreline {
        Centreline::Path { segments, .. } => {
            let segment = &segments[rng.random_range(0..segments.len())];
            (segment.eval(t), angle_at(segment, t))
        }
        Centreline::Circle(c) => (c.center + c.radius * Vec2::from_angle(TAU * t), TAU * t + FRAC_PI_2),
        Centreline::Dot(p) => (*p, 0.0),
    }
}

fn angle_at(segment: &Segment, t: f64) -> f64 {
    match segment {
        Segment::Line(l) => (l.p1 - l.p0).atan2(),
        Segment::Arc(a) => a.start_angle + a.sweep_angle * t + FRAC_PI_2 * a.sweep_angle.signum(),
        Segment::Cubic(c) => {
            use kurbo::ParamCurve;
            c.deriv().eval(t).to_vec2().atan2()
        }
    }
}

/// Angle between a new stroke and the one that it meets: any, often a right one, sometimes a shallow one.
fn meeting_angle(rng: &mut impl Rng) -> f64 {
    let side = if rng.random_bool(0.5) { 1.0 } else { -1.0 };
    side * match rng.random_range(0..10) {
        0..3 => FRAC_PI_2,
        3..5 => within(rng, 0.12, 0.6),
        _ => within(rng, 0.4, PI - 0.4),
    }
}

/// A stroke that crosses, branches from, or touches one that is there.
fn meet(rng: &mut impl Rng, sheet: &mut Sheet) {
    let (p, tangent) = point_on(rng, sheet);
    let length = sheet.style.scale * within(rng, 15.0, 80.0);
    let across = tangent + meeting_angle(rng);
    let centreline = match rng.random_range(0..10) {
        // X: through it, straight or bent.
        0..3 => {
            if rng.random_bool(0.5) {
                line_through(p, across, length)
            } else {
                let start = p - Vec2::from_angle(across) * length * within(rng, 0.2, 0.8);
                let bend = within(rng, -0.8, 0.8);
                open(vec![arc_from(start, across, length, bend)])
            }
        }
        // T or Y: from it, or nearly so.
        3..6 => {
            let miss = if rng.random_bool(0.7) { 0.0 } else { within(rng, -0.8, 2.0) * sheet.style.width };
            let start = p + miss * Vec2::from_angle(across);
            if sheet.style.freehand { freehand(rng, start, across, length) } else { bent(rng, start, across, length) }
        }
        // K: two from one point.
        6 => {
            let second = tangent + meeting_angle(rng);
            let other = bent(rng, p, second, length);
            sheet.add(rng, other);
            bent(rng, p, across, length)
        }
        // A branch that leaves along the tangent.
        7 | 8 => {
            let back = if rng.random_bool(0.5) { PI } else { 0.0 };
            let bend = within(rng, 0.4, 2.4) * if rng.random_bool(0.5) { 1.0 } else { -1.0 };
            open(vec![arc_from(p, tangent + back, length, bend)])
        }
        // A circle or a line that touches it from the side.
        _ => {
            let radius = within(rng, 5.0, 30.0);
            let side = Vec2::from_angle(tangent + FRAC_PI_2);
            if rng.random_bool(0.6) {
                Centreline::Circle(Circle::new(p + side * radius, radius))
            } else {
                line_through(p + side * within(rng, 0.0, 0.5) * sheet.style.width, tangent, length)
            }
        }
    };
    sheet.add(rng, centreline);
}

/// Three to eight arms from one point: Y, K, X and stars.
fn star(rng: &mut impl Rng, sheet: &mut Sheet) {
    let p = sheet.place(rng);
    let arms = *[3, 3, 3, 4, 4, 5, 6, 8].get(rng.random_range(0..8)).expect("eight choices");
    let even = rng.random_bool(0.5);
    let first = heading(rng);
    let length = sheet.style.scale * within(rng, 12.0, 50.0);
    for i in 0..arms {
        let step = TAU / f64::from(arms);
        let jitter = if even { 0.0 } else { within(rng, -0.4, 0.4) * step };
        let angle = first + step * f64::from(i) + jitter;
        let reach = length * within(rng, 0.7, 1.3);
        let arm = if even { line(p, p + length * Vec2::from_angle(angle)) } else { bent(rng, p, angle, reach) };
        sheet.add(rng, arm);
    }
}

/// A corner with a stroke that ends in it: an arrow's head, a check box's tick, the top of a bishop.
fn arrow(rng: &mut impl Rng, sheet: &mut Sheet) {
    let (p, angle) = (sheet.place(rng), heading(rng));
    let half = if rng.random_bool(0.65) { FRAC_PI_2 * 0.5 } else { within(rng, 0.3, 1.3) };
    let lean = if rng.random_bool(0.75) { 0.0 } else { within(rng, -0.5, 0.5) };
    let wing = sheet.style.scale * within(rng, 8.0, 30.0);
    let ends = [half, -half].map(|side| p + wing * Vec2::from_angle(angle + side));
    let wings = vec![Segment::Line(Line::new(ends[0], p)), Segment::Line(Line::new(p, ends[1]))];
    sheet.add(rng, open(wings));
    let length = sheet.style.scale * within(rng, 15.0, 70.0);
    let stem = if rng.random_bool(0.7) {
        line(p, p + length * Vec2::from_angle(angle + lean))
    } else {
        bent(rng, p, angle + lean, length)
    };
    sheet.add(rng, stem);
}

/// Two long lines at 5 to 25 degrees.
fn shallow_crossing(rng: &mut impl Rng, sheet: &mut Sheet) {
    let (p, angle) = (sheet.place(rng), heading(rng));
    let length = within(rng, 60.0, 140.0);
    let turn = within(rng, 0.09, 0.45);
    sheet.add(rng, line_through(p, angle, length));
    sheet.add(rng, line_through(p, angle + turn, length));
}

/// Two to five lines or arcs side by side, some so close that they touch.
fn parallels(rng: &mut impl Rng, sheet: &mut Sheet) {
    let (p, angle) = (sheet.place(rng), heading(rng));
    let length = within(rng, 30.0, 100.0);
    let gap = sheet.style.width * within(rng, 1.1, 3.0);
    let bend = if rng.random_bool(0.5) { 0.0 } else { within(rng, 0.3, 2.0) };
    let normal = Vec2::from_angle(angle + FRAC_PI_2);
    let drift = within(rng, -0.05, 0.05);
    for i in 0..rng.random_range(2..6) {
        let start = p + normal * gap * f64::from(i);
        sheet.add(rng, open(vec![arc_from(start, angle + drift * f64::from(i), length, bend)]));
    }
}

/// A dashed line or arc.
fn dashes(rng: &mut impl Rng, sheet: &mut Sheet) {
    let (mut p, mut angle) = (sheet.place(rng), heading(rng));
    let dash = sheet.style.width * within(rng, 1.5, 5.0);
    let gap = sheet.style.width * within(rng, 1.3, 3.0);
    let bend = if rng.random_bool(0.5) { 0.0 } else { within(rng, -0.03, 0.03) };
    for _ in 0..rng.random_range(3..10) {
        let piece = arc_from(p, angle, dash, bend * dash);
        p = piece.end() + gap * Vec2::from_angle(angle + bend * dash);
        angle += bend * (dash + gap);
        sheet.add(rng, open(vec![piece]));
    }
}

/// A patch of hatching, one time in three crossed.
fn hatch(rng: &mut impl Rng, sheet: &mut Sheet) {
    let (p, angle) = (sheet.place(rng), heading(rng));
    let gap = sheet.style.width * within(rng, 2.0, 4.0);
    let length = within(rng, 15.0, 45.0);
    let n = rng.random_range(3..8);
    let crossed = if rng.random_bool(0.33) { 2 } else { 1 };
    for pass in 0..crossed {
        let angle = angle + FRAC_PI_2 * f64::from(pass);
        let normal = Vec2::from_angle(angle + FRAC_PI_2);
        for i in 0..n {
            let middle = p + normal * gap * (f64::from(i) - 0.5 * f64::from(n - 1));
            let slant = within(rng, -0.05, 0.05);
            let length = length * within(rng, 0.8, 1.2);
            sheet.add(rng, line_through(middle, angle + slant, length));
        }
    }
}

/// Small things: rings, ticks, plus signs, short zigzags.
fn details(rng: &mut impl Rng, sheet: &mut Sheet) {
    let p = sheet.place(rng);
    let size = sheet.style.width * within(rng, 1.5, 4.0);
    for _ in 0..rng.random_range(1..4) {
        let q = p + Vec2::new(within(rng, -20.0, 20.0), within(rng, -20.0, 20.0));
        let angle = heading(rng);
        match rng.random_range(0..4) {
            0 => sheet.add(rng, Centreline::Circle(Circle::new(q, size))),
            1 => sheet.add(rng, line_through(q, angle, 2.0 * size)),
            2 => {
                sheet.add(rng, line_through(q, angle, 2.5 * size));
                sheet.add(rng, line_through(q, angle + FRAC_PI_2, 2.5 * size));
            }
            _ => {
                let zigzag = polyline(rng, q, angle, 3.0 * size);
                sheet.add(rng, zigzag);
            }
        }
    }
}
