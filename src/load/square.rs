//! Pixels made square: a scan resampled along the axis on which its pixels are the longer.

use super::Scan;
use crate::raster::Raster;
use image::RgbImage;

/// A scan of another size, no smaller either way; the same scan where the size is its own.
///
/// Where it has two levels alone, edges are steps both ways: they are smoothed both ways, by what the longer side of a
/// pixel asks for. Lines of a fax fall to pieces otherwise where they run nearly along its rows.
pub(super) fn resized(scan: Scan, size: (usize, usize)) -> Scan {
    let old = scan.gray.size();
    if old == size {
        return scan;
    }
    let (across, down) = if scan.rgb.is_none() && has_two_levels(&scan.gray) {
        let step = |old: usize, new: usize| new as f64 / old as f64;
        let longer = step(old.0, size.0).max(step(old.1, size.1));
        let smoothed = |old, new| taps(old, new, longer / step(old, new), spline);
        (smoothed(old.0, size.0), smoothed(old.1, size.1))
    } else {
        (taps(old.0, size.0, 1.0, cubic), taps(old.1, size.1, 1.0, cubic))
    };
    let gray = resample(&scan.gray, &across, &down, |v| [v], |[v]| v.clamp(0.0, 1.0));
    let rgb = scan.rgb.and_then(|rgb| {
        let pixels = Raster::from_vec(old.0, old.1, rgb.pixels().map(|p| p.0).collect())?;
        let new = resample(&pixels, &across, &down, |p| p.map(f32::from), |p| p.map(byte));
        RgbImage::from_raw(size.0 as u32, size.1 as u32, new.data().iter().flatten().copied().collect())
    });
    Scan { gray, rgb, dpi: scan.dpi }
}

fn has_two_levels(gray: &Raster<f32>) -> bool {
    let (low, high) = gray.data().iter().fold((1.0f32, 0.0f32), |(low, high), &v| (low.min(v), high.max(v)));
    gray.data().iter().all(|&v| v == low || v == high)
}

fn byte(v: f32) -> u8 {
    v.round().clamp(0.0, 255.0) as u8
}

/// What a new sample is made of: old ones and their weights.
type Taps = Vec<(usize, f32)>;

/// A grid of new samples from those of another: down first, then across.
fn resample<T: Copy + Send + Sync, const N: usize>(
    image: &Raster<T>,
    across: &[Taps],
    down: &[Taps],
    channels: impl Fn(T) -> [f32; N] + Sync,
    pixel: impl Fn([f32; N]) -> T + Sync,
) -> Raster<T> {
    Raster::from_rows(across.len(), down.len(), image.data()[0], |y, to| {
        let mut line = vec![[0.0; N]; image.width()];
        for &(at, weight) in &down[y] {
            let row = &image.data()[at * image.width()..][..image.width()];
            for (sum, value) in line.iter_mut().zip(row.iter().map(|&v| channels(v))) {
                (0..N).for_each(|c| sum[c] += weight * value[c]);
            }
        }
        for (to, taps) in to.iter_mut().zip(across) {
            *to = pixel(std::array::from_fn(|c| taps.iter().map(|&(at, weight)| weight * line[at][c]).sum()));
        }
    })
}

/// For each of `new` samples in the place of `old` ones, what it is made of by a kernel that reaches twice `scale` old
/// samples both ways. Samples that stay where they are keep their values where nothing is to be smoothed.
fn taps(old: usize, new: usize, scale: f64, kernel: fn(f64) -> f64) -> Vec<Taps> {
    if old == new && scale == 1.0 {
        return (0..old).map(|i| vec![(i, 1.0)]).collect();
    }
    let step = old as f64 / new as f64;
    let sample = |i: usize| {
        let place = (i as f64 + 0.5) * step - 0.5;
        let (first, last) = ((place - 2.0 * scale).ceil() as isize, (place + 2.0 * scale).floor() as isize);
        let weight = |at: isize| kernel((place - at as f64) / scale);
        let sum: f64 = (first..=last).map(weight).sum();
        let within = |at: isize| at.clamp(0, old as isize - 1) as usize;
        (first..=last).map(|at| (within(at), (weight(at) / sum) as f32)).collect()
    };
    (0..new).map(sample).collect()
}

