//! Whether strokes stay whole.

use super::cloud::Cloud;
use std::collections::{BTreeMap, BTreeSet};

/// Cosine of the largest angle between two strokes that run together: 35 degrees.
const ALIKE: f64 = 0.819_152_044_288_991_8;

/// The share of the length of `strokes` that the best single path of `paths` follows: for each stroke, the path that is
/// near most of it and runs in its direction. Near is within half a pen, or 1.5 px where that is more.
pub(super) fn follow(strokes: &Cloud, paths: &Cloud, pen: f64) -> f64 {
    let reach = (0.5 * pen).max(1.5);
    let mut lengths: BTreeMap<usize, (f64, BTreeMap<usize, f64>)> = BTreeMap::new();
    for sample in &strokes.samples {
        let near = paths.within(sample.position, reach);
        let along: BTreeSet<usize> =
            near.filter(|p| p.tangent.dot(sample.tangent).abs() >= ALIKE).map(|p| p.stroke).collect();
        let (length, followed) = lengths.entry(sample.stroke).or_default();
        *length += sample.weight;
        for path in along {
            *followed.entry(path).or_default() += sample.weight;
        }
    }
    let best = |followed: &BTreeMap<usize, f64>| followed.values().copied().fold(0.0, f64::max);
    let total: f64 = lengths.values().map(|(length, _)| length).sum();
    if total > 0.0 { lengths.values().map(|(_, followed)| best(followed)).sum::<f64>() / total } else { 0.0 }
}
