//! How far two sets of strokes are apart.

use super::cloud::Cloud;
use super::matching::harmonic_mean;

/// For each sample of both sides its weight and its distance to the other side.
pub(super) struct Distances {
    truth: Vec<(f64, f64)>,
    traced: Vec<(f64, f64)>,
}

impl Distances {
    /// Neither cloud may be empty.
    pub fn between(truth: &Cloud, traced: &Cloud) -> Self {
        Self { truth: one_way(truth, traced), traced: one_way(traced, truth) }
    }

    /// Harmonic mean of the shares of both lengths that are within `reach` of the other side.
    pub fn f1(&self, reach: f64) -> f64 {
        let share = |side: &[(f64, f64)]| mean(side, |d| if d <= reach { 1.0 } else { 0.0 });
        harmonic_mean(share(&self.traced), share(&self.truth))
    }

    /// Mean distance, the mean of both ways.
    pub fn chamfer(&self) -> f64 {
        0.5 * (mean(&self.truth, |d| d) + mean(&self.traced, |d| d))
    }
}

fn one_way(from: &Cloud, to: &Cloud) -> Vec<(f64, f64)> {
    let distance =
        |s: &super::cloud::Sample| to.nearest(s.position).map_or(f64::NAN, |n| s.position.distance(n.position));
    from.samples.iter().map(|s| (s.weight, distance(s))).collect()
}

/// The mean over the length; over the samples where there are only dots.
fn mean(side: &[(f64, f64)], f: impl Fn(f64) -> f64) -> f64 {
    let length: f64 = side.iter().map(|(weight, _)| weight).sum();
    if length > 0.0 {
        side.iter().map(|(weight, d)| weight * f(*d)).sum::<f64>() / length
    } else {
        side.iter().map(|(_, d)| f(*d)).sum::<f64>() / side.len() as f64
    }
}
