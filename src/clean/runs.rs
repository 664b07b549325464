//! Connected regions of a mask, as runs along its rows.

use crate::raster::{Mask, runs as row_runs};
use petgraph::unionfind::UnionFind;

/// Pixels `[from, to)` of row `y` that are set, and the region that they belong to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Run {
    pub y: usize,
    pub from: usize,
    pub to: usize,
    /// A number that the runs of one region share, less than the number of runs.
    pub region: usize,
}

/// All runs of a mask, row by row; pixels that touch by a side or a corner are one region.
pub(crate) fn runs(mask: &Mask) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    let mut touching: Vec<[usize; 2]> = Vec::new();
    let mut above = 0..0;
    for y in 0..mask.height() {
        let first = runs.len();
        runs.extend(row_runs(mask.row(y)).map(|run| Run { y, from: run.start, to: run.end, region: 0 }));
        let mut k = above.start;
        for i in first..runs.len() {
            while k < above.end && runs[k].to < runs[i].from {
                k += 1;
            }
            // The last run that touches this one may touch the next one too.
            touching.extend((k..above.end).take_while(|&j| runs[j].from <= runs[i].to).map(|j| [i, j]));
        }
        above = first..runs.len();
    }
    let mut regions = UnionFind::new(runs.len());
    for [a, b] in touching {
        regions.union(a, b);
    }
    for (run, region) in runs.iter_mut().zip(regions.into_labeling()) {
        run.region = region;
    }
    runs
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::Raster;
    use imageproc::region_labelling::{Connectivity, connected_components};
    use proptest::prelude::*;
    use std::collections::BTreeSet;

    proptest! {
        #[test]
        fn regions_are_the_connected_components(
            // The reference cannot take the smallest images.
            width in 4usize..20,
            height in 4usize..20,
            numbers in prop::collection::vec(0.0..1.0f64, 400),
            ink in 0.0..1.0f64,
        ) {
            let mask = Raster::from_fn(width, height, |x, y| numbers[y * 20 + x] < ink);
            let labels = connected_components(&mask.to_gray_image(), Connectivity::Eight, image::Luma([0u8]));
            let mut pairs = BTreeSet::new();
            let mut pixels = 0;
            for run in runs(&mask) {
                for x in run.from..run.to {
                    pairs.insert((run.region, labels.get_pixel(x as u32, run.y as u32)[0]));
                    pixels += 1;
                }
            }
            prop_assert_eq!(pixels, mask.count());
            // One to one: as many pairs as there are regions and labels.
            let (regions, labels): (BTreeSet<_>, BTreeSet<_>) = pairs.iter().copied().unzip();
            prop_assert!(!labels.contains(&0));
            prop_assert_eq!((regions.len(), labels.len()), (pairs.len(), pairs.len()));
        }
    }
}
