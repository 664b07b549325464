//! Unprinted sheets, and what happened to them before and after something was drawn.

use super::super::noise::{blur, gaussian, smooth, white};
use super::super::shapes::{heading, within};
use super::canvas::{Canvas, Rgb};
use super::random::{amount, clouds, like, near, place, spread};
use crate::raster::Raster;
use kurbo::Vec2;
use rand::Rng;

/// A sheet of a colour with its fibres, grain and blotches: how likely they are, and how strong of 1.
pub(super) fn sheet(
    rng: &mut impl Rng,
    (width, height): (usize, usize),
    color: Rgb,
    (rough, strength): (f64, f32),
) -> Canvas {
    let mut canvas = Canvas::filled((width, height), color);
    if rng.random_bool(rough) {
        let grain = blur(&white(rng, width, height), within(rng, 0.4, 2.2));
        let depth = spread(rng, 0.01, 0.12) as f32 * strength;
        canvas.add(&grain, [depth; 3]);
    }
    if rng.random_bool(0.7 * rough) {
        let cell = spread(rng, 3.0, 40.0);
        let blotches = smooth(rng, width, height, cell);
        let depth = spread(rng, 0.008, 0.09) * f64::from(strength);
        canvas.add(&blotches, near(rng, [depth as f32; 3], 0.2 * depth));
    }
    if rng.random_bool(0.3 * rough) {
        fibres(rng, &mut canvas, strength);
    }
    canvas
}

/// Short curved hairs of pulp, paler and darker than the sheet.
fn fibres(rng: &mut impl Rng, canvas: &mut Canvas, strength: f32) {
    let size = canvas.size();
    let depth = spread(rng, 0.03, 0.25) as f32 * strength;
    for color in [[0.25, 0.2, 0.15], [1.0; 3]] {
        let mut marks = Raster::filled(size.0, size.1, 0.0);
        for _ in 0..rng.random_range(2..40) {
            let length = within(rng, 3.0, 16.0);
            let (from, angle) = (place(rng, size.0 as f64, 0.0), heading(rng));
            walk(rng, &mut marks, (from, angle), length, 0.25, 0.9);
        }
        canvas.cover(&marks, color, depth);
    }
}

/// Draws a wandering line, a dot each half pixel.
pub(super) fn walk(
    rng: &mut impl Rng,
    marks: &mut Raster<f32>,
    (from, angle): (kurbo::Point, f64),
    length: f64,
    bend: f64,
    width: f64,
) {
    let (mut p, mut angle, mut turn) = (from, angle, 0.0);
    for _ in 0..(2.0 * length) as usize {
        p += 0.5 * Vec2::from_angle(angle);
        turn += bend * (0.3 * gaussian(rng) - 0.1 * turn);
        angle += 0.5 * turn;
        dot(marks, p, 0.5 * width, 1.0);
    }
}

/// A round dot, at least as dark as `dark` says in its middle.
pub(super) fn dot(marks: &mut Raster<f32>, centre: kurbo::Point, radius: f64, dark: f32) {
    let (width, height) = marks.size();
    let span = |c: f64, n: usize| ((c - radius - 1.0).max(0.0) as usize, ((c + radius + 2.0).max(0.0) as usize).min(n));
    let ((left, right), (top, bottom)) = (span(centre.x, width), span(centre.y, height));
    for y in top..bottom {
        for x in left..right {
            let d = (x as f64 + 0.5 - centre.x).hypot(y as f64 + 0.5 - centre.y);
            let cover = (radius + 0.5 - d).clamp(0.0, (2.0 * radius).min(1.0)) as f32 * dark;
            marks[(x, y)] = marks[(x, y)].max(cover);
        }
    }
}

/// Folds: a line, pale or dark, with the light falling otherwise on its two sides.
pub(super) fn fold(rng: &mut impl Rng, canvas: &mut Canvas) {
    let (width, height) = canvas.size();
    let (p, angle) =
        (place(rng, width as f64, 0.0), if rng.random_bool(0.7) { 0.02 * gaussian(rng) } else { heading(rng) });
    let angle = if rng.random_bool(0.5) { angle } else { angle + std::f64::consts::FRAC_PI_2 };
    let normal = Vec2::from_angle(angle);
    let (side, reach) = (0.12 * gaussian(rng) as f32, spread(rng, 4.0, 60.0) as f32);
    let (line, thick) = (0.25 * gaussian(rng) as f32, amount(rng, (0.5, 1.8)));
    let wear = clouds(rng, (width, height), (2.0, 12.0));
    let light = Raster::from_fn(width, height, |x, y| {
        let d = ((x as f64 - p.x) * normal.x + (y as f64 - p.y) * normal.y) as f32;
        let slope = side * (-d.abs() / reach).exp() * d.signum();
        let ridge = line * (-(d / thick).powi(2)).exp() * (0.7 + 0.5 * wear[(x, y)]);
        1.0 + slope + ridge
    });
    canvas.shade(&light);
}

