//! One walk along the field.

use super::coverage::{Coverage, Mark};
use super::heading::{Tail, angle_between, turned};
use super::seeds::Seed;
use super::straight::{Comer, Straight, Straights};
use super::{STEP, Stop, Streamline};
use crate::clean::LineImage;
use crate::field::FrameField;
use crate::profile::{Profile, cross_profile};
use kurbo::{Point, Vec2};

/// A root further than this from the heading (35 degrees) is another line's.
const OWN_ROOT: f64 = 0.61;
/// Share of the lateral error that one step takes back.
const PULL: f64 = 0.5;
/// How much a walk beside the ink's middle turns towards it, radians per line width of error. In tight bends,
/// where the field knows two directions and the nearer one lags behind, this carries the walk round.
const STEER: f64 = 0.8;
/// The tightest turn, as a radius in line widths.
const TIGHTEST: f64 = 0.5;
/// How many line widths of past single profiles tell the heading through a junction.
const MEMORY: f64 = 6.0;
/// How near another streamline of the same direction must be to cover a point, in line widths.
const COVERED: f64 = 0.35;
/// How far to coast along covered ink in the hope of coming out on its other side, in line widths.
const COAST_COVERED: f64 = 8.0;

/// A walk that is back within so many line widths on the line that it ran along has only strayed from it.
const BACK_IN: f64 = 4.0;

/// A walk is led round for no longer than so many line widths, onto a straight line that it meets at no less than 25 degrees.
const LED: f64 = 6.0;
const TEE_COS: f64 = 0.906;

/// A line that was led round has ended where its middle has lost this share of its ink.
const ENDED: f32 = 0.5;

/// A point of a walk.
struct Step {
    point: Point,
    heading: Vec2,
    /// Ink width; NaN where the profile is not single.
    width: f64,
    /// How far the ink's middle lay beside the walk, along the normal; the line turns that way.
    drift: f64,
}

/// A stretch of a walk through ink that is covered already.
#[derive(Clone, Copy)]
struct Covered {
    /// The step at which it began.
    from: usize,
    /// The streamline that it runs along.
    beside: u32,
}

/// Follows one line from a seed, both ways.
pub(super) struct Walker<'a, 'b> {
    image: &'a LineImage,
    frames: &'a FrameField,
    coverage: &'b mut Coverage<'a>,
    straights: &'b mut Straights,
    id: u32,
    /// Running estimates of the line's width and of the ink in its middle.
    width: f64,
    core: f32,
}

impl<'a, 'b> Walker<'a, 'b> {
    pub fn new(
        image: &'a LineImage,
        frames: &'a FrameField,
        coverage: &'b mut Coverage<'a>,
        straights: &'b mut Straights,
        id: u32,
    ) -> Self {
        Self { image, frames, coverage, straights, id, width: image.line_width, core: 1.0 }
    }

    /// The width of the line at the end of the last walk.
    pub fn width(&self) -> f64 {
        self.width
    }

    /// The streamline through a seed.
    pub fn trace(&mut self, seed: &Seed) -> Streamline {
        let (start, width) = seed.line(self.image).unwrap_or((seed.point, self.width));
        self.width = width;
        self.core = self.image.ink.sample(start).max(0.3);
        self.both_ways(vec![Step { point: start, heading: seed.tangent, width: self.width, drift: 0.0 }])
    }

    /// A straight line, and where it goes on from its ends.
    pub fn extend(&mut self, straight: &Straight) -> Streamline {
        self.width = straight.width;
        let steps: Vec<Step> = along(straight).collect();
        let core = steps.iter().map(|s| self.image.ink.sample(s.point)).sum::<f32>() / steps.len() as f32;
        self.core = core.max(0.3);
        self.both_ways(steps)
    }

    /// Walks on from the last of `start`, and back from its first.
    fn both_ways(&mut self, start: Vec<Step>) -> Streamline {
        let width = self.width;
        let (forward, forward_stop, closed) = self.walk(start, 1);
        if closed {
            return streamline(&forward, true, [Stop::InkEnd; 2]);
        }
        self.width = width;
        // The walk back starts on the forward walk's first points, so that its heading has a memory.
        let memory = (MEMORY * self.width / STEP) as usize;
        let reversed = forward.iter().take(memory).rev();
        let past: Vec<Step> =
            reversed.map(|s| Step { point: s.point, heading: -s.heading, width: s.width, drift: 0.0 }).collect();
        let known = past.len();
        let (backward, backward_stop, _) = self.walk(past, -1);
        let mut steps: Vec<Step> = backward.into_iter().skip(known).rev().collect();
        steps.extend(forward);
        streamline(&steps, false, [backward_stop, forward_stop])
    }

