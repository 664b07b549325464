//! The page that is traced: a megapixel with sixteen drawings of lines 3.5 pixels wide.

use crate::common::draw::{arc, circle, cubic, line, scan, sheet};
use fieldtrace::cancel::Cancel;
use fieldtrace::clean::{LineImage, clean};
use fieldtrace::estimate::{FieldEstimator, StructureTensor};
use fieldtrace::field::FrameField;
use fieldtrace::graph::{StrokeGraph, build};
use fieldtrace::load::Scan;
use fieldtrace::options::Options;
use fieldtrace::streamline::{Streamline, trace};

/// Side of the page in pixels.
pub const SIDE: usize = 1000;
/// Side of a drawing, of which there are sixteen.
const MOTIF: usize = SIDE / 4;

/// The page.
pub fn page() -> Scan {
    let mut strokes = Vec::new();
    for k in 0..16 {
        let (x, y) = ((k % 4 * MOTIF) as f64, (k / 4 * MOTIF) as f64);
        let at = |dx: f64, dy: f64| (x + dx, y + dy);
        strokes.push(circle(at(90.0, 90.0), 55.0 + k as f64, 3.5));
        strokes.push(line(at(20.0, 200.0), at(225.0, 30.0 + 5.0 * k as f64), 3.5));
        strokes.push(arc(at(150.0, 150.0), 70.0, 0.3 * k as f64, 3.0, 3.5));
        strokes.push(cubic([at(25.0, 120.0), at(100.0, 240.0), at(140.0, -20.0), at(225.0, 150.0)], 3.5));
        strokes.push(line(at(30.0, 225.0), at(220.0, 225.0), 3.5));
    }
    scan(&sheet(SIDE, SIDE, strokes))
}

/// The page, cleaned.
pub fn image() -> LineImage {
    clean(&page(), &Options::default())
}

/// The directions on the page.
pub fn frames(image: &LineImage) -> FrameField {
    FrameField::new(StructureTensor::default().estimate(image).expect("a field for any image"))
}

/// The streamlines of the page.
pub fn streamlines(image: &LineImage) -> Vec<Streamline> {
    trace(image, &frames(image), &Cancel::default()).expect("nobody cancels")
}

/// The stroke graph of the page.
pub fn graph(image: &LineImage) -> StrokeGraph {
    build(image, &streamlines(image), &Options::default(), &Cancel::default()).expect("nobody cancels")
}
