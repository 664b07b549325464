//! The strokes of an SVG against closed forms and against its rendering.

use fieldtrace::Error;
use fieldtrace::drawing::{Centreline, Color, Drawing, Segment};
use fieldtrace::load::{Input, LoadOptions, load_bytes};
use kurbo::{PathEl, Point, Shape};
use resvg::tiny_skia;
use std::f64::consts::PI;
use std::io::Write;

fn document(width: u32, height: u32, body: &str) -> String {
    format!("<svg xmlns='http://www.w3.org/2000/svg' width='{width}' height='{height}'>{body}</svg>")
}

/// An SVG of 100 x 100 CSS pixels, rendered at one pixel for each.
fn read(body: &str) -> Input {
    let options = LoadOptions::default().with(|o| o.size = Some(100));
    load_bytes("test.svg", document(100, 100, body).as_bytes(), &options).unwrap()
}

fn strokes(body: &str) -> Drawing {
    read(&format!("<g stroke='black' fill='none'>{body}</g>")).drawing.unwrap()
}

#[track_caller]
fn assert_at(p: Point, x: f64, y: f64) {
    assert!(p.distance(Point::new(x, y)) < 1e-4, "{p:?} is not {x}, {y}");
}

#[test]
fn nested_transforms_move_points_and_scale_widths() {
    let drawing = strokes(
        "<g transform='translate(40 20) rotate(90)'><g transform='scale(2)'>\
         <line x1='1' y1='3' x2='11' y2='3' stroke-width='3'/></g></g>\
         <path d='M1 1L9 1' stroke-width='2' transform='scale(2 8)'/>\
         <path d='M0 0L10 0' stroke-width='2' transform='matrix(-1 0 0 1 50 60)'/>",
    );
    let [a, b, c] = &drawing.strokes[..] else { panic!("{drawing:?}") };
    assert_at(a.centreline.start(), 34.0, 22.0);
    assert_at(a.centreline.end(), 34.0, 42.0);
    assert!((a.width - 6.0).abs() < 1e-4);
    assert_at(b.centreline.end(), 18.0, 8.0);
    assert!((b.width - 8.0).abs() < 1e-4, "2 times the root of 16");
    assert_at(c.centreline.end(), 40.0, 60.0);
    assert!((c.width - 2.0).abs() < 1e-4, "a mirror image keeps its width");
}

#[test]
fn a_view_box_is_a_transform_too() {
    let text = "<svg xmlns='http://www.w3.org/2000/svg' width='50' height='50' viewBox='10 10 20 20'>\
        <path d='M12 14H20' stroke='red' stroke-width='1'/></svg>";
    let options = LoadOptions::default().with(|o| o.size = Some(200));
    let drawing = load_bytes("a", text.as_bytes(), &options).unwrap().drawing.unwrap();
    assert_eq!((drawing.width, drawing.height), (200.0, 200.0));
    let stroke = &drawing.strokes[0];
    assert_at(stroke.centreline.start(), 20.0, 40.0);
    assert_at(stroke.centreline.end(), 100.0, 40.0);
    assert!((stroke.width - 10.0).abs() < 1e-4 && stroke.color == Color([255, 0, 0]));
}

#[test]
fn basic_shapes_have_their_closed_forms() {
    let drawing = strokes(
        "<rect x='10' y='20' width='30' height='15'/><circle cx='70' cy='30' r='12'/>\
         <polyline points='5,60 25,60 25,80'/><polygon points='50,60 53,60 53,64'/>\
         <ellipse cx='70' cy='80' rx='20' ry='10'/>",
    );
    let closed: Vec<bool> = drawing.strokes.iter().map(|s| s.centreline.is_closed()).collect();
    assert_eq!(closed, [true, true, false, true, true]);
    let length = |i: usize| drawing.strokes[i].centreline.to_path().perimeter(1e-6);
    assert!((length(0) - 90.0).abs() < 1e-3);
    assert!((length(1) - 24.0 * PI).abs() < 0.02, "{}", length(1));
    assert!((length(2) - 40.0).abs() < 1e-3);
    assert!((length(3) - 12.0).abs() < 1e-3);
    assert!((length(4) - 96.884).abs() < 0.05, "{}", length(4));
    let area = |i: usize| drawing.strokes[i].centreline.to_path().area().abs();
    assert!((area(0) - 450.0).abs() < 1e-2 && (area(1) - 144.0 * PI).abs() < 0.3 && (area(3) - 6.0).abs() < 1e-2);
    let path = drawing.strokes[1].centreline.to_path();
    for segment in path.segments() {
        use kurbo::ParamCurve;
        assert!((segment.eval(0.3).distance(Point::new(70.0, 30.0)) - 12.0).abs() < 0.01);
    }
    assert!(drawing.fills.is_empty());
}

