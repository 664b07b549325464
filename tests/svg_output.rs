//! The SVG text, read back by another library, is the drawing.

use fieldtrace::drawing::{Centreline, Color, Dashes, Drawing, Fill, Segment, Stroke};
use fieldtrace::write::{WriteOptions, to_svg};
use kurbo::{Arc, Circle, CubicBez, Line, PathEl, Point, Rect, Shape, Vec2};
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};
use usvg::tiny_skia_path::PathSegment;

fn stroke(centreline: Centreline, width: f64) -> Stroke {
    Stroke::new(centreline, width)
}

fn chain(segments: Vec<Segment>, closed: bool) -> Centreline {
    Centreline::Path { segments, closed }
}

fn svg(drawing: &Drawing) -> String {
    to_svg(drawing, &WriteOptions::default())
}

/// The stroked paths of an SVG: width and points along it.
fn read_back(text: &str) -> Vec<(f64, Vec<Point>)> {
    let tree = usvg::Tree::from_str(text, &usvg::Options::default()).expect("valid SVG");
    let mut found = Vec::new();
    collect(tree.root(), &mut found);
    found
}

fn collect(group: &usvg::Group, found: &mut Vec<(f64, Vec<Point>)>) {
    for node in group.children() {
        match node {
            usvg::Node::Group(group) => collect(group, found),
            usvg::Node::Path(path) => {
                if let Some(stroke) = path.stroke() {
                    assert_eq!(stroke.linecap(), usvg::LineCap::Round);
                    assert_eq!(stroke.linejoin(), usvg::LineJoin::Round);
                    assert!(path.fill().is_none());
                    found.push((f64::from(stroke.width().get()), points_along(path)));
                }
            }
            _ => panic!("only paths are written"),
        }
    }
}

fn points_along(path: &usvg::Path) -> Vec<Point> {
    let p = |q: usvg::tiny_skia_path::Point| Point::new(f64::from(q.x), f64::from(q.y));
    let elements = path.data().segments().map(|s| match s {
        PathSegment::MoveTo(a) => PathEl::MoveTo(p(a)),
        PathSegment::LineTo(a) => PathEl::LineTo(p(a)),
        PathSegment::QuadTo(a, b) => PathEl::QuadTo(p(a), p(b)),
        PathSegment::CubicTo(a, b, c) => PathEl::CurveTo(p(a), p(b), p(c)),
        PathSegment::Close => PathEl::ClosePath,
    });
    sampled(&elements.collect())
}

fn sampled(path: &kurbo::BezPath) -> Vec<Point> {
    let mut points = Vec::new();
    kurbo::flatten(path, 1e-3, |e| match e {
        PathEl::MoveTo(p) => points.push(p),
        PathEl::LineTo(p) => {
            let from = *points.last().unwrap();
            let steps = (p - from).hypot().ceil().max(1.0);
            points.extend((1..=steps as usize).map(|i| from.lerp(p, i as f64 / steps)));
        }
        _ => {
            let (from, to) = (*points.last().unwrap(), points[0]);
            points.extend((1..=200).map(|i| from.lerp(to, f64::from(i) / 200.0)));
        }
    });
    points
}

/// The largest distance from a point of one set to the chain through the other.
fn farthest(from: &[Point], to: &[Point]) -> f64 {
    let near = |p: &Point| {
        let to_piece = |w: &[Point]| {
            let d = w[1] - w[0];
            let t = if d.hypot2() > 0.0 { ((*p - w[0]).dot(d) / d.hypot2()).clamp(0.0, 1.0) } else { 0.0 };
            (*p - (w[0] + d * t)).hypot()
        };
        to.windows(2).map(to_piece).fold(f64::INFINITY, f64::min)
    };
    from.iter().map(near).fold(0.0, f64::max)
}

fn point() -> impl Strategy<Value = Point> {
    (-20.0..220.0f64, -20.0..220.0f64).prop_map(Point::from)
}

fn arc_segment() -> impl Strategy<Value = Centreline> {
    (point(), 0.3..150.0f64, -PI..PI, -2.0 * PI..2.0 * PI).prop_map(|(center, r, start, sweep)| {
        chain(vec![Segment::Arc(Arc::new(center, (r, r), start, sweep, 0.0))], false)
    })
}

