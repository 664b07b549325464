//! The paper under the ink: the colour that a page would have if nothing were drawn on it.

use crate::raster::{Mask, Raster};
use rayon::prelude::*;

/// What is not known of paper is the mean of what is known within so many pixels, so that the grain of one does not tell.
const REACH: i64 = 2;

type Rgb = [f32; 3];

/// Fills what is not known of a picture from its rims inwards, ring by ring, so that the paper on one side of a line tells
/// nothing of that on its other side: a line may run along the edge of a tint.
///
/// `color` is told for each column and row where `known`, which is of the picture's size. Where nothing is known at all, all
/// is black.
pub(super) fn filled(color: impl Fn(usize, usize) -> Rgb + Sync, mut known: Mask) -> Raster<Rgb> {
    let (width, height) = known.size();
    let mut paper = Raster::from_rows(width, height, [0.0; 3], |y, row| {
        row.iter_mut().enumerate().filter(|(x, _)| known[(*x, y)]).for_each(|(x, to)| *to = color(x, y));
    });
    let mut is_met = known.clone();
    let all: Vec<(usize, usize)> = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).collect();
    let mut ring = beside(all.into_iter().filter(|&p| known[p]), &mut is_met);
    while !ring.is_empty() {
        let colors: Vec<Rgb> = ring.par_iter().map(|&p| mean_around(&paper, &known, p)).collect();
        for (&p, color) in ring.iter().zip(colors) {
            (paper[p], known[p]) = (color, true);
        }
        ring = beside(ring.into_iter(), &mut is_met);
    }
    paper
}

/// The pixels beside some that were not met yet, which now are.
fn beside(pixels: impl Iterator<Item = (usize, usize)>, is_met: &mut Mask) -> Vec<(usize, usize)> {
    let mut new = Vec::new();
    for (x, y) in pixels {
        for (dx, dy) in [(-1, 0), (1, 0), (0, -1), (0, 1)] {
            let (x, y) = (x as i64 + dx, y as i64 + dy);
            if is_met.get(x, y) == Some(false) {
                let p = (x as usize, y as usize);
                is_met[p] = true;
                new.push(p);
            }
        }
    }
    new
}

/// The mean of what is known around a pixel beside which something is.
fn mean_around(paper: &Raster<Rgb>, known: &Mask, (x, y): (usize, usize)) -> Rgb {
    let (mut sum, mut count) = ([0.0; 3], 0.0);
    for (dx, dy) in (-REACH..=REACH).flat_map(|dy| (-REACH..=REACH).map(move |dx| (dx, dy))) {
        let (x, y) = (x as i64 + dx, y as i64 + dy);
        if known.get(x, y) == Some(true) {
            let color = paper[(x as usize, y as usize)];
            sum.iter_mut().zip(color).for_each(|(sum, c)| *sum += c);
            count += 1.0;
        }
    }
    sum.map(|sum| sum / count)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slope_goes_on_under_what_is_not_known() {
        let slope = |x: usize, y: usize| [0.2 + 0.006 * x as f32, 0.9 - 0.004 * y as f32, 0.5];
        for width in [1, 2, 3, 7, 12] {
            let paper = filled(slope, Raster::from_fn(100, 71, |x, _| !(40..40 + width).contains(&x)));
            for (y, x) in (0..71).flat_map(|y| (0..100).map(move |x| (y, x))) {
                let off = paper[(x, y)].iter().zip(slope(x, y)).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
                assert!(off < 0.006 * width as f32, "{off} off at ({x}, {y}) of {width}");
            }
        }
    }

    #[test]
    fn nothing_known_is_black_and_one_pixel_tells_all() {
        let nothing = filled(|_, _| [0.7; 3], Raster::filled(5, 4, false));
        assert!(nothing.data().iter().all(|color| *color == [0.0; 3]));
        let all = filled(|_, _| [0.7; 3], Raster::from_fn(33, 9, |x, y| (x, y) == (30, 2)));
        assert!(all.data().iter().all(|color| color.iter().all(|c| (c - 0.7).abs() < 1e-5)));
    }

    #[test]
    fn each_side_of_a_line_keeps_its_own_paper() {
        for width in [2, 5, 6] {
            let tint = |x: usize, _: usize| if x < 40 { [1.0, 0.9, 0.5] } else { [1.0; 3] };
            let paper = filled(tint, Raster::from_fn(80, 50, |x, _| !(40 - width..40 + width).contains(&x)));
            for (y, x) in (0..50).flat_map(|y| (0..80).filter(|x: &usize| x.abs_diff(40) > 1).map(move |x| (y, x))) {
                let off = paper[(x, y)].iter().zip(tint(x, y)).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
                assert!(off < 1e-5, "{off} off at ({x}, {y}) of {width}");
            }
        }
    }
}
