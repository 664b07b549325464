//! Things on a page and the table around it. None of them is ink, and they hide the ink below.

use super::super::noise::{blur, gaussian, white};
use super::super::shapes::{heading, within};
use super::canvas::{Canvas, Rgb};
use super::light::half_plane;
use super::paper::{dot, walk};
use super::random::{amount, clouds, like, near, pick, place, spread};
use crate::raster::Raster;
use kurbo::{Point, Vec2};
use rand::Rng;

/// Lays something on a page; what it hides is no ink. Gives how much of each pixel is still to be seen.
pub(super) fn object(rng: &mut impl Rng, canvas: &mut Canvas) -> Raster<f32> {
    match rng.random_range(0..10) {
        0..3 => hair(rng, canvas),
        3..5 => hole(rng, canvas),
        5..7 => staple(rng, canvas),
        7 => tape(rng, canvas),
        _ => finger(rng, canvas),
    }
}

fn uncovered(hidden: &Raster<f32>) -> Raster<f32> {
    hidden.map(|h| 1.0 - h.clamp(0.0, 1.0))
}

/// The shadow that a thing throws a little to one side.
fn thrown(rng: &mut impl Rng, canvas: &mut Canvas, shape: &Raster<f32>) {
    let (shift, sigma) = (Vec2::from_angle(heading(rng)) * within(rng, 0.0, 4.0), spread(rng, 0.6, 5.0));
    let depth = amount(rng, (0.1, 0.6));
    let (width, height) = shape.size();
    let moved = Raster::from_fn(width, height, |x, y| shape.sample(Point::new(x as f64 + 0.5, y as f64 + 0.5) + shift));
    canvas.shade(&blur(&moved, sigma).map(|s| 1.0 - depth * s));
}

/// A long thin curl, which hides next to nothing.
fn hair(rng: &mut impl Rng, canvas: &mut Canvas) -> Raster<f32> {
    let (width, height) = canvas.size();
    let mut marks = Raster::filled(width, height, 0.0);
    let from = (place(rng, width as f64, 0.0), heading(rng));
    let (length, thick) = (within(rng, 25.0, 160.0), within(rng, 0.5, 1.1));
    walk(rng, &mut marks, from, length, 0.06, thick);
    let color = *pick(rng, &[[0.1, 0.08, 0.07], [0.3, 0.2, 0.12], [0.6, 0.6, 0.6]]);
    canvas.cover(&marks, color, amount(rng, (0.3, 0.9)));
    Raster::filled(width, height, 1.0)
}

/// A punched hole that shows what lies below.
fn hole(rng: &mut impl Rng, canvas: &mut Canvas) -> Raster<f32> {
    let (width, height) = canvas.size();
    let mut shape = Raster::filled(width, height, 0.0);
    dot(&mut shape, place(rng, width as f64, 0.05), within(rng, 5.0, 18.0), 1.0);
    let color = like(rng, &[[0.1; 3], [0.3, 0.25, 0.2], [0.75; 3], [1.0; 3]], 0.1);
    thrown(rng, canvas, &shape);
    canvas.cover(&shape, color, 1.0);
    uncovered(&shape)
}

/// A bright or dark wire with its shadow.
fn staple(rng: &mut impl Rng, canvas: &mut Canvas) -> Raster<f32> {
    let (width, height) = canvas.size();
    let mut shape = Raster::filled(width, height, 0.0);
    let from = (place(rng, width as f64, 0.0), heading(rng));
    let (length, thick) = (within(rng, 8.0, 30.0), within(rng, 1.5, 4.0));
    walk(rng, &mut shape, from, length, 0.0, thick);
    thrown(rng, canvas, &shape);
    canvas.cover(&shape, like(rng, &[[0.7; 3], [0.45; 3], [0.9; 3]], 0.08), 1.0);
    uncovered(&shape)
}

/// Adhesive tape: a bar that tints what is below and has seen edges.
fn tape(rng: &mut impl Rng, canvas: &mut Canvas) -> Raster<f32> {
    let (width, height) = canvas.size();
    let (p, normal, half) = (place(rng, width as f64, 0.1), Vec2::from_angle(heading(rng)), within(rng, 8.0, 30.0));
    let distance = |x: usize, y: usize| (x as f64 - p.x) * normal.x + (y as f64 - p.y) * normal.y;
    let area = Raster::from_fn(width, height, |x, y| (half - distance(x, y).abs()).clamp(0.0, 1.0) as f32);
    let edge = Raster::from_fn(width, height, |x, y| (1.2 - (half - distance(x, y).abs()).abs()).max(0.0) as f32);
    canvas.stain(&area, near(rng, [0.85, 0.75, 0.5], 0.08), amount(rng, (0.1, 0.6)));
    canvas.cover(&edge, *pick(rng, &[[0.4, 0.35, 0.25], [1.0; 3]]), amount(rng, (0.1, 0.5)));
    Raster::filled(width, height, 1.0)
}

