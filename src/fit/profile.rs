//! Widths along a stroke.

use super::median_width;
use crate::clean::unblurred_width;
use crate::drawing::Centreline;
use crate::graph::TrailPoint;
use kurbo::Shape;

/// A stroke tapers where the medians of so many parts of it differ by more than this share of its own.
const PARTS: usize = 5;
const TAPER: f64 = 0.3;

/// Widths along a stroke, as measured; between places where one could be measured they change evenly.
pub(super) struct Profile {
    /// Distance from the start as a share of the length, growing.
    at: Vec<f64>,
    widths: Vec<f64>,
}

impl Profile {
    /// The widths of a trail; `blur` is taken off them. `spare` stands in where none is measured.
    pub fn new(walk: &[TrailPoint], blur: f64, spare: f64) -> Self {
        let mut arc = vec![0.0; walk.len()];
        for k in 1..walk.len() {
            arc[k] = arc[k - 1] + (walk[k].point - walk[k - 1].point).hypot();
        }
        let total = arc.last().copied().unwrap_or(0.0).max(1e-9);
        let measured = walk.iter().zip(&arc).filter(|(p, _)| p.width.is_finite());
        let (at, widths): (Vec<f64>, Vec<f64>) =
            measured.map(|(p, s)| (s / total, unblurred_width(p.width, blur))).unzip();
        if at.is_empty() { Self { at: vec![0.0], widths: vec![spare] } } else { Self { at, widths } }
    }

    /// The width at a share of the length.
    pub fn width(&self, share: f64) -> f64 {
        let after = self.at.partition_point(|&s| s < share);
        let (a, b) = (after.saturating_sub(1), after.min(self.at.len() - 1));
        let span = self.at[b] - self.at[a];
        let t = if span > 0.0 { ((share - self.at[a]) / span).clamp(0.0, 1.0) } else { 0.0 };
        self.widths[a] + t * (self.widths[b] - self.widths[a])
    }

    /// The one width of the stroke: the median, or where the stroke tapers that which has its ink, its area over its length.
    pub fn mean(&self) -> f64 {
        let last = self.at.len() - 1;
        let ends = self.at[0] * self.widths[0] + (1.0 - self.at[last]) * self.widths[last];
        let pieces = self.at.windows(2).zip(self.widths.windows(2));
        let mean = ends + pieces.map(|(s, w)| 0.5 * (s[1] - s[0]) * (w[0] + w[1])).sum::<f64>();
        let median_of = |widths: &[f64]| median_width(widths.iter().copied()).unwrap_or(mean);
        let median = median_of(&self.widths);
        let parts = self.widths.chunks(self.widths.len().div_ceil(PARTS)).map(median_of);
        let (least, most) = parts.fold((median, median), |(least, most), w| (least.min(w), most.max(w)));
        if most - least > TAPER * median { mean } else { median }
    }

    /// Widths at even distances of about half a line width along a centreline, both ends included.
    pub fn samples(&self, centreline: &Centreline, line_width: f64) -> Vec<f64> {
        let length = centreline.to_path().perimeter(1e-2);
        let pieces = (2.0 * length / line_width.max(1.0)).ceil().clamp(1.0, 1e6);
        (0..=pieces as usize).map(|k| self.width(k as f64 / pieces)).collect()
    }
}
