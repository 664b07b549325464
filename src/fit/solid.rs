//! Outlines of solid regions.

use super::Tolerance;
use super::joints::join;
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
        let mut curve = BezPath::new();
        curve.move_to(segments[0].start());
        segments.iter().for_each(|s| s.append_to(&mut curve));
        if !curve.is_finite() {
            // A ring that folds onto itself may have no curve through its corners: it stays as it is.
            curve.truncate(0);
            curve.move_to(ring[0]);
            ring[1..].iter().for_each(|p| curve.line_to(*p));
        }
        curve.close_path();
        outline.extend(curve);
    }
    Fill { outline, color: fill.color }
}
