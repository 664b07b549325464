//! Where a line that runs into another at a small angle leaves it.
//!
//! Long before two inks part, the edge of their union bulges: at a place `s` along the other line, the body, the outer
//! edge lies at `max(w_body / 2, y(s) + w / 2)` from the body's middle, where `y` is how far the line of width `w` is from
//! it. With `u = s - s0` after the place `s0` where they meet, `y = (u^2 + y^2) / 2R` for a circle that touches the body
//! and `y = m u + c u^2 / 2` for a line that meets it at an angle. The `s0` that explains the edge best, in least squares,
//! is the node; up to where the line is alone again, its middle is what was solved.

use super::leave::{Sample, leave};
use crate::clean::LineImage;
use crate::graph::lines::{End, EndState, Lead, Line, Lines, Place, arm_line};
use crate::streamline::STEP;
use kurbo::{Point, Vec2};
use rayon::prelude::*;

/// A body is looked for within this many line widths of an end, running along it within this cosine's angle (50 degrees).
const NEAR: f64 = 1.2;
const ALONG_COS: f64 = 0.64;
/// The end's course, drawn out to the body, comes in within this cosine's angle (35 degrees).
const ARRIVING_COS: f64 = 0.82;
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
/// A line that meets the body at a larger slope (27 degrees) is a tee, whose arms tell its place better.
const STEEPEST: f64 = 0.5;
/// Root mean square deviation of the edge from its explanation, in line widths and pixels, from which it is none.
const MISFIT: f64 = 0.1;
const MISFIT_PIXELS: f64 = 0.15;
/// An edge comes down by at least this share of the line's width.
const LOWER: f64 = 0.04;
/// An edge that turns back by this share of the line's width is another's.
const JUMP: f64 = 0.3;
/// The edge bulges where it is further out than this, in line widths, of a pen of at least so many pixels; there are at least
/// so many such places.
const BULGE: f64 = 0.12;
const THICK: f64 = 2.0;
const FEWEST: usize = 6;
/// Fainter ink than twice this, as a share of full ink, has no edge.
const FAINT: f32 = 0.15;
/// Of the line's own points, so many times as many are looked at as of the body's edge after the end.
const OWN: f64 = 4.0;
/// On which side of the body a line lies is told this many line widths from its end.
const INSIDE: f64 = 4.0;

/// Leads every end that runs into a body at a small angle to the place where it meets the body. Returns how many there are.
pub(in crate::graph) fn lead(image: &LineImage, lines: &mut Lines) -> usize {
    let is_open = |end: &&End| matches!(end.state, EndState::Open | EndState::RanIn | EndState::Parted);
    let solved = |end: &End| Some((end.line, end.side, solve(image, lines, end)?));
    let ends = lines.ends(image).par_iter().flatten().filter(is_open);
    let solved: Vec<(usize, usize, Lead)> = ends.filter_map(solved).collect();
    let count = solved.len();
    for (line, side, lead) in solved {
        lines.lead(line, side, lead);
    }
    count
}

fn solve(image: &LineImage, lines: &Lines, end: &End) -> Option<Lead> {
    let lw = image.line_width;
    let body = *bodies(lines, end, NEAR * lw).first()?;
    let arriving = arm_line(&end.tail, lines.point(body), lw).1;
    if arriving.dot(lines.direction(body)).abs() < ARRIVING_COS {
        return None;
    }
    let frame = Frame::new(lines, body, end, lw)?;
    let widths = [end.width, lines.width(body, lw)];
    let own = frame.own(&lines[end.line], end.side, APART.max(ALONE) * lw + lw);
    let edge = frame.edge(image, widths[0], APART * lw);
    let bulging = edge.iter().filter(|e| e.y > BULGE * lw.max(THICK)).count();
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
    Some(Lead { points, replaced: alone })
}

/// The lines that an end runs along, the nearest first, each where it is nearest.
pub(super) fn bodies(lines: &Lines, end: &End, radius: f64) -> Vec<Place> {
    let mut bodies: Vec<Place> = Vec::new();
    for (place, ..) in lines.near(end.point, radius) {
        let direction = lines.direction(place);
        let is_along = direction.dot(end.tail.heading).abs() > ALONG_COS;
        if is_along && place.line != end.line && bodies.iter().all(|body| body.line != place.line) {
            bodies.push(place);
        }
    }
    bodies
}

/// The body as an axis: `s` grows the way the line leaves it, `y` to the line's side.
struct Frame<'a> {
    body: &'a Line,
    /// Index of the body's point at `s = 0`, and which way indices go.
    origin: f64,
    forward: f64,
    side: f64,
    /// Half of the stretch that is looked at, in pixels.
    range: [f64; 2],
}

impl<'a> Frame<'a> {
    fn new(lines: &'a Lines, place: Place, end: &End, line_width: f64) -> Option<Self> {
        let body = &lines[place.line];
        let along = lines.direction(place);
        let forward = -along.dot(end.tail.heading).signum();
        let line = &lines[end.line];
        let inside = line.at_end(end.side, ((INSIDE * line_width / STEP) as usize).min(line.points.len() - 1));
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
        self.body.direction_at(k).turn_90() * (self.side * self.forward)
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
    fn own(&self, line: &Line, side: usize, reach: f64) -> Vec<(Sample, bool)> {
        let own = (0..line.points.len()).map_while(|k| {
            let (s, y) = self.locate(line.at_end(side, k))?;
            (y < reach).then_some((Sample { s, y, half: 0.0 }, line.is_alone(line.inwards(side, k))))
        });
        own.take((OWN * self.range[1] / STEP) as usize).collect()
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
    if half < FAINT {
        return None;
    }
    let k = (1..=(reach / SPACING) as usize).find(|&k| at(k) < half)?;
    let (inside, outside) = (at(k - 1), at(k));
    Some(SPACING * (k as f64 - 1.0 + f64::from((inside - half) / (inside - outside))))
}