/// A finger that holds the page down, from the edge inwards.
fn finger(rng: &mut impl Rng, canvas: &mut Canvas) -> Raster<f32> {
    let (width, height) = canvas.size();
    let side = width as f64;
    let tip = place(rng, side, -0.1);
    let outwards = tip - Point::new(0.5 * side, 0.5 * side);
    let axis = Vec2::from_angle(outwards.atan2() + 0.3 * gaussian(rng));
    let radius = within(rng, 10.0, 26.0);
    let distance = |x: usize, y: usize| {
        let at = Vec2::new(x as f64 - tip.x, y as f64 - tip.y);
        let along = at.dot(axis).max(0.0);
        (at - axis * along).hypot()
    };
    let shape = Raster::from_fn(width, height, |x, y| (radius + 0.5 - distance(x, y)).clamp(0.0, 1.0) as f32);
    let round = Raster::from_fn(width, height, |x, y| {
        let d = (distance(x, y) / radius).min(1.0);
        (0.45 + 0.55 * (1.0 - d * d).max(0.0).sqrt()) as f32 * shape[(x, y)]
    });
    let skin = like(rng, &[[0.9, 0.7, 0.58], [0.75, 0.52, 0.4], [0.5, 0.33, 0.24], [0.3, 0.2, 0.15]], 0.05);
    thrown(rng, canvas, &shape);
    canvas.cover(&shape, [0.0; 3], 1.0);
    for (plane, c) in canvas.planes.iter_mut().zip(skin) {
        plane.data_mut().iter_mut().zip(round.data()).for_each(|(v, r)| *v += c * r);
    }
    uncovered(&shape)
}

/// The end of the sheet, with a table or nothing beyond. Gives the sheet's own part of each pixel.
pub(super) fn edge(rng: &mut impl Rng, canvas: &mut Canvas) -> Raster<f32> {
    let size = canvas.size();
    let mut beyond = half_plane(rng, size);
    if rng.random_bool(0.3) {
        let second = half_plane(rng, size);
        beyond.data_mut().iter_mut().zip(second.data()).for_each(|(a, b)| *a = a.max(*b));
    }
    // Little of the sheet would teach little.
    if beyond.data().iter().sum::<f32>() > 0.6 * beyond.data().len() as f32 {
        beyond = beyond.map(|b| 1.0 - b);
    }
    let table = table(rng, size);
    for (plane, table) in canvas.planes.iter_mut().zip(&table.planes) {
        for ((v, t), b) in plane.data_mut().iter_mut().zip(table.data()).zip(beyond.data()) {
            *v += (t - *v) * b;
        }
    }
    let (depth, sigma) = (amount(rng, (0.0, 0.6)), spread(rng, 0.8, 6.0));
    let shade = blur(&beyond, sigma);
    let outer = rng.random_bool(0.7);
    let light = Raster::from_fn(size.0, size.1, |x, y| {
        let (b, s) = (beyond[(x, y)], shade[(x, y)]);
        1.0 - depth * if outer { b * (1.0 - s) * 2.0 } else { (1.0 - b) * s }
    });
    canvas.shade(&light);
    uncovered(&beyond)
}

/// Wood, cloth, stone, or a dark or white void.
fn table(rng: &mut impl Rng, (width, height): (usize, usize)) -> Canvas {
    const COLORS: [Rgb; 8] = [
        [0.55, 0.38, 0.22],
        [0.35, 0.22, 0.13],
        [0.75, 0.6, 0.42],
        [0.04, 0.04, 0.05],
        [0.2, 0.2, 0.22],
        [0.45, 0.5, 0.55],
        [0.25, 0.35, 0.3],
        [0.8, 0.8, 0.78],
    ];
    let mut canvas = Canvas::filled((width, height), like(rng, &COLORS, 0.08));
    let direction = Vec2::from_angle(heading(rng));
    let depth = spread(rng, 0.03, 0.45) as f32;
    let bends = clouds(rng, (width, height), (20.0, 60.0));
    let texture = match rng.random_range(0..4) {
        // Grain of wood: stripes that bend.
        0 => {
            let (step, bend) = (spread(rng, 2.0, 16.0), within(rng, 1.0, 10.0));
            Raster::from_fn(width, height, |x, y| {
                let across = x as f64 * direction.x + y as f64 * direction.y + bend * f64::from(bends[(x, y)]);
                let v = (across / step).rem_euclid(1.0);
                (v * (1.0 - v) * 4.0 - 0.5) as f32 - 0.3 * (across / (3.7 * step)).sin() as f32
            })
        }
        // A weave.
        1 => {
            let step = spread(rng, 1.2, 6.0);
            let wave = |v: f64| (v / step).sin();
            Raster::from_fn(width, height, |x, y| {
                let along = x as f64 * direction.x + y as f64 * direction.y;
                let across = y as f64 * direction.x - x as f64 * direction.y;
                (wave(along) * wave(across)) as f32
            })
        }
        2 => blur(&white(rng, width, height), within(rng, 0.4, 2.5)),
        _ => bends,
    };
    canvas.add(&texture, near(rng, [depth; 3], 0.03));
    canvas.map(|v| v.clamp(0.0, 1.0));
    canvas
}
