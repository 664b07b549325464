//! What the network is shown, from ink.

use crate::clean::LineImage;
use crate::moments::{Windows, fit};
use crate::raster::{Raster, runs};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::ops::Range;

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
    /// The page as it came in, red, green and blue less a half; see [`crate::unet::InkNet`].
    Color,
}

impl Input {
    /// Number of channels.
    pub fn channels(self) -> usize {
        match self {
            Self::Ink => 1,
            Self::Tensor => 9,
            Self::Color => 3,
        }
    }
}

/// What each channel of the input and of the field is multiplied by in a drawing that is laid down otherwise, from what the
/// real and imaginary parts of squared directions, and of their fourth powers, are.
pub(crate) fn signs([re2, im2, re4, im4]: [f32; 4]) -> ([f32; 9], [f32; 4]) {
    ([1.0, re2, im2, re4, im4, re2, im2, re4, im4], [re4, im4, re2, im2])
}

/// Windows of the moments: standard deviations in pixels, and how many of them a window reaches.
const SCALES: [f64; 2] = [1.8, 4.0];
const REACH: f64 = 3.0;

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
    let shown = Shown::of(image);
    Raster::from_fn(image.ink.width(), image.ink.height(), |x, y| shown.at(x, y))
}

/// [`shown`] pixel by pixel.
pub(crate) struct Shown<'a> {
    ink: &'a Raster<f32>,
    core: f32,
}

impl<'a> Shown<'a> {
    pub fn of(image: &'a LineImage) -> Self {
        let counts = (0..image.ink.height()).into_par_iter().fold(
            || [0usize; 64],
            |mut counts, y| {
                let ink = image.ink.row(y);
                let inked = runs(image.mask.row(y)).flatten().map(|x| ink[x]);
                inked.for_each(|i| counts[(i.clamp(0.0, 1.0) * 63.0) as usize] += 1);
                counts
            },
        );
        let counts = counts.reduce(|| [0; 64], |a, b| std::array::from_fn(|k| a[k] + b[k]));
        let mut left = counts.iter().sum::<usize>() / 10;
        let mut core = 1.0f32;
        for (bin, &n) in counts.iter().enumerate().rev() {
            if left < n {
                core = ((bin as f32 + 0.5) / 63.0).clamp(0.2, 1.0);
                break;
            }
            left -= n;
        }
        Self { ink: &image.ink, core }
    }

    pub fn at(&self, x: usize, y: usize) -> f32 {
        (self.ink[(x, y)] / self.core).clamp(0.0, 1.0)
    }
}

/// The input of a field network for an image of ink, 0 to 1. [`Input::Color`] is not made from ink.
///
/// In a window with the moments `m0`, `m2`, `m4` of the squared tangents (see [`crate::estimate::StructureTensor`]),
/// the channels are the ink, then `m2 / (m0 + floor)` and `m4 / (m0 + floor)` of each scale; the field that is
/// corrected is the one that fits the moments of the smaller scale best.
pub fn features(ink: &Raster<f32>, input: Input) -> Features {
    let (width, height) = ink.size();
    let everywhere = vec![std::iter::once(0..width).collect(); height];
    let mut extractor = Extractor::default();
    extractor.extract(ink, input, &everywhere);
    let base: Vec<[f32; 4]> = (0..width * height).filter_map(|i| extractor.base(i)).collect();
    let base = (0..4).flat_map(|k| base.iter().map(move |b| b[k])).collect();
    Features { channels: extractor.channels, base }
}

/// Computes features where they are wanted; its buffers are reused from image to image.
#[derive(Clone, Debug)]
pub(crate) struct Extractor {
    windows: Windows,
    /// [`Features::channels`], of no meaning where they were not wanted.
    pub channels: Vec<f32>,
    pixels: usize,
}

impl Default for Extractor {
    fn default() -> Self {
        Self { windows: Windows::new(&SCALES, REACH), channels: Vec::new(), pixels: 0 }
    }
}

impl Extractor {
    /// Fills the channels; `wanted[y]` are ranges of columns, in order.
    pub fn extract(&mut self, ink: &Raster<f32>, input: Input, wanted: &[Vec<Range<usize>>]) {
        let (width, height) = ink.size();
        let n = width * height;
        self.pixels = n;
        self.channels.resize(input.channels() * n, 0.0);
        self.channels[..n].copy_from_slice(ink.data());
        if input != Input::Tensor {
            return;
        }
        let (_, moments) = self.channels.split_at_mut(n);
        self.windows.average(ink, wanted, |scale, x, y, averages| {
            let planes = moments[4 * scale * n..4 * (scale + 1) * n].chunks_exact_mut(n).enumerate();
            for (k, plane) in planes {
                let row = &mut plane[y * width + x..][..averages.len()];
                row.iter_mut().zip(averages).for_each(|(to, m)| *to = m[k + 1] / (m[0] + FLOOR));
            }
        });
    }

    /// `Re c0`, `Im c0`, `Re c2`, `Im c2` of the field that is corrected at a pixel, by its number; `None` for
    /// [`Input::Ink`].
    pub fn base(&self, pixel: usize) -> Option<[f32; 4]> {
        let mut moments = [1.0; 5];
        for (k, m) in moments.iter_mut().enumerate().skip(1) {
            *m = *self.channels.get(k * self.pixels + pixel)?;
        }
        let (c0, c2, _) = fit(&moments, PRIOR);
        Some([c0.re, c0.im, c2.re, c2.im])
    }
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
