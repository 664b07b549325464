//! Photocopiers, fax machines and scans in two tones.

use super::super::noise::{blur, gaussian, white};
use super::super::shapes::within;
use super::canvas::Canvas;
use super::paper::dot;
use super::random::{amount, clouds, place, spread};
use crate::raster::Raster;
use rand::Rng;

/// A copy of a copy: grey, of hard contrast, with what the drum and the glass leave. Marks of a contrast stay to be seen.
pub(super) fn copied(rng: &mut impl Rng, canvas: &mut Canvas, contrast: f32) {
    canvas.fade(1.0);
    if rng.random_bool(0.6) {
        canvas.blur(within(rng, 0.3, 1.0));
        let paper = canvas.quantile(0.8);
        let (middle, hard) = (paper - contrast * amount(rng, (0.2, 0.7)), spread(rng, 3.0, 10.0) as f32);
        let hard = hard / contrast.max(0.25);
        canvas.map(|v| 1.0 / (1.0 + (-(v - middle) * hard).exp()));
    }
    if rng.random_bool(0.35) {
        streaks(rng, canvas);
    }
    if rng.random_bool(0.3) {
        bands(rng, canvas);
    }
    if rng.random_bool(0.75) {
        specks(rng, canvas, (2.0, 120.0));
    }
    if rng.random_bool(0.4) {
        toner_dust(rng, canvas);
    }
}

/// Lines along the paper's way through the machine.
fn streaks(rng: &mut impl Rng, canvas: &mut Canvas) {
    let (width, height) = canvas.size();
    let upright = rng.random_bool(0.7);
    let mut profile = vec![1.0f32; width.max(height)];
    for _ in 0..rng.random_range(1..6) {
        let (at, depth) = (rng.random_range(0..profile.len()), amount(rng, (-0.2, 0.6)));
        let wide = rng.random_range(1..3);
        profile.iter_mut().skip(at).take(wide).for_each(|v| *v -= depth);
    }
    let wear = clouds(rng, (width, height), (10.0, 60.0));
    let light = Raster::from_fn(width, height, |x, y| {
        let streak = profile[if upright { x } else { y }] - 1.0;
        1.0 + streak * (0.7 + 0.6 * wear[(x, y)]).clamp(0.0, 1.0)
    });
    canvas.shade(&light);
}

/// Broad dark bands and a dark side, grainy as toner is.
fn bands(rng: &mut impl Rng, canvas: &mut Canvas) {
    let (width, height) = canvas.size();
    let (angle_free, step) = (rng.random_bool(0.5), spread(rng, 12.0, 160.0));
    let (shift, depth) = (within(rng, 0.0, step), amount(rng, (0.05, 0.5)));
    let grain = white(rng, width, height);
    let light = Raster::from_fn(width, height, |x, y| {
        let at = if angle_free { x } else { y } as f64 + shift;
        let wave = 0.5 + 0.5 * (at / step * std::f64::consts::TAU).sin() as f32;
        1.0 - depth * wave * wave * (1.0 + 0.35 * grain[(x, y)])
    });
    canvas.shade(&light);
}

/// Dark and pale dots of about a pixel, so many on 10,000 pixels.
pub(super) fn specks(rng: &mut impl Rng, canvas: &mut Canvas, (low, high): (f64, f64)) {
    let (width, height) = canvas.size();
    let count = (spread(rng, low, high) * (width * height) as f64 / 1e4) as usize;
    let pale = if rng.random_bool(0.3) { 0.4 } else { 0.0 };
    let large = spread(rng, 0.7, 2.2);
    let [mut dark, mut white] = [0, 1].map(|_| Raster::filled(width, height, 0.0));
    for _ in 0..count {
        let marks = if rng.random_bool(pale) { &mut white } else { &mut dark };
        let radius = within(rng, 0.35, large) * within(rng, 0.5, 1.0);
        dot(marks, place(rng, width as f64, 0.0), radius, amount(rng, (0.3, 1.0)));
    }
    canvas.cover(&dark, [0.08; 3], 1.0);
    canvas.cover(&white, [1.0; 3], 1.0);
}

/// Single dark pixels everywhere, more in some parts of the page.
fn toner_dust(rng: &mut impl Rng, canvas: &mut Canvas) {
    let (width, height) = canvas.size();
    let (share, depth) = (spread(rng, 0.005, 0.2) as f32, amount(rng, (0.15, 0.9)));
    let wide = clouds(rng, (width, height), (20.0, 90.0));
    let dust = Raster::from_fn(width, height, |x, y| {
        let here = share * (1.0 + wide[(x, y)]);
        if rng.random::<f32>() < here { depth } else { 0.0 }
    });
    canvas.cover(&dust, [0.1; 3], 1.0);
}

/// Two tones, at a coarser resolution or not, with noise before and after.
pub(super) fn two_tones(rng: &mut impl Rng, canvas: &mut Canvas) {
    let gray = canvas.gray();
    let coarse = if rng.random_bool(0.5) {
        (1.0, 1.0)
    } else {
        // Faxes have fewer rows than columns.
        let across = within(rng, 1.0, 1.8);
        (across, across * if rng.random_bool(0.4) { within(rng, 1.2, 2.0) } else { 1.0 })
    };
    let seen = averaged(&blur(&gray, within(rng, 0.2, 0.9)), coarse);
    let level = midway(&seen) + 0.06 * gaussian(rng) as f32;
    let noise = spread(rng, 0.01, 0.22) as f32;
    let errors = spread(rng, 5e-4, 0.05) as f32;
    let bits = seen.map(|v| {
        let bit = v + noise * gaussian(rng) as f32 > level;
        let wrong = rng.random::<f32>() < errors;
        if bit != wrong { 1.0 } else { 0.0 }
    });
    let (width, height) = gray.size();
    let at = |p: usize, step: f64, n: usize| (((p as f64 + 0.5) / step) as usize).min(n - 1);
    let out =
        Raster::from_fn(width, height, |x, y| bits[(at(x, coarse.0, bits.width()), at(y, coarse.1, bits.height()))]);
    canvas.each(|_| out.clone());
}

/// The image at a coarser resolution, steps of so many pixels across and down.
fn averaged(image: &Raster<f32>, (across, down): (f64, f64)) -> Raster<f32> {
    let size = |n: usize, step: f64| ((n as f64 / step).ceil() as usize).max(1);
    let (columns, rows) = (size(image.width(), across), size(image.height(), down));
    let inside = |v: f64, n: usize| v.clamp(0.5, n as f64 - 0.5);
    Raster::from_fn(columns, rows, |x, y| {
        let p = kurbo::Point::new((x as f64 + 0.5) * across, (y as f64 + 0.5) * down);
        image.sample(kurbo::Point::new(inside(p.x, image.width()), inside(p.y, image.height())))
    })
}

/// Halfway between the paper, which most of the page is, and what differs most from it.
fn midway(image: &Raster<f32>) -> f32 {
    let mut values = image.data().to_vec();
    values.sort_by(f32::total_cmp);
    let at = |share: f64| values[((values.len() - 1) as f64 * share) as usize];
    let (low, middle, high) = (at(0.005), at(0.5), at(0.995));
    if middle - low > high - middle { 0.5 * (low + middle) } else { 0.5 * (high + middle) }
}
