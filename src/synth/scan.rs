//! From rendered ink to what a scanner or a camera would see.

use super::noise::{blur, gaussian, smooth, white};
use super::shapes::within;
use crate::raster::Raster;
use image::{GrayImage, Luma, codecs::jpeg::JpegEncoder};
use kurbo::Point;
use rand::Rng;

/// How a sheet was drawn on and scanned.
#[derive(Clone, Copy, Debug)]
pub struct ScanStyle {
    /// Darkness of full ink, 0 to 1.
    pub darkness: f64,
    /// How much pencil or pen texture takes from the ink, 0 to 1.
    pub texture: f64,
    /// Share of the line length that is nearly missing.
    pub gaps: f64,
    /// Displacement of stroke edges in pixels.
    pub ragged: f64,
    /// Blur in pixels, standard deviation.
    pub blur: f64,
    /// Brightness of the paper.
    pub paper: f64,
    /// Largest change of brightness by uneven light.
    pub light: f64,
    /// Amplitude of the paper's blotches.
    pub blotches: f64,
    /// Standard deviation of the grain.
    pub grain: f64,
    /// Specks per 10,000 pixels.
    pub specks: f64,
    /// JPEG quality, where the image was stored as one.
    pub jpeg: Option<u8>,
    /// Whether the result is black and white only.
    pub binary: bool,
}

impl ScanStyle {
    /// A random style, from a sharp ink scan to a soft pencil one.
    pub fn draw(rng: &mut impl Rng) -> Self {
        let chance = |rng: &mut _, p: f64, low: f64, high: f64| {
            if Rng::random_bool(rng, p) { within(rng, low, high) } else { 0.0 }
        };
        Self {
            darkness: within(rng, 0.45, 0.95),
            texture: chance(rng, 0.75, 0.1, 0.6),
            gaps: chance(rng, 0.15, 0.02, 0.12),
            ragged: chance(rng, 0.6, 0.1, 0.6),
            blur: within(rng, 0.3, 1.1),
            paper: within(rng, 0.75, 1.0),
            light: chance(rng, 0.8, 0.03, 0.3),
            blotches: chance(rng, 0.7, 0.01, 0.06),
            grain: chance(rng, 0.85, 0.01, 0.045),
            specks: chance(rng, 0.5, 0.5, 4.0),
            jpeg: rng.random_bool(0.6).then(|| rng.random_range(55..95)),
            binary: rng.random_bool(0.08),
        }
    }
}

/// A scan of an ink coverage: brightness 0 (black) to 1, of the same size.
pub fn scan(rng: &mut impl Rng, ink: &Raster<f32>, style: &ScanStyle) -> Raster<f32> {
    let (width, height) = ink.size();
    let mut marks = ragged(rng, ink, style.ragged);
    pencil(rng, &mut marks, style);
    specks(rng, &mut marks, style.specks);
    let marks = blur(&marks, style.blur);
    let mut gray = sheet(rng, width, height, style);
    for (g, m) in gray.data_mut().iter_mut().zip(marks.data()) {
        *g *= 1.0 - m * style.darkness as f32;
    }
    let soft = if rng.random_bool(0.5) { within(rng, 0.3, 0.7) } else { 0.0 };
    let grain = blur(&white(rng, width, height), soft);
    let amount = style.grain as f32 * (1.0 + 2.0 * soft as f32);
    for (g, n) in gray.data_mut().iter_mut().zip(grain.data()) {
        *g = (*g + amount * n).clamp(0.0, 1.0);
    }
    if let Some(quality) = style.jpeg {
        gray = through_jpeg(&gray, quality);
    }
    if style.binary { binary(&gray, style) } else { gray }
}

/// Moves each pixel's source by smooth noise: edges fray and the centreline stays on average.
fn ragged(rng: &mut impl Rng, ink: &Raster<f32>, amount: f64) -> Raster<f32> {
    if amount == 0.0 {
        return ink.clone();
    }
    let (width, height) = ink.size();
    let (dx, dy) = (smooth(rng, width, height, 2.5), smooth(rng, width, height, 2.5));
    Raster::from_fn(width, height, |x, y| {
        let shift = |d: f32| amount * f64::from(d);
        ink.sample(Point::new(x as f64 + 0.5 + shift(dx[(x, y)]), y as f64 + 0.5 + shift(dy[(x, y)])))
    })
}

/// Takes ink away where the pencil skipped over the grain of the paper, and where it was lifted.
fn pencil(rng: &mut impl Rng, marks: &mut Raster<f32>, style: &ScanStyle) {
    let (width, height) = marks.size();
    let fine = white(rng, width, height);
    let cell = within(rng, 3.0, 14.0);
    let coarse = smooth(rng, width, height, cell);
    let lifted = smooth(rng, width, height, 2.0 * cell);
    let (texture, lift) = (style.texture as f32, 1.0 - 2.0 * style.gaps as f32);
    let pixels = marks.data_mut().iter_mut().zip(fine.data()).zip(coarse.data()).zip(lifted.data());
    for (((m, f), c), l) in pixels {
        let keep = 1.0 - texture * (0.35 + 0.45 * c + 0.2 * f);
        let gap = if style.gaps > 0.0 && *l > lift { 0.15 } else { 1.0 };
        *m = (*m * keep * gap).clamp(0.0, 1.0);
    }
}

