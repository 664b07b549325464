//! A rendering beside its true field: `cargo run --release --features train --example truth -- OUT.png`.

use fieldtrace::drawing::{Centreline, Drawing, Segment, Stroke};
use fieldtrace::ground_truth;
use fieldtrace::inspect::{field_overlay, to_png};
use fieldtrace::load::Scan;
use fieldtrace::render::render;
use image::{RgbaImage, imageops};
use kurbo::{Circle, CubicBez, Line};

/// Two lines that cross, a branch, a corner, a curve, and a circle that touches a line.
fn drawing() -> Drawing {
    let line = |a: (f64, f64), b: (f64, f64)| Segment::Line(Line::new(a, b));
    let path = |segments| Centreline::Path { segments, closed: false };
    let centrelines = [
        path(vec![line((6.0, 50.0), (90.0, 14.0))]),
        path(vec![line((10.0, 12.0), (58.0, 60.0)), line((58.0, 60.0), (88.0, 60.0))]),
        path(vec![Segment::Cubic(CubicBez::new((66.0, 24.3), (60.0, 40.0), (84.0, 40.0), (78.0, 60.0)))]),
        Centreline::Circle(Circle::new((22.0, 58.0), 15.0)),
    ];
    let mut drawing = Drawing::new(96.0, 76.0);
    drawing.strokes = centrelines.map(|centreline| Stroke::new(centreline, 4.0)).into();
    drawing.scaled(0.75)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let out = std::env::args().nth(1).unwrap_or_else(|| "samples/paper/truth.png".into());
    let drawing = drawing();
    let scan = Scan { gray: render(&drawing).map(|i| 1.0 - i), rgb: None, dpi: None };
    let field = image::load_from_memory(&to_png(&field_overlay(&scan, &ground_truth::field(&drawing).field))?)?;
    let field = field.to_rgba8();
    let scale = field.width() / scan.gray.width() as u32;
    let ink = RgbaImage::from_fn(field.width(), field.height(), |x, y| {
        let (x, y) = ((x / scale) as usize, (y / scale) as usize);
        let light = scan.gray.get(x as i64, y as i64).unwrap_or(1.0);
        let gray = (255.0 * light) as u8;
        image::Rgba([gray, gray, gray, 255])
    });
    let mut both = RgbaImage::new(2 * field.width(), field.height());
    imageops::replace(&mut both, &ink, 0, 0);
    imageops::replace(&mut both, &field, i64::from(field.width()), 0);
    both.save(out)?;
    Ok(())
}
