//! Circles that other lines touch, which are found as a whole.
//!
//! Where a line touches a circle, both share their ink for a long stretch, and a walk may leave on the wrong one. A circle
//! is told by all of its ink at once.

use super::heading::{Tail, angle_between};
use super::seeds::{Seed, pixel};
use super::straight::{Axis, INKED, Sample};
use super::{STEP, Stop, Streamline};
use crate::clean::LineImage;
use crate::field::FrameField;
use kurbo::{Point, Vec2};
use std::collections::HashSet;
use std::f64::consts::TAU;

/// How far to both sides of a seed a circle is sought at first, in line widths, and how much further each time.
const START: f64 = 3.0;
const GROWTH: f64 = 1.5;
/// The least and the largest radius, in line widths.
const SMALLEST: f64 = 1.25;
const LARGEST: f64 = 64.0;
/// How far the middle of the ink may lie beside the circle, in line widths and pixels, and for how long further off, in
/// line widths.
const BESIDE: f64 = 0.1;
const BESIDE_PIXELS: f64 = 0.3;
const LEFT: f64 = 1.5;
/// How much further off it may lie per pixel where the circle is not known yet.
const GUESS: f64 = 0.05;
/// The root mean square of that around the whole circle, in line widths and pixels.
const ROUND: f64 = 0.04;
const ROUND_PIXELS: f64 = 0.12;
/// How much the field may turn more on one side of a seed than on the other, as a share of both.
const UNEVEN: f64 = 0.5;
/// Of a circle larger than so many line widths, a sample of the seeds is looked at.
const SMALL: f64 = 8.0;
/// The most places on each side that are looked at.
const MOST_SAMPLES: f64 = 48.0;
/// The longest arc of which nothing may be known, in radians.
const BLIND: f64 = 2.1;
/// The share of its length along which it is alone: at least, and at most for a walk to go astray.
const LEAST_ALONE: f64 = 0.3;
const MOST_ALONE: f64 = 0.97;

/// The circles of an island.
#[derive(Default)]
pub(super) struct Rings {
    /// Pixels along arcs that are of none.
    seen: HashSet<(i64, i64)>,
}

impl Rings {
    /// The circle through a seed that is whole, but shares its ink with other lines in places.
    pub fn find(&mut self, image: &LineImage, frames: &FrameField, seed: &Seed) -> Option<Ring> {
        if self.seen.contains(&pixel(seed.point)) || !bends(image, frames, seed) {
            return None;
        }
        let mut ring = Ring::around(image, seed)?;
        if ring.radius > SMALL * ring.width && !seed.is_of_sample() {
            return None;
        }
        let known = ring.grow(image).err();
        if let Some(known) = known {
            let arc = [-1.0, 1.0].map(|sign| pixels(known * ring.radius, 2.0).map(move |s| sign * s / ring.radius));
            self.seen.extend(arc.into_iter().flatten().map(|angle| pixel(ring.at(ring.start + angle))));
        }
        known.is_none().then_some(ring)
    }
}

/// A circle of ink.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ring {
    pub centre: Point,
    pub radius: f64,
    /// Its mean ink width, in pixels.
    pub width: f64,
    /// The angle of a place where it is alone.
    start: f64,
}

impl Ring {
    /// The line itself, from a place on where it is alone.
    pub fn streamline(&self, image: &LineImage) -> Streamline {
        let count = (TAU * self.radius / STEP).round().max(8.0);
        let angles = (0..count as usize).map(|k| self.start + k as f64 / count * TAU);
        let width = |angle: f64| self.axis(image, angle).sample(0.0).map_or(f64::NAN, |sample| sample.width);
        let (points, widths) = angles.map(|angle| (self.at(angle), width(angle))).unzip();
        Streamline { points, widths, closed: true, stops: [Stop::InkEnd; 2] }
    }

    /// The tangent at a point beside it.
    pub fn heading(&self, p: Point) -> Vec2 {
        (p - self.centre).normalize().turn_90()
    }

    fn at(&self, angle: f64) -> Point {
        self.centre + Vec2::from_angle(angle) * self.radius
    }

