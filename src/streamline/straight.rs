//! Long straight lines, which are found as a whole: a walk sees only what lies behind it.
//!
//! Where many lines end at one, hardly any of its ink is its own, and a walk would be led away at each of them. A straight
//! line is told by all of its ink at once.

use super::STEP;
use super::coverage::{Coverage, Mark};
use super::seeds::{Seed, pixel};
use crate::clean::LineImage;
use crate::profile::cross_profile;
use kurbo::{Point, Vec2};
use std::collections::HashSet;
use std::ops::Range;

/// The shortest straight line that is looked for, in line widths and in pixels.
const LONG: f64 = 16.0;
const LONG_PIXELS: f64 = 24.0;
/// What is wider, in line widths and pixels, may be two lines.
const WIDEST: f64 = 1.3;
/// How far to both sides of a seed a line must be straight at first, in line widths.
const START: f64 = 3.0;
/// How much further it is followed each time.
const GROWTH: f64 = 1.6;
/// How far the middle of the ink may lie beside the line, in line widths and pixels; where it is for longer than
/// [`LEFT`] line widths, the line has ended.
const BESIDE: f64 = 0.1;
const BESIDE_PIXELS: f64 = 0.3;
const LEFT: f64 = 1.0;
/// How far nothing may be known of a line, in line widths.
const BLIND: f64 = 4.0;
/// How many lines it meets at least, each for longer than so many pixels.
const LEAST_MET: usize = 2;
const MEETING: f64 = 2.5;
/// The share of its length along which it is alone: at least, and at most for the walk to be led away.
const LEAST_ALONE: f64 = 0.2;
const MOST_ALONE: f64 = 0.85;
/// How much further out the quarters at its ends may lie than its middle, in line widths and pixels.
const SAG: f64 = 0.02;
const SAG_PIXELS: f64 = 0.08;
/// How near the middle of its ink must be to the line at its ends, in line widths and pixels, and how far it ends short of
/// there, in line widths.
const CLOSE: f64 = 0.02;
const CLOSE_PIXELS: f64 = 0.1;
const BACK: f64 = 1.0;
/// A walk goes on along a straight line that it meets within so many line widths of its end, no further beside it than so
/// many line widths and pixels, and in about its direction (10 degrees).
const ENTRY: f64 = 3.0;
const ENTRY_BESIDE: f64 = 0.2;
const ENTRY_PIXELS: f64 = 0.25;
const ENTRY_COS: f64 = 0.985;
/// Ink that is another line's as well is wider than so many line widths and pixels.
const SHARED: f64 = 1.15;
const SHARED_PIXELS: f64 = 0.25;
/// Share of a line's ink that its middle must hold.
pub(super) const INKED: f32 = 0.5;

/// A piece of a straight line, which ends short of where the line does.
#[derive(Clone, Copy, Debug)]
pub(super) struct Straight {
    pub from: Point,
    pub to: Point,
    /// Its mean ink width, in pixels.
    pub width: f64,
}

impl Straight {
    pub fn heading(&self) -> Vec2 {
        (self.to - self.from).normalize()
    }

    /// Distance of a point from the line.
    pub fn distance(&self, p: Point) -> f64 {
        (p - self.from).cross(self.heading()).abs()
    }

    /// Points a step apart.
    pub fn points(&self) -> Vec<Point> {
        let count = (self.from.distance(self.to) / STEP).round().max(1.0) as usize;
        (0..=count).map(|k| self.from.lerp(self.to, k as f64 / count as f64)).collect()
    }
}

/// The straight lines of an island, which cover their ink before any walk begins; as streamlines, they come first.
#[derive(Default)]
pub(super) struct Straights {
    laid: Vec<Laid>,
    /// Pixels along lines that were looked at and not laid.
    seen: HashSet<(i64, i64)>,
}

/// A straight line that covers its ink.
struct Laid {
    rank: usize,
    straight: Straight,
    /// Its points among those of the coverage.
    marks: Range<usize>,
    /// Whether it is part of a streamline by now.
    taken: bool,
}

impl Straights {
    pub fn len(&self) -> usize {
        self.laid.len()
    }

