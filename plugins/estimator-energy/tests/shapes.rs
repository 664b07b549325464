//! The field of shapes whose directions are known.

use fieldtrace::clean::{Decisions, LineImage, Noise, NoiseMap, clean};
use fieldtrace::drawing::{Centreline, Drawing, Segment, Stroke};
use fieldtrace::estimate::FieldEstimator;
use fieldtrace::field::{Frame, FrameField, PolyVectorField};
use fieldtrace::load::Scan;
use fieldtrace::options::Options;
use fieldtrace::raster::{Mask, Raster};
use fieldtrace::render::render;
use fieldtrace_estimator_energy::EnergyEstimator;
use kurbo::{Line, Point, Vec2};

const SIZE: usize = 96;
const CENTER: Point = Point::new(48.3, 47.6);

/// The cleaned picture of some line segments, 5 pixels wide.
fn picture(lines: &[Line]) -> LineImage {
    let mut drawing = Drawing::new(SIZE as f64, SIZE as f64);
    for &line in lines {
        let centreline = Centreline::Path { segments: vec![Segment::Line(line)], closed: false };
        drawing.strokes.push(Stroke::new(centreline, 5.0));
    }
    clean(&Scan { gray: render(&drawing).map(|i| 1.0 - i), rgb: None, dpi: None }, &Options::default())
}

/// An image whose ink is given as it is.
fn bare(ink: Raster<f32>) -> LineImage {
    let mask: Mask = ink.map(|i| i > 0.5);
    let depth = mask.map(|m| f32::from(u8::from(m)));
    LineImage {
        ink,
        solid: mask.map(|_| false),
        mask,
        depth,
        line_width: 3.0,
        scale: 1.0,
        page_scale: 1.0,
        noise: NoiseMap::even(Noise::default()),
        decisions: Decisions::default(),
        blur: 0.0,
        solids: Vec::new(),
        broad: None,
        colors: None,
    }
}

fn through_center(angle: f64) -> Line {
    let half = 38.0 * Vec2::from_angle(angle);
    Line::new(CENTER - half, CENTER + half)
}

fn field(image: &LineImage) -> PolyVectorField {
    EnergyEstimator::default().estimate(image).unwrap()
}

/// Degrees between two directions without signs.
fn apart(a: Vec2, b: Vec2) -> f64 {
    a.cross(b).abs().atan2(a.dot(b).abs()).to_degrees()
}

/// The pixels of the mask with their centres and frames.
fn frames(image: &LineImage) -> Vec<(Point, Frame)> {
    let field = FrameField::new(field(image));
    let all = (0..image.mask.height()).flat_map(|y| (0..image.mask.width()).map(move |x| (x, y)));
    let inked = all.filter(|&pixel| image.mask[pixel]);
    inked.map(|(x, y)| (Point::new(x as f64 + 0.5, y as f64 + 0.5), field.at_pixel(x, y).unwrap())).collect()
}

#[test]
fn a_line_has_its_tangent_and_its_normal() {
    for degrees in (0..180).step_by(10) {
        let u = Vec2::from_angle(f64::from(degrees).to_radians());
        let image = picture(&[through_center(u.atan2())]);
        // Away from the round ends.
        let mut worst = 0.0f64;
        for (p, frame) in frames(&image).into_iter().filter(|(p, _)| p.distance(CENTER) < 30.0) {
            assert!(apart(frame.nearest(u), u) < 1.0, "{degrees} at {p}: {frame:?}");
            let second = apart(frame.nearest(u.turn_90()), u.turn_90());
            worst = worst.max(second);
        }
        assert!(worst < 3.0, "{degrees}: {worst}");
    }
}

