//! Where a line that runs into another at a small angle leaves it.
//!
//! Long before two inks part, the edge of their union bulges: at a place `s` along the other line, the body, the outer
//! edge lies at `max(w_body / 2, y(s) + w / 2)` from the body's middle, where `y` is how far the line of width `w` is from
//! it. With `u = s - s0` after the place `s0` where they meet, `y = (u^2 + y^2) / 2R` for a circle that touches the body
//! and `y = m u + c u^2 / 2` for a line that meets it at an angle. The `s0` that explains the edge best, in least squares,
//! is the node; up to where the line is alone again, its middle is what was solved.

use crate::clean::LineImage;
use crate::graph::lines::course::Ending;
use crate::graph::lines::end::{End, ends};
use crate::graph::resolve::contacts::{LineIndex, Place, direction, direction_at, point_at, width_at};
use crate::graph::resolve::node::arm_line;
use crate::streamline::{STEP, Stop, Streamline};
use kurbo::{Point, Vec2};
use rayon::prelude::*;

/// A body is looked for within this many line widths of an end, running along it within this cosine's angle (50 degrees).
const NEAR: f64 = 1.2;
const ALONG: f64 = 0.64;
/// The end's course, drawn out to the body, comes in within this cosine's angle (35 degrees).
const ARRIVING: f64 = 0.82;
/// A line that comes in at an angle meets the body this many line widths from its ends.
const CLEAR: f64 = 2.0;
/// The edge is measured from this many line widths before the end's last point on the body, or from where it has come down
/// no further for so many, to that many after it.
const BEFORE: f64 = 12.0;
const DOWN: f64 = 4.0;
const AFTER: f64 = 8.0;
/// The lines are compared up to a distance of this many line widths.
const APART: f64 = 1.2;
/// A line from this many line widths on shows its own middle.
const ALONE: f64 = 0.7;
/// A meeting at an angle has to explain the edge better than a touch by this factor.
const ANGLE: f64 = 2.0;
/// A line that meets the body at a larger slope (27 degrees) is a tee, whose arms tell its place better.
const STEEPEST: f64 = 0.5;
/// Root mean square deviation of the edge from its explanation, in line widths and pixels, from which it is none.
const MISFIT: f64 = 0.1;
const MISFIT_PIXELS: f64 = 0.15;
/// An edge comes down by at least this share of the line's width.
const LOWER: f64 = 0.04;
/// An edge that turns back by this share of the line's width is another's.
const JUMP: f64 = 0.3;
/// The fewest places at which the edge must bulge.
const FEWEST: usize = 6;

/// Leads every end that runs into a body at a small angle to the place where it meets the body.
pub(in crate::graph) fn merge(image: &LineImage, lines: &mut [Streamline]) {
    let index = LineIndex::new(lines);
    let ends = ends(image, lines);
    let is_open = |end: &&End| !end.stop.is_cut_off() && !matches!(end.stop, Stop::Settled | Stop::Joined);
    let solved = |end: &End| Some((end.line, end.side, solve(image, lines, &index, end)?));
    let solved: Vec<(usize, usize, Ending)> =
        ends.par_iter().filter_map(|end| solved(end.as_ref().filter(is_open)?)).collect();
    for (line, side, ending) in solved {
        ending.apply(&mut lines[line], side);
    }
}

/// A place beside the body: how far along it, and how far away.
#[derive(Clone, Copy)]
struct Sample {
    s: f64,
    y: f64,
    /// Half the width of the line whose edge was measured, 0 where it was its middle: at a slope the edge is further away,
    /// by the secant.
    half: f64,
}

/// How a line leaves the body.
#[derive(Clone, Copy, Debug)]
struct Leave {
    /// Where, along the body.
    s0: f64,
    slope: f64,
    curvature: f64,
    /// Sum of squares.
    error: f64,
}

