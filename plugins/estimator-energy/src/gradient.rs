//! The edges that the field is to follow, as moments of their directions.
//!
//! An edge with unit tangent `tau` asks for `f(tau) = tau^4 + c2 tau^2 + c0 = 0`. Divided by `tau^2`, which changes no
//! modulus, and with `p = tau^2`, that is `p + c2 + c0 conj(p) = 0`. The sum of squares over any number of edges,
//! `sum w |p + c2 + c0 conj(p)|^2`, depends on them by three moments only: `m0 = sum w`, `m2 = sum w p` and
//! `m4 = sum w p^2`.

use fieldtrace::clean::LineImage;
use fieldtrace::raster::Raster;
use num_complex::Complex64;
use std::ops::{AddAssign, Mul};

/// Weights and directions of edges, summed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Moments {
    /// `sum w`, the edges' total weight.
    pub(crate) m0: f64,
    /// `sum w tau^2`.
    pub(crate) m2: Complex64,
    /// `sum w tau^4`.
    pub(crate) m4: Complex64,
}

impl AddAssign for Moments {
    fn add_assign(&mut self, other: Self) {
        self.m0 += other.m0;
        self.m2 += other.m2;
        self.m4 += other.m4;
    }
}

impl Mul<f64> for Moments {
    type Output = Self;
    fn mul(self, k: f64) -> Self {
        Self { m0: self.m0 * k, m2: self.m2 * k, m4: self.m4 * k }
    }
}

/// The four neighbours of a pixel.
pub(crate) const SIDES: [(i64, i64); 4] = [(-1, 0), (1, 0), (0, -1), (0, 1)];

/// The edges that an ink pixel answers for: its own, and a share of those of the paper pixels beside it.
///
/// Half of a line's slope lies on the paper's side of the threshold; each paper pixel divides what it has evenly
/// among the ink pixels at its four sides.
pub(crate) fn moments(image: &LineImage, x: usize, y: usize) -> Moments {
    let (x, y) = (x as i64, y as i64);
    let ink = |x, y| image.mask.get(x, y);
    let mut sum = edge(&image.ink, x, y);
    for (dx, dy) in SIDES {
        let (x, y) = (x + dx, y + dy);
        if ink(x, y) == Some(false) {
            let sharers = SIDES.iter().filter(|(dx, dy)| ink(x + dx, y + dy) == Some(true)).count();
            sum += edge(&image.ink, x, y) * (1.0 / sharers as f64);
        }
    }
    sum
}

/// The edge at one pixel by Scharr's 3x3 derivative, weighted by its squared gradient in ink per pixel.
///
/// The tangent is the gradient turned by 90 degrees, `tau = i g / |g|`, so `tau^2 = -g^2 / |g|^2`.
fn edge(ink: &Raster<f32>, x: i64, y: i64) -> Moments {
    let (right, bottom) = (ink.width() as i64 - 1, ink.height() as i64 - 1);
    let at = |dx: i64, dy: i64| f64::from(ink[((x + dx).clamp(0, right) as usize, (y + dy).clamp(0, bottom) as usize)]);
    let slope = |a: f64, b: f64, c: f64| (3.0 * (a + c) + 10.0 * b) / 32.0;
    let gradient = Complex64::new(
        slope(at(1, -1) - at(-1, -1), at(1, 0) - at(-1, 0), at(1, 1) - at(-1, 1)),
        slope(at(-1, 1) - at(-1, -1), at(0, 1) - at(0, -1), at(1, 1) - at(1, -1)),
    );
    let energy = gradient.norm_sqr();
    if energy < 1e-9 {
        return Moments::default();
    }
    let p = -gradient * gradient / energy;
    Moments { m0: energy, m2: p * energy, m4: p * p * energy }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fieldtrace::clean::{Decisions, Noise, NoiseMap};
    use fieldtrace::raster::Mask;

    #[test]
    fn a_slope_has_the_tangent_across_it() {
        let slope = |angle: f64| {
            let (sin, cos) = angle.sin_cos();
            Raster::from_fn(3, 3, |x, y| (0.1 * (x as f64 * cos + y as f64 * sin)) as f32)
        };
        for degrees in (0..180).step_by(15) {
            let angle = f64::from(degrees).to_radians();
            let m = edge(&slope(angle), 1, 1);
            // The gradient has the angle, its square twice the angle, and the tangent's square is opposite.
            let expected = -Complex64::cis(2.0 * angle);
            assert!((m.m0 - 0.01).abs() < 1e-6, "{m:?}");
            assert!((m.m2 / m.m0 - expected).norm() < 1e-4, "{degrees}: {m:?}");
            assert!((m.m4 / m.m0 - expected * expected).norm() < 1e-4, "{degrees}: {m:?}");
        }
    }

    #[test]
    fn what_paper_pixels_have_is_divided_not_doubled() {
        let ink = Raster::from_fn(9, 9, |x, y| if (3..6).contains(&x) && (2..7).contains(&y) { 1.0f32 } else { 0.0 });
        let mask: Mask = ink.map(|i| i > 0.5);
        let depth = ink.clone();
        let image = LineImage {
            ink,
            solid: mask.map(|_| false),
            mask,
            depth,
            line_width: 3.0,
            scale: 1.0,
            page_scale: 1.0,
            noise: NoiseMap::even(Noise::default()),
            decisions: Decisions::default(),
            blur: 0.0,
            solids: Vec::new(),
            broad: None,
            colors: None,
        };
        let pixels = (0..81).map(|i| (i % 9, i / 9));
        let received: f64 = pixels.clone().filter(|&p| image.mask[p]).map(|(x, y)| moments(&image, x, y).m0).sum();
        let beside = |&(x, y): &(usize, usize)| {
            image.mask[(x, y)]
                || SIDES.iter().any(|(dx, dy)| image.mask.get(x as i64 + dx, y as i64 + dy) == Some(true))
        };
        let present: f64 = pixels.filter(beside).map(|(x, y)| edge(&image.ink, x as i64, y as i64).m0).sum();
        assert!((received - present).abs() < 1e-9, "{received} of {present}");
    }
}
