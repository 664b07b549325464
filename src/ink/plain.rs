//! Pages that have nothing on them but paper of one tone and ink.

use crate::load::Scan;
use crate::raster::Raster;
use rayon::prelude::*;

/// Tones by which the paper of a render differs from itself: rounding.
const FLAT: f32 = 1.5 / 255.0;
/// The paper of a render is at least this share of it.
const PAPER: f64 = 0.3;
/// Ink that has none of this strength within so many pixels is no edge of a line, but a tint, a shadow or ruling.
const CORE: f32 = 0.3;
const EDGE: usize = 2;
/// A page is plain where no more than this share of its ink is of that kind.
const STRAY: f64 = 0.01;

/// Whether a page has paper of one tone and strong ink on it, and no shadow, tint, ruling or stain.
pub(crate) fn is_plain(scan: &Scan) -> bool {
    let ink = strength(scan);
    let all = ink.data().len();
    let inked = ink.data().par_iter().filter(|&&i| i > FLAT).count();
    if ((all - inked) as f64) < PAPER * all as f64 {
        return false;
    }
    let has_core = |x: usize, y: usize| {
        let rows = y.saturating_sub(EDGE)..(y + EDGE + 1).min(ink.height());
        let columns = x.saturating_sub(EDGE)..(x + EDGE + 1).min(ink.width());
        rows.into_iter().any(|y| ink.row(y)[columns.clone()].iter().any(|&i| i >= CORE))
    };
    let stray = |y: usize| (0..ink.width()).filter(|&x| ink[(x, y)] > FLAT && !has_core(x, y)).count();
    let stray: usize = (0..ink.height()).into_par_iter().map(stray).sum();
    stray as f64 <= STRAY * inked as f64
}

/// By how much the channel that differs most differs from the paper's commonest tone.
fn strength(scan: &Scan) -> Raster<f32> {
    let (width, height) = scan.gray.size();
    let Some(rgb) = &scan.rgb else {
        let byte = |g: f32| (255.0 * g.clamp(0.0, 1.0)).round() as u8;
        let paper = f32::from(commonest(scan.gray.data().iter().map(|&g| byte(g)))) / 255.0;
        return scan.gray.mapped(0.0, |g| (g - paper).abs());
    };
    let paper = [0, 1, 2].map(|c| commonest(rgb.pixels().map(|pixel| pixel.0[c])));
    Raster::from_rows(width, height, 0.0, |y, row| {
        for (x, to) in row.iter_mut().enumerate() {
            let color = rgb.get_pixel(x as u32, y as u32).0;
            let most = color.iter().zip(paper).map(|(&c, paper)| c.abs_diff(paper)).max().unwrap_or(0);
            *to = f32::from(most) / 255.0;
        }
    })
}

/// The most common of some tones.
fn commonest(tones: impl Iterator<Item = u8>) -> u8 {
    let mut counts = [0usize; 256];
    tones.for_each(|tone| counts[usize::from(tone)] += 1);
    (0..=255).max_by_key(|&tone| counts[usize::from(tone)]).unwrap_or(255)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A slanted line with grey edges on paper of a tone.
    fn line(paper: f32, ink: f32) -> Raster<f32> {
        Raster::from_fn(120, 80, |x, y| {
            let off = (y as f32 - 20.0 - 0.3 * x as f32).abs();
            paper + (ink - paper) * (2.0 - off).clamp(0.0, 1.0)
        })
    }

    fn grey(gray: Raster<f32>) -> Scan {
        Scan { gray, rgb: None, dpi: None }
    }

    #[test]
    fn lines_on_paper_of_one_tone_are_plain() {
        for (paper, ink) in [(1.0, 0.0), (0.9, 0.5), (0.1, 0.8)] {
            assert!(is_plain(&grey(line(paper, ink))));
        }
        assert!(is_plain(&grey(Raster::filled(9, 9, 0.4))));
    }

    #[test]
    fn a_tint_a_shadow_or_grain_is_not_plain() {
        let render = line(1.0, 0.0);
        let with = |f: &dyn Fn(usize, usize) -> f32| grey(Raster::from_fn(120, 80, |x, y| render[(x, y)] * f(x, y)));
        assert!(!is_plain(&with(&|x, _| if x > 90 { 0.8 } else { 1.0 })));
        assert!(!is_plain(&with(&|x, _| 1.0 - 0.002 * x as f32)));
        assert!(!is_plain(&with(&|x, y| if (3 * x + 7 * y) % 5 == 0 { 0.97 } else { 1.0 })));
    }
}
