//! What is drawn on a page: a drawing, writing, solids and grids, each pen's marks by themselves.

use super::super::noise::gaussian;
use super::super::shapes::{arc_from, blob, heading, line, line_through, open, polygon, rectangle, within};
use super::random::{place, spread};
use crate::drawing::{Centreline, Color, Dashes, Drawing, Fill, Segment, Stroke};
use crate::raster::Raster;
use crate::render::render;
use kurbo::{CubicBez, Point, Vec2};
use rand::Rng;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Widths of pens in pixels.
const PENS: (f64, f64) = (1.2, 8.0);

/// The marks of a page.
#[derive(Clone, Debug)]
pub(super) struct Content {
    /// Coverage by the marks of each pen, 0 to 1, at the page's resolution.
    pub pens: Vec<Raster<f32>>,
    /// Coverage by all of them, at the drawing's.
    pub ink: Raster<f32>,
    /// All of them.
    pub marks: Drawing,
}

impl Content {
    /// A drawing with what else is on its page, drawn with one to three pens. A pixel of the page is `pixel` of the
    /// drawing's wide.
    pub fn draw(rng: &mut impl Rng, mut drawing: Drawing, pixel: f64) -> Self {
        for stroke in &mut drawing.strokes {
            stroke.width = stroke.width.clamp(PENS.0, PENS.1);
        }
        complete(rng, &mut drawing);
        let ink = render(&drawing);
        let pens = if rng.random_bool(0.25) { rng.random_range(2..4) } else { 1 };
        let parts = if pens == 1 { vec![drawing.clone()] } else { shared(rng, &drawing, pens) };
        Self { pens: parts.iter().map(|part| render(&part.scaled(1.0 / pixel))).collect(), ink, marks: drawing }
    }
}

/// Adds what is no line drawing.
fn complete(rng: &mut impl Rng, drawing: &mut Drawing) {
    let blank = rng.random_bool(0.06);
    if blank || rng.random_bool(0.06) {
        drawing.strokes.clear();
        drawing.fills.clear();
    }
    if blank {
        return;
    }
    if rng.random_bool(0.22) {
        writing(rng, drawing);
    }
    if rng.random_bool(0.22) {
        solids(rng, drawing);
    }
    if rng.random_bool(0.12) {
        dashed(rng, drawing);
    }
    if rng.random_bool(0.12) {
        hatching(rng, drawing);
    }
    // A grid alone on its page could be the paper's.
    if !drawing.strokes.is_empty() && rng.random_bool(0.02) {
        grid(rng, drawing);
    }
}

/// The drawing in parts, each stroke and solid in one.
fn shared(rng: &mut impl Rng, drawing: &Drawing, count: usize) -> Vec<Drawing> {
    let mut parts = vec![Drawing::new(drawing.width, drawing.height); count];
    for stroke in &drawing.strokes {
        parts[rng.random_range(0..count)].strokes.push(stroke.clone());
    }
    for fill in &drawing.fills {
        parts[rng.random_range(0..count)].fills.push(fill.clone());
    }
    parts
}

fn stroke(centreline: Centreline, width: f64) -> Stroke {
    Stroke::new(centreline, width)
}

/// The width of a pen of its own.
fn pen(rng: &mut impl Rng) -> f64 {
    spread(rng, PENS.0, PENS.1)
}

/// Rows of small marks that look like letters.
fn writing(rng: &mut impl Rng, drawing: &mut Drawing) {
    let height = spread(rng, 6.0, 26.0);
    let width = (height * within(rng, 0.08, 0.2)).max(0.9);
    let (slant, straight) = (within(rng, -0.2, 0.3), rng.random_bool(0.5));
    let tilt = if rng.random_bool(0.5) { 0.0 } else { 0.15 * gaussian(rng) };
    let along = Vec2::from_angle(tilt);
    let down = Vec2::from_angle(tilt + FRAC_PI_2 + slant);
    let mut row = place(rng, drawing.width, 0.1);
    for _ in 0..rng.random_range(1..6) {
        let mut at = row;
        for _ in 0..rng.random_range(2..20) {
            let wide = within(rng, 0.35, 0.75) * height;
            let tall = if rng.random_bool(0.3) { height } else { 0.65 * height };
            letter(rng, drawing, (at, along * wide, -down * tall), width, straight);
            let space = if rng.random_bool(0.15) { 1.6 } else { 0.4 };
            at += along * (wide + space * 0.5 * height);
        }
        row += down * height * within(rng, 1.3, 2.0);
    }
}

