//! Dots: what is about as long, caps included, as it is wide, and touches nothing else.

use super::Dot;
use super::lines::{Line, Lines};
use crate::clean::LineImage;
use crate::drawing::Color;
use crate::streamline::STEP;
use kurbo::{Point, Vec2};

/// What is longer than this many line widths is no dot.
const LONGEST: f64 = 2.6;
/// What is wider than this many line widths is no dot.
const WIDEST: f64 = 2.5;
/// A dot is round: no longer than this many times its width, and so many pixels.
const ROUND: f64 = 1.35;
const ROUND_PIXELS: f64 = 0.5;
/// A dot touches nothing within this many line widths, and so many pixels.
const ISOLATED: f64 = 3.0;
const ISOLATED_PIXELS: f64 = 4.0;
/// Fainter than this, the blur around a dot is paper, as a share of full ink.
const FAINT: f32 = 0.15;

/// Takes out the lines that are dots, and those of less than two points.
pub(super) fn take_out(image: &LineImage, lines: &mut Lines) -> Vec<Dot> {
    let found: Vec<Option<Dot>> = lines.iter().map(|line| dot(image, line)).collect();
    let mut is_dot = found.iter().map(Option::is_some);
    lines.edit().retain(|line| is_dot.next() == Some(false) && line.points.len() > 1);
    found.into_iter().flatten().collect()
}

/// A line's ink, if it is a dot.
fn dot(image: &LineImage, line: &Line) -> Option<Dot> {
    let length = line.points.len() as f64 * STEP;
    if length > LONGEST * image.line_width || line.points.is_empty() {
        return None;
    }
    let middle = line.points[line.points.len() / 2];
    let blob = Blob::around(image, middle, ISOLATED * image.line_width + ISOLATED_PIXELS)?;
    let round = blob.long < ROUND * blob.short + ROUND_PIXELS;
    let dot = Dot { centre: blob.centre, diameter: blob.short.max(1.0), color: Color::BLACK };
    (round && blob.short < WIDEST * image.line_width).then_some(dot)
}

/// An isolated region of ink.
struct Blob {
    centre: Point,
    /// Extent along its long and its short axis, in pixels.
    long: f64,
    short: f64,
}

impl Blob {
    /// The connected ink around a point; `None` when it reaches further than `limit`.
    fn around(image: &LineImage, start: Point, limit: f64) -> Option<Self> {
        let first = (start.x.floor() as i64, start.y.floor() as i64);
        let (mut stack, mut seen) = (vec![first], vec![first]);
        let (mut mass, mut sum, mut xx, mut xy, mut yy) = (0.0, Vec2::ZERO, 0.0, 0.0, 0.0);
        while let Some((x, y)) = stack.pop() {
            let p = Vec2::new(x as f64 + 0.5, y as f64 + 0.5);
            let d = p - start.to_vec2();
            if d.hypot() > limit {
                return None;
            }
            let ink = f64::from(image.ink.get(x, y).unwrap_or(0.0));
            mass += ink;
            sum += p * ink;
            (xx, xy, yy) = (xx + d.x * d.x * ink, xy + d.x * d.y * ink, yy + d.y * d.y * ink);
            for (nx, ny) in [(x - 1, y), (x + 1, y), (x, y - 1), (x, y + 1)] {
                if image.ink.get(nx, ny).is_some_and(|i| i > FAINT) && !seen.contains(&(nx, ny)) {
                    seen.push((nx, ny));
                    stack.push((nx, ny));
                }
            }
        }
        if mass <= 0.0 {
            return None;
        }
        let centre = sum / mass;
        let d = centre - start.to_vec2();
        let (a, b, c) = (xx / mass - d.x * d.x, xy / mass - d.x * d.y, yy / mass - d.y * d.y);
        let spread = (0.25 * (a - c) * (a - c) + b * b).sqrt();
        // A disc of diameter D has a variance of D^2 / 16 along any axis.
        let extent = |variance: f64| 4.0 * variance.max(0.0).sqrt();
        let (long, short) = (extent(0.5 * (a + c) + spread), extent(0.5 * (a + c) - spread));
        Some(Self { centre: centre.to_point(), long, short })
    }
}
