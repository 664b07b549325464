//! Arcs that no drawing has: the parser of paths makes ever more pieces of an arc, the larger it is.

use kurbo::{Arc, Point, SvgArc, Vec2};
use svgtypes::{PathParser, PathSegment};
use usvg::roxmltree::Document;

/// The largest radius, in units of the path.
const LARGEST: f64 = 1e12;

/// The first arc of a document's paths that is too large to be taken apart, by its larger radius.
pub(super) fn too_large(document: &Document) -> Option<f64> {
    let paths = document.descendants().filter_map(|node| node.attribute("d"));
    paths.flat_map(radii).find(|radius| *radius > LARGEST)
}

/// The larger radius of each arc of a path, enlarged where the arc would not reach its end.
fn radii(path: &str) -> impl Iterator<Item = f64> {
    let (mut here, mut start) = (Point::ZERO, Point::ZERO);
    PathParser::from(path).map_while(Result::ok).filter_map(move |segment| {
        let from = here;
        here = end(&segment, here, start);
        match segment {
            PathSegment::MoveTo { .. } => start = here,
            PathSegment::EllipticalArc { rx, ry, x_axis_rotation, large_arc, sweep, .. } => {
                let (radii, x_rotation) = (Vec2::new(rx, ry), x_axis_rotation.to_radians());
                let arc = Arc::from_svg_arc(&SvgArc { from, to: here, radii, x_rotation, large_arc, sweep });
                return arc.map(|arc| arc.radii.x.max(arc.radii.y));
            }
            _ => {}
        }
        None
    })
}

/// Where a segment ends that begins at `here`, in a subpath that began at `start`.
fn end(segment: &PathSegment, here: Point, start: Point) -> Point {
    let origin = if segment.is_abs() { Vec2::ZERO } else { here.to_vec2() };
    match *segment {
        PathSegment::MoveTo { x, y, .. }
        | PathSegment::LineTo { x, y, .. }
        | PathSegment::CurveTo { x, y, .. }
        | PathSegment::SmoothCurveTo { x, y, .. }
        | PathSegment::Quadratic { x, y, .. }
        | PathSegment::SmoothQuadratic { x, y, .. }
        | PathSegment::EllipticalArc { x, y, .. } => Point::new(x, y) + origin,
        PathSegment::HorizontalLineTo { x, .. } => Point::new(x + origin.x, here.y),
        PathSegment::VerticalLineTo { y, .. } => Point::new(here.x, y + origin.y),
        PathSegment::ClosePath { .. } => start,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn radii_are_those_that_reach_the_end() {
        let found = |path: &str| radii(path).collect::<Vec<_>>();
        assert_eq!(found("M1 2a5 4 0 0 1 3 0M0 0A1 2 0 0 1 8 0"), [5.0, 8.0]);
        assert_eq!(found("m9 9h1v-5l2 3c1 1 2 2 3 3s1 1 2 2q1 1 2 2t1 1H8V4za1 1 0 1 0 6 8"), [5.0]);
        assert_eq!(found("M0 0A0 3 0 0 1 8 0L3 3"), [0.0; 0]);
    }

    #[test]
    fn only_what_no_drawing_has_is_too_large() {
        for (far, large) in [("100", false), ("1e9", false), ("1e13", true), ("1e60", true), ("1e308", true)] {
            for arc in [
                format!("A{far} {far} 0 0 1 5 5"),
                format!("L{far} 0A1 1 0 0 1 5 5"),
                format!("l0 {far}a1 2 0 0 1 2-{far}"),
            ] {
                let text = format!("<svg xmlns='http://www.w3.org/2000/svg'><g><path d='M0 0{arc}'/></g></svg>");
                assert_eq!(too_large(&Document::parse(&text).unwrap()).is_some(), large, "{arc}");
            }
        }
    }
}
