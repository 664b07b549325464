//! Overlap of the ink.

use super::chain::Chain;
use crate::drawing::{Centreline, Drawing, Segment, Stroke};
use crate::raster::{Mask, Raster};
use crate::render::render;
use kurbo::Line;

/// The pixels at least half of which are inked by strokes with round caps and joins.
pub(super) fn ink(chains: &[Chain], (width, height): (usize, usize)) -> Mask {
    let strokes = chains.iter().map(|c| Stroke::new(centreline(c), c.width));
    let mut drawing = Drawing::new(width as f64, height as f64);
    drawing.strokes = strokes.collect();
    render(&drawing).map(|coverage| coverage >= 0.5)
}

/// The dark pixels of a rendering, on a raster of a size.
pub(super) fn dark(gray: &Raster<f32>, (width, height): (usize, usize)) -> Mask {
    let at = |i: usize, from: usize, to: usize| (2 * i + 1) * from / (2 * to);
    Mask::from_fn(width, height, |x, y| gray[(at(x, gray.width(), width), at(y, gray.height(), height))] < 0.5)
}

/// Inked pixels of both over inked pixels of either; 1 where there are none.
pub(super) fn iou(a: &Mask, b: &Mask) -> f64 {
    let count = |both: fn(bool, bool) -> bool| a.data().iter().zip(b.data()).filter(|(a, b)| both(**a, **b)).count();
    let (shared, either) = (count(|a, b| a && b), count(|a, b| a || b));
    if either > 0 { shared as f64 / either as f64 } else { 1.0 }
}

fn centreline(chain: &Chain) -> Centreline {
    if let [point] = chain.points[..] {
        return Centreline::Dot(point);
    }
    let segments = chain.points.windows(2).map(|p| Segment::Line(Line::new(p[0], p[1]))).collect();
    Centreline::Path { segments, closed: chain.closed }
}
