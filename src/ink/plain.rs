//! Pages that have nothing on them but paper of one tone and ink.

use crate::raster::Raster;
use rayon::prelude::*;

/// Tones by which the paper of a render differs from itself: rounding.
const FLAT: f32 = 1.5 / 255.0;
/// Ink that has none of at least this share of the darkest within so many pixels is no edge of a line.
const CORE: f32 = 0.5;
const EDGE: usize = 2;
/// A page is plain where no more than this share of its ink is of that kind.
const STRAY: f64 = 0.01;

/// Whether a page has paper of one tone and ink of about one darkness: no shadow, tint, ruling or stain.
pub(crate) fn is_plain(gray: &Raster<f32>) -> bool {
    let paper = commonest(gray);
    let inked = |g: f32| (g - paper).abs();
    let most = gray.data().par_iter().map(|&g| inked(g)).reduce(|| 0.0, f32::max);
    let has_core = |x: usize, y: usize| {
        let rows = y.saturating_sub(EDGE)..(y + EDGE + 1).min(gray.height());
        let columns = x.saturating_sub(EDGE)..(x + EDGE + 1).min(gray.width());
        rows.into_iter().any(|y| gray.row(y)[columns.clone()].iter().any(|&g| inked(g) >= CORE * most))
    };
    let of_row = |y: usize| {
        let ink = gray.row(y).iter().enumerate().filter(|(_, g)| inked(**g) > FLAT);
        ink.fold([0usize; 2], |[all, stray], (x, _)| [all + 1, stray + usize::from(!has_core(x, y))])
    };
    let [all, stray] =
        (0..gray.height()).into_par_iter().map(of_row).reduce(|| [0; 2], |a, b| [a[0] + b[0], a[1] + b[1]]);
    stray as f64 <= STRAY * all as f64
}

/// The tone that most pixels have, of 256.
fn commonest(gray: &Raster<f32>) -> f32 {
    let mut counts = [0usize; 256];
    gray.data().iter().for_each(|&g| counts[(255.0 * g.clamp(0.0, 1.0)).round() as usize] += 1);
    let most = (0..256).max_by_key(|&tone| counts[tone]).unwrap_or(255);
    most as f32 / 255.0
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

    #[test]
    fn lines_on_paper_of_one_tone_are_plain() {
        for (paper, ink) in [(1.0, 0.0), (0.9, 0.5), (0.1, 0.8)] {
            assert!(is_plain(&line(paper, ink)));
        }
        assert!(is_plain(&Raster::filled(9, 9, 0.4)));
    }

    #[test]
    fn a_tint_a_shadow_or_grain_is_not_plain() {
        let render = line(1.0, 0.0);
        let with = |f: &dyn Fn(usize, usize) -> f32| Raster::from_fn(120, 80, |x, y| render[(x, y)] * f(x, y));
        assert!(!is_plain(&with(&|x, _| if x > 90 { 0.8 } else { 1.0 })));
        assert!(!is_plain(&with(&|x, _| 1.0 - 0.002 * x as f32)));
        assert!(!is_plain(&with(&|x, y| if (3 * x + 7 * y) % 5 == 0 { 0.97 } else { 1.0 })));
    }
}
