//! Every format holds the drawing: what is written is read back and lies where it was.

mod common;

use common::draw::{arc, circle, cubic, dot, line, polyline, sheet};
use fieldtrace::drawing::{Centreline, Color, Dashes, Drawing, Fill, Stroke};
use fieldtrace::load::{LoadOptions, load_bytes};
use fieldtrace::render::render;
use fieldtrace::write::{
    Curves, Document, Shapes, Units, WriteOptions, encode, format_named, formats, is_untouched_output,
};
use kurbo::{Point, Rect, Shape};
use std::collections::BTreeMap;

/// One of everything: lines, arcs, curves, circles, dots, dashes, a region with a hole, two pens.
fn everything() -> Drawing {
    let red = Color([200, 0, 16]);
    let mut outline = Rect::new(20.0, 150.0, 80.0, 190.0).to_path(0.1);
    outline.extend(Rect::new(35.0, 160.0, 65.0, 180.0).to_path(0.1));
    let dashes = Some(Dashes { dash: 9.0, gap: 5.0, offset: 0.0 });
    let corners = [(20.0, 20.0), (60.0, 25.0), (50.0, 60.0)].map(Point::from);
    let strokes = vec![
        line((100.0, 20.0), (180.0, 45.0), 3.0),
        polyline(&corners, true, 2.0),
        Stroke { color: red, ..arc((150.0, 100.0), 30.0, 0.4, 2.5, 3.0) },
        Stroke { color: red, ..arc((150.0, 100.0), 22.0, 1.0, -4.5, 3.0) },
        cubic([(20.0, 90.0), (60.0, 60.0), (60.0, 140.0), (110.0, 110.0)], 4.0),
        circle((150.0, 170.0), 20.0, 2.0),
        dot((100.0, 180.0), 6.0),
        Stroke { dashes, ..line((20.0, 210.0), (220.0, 212.0), 2.0) },
    ];
    let mut drawing = sheet(240, 220, strokes);
    drawing.fills.push(Fill { outline, color: Color::BLACK });
    drawing.dpi = Some(127.0);
    drawing
}

fn bytes(drawing: &Drawing, format: &str, options: &WriteOptions) -> Vec<u8> {
    encode(format_named(format).unwrap(), &Document { drawing, graph: None }, options).unwrap()
}

fn text(drawing: &Drawing, format: &str, options: &WriteOptions) -> String {
    String::from_utf8(bytes(drawing, format, options)).unwrap()
}

/// The entities of a DXF: the kind and its pairs of code and value.
fn entities(dxf: &str) -> Vec<(String, Vec<(u16, String)>)> {
    let lines: Vec<&str> = dxf.lines().collect();
    let pairs: Vec<(u16, &str)> = lines.chunks(2).map(|pair| (pair[0].trim().parse().unwrap(), pair[1])).collect();
    let start = pairs.iter().position(|pair| *pair == (2, "ENTITIES")).unwrap() + 1;
    let mut entities: Vec<(String, Vec<(u16, String)>)> = Vec::new();
    for (code, value) in &pairs[start..] {
        match (code, *value) {
            (0, "ENDSEC") => break,
            (0, kind) => entities.push((kind.into(), Vec::new())),
            _ => entities.last_mut().unwrap().1.push((*code, value.to_string())),
        }
    }
    entities
}

fn real(pairs: &[(u16, String)], code: u16) -> f64 {
    pairs.iter().find(|pair| pair.0 == code).map(|pair| pair.1.parse().unwrap()).expect("the code is there")
}

#[test]
fn a_dxf_has_entities_of_each_kind_in_millimetres_with_y_up() {
    let dxf = text(&everything(), "dxf", &WriteOptions::default());
    let found = entities(&dxf);
    let mut counts = BTreeMap::new();
    found.iter().for_each(|(kind, _)| *counts.entry(kind.as_str()).or_insert(0) += 1);
    let expected = [("ARC", 2), ("CIRCLE", 1), ("HATCH", 1), ("LINE", 2), ("LWPOLYLINE", 2), ("POINT", 1)];
    assert_eq!(counts, expected.into());
    // 127 dots per inch are 5 in a millimetre.
    let (_, circle) = found.iter().find(|e| e.0 == "CIRCLE").unwrap();
    assert_eq!([real(circle, 10), real(circle, 20), real(circle, 40)], [30.0, (220.0 - 170.0) / 5.0, 4.0]);
    assert!(dxf.contains("$INSUNITS\n70\n4\n") && dxf.contains("1 Pen #c80010"));
}