/// Dark dots of about a pixel.
fn specks(rng: &mut impl Rng, marks: &mut Raster<f32>, per_10000: f64) {
    let (width, height) = marks.size();
    let n = per_10000 * (width * height) as f64 / 1e4;
    for _ in 0..(n + rng.random::<f64>()) as usize {
        let (cx, cy) = (within(rng, 0.0, width as f64), within(rng, 0.0, height as f64));
        let (radius, dark) = (within(rng, 0.4, 1.3), within(rng, 0.3, 1.0) as f32);
        for y in (cy - 2.0).max(0.0) as usize..((cy + 3.0) as usize).min(height) {
            for x in (cx - 2.0).max(0.0) as usize..((cx + 3.0) as usize).min(width) {
                let d = (x as f64 + 0.5 - cx).hypot(y as f64 + 0.5 - cy);
                let cover = (radius + 0.5 - d).clamp(0.0, 1.0) as f32 * dark;
                marks[(x, y)] = marks[(x, y)].max(cover);
            }
        }
    }
}

/// Unmarked paper under uneven light.
fn sheet(rng: &mut impl Rng, width: usize, height: usize, style: &ScanStyle) -> Raster<f32> {
    let (gx, gy) = (gaussian(rng) / width as f64, gaussian(rng) / height as f64);
    let wide = smooth(rng, width, height, 80.0);
    let cell = within(rng, 4.0, 25.0);
    let blotches = smooth(rng, width, height, cell);
    Raster::from_fn(width, height, |x, y| {
        let slope = gx * (x as f64 - 0.5 * width as f64) + gy * (y as f64 - 0.5 * height as f64);
        let light = style.light * (0.5 * slope + 0.4 * f64::from(wide[(x, y)]));
        let paper = style.paper + light - style.light * 0.3 + style.blotches * f64::from(blotches[(x, y)]);
        paper.clamp(0.3, 1.0) as f32
    })
}

fn through_jpeg(gray: &Raster<f32>, quality: u8) -> Raster<f32> {
    let (width, height) = gray.size();
    let bytes = GrayImage::from_fn(width as u32, height as u32, |x, y| {
        Luma([(gray[(x as usize, y as usize)] * 255.0).round() as u8])
    });
    let mut file = Vec::new();
    let encoded = bytes.write_with_encoder(JpegEncoder::new_with_quality(&mut file, quality));
    let decoded = encoded.and_then(|()| image::load_from_memory_with_format(&file, image::ImageFormat::Jpeg));
    match decoded {
        Ok(image) => {
            let data = image.into_luma8().into_raw().iter().map(|&v| f32::from(v) / 255.0).collect();
            Raster::from_vec(width, height, data).unwrap_or_else(|| gray.clone())
        }
        Err(_) => gray.clone(),
    }
}

/// Thresholds halfway between paper and ink, locally.
fn binary(gray: &Raster<f32>, style: &ScanStyle) -> Raster<f32> {
    let paper = background(gray);
    let level = 1.0 - 0.4 * style.darkness as f32;
    let (width, height) = gray.size();
    Raster::from_fn(width, height, |x, y| if gray[(x, y)] < level * paper[(x, y)] { 0.0 } else { 1.0 })
}

/// The ink of a render without noise.
pub fn clean_ink(rng: &mut impl Rng, ink: &Raster<f32>) -> Raster<f32> {
    match rng.random_range(0..10) {
        0..6 => ink.clone(),
        6..8 => blur(ink, within(rng, 0.2, 0.8)),
        _ => ink.map(|i| if i > 0.5 { 1.0 } else { 0.0 }),
    }
}

/// The brightness of the paper around each pixel: the upper quartile of blocks of 32 pixels, interpolated.
fn background(gray: &Raster<f32>) -> Raster<f32> {
    const BLOCK: usize = 32;
    let (width, height) = gray.size();
    let (columns, rows) = (width.div_ceil(BLOCK), height.div_ceil(BLOCK));
    let quartile = |bx: usize, by: usize| {
        let mut counts = [0usize; 256];
        let mut total = 0;
        for y in by * BLOCK..((by + 1) * BLOCK).min(height) {
            for &g in &gray.row(y)[bx * BLOCK..((bx + 1) * BLOCK).min(width)] {
                counts[(g * 255.0) as usize] += 1;
                total += 1;
            }
        }
        let mut left = total * 3 / 10;
        for (bin, &n) in counts.iter().enumerate().rev() {
            if left < n {
                return (bin as f32 + 0.5) / 255.0;
            }
            left -= n;
        }
        1.0
    };
    let blocks = Raster::from_fn(columns, rows, quartile);
    Raster::from_fn(width, height, |x, y| {
        let clamp = |p: usize, n: usize| (p as f64 / BLOCK as f64 - 0.5).clamp(0.0, (n - 1) as f64) + 0.5;
        let p = Point::new(clamp(x, columns), clamp(y, rows));
        // Sampling needs a block beyond the last; at the far edge the weight of it is 0.
        let (px, py) = (p.x.min(columns as f64 - 0.5 - 1e-9), p.y.min(rows as f64 - 0.5 - 1e-9));
        blocks.sample(Point::new(px.max(0.5), py.max(0.5))).max(0.05)
    })
}
