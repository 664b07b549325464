//! The stroke graph as JSON: read back, corrected, and wrong.

mod common;

use common::compare::{bow, lines, strokes_apart};
use common::draw::{arc, circle, dot, line, polar, polyline, scan, sheet};
use common::paper::Paper;
use common::sweep::{ensure, pairs, steps, sweep};
use fieldtrace::drawing::{Drawing, Stroke};
use fieldtrace::graph::{JunctionKind, StrokeGraph};
use fieldtrace::load::{LoadOptions, Scan, load};
use fieldtrace::options::Options;
use fieldtrace::pipeline::Vectorizer;
use fieldtrace::write::graph_json::{from_json, is_json, to_json};
use fieldtrace::write::{WriteOptions, to_svg};
use kurbo::Point;
use serde_json::{Value, json};

const CENTER: Point = Point::new(48.0, 48.0);

fn vectorizer() -> Vectorizer {
    Vectorizer::new(Options::default()).unwrap()
}

fn graph(scan: &Scan) -> StrokeGraph {
    vectorizer().graph(scan, &mut ()).unwrap()
}

fn draw(graph: &StrokeGraph) -> Drawing {
    vectorizer().draw(graph, &mut ()).unwrap()
}

fn json_of(strokes: Vec<Stroke>) -> Value {
    serde_json::from_str(&to_json(&graph(&scan(&sheet(96, 96, strokes))))).unwrap()
}

fn drawn(value: &Value) -> Drawing {
    draw(&from_json("corrected.json", value.to_string().as_bytes()).unwrap())
}

/// The graph written and read gives the trace's own drawing, and is written the same again.
fn round_trip(scan: &Scan) -> Result<(), String> {
    let traced = graph(scan);
    let text = to_json(&traced);
    let read = from_json("graph.json", text.as_bytes()).map_err(|e| e.to_string())?;
    let again = to_json(&read);
    let changed = text.lines().zip(again.lines()).find(|(a, b)| a != b);
    ensure(again == text, || format!("it is written differently: {changed:?}"))?;
    let (before, after) = (draw(&traced), draw(&read));
    let counts = |d: &Drawing| (d.strokes.len(), d.segment_count(), d.fills.len());
    ensure(counts(&before) == counts(&after), || format!("{:?} became {:?}", counts(&before), counts(&after)))?;
    let apart = strokes_apart(&before, &after);
    ensure(apart.max < 0.01, || format!("{apart:?}"))?;
    let sizes = |d: &Drawing| (d.width, d.height, d.dpi);
    ensure(sizes(&before) == sizes(&after), || "the page changed".into())
}

#[test]
fn a_graph_that_nobody_changed_gives_the_same_drawing() {
    let mut cases: Vec<(String, Scan)> = ["leaf.jpg", "kettle.png", "boat.png", "plan.svg"]
        .map(|name| {
            let options = LoadOptions::default().with(|o| o.dpi = Some(96.0.into()));
            (name.to_string(), load(format!("samples/{name}").as_ref(), &options).unwrap().scan)
        })
        .into();
    // Thin lines are traced at twice their size, thick ones at half.
    for (angle, width) in pairs(&steps(0.0, 85.0, 17.0), &[1.0, 3.0, 18.0]) {
        let at = |turn: f64, reach: f64| polar(CENTER, angle + turn, reach);
        let strokes = vec![
            line(at(0.0, 40.0), at(180.0, 40.0), width),
            line(at(70.0, 40.0), at(250.0, 40.0), width),
            polyline(&[at(120.0, 36.0), at(150.0, 42.0), at(165.0, 25.0)], false, width),
            circle(at(-45.0, 25.0), 10.0, width),
            dot(at(35.0, 40.0), 1.2 * width),
        ];
        let clean = scan(&sheet(96, 96, strokes));
        let mut pencil = clean.clone();
        pencil.gray = Paper::PENCIL.scan(&clean.gray, angle as u64);
        cases.push((format!("{angle} degrees, {width} wide, clean"), clean));
        cases.push((format!("{angle} degrees, {width} wide, pencil"), pencil));
    }
    let names: Vec<usize> = (0..cases.len()).collect();
    sweep("round trips", 1.0, &names, |&i| round_trip(&cases[i].1).map_err(|e| format!("{}: {e}", cases[i].0)));
}