impl Leave {
    /// How much further away the edge is measured than the middle and half a width, for the slope there.
    fn secant(&self, p: &Sample) -> f64 {
        let u = (p.s - self.s0).max(0.0);
        let k = self.curvature * u;
        let slope = if self.slope > 0.0 { self.slope + k } else { k / (1.0 - k * k).max(0.1).sqrt() };
        p.half * ((1.0 + slope * slope).sqrt() - 1.0)
    }

    /// From where on the line's edge lies outside the body's: a slanting line's is ahead of its middle.
    fn first(&self, half: f64) -> f64 {
        if self.slope <= 0.0 {
            return self.s0;
        }
        self.s0 - half * ((1.0 + self.slope * self.slope).sqrt() - 1.0) / self.slope
    }

    /// Distance from the body at a place.
    fn at(&self, s: f64) -> f64 {
        let u = s - self.s0;
        if self.slope > 0.0 {
            return self.slope * u + 0.5 * self.curvature * u * u.max(0.0);
        }
        // A circle, as far as it goes.
        let k = self.curvature;
        if k * u < 0.9 { k * u * u / (1.0 + (1.0 - k * k * u * u).sqrt()) } else { 0.5 * k * u * u }
    }
}

fn solve(image: &LineImage, lines: &[Streamline], index: &LineIndex, end: &End) -> Option<Ending> {
    let lw = image.line_width;
    let body = *bodies(lines, index, end, NEAR * lw).first()?;
    let arriving = arm_line(&end.tail, point_at(&lines[body.line], body.at), lw).1;
    if arriving.dot(direction(lines, body)).abs() < ARRIVING {
        return None;
    }
    let frame = Frame::new(lines, body, end, lw)?;
    let widths = [end.width, width_at(lines, body, lw)];
    let own = frame.own(&lines[end.line], end.side, APART.max(ALONE) * lw + lw);
    let edge = frame.edge(image, widths[0], APART * lw);
    let bulging = edge.iter().filter(|e| e.y > 0.12 * lw.max(2.0)).count();
    if bulging < FEWEST {
        return None;
    }
    let alone = own.iter().position(|(sample, is_single)| *is_single && sample.y > ALONE * lw)?;
    let samples: Vec<Sample> = edge.into_iter().chain(own[alone..].iter().map(|o| o.0)).collect();
    let leave = leave(&samples, 0.5 * (widths[1] - widths[0]))?;
    if leave.slope > STEEPEST {
        return None;
    }
    let deviation = (leave.error / samples.len() as f64).sqrt();
    if deviation > (MISFIT * lw).max(MISFIT_PIXELS) {
        return None;
    }
    // Where the body ends as well, two lines make a corner.
    let goes_on = |s: f64| frame.index(s).is_some();
    if leave.slope > 0.0 && !(goes_on(leave.s0 - CLEAR * lw) && goes_on(leave.s0 + CLEAR * lw)) {
        return None;
    }
    let last = own[alone].0.s;
    let count = ((last - leave.s0) / STEP) as i64;
    if count < 1 {
        return None;
    }
    let at = |k: i64| leave.s0 + STEP * k as f64;
    let points: Vec<Point> = (0..count).map(|k| frame.point(at(k), leave.at(at(k)))).collect::<Option<_>>()?;
    Some(Ending { points, replaced: alone })
}

/// The lines that an end runs along, the nearest first, each where it is nearest.
pub(in crate::graph) fn bodies(lines: &[Streamline], index: &LineIndex, end: &End, radius: f64) -> Vec<Place> {
    let mut bodies: Vec<Place> = Vec::new();
    for (place, ..) in index.near(end.point, radius) {
        let direction = direction_at(&lines[place.line], place.at as usize);
        let is_along = direction.dot(end.tail.heading).abs() > ALONG;
        if is_along && place.line != end.line && bodies.iter().all(|body| body.line != place.line) {
            bodies.push(place);
        }
    }
    bodies
}

/// The body as an axis: `s` grows the way the line leaves it, `y` to the line's side.
struct Frame<'a> {
    body: &'a Streamline,
    /// Index of the body's point at `s = 0`, and which way indices go.
    origin: f64,
    forward: f64,
    side: f64,
    /// Half of the stretch that is looked at, in pixels.
    range: [f64; 2],
}