/// The cubic B-spline: smooth, and without the last sharpness.
fn spline(distance: f64) -> f64 {
    let x = distance.abs();
    match x {
        _ if x < 1.0 => (3.0 * x * x * x - 6.0 * x * x + 4.0) / 6.0,
        _ if x < 2.0 => (2.0 - x).powi(3) / 6.0,
        _ => 0.0,
    }
}

/// The cubic of Mitchell and Netravali (B = C = 1/3): neither steps nor rings show.
fn cubic(distance: f64) -> f64 {
    let x = distance.abs();
    match x {
        _ if x < 1.0 => (7.0 * x * x * x - 12.0 * x * x + 16.0 / 3.0) / 6.0,
        _ if x < 2.0 => (-7.0 / 3.0 * x * x * x + 12.0 * x * x - 20.0 * x + 32.0 / 3.0) / 6.0,
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scan(gray: Raster<f32>) -> Scan {
        Scan { gray, rgb: None, dpi: None }
    }

    #[test]
    fn weights_sum_to_one() {
        for (old, new, scale) in [(7, 19, 1.0), (98, 204, 1.0), (1, 3, 1.0), (50, 51, 1.3), (9, 9, 1.0), (9, 9, 2.1)] {
            for taps in [cubic, spline].into_iter().flat_map(|kernel| taps(old, new, scale, kernel)) {
                assert!((taps.iter().map(|t| t.1).sum::<f32>() - 1.0).abs() < 1e-5);
                assert!(taps.iter().all(|t| t.0 < old));
            }
        }
    }

    #[test]
    fn steps_of_one_bit_are_smoothed_both_ways_alike() {
        // A line that falls by a pixel in eight; twice as high, by a pixel in four.
        let gray = Raster::from_fn(80, 40, |x, y| if (y + 5).abs_diff(x / 8 + 10) < 2 { 0.0 } else { 1.0 });
        let tall = resized(scan(gray), (80, 80)).gray;
        let ink = |x: usize| (0..80).map(|y| 1.0 - tall[(x, y)]).sum::<f32>();
        let middle = |x: usize| (0..80).map(|y| (1.0 - tall[(x, y)]) * y as f32).sum::<f32>() / ink(x);
        for x in 8..72 {
            assert!((ink(x) - 6.0).abs() < 1e-3);
            assert!((middle(x + 1) - middle(x) - 0.25).abs() < 0.5, "{x}: no step of two pixels");
        }
    }

    #[test]
    fn a_slope_stays_a_slope_and_an_edge_stays_in_place() {
        let slope = scan(Raster::from_fn(5, 20, |_, y| (y as f32 + 0.5) / 20.0));
        let tall = resized(slope, (5, 50)).gray;
        assert!((5..45).all(|y| (tall[(2, y)] - (y as f32 + 0.5) / 50.0).abs() < 1e-5));
        let edge = scan(Raster::from_fn(20, 4, |x, _| {
            if x < 8 {
                0.0
            } else if x < 19 {
                1.0
            } else {
                0.99
            }
        }));
        let wide = resized(edge, (60, 4)).gray;
        assert!((wide[(23, 1)] + wide[(24, 1)] - 1.0).abs() < 1e-5, "the half lies on the old edge");
        assert!(wide[(18, 1)] < 0.02 && wide[(29, 1)] > 0.98);
    }

    #[test]
    fn colour_goes_with_the_grey() {
        let rgb = RgbImage::from_fn(3, 4, |_, y| image::Rgb([if y < 2 { 255 } else { 0 }, 10, 20]));
        let both =
            Scan { gray: Raster::from_fn(3, 4, |_, y| if y < 2 { 1.0 } else { 0.0 }), rgb: Some(rgb), dpi: None };
        let both = resized(both, (3, 9));
        let rgb = both.rgb.unwrap();
        assert_eq!(rgb.dimensions(), (3, 9));
        for (y, row) in (0..9).zip(rgb.rows()) {
            assert!(row.into_iter().all(|p| (f32::from(p[0]) / 255.0 - both.gray[(1, y)]).abs() < 0.003 && p[1] == 10));
        }
    }
}
