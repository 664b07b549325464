//! Tints, highlighters and printers' screens.

use super::super::noise::blur;
use super::super::shapes::{blob, heading, polygon, rectangle, within};
use super::canvas::{Canvas, Rgb, brightness};
use super::random::{amount, clouds, like, place, spread};
use crate::drawing::{Centreline, Color, Drawing, Fill, Stroke};
use crate::raster::Raster;
use crate::render::render;
use kurbo::{Line, Vec2};
use rand::Rng;
use std::f64::consts::{PI, TAU};

/// A screen: a wave of -1 to 1 whose level decides where a tone has dots.
fn screen(rng: &mut impl Rng, (width, height): (usize, usize)) -> Raster<f32> {
    let angle = if rng.random_bool(0.5) { 0.25 * PI } else { within(rng, 0.0, PI) };
    let (step, lined) = (TAU / spread(rng, 2.2, 7.0), rng.random_bool(0.25));
    let (c, s) = (angle.cos() * step, angle.sin() * step);
    Raster::from_fn(width, height, |x, y| {
        let (x, y) = (x as f64, y as f64);
        let first = (c * x + s * y).cos();
        if lined { first as f32 } else { (0.5 * (first + (c * y - s * x).cos())) as f32 }
    })
}

/// A tone, 0 to 1, as dots of full strength.
pub(super) fn screened(rng: &mut impl Rng, tone: &Raster<f32>) -> Raster<f32> {
    let screen = screen(rng, tone.size());
    let sharp = spread(rng, 1.5, 8.0) as f32;
    let data = tone
        .data()
        .iter()
        .zip(screen.data())
        .map(|(tone, s)| if *tone < 0.004 { 0.0 } else { (0.5 + sharp * (2.0 * tone - 1.0 - s)).clamp(0.0, 1.0) });
    Raster::from_vec(tone.width(), tone.height(), data.collect()).expect("as many as before")
}

/// Flat shapes of a tint under the drawing, none of which is as dark as marks of a contrast, which might be solids.
pub(super) fn tints(rng: &mut impl Rng, canvas: &mut Canvas, colors: &[Rgb], contrast: f32) {
    let (width, _) = canvas.size();
    for _ in 0..rng.random_range(1..5) {
        let (p, angle) = (place(rng, width as f64, 0.1), heading(rng));
        let radius = spread(rng, 12.0, 90.0);
        let shape = match rng.random_range(0..4) {
            0 => blob(rng, p, radius),
            1 => polygon(rng, p, radius, angle),
            _ => rectangle(p, Vec2::new(radius, radius * within(rng, 0.2, 1.0)), 0.0, angle),
        };
        let mut area = shape_area(canvas, shape);
        if rng.random_bool(0.2) {
            area = screened(rng, &area.map(|a| 0.35 * a));
        } else if rng.random_bool(0.3) {
            let uneven = clouds(rng, canvas.size(), (5.0, 40.0));
            area.data_mut().iter_mut().zip(uneven.data()).for_each(|(a, u)| *a *= 0.8 + 0.2 * u);
        }
        let color = like(rng, colors, 0.08);
        let most = 0.6 * contrast / (1.0 - brightness(color)).max(0.1);
        let strength = amount(rng, (0.1, 0.9)).min(most);
        canvas.stain(&area, color, strength);
    }
}

fn shape_area(canvas: &Canvas, shape: Centreline) -> Raster<f32> {
    let mut drawing = empty(canvas);
    drawing.fills.push(Fill { outline: shape.to_path(), color: Color::BLACK });
    render(&drawing)
}

fn empty(canvas: &Canvas) -> Drawing {
    let (width, height) = canvas.size();
    Drawing::new(width as f64, height as f64)
}

/// Bars of a highlighter, darker at their edges and where they lie over one another.
pub(super) fn highlight(rng: &mut impl Rng, canvas: &mut Canvas) {
    const COLORS: [Rgb; 5] =
        [[1.0, 0.95, 0.2], [0.55, 1.0, 0.45], [1.0, 0.55, 0.75], [0.45, 0.85, 1.0], [1.0, 0.7, 0.3]];
    let side = canvas.size().0 as f64;
    let (color, width) = (like(rng, &COLORS, 0.04), spread(rng, 8.0, 36.0));
    let angle = within(rng, -0.15, 0.15);
    let strength = amount(rng, (0.35, 1.0));
    for _ in 0..rng.random_range(1..4) {
        let (p, reach) = (place(rng, side, 0.0), Vec2::from_angle(angle) * within(rng, 15.0, 90.0));
        let mut drawing = empty(canvas);
        let centreline = Centreline::Path {
            segments: vec![crate::drawing::Segment::Line(Line::new(p - reach, p + reach))],
            closed: false,
        };
        drawing.strokes.push(Stroke::new(centreline, width));
        let area = render(&drawing);
        let inner = blur(&area, 2.0);
        let alpha =
            Raster::from_fn(area.width(), area.height(), |x, y| area[(x, y)] * (0.8 + 0.4 * (1.0 - inner[(x, y)])));
        canvas.stain(&alpha, color, strength);
    }
}
