//! Upright rectangles, their corners sharp or all rounded alike, are made exact.

use super::Tolerance;
use super::fillet::CHORDS;
use super::samples::Samples;
use crate::drawing::{Centreline, Segment, outside_rounded};
use kurbo::{Arc, Line, Point, Rect, RoundedRect, Vec2};
use std::f64::consts::{FRAC_PI_2, PI, SQRT_2};

const ROUNDS: usize = 12;

/// A centreline that is an upright rectangle to within the tolerance becomes one: it starts at the left of its upper edge
/// and runs to the right, as SVG's own does. Others are kept.
pub(super) fn regular(centreline: Centreline, tolerance: Tolerance) -> Centreline {
    match centreline.as_rounded_rect(0.5 * tolerance.fit) {
        Some(rect) => Centreline::Path { segments: segments(&rect), closed: true },
        None => centreline,
    }
}

/// The rectangle with round corners that explains all samples of a loop, if one does.
///
/// Least squares over the distances from its outline, side after side and then the radius, which hardly depend on one
/// another.
pub(super) fn round(samples: &Samples, tolerance: Tolerance) -> Option<Centreline> {
    let start = *samples.points.first()?;
    let bounds = samples.points.iter().fold(Rect::from_points(start, start), |bounds, p| bounds.union_pt(*p));
    let corner = |p: Point| samples.points.iter().map(|q| (*q - p).hypot2()).fold(f64::MAX, f64::min).sqrt();
    let cut_off = corner(bounds.origin()).midpoint(corner(Point::new(bounds.x1, bounds.y1)));
    let mut sides = [bounds.x0, bounds.y0, bounds.x1, bounds.y1, cut_off / (SQRT_2 - 1.0)];
    let limit = tolerance.deviation(samples).max(CHORDS);
    for _ in 0..ROUNDS {
        for side in 0..sides.len() {
            let (mut slope, mut curvature) = (0.0, 0.0);
            for (p, w) in samples.points.iter().zip(&samples.weights) {
                let (off, changes) = offset(sides, *p);
                slope += w * off * changes[side];
                curvature += w * changes[side] * changes[side];
            }
            sides[side] -= slope / curvature.max(1.0);
        }
        let [x0, y0, x1, y1, _] = sides;
        sides[4] = sides[4].clamp(0.0, 0.5 * (x1 - x0).min(y1 - y0).max(0.0));
    }
    let [x0, y0, x1, y1, radius] = sides;
    let all = 0..=samples.len() - 1;
    let fits = radius > tolerance.width && samples.keep_to(all, limit, |_, p| offset(sides, p).0);
    fits.then(|| {
        let rect = RoundedRect::new(x0, y0, x1, y1, radius);
        Centreline::Path { segments: segments(&rect), closed: true }
    })
}

/// How far a point lies outside the rectangle between `[x0, y0, x1, y1]` with corners of a radius, and how that changes
/// with each of the five.
fn offset([x0, y0, x1, y1, radius]: [f64; 5], p: Point) -> (f64, [f64; 5]) {
    let rect = Rect::new(x0, y0, x1, y1);
    let (distance, normal) = outside_rounded(rect, radius, p);
    // Outwards is against the axis at the left and at the top.
    let [left, right] = [(-normal.x).max(0.0), -normal.x.max(0.0)];
    let [top, bottom] = [(-normal.y).max(0.0), -normal.y.max(0.0)];
    (distance, [left, top, right, bottom, normal.x.abs() + normal.y.abs() - 1.0])
}