    /// Walks on from the last of `steps`; returns all steps, why it stopped, and whether it closed a loop.
    fn walk(&mut self, mut steps: Vec<Step>, sign: i32) -> (Vec<Step>, Stop, bool) {
        let known = steps.len();
        // Steps count from the first of the walk forward.
        let first = if sign > 0 { known as i32 - 1 } else { 0 };
        let limit = 16 * (self.coverage.ink_pixels + 64);
        let mut covered: Option<Covered> = None;
        // Steps that are no longer taken back.
        let mut sure = known;
        let (mut free_run, mut covered_run) = (0, 0);
        // The last covered stretch, and where the walk came out of it.
        let mut came_out: Option<(Covered, usize)> = None;
        loop {
            let index = first + sign * (steps.len() - known) as i32;
            let here = &steps[steps.len() - 1];
            self.coverage.add(Mark {
                point: here.point,
                heading: here.heading * f64::from(sign),
                streamline: self.id,
                index,
            });
            let Some(mut next) = self.advance(&steps, covered.is_some()) else {
                let Some(stretch) = covered else {
                    let stop = self.stop_at(here);
                    if stop == Stop::Solid {
                        let (point, heading) = (here.point + here.heading * (2.0 * STEP), here.heading);
                        steps.push(Step { point, heading, width: f64::NAN, drift: 0.0 });
                    }
                    return (steps, stop, false);
                };
                return (self.up_to(stretch, steps, sure), Stop::Merged, false);
            };
            let covering = self.covering(&next, index);
            if let Some(mark) = covering
                && mark.streamline == self.id
                && sign > 0
                && f64::from(mark.index) * STEP < 2.0 * self.width
                && mark.heading.dot(next.heading) > 0.9
                && covered.is_none()
            {
                return (steps, Stop::Merged, true);
            }
            if covered.is_none()
                && let Some(mark) = covering
                && let Some(ahead) =
                    self.straights.take_in(self.coverage, &mark, &self.comer(&next, index + sign, sign))
            {
                steps.extend(along(&ahead));
                sure = steps.len();
                (covered_run, came_out) = (0, None);
                continue;
            }
            covered_run = if covering.is_some() { covered_run + 1 } else { 0 };
            let lasting = f64::from(covered_run) * STEP > self.width;
            match (covering, covered) {
                (Some(mark), None) if lasting || !next.width.is_nan() => {
                    let back = came_out.filter(|(last, out)| {
                        last.beside == mark.streamline && (steps.len() - out) as f64 * STEP < BACK_IN * self.width
                    });
                    let from = back.map_or(steps.len(), |(last, _)| last.from);
                    covered = Some(Covered { from, beside: mark.streamline });
                }
                (Some(mark), Some(stretch)) => {
                    free_run = 0;
                    covered = Some(Covered { beside: mark.streamline, ..stretch });
                }
                (None, Some(stretch)) => {
                    free_run += 1;
                    if f64::from(free_run) * STEP > 0.75 * self.width {
                        came_out = Some((stretch, steps.len()));
                        covered = None;
                        free_run = 0;
                    }
                }
                _ => {}
            }
            if let Some(stretch) = covered {
                next.width = f64::NAN;
                if (steps.len() - stretch.from) as f64 * STEP > COAST_COVERED * self.width {
                    return (self.up_to(stretch, steps, sure), Stop::Merged, false);
                }
            }
            steps.push(next);
            if steps.len() > limit {
                return (steps, Stop::Merged, false);
            }
        }
    }

    /// The steps of a walk that ended in a covered stretch, up to there. If it ran along a straight line that it had come to
    /// at an angle, it was led round on its ink: the line itself goes straight on, over all of it.
    fn up_to(&self, stretch: Covered, mut steps: Vec<Step>, sure: usize) -> Vec<Step> {
        steps.truncate(stretch.from.max(sure));
        let Some(straight) = self.straights.get(stretch.beside) else { return steps };
        let outside = |s: &Step| straight.distance(s.point) > 0.5 * (straight.width + self.width);
        let own = steps.iter().rposition(|s| outside(s) && !s.width.is_nan()).map_or(0, |last| last + 1);
        if own < sure || steps.len() - own > (LED * self.width / STEP) as usize {
            return steps;
        }
        let Some(tail) = self.tail(&steps[..own]) else { return steps };
        if tail.heading.dot(straight.heading()).abs() > TEE_COS {
            return steps;
        }
        steps.truncate(own);
        let heading = tail.heading;
        while let Some(last) = steps.last()
            && let point = last.point + heading * STEP
            && self.image.ink.sample(point) >= ENDED * self.core
        {
            steps.push(Step { point, heading, width: f64::NAN, drift: 0.0 });
        }
        steps
    }

    fn comer(&self, step: &Step, index: i32, sign: i32) -> Comer {
        let Step { point, heading, .. } = *step;
        Comer { point, heading, width: self.width, streamline: self.id, index, sign }
    }

