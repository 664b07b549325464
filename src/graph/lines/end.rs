//! The ends of streamlines, before they are resolved.

use crate::clean::LineImage;
use crate::drawing::Color;
use crate::graph::Dot;
use crate::streamline::{STEP, Stop, Streamline, Tail};
use kurbo::{Point, Vec2};
use rayon::prelude::*;

/// How much of a line tells where its end is heading, in line widths.
const TAIL: f64 = 5.0;
/// How much of a line right before a junction is left out of that, in line widths.
const BLUR: f64 = 0.4;
/// The same where a line was cut because it had taken the wrong arm.
const CUT_BLUR: f64 = 2.0;

/// For how many line widths a line must be alone before its end for that to be its course.
const LASTING: f64 = 0.5;

/// One end of a line.
#[derive(Clone, Copy, Debug)]
pub(in crate::graph) struct End {
    /// Index of the line.
    pub line: usize,
    /// 0 for the first point, 1 for the last.
    pub side: usize,
    /// Where the walk stopped.
    pub point: Point,
    /// Index of the last point at which the line was alone.
    pub tip: usize,
    /// The line's course up to the tip, heading outwards.
    pub tail: Tail,
    /// Line width near the end.
    pub width: f64,
    /// Ink in the line's middle near the end, at most 1.
    pub core: f32,
    /// Why the walk stopped.
    pub stop: Stop,
}

/// Number of an end: two per line.
pub(in crate::graph) fn end_id(line: usize, side: usize) -> usize {
    2 * line + side
}

/// The ends of all lines, `2 * line + side`; `None` for closed lines.
pub(in crate::graph) fn ends(image: &LineImage, lines: &[Streamline]) -> Vec<Option<End>> {
    let both = |line: usize| [0, 1].map(|side| end(image, lines, line, side));
    (0..lines.len()).into_par_iter().flat_map_iter(both).collect()
}

fn end(image: &LineImage, lines: &[Streamline], line: usize, side: usize) -> Option<End> {
    let streamline = &lines[line];
    if streamline.closed {
        return None;
    }
    let n = streamline.points.len();
    // Indices counted from this end.
    let index = |k: usize| if side == 0 { k } else { n - 1 - k };
    let width = median_width(streamline, index, image.line_width);
    let alone = |k: usize| streamline.widths[index(k)].is_finite();
    // Where several lines end, the corner of their ink can look like a line of its own.
    let lasting = (LASTING * width / STEP) as usize;
    let long = (0..n / 2).find(|&k| (k..(k + lasting).min(n)).all(alone));
    let tip = long.or_else(|| (0..n).find(|&k| alone(k))).unwrap_or(n / 2);
    let overrun = tip as f64 * STEP;
    let blur = match streamline.stops[side] {
        Stop::Cut => CUT_BLUR,
        _ if overrun > 0.3 * width => BLUR,
        _ => 0.0,
    };
    let skip = (blur * width / STEP) as usize;
    let length = ((TAIL * width / STEP) as usize).max(3);
    let from = (tip + skip).min(n.saturating_sub(3));
    let run: Vec<Point> = (from..(from + length).min(n))
        .take_while(|&k| k < from + 3 || streamline.widths[index(k)].is_finite())
        .map(|k| streamline.points[index(k)])
        .collect();
    let course = |w: &[Point]| (w[1] - w[0]).hypot2() > 1e-12;
    let along = run.windows(2).filter(|w| course(w)).map(|w| image.core(w[0], (w[1] - w[0]).normalize()));
    let core = median(along).map_or(1.0, |c| c.clamp(0.3, 1.0));
    let oldest_first: Vec<Point> = run.into_iter().rev().collect();
    let outwards = streamline.points[index(0)] - streamline.points[index((n - 1).min(2))];
    let heading = if outwards.hypot() > 1e-9 { outwards.normalize() } else { Vec2::new(1.0, 0.0) };
    let fallback = Tail { point: streamline.points[index(0)], heading, curvature: 0.0 };
    let tail = Tail::fit(&oldest_first, 0.1).unwrap_or(fallback);
    let point = streamline.points[index(0)];
    Some(End { line, side, point, tip: index(tip), tail, width, core, stop: streamline.stops[side] })
}

fn median_width(line: &Streamline, index: impl Fn(usize) -> usize, typical: f64) -> f64 {
    let near = (0..line.points.len()).map(|k| line.widths[index(k)]).filter(|w| w.is_finite()).take(40);
    median(near.map(|w| w as f32)).map_or(typical, f64::from)
}

fn median(values: impl Iterator<Item = f32>) -> Option<f32> {
    let mut values: Vec<f32> = values.collect();
    values.sort_by(f32::total_cmp);
    values.get(values.len() / 2).copied()
}

/// Takes out lines that are dots: about as long, caps included, as they are wide, and touching nothing else.
pub(in crate::graph) fn split_dots(image: &LineImage, streamlines: &[Streamline]) -> (Vec<Dot>, Vec<Streamline>) {
    let mut dots = Vec::new();
    let mut lines = Vec::new();
    for streamline in streamlines {
        match dot(image, streamline) {
            Some(dot) => dots.push(dot),
            None if streamline.points.len() > 1 => lines.push(streamline.clone()),
            None => {}
        }
    }
    (dots, lines)
}

/// A streamline's ink, if it is a dot.
fn dot(image: &LineImage, line: &Streamline) -> Option<Dot> {
    let length = line.points.len() as f64 * STEP;
    if length > 2.6 * image.line_width || line.points.is_empty() {
        return None;
    }
    let middle = line.points[line.points.len() / 2];
    let blob = Blob::around(image, middle, 3.0 * image.line_width + 4.0)?;
    let round = blob.long < 1.35 * blob.short + 0.5;
    let dot = Dot { centre: blob.centre, diameter: blob.short.max(1.0), color: Color::BLACK };
    (round && blob.short < 2.5 * image.line_width).then_some(dot)
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
                if image.ink.get(nx, ny).is_some_and(|i| i > 0.15) && !seen.contains(&(nx, ny)) {
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
