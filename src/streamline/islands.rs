//! Parts of the ink that are so far apart that no walk sees two of them; they can be traced side by side.

use super::seeds::Seed;
use crate::clean::{LineImage, runs};
use crate::raster::Raster;
use std::collections::BTreeMap;

/// Less ink than this carries no walk from one island to another.
const FAINT: f32 = 0.1;
/// Islands are this many times the greatest line width apart, and so many pixels.
const APART: f64 = 3.0;
const APART_PIXELS: f64 = 8.0;

/// An island of ink.
pub(super) struct Island {
    /// Left, top, right and bottom of its ink and the paper around it, in pixels.
    pub bounds: [usize; 4],
    /// Rectangles that hold its ink and no other island's: left, top, right and bottom in pixels.
    pub parts: Vec<[usize; 4]>,
    /// Its seeds, each with its rank among all seeds.
    pub seeds: Vec<(usize, Seed)>,
}

/// The islands that hold seeds.
pub(super) fn islands(image: &LineImage, seeds: &[Seed]) -> Vec<Island> {
    let deepest = image.depth.data().iter().copied().fold(0.0, f32::max);
    let side = (APART * 2.0 * f64::from(deepest) + APART_PIXELS).ceil() as usize;
    let (columns, rows) = (image.ink.width().div_ceil(side), image.ink.height().div_ceil(side));
    let inked = Raster::from_rows(columns, rows, false, |row, cells| {
        for y in row * side..((row + 1) * side).min(image.ink.height()) {
            let parts = image.ink.row(y).chunks(side);
            cells.iter_mut().zip(parts).for_each(|(cell, part)| *cell |= part.iter().any(|&ink| ink >= FAINT));
        }
    });
    // Cells that touch are one island, so that there is an empty cell between two.
    let mut island_of = Raster::filled(columns, rows, 0usize);
    let mut islands: BTreeMap<usize, Island> = BTreeMap::new();
    for run in runs(&inked) {
        let own = [run.from.saturating_sub(1), run.y.saturating_sub(1), run.to + 1, run.y + 2].map(|cell| cell * side);
        let island = islands.entry(run.region).or_insert(Island { bounds: own, parts: Vec::new(), seeds: Vec::new() });
        let b = &mut island.bounds;
        *b = [b[0].min(own[0]), b[1].min(own[1]), b[2].max(own[2]), b[3].max(own[3])];
        let (right, bottom) = ((run.to * side).min(image.ink.width()), ((run.y + 1) * side).min(image.ink.height()));
        island.parts.push([run.from * side, run.y * side, right, bottom]);
        (run.from..run.to).for_each(|x| island_of[(x, run.y)] = run.region);
    }
    for (rank, seed) in seeds.iter().enumerate() {
        let cell = (seed.point.x as usize / side, seed.point.y as usize / side);
        if let Some(island) = islands.get_mut(&island_of[cell]) {
            island.seeds.push((rank, *seed));
        }
    }
    islands.into_values().filter(|island| !island.seeds.is_empty()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clean::clean;
    use crate::load::Scan;
    use crate::options::Options;
    use kurbo::{Point, Vec2};

    #[test]
    fn ink_that_is_far_apart_is_two_islands() {
        let count = |gap: usize| {
            let inked = |x: usize| (20..100).contains(&x) || (100 + gap..330).contains(&x);
            let gray = Raster::from_fn(360, 60, |x, y| if inked(x) && (28..31).contains(&y) { 0.0 } else { 1.0f32 });
            let image = clean(&Scan { gray, rgb: None, dpi: None }, &Options::default());
            let seed = |x: f64| Seed { point: Point::new(x, 29.5), tangent: Vec2::new(1.0, 0.0) };
            islands(&image, &[seed(60.5), seed(300.5)]).len()
        };
        assert_eq!([2, 10, 80, 150].map(count), [1, 1, 2, 2]);
    }
}
