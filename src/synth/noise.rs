//! Random textures.

use crate::raster::Raster;
use rand::Rng;

/// A sample of the standard normal distribution, from twelve bits of each of four uniform numbers: the tails end
/// at 3.5, which no texture shows.
pub(super) fn gaussian(rng: &mut impl Rng) -> f64 {
    let bits: u64 = rng.random();
    let sum: u64 = (0..4).map(|i| (bits >> (16 * i)) & 0xffff).sum();
    (sum as f64 / 65536.0 - 2.0) * 3f64.sqrt()
}

/// White noise with unit deviation.
pub(super) fn white(rng: &mut impl Rng, width: usize, height: usize) -> Raster<f32> {
    Raster::from_fn(width, height, |_, _| gaussian(rng) as f32)
}

/// Smooth noise, about -1 to 1: random values on a grid of `cell` pixels, interpolated with smooth steps.
pub(super) fn smooth(rng: &mut impl Rng, width: usize, height: usize, cell: f64) -> Raster<f32> {
    let (columns, rows) = ((width as f64 / cell) as usize + 3, (height as f64 / cell) as usize + 3);
    let grid = Raster::from_fn(columns, rows, |_, _| rng.random_range(-1.0..1.0f32));
    let (shift_x, shift_y) = (rng.random::<f64>(), rng.random::<f64>());
    let split = |i: usize, shift: f64| {
        let s = i as f64 / cell + shift;
        let t = (s - s.floor()) as f32;
        (s as usize, t * t * (3.0 - 2.0 * t))
    };
    let xs: Vec<_> = (0..width).map(|x| split(x, shift_x)).collect();
    let mut out = Raster::filled(width, height, 0.0);
    for (y, row) in out.data_mut().chunks_mut(width).enumerate() {
        let (gy, ty) = split(y, shift_y);
        for (value, &(gx, tx)) in row.iter_mut().zip(&xs) {
            let at = |dx, dy| grid[(gx + dx, gy + dy)];
            let top = at(0, 0) + (at(1, 0) - at(0, 0)) * tx;
            let bottom = at(0, 1) + (at(1, 1) - at(0, 1)) * tx;
            *value = top + (bottom - top) * ty;
        }
    }
    out
}

/// Gaussian blur, the raster's edge repeated outside.
pub(super) fn blur(image: &Raster<f32>, sigma: f64) -> Raster<f32> {
    if sigma < 0.05 {
        return image.clone();
    }
    let radius = (3.0 * sigma).ceil() as i64;
    let mut kernel: Vec<f32> =
        (-radius..=radius).map(|d| (-(d * d) as f64 / (2.0 * sigma * sigma)).exp() as f32).collect();
    let total: f32 = kernel.iter().sum();
    kernel.iter_mut().for_each(|k| *k /= total);
    let once = along_rows(image, &kernel);
    transposed(&along_rows(&transposed(&once), &kernel))
}

fn along_rows(image: &Raster<f32>, kernel: &[f32]) -> Raster<f32> {
    let (width, height) = image.size();
    let radius = kernel.len() / 2;
    let mut out = Raster::filled(width, height, 0.0f32);
    let mut padded = vec![0.0f32; width + 2 * radius];
    for y in 0..height {
        let row = image.row(y);
        padded[..radius].fill(row[0]);
        padded[radius..radius + width].copy_from_slice(row);
        padded[radius + width..].fill(row[width - 1]);
        let target = &mut out.data_mut()[y * width..(y + 1) * width];
        for (i, &k) in kernel.iter().enumerate() {
            target.iter_mut().zip(&padded[i..]).for_each(|(t, &p)| *t += k * p);
        }
    }
    out
}

fn transposed(image: &Raster<f32>) -> Raster<f32> {
    Raster::from_fn(image.height(), image.width(), |x, y| image[(y, x)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    #[test]
    fn white_noise_has_unit_deviation() {
        let noise = white(&mut ChaCha8Rng::seed_from_u64(1), 100, 100);
        let square = noise.data().iter().map(|v| v * v).sum::<f32>() / 1e4;
        assert!((square - 1.0).abs() < 0.05, "{square}");
    }

    #[test]
    fn blurring_keeps_the_sum_and_the_constant() {
        let mut spot = Raster::filled(21, 21, 0.0);
        spot[(10, 10)] = 1.0f32;
        let blurred = blur(&spot, 1.5);
        assert!((blurred.data().iter().sum::<f32>() - 1.0).abs() < 1e-5);
        assert!(blur(&Raster::filled(9, 5, 0.7), 2.0).data().iter().all(|v| (v - 0.7).abs() < 1e-6));
    }
}
