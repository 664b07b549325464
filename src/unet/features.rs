//! What the network is shown, from ink.

use crate::clean::LineImage;
use crate::moments::{Moments, fit, gradients};
use crate::raster::Raster;
use serde::{Deserialize, Serialize};

/// The channels of the network's input.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Default)]
#[serde(rename_all = "lowercase")]
pub enum Input {
    /// The ink alone, as in the paper; the network regresses the coefficients themselves.
    Ink,
    /// The ink and the fourth-order structure tensor at two scales; the network regresses what has to be added to the
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

/// Windows of the moments: standard deviations in pixels.
const SCALES: [f64; 2] = [1.8, 4.0];

/// Gradient energy that counts as paper: coherence falls off below it.
const FLOOR: f32 = 2e-3;

/// Weight of the prior of the field that is corrected, as in [`crate::estimate::StructureTensor`].
const PRIOR: f32 = 0.06;

/// Input channels and the field that the output is added to, planes of `width x height`.
#[derive(Clone, Debug)]
pub struct Features {
    /// `[channels, height, width]`.
    pub channels: Vec<f32>,
    /// `Re c0`, `Im c0`, `Re c2`, `Im c2` of the field that the network corrects, `[4, height, width]`. Empty for
    /// [`Input::Ink`].
    pub base: Vec<f32>,
}

/// The ink that the network is shown of a cleaned image: its dark cores at 1, which is nine tenths of the way up the
/// ink on the mask.
pub fn shown(image: &LineImage) -> Raster<f32> {
    let mut counts = [0usize; 64];
    let inked = image.ink.data().iter().zip(image.mask.data()).filter(|(_, m)| **m);
    inked.for_each(|(i, _)| counts[(i.clamp(0.0, 1.0) * 63.0) as usize] += 1);
    let mut left = counts.iter().sum::<usize>() / 10;
    let mut core = 1.0f32;
    for (bin, &n) in counts.iter().enumerate().rev() {
        if left < n {
            core = ((bin as f32 + 0.5) / 63.0).clamp(0.2, 1.0);
            break;
        }
        left -= n;
    }
    image.ink.map(|i| (i / core).clamp(0.0, 1.0))
}

/// The network's input for an image of ink, 0 to 1.
///
/// In a window with the moments `m0`, `m2`, `m4` of the squared tangents (see [`crate::estimate::StructureTensor`]),
/// the channels are the ink, then `m2 / (m0 + floor)` and `m4 / (m0 + floor)` of each scale; the field that is
/// corrected is the one that fits the moments of the smaller scale best.
pub fn features(ink: &Raster<f32>, input: Input) -> Features {
    let mut channels = ink.data().to_vec();
    let mut base = Vec::new();
    if input == Input::Ink {
        return Features { channels, base };
    }
    let gradients = gradients(ink);
    for (scale, sigma) in SCALES.into_iter().enumerate() {
        let mut moments = window(&gradients, sigma);
        for m in &mut moments {
            let energy = m[0] + FLOOR;
            m[1..].iter_mut().for_each(|v| *v /= energy);
        }
        (1..5).for_each(|k| channels.extend(moments.iter().map(|m| m[k])));
        if scale == 0 {
            let solved: Vec<_> = moments.iter().map(|&[_, a, b, c, d]| fit(&[1.0, a, b, c, d], PRIOR)).collect();
            base.extend(solved.iter().map(|s| s.0.re));
            base.extend(solved.iter().map(|s| s.0.im));
            base.extend(solved.iter().map(|s| s.1.re));
            base.extend(solved.iter().map(|s| s.1.im));
        }
    }
    Features { channels, base }
}

/// Gaussian window average of moments, zero outside; the window is cut at three deviations.
fn window(moments: &Raster<Moments>, sigma: f64) -> Vec<Moments> {
    const N: usize = 5;
    let (width, height) = moments.size();
    let radius = (3.0 * sigma).ceil() as usize;
    let mut kernel: Vec<f32> = (0..=radius).map(|d| (-((d * d) as f64) / (2.0 * sigma * sigma)).exp() as f32).collect();
    let total = kernel[0] + 2.0 * kernel[1..].iter().sum::<f32>();
    kernel.iter_mut().for_each(|k| *k /= total);
    let mut across = vec![[0.0f32; N]; width * height];
    let mut padded = vec![[0.0f32; N]; width + 2 * radius];
    for (from, to) in moments.data().chunks_exact(width).zip(across.chunks_exact_mut(width)) {
        padded[radius..radius + width].copy_from_slice(from);
        let to = to.as_flattened_mut();
        for (d, &k) in kernel.iter().enumerate().skip(1) {
            let (left, right) = (padded[radius - d..].as_flattened(), padded[radius + d..].as_flattened());
            to.iter_mut().zip(left).zip(right).for_each(|((t, l), r)| *t += k * (l + r));
        }
        to.iter_mut().zip(from.as_flattened()).for_each(|(t, f)| *t += kernel[0] * f);
    }
    let mut out = vec![[0.0f32; N]; width * height];
    for (y, to) in out.chunks_exact_mut(width).enumerate() {
        for v in y.saturating_sub(radius)..(y + radius + 1).min(height) {
            let (k, from) = (kernel[v.abs_diff(y)], across[v * width..].as_flattened());
            to.as_flattened_mut().iter_mut().zip(from).for_each(|(t, f)| *t += k * f);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::decode;
    use kurbo::Vec2;
    use num_complex::Complex32;

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
            let base = |channel: usize| f.base[channel * size * size + i];
            let frame = decode(Complex32::new(base(0), base(1)), Complex32::new(base(2), base(3))).unwrap();
            let tangent = Vec2::from_angle(f64::from(angle));
            assert!(frame.u.cross(tangent).abs() < 0.02 || frame.v.cross(tangent).abs() < 0.02, "{angle}: {frame:?}");
        }
    }

    #[test]
    fn blank_paper_has_no_direction() {
        let f = features(&Raster::filled(20, 10, 0.0), Input::Tensor);
        assert_eq!(f.channels.len(), 9 * 200);
        assert!(f.channels.iter().chain(&f.base).all(|v| *v == 0.0));
    }
}