#[test]
fn the_graph_tells_kinds_and_confidence() {
    sweep("a tee and a crossing", 1.0, &steps(0.0, 80.0, 8.0), |&angle| {
        let at = |turn: f64, reach: f64| polar(CENTER, angle + turn, reach);
        let value = json_of(vec![
            line(at(0.0, 44.0), at(180.0, 44.0), 3.0),
            line(at(0.0, 20.0) + (at(90.0, 30.0) - CENTER), at(0.0, 20.0), 3.0),
            line(at(180.0, 20.0) + (at(90.0, 20.0) - CENTER), at(180.0, 20.0) + (at(270.0, 20.0) - CENTER), 3.0),
        ]);
        let nodes = value["nodes"].as_array().unwrap();
        for (kind, x, y) in
            [("tee", at(0.0, 20.0).x, at(0.0, 20.0).y), ("crossing", at(180.0, 20.0).x, at(180.0, 20.0).y)]
        {
            let of_kind: Vec<&Value> = nodes.iter().filter(|n| n["kind"] == kind).collect();
            ensure(of_kind.len() == 1, || format!("{} of {kind}", of_kind.len()))?;
            let far = (of_kind[0]["x"].as_f64().unwrap() - x).hypot(of_kind[0]["y"].as_f64().unwrap() - y);
            ensure(far < 0.8, || format!("the {kind} is {far:.2} off"))?;
            let confidence = of_kind[0]["confidence"].as_f64().unwrap();
            ensure((0.8..=1.0).contains(&confidence), || format!("the {kind} has confidence {confidence}"))?;
        }
        Ok(())
    });
}

#[test]
fn a_moved_end_takes_its_line_along() {
    sweep("a moved end", 1.0, &pairs(&steps(0.0, 345.0, 15.0), &[2.0, 4.0]), |&(angle, width)| {
        let mut value = json_of(vec![line((20.0, 48.0), (76.0, 48.0), width)]);
        let node = value["nodes"].as_array_mut().unwrap().iter_mut().find(|n| n["x"].as_f64() > Some(48.0)).unwrap();
        let to = polar(Point::new(76.0, 48.0), angle, 12.0);
        (node["x"], node["y"]) = (json!(to.x), json!(to.y));
        let result = drawn(&value);
        let [stroke] = &result.strokes[..] else { return Err(format!("{} strokes", result.strokes.len())) };
        let ends = [stroke.centreline.start(), stroke.centreline.end()];
        let off = ends.map(|e| e.distance(to)).into_iter().fold(f64::INFINITY, f64::min);
        ensure(off < 0.3, || format!("the end is {off:.2} away"))?;
        ensure(bow(&stroke.centreline) < 0.2, || format!("it bows by {:.2}", bow(&stroke.centreline)))
    });
}

#[test]
fn a_moved_corner_stays_sharp() {
    sweep("a moved corner", 1.0, &steps(0.0, 350.0, 10.0), |&angle| {
        let mut value =
            json_of(vec![polyline(&[(16.0, 80.0).into(), (48.0, 24.0).into(), (80.0, 80.0).into()], false, 3.0)]);
        let node = value["nodes"].as_array_mut().unwrap().iter_mut().find(|n| n["kind"] == "corner").unwrap();
        let to = polar(Point::new(48.0, 24.0), angle, 10.0);
        (node["x"], node["y"]) = (json!(to.x), json!(to.y));
        let truth = sheet(96, 96, vec![polyline(&[(16.0, 80.0).into(), to, (80.0, 80.0).into()], false, 3.0)]);
        let apart = strokes_apart(&truth, &drawn(&value));
        ensure(apart.max < 0.8, || format!("{apart:?}"))
    });
}

#[test]
fn a_split_trail_is_two_strokes_and_a_deleted_one_none() {
    let strokes = vec![line((10.0, 48.0), (86.0, 48.0), 3.0), line((48.0, 10.0), (48.0, 86.0), 3.0)];
    let value = json_of(strokes);
    assert_eq!(drawn(&value).strokes.len(), 2);
    let mut split = value.clone();
    let trails = split["strokes"].as_array_mut().unwrap();
    let second = trails[0]["edges"].as_array_mut().unwrap().pop().unwrap();
    trails.push(json!({ "edges": [second] }));
    let result = drawn(&split);
    assert_eq!(result.strokes.len(), 3);
    assert!(strokes_apart(&result, &drawn(&value)).max < 0.3);
    let mut deleted = value;
    deleted["strokes"].as_array_mut().unwrap().pop();
    assert_eq!(drawn(&deleted).strokes.len(), 1);
}

#[test]
fn points_may_be_few_and_widths_missing() {
    let mut value = json_of(vec![arc(CENTER, 30.0, 0.3, 2.0, 3.0)]);
    let before = drawn(&value);
    for edge in value["edges"].as_array_mut().unwrap() {
        let points = edge["points"].as_array().unwrap();
        let last = points.len() - 1;
        let kept: Vec<Value> = (0..=last).filter(|k| k % 6 == 0 || *k == last).map(|k| points[k].clone()).collect();
        edge["points"] = json!(kept);
        edge.as_object_mut().unwrap().remove("widths");
    }
    let after = drawn(&value);
    assert!(strokes_apart(&before, &after).max < 0.5);
    assert!((after.strokes[0].width - 3.0).abs() < 0.3);
}