/// One to three strokes in a box that stands on a point.
fn letter(rng: &mut impl Rng, drawing: &mut Drawing, (at, right, up): (Point, Vec2, Vec2), width: f64, straight: bool) {
    let corner = |rng: &mut _| {
        let third = |rng: &mut _| 0.5 * f64::from(Rng::random_range(rng, 0..3u8)) + 0.08 * gaussian(rng);
        at + right * third(rng) + up * third(rng)
    };
    for _ in 0..rng.random_range(1..4) {
        let [a, b, c, d] = [corner(rng), corner(rng), corner(rng), corner(rng)];
        let centreline = if straight { line(a, b) } else { open(vec![Segment::Cubic(CubicBez::new(a, b, c, d))]) };
        drawing.strokes.push(stroke(centreline, width));
    }
}

/// Filled shapes.
fn solids(rng: &mut impl Rng, drawing: &mut Drawing) {
    for _ in 0..rng.random_range(1..4) {
        let (p, angle) = (place(rng, drawing.width, 0.05), heading(rng));
        let radius = spread(rng, 4.0, 90.0);
        let shape = match rng.random_range(0..4) {
            0 => blob(rng, p, radius),
            1 => polygon(rng, p, radius, angle),
            2 => Centreline::Circle(kurbo::Circle::new(p, radius)),
            _ => rectangle(p, Vec2::new(radius, radius * within(rng, 0.2, 1.0)), 0.0, angle),
        };
        drawing.fills.push(Fill { outline: shape.to_path(), color: Color::BLACK });
    }
}

/// Dashed and dotted lines and arcs.
fn dashed(rng: &mut impl Rng, drawing: &mut Drawing) {
    let width = pen(rng).min(4.0);
    let dash = if rng.random_bool(0.3) { 0.01 } else { width * within(rng, 1.5, 6.0) };
    let gap = width * within(rng, 1.8, 4.0);
    for _ in 0..rng.random_range(1..4) {
        let (p, angle) = (place(rng, drawing.width, 0.1), heading(rng));
        let bend = if rng.random_bool(0.5) { 0.0 } else { within(rng, -2.0, 2.0) };
        let centreline = open(vec![arc_from(p, angle, within(rng, 40.0, 160.0), bend)]);
        let dashes = Some(Dashes { dash, gap, offset: 0.0 });
        drawing.strokes.push(Stroke { dashes, ..stroke(centreline, width) });
    }
}

/// A region of parallel lines, sometimes crossed.
fn hatching(rng: &mut impl Rng, drawing: &mut Drawing) {
    let (middle, first) = (place(rng, drawing.width, 0.0), heading(rng));
    let width = within(rng, 1.2, 3.0);
    let gap = width * within(rng, 1.8, 5.0);
    let (length, count) = (within(rng, 20.0, 110.0), rng.random_range(4..16));
    for pass in 0..rng.random_range(1..3) {
        let angle = first + FRAC_PI_2 * f64::from(pass) * within(rng, 0.6, 1.0);
        let across = Vec2::from_angle(angle + FRAC_PI_2);
        for i in 0..count {
            let p = middle + across * gap * (f64::from(i) - 0.5 * f64::from(count));
            let reach = length * within(rng, 0.8, 1.2);
            drawing.strokes.push(stroke(line_through(p, angle + 0.02 * gaussian(rng), reach), width));
        }
    }
}

/// A grid or table with the drawing's own pen: unlike the paper's ruling, it is ink.
fn grid(rng: &mut impl Rng, drawing: &mut Drawing) {
    let side = drawing.width;
    let width = drawing.strokes.first().map_or_else(|| pen(rng).min(4.0), |s| s.width.min(5.0));
    let step = within(rng, 14.0, 50.0).max(4.0 * width);
    let angle = if rng.random_bool(0.6) { 0.0 } else { within(rng, 0.0, TAU) };
    for quarter in [0.0, FRAC_PI_2] {
        let across = Vec2::from_angle(angle + quarter + FRAC_PI_2);
        let shift = within(rng, 0.0, step);
        for i in -8..9 {
            let p = Point::new(0.5 * side, 0.5 * side) + across * (step * f64::from(i) + shift);
            drawing.strokes.push(stroke(line_through(p, angle + quarter, 2.0 * side), width));
        }
    }
}
