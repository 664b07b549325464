//! The pictures of the stages. They are left in the folder `tmp/inspect` of Cargo's target directory.

use fieldtrace::clean::{LineImage, clean};
use fieldtrace::drawing::{Centreline, Color, Drawing, Fill, Segment, Stroke};
use fieldtrace::field::PolyVectorField;
use fieldtrace::graph::{Dot, Edge, Junction, JunctionKind, StrokeGraph, Trail};
use fieldtrace::hooks::Observer;
use fieldtrace::inspect::{DebugDir, drawing_overlay, field_overlay, graph_overlay, streamlines_overlay, to_png};
use fieldtrace::load::Scan;
use fieldtrace::options::Options;
use fieldtrace::raster::Raster;
use fieldtrace::render::render;
use fieldtrace::streamline::{Stop, Streamline};
use kurbo::{Arc, Circle, CubicBez, Line, Point, Rect, Shape, Vec2};
use std::path::Path;

/// One of everything on 160 x 120 pixels.
fn drawing() -> Drawing {
    let mut drawing = Drawing::new(160.0, 120.0);
    let mut add = |centreline, width| drawing.strokes.push(Stroke::new(centreline, width));
    let path = |segments| Centreline::Path { segments, closed: false };
    add(path(vec![Segment::Line(Line::new((10.0, 20.0), (150.0, 100.0)))]), 4.0);
    let arc = Arc::new((80.0, 60.0), (40.0, 40.0), 0.0, 3.0, 0.0);
    add(path(vec![Segment::Arc(arc)]), 3.0);
    let cubic = CubicBez::new((10.0, 100.0), (40.0, 10.0), (90.0, 130.0), (150.0, 20.0));
    add(path(vec![Segment::Cubic(cubic)]), 3.0);
    add(Centreline::Circle(Circle::new((30.0, 60.0), 12.0)), 3.0);
    add(Centreline::Dot(Point::new(140.0, 60.0)), 6.0);
    let outline = Rect::new(60.0, 5.0, 85.0, 20.0).to_path(0.1);
    drawing.fills.push(Fill { outline, color: Color::BLACK });
    drawing
}

fn scan() -> Scan {
    Scan { gray: render(&drawing()).map(|ink| 1.0 - ink), rgb: None, dpi: None }
}

fn line_image() -> LineImage {
    let ink = render(&drawing());
    let solids = drawing().fills;
    let mask = Raster::from_fn(160, 120, |x, y| ink[(x, y)] > 0.5 && !(60..85).contains(&x));
    LineImage { mask, solids, ..clean(&scan(), &Options::default()) }
}

fn field() -> PolyVectorField {
    let image = line_image();
    PolyVectorField::from_directions(160, 120, |x, y| {
        image.mask[(x, y)].then(|| (Vec2::from_angle(0.02 * x as f64), Vec2::from_angle(1.0 + 0.03 * y as f64)))
    })
}

fn streamline(points: Vec<Point>, closed: bool) -> Streamline {
    Streamline { widths: vec![f64::NAN; points.len()], points, closed, stops: [Stop::InkEnd; 2] }
}

fn streamlines() -> Vec<Streamline> {
    let along = |s: &Stroke| {
        let mut points = Vec::new();
        kurbo::flatten(s.centreline.to_path(), 0.05, |e| points.extend(e.end_point()));
        streamline(points, s.centreline.is_closed())
    };
    drawing().strokes.iter().map(along).chain([streamline(vec![], true)]).collect()
}