impl<'a> Frame<'a> {
    fn new(lines: &'a [Streamline], place: Place, end: &End, line_width: f64) -> Option<Self> {
        let body = &lines[place.line];
        let along = direction_at(body, place.at as usize);
        let forward = -along.dot(end.tail.heading).signum();
        let n = lines[end.line].points.len();
        let inner = ((4.0 * line_width / STEP) as usize).min(n - 1);
        let inside = lines[end.line].points[if end.side == 0 { inner } else { n - 1 - inner }];
        let mut frame =
            Self { body, origin: place.at, forward, side: 1.0, range: [BEFORE * line_width, AFTER * line_width] };
        // The side is that of the line before it comes near.
        let (_, y) = frame.locate(inside)?;
        frame.side = y.signum();
        Some(frame)
    }

    /// Index of the body's point at a distance along it; `None` beyond its ends.
    fn index(&self, s: f64) -> Option<usize> {
        let n = self.body.points.len() as i64;
        let k = (self.origin + self.forward * s / STEP).round() as i64;
        let k = if self.body.closed { k.rem_euclid(n) } else { k };
        (0..n).contains(&k).then_some(k as usize)
    }

    fn normal(&self, k: usize) -> Vec2 {
        direction_at(self.body, k).turn_90() * (self.side * self.forward)
    }

    /// The point at a distance along the body and away from it.
    fn point(&self, s: f64, y: f64) -> Option<Point> {
        let k = self.index(s)?;
        Some(self.body.points[k] + self.normal(k) * y)
    }

    /// Where a point lies beside the body.
    fn locate(&self, p: Point) -> Option<(f64, f64)> {
        let count = |pixels: f64| (pixels / STEP) as i64;
        let places = (-count(self.range[0])..=count(self.range[1])).map(|i| STEP * i as f64);
        let known = places.filter_map(|s| Some((s, self.index(s)?)));
        let (s, k) = known.min_by(|a, b| {
            let d = |k: usize| (self.body.points[k] - p).hypot2();
            d(a.1).total_cmp(&d(b.1))
        })?;
        Some((s, (p - self.body.points[k]).dot(self.normal(k))))
    }

    /// The line's own points from its end on, up to a distance from the body, and whether each is alone.
    fn own(&self, line: &Streamline, side: usize, reach: f64) -> Vec<(Sample, bool)> {
        let n = line.points.len();
        let index = |k: usize| if side == 0 { k } else { n - 1 - k };
        let own = (0..n).map_while(|k| {
            let (s, y) = self.locate(line.points[index(k)])?;
            (y < reach).then_some((Sample { s, y, half: 0.0 }, line.widths[index(k)].is_finite()))
        });
        own.take((4.0 * self.range[1] / STEP) as usize).collect()
    }

    /// How far the line's middle must be from the body's for the edge of their ink to lie where it does.
    ///
    /// Before the end the edge comes down to the body's own, until another line leaves; after it, it goes up until there
    /// is paper between the two lines.
    fn edge(&self, image: &LineImage, own: f64, apart: f64) -> Vec<Sample> {
        let at = |i: i64| {
            let s = STEP * i as f64;
            let k = self.index(s)?;
            let edge = edge(image, self.body.points[k], self.normal(k), 0.5 * own + apart)?;
            Some(Sample { s, y: edge - 0.5 * own, half: 0.5 * own })
        };
        let count = self.range.map(|pixels| (pixels / STEP) as i64);
        let (mut lowest, mut down) = (f64::MAX, 0.0);
        let before = (0..=count[0]).map_while(|i| at(-i)).take_while(|sample| {
            if sample.y < lowest - LOWER * own {
                (lowest, down) = (sample.y, sample.s);
            }
            sample.y < lowest + JUMP * own && down - sample.s <= DOWN * own
        });
        let mut samples: Vec<Sample> = before.collect();
        samples.reverse();
        let mut highest = f64::MIN;
        samples.extend((1..=count[1]).map_while(at).take_while(|sample| {
            highest = highest.max(sample.y);
            sample.y > highest - JUMP * own
        }));
        samples
    }
}