#[test]
fn paths_keep_their_pieces() {
    let drawing =
        strokes("<path d='M10 10Q20 0 30 10C40 20 50 0 60 10L70 10M10 50L20 50L20 60ZM30 90A10 10 0 0 1 50 90'/>");
    let [a, b, c] = &drawing.strokes[..] else { panic!("{drawing:?}") };
    let Centreline::Path { segments, closed: false } = &a.centreline else { panic!("{a:?}") };
    let [Segment::Cubic(q), Segment::Cubic(_), Segment::Line(_)] = &segments[..] else { panic!("{segments:?}") };
    assert_at(q.p1, 10.0 + 20.0 / 3.0, 10.0 - 20.0 / 3.0);
    assert_at(q.p2, 30.0 - 20.0 / 3.0, 10.0 - 20.0 / 3.0);
    assert!(b.centreline.is_closed() && b.centreline.start() == b.centreline.end());
    assert!((c.centreline.to_path().perimeter(1e-6) - 10.0 * PI).abs() < 0.01);
}

#[test]
fn dashes_and_dots() {
    let drawing = strokes(
        "<path d='M10 10H50' stroke-dasharray='6 4'/><path d='M70 70h0' stroke-linecap='round' stroke-width='5'/>\
         <path d='M80 70h0'/>",
    );
    let mut lines: Vec<_> = drawing.strokes.iter().filter(|s| !matches!(s.centreline, Centreline::Dot(_))).collect();
    lines.sort_by(|a, b| a.centreline.start().x.total_cmp(&b.centreline.start().x));
    assert_eq!(lines.len(), 4);
    for (i, dash) in lines.iter().enumerate() {
        assert_at(dash.centreline.start(), 10.0 + 10.0 * i as f64, 10.0);
        assert_at(dash.centreline.end(), 16.0 + 10.0 * i as f64, 10.0);
    }
    let dots: Vec<_> = drawing.strokes.iter().filter(|s| matches!(s.centreline, Centreline::Dot(_))).collect();
    assert_eq!(dots.len(), 1);
    assert_at(dots[0].centreline.start(), 70.0, 70.0);
    assert_eq!(dots[0].width, 5.0);
}

#[test]
fn paints_become_colours() {
    let drawing = read(
        "<rect width='100' height='100' fill='white'/><path d='M0 0H9V9Z' fill='#00f'/>\
         <path d='M20 20H50' stroke='black' stroke-opacity='.5'/>\
         <g opacity='.5'><path d='M20 30H50' stroke='red'/></g><path d='M20 40L50 50' stroke='blue'/>\
         <path d='M20 60H50' stroke='black' visibility='hidden'/><path d='M2 4H8' stroke='white'/>",
    )
    .drawing
    .unwrap();
    let colors: Vec<_> = drawing.strokes.iter().map(|s| s.color.0).collect();
    assert_eq!(colors, [[128, 128, 128], [255, 128, 128], [0, 0, 255], [255, 255, 255]]);
    assert_eq!(drawing.fills.len(), 1, "paper is no fill, nor is the inside of a straight line");
    assert_eq!(drawing.fills[0].color, Color([0, 0, 255]));
    assert!((drawing.fills[0].outline.area().abs() - 40.5).abs() < 1e-3);
    assert_eq!(drawing.fills[0].outline.elements().last(), Some(&PathEl::ClosePath));
}

/// Draws the strokes with round caps and joins; ink is 1.
fn ink(drawing: &Drawing) -> Vec<f32> {
    let mut pixmap = tiny_skia::Pixmap::new(drawing.width as u32, drawing.height as u32).unwrap();
    let mut paint = tiny_skia::Paint::default();
    paint.set_color_rgba8(0, 0, 0, 255);
    for s in &drawing.strokes {
        let mut path = tiny_skia::PathBuilder::new();
        for element in s.centreline.to_path().elements() {
            let f = |p: &Point| (p.x as f32, p.y as f32);
            match element {
                PathEl::MoveTo(a) => path.move_to(f(a).0, f(a).1),
                PathEl::LineTo(a) => path.line_to(f(a).0, f(a).1),
                PathEl::CurveTo(a, b, c) => path.cubic_to(f(a).0, f(a).1, f(b).0, f(b).1, f(c).0, f(c).1),
                PathEl::QuadTo(..) => unreachable!("quadratics are raised"),
                PathEl::ClosePath => path.close(),
            }
        }
        let width = s.width as f32;
        let (line_cap, line_join) = (tiny_skia::LineCap::Round, tiny_skia::LineJoin::Round);
        let stroke = tiny_skia::Stroke { width, line_cap, line_join, ..Default::default() };
        pixmap.stroke_path(&path.finish().unwrap(), &paint, &stroke, tiny_skia::Transform::identity(), None);
    }
    pixmap.pixels().iter().map(|p| f32::from(p.alpha()) / 255.0).collect()
}

