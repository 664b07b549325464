//! Light and shadow on a page.

use super::super::noise::{blur, gaussian};
use super::super::shapes::{heading, within};
use super::canvas::Canvas;
use super::random::{amount, clouds, place, spread};
use crate::raster::Raster;
use kurbo::{Point, Vec2};
use rand::Rng;
use std::f64::consts::TAU;

/// Light that falls off to one side and changes softly; tinted a little, as lamps and windows are.
pub(super) fn uneven(rng: &mut impl Rng, canvas: &mut Canvas) {
    let (width, height) = canvas.size();
    let depth = spread(rng, 0.05, 0.6);
    let slope = Vec2::from_angle(heading(rng)) * depth / width as f64;
    let wide = clouds(rng, (width, height), (50.0, 160.0));
    let level = 1.0 - 0.5 * depth * rng.random::<f64>();
    let light = Raster::from_fn(width, height, |x, y| {
        let across = slope.x * (x as f64 - 0.5 * width as f64) + slope.y * (y as f64 - 0.5 * height as f64);
        (level + across) as f32 + 0.3 * depth as f32 * wide[(x, y)]
    });
    canvas.shade(&light);
    if rng.random_bool(0.4) {
        let warm = 0.08 * gaussian(rng) as f32;
        let [red, _, blue] = &mut canvas.planes;
        red.data_mut().iter_mut().for_each(|v| *v *= 1.0 + warm);
        blue.data_mut().iter_mut().for_each(|v| *v *= 1.0 - warm);
    }
}

/// A page that gets darker away from some place, as towards the corners of a lens.
pub(super) fn vignette(rng: &mut impl Rng, canvas: &mut Canvas) {
    let (width, height) = canvas.size();
    let (centre, depth) = (place(rng, width as f64, 0.3), within(rng, 0.1, 0.7));
    let reach = within(rng, 0.8, 1.8) * width as f64;
    let light = Raster::from_fn(width, height, |x, y| {
        let d = Point::new(x as f64, y as f64).distance(centre) / reach;
        (1.0 - depth * d * d).max(0.1) as f32
    });
    canvas.shade(&light);
}

/// The shadow of a hand, a phone or an edge: a polygon or a bar, hard or soft, often bluish.
pub(super) fn shadow(rng: &mut impl Rng, canvas: &mut Canvas) {
    let size = canvas.size();
    let shape = match rng.random_range(0..3) {
        0 => half_plane(rng, size),
        1 => bar(rng, size),
        _ => convex(rng, size),
    };
    let hard = rng.random_bool(0.35);
    let sigma = if hard { within(rng, 0.3, 1.5) } else { spread(rng, 1.5, 14.0) };
    let shape = blur(&shape, sigma);
    // A hard shadow as dark as ink would be taken for a solid.
    let depth = amount(rng, (0.12, if hard { 0.5 } else { 0.75 }));
    let tint = if rng.random_bool(0.4) { 0.1 * depth } else { 0.0 };
    for (plane, depth) in canvas.planes.iter_mut().zip([depth + tint, depth, depth - tint]) {
        plane.data_mut().iter_mut().zip(shape.data()).for_each(|(v, s)| *v *= 1.0 - depth.min(0.9) * s);
    }
}

/// What lies on one side of a line; 1 there.
pub(super) fn half_plane(rng: &mut impl Rng, (width, height): (usize, usize)) -> Raster<f32> {
    let (p, normal) = (place(rng, width as f64, 0.0), Vec2::from_angle(heading(rng)));
    Raster::from_fn(width, height, |x, y| {
        let d = (x as f64 + 0.5 - p.x) * normal.x + (y as f64 + 0.5 - p.y) * normal.y;
        (d + 0.5).clamp(0.0, 1.0) as f32
    })
}

fn bar(rng: &mut impl Rng, (width, height): (usize, usize)) -> Raster<f32> {
    let (p, normal) = (place(rng, width as f64, 0.0), Vec2::from_angle(heading(rng)));
    let half = spread(rng, 2.0, 40.0);
    Raster::from_fn(width, height, |x, y| {
        let d = (x as f64 + 0.5 - p.x) * normal.x + (y as f64 + 0.5 - p.y) * normal.y;
        (half + 0.5 - d.abs()).clamp(0.0, 1.0) as f32
    })
}

/// The intersection of a few half planes about a place.
fn convex(rng: &mut impl Rng, (width, height): (usize, usize)) -> Raster<f32> {
    let p = place(rng, width as f64, 0.1);
    let sides: Vec<(Vec2, f64)> = (0..rng.random_range(3..7))
        .map(|i| (Vec2::from_angle(within(rng, 0.0, 2.0) + f64::from(i) * TAU / 4.0), within(rng, 10.0, 70.0)))
        .collect();
    Raster::from_fn(width, height, |x, y| {
        let at = Vec2::new(x as f64 + 0.5 - p.x, y as f64 + 0.5 - p.y);
        let inside = sides.iter().map(|(n, reach)| reach - at.dot(*n)).fold(f64::MAX, f64::min);
        (inside + 0.5).clamp(0.0, 1.0) as f32
    })
}

/// A lamp mirrored in a glossy ground: a soft bright spot or bar that washes marks out.
pub(super) fn glare(rng: &mut impl Rng, canvas: &mut Canvas) {
    let size = canvas.size();
    let shape = if rng.random_bool(0.5) { bar(rng, size) } else { convex(rng, size) };
    let soft = blur(&shape, within(rng, 4.0, 18.0));
    canvas.cover(&soft, [1.0; 3], amount(rng, (0.1, 0.65)));
}