/// Distance from a point in the ink to its edge, up to `reach`.
fn edge(image: &LineImage, p: Point, normal: Vec2, reach: f64) -> Option<f64> {
    const SPACING: f64 = 0.25;
    let at = |k: usize| image.ink.sample(p + normal * (SPACING * k as f64));
    let half = 0.5 * at(0).min(1.0);
    if half < 0.15 {
        return None;
    }
    let k = (1..=(reach / SPACING) as usize).find(|&k| at(k) < half)?;
    let (inside, outside) = (at(k - 1), at(k));
    Some(SPACING * (k as f64 - 1.0 + f64::from((inside - half) / (inside - outside))))
}

/// The best explanation of the samples; `rest` is what `y` measures where only the body is.
fn leave(samples: &[Sample], rest: f64) -> Option<Leave> {
    let (first, last) = (samples.first()?.s, samples.iter().map(|s| s.s).fold(f64::MIN, f64::max));
    let count = ((last - first) / STEP) as i64 - 3;
    let starts = (2..count).map(|k| first + STEP * k as f64);
    let both: Vec<[Option<Leave>; 2]> = starts.map(|s0| [touch(samples, s0, rest), angle(samples, s0, rest)]).collect();
    let best = |which: usize| both.iter().filter_map(|l| l[which]).min_by(|a, b| a.error.total_cmp(&b.error));
    match (best(0), best(1)) {
        (Some(touch), Some(angle)) if angle.error * ANGLE < touch.error => Some(angle),
        (touch, angle) => touch.or(angle),
    }
}

/// Rounds in which what the slope adds to the edge is found.
const ROUNDS: usize = 3;

/// A circle that touches the body at `s0`.
fn touch(samples: &[Sample], s0: f64, rest: f64) -> Option<Leave> {
    let mut leave = Leave { s0, slope: 0.0, curvature: 0.0, error: 0.0 };
    for _ in 0..ROUNDS {
        let (mut qq, mut qy) = (0.0, 0.0);
        for p in samples.iter().filter(|p| p.s > s0) {
            let y = p.y - leave.secant(p);
            let q = 0.5 * ((p.s - s0).powi(2) + y * y);
            (qq, qy) = (qq + q * q, qy + q * y);
        }
        leave.curvature = qy / qq;
        if leave.curvature.is_nan() || leave.curvature <= 0.0 {
            return None;
        }
    }
    Some(with_error(samples, rest, leave))
}

/// A line that meets the body at `s0` at an angle.
fn angle(samples: &[Sample], s0: f64, rest: f64) -> Option<Leave> {
    let mut leave = Leave { s0, slope: 0.0, curvature: 0.0, error: 0.0 };
    for _ in 0..ROUNDS {
        let (mut uu, mut uq, mut qq, mut uy, mut qy) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for p in samples.iter().filter(|p| p.s > leave.first(p.half)) {
            let (u, y) = (p.s - s0, p.y - leave.secant(p));
            let q = 0.5 * u * u;
            (uu, uq, qq, uy, qy) = (uu + u * u, uq + u * q, qq + q * q, uy + u * y, qy + q * y);
        }
        let det = uu * qq - uq * uq;
        if det < 1e-9 {
            return None;
        }
        (leave.slope, leave.curvature) = ((uy * qq - qy * uq) / det, (qy * uu - uy * uq) / det);
        if leave.slope <= 0.0 {
            return None;
        }
    }
    Some(with_error(samples, rest, leave))
}

fn with_error(samples: &[Sample], rest: f64, leave: Leave) -> Leave {
    let at = |p: &Sample| if p.s > leave.first(p.half) { (leave.at(p.s) + leave.secant(p)).max(rest) } else { rest };
    Leave { error: samples.iter().map(|p| (p.y - at(p)).powi(2)).sum(), ..leave }
}
