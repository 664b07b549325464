//! Distances from ink to paper, exact and in linear time (Meijster, Roerdink & Hesselink 2000).
//!
//! First the distance to paper within each column. Then along each row, where a pixel's squared distance is the lowest
//! of the parabolas that stand on the column distances of its row. Beyond the paper that ends a run of ink no parabola
//! can be the lowest, so that each run is solved by itself and paper costs nothing.

use crate::raster::{Mask, Raster, runs};
use rayon::prelude::*;

/// Distance of each mask pixel's centre to the nearest other pixel's centre; 0 off the mask.
///
/// The outside of the image counts as mask, so a line that leaves the image keeps its width. Where there is nothing
/// but mask, all distances are the image's longer side.
pub(crate) fn distance(mask: &Mask) -> Raster<f32> {
    let (width, height) = mask.size();
    if !mask.data().contains(&false) {
        return Raster::filled(width, height, width.max(height) as f32);
    }
    let mut distance = columns(mask);
    distance.data_mut().par_chunks_mut(width.max(1)).enumerate().for_each_init(
        Envelope::default,
        |envelope, (y, row)| {
            for run in runs(mask.row(y)) {
                envelope.solve(&mut row[run.start.saturating_sub(1)..(run.end + 1).min(width)]);
            }
        },
    );
    distance
}

/// Distance to paper within each column; more than any other where a column has none.
fn columns(mask: &Mask) -> Raster<f32> {
    let (width, height) = mask.size();
    let mut distance = Raster::filled(width, height, 0.0f32);
    let far = (width + height) as f32;
    let mut last = vec![far; width];
    for y in 0..height {
        let row = &mut distance.data_mut()[y * width..(y + 1) * width];
        for ((d, above), &inked) in row.iter_mut().zip(&mut last).zip(mask.row(y)) {
            *above = if inked { *above + 1.0 } else { 0.0 };
            *d = *above;
        }
    }
    last.fill(far);
    for y in (0..height).rev() {
        let row = &mut distance.data_mut()[y * width..(y + 1) * width];
        for ((d, below), &inked) in row.iter_mut().zip(&mut last).zip(mask.row(y)) {
            *below = if inked { (*below + 1.0).min(*d) } else { 0.0 };
            *d = *below;
        }
    }
    distance
}

/// The lower envelope of parabolas; to be reused from run to run.
#[derive(Default)]
struct Envelope {
    /// Height of each place's parabola.
    heights: Vec<i64>,
    /// The parabolas of the envelope, and the places from which each is the lowest.
    lowest: Vec<(usize, i64)>,
}

impl Envelope {
    /// From column distances to distances.
    fn solve(&mut self, row: &mut [f32]) {
        let Self { heights, lowest } = self;
        heights.clear();
        heights.extend(row.iter().map(|&d| (d as i64).pow(2)));
        let at = |place: usize, x: i64| (x - place as i64).pow(2) + heights[place];
        lowest.clear();
        for next in 0..heights.len() {
            // The first place at which `next` is lower than a parabola that stands before it.
            let crossing = |place: usize| {
                let (a, b) = (place as i64, next as i64);
                (b * b - a * a + heights[next] - heights[place]).div_euclid(2 * (b - a)) + 1
            };
            while lowest.last().is_some_and(|&(place, from)| at(place, from) > at(next, from)) {
                lowest.pop();
            }
            match lowest.last() {
                None => lowest.push((next, 0)),
                Some(&(place, _)) => {
                    let from = crossing(place);
                    if from < heights.len() as i64 {
                        lowest.push((next, from));
                    }
                }
            }
        }
        let mut x = row.len();
        for &(place, from) in lowest.iter().rev() {
            let from = from as usize;
            for (i, d) in row[from..x].iter_mut().enumerate() {
                *d = (at(place, (from + i) as i64) as f64).sqrt() as f32;
            }
            x = from;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn by_search(mask: &Mask, x: usize, y: usize) -> f32 {
        let pixels = (0..mask.height()).flat_map(|v| (0..mask.width()).map(move |u| (u, v)));
        let paper = pixels.filter(|&p| !mask[p]);
        let squared = paper.map(|(u, v)| u.abs_diff(x).pow(2) + v.abs_diff(y).pow(2)).min();
        squared.map_or(mask.width().max(mask.height()) as f32, |d| (d as f64).sqrt() as f32)
    }

    proptest! {
        #[test]
        fn every_distance_is_that_to_the_nearest_paper(
            width in 1usize..24,
            height in 1usize..24,
            ink in 0.0..1.0f64,
            numbers in prop::collection::vec(0.0..1.0f64, 24 * 24),
        ) {
            // Ever more ink, up to a page without paper.
            let mask = Raster::from_fn(width, height, |x, y| numbers[y * 24 + x] >= ink.powi(4));
            let found = distance(&mask);
            for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
                prop_assert_eq!(found[(x, y)], by_search(&mask, x, y), "({}, {})", x, y);
            }
        }
    }
}