    /// The point of the same direction that already covers a step, this walk's own latest points aside.
    fn covering(&self, step: &Step, index: i32) -> Option<Mark> {
        let radius = (COVERED * self.width).max(0.6);
        let own = (4.0 * self.width / STEP) as i32;
        self.coverage.nearest(step.point, step.heading, radius, |mark| {
            mark.streamline != self.id || (mark.index - index).abs() > own
        })
    }

    /// The next step, or `None` where the ink ends.
    fn advance(&mut self, steps: &[Step], coasting: bool) -> Option<Step> {
        let here = &steps[steps.len() - 1];
        let heading = self.next_heading(steps, coasting);
        let mut point = here.point + heading * STEP;
        if self.is_solid(point) {
            return None;
        }
        let normal = heading.turn_90();
        let inked = self.image.goes_on(point, heading, self.width, self.core);
        let profile = self.profile(point, normal).filter(|_| inked)?;
        if coasting {
            return Some(Step { point, heading, width: f64::NAN, drift: 0.0 });
        }
        if let Some(shift) = profile.shift(self.width) {
            point += normal * (PULL * shift).clamp(-0.35, 0.35);
        }
        let mut width = f64::NAN;
        if profile.is_single(self.width) {
            width = profile.width().unwrap_or(f64::NAN);
            self.width += 0.04 * (width - self.width);
            self.core += 0.04 * (self.image.ink.sample(point) - self.core);
        }
        let drift = if width.is_nan() { 0.0 } else { profile.middle().unwrap_or(0.0) };
        Some(Step { point, heading, width, drift })
    }

    /// On a single line, the field's root; inside a junction, the heading and curvature of the line so far.
    fn next_heading(&self, steps: &[Step], coasting: bool) -> Vec2 {
        let here = &steps[steps.len() - 1];
        let most = STEP / (TIGHTEST * self.width);
        let single = !here.width.is_nan() && !coasting;
        let ahead = here.point + here.heading * (0.5 * STEP);
        let root = self.frames.along(ahead, here.heading);
        let turn = root.map(|r| angle_between(here.heading, r)).filter(|t| t.abs() < OWN_ROOT);
        if single {
            let steer = STEER * here.drift / self.width;
            return turned(here.heading, (turn.unwrap_or(0.0) + steer).clamp(-most, most));
        }
        // The first step of a coast takes its heading from the line's whole recent course.
        let before = steps.len().checked_sub(2).map(|i| &steps[i]);
        let tail = self.tail(steps);
        let entering = before.is_none_or(|b| !b.width.is_nan());
        let heading = if entering { tail.map_or(here.heading, |t| t.heading) } else { here.heading };
        let curvature = tail.map_or(0.0, |t| t.curvature).clamp(-0.5 / self.width, 0.5 / self.width);
        let follow = if coasting { 0.0 } else { 0.1 * turn.unwrap_or(0.0) };
        turned(heading, (curvature * STEP + follow).clamp(-most, most))
    }

    /// The course of the last single profiles before the junction.
    fn tail(&self, steps: &[Step]) -> Option<Tail> {
        let last = steps.iter().rposition(|s| !s.width.is_nan())?;
        let memory = (MEMORY * self.width / STEP) as usize;
        let run = steps[..=last].iter().rev().take(memory).take_while(|s| !s.width.is_nan()).count();
        let points: Vec<Point> = steps[last + 1 - run..=last].iter().map(|s| s.point).collect();
        Tail::fit(&points, 0.1)
    }

    fn profile(&self, p: Point, normal: Vec2) -> Option<Profile> {
        cross_profile(&self.image.ink, p, normal, 0.85 * self.width + 1.0)
    }

    fn stop_at(&self, here: &Step) -> Stop {
        let p = here.point;
        let (w, h) = (self.image.mask.width() as f64, self.image.mask.height() as f64);
        let margin = 1.0;
        let inside = p.x > margin && p.y > margin && p.x < w - margin && p.y < h - margin;
        match inside {
            false => Stop::Border,
            true if self.is_solid(p + here.heading * (2.0 * STEP)) => Stop::Solid,
            true => Stop::InkEnd,
        }
    }

    /// Whether a point lies in a solid region, whose ink is no line's.
    fn is_solid(&self, p: Point) -> bool {
        self.image.solid.at(p) == Some(true)
    }
}

/// The steps along a straight line.
fn along(straight: &Straight) -> impl Iterator<Item = Step> {
    let (heading, width) = (straight.heading(), straight.width);
    straight.points().into_iter().map(move |point| Step { point, heading, width, drift: 0.0 })
}

fn streamline(steps: &[Step], closed: bool, stops: [Stop; 2]) -> Streamline {
    Streamline {
        points: steps.iter().map(|s| s.point).collect(),
        widths: steps.iter().map(|s| s.width).collect(),
        closed,
        stops,
    }
}