    /// Lays the straight line through a seed over its ink, if there is one at which others end.
    pub fn lay(&mut self, image: &LineImage, coverage: &mut Coverage, rank: usize, seed: &Seed) {
        let (x, y) = pixel(seed.point);
        let mut around = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (x + dx, y + dy)));
        if !seed.is_of_sample() || around.any(|near| self.seen.contains(&near)) {
            return;
        }
        let Some((straight, is_busy)) = straight(image, seed) else { return };
        if !is_busy {
            self.seen.extend(straight.points().into_iter().step_by(2).map(pixel));
            return;
        }
        let (points, heading) = (straight.points(), straight.heading());
        let first = coverage.len();
        coverage.lay(self.len() as u32, &points, &vec![straight.width; points.len()], |_| heading);
        self.laid.push(Laid { rank, straight, marks: first..coverage.len(), taken: false });
    }

    /// A straight line that is part of no streamline yet, with its rank; from now on it is.
    pub fn take(&mut self, id: usize) -> Option<(usize, Straight)> {
        let laid = self.laid.get_mut(id).filter(|laid| !laid.taken)?;
        laid.taken = true;
        Some((laid.rank, laid.straight))
    }

    /// What lies ahead of the straight line that a covered point is of, if a walk that is there has come upon its end and
    /// goes on along it. Its points are the walk's from now on.
    pub fn take_in(&mut self, coverage: &mut Coverage, mark: &Mark, by: &Comer) -> Option<Straight> {
        let laid = self.laid.get_mut(mark.streamline as usize).filter(|laid| !laid.taken)?;
        let Straight { from, to, width } = laid.straight;
        let backwards = mark.heading.dot(by.heading) < 0.0;
        let (start, end) = if backwards { (to, from) } else { (from, to) };
        let heading = (end - start).normalize();
        let passed = (mark.point - start).dot(heading);
        if passed > ENTRY * by.width
            || laid.straight.distance(by.point) > ENTRY_BESIDE * by.width + ENTRY_PIXELS
            || heading.dot(by.heading) < ENTRY_COS
        {
            return None;
        }
        laid.taken = true;
        let skipped = (passed / STEP).round() as i32;
        coverage.hand_over(laid.marks.clone(), backwards, by.streamline, by.index - by.sign * skipped, by.sign);
        Some(Straight { from: mark.point, to: end, width })
    }

    /// A straight line by the streamline that it is or was to be.
    pub fn get(&self, streamline: u32) -> Option<&Straight> {
        self.laid.get(streamline as usize).map(|laid| &laid.straight)
    }
}

/// A walk that comes upon a line.
pub(super) struct Comer {
    pub point: Point,
    pub heading: Vec2,
    /// Width of its own line.
    pub width: f64,
    pub streamline: u32,
    /// The place of its next point, and whether they count up or down.
    pub index: i32,
    pub sign: i32,
}

/// A straight line while it is sought.
pub(super) struct Axis<'a> {
    pub image: &'a LineImage,
    pub origin: Point,
    pub direction: Vec2,
    pub width: f64,
}

/// The ink across a place on an axis.
pub(super) struct Sample {
    /// Distance from the origin.
    pub along: f64,
    /// Of the ink's middle from the axis.
    pub beside: f64,
    pub width: f64,
}