#[test]
fn arcs_of_a_dxf_begin_and_end_where_they_did() {
    let drawing = everything();
    for (kind, pairs) in entities(&text(&drawing, "dxf", &WriteOptions::default())) {
        if kind != "ARC" {
            continue;
        }
        let (centre, radius) = (Point::new(real(&pairs, 10), real(&pairs, 20)), real(&pairs, 40));
        let mut ends = [50, 51].map(|code| {
            let angle = real(&pairs, code).to_radians();
            let p = centre + radius * kurbo::Vec2::from_angle(angle);
            (5.0 * p.x, 220.0 - 5.0 * p.y)
        });
        let stroke = drawing.strokes.iter().find(|s| match &s.centreline {
            Centreline::Path { segments, .. } => {
                matches!(segments[..], [fieldtrace::Segment::Arc(a)] if (a.radii.x - 5.0 * radius).abs() < 1e-3)
            }
            _ => false,
        });
        let line = &stroke.expect("an arc of this radius").centreline;
        let mut expected = [line.start(), line.end()].map(|p| (p.x, p.y));
        let order = |a: &(f64, f64), b: &(f64, f64)| a.0.total_cmp(&b.0);
        ends.sort_by(order);
        expected.sort_by(order);
        for (a, b) in ends.iter().zip(&expected) {
            assert!((a.0 - b.0).abs() < 1e-3 && (a.1 - b.1).abs() < 1e-3, "{ends:?} {expected:?}");
        }
    }
}

#[test]
fn curves_of_a_dxf_are_splines_on_request() {
    let options = WriteOptions::default().with(|o| o.curves = Some(Curves::Bezier));
    let found = entities(&text(&everything(), "dxf", &options));
    let (_, spline) = found.iter().find(|e| e.0 == "SPLINE").expect("a spline");
    let count = |code| spline.iter().filter(|pair| pair.0 == code).count();
    assert_eq!((count(10), count(40)), (4, 8));
    assert_eq!((real(spline, 72), real(spline, 73)), (8.0, 4.0));
}

#[test]
fn a_pdf_has_the_ink_of_the_drawing() {
    let drawing = everything();
    let pdf = bytes(&drawing, "pdf", &WriteOptions::default());
    let options = LoadOptions::default().with(|o| o.dpi = Some(127.0.into()));
    let scan = load_bytes("out.pdf", &pdf, &options).unwrap().scan;
    assert_eq!(scan.gray.size(), (240, 220));
    let ink = render(&drawing);
    let rgb = scan.rgb.as_ref().expect("a pen in colour");
    let (mut wrong, mut all) = (0.0, 0.0);
    for y in 0..220 {
        for x in 0..240 {
            // Full ink of either pen leaves no green.
            let shown = 1.0 - f64::from(rgb.get_pixel(x as u32, y as u32).0[1]) / 255.0;
            wrong += (shown - f64::from(ink[(x, y)])).abs();
            all += f64::from(ink[(x, y)]);
        }
    }
    assert!(wrong < 0.04 * all, "{wrong} of {all}");
}

#[test]
fn geojson_has_lines_points_and_polygons_with_holes() {
    let json: serde_json::Value =
        serde_json::from_str(&text(&everything(), "geojson", &WriteOptions::default())).unwrap();
    let features = json["features"].as_array().unwrap();
    let kinds = |kind: &str| features.iter().filter(|f| f["geometry"]["type"] == kind).count();
    assert_eq!((kinds("LineString"), kinds("Point"), kinds("Polygon")), (7, 1, 1));
    let polygon = features.iter().find(|f| f["geometry"]["type"] == "Polygon").unwrap();
    assert_eq!(polygon["geometry"]["coordinates"].as_array().unwrap().len(), 2);
    let ends = [serde_json::json!([100.0, 200.0]), serde_json::json!([180.0, 175.0])];
    let is_between = |f: &&serde_json::Value| {
        let ways = f["geometry"]["coordinates"].as_array().filter(|points| points.len() == 2);
        ways.is_some_and(|points| ends.iter().all(|end| points.contains(end)))
    };
    let straight = features.iter().find(is_between).expect("the line, with y up");
    assert_eq!((&straight["properties"]["width"], &straight["properties"]["color"]), (&3.0.into(), &"#000000".into()));
}