/// A graph with a node of each kind.
fn graph() -> StrokeGraph {
    use JunctionKind::{Branch, Corner, Crossing, FreeEnd, Seam, Tee};
    let mut graph = StrokeGraph::default();
    let mut last = None;
    for (i, kind) in [FreeEnd, Corner, Tee, Crossing, Branch, Seam].into_iter().enumerate() {
        let position = Point::new(20.0 + 24.0 * i as f64, 40.0 + 10.0 * (i % 2) as f64);
        let node = graph.graph.add_node(Junction::new(position, kind));
        if let Some((before, from)) = last {
            let edge = Edge { points: vec![from, position], widths: vec![3.0, f64::NAN], noise: 0.0 };
            let edge = graph.graph.add_edge(before, node, edge);
            graph.trails.push(Trail { edges: vec![(edge, false)], closed: false, color: Color::BLACK, dashes: None });
        }
        last = Some((node, position));
    }
    graph.dots.push(Dot { centre: Point::new(140.0, 60.0), diameter: 6.0, color: Color::BLACK });
    graph
}

fn observe(folder: &Path, scan: &Scan) {
    let mut debug = DebugDir::create(folder, scan).unwrap();
    let (mut image, mut graph) = (line_image(), graph());
    debug.on_line_image(&mut image).unwrap();
    debug.on_field(&image, &mut field()).unwrap();
    for mut streamline in streamlines() {
        assert!(debug.on_streamline(&image, &mut streamline).unwrap());
    }
    debug.on_graph(&image, &mut graph).unwrap();
    debug.on_drawing(&mut drawing()).unwrap();
}

#[test]
fn every_stage_is_drawn() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("inspect/of/everything");
    let _ = std::fs::remove_dir_all(&folder);
    observe(&folder, &scan());
    let ink = image::open(folder.join("1-ink.png")).unwrap().to_rgb8();
    assert_eq!((ink.width(), ink.height()), (1280, 960));
    assert_eq!(ink.get_pixel(8 * 72, 8 * 12).0, [240, 140, 0], "a solid region");
    assert_eq!(ink.get_pixel(8 * 140, 8 * 60).0, [0, 0, 0], "a dot");
    assert_eq!(ink.get_pixel(2, 2).0, [255, 255, 255], "paper");
    for stage in ["2-field", "3-streamlines", "4-graph", "5-strokes"] {
        let svg = std::fs::read_to_string(folder.join(format!("{stage}.svg"))).unwrap();
        assert!(usvg::Tree::from_str(&svg, &usvg::Options::default()).is_ok(), "{stage}");
        assert!(svg.contains("data:image/png;base64,") && !svg.contains("NaN"), "{stage}");
        let png = image::open(folder.join(format!("{stage}.png"))).unwrap();
        assert!(png.width() == 1280 && png.height() > 960, "{stage}: {} x {}", png.width(), png.height());
    }
}

#[test]
fn the_same_trace_gives_the_same_pictures() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("inspect/twice");
    let text = |name: &str| std::fs::read_to_string(folder.join(name).join("4-graph.svg")).unwrap();
    observe(&folder.join("a"), &scan());
    observe(&folder.join("b"), &scan());
    assert_eq!(text("a"), text("b"));
}

#[test]
fn a_legend_counts_the_nodes() {
    let svg = graph_overlay(&scan(), 1.0, &graph());
    for label in ["1 free ends", "1 corners", "1 tees", "1 crossings", "1 branches", "1 seams", "1 dots", "5 trails"] {
        assert!(svg.contains(label), "{label}");
    }
}

#[test]
fn the_line_image_may_be_of_another_scale() {
    let line = streamline(vec![(20.0, 40.0).into(), (60.0, 40.0).into()], false);
    assert!(streamlines_overlay(&scan(), 4.0, &[line]).contains("M5 10L15 10"));
}

#[test]
fn nothing_to_show_is_no_error() {
    let scan = Scan { gray: Raster::filled(3, 1, 1.0), rgb: None, dpi: None };
    let nothing = PolyVectorField::from_directions(3, 1, |_, _| None);
    for svg in [
        field_overlay(&scan, &nothing),
        streamlines_overlay(&scan, 1.0, &[]),
        graph_overlay(&scan, 1.0, &StrokeGraph::default()),
        drawing_overlay(&scan, &Drawing::new(3.0, 1.0)),
    ] {
        assert!(image::load_from_memory(&to_png(&svg).unwrap()).is_ok());
    }
}
