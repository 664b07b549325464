//! Pieces become segments that meet, and keep to their points.

use super::Tolerance;
use super::fillet::{CHORDS, rounded};
use super::joints::{Draft, Joint, change, draft, placed, segments};
use super::samples::Samples;
use super::segmentation::{Kind, Piece};
use crate::drawing::Segment;
use kurbo::{Line, ParamCurveNearest, Point, Vec2};

/// A joined curve may miss its points by this many times what is taken for noise, root mean square.
const MISFIT: f64 = 1.2;
/// Lines shorter than this many line widths give way to a curve beside them.
const SHORT: f64 = 5.0;
/// How many pieces of a section are given more freedom.
const REPAIRS: usize = 4;
/// Steps by which a joint is tried elsewhere: of its tangent, in radians (3 degrees); of its place to a side and along, in
/// line widths. No vertex of a parabola through three tries is followed further than so many of them.
const TURN: f64 = 0.05;
const SIDE: f64 = 0.05;
const ALONG: f64 = 0.5;
const MOST_STEPS: f64 = 3.0;
/// At most so many points tell how well a piece keeps to them.
const TOLD: usize = 80;
/// A segment has gone astray where it is further from its points than so many line widths, which no sharp corner is, at
/// one of so many places.
const ASTRAY: f64 = 2.0;
const LOOKED_AT: u32 = 8;

/// The segments of a section. `closed` sections join their last piece to their first. Ends of an open section
/// keep to `ends` where given.
///
/// A tangent taken over from a neighbour can hold a curve off its points. Then the joints at its ends are turned and moved
/// to where both pieces are best off; if that is not enough, a short line beside it gives way and becomes a curve itself,
/// or else the curve is cut in two.
pub(super) fn join(
    samples: &Samples,
    pieces: &[Piece],
    closed: bool,
    ends: [Option<Point>; 2],
    tolerance: Tolerance,
) -> Vec<Segment> {
    let mut pieces = rounded(samples, pieces, closed, tolerance);
    let mut repairs = 0;
    loop {
        let mut chain = Chain::new(samples, &pieces, closed, ends, tolerance);
        for k in 0..pieces.len() {
            if chain.misfit(k) > MISFIT {
                chain.ease(k);
            }
        }
        let misfits = (0..pieces.len()).map(|k| (k, chain.misfit(k)));
        let worst = misfits.max_by(|a, b| a.1.total_cmp(&b.1)).filter(|worst| worst.1 > MISFIT && repairs < REPAIRS);
        repairs += 1;
        match worst {
            Some((k, _)) if repair(samples, &mut pieces, k, closed, tolerance) => {}
            _ if chain.is_astray() => return polyline(samples, ends, tolerance),
            _ => return chain.segments.concat(),
        }
    }
}

/// Pieces with the joints between them.
struct Chain<'a> {
    samples: &'a Samples,
    tolerance: Tolerance,
    deviation: f64,
    closed: bool,
    drafts: Vec<Draft>,
    joints: Vec<Joint>,
    segments: Vec<Vec<Segment>>,
}

impl<'a> Chain<'a> {
    fn new(
        samples: &'a Samples,
        pieces: &[Piece],
        closed: bool,
        ends: [Option<Point>; 2],
        tolerance: Tolerance,
    ) -> Self {
        let deviation = tolerance.deviation(samples);
        let drafts: Vec<Draft> = pieces.iter().map(|&p| draft(samples, p, tolerance)).collect();
        let joints = placed(samples, &drafts, closed, ends, tolerance);
        let mut chain = Self { samples, tolerance, deviation, closed, drafts, joints, segments: Vec::new() };
        chain.segments = (0..pieces.len()).map(|k| chain.drawn(k)).collect();
        chain
    }

    fn drawn(&self, k: usize) -> Vec<Segment> {
        segments(self.samples, &self.drafts[k], self.joints[k], self.joints[k + 1], self.tolerance, self.deviation)
    }

