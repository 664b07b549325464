//! Solid regions as strokes, for machines that hold a pen.

use super::median_width;
use crate::drawing::{Centreline, Drawing, Fill, Segment, Stroke};
use crate::options::Solids;
use kurbo::{Affine, BezPath, CubicBez, Line, ParamCurve, PathEl, PathSeg, Point};
use std::f64::consts::FRAC_PI_4;

/// How far the corners of a hatched region may leave its outline, in pixels.
const FLAT: f64 = 0.1;

/// Does with the solid regions of a drawing as asked. Their pens are as wide as most strokes are, or a pixel.
pub(super) fn treat(drawing: &mut Drawing, solids: Solids) {
    if solids == Solids::Fill {
        return;
    }
    let fills = std::mem::take(&mut drawing.fills);
    let width = median_width(drawing.strokes.iter().map(|s| s.width)).unwrap_or(1.0);
    for fill in &fills {
        if matches!(solids, Solids::Outline | Solids::Hatch) {
            drawing.strokes.extend(rims(fill, width));
        }
        if solids == Solids::Hatch {
            drawing.strokes.extend(hatching(fill, width));
        }
    }
}

/// The outlines of a region as closed strokes.
fn rims(fill: &Fill, width: f64) -> Vec<Stroke> {
    let mut rims: Vec<Vec<Segment>> = Vec::new();
    for segment in fill.outline.segments() {
        let piece = match segment {
            PathSeg::Line(l) => Segment::Line(l),
            PathSeg::Quad(q) => Segment::Cubic(q.raise()),
            PathSeg::Cubic(c) => Segment::Cubic(CubicBez::new(c.p0, c.p1, c.p2, c.p3)),
        };
        match rims.last_mut() {
            Some(rim) if rim.last().is_some_and(|last| last.end() == piece.start()) => rim.push(piece),
            _ => rims.push(vec![piece]),
        }
    }
    let stroke = |segments| Stroke::new(Centreline::Path { segments, closed: true }, width);
    rims.into_iter().map(|rim| Stroke { color: fill.color, ..stroke(rim) }).collect()
}

/// Strokes at 45 degrees that cover a region, their ends within its rim.
fn hatching(fill: &Fill, width: f64) -> Vec<Stroke> {
    let turn = Affine::rotate(-FRAC_PI_4);
    let mut flat = BezPath::new();
    kurbo::flatten(turn * fill.outline.clone(), FLAT, |el| flat.push(el));
    let stroke = |[start, end]: [Point; 2]| {
        let line = Segment::Line(turn.inverse() * Line::new(start, end));
        Stroke { color: fill.color, ..Stroke::new(Centreline::Path { segments: vec![line], closed: false }, width) }
    };
    rows(&flat, width).into_iter().map(stroke).collect()
}

/// The pieces of level lines a pen's width apart that lie inside a path of lines, shortened by half that at both ends.
fn rows(path: &BezPath, width: f64) -> Vec<[Point; 2]> {
    let ys = path.elements().iter().filter_map(PathEl::end_point).map(|p| p.y);
    let top = ys.clone().fold(f64::INFINITY, f64::min) + 0.5 * width;
    let bottom = ys.fold(f64::NEG_INFINITY, f64::max);
    let count = ((bottom - top) / width).ceil().max(0.0) as usize;
    let mut crossings = vec![Vec::new(); count];
    for edge in path.segments() {
        let (a, b) = (edge.start(), edge.end());
        let (low, high) = (a.y.min(b.y), a.y.max(b.y));
        let first = ((low - top) / width).ceil().max(0.0) as usize;
        for (k, row) in crossings.iter_mut().enumerate().skip(first) {
            let y = top + k as f64 * width;
            if y >= high {
                break;
            }
            row.push(a.x + (b.x - a.x) * (y - a.y) / (b.y - a.y));
        }
    }
    let mut pieces = Vec::new();
    for (k, mut row) in crossings.into_iter().enumerate() {
        row.sort_by(f64::total_cmp);
        let y = top + k as f64 * width;
        let inside = row.chunks_exact(2).filter(|ends| ends[1] - ends[0] > width);
        pieces.extend(inside.map(|ends| [Point::new(ends[0] + 0.5 * width, y), Point::new(ends[1] - 0.5 * width, y)]));
    }
    pieces
}
