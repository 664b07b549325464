//! Traces a drawing under a field of the caller's own and refuses short lines.
//!
//! `cargo run --release --example hook`

use fieldtrace::clean::LineImage;
use fieldtrace::drawing::{Centreline, Drawing, Segment, Stroke};
use fieldtrace::field::PolyVectorField;
use fieldtrace::hooks::Observer;
use fieldtrace::load::Scan;
use fieldtrace::options::Options;
use fieldtrace::pipeline::Vectorizer;
use fieldtrace::render::render;
use fieldtrace::streamline::Streamline;
use kurbo::{Line, Point, Vec2};

const SIZE: usize = 128;
const CENTER: Point = Point::new(64.0, 64.0);

/// A cross whose bars meet at 60 degrees, and a short dash that is not wanted.
fn picture() -> Scan {
    let mut drawing = Drawing::new(SIZE as f64, SIZE as f64);
    let (u, v) = directions();
    for (center, half) in [(CENTER, 50.0 * u), (CENTER, 50.0 * v), (Point::new(20.0, 64.0), Vec2::new(4.0, 0.0))] {
        let segments = vec![Segment::Line(Line::new(center - half, center + half))];
        let centreline = Centreline::Path { segments, closed: false };
        drawing.strokes.push(Stroke::new(centreline, 4.0));
    }
    Scan { gray: render(&drawing).map(|ink| 1.0 - ink), rgb: None, dpi: None }
}

/// The directions of the two bars.
fn directions() -> (Vec2, Vec2) {
    (Vec2::from_angle(60f64.to_radians()), Vec2::from_angle(120f64.to_radians()))
}

/// What the caller knows better than any estimator: near the middle the ink goes two ways, and elsewhere
/// the way of its own bar. On a single line the second direction is the normal.
fn own_field() -> PolyVectorField {
    let (u, v) = directions();
    PolyVectorField::from_directions(SIZE, SIZE, |x, y| {
        let from_center = Point::new(x as f64 + 0.5, y as f64 + 0.5) - CENTER;
        let (off_u, off_v) = (from_center.cross(u).abs(), from_center.cross(v).abs());
        match (off_u < 4.0, off_v < 4.0) {
            (true, true) => Some((u, v)),
            (true, false) => Some((u, u.turn_90())),
            (false, true) => Some((v, v.turn_90())),
            (false, false) if from_center.y.abs() < 6.0 => Some((Vec2::new(1.0, 0.0), Vec2::new(0.0, 1.0))),
            (false, false) => None,
        }
    })
}

/// Drops streamlines of under 20 pixels of the line image.
struct NoShortLines {
    dropped: usize,
}

impl Observer for NoShortLines {
    fn on_streamline(&mut self, image: &LineImage, streamline: &mut Streamline) -> fieldtrace::Result<bool> {
        let length: f64 = streamline.points.windows(2).map(|p| p[0].distance(p[1])).sum();
        let keep = length >= 20.0 * image.scale;
        self.dropped += usize::from(!keep);
        Ok(keep)
    }
}

fn main() -> fieldtrace::Result<()> {
    let vectorizer = Vectorizer::new(Options::default())?;
    let mut observer = NoShortLines { dropped: 0 };
    let drawing = vectorizer.trace_with_field(&picture(), &own_field(), &mut observer)?;
    println!("{} short streamlines dropped", observer.dropped);
    for stroke in &drawing.strokes {
        let (start, end) = (stroke.centreline.start(), stroke.centreline.end());
        println!("({:.1}, {:.1}) to ({:.1}, {:.1}), {:.1} wide", start.x, start.y, end.x, end.y, stroke.width);
    }
    Ok(())
}
