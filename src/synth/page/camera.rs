//! Lenses, sensors and files.

use super::super::noise::{blur, gaussian, white};
use super::super::shapes::{heading, within};
use super::canvas::Canvas;
use super::random::{amount, spread};
use crate::raster::Raster;
use image::{ImageFormat, Rgb as Pixel, RgbImage, codecs::jpeg::JpegEncoder};
use kurbo::{Point, Vec2};
use rand::Rng;

/// The mean of the image along a short way.
pub(super) fn motion(rng: &mut impl Rng, canvas: &mut Canvas) {
    let way = Vec2::from_angle(heading(rng)) * within(rng, 1.0, 4.0);
    canvas.each(|plane| {
        let (width, height) = plane.size();
        let inside = |v: f64, n: usize| v.clamp(0.5, n as f64 - 0.5);
        Raster::from_fn(width, height, |x, y| {
            let sum: f32 = (0..5)
                .map(|i| {
                    let p = Point::new(x as f64 + 0.5, y as f64 + 0.5) + way * (f64::from(i) / 4.0 - 0.5);
                    plane.sample(Point::new(inside(p.x, width), inside(p.y, height)))
                })
                .sum();
            sum / 5.0
        })
    });
}

/// Noise of a sensor, grey and coloured, fine or coarse, more of it in the dark or not.
pub(super) fn noise(rng: &mut impl Rng, canvas: &mut Canvas, strength: f32) {
    let (width, height) = canvas.size();
    let coarse = if rng.random_bool(0.4) { within(rng, 0.35, 0.9) } else { 0.0 };
    let mut grain = |coarse: f64| {
        // A blur takes from the deviation about what it is divided by.
        let gain = 1.0 + 2.0 * coarse as f32;
        blur(&white(rng, width, height), coarse).map(|v| v * gain)
    };
    let gray = grain(coarse);
    canvas.add(&gray, [strength; 3]);
    if rng.random_bool(0.5) {
        let (coarse, share) = (within(rng, 0.0, 2.0), amount(rng, (0.2, 1.0)) * strength);
        for plane in &mut canvas.planes {
            let colored = blur(&white(rng, width, height), coarse);
            let gain = share * (1.0 + 2.0 * coarse as f32);
            plane.data_mut().iter_mut().zip(colored.data()).for_each(|(v, n)| *v += gain * n);
        }
    }
}

/// The halos of sharpening.
pub(super) fn sharpen(rng: &mut impl Rng, canvas: &mut Canvas) {
    let (sigma, gain) = (spread(rng, 0.6, 2.5), amount(rng, (0.3, 2.5)));
    canvas.each(|plane| {
        let soft = blur(plane, sigma);
        let sharp = plane.data().iter().zip(soft.data()).map(|(v, s)| v + gain * (v - s)).collect();
        Raster::from_vec(plane.width(), plane.height(), sharp).expect("as many as before")
    });
}

/// Contrast that ends in pure white, in pure black or in both; marks of a contrast stay to be seen.
pub(super) fn clip(rng: &mut impl Rng, canvas: &mut Canvas, contrast: f32) {
    let bright = if contrast > 0.4 { within(rng, 0.6, 0.95) } else { 0.95 };
    let (low, high) = (canvas.quantile(0.02), canvas.quantile(bright));
    // White begins near the paper's brightness, black somewhere below the ink's.
    let white = high - 0.35 * contrast * rng.random::<f32>();
    let black = if rng.random_bool(0.5) { (low - 0.2 * rng.random::<f32>()).max(0.0) } else { 0.0 };
    let gain = 1.0 / (white - black).max(0.1);
    canvas.map(|v| (v - black) * gain);
}

/// Brighter or darker middle tones.
pub(super) fn gamma(rng: &mut impl Rng, canvas: &mut Canvas) {
    let power = (0.3 * gaussian(rng)).exp() as f32;
    canvas.map(|v| v.clamp(0.0, 1.0).powf(power));
}

/// Through a JPEG file. Its blocks of 8 pixels may begin anywhere.
pub(super) fn jpeg(rng: &mut impl Rng, canvas: &mut Canvas, quality: u8) {
    if rng.random_bool(0.5) {
        coarse_color(canvas);
    }
    let (width, height) = canvas.size();
    let (dx, dy) = (rng.random_range(0..8usize), rng.random_range(0..8usize));
    let image = RgbImage::from_fn((width + dx) as u32, (height + dy) as u32, |x, y| {
        let at = ((x as usize).saturating_sub(dx), (y as usize).saturating_sub(dy));
        Pixel([0, 1, 2].map(|c| (canvas.planes[c][at].clamp(0.0, 1.0) * 255.0).round() as u8))
    });
    let mut file = Vec::new();
    let encoded = image.write_with_encoder(JpegEncoder::new_with_quality(&mut file, quality));
    let decoded = encoded.and_then(|()| image::load_from_memory_with_format(&file, ImageFormat::Jpeg));
    // Memory holds whatever is written; if it should not, the page stays as it was.
    let Ok(decoded) = decoded else { return };
    let decoded = decoded.into_rgb8();
    for (c, plane) in canvas.planes.iter_mut().enumerate() {
        *plane = Raster::from_fn(width, height, |x, y| {
            f32::from(decoded.get_pixel((x + dx) as u32, (y + dy) as u32).0[c]) / 255.0
        });
    }
}

/// Colour at half the resolution of brightness, as most cameras store it.
fn coarse_color(canvas: &mut Canvas) {
    let gray = canvas.gray();
    let (width, height) = canvas.size();
    for plane in &mut canvas.planes {
        let color = Raster::from_fn(width, height, |x, y| plane[(x, y)] - gray[(x, y)]);
        let mean = |x: usize, y: usize| {
            let (x, y) = (x & !1, y & !1);
            let (u, v) = ((x + 1).min(width - 1), (y + 1).min(height - 1));
            0.25 * (color[(x, y)] + color[(u, y)] + color[(x, v)] + color[(u, v)])
        };
        *plane = Raster::from_fn(width, height, |x, y| gray[(x, y)] + mean(x, y));
    }
}