/// Lines and cubics through random points, open or closed.
fn polycurve() -> impl Strategy<Value = Centreline> {
    (prop::collection::vec((point(), point(), point(), any::<bool>()), 2..6), any::<bool>()).prop_map(
        |(steps, closed)| {
            let count = if closed { steps.len() } else { steps.len() - 1 };
            let segment = |i: usize| {
                let (p, a, b, straight) = steps[i];
                let q = steps[(i + 1) % steps.len()].0;
                if straight { Segment::Line(Line::new(p, q)) } else { Segment::Cubic(CubicBez::new(p, a, b, q)) }
            };
            chain((0..count).map(segment).collect(), closed)
        },
    )
}

/// A line, an arc that continues it and a line again.
fn rounded() -> impl Strategy<Value = Centreline> {
    (point(), 0.5..40.0f64, -PI..PI, -2.0 * PI..2.0 * PI).prop_map(|(center, r, start, sweep)| {
        let arc = Arc::new(center, (r, r), start, sweep, 0.0);
        let at = |angle: f64| center + r * Vec2::from_angle(angle);
        let along = |angle: f64| Vec2::from_angle(angle + 0.5 * PI) * 20.0 * sweep.signum();
        let before = Line::new(at(start) - along(start), at(start));
        let after = Line::new(at(start + sweep), at(start + sweep) + along(start + sweep));
        chain(vec![Segment::Line(before), Segment::Arc(arc), Segment::Line(after)], false)
    })
}