    /// The tangent at an angle.
    fn axis<'a>(&self, image: &'a LineImage, angle: f64) -> Axis<'a> {
        Axis { image, origin: self.at(angle), direction: Vec2::from_angle(angle).turn_90(), width: self.width }
    }

    /// Grows from an arc to the whole circle; `Err` is how far to both sides of the start it goes on, in radians.
    fn grow(&mut self, image: &LineImage) -> Result<(), f64> {
        let mut known = 0.0;
        let mut reach = START * self.width / self.radius;
        while known < 0.5 * TAU {
            reach = f64::min(reach, 0.5 * TAU);
            let samples = self.samples(image, known, reach).ok_or(known)?;
            self.fit(&samples).ok_or(known)?;
            (known, reach) = (reach, GROWTH * reach);
        }
        let is_whole = self.samples(image, known, known).is_some_and(|samples| self.is_whole(image, &samples));
        if is_whole { Ok(()) } else { Err(known) }
    }

    /// The circle that the ink around a seed is an arc of.
    fn around(image: &LineImage, seed: &Seed) -> Option<Self> {
        let axis = Axis::new(image, seed)?;
        let (origin, width) = (axis.origin, axis.width);
        let place = |s: &Sample| axis.at(s.along) + axis.direction.turn_90() * s.beside;
        let points: Vec<Point> = axis.samples([-START * width, START * width]).iter().map(place).collect();
        let tail = Tail::fit(&points, 0.02).filter(|tail| points.len() >= 6 && tail.curvature != 0.0)?;
        let radius = 1.0 / tail.curvature;
        let centre = tail.point + tail.heading.turn_90() * radius;
        let (w, h) = image.ink.size();
        let ring = Self { centre, radius: radius.abs(), width, start: (origin - centre).atan2() };
        let most = (LARGEST * image.line_width).min(0.5 * w.min(h) as f64);
        (ring.radius > SMALLEST * width && ring.radius < most).then_some(ring)
    }

    /// The places up to `reach` radians to both sides of its start where the ink is the circle's alone, in order;
    /// `None` where it does not go on. Beyond `known`, the circle is a guess.
    fn samples(&self, image: &LineImage, known: f64, reach: f64) -> Option<Vec<Sample>> {
        let step = self.step(reach);
        let mut samples = Vec::new();
        for sign in [-1.0, 1.0] {
            let mut left = 0.0;
            for s in pixels(reach * self.radius, step) {
                let angle = self.start + sign * s / self.radius;
                let limit = BESIDE * self.width + BESIDE_PIXELS + GUESS * (s - known * self.radius).max(0.0);
                let sample = self.axis(image, angle).sample(0.0);
                let is_off = sample.as_ref().is_some_and(|sample| sample.beside.abs() > limit);
                if is_off || image.ink.sample(self.at(angle)) < INKED {
                    left += step;
                    if left > LEFT * self.width {
                        return None;
                    }
                } else if let Some(sample) = sample {
                    left = 0.0;
                    samples.push(Sample { along: angle, ..sample });
                }
            }
            // Those before the start are found last to first.
            if sign < 0.0 {
                samples.reverse();
            }
        }
        Some(samples)
    }

    /// How far apart samples are, in pixels.
    fn step(&self, reach: f64) -> f64 {
        (reach * self.radius / MOST_SAMPLES).max(1.0)
    }

    /// Moves the circle to the middle of samples, by least squares of `beside = r + x cos + y sin`.
    fn fit(&mut self, samples: &[Sample]) -> Option<()> {
        let n = samples.len() as f64;
        let mean = |value: &dyn Fn(&Sample, Vec2) -> f64| {
            samples.iter().map(|s| value(s, Vec2::from_angle(s.along))).sum::<f64>() / n
        };
        // Normals point against the radius: a tangent turned by 90 degrees.
        let out = |s: &Sample| -s.beside;
        let (x, y, d) = (mean(&|_, e| e.x), mean(&|_, e| e.y), mean(&|s, _| out(s)));
        let (xx, yy) = (mean(&|_, e| e.x * e.x) - x * x, mean(&|_, e| e.y * e.y) - y * y);
        let (xy, dx) = (mean(&|_, e| e.x * e.y) - x * y, mean(&|s, e| out(s) * e.x) - d * x);
        let dy = mean(&|s, e| out(s) * e.y) - d * y;
        let determinant = xx * yy - xy * xy;
        if samples.len() < 6 || determinant < 1e-9 {
            return None;
        }
        let shift = Vec2::new(dx * yy - dy * xy, dy * xx - dx * xy) / determinant;
        self.centre += shift;
        self.radius += d - shift.x * x - shift.y * y;
        self.width = mean(&|s, _| s.width);
        (self.radius > SMALLEST * self.width).then_some(())
    }

    /// Whether samples from all around are those of one circle that others meet.
    fn is_whole(&self, image: &LineImage, samples: &[Sample]) -> bool {
        let n = samples.len() as f64;
        let alone = n * self.step(0.5 * TAU) / (TAU * self.radius);
        let deviation = (samples.iter().map(|s| s.beside * s.beside).sum::<f64>() / n).sqrt();
        let gaps = samples.windows(2).map(|pair| pair[1].along - pair[0].along);
        let last = samples.first().zip(samples.last()).map_or(TAU, |(a, b)| TAU - (b.along - a.along));
        let mut around = pixels(TAU * self.radius, 1.0).map(|s| self.at(s / self.radius));
        (LEAST_ALONE..MOST_ALONE).contains(&alone)
            && around.all(|point| image.ink.sample(point) >= INKED)
            && deviation < ROUND * self.width + ROUND_PIXELS
            && gaps.fold(last, f64::max) < BLIND
    }
}

