//! Strokes as chains of points on the raster.

use crate::drawing::{Centreline, Drawing, Segment, Stroke};
use kurbo::{Affine, Arc, Circle, Point, Vec2};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Steps of a curved piece for each pixel of its chord, and the fewest.
const STEPS: (f64, f64) = (2.0, 16.0);

/// Ends closer than this many pixels are one.
const SAME_POINT: f64 = 1e-3;

/// What of a coordinate is true: four decimals, as a factor. An SVG is read in single precision.
const DIGITS: f64 = 1e4;

/// A stroke on the raster.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Chain {
    /// At least one; one alone is a dot.
    pub points: Vec<Point>,
    /// Pen width in pixels.
    pub width: f64,
    /// Number of lines and curves that it was drawn with.
    pub pieces: usize,
    /// Whether it ends where it starts.
    pub closed: bool,
}

/// The strokes of a drawing, stretched onto a raster of a size.
pub(super) fn chains(drawing: &Drawing, (width, height): (usize, usize)) -> Vec<Chain> {
    let stretch = |to: usize, from: f64| if from > 0.0 { to as f64 / from } else { 1.0 };
    let map = Affine::scale_non_uniform(stretch(width, drawing.width), stretch(height, drawing.height));
    let factor = map.determinant().abs().sqrt();
    let chain = |stroke: &Stroke| {
        let (mut points, pieces) = points(&stroke.centreline);
        points.iter_mut().for_each(|p| *p = rounded(map * *p));
        let meets = points.len() > 1 && points[0].distance(points[points.len() - 1]) < SAME_POINT;
        Chain { points, width: stroke.width * factor, pieces, closed: stroke.centreline.is_closed() || meets }
    };
    drawing.strokes.iter().map(chain).collect()
}

/// A point without the noise of single precision, so that what was drawn alike is alike.
fn rounded(p: Point) -> Point {
    let round = |v: f64| (v * DIGITS).round() / DIGITS;
    Point::new(round(p.x), round(p.y))
}

/// The points of a centreline and the number of its pieces; a circle has four, as SVG defines it.
fn points(centreline: &Centreline) -> (Vec<Point>, usize) {
    match centreline {
        Centreline::Path { segments, .. } => {
            let mut points = vec![segments[0].start()];
            segments.iter().for_each(|s| add(s, &mut points));
            (points, segments.len())
        }
        Centreline::Circle(circle) => {
            let mut points = vec![circle.center + Vec2::new(circle.radius, 0.0)];
            quarters(circle).iter().for_each(|s| add(s, &mut points));
            (points, 4)
        }
        Centreline::Dot(p) => (vec![*p], 1),
    }
}

fn quarters(circle: &Circle) -> [Segment; 4] {
    let quarter = |n: usize| {
        let start = n as f64 * 0.25 * TAU;
        Segment::Arc(Arc::new(circle.center, (circle.radius, circle.radius), start, FRAC_PI_2, 0.0))
    };
    [0, 1, 2, 3].map(quarter)
}

/// Appends a piece's points after its first: evenly spaced in its parameter.
fn add(segment: &Segment, points: &mut Vec<Point>) {
    if matches!(segment, Segment::Line(_)) {
        points.push(segment.end());
        return;
    }
    let steps = (STEPS.0 * segment.start().distance(segment.end())).ceil().max(STEPS.1) as usize;
    points.extend((1..=steps).map(|i| segment.eval(i as f64 / steps as f64)));
}