#[test]
fn the_example_of_the_documentation_is_a_graph() {
    let page = include_str!("../src/write/graph_json.md");
    let example = page.split("```json").nth(1).and_then(|rest| rest.split("```").next()).unwrap();
    let graph = from_json("example", example.as_bytes()).unwrap();
    let kinds: Vec<JunctionKind> = graph.graph.node_weights().map(|n| n.kind).collect();
    assert_eq!(kinds, [JunctionKind::FreeEnd, JunctionKind::Tee]);
    let drawing = draw(&graph);
    assert_eq!((drawing.strokes.len(), drawing.fills.len(), drawing.dpi), (2, 1, Some(300.0)));
    assert!(to_svg(&drawing, &WriteOptions::default()).contains("<line"));
    assert_eq!(lines(&drawing).len(), 2);
}

#[test]
fn what_is_wrong_is_named_with_its_place() {
    let good = json_of(vec![line((10.0, 48.0), (86.0, 48.0), 3.0), line((48.0, 10.0), (48.0, 86.0), 3.0)]);
    let cases: [(&str, Value, &str, &str); 19] = [
        ("/format", json!("other"), "format", "fieldtrace-graph"),
        ("/version", json!(2), "version", "2 is not 1"),
        ("/width", json!(0), "width", "0 is not between"),
        ("/height", json!(1e9), "height", "is not between"),
        ("/line_width", json!(-1), "line_width", "-1 is not between"),
        ("/scale", json!(0), "scale", "is not between"),
        ("/nodes/1/id", good["nodes"][0]["id"].clone(), "nodes[1].id", "two nodes"),
        ("/nodes/1/kind", json!("knot"), "line 1, column", "unknown variant `knot`"),
        ("/nodes/1/x", json!("left"), "line 1, column", "invalid type"),
        ("/nodes/1/x", json!(1e12), "nodes[1]", "is not between"),
        ("/nodes/1/confidence", json!(1.5), "nodes[1].confidence", "1.5 is not between 0 and 1"),
        ("/edges/0/from", json!(99), "edges[0].from", "there is no node 99"),
        ("/edges/0/points", json!([[1, 2]]), "edges[0].points", "1 points are too few"),
        ("/edges/0/widths", json!([3.0]), "edges[0].widths", "1 widths for"),
        ("/edges/0/widths/0", json!(-3.0), "edges[0].widths[0]", "-3 is not between"),
        ("/strokes/0/edges/0/edge", json!(77), "strokes[0].edges[0]", "there is no edge 77"),
        ("/strokes/0/edges/0/reversed", json!(true), "strokes[0].edges[1]", "does not start where"),
        ("/strokes/0/closed", json!(true), "strokes[0]", "does not end where it starts"),
        ("/strokes/0/color", json!("red"), "line 1, column", "not a colour"),
    ];
    for (at, value, place, reason) in cases {
        let mut bad = good.clone();
        *bad.pointer_mut(at).unwrap_or_else(|| panic!("{at}")) = value;
        let error = from_json("bad.json", bad.to_string().as_bytes()).expect_err(at).to_string();
        assert!(error.starts_with(&format!("bad.json: {place}")) && error.contains(reason), "{at}: {error}");
    }
    let mut twice = good.clone();
    twice["strokes"][1] = twice["strokes"][0].clone();
    let error = from_json("bad.json", twice.to_string().as_bytes()).unwrap_err().to_string();
    assert!(
        error.starts_with("bad.json: strokes[1].edges[0]: edge") && error.ends_with("in a stroke already"),
        "{error}"
    );
}

#[test]
fn half_a_file_is_an_error_at_any_length() {
    let text = json_of(vec![line((10.0, 48.0), (30.0, 48.0), 3.0), dot((60.0, 60.0), 4.0)]).to_string();
    let lengths: Vec<usize> = (0..text.len()).step_by(7).collect();
    sweep("halves", 1.0, &lengths, |&n| {
        let error = from_json("half.json", &text.as_bytes()[..n]).err().ok_or("it was read")?.to_string();
        ensure(error.starts_with("half.json: line 1, column"), || error.clone())
    });
}

#[test]
fn json_is_told_from_images() {
    assert!(is_json(b"{}") && is_json(b" \n{ ") && is_json(b"\xEF\xBB\xBF{"));
    assert!(!is_json(b"\x89PNG") && !is_json(b"<svg/>") && !is_json(b""));
}
