//! The drawing as evenly spaced samples of its smooth curves.

use crate::drawing::{Centreline, Drawing, Segment};
use kurbo::{CubicBez, ParamCurve, ParamCurveDeriv, Point, Vec2};

/// Arc length between samples in pixels.
pub(super) const STEP: f64 = 0.25;

/// Tangents further apart than this split a stroke into two curves: a corner, whose arms are two directions.
/// Also the angle under which two directions are one for [`super::FieldTruth`]; as the benchmark has it.
pub(super) const CORNER: f64 = 15.0 * std::f64::consts::PI / 180.0;

/// A point of a curve with its derivatives.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample {
    pub position: Point,
    /// Unit tangent.
    pub tangent: Vec2,
    /// Signed curvature in radians per pixel: how fast the tangent's angle grows along the curve.
    pub curvature: f64,
    /// Arc length from the start of the curve in pixels.
    pub arc: f64,
}

impl Sample {
    /// The tangent angle of the curve at the point nearest `p`, to second order in the arc length between.
    pub fn tangent_near(&self, p: Point) -> f64 {
        let offset = p - self.position;
        let along = offset.dot(self.tangent);
        let across = self.tangent.cross(offset);
        let shrink = (1.0 - self.curvature * across).max(0.25);
        self.tangent.atan2() + self.curvature * (along / shrink).clamp(-STEP, STEP)
    }
}

/// A maximal piece of a stroke without a corner.
#[derive(Clone, Debug)]
pub(super) struct Curve {
    pub samples: Vec<Sample>,
    /// Pen width in pixels.
    pub width: f64,
    /// Arc length in pixels.
    pub length: f64,
    /// Whether the end joins the start without a corner.
    pub closed: bool,
}

impl Curve {
    /// Distance along the curve between two arc lengths, the shorter way where the curve is closed.
    pub fn between(&self, a: f64, b: f64) -> f64 {
        let d = (a - b).abs();
        if self.closed { d.min(self.length - d) } else { d }
    }

    /// Whether an arc length is within a pixel of a free end.
    pub fn at_end(&self, arc: f64) -> bool {
        !self.closed && (arc < 1.0 || arc > self.length - 1.0)
    }

    fn new(width: f64) -> Self {
        Self { samples: Vec::new(), width, length: 0.0, closed: false }
    }

    fn push(&mut self, position: Point, tangent: Vec2, curvature: f64) {
        if let Some(last) = self.samples.last() {
            self.length += (position - last.position).hypot();
        }
        self.samples.push(Sample { position, tangent, curvature, arc: self.length });
    }
}

/// The curves of a drawing. Dots have no direction and give none.
pub(super) fn curves(drawing: &Drawing) -> Vec<Curve> {
    let mut out = Vec::new();
    for stroke in &drawing.strokes {
        match &stroke.centreline {
            Centreline::Path { segments, closed } => path(segments, *closed, stroke.width, &mut out),
            Centreline::Circle(c) => {
                let mut curve = Curve::new(stroke.width);
                let arc = kurbo::Arc::new(c.center, (c.radius, c.radius), 0.0, std::f64::consts::TAU, 0.0);
                sample(&Segment::Arc(arc), &mut curve);
                curve.closed = true;
                out.push(curve);
            }
            Centreline::Dot(_) => {}
        }
    }
    out.retain(|c| c.length > 1e-6);
    out
}

/// Splits a chain of segments at its corners.
fn path(segments: &[Segment], closed: bool, width: f64, out: &mut Vec<Curve>) {
    let first = out.len();
    let mut curve = Curve::new(width);
    for segment in segments {
        let mut piece = Curve::new(width);
        sample(segment, &mut piece);
        let Some(next) = piece.samples.first() else { continue };
        if curve.samples.last().is_some_and(|last| turn(last.tangent, next.tangent) > CORNER) {
            out.push(std::mem::replace(&mut curve, Curve::new(width)));
        }
        piece.samples.iter().for_each(|s| curve.push(s.position, s.tangent, s.curvature));
    }
    out.push(curve);
    if closed {
        close(first, out)
    }
}

/// Joins the last curve of a closed chain to the first unless a corner is between them.
fn close(first: usize, out: &mut Vec<Curve>) {
    let last = out.len() - 1;
    let (Some(end), Some(start)) = (out[last].samples.last(), out[first].samples.first()) else { return };
    if turn(end.tangent, start.tangent) > CORNER {
        return;
    }
    if first == last {
        out[first].closed = true;
        return;
    }
    let head = std::mem::replace(&mut out[first], Curve::new(0.0));
    let mut tail = out.pop().expect("there are at least two");
    head.samples.iter().for_each(|s| tail.push(s.position, s.tangent, s.curvature));
    out[first] = tail;
}

fn turn(a: Vec2, b: Vec2) -> f64 {
    a.cross(b).atan2(a.dot(b)).abs()
}

/// Appends samples of one segment, its two ends included, at most [`STEP`] apart.
fn sample(segment: &Segment, curve: &mut Curve) {
    match segment {
        Segment::Line(l) => {
            let d = l.p1 - l.p0;
            if d.hypot() < 1e-9 {
                return;
            }
            let n = (d.hypot() / STEP).ceil();
            (0..=n as usize).for_each(|i| curve.push(l.p0 + d * (i as f64 / n), d.normalize(), 0.0));
        }
        Segment::Arc(a) => {
            let r = a.radii.x;
            let n = (r * a.sweep_angle.abs() / STEP).ceil().max(1.0);
            for i in 0..=n as usize {
                let angle = a.start_angle + a.sweep_angle * i as f64 / n;
                let tangent = Vec2::from_angle(angle + 0.5 * std::f64::consts::PI) * a.sweep_angle.signum();
                curve.push(a.center + r * Vec2::from_angle(angle), tangent, a.sweep_angle.signum() / r.max(1e-9));
            }
        }
        Segment::Cubic(c) => sample_cubic(c, curve),
    }
}

/// Steps a cubic by `dt = STEP / |B'(t)|`, so that samples are evenly spaced in arc length.
fn sample_cubic(c: &CubicBez, curve: &mut Curve) {
    let (first, second) = (c.deriv(), c.deriv().deriv());
    let hull = (c.p1 - c.p0).hypot() + (c.p2 - c.p1).hypot() + (c.p3 - c.p2).hypot();
    if hull < 1e-9 {
        return;
    }
    let mut t = 0.0f64;
    loop {
        let d = first.eval(t).to_vec2();
        let dd = second.eval(t).to_vec2();
        let speed = d.hypot();
        if speed > 1e-6 * hull {
            curve.push(c.eval(t), d / speed, d.cross(dd) / speed.powi(3));
        } else {
            // A vanishing derivative: the direction is that of the second derivative, or towards the far end.
            let towards = if dd.hypot() > 1e-9 { dd * if t < 0.5 { 1.0 } else { -1.0 } } else { c.p3 - c.p0 };
            curve.push(c.eval(t), towards.normalize(), 0.0);
        }
        if t >= 1.0 {
            return;
        }
        t = (t + (STEP / speed.max(1e-9)).clamp(1e-4, 0.02)).min(1.0);
    }
}
