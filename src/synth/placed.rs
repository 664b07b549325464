//! Drawings by others, placed on a sheet.

use super::shapes::within;
use super::{Style, noise};
use crate::drawing::{Centreline, Drawing, Fill, Segment, Stroke};
use kurbo::{Affine, Circle, Point};
use rand::Rng;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Longer sides that drawings are brought to, in pixels.
const SIDES: (f64, f64) = (110.0, 600.0);

/// A sheet of `size x size` pixels that looks on some part of a drawing: turned, mirrored, at some size, with a pen of
/// its own, never wider than the drawing's at that size. `None` for a drawing without strokes.
pub fn placed(rng: &mut impl Rng, drawing: &Drawing, size: usize) -> Option<Drawing> {
    if drawing.strokes.is_empty() {
        return None;
    }
    let style = Style::draw(rng);
    let side = within(rng, SIDES.0.ln(), SIDES.1.ln()).exp();
    let scale = side / drawing.width.max(drawing.height).max(1.0);
    let turn = match rng.random_range(0..4) {
        0 => within(rng, 0.0, TAU),
        1 => within(rng, -0.2, 0.2),
        _ => 0.0,
    } + FRAC_PI_2 * f64::from(rng.random_range(0..4));
    let mirror = if rng.random_bool(0.5) { Affine::FLIP_X } else { Affine::IDENTITY };
    let map = Affine::rotate(turn) * Affine::scale(scale) * mirror;
    let seen = &drawing.strokes[rng.random_range(0..drawing.strokes.len())];
    let from = map * seen.centreline.start();
    let to = Point::new(within(rng, 0.1, 0.9) * size as f64, within(rng, 0.1, 0.9) * size as f64);
    let map = Affine::translate(to - from) * map;
    // One factor for all pens keeps the drawing's own mix of widths.
    let widest = drawing.strokes.iter().map(|s| s.width).fold(0.0, f64::max);
    let thinner = (style.width / (widest * scale)).min(1.0) * scale;
    let mut sheet = Drawing::new(size as f64, size as f64);
    sheet.fills = drawing.fills.iter().map(|f| Fill { outline: map * f.outline.clone(), color: f.color }).collect();
    let wobble = if style.mix > 0.0 { 0.5 * style.mix } else { 0.0 };
    sheet.strokes = drawing
        .strokes
        .iter()
        .map(|s| {
            let width = (s.width * thinner * (wobble * noise::gaussian(rng)).exp()).max(1.0);
            Stroke { color: s.color, ..Stroke::new(mapped(&s.centreline, map), width) }
        })
        .collect();
    Some(sheet)
}

/// A centreline under a similarity, its arcs as cubics.
pub(crate) fn mapped(centreline: &Centreline, map: Affine) -> Centreline {
    match centreline {
        Centreline::Path { segments, closed } => {
            Centreline::Path { segments: segments.iter().flat_map(|s| pieces(s, map)).collect(), closed: *closed }
        }
        Centreline::Circle(c) => {
            Centreline::Circle(Circle::new(map * c.center, c.radius * map.determinant().abs().sqrt()))
        }
        Centreline::Dot(p) => Centreline::Dot(map * *p),
    }
}

fn pieces(segment: &Segment, map: Affine) -> Vec<Segment> {
    match segment {
        Segment::Line(l) => vec![Segment::Line(map * *l)],
        Segment::Cubic(c) => vec![Segment::Cubic(map * *c)],
        Segment::Arc(a) => {
            let mut path = kurbo::BezPath::new();
            path.move_to(segment.start());
            path.extend(a.append_iter(1e-3));
            (map * path).segments().map(|s| Segment::Cubic(s.to_cubic())).collect()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kurbo::{Arc, Line};
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    #[test]
    fn a_placed_drawing_is_similar_and_in_sight() {
        let mut original = Drawing::new(100.0, 80.0);
        let line = Segment::Line(Line::new((10.0, 40.0), (60.0, 40.0)));
        let arc = Segment::Arc(Arc::new((60.0, 30.0), (10.0, 10.0), FRAC_PI_2, -FRAC_PI_2, 0.0));
        let centreline = Centreline::Path { segments: vec![line, arc], closed: false };
        original.strokes.push(Stroke::new(centreline, 4.0));
        for seed in 0..50 {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            let sheet = placed(&mut rng, &original, 144).unwrap();
            let Centreline::Path { segments, .. } = &sheet.strokes[0].centreline else { panic!("a path stays one") };
            let start = segments[0].start();
            assert!((0.0..144.0).contains(&start.x) && (0.0..144.0).contains(&start.y), "{start:?}");
            let long = start.distance(segments[0].end());
            let scale = long / 50.0;
            assert!((109.9..=600.1).contains(&(scale * 100.0)), "{scale}");
            let round = segments[segments.len() - 1].end().distance(segments[0].end());
            assert!((round - scale * 200f64.sqrt()).abs() < 0.01 * scale, "{round} {scale}");
            assert!(sheet.strokes[0].width >= 1.0 && sheet.strokes[0].width <= (4.0 * scale).max(1.0) * 1.8);
        }
        assert!(placed(&mut ChaCha8Rng::seed_from_u64(0), &Drawing::new(9.0, 9.0), 64).is_none());
    }
}
