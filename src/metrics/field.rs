//! Angular error of a field.

use super::Truth;
use super::cloud::Sample;
use crate::error::{Error, Result};
use crate::field::PolyVectorField;
use kurbo::{Point, Vec2};
use num_complex::{Complex32, Complex64};

/// Directions less than this apart are one: 15 degrees.
const APART: f64 = 15.0 * std::f64::consts::PI / 180.0;

/// Mean angles in degrees between the directions of a field and those of the true strokes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AngularError {
    /// Over the pixels that the strokes ink: between the tangent of the nearest and the nearer root.
    pub ink: f64,
    /// Over those within two pens of a junction: where strokes of two directions cover the pixel, each against a root
    /// of its own, the mean of both. NaN where there is no junction.
    pub junction: f64,
}

/// Compares a field with the truth. Where the field is undefined, what its coefficients hold counts: zeros are two
/// horizontal directions.
pub(super) fn angular_error(truth: &Truth, field: &PolyVectorField) -> Result<AngularError> {
    if field.size() != truth.size {
        return Err(Error::FieldSize { field: field.size(), image: truth.size });
    }
    let (width, height) = truth.size;
    let (mut ink, mut junction) = (Mean::default(), Mean::default());
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).filter(|at| truth.ink[*at]) {
        let centre = Point::new(x as f64 + 0.5, y as f64 + 0.5);
        let roots = roots(field.c0()[(x, y)], field.c2()[(x, y)]);
        if let Some(nearest) = truth.cloud.nearest(centre).filter(|s| s.tangent != Vec2::ZERO) {
            ink.add(single(roots, nearest.tangent));
        }
        if truth.nodes.junctions.iter().any(|j| j.distance(centre) <= 2.0 * truth.pen) {
            match covering(truth, centre)[..] {
                [a, b] => junction.add(pair(roots, a, b)),
                [a] => junction.add(single(roots, a)),
                _ => {}
            }
        }
    }
    Ok(AngularError { ink: ink.degrees(), junction: junction.degrees() })
}

/// The two directions, however small the coefficients are.
fn roots(c0: Complex32, c2: Complex32) -> [Vec2; 2] {
    let double = |c: Complex32| Complex64::new(c.re.into(), c.im.into());
    let (c0, c2) = (double(c0), double(c2));
    let root = (c2 * c2 - 4.0 * c0).sqrt();
    [root - c2, -root - c2].map(|square| Vec2::from_angle(0.5 * square.arg()))
}

/// The directions of the strokes that cover a pixel, the nearest first, at most two.
fn covering(truth: &Truth, centre: Point) -> Vec<Vec2> {
    let distance = |s: &Sample| s.position.distance(centre);
    let mut cover: Vec<&Sample> =
        truth.cloud.within(centre, 0.5 * truth.pen + 0.5).filter(|s| s.tangent != Vec2::ZERO).collect();
    // Of strokes as near as one another the one on top, in whichever order they were found.
    let order = |a: &Sample, b: &Sample| b.stroke.cmp(&a.stroke).then(a.number.cmp(&b.number));
    cover.sort_by(|a, b| distance(a).total_cmp(&distance(b)).then(order(a, b)));
    let mut directions: Vec<Vec2> = Vec::new();
    for sample in cover {
        if directions.iter().all(|d| between(*d, sample.tangent) > APART) {
            directions.push(sample.tangent);
        }
        if directions.len() == 2 {
            break;
        }
    }
    directions
}

/// The angle between two lines in radians, at most a right one.
fn between(a: Vec2, b: Vec2) -> f64 {
    a.cross(b).abs().atan2(a.dot(b).abs())
}

/// The angle from a direction to the nearer root.
pub(crate) fn single([u, v]: [Vec2; 2], direction: Vec2) -> f64 {
    between(u, direction).min(between(v, direction))
}

/// The mean angle from two directions to roots of their own.
pub(crate) fn pair([u, v]: [Vec2; 2], a: Vec2, b: Vec2) -> f64 {
    0.5 * (between(u, a) + between(v, b)).min(between(u, b) + between(v, a))
}

#[derive(Default)]
struct Mean {
    sum: f64,
    count: usize,
}

impl Mean {
    fn add(&mut self, value: f64) {
        self.sum += value;
        self.count += 1;
    }

    /// NaN where there was nothing.
    fn degrees(&self) -> f64 {
        (self.sum / self.count as f64).to_degrees()
    }
}