/// The facets of crumpled paper.
pub(super) fn crumple(rng: &mut impl Rng, canvas: &mut Canvas) {
    let (width, height) = canvas.size();
    let cell = within(rng, 14.0, 50.0);
    let relief = smooth(rng, width, height, cell);
    let depth = amount(rng, (0.03, 0.2));
    // Ridges where the relief is folded onto itself.
    let light = relief.map(|v| {
        let folded = (3.0 * v).rem_euclid(2.0) - 1.0;
        1.0 + depth * (folded.abs() - 0.5) * 1.4
    });
    canvas.shade(&light);
}

/// Blots of a fluid: contours of noise, darker at the rim or not.
pub(super) fn stain(rng: &mut impl Rng, canvas: &mut Canvas) {
    let (width, height) = canvas.size();
    let noise = clouds(rng, (width, height), (12.0, 60.0));
    let fine = clouds(rng, (width, height), (3.0, 10.0));
    let (level, soft) = (amount(rng, (0.0, 0.6)), spread(rng, 1.5, 25.0) as f32);
    let rim = if rng.random_bool(0.5) { amount(rng, (0.2, 1.0)) } else { 0.0 };
    let alpha = Raster::from_fn(width, height, |x, y| {
        let over = (noise[(x, y)] + 0.15 * fine[(x, y)] - level) * soft;
        over.clamp(0.0, 1.0) * (1.0 - rim) + rim * (-(over - 0.5).powi(2) * 8.0).exp()
    });
    let color = like(rng, &[[0.55, 0.4, 0.2], [0.4, 0.3, 0.15], [0.6, 0.55, 0.5], [0.3, 0.4, 0.6]], 0.08);
    canvas.stain(&alpha, color, amount(rng, (0.1, 0.6)));
}

/// Rusty spots of old age.
pub(super) fn foxing(rng: &mut impl Rng, canvas: &mut Canvas) {
    let (width, height) = canvas.size();
    let mut spots = Raster::filled(width, height, 0.0);
    for _ in 0..rng.random_range(3..50) {
        let radius = spread(rng, 0.6, 6.0);
        dot(&mut spots, place(rng, width as f64, 0.0), radius, amount(rng, (0.2, 1.0)));
    }
    let spots = blur(&spots, within(rng, 0.3, 2.0));
    canvas.stain(&spots, near(rng, [0.5, 0.32, 0.15], 0.08), amount(rng, (0.15, 0.8)));
}

/// The ring that a cup leaves.
pub(super) fn ring(rng: &mut impl Rng, canvas: &mut Canvas) {
    let (width, height) = canvas.size();
    let (p, radius) = (place(rng, width as f64, 0.4), within(rng, 25.0, 90.0));
    let (thick, wear) = (within(rng, 1.0, 5.0), smooth(rng, width, height, 15.0));
    let alpha = Raster::from_fn(width, height, |x, y| {
        let d = ((x as f64 - p.x).hypot(y as f64 - p.y) - radius).abs() / thick;
        let inside = if (x as f64 - p.x).hypot(y as f64 - p.y) < radius { 0.12 } else { 0.0 };
        ((-d * d).exp() as f32 + inside) * (0.6 + 0.4 * wear[(x, y)])
    });
    canvas.stain(&alpha, near(rng, [0.45, 0.28, 0.12], 0.06), amount(rng, (0.15, 0.7)));
}

/// What another drawing leaves: printed through from the back, wiped off, or rubbed off from the sheet before.
pub(super) fn ghost(rng: &mut impl Rng, canvas: &mut Canvas, other: &Raster<f32>, color: Rgb, strength: f32) {
    let (width, height) = other.size();
    let back = Raster::from_fn(width, height, |x, y| other[(width - 1 - x, y)]);
    let soft = blur(&back, spread(rng, 0.8, 3.5));
    let uneven = clouds(rng, (width, height), (15.0, 80.0));
    let alpha = Raster::from_fn(width, height, |x, y| soft[(x, y)] * (0.7 + 0.3 * uneven[(x, y)]));
    canvas.cover(&alpha, color, strength);
}

/// Marks that were wiped in one direction, as on a board.
pub(super) fn wiped(rng: &mut impl Rng, canvas: &mut Canvas, other: &Raster<f32>, color: Rgb, strength: f32) {
    let (width, height) = other.size();
    let direction = Vec2::from_angle(heading(rng));
    let length = within(rng, 4.0, 24.0);
    let mut smear = Raster::filled(width, height, 0.0);
    for i in 0..8 {
        let shift = direction * length * f64::from(i) / 8.0;
        for y in 0..height {
            for x in 0..width {
                let at = kurbo::Point::new(x as f64 + 0.5, y as f64 + 0.5) + shift;
                smear[(x, y)] += 0.125 * other.sample(at);
            }
        }
    }
    canvas.cover(&smear, color, strength);
}
