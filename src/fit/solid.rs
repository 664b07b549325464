//! Outlines of solid regions.

use super::Tolerance;
use super::chain::join;
use super::samples::Samples;
use super::segmentation::segment;
use crate::drawing::Fill;
use kurbo::BezPath;

/// A traced outline as smooth curves and sharp corners.
pub(super) fn smooth(fill: &Fill, tolerance: Tolerance) -> Fill {
    let mut outline = BezPath::new();
    for ring in fill.rings() {
        let mut points = ring.clone();
        points.push(ring[0]);
        let weights = vec![1.0; points.len()];
        let samples = Samples::new(points, weights);
        if samples.len() < 6 {
            continue;
        }
        let pieces = segment(&samples, tolerance);
        let segments = join(&samples, &pieces, true, [None, None], tolerance);
        outline.move_to(segments[0].start());
        segments.iter().for_each(|s| s.append_to(&mut outline));
        outline.close_path();
    }
    Fill { outline, color: fill.color }
}