/// The long straight line through a seed, and whether many others end at it.
fn straight(image: &LineImage, seed: &Seed) -> Option<(Straight, bool)> {
    let mut axis = Axis::new(image, seed)?;
    let width = axis.width;
    let mut reach = START * width;
    let is_inked = |along: f64| image.ink.sample(axis.at(along)) >= INKED;
    // Most seeds are on curves, which these tell at once.
    if ![-reach, reach].into_iter().all(is_inked) || ![-2.0 * reach, 2.0 * reach].into_iter().any(is_inked) {
        return None;
    }
    let mut found = [(-reach, false), (reach, false)];
    if [-1.0, 1.0].into_iter().any(|sign| axis.follow(sign, reach).1) {
        return None;
    }
    while !found.iter().all(|(_, has_ended)| *has_ended) {
        axis.fit(&axis.samples(found.map(|(end, _)| end)))?;
        reach *= GROWTH;
        found = [-1.0, 1.0].map(|sign| axis.follow(sign, reach));
    }
    let ends = found.map(|(end, _)| end);
    axis.fit(&axis.samples(ends))?;
    let samples = axis.samples(ends);
    let length = ends[1] - ends[0];
    let is_long = length > (LONG * axis.width).max(LONG_PIXELS);
    let met = samples.windows(2).filter(|pair| pair[1].along - pair[0].along > MEETING).count();
    let is_busy = met >= LEAST_MET
        && (LEAST_ALONE..MOST_ALONE).contains(&(samples.len() as f64 / length))
        && sag(&samples, ends) < SAG * width + SAG_PIXELS;
    // An arc that goes on from it lies beside it for a while.
    let close = |s: &&Sample| s.beside.abs() <= CLOSE * axis.width + CLOSE_PIXELS;
    let (first, last) = (samples.iter().find(close)?.along, samples.iter().rev().find(close)?.along);
    let [from, to] = [first + BACK * width, last - BACK * width].map(|s| axis.at(s));
    (is_long && last - first > 0.5 * length).then_some((Straight { from, to, width: axis.width }, is_busy))
}

impl<'a> Axis<'a> {
    /// The axis of the line at a seed, unless its ink may be two lines'.
    pub fn new(image: &'a LineImage, seed: &Seed) -> Option<Self> {
        let (origin, width) = seed.line(image).filter(|(_, width)| *width < WIDEST * image.line_width + 0.5)?;
        Some(Self { image, origin, direction: seed.tangent, width })
    }

    pub fn at(&self, along: f64) -> Point {
        self.origin + self.direction * along
    }

    /// The ink of the line alone at a distance from the origin.
    pub fn sample(&self, along: f64) -> Option<Sample> {
        let reach = 0.85 * self.width + 1.0;
        let profile = cross_profile(&self.image.ink, self.at(along), self.direction.turn_90(), reach)?;
        let width = profile.width().filter(|w| *w < SHARED * self.width + SHARED_PIXELS && *w > 0.5 * self.width)?;
        Some(Sample { along, beside: profile.middle()?, width })
    }

    /// Distance of the last place on one side, `sign`, up to `reach`, where the ink is the line's alone, and whether the
    /// line ends there.
    fn follow(&self, sign: f64, reach: f64) -> (f64, bool) {
        let tolerance = BESIDE * self.width + BESIDE_PIXELS;
        let (mut last, mut left, mut s) = (0.0, 0.0, 0.0);
        while s < reach {
            s += 1.0;
            let inked = self.image.ink.sample(self.at(sign * s)) >= INKED;
            match self.sample(sign * s) {
                Some(sample) if sample.beside.abs() <= tolerance => (last, left) = (s, 0.0),
                Some(_) => left += 1.0,
                None => {}
            }
            if !inked || left > LEFT * self.width || s - last > BLIND * self.width {
                return (sign * last, true);
            }
        }
        (sign * last, false)
    }

    pub fn samples(&self, [from, to]: [f64; 2]) -> Vec<Sample> {
        (from.round() as i64..=to.round() as i64).filter_map(|s| self.sample(s as f64)).collect()
    }

    /// Moves the axis to the middle of samples, by least squares.
    fn fit(&mut self, samples: &[Sample]) -> Option<()> {
        let n = samples.len() as f64;
        let mean = |value: &dyn Fn(&Sample) -> f64| samples.iter().map(value).sum::<f64>() / n;
        let (s, m) = (mean(&|p| p.along), mean(&|p| p.beside));
        let spread = mean(&|p| (p.along - s).powi(2));
        if samples.len() < 4 || spread < 1.0 {
            return None;
        }
        let slope = mean(&|p| (p.along - s) * (p.beside - m)) / spread;
        self.width = mean(&|p| p.width);
        let normal = self.direction.turn_90();
        self.origin += normal * (m - slope * s);
        self.direction = (self.direction + normal * slope).normalize();
        Some(())
    }
}