fn centreline() -> impl Strategy<Value = Centreline> {
    prop_oneof![
        2 => polycurve(),
        2 => arc_segment(),
        2 => rounded(),
        1 => (point(), 0.5..100.0f64).prop_map(|(c, r)| Centreline::Circle(Circle::new(c, r))),
        1 => point().prop_map(Centreline::Dot),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn the_text_holds_the_geometry(lines in prop::collection::vec(centreline(), 1..8), precision in 1usize..5) {
        let mut drawing = Drawing::new(200.0, 200.0);
        // Widths tell the strokes apart, since the order changes.
        drawing.strokes = lines.into_iter().enumerate().map(|(i, c)| stroke(c, 0.5 * (i + 1) as f64)).collect();
        let text = to_svg(&drawing, &WriteOptions::default().with(|o| o.precision = precision));
        prop_assert_eq!(&text, &to_svg(&drawing, &WriteOptions::default().with(|o| o.precision = precision)));
        prop_assert!(!text.contains("NaN") && !text.contains("inf") && !text.contains("\"-0\""));
        let back = read_back(&text);
        prop_assert_eq!(back.len(), drawing.strokes.len());
        // Rounding moves an end by up to 0.71 of a step, and what hangs on both ends by up to three times
        // that; the rest is the reader, which turns arcs into cubics (3e-4 of a radius off).
        let tolerance = 2.2 * 0.1f64.powi(precision as i32) + 0.05;
        for stroke in &drawing.strokes {
            let (_, points) = back.iter().find(|(w, _)| (w - stroke.width).abs() < 1e-3).expect("the width");
            let truth = sampled(&stroke.centreline.to_path());
            let (out, home) = (farthest(&truth, points), farthest(points, &truth));
            prop_assert!(out < tolerance && home < tolerance, "{} {} in {}", out, home, text);
        }
    }
}

#[test]
fn plain_shapes_are_written_as_such() {
    let mut drawing = Drawing::new(100.0, 50.0);
    let line = Segment::Line(Line::new((1.0, 2.0), (90.0, 40.5)));
    drawing.strokes.push(stroke(chain(vec![line], false), 1.257));
    drawing.strokes.push(stroke(Centreline::Circle(Circle::new((50.0, 25.0), 10.126)), 2.0));
    drawing.strokes.push(stroke(Centreline::Dot(Point::new(70.0, 8.0)), 3.0));
    let text = svg(&drawing);
    for part in [
        r##"<line stroke="#000000" stroke-width="1.26" x1="1" x2="90" y1="2" y2="40.5"/>"##,
        r##"<circle cx="50" cy="25" r="10.13" stroke="#000000" stroke-width="2"/>"##,
        r##"<path d="M70 8h0.01" stroke="#000000" stroke-width="3"/>"##,
        r#"viewBox="0 0 100 50""#,
        r#"width="100""#,
    ] {
        assert!(text.contains(part), "{part} is not in\n{text}");
    }
}

#[test]
fn an_upright_rectangle_is_written_as_one() {
    let edges = |points: [(f64, f64); 4]| {
        let ends = points.iter().zip(points.iter().cycle().skip(1));
        ends.map(|(a, b)| Segment::Line(Line::new(*a, *b))).collect::<Vec<_>>()
    };
    let quarter = |centre: (f64, f64), angle: f64| Segment::Arc(Arc::new(centre, (4.0, 4.0), angle, FRAC_PI_2, 0.0));
    let round = vec![
        Segment::Line(Line::new((14.0, 10.0), (36.0, 10.0))),
        quarter((36.0, 14.0), -FRAC_PI_2),
        Segment::Line(Line::new((40.0, 14.0), (40.0, 26.0))),
        quarter((36.0, 26.0), 0.0),
        Segment::Line(Line::new((36.0, 30.0), (14.0, 30.0))),
        quarter((14.0, 26.0), FRAC_PI_2),
        Segment::Line(Line::new((10.0, 26.0), (10.0, 14.0))),
        quarter((14.0, 14.0), PI),
    ];
    let sharp = edges([(50.004, 5.0), (80.0, 5.0), (80.0, 25.5), (50.004, 25.5)]);
    let slanted = edges([(50.0, 30.0), (80.0, 30.1), (80.0, 45.0), (50.0, 45.0)]);
    let written = |segments: Vec<Segment>, closed: bool| {
        let mut drawing = Drawing::new(100.0, 50.0);
        drawing.strokes.push(stroke(chain(segments, closed), 2.0));
        svg(&drawing)
    };
    let text = written(round, true);
    assert!(
        text.contains(r##"<rect height="20" rx="4" stroke="#000000" stroke-width="2" width="30" x="10" y="10"/>"##),
        "{text}"
    );
    let text = written(sharp.clone(), true);
    assert!(
        text.contains(r##"<rect height="20.5" stroke="#000000" stroke-width="2" width="30" x="50" y="5"/>"##),
        "{text}"
    );
    for text in [written(sharp[..3].to_vec(), false), written(slanted, true)] {
        assert!(!text.contains("<rect"), "{text}");
    }
}

#[test]
fn the_pattern_of_a_closed_line_is_its_own_whatever_the_order() {
    let mut state = 7u64;
    let mut next = || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        100.0 * (state >> 11) as f64 / (1u64 << 53) as f64
    };
    for _ in 0..40 {
        let mut drawing = Drawing::new(100.0, 100.0);
        for k in 0..12 {
            let (p, q) = (Point::new(next(), next()), Point::new(next(), next()));
            let centreline = match k % 3 {
                0 => Centreline::Circle(Circle::new(p, 5.0)),
                _ => chain(vec![Segment::Line(Line::new(p, q))], false),
            };
            let dashes = (k % 3 == 0).then_some(Dashes { dash: 3.0, gap: 2.0, offset: 1.25 });
            drawing.strokes.push(Stroke { dashes, ..stroke(centreline, 1.0) });
        }
        assert_eq!(svg(&drawing).matches(r#"stroke-dashoffset="1.25""#).count(), 4);
    }
    // A rectangle does not say where its pattern starts.
    let corners = [(60.0, 5.0), (80.0, 5.0), (80.0, 25.0), (50.0, 25.0), (50.0, 5.0), (60.0, 5.0)].map(Point::from);
    let edges = corners.windows(2).map(|p| Segment::Line(Line::new(p[0], p[1]))).collect();
    let mut drawing = Drawing::new(100.0, 50.0);
    let dashes = Some(Dashes { dash: 3.0, gap: 2.0, offset: 0.0 });
    drawing.strokes.push(Stroke { dashes, ..stroke(chain(edges, true), 2.0) });
    assert!(!svg(&drawing).contains("<rect"), "{}", svg(&drawing));
}

#[test]
fn a_known_dpi_gives_millimetres() {
    let drawing = Drawing { dpi: Some(300.0), ..Drawing::new(2480.0, 3508.0) };
    let text = svg(&drawing);
    assert!(text.contains(r#"width="209.9733mm""#) && text.contains(r#"height="297.0107mm""#), "{text}");
    assert!(text.contains(r#"viewBox="0 0 2480 3508""#), "{text}");
}

#[test]
fn each_pen_is_a_layer_and_regions_come_first() {
    let mut drawing = Drawing::new(100.0, 100.0);
    let red = Color([200, 0, 16]);
    drawing.strokes.push(stroke(Centreline::Circle(Circle::new((50.0, 50.0), 10.0)), 1.0));
    drawing.strokes.push(Stroke { color: red, ..stroke(Centreline::Dot(Point::new(5.0, 5.0)), 1.0) });
    drawing.fills.push(Fill { outline: Rect::new(10.0, 10.0, 20.0, 20.5).to_path(0.1), color: red });
    let text = svg(&drawing);
    assert_eq!(text.matches("inkscape:groupmode=\"layer\"").count(), 2);
    assert!(text.contains("xmlns:inkscape=") && text.contains("inkscape:label=\"1 Pen #c80010\""), "{text}");
    let fill = text.find(r##"<path d="M10 10H20V20.5H10Z" fill="#c80010" fill-rule="evenodd" stroke="none"/>"##);
    let (fill, dot) = (fill.expect("the region"), text.find("h0.01").expect("the dot"));
    let (red, black) = (text.find("Pen #c80010").unwrap(), text.find("Pen #000000").unwrap());
    assert!(red < fill && fill < dot && dot < black, "{text}");
    assert_eq!(read_back(&text).len(), 2);
}

#[test]
fn an_empty_drawing_is_valid() {
    let title = Some("a <b> & \"c\"\u{1}\n".to_string());
    let text = to_svg(&Drawing::new(7.0, 9.0), &WriteOptions::default().with(|o| o.title = title));
    assert!(read_back(&text).is_empty());
    assert!(text.contains("a &lt;b&gt; &amp;") && text.contains(env!("CARGO_PKG_VERSION")), "{text}");
}

#[test]
fn values_that_are_not_finite_never_appear() {
    let mut drawing = Drawing::new(50.0, 50.0);
    let nan = f64::NAN;
    drawing.strokes.push(stroke(chain(vec![Segment::Line(Line::new((nan, 1.0), (2.0, 3.0)))], false), 1.0));
    drawing
        .strokes
        .push(stroke(chain(vec![Segment::Arc(Arc::new((1.0, 1.0), (2.0, 2.0), nan, 1.0, 0.0))], false), 1.0));
    drawing.strokes.push(stroke(Centreline::Dot(Point::new(f64::INFINITY, 0.0)), 1.0));
    drawing.strokes.push(stroke(Centreline::Dot(Point::new(4.0, 4.0)), nan));
    drawing.strokes.push(stroke(Centreline::Dot(Point::new(4.0, 8.0)), -1.0));
    drawing.strokes.push(stroke(chain(Vec::new(), false), 1.0));
    let text = svg(&drawing);
    assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
    assert_eq!(read_back(&text).len(), 2, "{text}");
}

#[test]
fn a_stroke_is_walked_from_the_end_that_is_nearer() {
    let mut drawing = Drawing::new(50.0, 50.0);
    drawing.strokes.push(stroke(chain(vec![Segment::Line(Line::new((40.0, 40.0), (2.0, 3.0)))], false), 1.0));
    assert!(svg(&drawing).contains(r#"x1="2" x2="40" y1="3" y2="40""#));
}

#[test]
fn title_is_the_first_child() {
    let options = WriteOptions::default().with(|o| o.title = Some("bird.png".into()));
    let text = to_svg(&Drawing::new(5.0, 5.0), &options);
    let second = text.lines().nth(1).unwrap_or_default();
    assert_eq!(second, "<title>bird.png</title>", "{text}");
}
