//! The paper under the ink: the colour that a page would have if nothing were drawn on it.

use crate::raster::{Raster, between};

/// Samples that count as a whole one: where less is known, a coarser level helps.
const ENOUGH: f32 = 1.0;

/// Colour channels of a page, and how far each pixel is known, 0 to 1: premultiplied.
type Known = Raster<[f32; 4]>;

/// Fills what is not known of a picture from what is known around it, from nearest places first (push and pull, Gortler et
/// al. 1996, section 3.4.2): each level of a pyramid is half as large, and pixels that are not known take what the next
/// coarser level says.
///
/// `color` and `known`, 0 to 1, are told for each column and row of a picture of `width x height`, which is not empty.
pub(super) fn filled(
    (width, height): (usize, usize),
    color: impl Fn(usize, usize) -> [f32; 3] + Sync,
    known: &Raster<f32>,
) -> Raster<[f32; 3]> {
    let finest = Raster::from_rows(width, height, [0.0; 4], |y, row| {
        for (x, to) in row.iter_mut().enumerate() {
            let (weight, [r, g, b]) = (known[(x, y)], color(x, y));
            *to = [r * weight, g * weight, b * weight, weight];
        }
    });
    let mut levels = vec![finest];
    while let Some(last) = levels.last().filter(|last| last.width().max(last.height()) > 1) {
        levels.push(halved(last));
    }
    let mut coarser = levels.pop().map(|top| top.mapped([0.0; 3], |sum| over(sum, sum[3])));
    while let Some(level) = levels.pop() {
        coarser = coarser.map(|coarser| pulled(&level, &coarser));
    }
    coarser.unwrap_or_else(|| Raster::zeroed(width, height))
}

/// The sums of squares of four pixels, which count as one where they tell enough.
fn halved(level: &Known) -> Known {
    Raster::from_rows(level.width().div_ceil(2), level.height().div_ceil(2), [0.0; 4], |y, row| {
        for (x, to) in row.iter_mut().enumerate() {
            for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                if let Some(part) = level.get((2 * x + dx) as i64, (2 * y + dy) as i64) {
                    to.iter_mut().zip(part).for_each(|(to, part)| *to += part);
                }
            }
            let most = to[3].max(ENOUGH);
            to.iter_mut().for_each(|to| *to *= ENOUGH / most);
        }
    })
}

/// A level with what it does not know from the coarser one, between whose pixels it is interpolated.
fn pulled(level: &Known, coarser: &Raster<[f32; 3]>) -> Raster<[f32; 3]> {
    let (columns, rows) = coarser.size();
    Raster::from_rows(level.width(), level.height(), [0.0; 3], |y, row| {
        let (top, bottom, down) = between(y, 2, rows);
        for (x, to) in row.iter_mut().enumerate() {
            let sum = level[(x, y)];
            let missing = (1.0 - sum[3]).max(0.0);
            if missing == 0.0 {
                *to = over(sum, sum[3]);
                continue;
            }
            let (left, right, along) = between(x, 2, columns);
            for (c, to) in to.iter_mut().enumerate() {
                let mix = |y: usize| coarser[(left, y)][c] * (1.0 - along) + coarser[(right, y)][c] * along;
                *to = sum[c] + missing * (mix(top) * (1.0 - down) + mix(bottom) * down);
            }
        }
    })
}

fn over([r, g, b, _]: [f32; 4], weight: f32) -> [f32; 3] {
    if weight > 0.0 { [r / weight, g / weight, b / weight] } else { [0.0; 3] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slope_goes_on_under_what_is_not_known() {
        let slope = |x: usize, y: usize| [0.2 + 0.006 * x as f32, 0.9 - 0.004 * y as f32, 0.5];
        for width in [1, 2, 3, 7, 12] {
            let known = Raster::from_fn(100, 71, |x, _| if (40..40 + width).contains(&x) { 0.0 } else { 1.0 });
            let paper = filled((100, 71), slope, &known);
            for (y, x) in (0..71).flat_map(|y| (0..100).map(move |x| (y, x))) {
                let off = paper[(x, y)].iter().zip(slope(x, y)).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
                assert!(off < 0.006 * width as f32, "{off} off at ({x}, {y}) of {width}");
            }
        }
    }

    #[test]
    fn nothing_known_is_black_and_one_pixel_tells_all() {
        let nothing = filled((5, 4), |_, _| [0.7; 3], &Raster::filled(5, 4, 0.0));
        assert!(nothing.data().iter().all(|color| *color == [0.0; 3]));
        let one = Raster::from_fn(33, 9, |x, y| if (x, y) == (30, 2) { 1.0 } else { 0.0 });
        let all = filled((33, 9), |_, _| [0.7; 3], &one);
        assert!(all.data().iter().all(|color| color.iter().all(|c| (c - 0.7).abs() < 1e-5)));
    }
}