#[test]
fn the_strokes_lie_on_the_ink_of_the_rendering() {
    let body = "<g fill='none' stroke='black' stroke-linecap='round' stroke-linejoin='round' stroke-width='2'>\
        <g transform='translate(50 8) rotate(20) scale(1.5)'><rect width='12' height='9' rx='3'/>\
        <path d='M0 12Q8 20 16 12T30 12' stroke-width='.8'/></g>\
        <circle cx='20' cy='20' r='12'/><path d='M5 60L30 90L40 55Z'/><path d='M50 80h0' stroke-width='6'/>\
        <path d='M60 60C90 50 90 95 60 90' stroke-dasharray='7 5' transform='matrix(1 .2 -.2 1 10 0)'/></g>";
    for size in [100, 333, 800] {
        let options = LoadOptions::default().with(|o| o.size = Some(size));
        let input = load_bytes("a", document(100, 90, body).as_bytes(), &options).unwrap();
        let drawing = input.drawing.unwrap();
        assert_eq!((drawing.width, drawing.height), (input.scan.gray.width() as f64, input.scan.gray.height() as f64));
        let drawn = ink(&drawing);
        let rendered = input.scan.gray.data().iter().map(|v| 1.0 - v);
        let (mut different, mut total) = (0.0, 0.0);
        for (a, b) in drawn.iter().zip(rendered) {
            different += (a - b).abs();
            total += b;
        }
        // Anti-aliasing is as coarse as a sixteenth of a pixel, and edges matter the less the larger the rendering is.
        let bearable = 3.0 / size as f32;
        assert!(total > 100.0 && different / total < bearable, "{size}: {different} of {total}");
    }
}

#[test]
fn the_size_of_the_rendering() {
    let read = |width, height, dpi: Option<f64>, size| {
        let text = document(width, height, "<path d='M0 0L9 5' stroke='black'/>");
        let options = LoadOptions::default().with(|o| {
            o.dpi = dpi.map(Into::into);
            o.size = size;
        });
        let scan = load_bytes(&format!("{width} {height}"), text.as_bytes(), &options).unwrap().scan;
        (scan.gray.size(), scan.dpi.unwrap())
    };
    assert_eq!(read(800, 600, None, None), ((800, 600), 96.0));
    assert_eq!(read(16, 24, None, None), ((342, 512), 2048.0));
    assert_eq!(read(100, 50, Some(300.0), None), ((313, 157), 300.0));
    assert_eq!(read(100, 50, None, Some(1000)), ((1000, 500), 960.0));
    assert_eq!(read(100, 50, Some(300.0), Some(1000)), ((1000, 500), 300.0));
    assert_eq!(read(20_000, 3, None, None).0, (20_000, 3));
    assert_eq!(read(1, 1, None, Some(3)).0, (3, 3));
}

#[test]
fn nothing_visible_is_an_error() {
    for body in [
        "",
        "<path d='M1 1H9' stroke='none' fill='none'/>",
        "<path d='M1 1H9' stroke='white'/><rect width='5' height='5' fill='#fff'/>",
        "<path d='M1 1H9' stroke='black' stroke-opacity='0'/>",
        "<path d='M500 500H900' stroke='black'/>",
        "<image href='/etc/hostname' width='5' height='5'/>",
        "<text x='5' y='5'></text>",
    ] {
        let error = load_bytes("blank.svg", document(9, 9, body).as_bytes(), &LoadOptions::default()).unwrap_err();
        assert!(matches!(error, Error::NothingVisible { .. }), "{body}: {error:?}");
        assert_eq!(error.to_string(), "blank.svg: the SVG has nothing visible");
    }
}

#[test]
fn text_beside_a_stroke_needs_no_fonts() {
    let drawing = strokes("<text x='5' y='20' font-family='No Such Font'>plan</text><path d='M5 50H90'/>");
    assert_eq!(drawing.strokes.iter().filter(|s| s.centreline.start() == Point::new(5.0, 50.0)).count(), 1);
}

#[test]
fn compressed_and_embedded() {
    let text = document(100, 100, "<path d='M1 50H99' stroke='black' stroke-width='4'/>");
    let mut gz = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    gz.write_all(text.as_bytes()).unwrap();
    let options = LoadOptions::default();
    let packed = load_bytes("a.svgz", &gz.finish().unwrap(), &options).unwrap();
    let plain = load_bytes("a.svg", text.as_bytes(), &options).unwrap();
    assert_eq!(packed.scan.gray, plain.scan.gray);
    assert_eq!(packed.drawing, plain.drawing);
    assert!(plain.scan.rgb.is_none());
}