/// How much further to one side the ink of the outer quarters lies than that of the middle.
fn sag(samples: &[Sample], ends: [f64; 2]) -> f64 {
    let middle = 0.5 * (ends[0] + ends[1]);
    let quarter = 0.25 * (ends[1] - ends[0]);
    let (inner, outer): (Vec<&Sample>, Vec<&Sample>) = samples.iter().partition(|s| (s.along - middle).abs() < quarter);
    let mean = |part: &[&Sample]| part.iter().map(|s| s.beside).sum::<f64>() / part.len() as f64;
    if inner.is_empty() || outer.is_empty() { 0.0 } else { (mean(&outer) - mean(&inner)).abs() }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::clean::clean;
    use crate::load::Scan;
    use crate::options::Options;
    use crate::raster::Raster;

    /// The line image of 160 x 160 pixels of ink.
    pub fn image(is_inked: impl Fn(Point) -> bool + Sync) -> LineImage {
        let covered = |x: usize, y: usize| {
            let at = |k: u32| {
                Point::new(x as f64 + f64::from(2 * (k % 4) + 1) / 8.0, y as f64 + f64::from(2 * (k / 4) + 1) / 8.0)
            };
            (0..16).filter(|&k| is_inked(at(k))).count() as f32 / 16.0
        };
        clean(
            &Scan { gray: Raster::from_fn(160, 160, |x, y| 1.0 - covered(x, y)), rgb: None, dpi: None },
            &Options::default(),
        )
    }

    /// The straight line through the middle of the image, along `heading`, and whether others end at it.
    fn through_middle(image: &LineImage, heading: Vec2) -> Option<(Straight, bool)> {
        let seeds = (-12..=12).map(|k| Point::new(80.0, 80.0) + heading * f64::from(k));
        seeds.filter_map(|point| straight(image, &Seed { point, tangent: heading })).max_by_key(|(_, is_busy)| *is_busy)
    }

    const MIDDLE: Point = Point::new(80.0, 80.0);

    #[test]
    fn a_line_at_which_others_end_is_found_where_it_is() {
        for degrees in [0.0f64, 10.0, 33.0, 45.0, 80.0] {
            for width in [3.0, 4.0, 5.0] {
                let heading = Vec2::from_angle(degrees.to_radians());
                let hatch = Vec2::from_angle((degrees + 45.0).to_radians());
                let inked = |p: Point| {
                    let d = p - MIDDLE;
                    let along = d.dot(heading).abs() < 60.0;
                    // Lines at 45 degrees, on one side.
                    let (side, across) =
                        (d.cross(heading), (d.cross(hatch) / (4.0 * width)).rem_euclid(1.0) * 4.0 * width);
                    along && (side.abs() < 0.5 * width || (-40.0..0.0).contains(&side) && across < width)
                };
                let (line, is_busy) =
                    through_middle(&image(inked), heading).unwrap_or_else(|| panic!("{degrees} {width}: none"));
                assert!(is_busy, "{degrees} {width}");
                assert!((line.width - width).abs() < 0.2 * width + 0.2, "{degrees} {width}: {}", line.width);
                let off = line.distance(MIDDLE).max((line.to - MIDDLE).cross(heading).abs());
                assert!(off < 0.35 && line.from.distance(line.to) > 70.0, "{degrees} {width}: {line:?}");
            }
        }
    }

    #[test]
    fn a_line_that_is_alone_is_left_to_the_walk() {
        for degrees in [0.0f64, 20.0, 45.0] {
            let heading = Vec2::from_angle(degrees.to_radians());
            let inked = |p: Point| (p - MIDDLE).cross(heading).abs() < 1.5 && (p - MIDDLE).hypot() < 60.0;
            assert!(!through_middle(&image(inked), heading).expect("a line").1);
        }
    }

    #[test]
    fn a_circle_is_not_straight() {
        for radius in [15.0, 40.0, 60.0] {
            let centre = MIDDLE + Vec2::new(0.0, radius);
            let inked = |p: Point| (p.distance(centre) - radius).abs() < 1.5;
            assert!(!through_middle(&image(inked), Vec2::new(1.0, 0.0)).is_some_and(|(_, is_busy)| is_busy));
        }
    }
}
