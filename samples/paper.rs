//! Makes a clean rendering look like a drawing on paper: graphite on its tooth, uneven light, blur, grain, specks.
//!
//! Everything follows from the seed, so the same call gives the same picture everywhere.

use fieldtrace::raster::Raster;
use imageproc::filter::gaussian_blur_f32;

/// How a drawing got onto paper and into the machine.
#[derive(Clone, Copy, Debug)]
pub struct Paper {
    /// Darkness of full ink, 0 to 1.
    pub darkness: f32,
    /// Share of the ink that the tooth of the paper keeps away, 0 for a pen.
    pub tooth: f32,
    /// How much of the light is missing in the darkest corner.
    pub shade: f32,
    /// Standard deviation of the blur in pixels.
    pub blur: f32,
    /// Standard deviation of the grain.
    pub grain: f32,
    /// Specks of dust for every 10,000 pixels.
    pub specks: f32,
}

impl Paper {
    /// Pencil, photographed under a lamp.
    pub const PENCIL: Self = Self { darkness: 0.7, tooth: 0.45, shade: 0.3, blur: 0.6, grain: 0.02, specks: 1.0 };
    /// Ink on a flatbed scanner.
    pub const INK: Self = Self { darkness: 0.9, tooth: 0.06, shade: 0.06, blur: 0.5, grain: 0.012, specks: 0.3 };

    /// The lightness of a scan from the lightness of a clean rendering.
    pub fn scan(&self, clean: &Raster<f32>, seed: u64) -> Raster<f32> {
        let (width, height) = clean.size();
        let diagonal = (width as f32).hypot(height as f32);
        let marked = Raster::from_fn(width, height, |x, y| {
            let (px, py) = (x as f32, y as f32);
            let tooth = self.tooth * (0.6 * smooth_noise(seed, 1.7, px, py) + 0.4 * uniform(seed ^ 1, x, y));
            let ink = (1.0 - clean[(x, y)]) * self.darkness * (1.0 - tooth);
            let lamp = (px - 0.2 * width as f32).hypot(py - 0.1 * height as f32) / diagonal;
            let fibres = 0.02 * self.shade * (smooth_noise(seed ^ 2, 25.0, px, py) - 0.5);
            (1.0 - self.shade * lamp * lamp + fibres) * (1.0 - ink) * 0.97
        });
        let mut light = Raster::from_image(gaussian_blur_f32(&marked.into_image(), self.blur.max(0.05)));
        for y in 0..height {
            for x in 0..width {
                light[(x, y)] = (light[(x, y)] + self.grain * normal(seed ^ 3, x, y)).clamp(0.0, 1.0);
            }
        }
        let specks = (self.specks * (width * height) as f32 / 10_000.0) as usize;
        for i in 0..specks {
            let x = (uniform(seed ^ 4, i, 0) * width as f32) as usize;
            let y = (uniform(seed ^ 4, i, 1) * height as f32) as usize;
            light[(x, y)] *= 0.45;
        }
        light
    }
}

/// A hash of a seed and a cell, uniform in `[0, 1)` (splitmix64's finalizer).
pub fn uniform(seed: u64, x: usize, y: usize) -> f32 {
    let mut z = seed
        .wrapping_mul(0x9E37_79B9_7F4A_7C15)
        .wrapping_add((x as u64) << 32 | y as u64)
        .wrapping_add(0x9E37_79B9_7F4A_7C15);
    for (shift, factor) in [(30, 0xBF58_476D_1CE4_E5B9), (27, 0x94D0_49BB_1331_11EB), (31, 0x9E37_79B9_7F4A_7C15)] {
        z = (z ^ (z >> shift)).wrapping_mul(factor);
    }
    ((z ^ (z >> 32)) >> 40) as f32 / (1u64 << 24) as f32
}

/// About normal: the sum of four uniform numbers, centred, of unit variance.
fn normal(seed: u64, x: usize, y: usize) -> f32 {
    let sum: f32 = (0..4).map(|k| uniform(seed.wrapping_add(k << 40), x, y)).sum();
    (sum - 2.0) * 3f32.sqrt()
}

/// Noise in `[0, 1)` that changes over `period` pixels.
fn smooth_noise(seed: u64, period: f32, x: f32, y: f32) -> f32 {
    let (x, y) = (x / period, y / period);
    let (i, j) = (x as usize, y as usize);
    let ease = |t: f32| t * t * (3.0 - 2.0 * t);
    let (tx, ty) = (ease(x.fract()), ease(y.fract()));
    let row = |j| uniform(seed, i, j) * (1.0 - tx) + uniform(seed, i + 1, j) * tx;
    row(j) * (1.0 - ty) + row(j + 1) * ty
}