    /// How far a curved piece's points lie off its segments, root mean square, over what is noise; 0 for a line.
    fn misfit(&self, k: usize) -> f64 {
        let (draft, segments) = (&self.drafts[k], &self.segments[k]);
        let noise = self.deviation.max(draft.deviation);
        let noise = if let [Segment::Arc(_)] = segments[..] { noise.max(CHORDS) } else { noise };
        misfit(self.samples, draft.piece, segments) / noise
    }

    /// Whether some segment leads where there are no points, of its own piece or of those beside it.
    fn is_astray(&self) -> bool {
        let least = (ASTRAY * self.tolerance.width).powi(2);
        let courses: Vec<Vec<Point>> = self.drafts.iter().map(|draft| self.course(draft.piece)).collect();
        (0..courses.len()).any(|k| {
            let off = |p: Point| {
                let lines = self.around(k).flat_map(|i| courses[i].windows(2));
                lines.map(|w| Line::new(w[0], w[1])).all(|line| line.nearest(p, 1e-6).distance_sq > least)
            };
            let places = |s: &Segment| (0..=LOOKED_AT).map(|t| s.eval(f64::from(t) / f64::from(LOOKED_AT))).collect();
            self.segments[k].iter().flat_map(|s| -> Vec<Point> { places(s) }).any(off)
        })
    }

    /// A piece and those beside it.
    fn around(&self, k: usize) -> impl Iterator<Item = usize> + use<> {
        let n = self.drafts.len();
        let beside =
            if self.closed { [(k + n - 1) % n, (k + 1) % n] } else { [k.saturating_sub(1), (k + 1).min(n - 1)] };
        std::iter::once(k).chain(beside)
    }

    /// Points of a piece, as many as tell enough.
    fn course(&self, Piece { from, to, .. }: Piece) -> Vec<Point> {
        told(from, to).chain([to]).map(|k| self.samples.points[k]).collect()
    }

    /// Turns and moves the joints of a piece so that it and its neighbours keep to their points. Lines keep their course.
    fn ease(&mut self, k: usize) {
        let n = self.drafts.len();
        for j in [k, k + 1] {
            let is_end = !self.closed && (j == 0 || j == n);
            if is_end || self.joints[j].tangent.is_none() {
                continue;
            }
            let sides = [(j + n - 1) % n, j % n];
            let kinds = sides.map(|i| self.drafts[i].piece.kind);
            if !kinds.contains(&Kind::Line) {
                self.search(j, sides, Joint::turned);
                self.search(j, sides, Joint::shifted);
            } else if kinds.contains(&Kind::Cubic) {
                self.search(j, sides, Joint::slid);
            }
        }
    }

    /// Puts a joint at the best of a step to either side and the vertex of the parabola through the three.
    fn search(&mut self, j: usize, sides: [usize; 2], moved: fn(Joint, f64, f64) -> Joint) {
        let (joint, width) = (self.joints[j], self.tolerance.width);
        let mut cost = |by: f64| {
            change(&mut self.joints, j, self.closed, |at| *at = moved(joint, by, width));
            sides.iter().for_each(|&i| self.segments[i] = self.drawn(i));
            self.cost(sides)
        };
        let (back, still, forth) = (cost(-1.0), cost(0.0), cost(1.0));
        let bend = back + forth - 2.0 * still;
        let vertex = if bend > 0.0 { 0.5 * (back - forth) / bend } else { (back - forth).signum() * MOST_STEPS };
        let vertex = if vertex.is_finite() { vertex.clamp(-MOST_STEPS, MOST_STEPS) } else { 0.0 };
        let tries = [(0.0, still), (-1.0, back), (1.0, forth), (vertex, cost(vertex))];
        if let Some((best, _)) = tries.into_iter().min_by(|a, b| a.1.total_cmp(&b.1)) {
            cost(best);
        }
    }

    /// Sum of the squared distances of two neighbours' points from both; infinite where a line has turned back.
    fn cost(&self, sides: [usize; 2]) -> f64 {
        let turned_back = |i: usize| {
            let draft = &self.drafts[i];
            let line = |s: &Segment| (s.end() - s.start()).dot(draft.start_tangent) <= 0.0;
            draft.piece.kind == Kind::Line && self.segments[i].iter().any(line)
        };
        if sides.into_iter().any(turned_back) {
            return f64::INFINITY;
        }
        let both = sides.map(|i| &self.segments[i][..]).concat();
        let pieces = sides.map(|i| self.drafts[i].piece);
        pieces.iter().map(|p| misfit(self.samples, *p, &both).powi(2) * (p.to - p.from) as f64).sum()
    }
}

