//! Strokes and solid regions as entities.

use super::frame::ENTITIES;
use super::pairs::Pairs;
use super::{Page, line_type_name};
use crate::drawing::{Centreline, Fill, Segment, Stroke};
use crate::write::curves::rings;
use crate::write::layers::Layer;
use kurbo::{Affine, Arc, BezPath, CubicBez, Point};

/// The line weights that the format knows, in hundredths of a millimetre.
const WEIGHTS: [i64; 24] =
    [0, 5, 9, 13, 15, 18, 20, 25, 30, 35, 40, 50, 53, 60, 70, 80, 90, 100, 106, 120, 140, 158, 200, 211];

/// Entities in the order in which they are drawn.
pub(super) struct Entities<'a> {
    pairs: Pairs,
    page: &'a Page,
    map: Affine,
    owner: u64,
    next_handle: u64,
}

impl<'a> Entities<'a> {
    pub fn new(page: &'a Page, owner: u64) -> Self {
        Self { pairs: Pairs::new(), page, map: page.map(), owner, next_handle: ENTITIES }
    }

    pub fn next_handle(&self) -> u64 {
        self.next_handle
    }

    pub fn into_pairs(self) -> Pairs {
        self.pairs
    }

    /// The head of an entity, up to its own class.
    fn begin(&mut self, kind: &str, class: &str, layer: &Layer, pen: Option<(&Stroke, Option<usize>)>) {
        self.pairs.text(0, kind);
        self.pairs.handle(5, self.next_handle);
        self.next_handle += 1;
        self.pairs.handle(330, self.owner);
        self.pairs.text(100, "AcDbEntity");
        self.pairs.text(8, &layer.name());
        if let Some((stroke, line_type)) = pen {
            line_type.iter().for_each(|&number| self.pairs.text(6, &line_type_name(number)));
            if self.page.metric {
                self.pairs.int(370, weight(stroke.width * self.page.scale));
            }
        }
        self.pairs.text(100, class);
    }

    /// A stroke; `line_type` is the number of its pattern.
    pub fn stroke(&mut self, layer: &Layer, stroke: &Stroke, line_type: Option<usize>) {
        let pen = Some((stroke, line_type));
        match &stroke.centreline {
            Centreline::Dot(p) => {
                self.begin("POINT", "AcDbPoint", layer, pen);
                self.pairs.point(10, self.map * *p);
            }
            Centreline::Circle(c) => {
                self.begin("CIRCLE", "AcDbCircle", layer, pen);
                self.pairs.point(10, self.map * c.center);
                self.pairs.real(40, c.radius.abs() * self.page.scale);
            }
            Centreline::Path { segments, closed } => match &segments[..] {
                [Segment::Line(l)] if l.p0 == l.p1 => {
                    self.begin("POINT", "AcDbPoint", layer, pen);
                    self.pairs.point(10, self.map * l.p0);
                }
                [Segment::Line(l)] => {
                    self.begin("LINE", "AcDbLine", layer, pen);
                    self.pairs.point(10, self.map * l.p0);
                    self.pairs.point(11, self.map * l.p1);
                }
                [Segment::Arc(a)] if !closed => self.arc(layer, a, pen),
                _ if segments.iter().any(|s| matches!(s, Segment::Cubic(_))) => {
                    let path = self.map * stroke.centreline.to_path();
                    self.spline(layer, &path, *closed, pen);
                }
                _ => self.light_polyline(layer, segments, *closed, pen),
            },
        }
    }

    /// An arc. The format's go against the clock with y up, as those here go with it with y down.
    fn arc(&mut self, layer: &Layer, a: &Arc, pen: Option<(&Stroke, Option<usize>)>) {
        let (first, last) = (-a.start_angle, -(a.start_angle + a.sweep_angle));
        let (start, end) = if a.sweep_angle < 0.0 { (first, last) } else { (last, first) };
        self.begin("ARC", "AcDbCircle", layer, pen);
        self.pairs.point(10, self.map * a.center);
        self.pairs.real(40, a.radii.x.abs() * self.page.scale);
        self.pairs.text(100, "AcDbArc");
        self.pairs.real(50, start.to_degrees().rem_euclid(360.0));
        self.pairs.real(51, end.to_degrees().rem_euclid(360.0));
    }

