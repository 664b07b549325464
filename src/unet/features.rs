//! What the network is shown, from ink.

use crate::raster::Raster;
use num_complex::Complex32;
use serde::{Deserialize, Serialize};

/// The channels of the network's input.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Default)]
#[serde(rename_all = "lowercase")]
pub enum Input {
    /// The ink alone, as in the paper; the network regresses the coefficients themselves.
    Ink,
    /// The ink and the structure tensor at two scales; the network regresses what has to be added to the
    /// tensor's own field, so that it starts where a structure tensor ends.
    #[default]
    Tensor,
}

impl Input {
    /// Number of channels.
    pub fn channels(self) -> usize {
        match self {
            Self::Ink => 1,
            Self::Tensor => 9,
        }
    }
}

/// Windows of the structure tensor: standard deviations in pixels.
pub const SCALES: [f64; 2] = [2.2, 4.0];

/// Gradient energy that counts as paper: coherence falls off below it.
const FLOOR: f32 = 2e-3;

/// Pixels that [`features`] looks around itself.
pub const REACH: usize = 13;

/// Input channels and the field that the output is added to, planes of `width x height`.
#[derive(Clone, Debug)]
pub struct Features {
    /// `[channels, height, width]`.
    pub channels: Vec<f32>,
    /// `Re c0`, `Im c0` of the field that the network corrects, `[2, height, width]`; its `c2` is 0. Empty for
    /// [`Input::Ink`].
    pub base: Vec<f32>,
}

/// The network's input for an image of ink, 0 to 1.
///
/// With the Scharr gradient `g = gx + i gy`, a window's tensor in complex form is `Z = -<g^2> / (<|g|^2> + floor)`: the
/// squared tangent times the coherence. The channels are the ink, then `Z` and `Z^2` of each scale; the field that is
/// corrected has tangent and normal of the smaller scale, `c0 = -Z^2`, `c2 = 0`.
pub fn features(ink: &Raster<f32>, input: Input) -> Features {
    let mut channels = ink.data().to_vec();
    if input == Input::Ink {
        return Features { channels, base: Vec::new() };
    }
    let (width, height) = ink.size();
    let planes = products(ink);
    let mut base = Vec::new();
    for sigma in SCALES {
        let [re, im, energy] = planes.each_ref().map(|p| window(p, width, height, sigma));
        let z: Vec<Complex32> =
            re.iter().zip(&im).zip(&energy).map(|((a, b), e)| -Complex32::new(*a, *b) / (e + FLOOR)).collect();
        channels.extend(z.iter().map(|z| z.re));
        channels.extend(z.iter().map(|z| z.im));
        channels.extend(z.iter().map(|z| (z * z).re));
        channels.extend(z.iter().map(|z| (z * z).im));
        if base.is_empty() {
            base.extend(z.iter().map(|z| -(z * z).re));
            base.extend(z.iter().map(|z| -(z * z).im));
        }
    }
    Features { channels, base }
}

/// `Re g^2`, `Im g^2` and `|g|^2` of the Scharr gradient; the ink's edge pixels are repeated outside.
fn products(ink: &Raster<f32>) -> [Vec<f32>; 3] {
    let (width, height) = ink.size();
    let mut out = [0, 1, 2].map(|_| vec![0.0f32; width * height]);
    let mut rows = [0, 1, 2].map(|_| vec![0.0f32; width + 2]);
    for y in 0..height {
        for (row, from) in rows.iter_mut().zip([y.saturating_sub(1), y, (y + 1).min(height - 1)]) {
            row[1..=width].copy_from_slice(ink.row(from));
            row[0] = row[1];
            row[width + 1] = row[width];
        }
        let [a, b, c] = &rows;
        let [re, im, energy] = out.each_mut().map(|p| &mut p[y * width..(y + 1) * width]);
        for x in 0..width {
            let gx = (3.0 * (a[x + 2] - a[x] + c[x + 2] - c[x]) + 10.0 * (b[x + 2] - b[x])) / 16.0;
            let gy = (3.0 * (c[x] - a[x] + c[x + 2] - a[x + 2]) + 10.0 * (c[x + 1] - a[x + 1])) / 16.0;
            re[x] = gx * gx - gy * gy;
            im[x] = 2.0 * gx * gy;
            energy[x] = gx * gx + gy * gy;
        }
    }
    out
}

/// Gaussian window average of a plane, zero outside; the window is cut at three deviations.
fn window(plane: &[f32], width: usize, height: usize, sigma: f64) -> Vec<f32> {
    let radius = (3.0 * sigma).ceil() as usize;
    let mut kernel: Vec<f32> = (0..=radius).map(|d| (-((d * d) as f64) / (2.0 * sigma * sigma)).exp() as f32).collect();
    let total = kernel[0] + 2.0 * kernel[1..].iter().sum::<f32>();
    kernel.iter_mut().for_each(|k| *k /= total);
    let mut across = vec![0.0f32; width * height];
    let mut padded = vec![0.0f32; width + 2 * radius];
    for (from, to) in plane.chunks_exact(width).zip(across.chunks_exact_mut(width)) {
        padded[radius..radius + width].copy_from_slice(from);
        for (d, &k) in kernel.iter().enumerate().skip(1) {
            let (left, right) = (&padded[radius - d..], &padded[radius + d..]);
            to.iter_mut().zip(left).zip(right).for_each(|((t, l), r)| *t += k * (l + r));
        }
        to.iter_mut().zip(from).for_each(|(t, f)| *t += kernel[0] * f);
    }
    let mut out = vec![0.0f32; width * height];
    for (y, to) in out.chunks_exact_mut(width).enumerate() {
        for v in y.saturating_sub(radius)..(y + radius + 1).min(height) {
            let k = kernel[v.abs_diff(y)];
            to.iter_mut().zip(&across[v * width..]).for_each(|(t, f)| *t += k * f);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A soft-edged straight line through the middle.
    fn line(angle: f32, size: usize) -> Raster<f32> {
        let centre = size as f32 / 2.0;
        Raster::from_fn(size, size, |x, y| {
            let (dx, dy) = (x as f32 + 0.5 - centre, y as f32 + 0.5 - centre);
            let d = (dy * angle.cos() - dx * angle.sin()).abs();
            (2.0 - d).clamp(0.0, 1.0)
        })
    }

    #[test]
    fn on_a_straight_line_the_tensor_is_the_squared_tangent() {
        for angle in [0.0f32, 0.4, 1.2, 2.3] {
            let size = 48;
            let f = features(&line(angle, size), Input::Tensor);
            let i = (size / 2) * size + size / 2;
            let at = |channel: usize| f.channels[channel * size * size + i];
            for scale in 0..2 {
                let z = Complex32::new(at(1 + 4 * scale), at(2 + 4 * scale));
                let truth = Complex32::from_polar(1.0, 2.0 * angle);
                assert!((z / z.norm() - truth).norm() < 0.03 && z.norm() > 0.9, "{angle}: {z} {truth}");
            }
            let c0 = Complex32::new(f.base[i], f.base[size * size + i]);
            assert!((c0 + Complex32::from_polar(1.0, 4.0 * angle)).norm() < 0.2);
        }
    }

    #[test]
    fn blank_paper_has_no_direction() {
        let f = features(&Raster::filled(20, 10, 0.0), Input::Tensor);
        assert_eq!(f.channels.len(), 9 * 200);
        assert!(f.channels.iter().chain(&f.base).all(|v| *v == 0.0));
    }
}
