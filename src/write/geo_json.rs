//! A drawing as GeoJSON (RFC 7946; the member `crs` as in the format of 2008, which programs for maps read).

use super::curves::{polyline, rings};
use super::document::{Document, WriteOptions};
use super::layers::layers;
use super::{Format, Rounding};
use crate::drawing::{Color, Fill, Stroke};
use crate::error::Result;
use crate::place::Georeference;
use geojson::{Feature, FeatureCollection, GeometryValue, JsonObject, Position};
use kurbo::{BezPath, PathEl, Point, Shape};
use serde_json::{Value, json};

/// Decimals of degrees that are as fine as centimetres.
const FINE: usize = 7;

/// Strokes as LineStrings within the tolerance, dots as Points, solid regions as Polygons.
///
/// Coordinates are those of the world where the scan knows its place, else pixels with y up. Properties are `stroke`, the
/// number of the stroke from 0, `width` in units of the coordinates, and `color`.
pub(super) struct GeoJson;

impl Format for GeoJson {
    fn name(&self) -> &'static str {
        "geojson"
    }

    fn is_on_earth(&self) -> bool {
        true
    }

    fn encode(&self, document: &Document, options: &WriteOptions) -> Result<Vec<u8>> {
        let drawing = document.drawing;
        let place = options.georeference.clone().unwrap_or_else(|| Georeference::upright(drawing.height));
        let map = Map { rounding: Rounding::new(options.precision.max(FINE)), tolerance: options.tolerance, place };
        let layers = layers(drawing);
        let fills = layers.iter().flat_map(|layer| &layer.fills).flat_map(|fill| map.regions(fill));
        let strokes = layers.iter().flat_map(|layer| &layer.strokes).enumerate();
        let features = fills.chain(strokes.map(|(number, stroke)| map.stroke(number, stroke))).collect();
        let mut foreign = JsonObject::new();
        let origin = serde_json::from_str(&options.origin()).unwrap_or(Value::Null);
        foreign.insert("origin".into(), origin);
        // Without the member, readers take coordinates for degrees.
        let crs = map.place.epsg.map_or(
            Value::Null,
            |epsg| json!({ "type": "name", "properties": { "name": format!("urn:ogc:def:crs:EPSG::{epsg}") } }),
        );
        foreign.insert("crs".into(), crs);
        let collection = FeatureCollection { bbox: None, features, foreign_members: Some(foreign) };
        Ok(format!("{collection}\n").into_bytes())
    }
}

/// From pixels to the world.
struct Map {
    rounding: Rounding,
    tolerance: f64,
    place: Georeference,
}

impl Map {
    fn position(&self, p: Point) -> Position {
        let p = self.place.place(p);
        Position::from([self.rounding.round(p.x), self.rounding.round(p.y)])
    }

    /// A length in pixels in units of the world.
    fn length(&self, pixels: f64) -> f64 {
        self.rounding.round(pixels * self.place.to_world.determinant().abs().sqrt())
    }

    fn feature(&self, geometry: GeometryValue, color: Color, more: Vec<(&str, Value)>) -> Feature {
        let mut properties: JsonObject = more.into_iter().map(|(name, value)| (name.to_string(), value)).collect();
        properties.insert("color".into(), color.to_string().into());
        Feature {
            bbox: None,
            geometry: Some(geometry.into()),
            id: None,
            properties: Some(properties),
            foreign_members: None,
        }
    }

    fn stroke(&self, number: usize, stroke: &Stroke) -> Feature {
        let points = polyline(&stroke.centreline.to_path(), self.tolerance);
        let geometry = match &points[..] {
            [p] => GeometryValue::Point { coordinates: self.position(*p) },
            _ => GeometryValue::LineString { coordinates: points.iter().map(|&p| self.position(p)).collect() },
        };
        let about = vec![("stroke", number.into()), ("width", self.length(stroke.width).into())];
        self.feature(geometry, stroke.color, about)
    }

    /// The parts of a region, each with its holes.
    fn regions(&self, fill: &Fill) -> Vec<Feature> {
        let polygon = |rings: Vec<Vec<Point>>| {
            let coordinates = rings.iter().enumerate().map(|(k, ring)| self.ring(ring, k == 0)).collect();
            self.feature(GeometryValue::Polygon { coordinates }, fill.color, Vec::new())
        };
        polygons(rings(&fill.outline, self.tolerance)).into_iter().map(polygon).collect()
    }

    /// A closed ring, an outer one against the clock.
    fn ring(&self, ring: &[Point], outer: bool) -> Vec<Position> {
        let placed: Vec<Point> = ring.iter().map(|&p| self.place.place(p)).collect();
        let against_clock = signed_area(&placed) > 0.0;
        let mut ring: Vec<Position> = ring.iter().map(|&p| self.position(p)).collect();
        if against_clock != outer {
            ring.reverse();
        }
        ring.extend(ring.first().cloned());
        ring
    }
}

/// Twice the area within corners; positive where they go against the clock with y up.
fn signed_area(ring: &[Point]) -> f64 {
    let next = ring.iter().cycle().skip(1);
    ring.iter().zip(next).map(|(a, b)| a.x * b.y - b.x * a.y).sum()
}

/// Rings under the even-odd rule as polygons: each outer ring, then its holes.
fn polygons(rings: Vec<Vec<Point>>) -> Vec<Vec<Vec<Point>>> {
    let outlines: Vec<BezPath> = rings.iter().map(|ring| closed(ring)).collect();
    let around = |k: usize| -> Vec<usize> {
        let inside = |j: &usize| *j != k && outlines[*j].winding(rings[k][0]) != 0;
        (0..rings.len()).filter(inside).collect()
    };
    let around: Vec<Vec<usize>> = (0..rings.len()).map(around).collect();
    let is_outer = |k: &usize| around[*k].len().is_multiple_of(2);
    let hole_of = |outer: usize| {
        let around = &around;
        move |k: &usize| around[*k].len() == around[outer].len() + 1 && around[*k].contains(&outer)
    };
    let polygon = |outer: usize| {
        let holes = (0..rings.len()).filter(hole_of(outer)).map(|k| rings[k].clone());
        std::iter::once(rings[outer].clone()).chain(holes).collect()
    };
    (0..rings.len()).filter(is_outer).map(polygon).collect()
}

fn closed(ring: &[Point]) -> BezPath {
    let lines = ring.iter().skip(1).map(|&p| PathEl::LineTo(p));
    std::iter::once(PathEl::MoveTo(ring[0])).chain(lines).chain([PathEl::ClosePath]).collect()
}