/// The edges and corners in turn, without those of no length.
fn segments(rounded: &RoundedRect) -> Vec<Segment> {
    let (rect, radius) = (rounded.rect(), rounded.radii().top_left);
    let inner = rect.inset(-radius);
    let corners = [(inner.x1, inner.y0), (inner.x1, inner.y1), (inner.x0, inner.y1), (inner.x0, inner.y0)];
    let mut out = Vec::new();
    let mut at = Point::new(inner.x0, rect.y0);
    for (centre, angle) in corners.into_iter().zip([-FRAC_PI_2, 0.0, FRAC_PI_2, PI]) {
        let arc = Arc::new(centre, (radius, radius), angle, FRAC_PI_2, 0.0);
        let edge = Line::new(at, Point::from(centre) + radius * Vec2::from_angle(angle));
        out.push(Segment::Line(edge));
        out.push(Segment::Arc(arc));
        at = Point::from(centre) + radius * Vec2::from_angle(angle + FRAC_PI_2);
    }
    out.retain(|s| (s.end() - s.start()).hypot() > 1e-9);
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    const TOLERANCE: Tolerance = Tolerance { fit: 0.3, width: 3.0, steadiness: 0.1, pixel: 1.0 };

    #[test]
    fn a_rectangle_with_uneven_corners_becomes_regular_from_any_start() {
        for radius in [0.0, 4.0, 12.0, 15.0] {
            let exact = RoundedRect::new(10.0, 20.0, 70.0, 50.0, radius);
            let mut uneven = segments(&exact);
            let n = uneven.len();
            for turn in 0..n {
                uneven.rotate_left(1);
                let mut drawn = uneven.clone();
                if let Segment::Line(l) = &mut drawn[n / 2] {
                    l.p0 += Vec2::new(0.04, 0.05);
                }
                for backwards in [false, true] {
                    let drawn = Centreline::Path { segments: drawn.clone(), closed: true };
                    let drawn = if backwards { drawn.reversed() } else { drawn };
                    let Centreline::Path { segments: found, .. } = regular(drawn, TOLERANCE) else {
                        panic!("a circle")
                    };
                    assert_eq!(found.len(), n, "{radius} {turn}");
                    let off = found.iter().zip(segments(&exact)).map(|(a, b)| (a.start() - b.start()).hypot());
                    assert!(off.fold(0.0, f64::max) < 0.07, "{radius} {turn}: {found:?}");
                }
            }
        }
    }

    #[test]
    fn points_of_a_rectangle_with_round_corners_give_it() {
        for radius in [5.0, 14.0, 29.0, 30.0] {
            for noise in [0.0, 0.1] {
                let exact = RoundedRect::new(10.3, 20.6, 98.3, 80.6, radius);
                let outline = segments(&exact);
                let along = |s: &Segment| (0..20).map(|k| s.eval(f64::from(k) / 20.0)).collect::<Vec<_>>();
                let points: Vec<Point> = outline.iter().flat_map(along).collect();
                let moved = |(k, p): (usize, &Point)| *p + Vec2::from_angle(1.9 * k as f64) * noise;
                let points: Vec<Point> = points.iter().enumerate().map(moved).collect();
                let n = points.len();
                let found = round(&Samples::new(points, vec![1.0; n]), TOLERANCE).unwrap();
                let found = found.as_rounded_rect(1e-6).unwrap();
                let off = (found.rect().origin() - exact.rect().origin()).hypot();
                assert!(off < 0.02 + noise && (found.radii().top_left - radius).abs() < 0.05 + noise, "{found:?}");
            }
        }
        let circle = (0..100).map(|k| Point::new(50.0, 40.0) + Vec2::from_angle(TAU * f64::from(k) / 100.0) * 20.0);
        let squeezed: Vec<Point> = circle.map(|p| Point::new(1.3 * p.x, p.y)).collect();
        assert_eq!(round(&Samples::new(squeezed, vec![1.0; 100]), TOLERANCE), None);
    }

    #[test]
    fn what_is_no_rectangle_is_kept() {
        let p = |x: f64, y: f64| Point::new(x, y);
        let chain = |points: &[Point]| {
            let ends = points.iter().zip(points.iter().cycle().skip(1));
            Centreline::Path { segments: ends.map(|(a, b)| Segment::Line(Line::new(*a, *b))).collect(), closed: true }
        };
        let step = chain(&[p(0.0, 0.0), p(40.0, 0.0), p(40.0, 10.0), p(38.0, 10.0), p(38.0, 30.0), p(0.0, 30.0)]);
        let slanted = chain(&[p(0.0, 0.0), p(40.0, 2.0), p(40.0, 30.0), p(0.0, 30.0)]);
        let twice = chain(&[p(0.0, 0.0), p(40.0, 0.0), p(40.0, 30.0), p(0.0, 30.0)].repeat(2));
        let mut one_sharp = segments(&RoundedRect::new(0.0, 0.0, 40.0, 30.0, 8.0));
        one_sharp[0] = Segment::Line(Line::new((8.0, 0.0), (40.0, 0.0)));
        one_sharp[1] = Segment::Line(Line::new((40.0, 0.0), (40.0, 8.0)));
        let open = Centreline::Path { segments: one_sharp[..5].to_vec(), closed: false };
        for kept in [step, slanted, twice, Centreline::Path { segments: one_sharp, closed: true }, open] {
            assert_eq!(regular(kept.clone(), TOLERANCE), kept);
        }
    }
}