/// Distances of so many pixels each, up to one.
fn pixels(to: f64, step: f64) -> impl Iterator<Item = f64> {
    (1..=(to / step) as usize).map(move |k| k as f64 * step)
}

/// Whether the field turns before and after a seed as it would on a circle that is not too large.
fn bends(image: &LineImage, frames: &FrameField, seed: &Seed) -> bool {
    let reach = 0.5 * START * image.line_width;
    let turn = |sign: f64| {
        let ahead = frames.along(seed.point + seed.tangent * (sign * reach), seed.tangent)?;
        Some(sign * angle_between(seed.tangent, ahead))
    };
    let is_bend = |[a, b]: [f64; 2]| {
        (a + b).abs() > 2.0 * reach / (LARGEST * image.line_width) && (a - b).abs() < UNEVEN * (a + b).abs()
    };
    turn(-1.0).zip(turn(1.0)).is_none_or(|(a, b)| is_bend([a, b]))
}

#[cfg(test)]
mod tests {
    use super::super::straight::tests::image;
    use super::*;
    use crate::field::PolyVectorField;

    const MIDDLE: Point = Point::new(80.0, 80.0);

    /// The ring that the first of the seeds around a circle finds, where its field is that of the circle.
    fn ring_of(radius: f64, is_inked: impl Fn(Point) -> bool + Sync) -> Option<Ring> {
        let image = image(is_inked);
        let tangent = |p: Point| (p - MIDDLE).normalize().turn_90();
        let field = PolyVectorField::from_directions(160, 160, |x, y| {
            let t = tangent(Point::new(x as f64 + 0.5, y as f64 + 0.5));
            t.is_finite().then(|| (t, t.turn_90()))
        });
        let (frames, mut rings) = (FrameField::new(field), Rings::default());
        (0..180).find_map(|k| {
            let point = MIDDLE + Vec2::from_angle(f64::from(2 * k).to_radians()) * radius;
            rings.find(&image, &frames, &Seed { point, tangent: tangent(point) })
        })
    }

    fn is_on_circle(p: Point, radius: f64, width: f64) -> bool {
        (p.distance(MIDDLE) - radius).abs() < 0.5 * width
    }

    #[test]
    fn a_circle_that_lines_touch_is_found_where_it_is() {
        let mut found = 0;
        for radius in [10.0, 24.0, 50.0] {
            for width in [3.0, 4.0, 5.0] {
                for sides in [1u32, 4, 6] {
                    let touched = |p: Point| {
                        let side = |k: u32| {
                            let out = Vec2::from_angle(f64::from(k) / f64::from(sides) * TAU + 0.2);
                            ((p - MIDDLE).dot(out) - radius).abs() < 0.5 * width
                        };
                        (0..sides).any(side)
                    };
                    // Between two lines that touch it, the circle must be alone for a while.
                    let alone = TAU * radius / f64::from(sides) - 2.0 * (2.4 * radius * width).sqrt();
                    if alone < 6.0 * width {
                        continue;
                    }
                    found += 1;
                    let ring = ring_of(radius, |p| is_on_circle(p, radius, width) || touched(p));
                    let ring = ring.unwrap_or_else(|| panic!("{radius} {width} {sides}: none"));
                    let off = (ring.radius - radius).abs().max(ring.centre.distance(MIDDLE));
                    assert!(off < 0.3, "{radius} {width} {sides}: {ring:?}");
                }
            }
        }
        assert_eq!(found, 11);
    }

    #[test]
    fn circles_that_are_alone_or_open_and_ellipses_are_left_to_the_walk() {
        for radius in [10.0, 24.0, 50.0] {
            let crossed = |p: Point| (p.x - 80.0).abs() < 1.5 || (p.y - 80.0).abs() < 1.5;
            let open = |p: Point| (p - MIDDLE).atan2().abs() > 0.3;
            let ellipse = |p: Point| MIDDLE + Vec2::new(p.x - 80.0, 1.06 * (p.y - 80.0));
            assert!(ring_of(radius, |p| is_on_circle(p, radius, 3.0) || crossed(p)).is_some(), "crossed {radius}");
            assert!(ring_of(radius, |p| is_on_circle(p, radius, 3.0)).is_none(), "alone");
            assert!(ring_of(radius, |p| (is_on_circle(p, radius, 3.0) && open(p)) || crossed(p)).is_none(), "open");
            if radius > 20.0 {
                let ring = ring_of(radius, |p| is_on_circle(ellipse(p), radius, 3.0) || crossed(p));
                assert!(ring.is_none(), "ellipse {radius}");
            }
        }
    }
}