#[test]
fn a_circle_is_followed_all_round() {
    let ink = Raster::from_fn(SIZE, SIZE, |x, y| {
        let radius = (Point::new(x as f64 + 0.5, y as f64 + 0.5) - CENTER).hypot();
        (3.0 - (radius - 30.0).abs()).clamp(0.0, 1.0) as f32
    });
    let image = bare(ink);
    let frames = frames(&image);
    let error = |(p, frame): &(Point, Frame)| {
        let tangent = (*p - CENTER).turn_90();
        apart(frame.nearest(tangent), tangent)
    };
    let mean = frames.iter().map(error).sum::<f64>() / frames.len() as f64;
    assert!(mean < 0.6, "{mean}");
    assert!(frames.iter().map(error).fold(0.0, f64::max) < 4.0);
}

#[test]
fn a_crossing_has_both_directions() {
    for degrees in (30..=90).step_by(10) {
        let half = 0.5 * f64::from(degrees).to_radians();
        let (u, v) = (Vec2::from_angle(0.4 - half), Vec2::from_angle(0.4 + half));
        let image = picture(&[through_center(u.atan2()), through_center(v.atan2())]);
        let near = frames(&image).into_iter().filter(|(p, _)| p.distance(CENTER) < 2.5);
        let errors: Vec<f64> =
            near.map(|(_, frame)| apart(frame.nearest(u), u).max(apart(frame.nearest(v), v))).collect();
        let mean = errors.iter().sum::<f64>() / errors.len() as f64;
        // Directions so close are drawn together by the smoothness.
        assert!(mean < if degrees < 40 { 15.0 } else { 5.0 }, "{degrees}: {mean}");
    }
}

#[test]
fn pieces_that_do_not_touch_do_not_matter_to_each_other() {
    let (upper, lower) = (Line::new((10.0, 20.0), (85.0, 31.0)), Line::new((10.0, 70.0), (85.0, 55.0)));
    let (alone, both) = (picture(&[upper]), picture(&[upper, lower]));
    let (alone_field, both_field) = (field(&alone), field(&both));
    for (x, y) in (0..SIZE * SIZE).map(|i| (i % SIZE, i / SIZE)).filter(|&pixel| alone.mask[pixel]) {
        assert_eq!(alone_field.c0()[(x, y)], both_field.c0()[(x, y)]);
        assert_eq!(alone_field.c2()[(x, y)], both_field.c2()[(x, y)]);
    }
}

#[test]
fn an_empty_mask_gives_an_empty_field() {
    let field = field(&bare(Raster::filled(12, 7, 0.0)));
    assert_eq!(field.size(), (12, 7));
    assert!(field.confidence().data().iter().all(|&c| c == 0.0));
}

#[test]
fn single_pixels_and_full_images_have_a_frame() {
    let dots = bare(Raster::from_fn(9, 9, |x, y| if x % 4 == 2 && y % 4 == 2 { 1.0 } else { 0.0 }));
    let full = bare(Raster::filled(6, 5, 1.0));
    for image in [dots, full] {
        let field = field(&image);
        for (inked, confidence) in image.mask.data().iter().zip(field.confidence().data()) {
            assert_eq!(*inked, *confidence > 0.0);
            assert!(*confidence <= 1.0);
        }
        assert_eq!(frames(&image).len(), image.mask.count());
    }
}

#[test]
fn the_number_of_threads_does_not_matter() {
    let image = picture(&[through_center(0.3), through_center(1.2), Line::new((5.0, 90.0), (90.0, 92.0))]);
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| field(&image))
    };
    assert_eq!(with(1), with(3));
}

#[test]
fn weights_out_of_range_are_refused() {
    let image = bare(Raster::filled(3, 3, 1.0));
    let default = EnergyEstimator::default;
    for wrong in [
        EnergyEstimator { smoothness: 0.0, ..default() },
        EnergyEstimator { smoothness: f64::NAN, ..default() },
        EnergyEstimator { grain: -1.0, ..default() },
        EnergyEstimator { normal: 0.0, ..default() },
        EnergyEstimator { normal: 2.0, ..default() },
        EnergyEstimator { accuracy: f64::INFINITY, ..default() },
    ] {
        assert!(matches!(wrong.estimate(&image), Err(fieldtrace::Error::Estimate { .. })));
    }
}