impl Joint {
    /// With the tangent turned by steps.
    fn turned(self, by: f64, _: f64) -> Self {
        let turn = |tangent: Vec2| Vec2::from_angle(tangent.atan2() + TURN * by);
        Self { tangent: self.tangent.map(turn), ..self }
    }

    /// Moved to a side by steps.
    fn shifted(self, by: f64, width: f64) -> Self {
        let normal = self.tangent.map_or(Vec2::ZERO, Vec2::turn_90);
        Self { point: self.point + normal * (SIDE * by * width), ..self }
    }

    /// Moved along the tangent by steps.
    fn slid(self, by: f64, width: f64) -> Self {
        Self { point: self.point + self.tangent.unwrap_or(Vec2::ZERO) * (ALONG * by * width), ..self }
    }
}

/// As many of some samples as tell enough.
fn told(from: usize, to: usize) -> impl Iterator<Item = usize> {
    (from..=to).step_by((to - from).div_ceil(TOLD).max(1))
}

/// Lines from sample to sample about a line width apart: what no piece explains is drawn as it is.
fn polyline(samples: &Samples, ends: [Option<Point>; 2], tolerance: Tolerance) -> Vec<Segment> {
    let last = samples.len() - 1;
    let mut points: Vec<Point> = Vec::new();
    let mut next = 0.0;
    for (k, &p) in samples.points.iter().enumerate() {
        if k == last || samples.arc[k] >= next {
            points.push(p);
            next = samples.arc[k] + tolerance.width;
        }
    }
    let n = points.len();
    points[0] = ends[0].unwrap_or(points[0]);
    points[n - 1] = ends[1].unwrap_or(points[n - 1]);
    points.windows(2).map(|w| Segment::Line(Line::new(w[0], w[1]))).collect()
}

/// Root mean square distance of a curved piece's samples from its segments; 0 for a line.
fn misfit(samples: &Samples, piece: Piece, segments: &[Segment]) -> f64 {
    if piece.kind == Kind::Line {
        return 0.0;
    }
    let curve: Vec<Point> = segments.iter().flat_map(|s| (0..=32).map(|k| s.eval(f64::from(k) / 32.0))).collect();
    let (mut sum, mut weight) = (0.0, 0.0);
    for k in told(piece.from, piece.to) {
        let p = samples.points[k];
        let nearest = curve.windows(2).map(|w| Line::new(w[0], w[1]).nearest(p, 1e-6).distance_sq);
        sum += samples.weights[k] * nearest.fold(f64::MAX, f64::min);
        weight += samples.weights[k];
    }
    (sum / weight.max(1e-9)).sqrt()
}

/// Gives a piece that misses its points more freedom; `false` when there is none to give.
fn repair(samples: &Samples, pieces: &mut Vec<Piece>, k: usize, closed: bool, tolerance: Tolerance) -> bool {
    let n = pieces.len();
    let neighbours = [(k > 0 || closed).then(|| (k + n - 1) % n), (k + 1 < n || closed).then(|| (k + 1) % n)];
    let is_short = |p: &Piece| samples.arc[p.to] - samples.arc[p.from] < SHORT * tolerance.width;
    let short: Vec<usize> =
        neighbours.into_iter().flatten().filter(|&j| pieces[j].kind == Kind::Line && is_short(&pieces[j])).collect();
    if !short.is_empty() {
        short.iter().for_each(|&j| pieces[j].kind = Kind::Cubic);
        return true;
    }
    let Piece { from, to, .. } = pieces[k];
    let middle = samples.arc.partition_point(|&a| a < 0.5 * (samples.arc[from] + samples.arc[to]));
    if middle < from + 3 || middle + 3 > to {
        return false;
    }
    pieces
        .splice(k..=k, [Piece { from, to: middle, kind: Kind::Cubic }, Piece { from: middle, to, kind: Kind::Cubic }]);
    true
}