#[test]
fn points_of_a_csv_are_a_step_apart_and_on_the_lines() {
    let drawing = sheet(200, 100, vec![line((10.0, 20.0), (110.0, 20.0), 3.0), circle((150.0, 50.0), 20.0, 2.0)]);
    for step in [0.5, 2.0, 7.0] {
        let csv = text(&drawing, "csv", &WriteOptions::default().with(|o| o.step = step));
        let rows: Vec<Vec<&str>> = csv.lines().map(|row| row.split(',').collect()).collect();
        assert_eq!(rows[0], ["stroke", "x", "y", "width", "color"]);
        let number = |row: &[&str], k: usize| -> f64 { row[k].parse().unwrap() };
        let along = |stroke: &str| rows[1..].iter().filter(|row| row[0] == stroke).cloned().collect::<Vec<_>>();
        for stroke in ["0", "1"] {
            for pair in along(stroke).windows(2) {
                let apart =
                    (number(&pair[1], 1) - number(&pair[0], 1)).hypot(number(&pair[1], 2) - number(&pair[0], 2));
                assert!(apart <= step + 0.02 && apart > 0.4 * step, "{apart} for {step}");
            }
        }
        assert!(rows[1..].iter().any(|row| row[3] == "3") && rows[1..].iter().any(|row| row[3] == "2"));
    }
}

#[test]
fn millimetres_need_a_resolution_and_scale_everything() {
    let options = WriteOptions::default().with(|o| {
        o.units = Units::Millimetres;
        o.precision = 3;
    });
    let mut drawing = sheet(254, 127, vec![line((10.0, 20.0), (110.0, 20.0), 3.0)]);
    let wrong =
        encode(format_named("svg").unwrap(), &Document { drawing: &drawing, graph: None }, &options).unwrap_err();
    assert!(wrong.to_string().starts_with("units: "), "{wrong}");
    drawing.dpi = Some(254.0);
    let svg = text(&drawing, "svg", &options);
    assert!(svg.contains(r#"width="25.4mm""#) && svg.contains(r#"viewBox="0 0 25.4 12.7""#), "{svg}");
    assert!(svg.contains(r#"x1="1" "#) && svg.contains(r#"stroke-width="0.3""#), "{svg}");
}

#[test]
fn an_svg_of_paths_alone_draws_the_same() {
    let drawing = everything();
    let inks = [Shapes::Plain, Shapes::Path].map(|shapes| {
        let svg = text(&drawing, "svg", &WriteOptions::default().with(|o| o.shapes = shapes));
        if shapes == Shapes::Path {
            assert!(!["<line", "<circle", "<rect"].iter().any(|element| svg.contains(element)), "{svg}");
        }
        load_bytes("out.svg", svg.as_bytes(), &LoadOptions::default().with(|o| o.size = Some(240))).unwrap().scan.gray
    });
    let difference: f32 = inks[0].data().iter().zip(inks[1].data()).map(|(a, b)| (a - b).abs()).sum();
    assert!(difference < 3.0, "{difference}");
}

#[test]
fn every_element_of_an_svg_has_its_own_pen_and_ids_are_unique() {
    let svg = text(&everything(), "svg", &WriteOptions::default());
    let document = roxmltree_of(&svg);
    let mut ids = Vec::new();
    for node in document.descendants().filter(|node| node.is_element()) {
        ids.extend(node.attribute("id"));
        if ["line", "path", "circle", "rect"].contains(&node.tag_name().name()) {
            assert!(node.attribute("stroke").is_some(), "{node:?}");
            assert!(node.attribute("stroke") == Some("none") || node.attribute("stroke-width").is_some());
        }
    }
    let count = ids.len();
    ids.sort_unstable();
    ids.dedup();
    assert!(count == ids.len() && count >= 2);
    assert!(!svg.contains("<!--"), "programs trip over comments");
}

fn roxmltree_of(svg: &str) -> usvg::roxmltree::Document<'_> {
    usvg::roxmltree::Document::parse(svg).expect("valid XML")
}

#[test]
fn outputs_know_that_they_are_untouched() {
    let drawing = everything();
    for format in formats().iter().filter(|format| format.name() != "json") {
        let written = bytes(&drawing, format.name(), &WriteOptions::default());
        assert_eq!(written, bytes(&drawing, format.name(), &WriteOptions::default()), "{}", format.name());
        assert!(is_untouched_output(&written), "{}", format.name());
        if ["csv", "svgz"].contains(&format.name()) {
            continue;
        }
        for at in [written.len() / 3, written.len() / 2, written.len() - 2] {
            let mut changed = written.clone();
            changed[at] = if changed[at] == b'7' { b'8' } else { b'7' };
            assert!(!is_untouched_output(&changed), "{} at {at}", format.name());
        }
    }
    for other in [&b""[..], b"<svg/>", b"stroke;x;y", b"%PDF-1.7", b"\x1f\x8b"] {
        assert!(!is_untouched_output(other));
    }
}

#[test]
fn without_the_graph_there_is_no_json() {
    let drawing = everything();
    let wrong =
        encode(format_named("json").unwrap(), &Document { drawing: &drawing, graph: None }, &WriteOptions::default());
    assert!(wrong.unwrap_err().to_string().contains("graph"));
}