    fn light_polyline(
        &mut self,
        layer: &Layer,
        segments: &[Segment],
        closed: bool,
        pen: Option<(&Stroke, Option<usize>)>,
    ) {
        let bulge = |s: &Segment| match s {
            Segment::Arc(a) => -(0.25 * a.sweep_angle).tan(),
            _ => 0.0,
        };
        let mut corners: Vec<(Point, f64)> =
            segments.iter().flat_map(halves).map(|s| (self.map * s.start(), bulge(&s))).collect();
        if !closed {
            corners.extend(segments.last().map(|last| (self.map * last.end(), 0.0)));
        }
        self.begin("LWPOLYLINE", "AcDbPolyline", layer, pen);
        self.pairs.int(90, corners.len() as i64);
        // 128 lets the pattern of dashes run on over corners.
        self.pairs.int(70, i64::from(closed) + 128);
        for (p, bulge) in corners {
            self.pairs.flat_point(10, p);
            self.pairs.real(42, bulge);
        }
    }

    /// A spline of degree 3 whose every knot is threefold: the Bezier curves themselves.
    fn spline(&mut self, layer: &Layer, path: &BezPath, closed: bool, pen: Option<(&Stroke, Option<usize>)>) {
        let cubics: Vec<CubicBez> = path.segments().map(|s| s.to_cubic()).collect();
        let points: Vec<Point> =
            cubics.iter().flat_map(|c| [c.p0, c.p1, c.p2]).chain(cubics.last().map(|c| c.p3)).collect();
        self.begin("SPLINE", "AcDbSpline", layer, pen);
        self.pairs.upwards();
        self.pairs.int(70, 8 + i64::from(closed));
        self.pairs.int(71, 3);
        let ends = cubics.len();
        let knots = std::iter::once(0).chain((0..=ends).flat_map(|k| [k; 3])).chain([ends]);
        self.pairs.int(72, points.len() as i64 + 4);
        self.pairs.int(73, points.len() as i64);
        self.pairs.int(74, 0);
        knots.for_each(|knot| self.pairs.real(40, knot as f64));
        points.iter().for_each(|&p| self.pairs.point(10, p));
    }

    /// A solid region, its outline made of lines.
    pub fn hatch(&mut self, layer: &Layer, fill: &Fill, tolerance: f64) {
        let outline = self.map * fill.outline.clone();
        let rings = rings(&outline, tolerance * self.page.scale);
        self.begin("HATCH", "AcDbHatch", layer, None);
        self.pairs.point(10, Point::ZERO);
        self.pairs.upwards();
        self.pairs.text(2, "SOLID");
        self.pairs.int(70, 1);
        self.pairs.int(71, 0);
        self.pairs.int(91, rings.len() as i64);
        for ring in &rings {
            self.pairs.int(92, 2);
            self.pairs.int(72, 0);
            self.pairs.int(73, 1);
            self.pairs.int(93, ring.len() as i64);
            ring.iter().for_each(|&p| self.pairs.flat_point(10, p));
            self.pairs.int(97, 0);
        }
        self.pairs.int(75, 0);
        self.pairs.int(76, 1);
        self.pairs.int(98, 1);
        self.pairs.flat_point(10, rings.first().map_or(Point::ZERO, |ring| ring[0]));
    }
}

/// A piece, or the halves of an arc that a bulge cannot say because it is all but a circle.
fn halves(segment: &Segment) -> Vec<Segment> {
    match segment {
        Segment::Arc(a) if a.sweep_angle.abs() > 1.5 * std::f64::consts::PI => {
            let sweep_angle = 0.5 * a.sweep_angle;
            let second = Arc { start_angle: a.start_angle + sweep_angle, sweep_angle, ..*a };
            vec![Segment::Arc(Arc { sweep_angle, ..*a }), Segment::Arc(second)]
        }
        _ => vec![*segment],
    }
}

/// The line weight nearest to a width in millimetres.
fn weight(width: f64) -> i64 {
    let hundredths = (100.0 * width).round() as i64;
    WEIGHTS.into_iter().min_by_key(|w| (w - hundredths).abs()).unwrap_or(0)
}
