//! What a network makes of some drawings, as a picture: a row for each with the ink, the true field, the prediction,
//! the difference of the coefficients and the angular error.

use super::validate::{Sheet, angles, coefficients};
use crate::error::Result;
use crate::field::decode;
use crate::write::write_png;
use image::{ImageBuffer, Rgb, RgbImage};
use kurbo::{Point, Vec2};
use num_complex::Complex32;
use std::path::Path;
use tiny_skia::{LineCap, Paint, PathBuilder, Pixmap, Stroke, Transform};

/// Longer side of a panel in pixels, at most; a pixel of the sheet is a whole number of them.
const PANEL: usize = 448;
/// Pixels between panels.
const GAP: usize = 8;
/// What is drawn in full red: a difference of the coefficients, and an angle in degrees.
const WORST: (f32, f64) = (0.5, 10.0);
const U_COLOR: [u8; 3] = [208, 0, 0];
const V_COLOR: [u8; 3] = [0, 80, 208];

/// Draws sheets with their predictions, `[4, height, width]`, to a PNG.
///
/// # Errors
/// [`crate::Error::Write`].
pub fn draw(examples: &[(&Sheet, Vec<f32>)], out: &Path) -> Result<()> {
    let rows: Vec<[RgbImage; 5]> = examples.iter().map(|(sheet, field)| panels(sheet, field)).collect();
    let heights: Vec<usize> = rows.iter().map(|r| r[0].height() as usize + GAP).collect();
    let width = rows.iter().map(|r| 5 * (r[0].width() as usize + GAP)).max().unwrap_or(1);
    let mut whole = ImageBuffer::from_pixel(width as u32, heights.iter().sum::<usize>().max(1) as u32, Rgb([255; 3]));
    let mut y = 0;
    for (row, height) in rows.iter().zip(heights) {
        for (i, panel) in row.iter().enumerate() {
            image::imageops::replace(&mut whole, panel, (i * (panel.width() as usize + GAP)) as i64, y);
        }
        y += height as i64;
    }
    write_png(out, &whole.into())
}

fn panels(sheet: &Sheet, field: &[f32]) -> [RgbImage; 5] {
    let truth = &sheet.truth;
    let (width, height) = truth.place.size();
    let stride = sheet.ink.width();
    let scale = (PANEL / width.max(height)).max(1);
    let of_truth = |i: usize| [truth.field.c0().data()[i], truth.field.c2().data()[i]];
    let of_network = |i: usize| coefficients(field, i / width * stride + i % width);
    let heat = |i: usize, share: f64| {
        let faded = (255.0 * (1.0 - share.clamp(0.0, 1.0))) as u8;
        if truth.ink.data()[i] { Rgb([255, faded, faded]) } else { Rgb([216; 3]) }
    };
    let shown = |color: &dyn Fn(usize) -> Rgb<u8>| {
        RgbImage::from_fn((width * scale) as u32, (height * scale) as u32, |x, y| {
            color(y as usize / scale * width + x as usize / scale)
        })
    };
    let ink = shown(&|i| Rgb([(255.0 * (1.0 - sheet.ink[(i % width, i / width)])) as u8; 3]));
    let difference = shown(&|i| {
        let [a, b] = of_network(i);
        let [c, d] = of_truth(i);
        heat(i, f64::from(((a - c).norm_sqr() + (b - d).norm_sqr()).sqrt() / WORST.0))
    });
    let error = shown(&|i| heat(i, angles(of_network(i), truth, i).0.to_degrees() / WORST.1));
    let crosses = |coefficients: &dyn Fn(usize) -> [Complex32; 2]| {
        let inked = (0..width * height).filter(|&i| truth.ink.data()[i]);
        let frames = inked.filter_map(|i| {
            let [c0, c2] = coefficients(i);
            let frame = decode(c0, c2)?;
            Some((Point::new((i % width) as f64 + 0.5, (i / width) as f64 + 0.5), [frame.u, frame.v]))
        });
        ticks(frames, (width, height), scale)
    };
    [ink, crosses(&of_truth), crosses(&of_network), difference, error]
}

/// Both directions at each pixel as a cross of its size.
fn ticks(frames: impl Iterator<Item = (Point, [Vec2; 2])>, size: (usize, usize), scale: usize) -> RgbImage {
    let (width, height) = ((size.0 * scale) as u32, (size.1 * scale) as u32);
    let mut builders = [PathBuilder::new(), PathBuilder::new()];
    for (center, directions) in frames {
        for (builder, direction) in builders.iter_mut().zip(directions) {
            let [a, b] = [-0.45, 0.45].map(|t| (center + t * direction).to_vec2() * scale as f64);
            builder.move_to(a.x as f32, a.y as f32);
            builder.line_to(b.x as f32, b.y as f32);
        }
    }
    let Some(mut pixmap) = Pixmap::new(width, height) else { return RgbImage::new(width, height) };
    pixmap.fill(tiny_skia::Color::WHITE);
    let pen = Stroke { width: 0.18 * scale as f32, line_cap: LineCap::Round, ..Stroke::default() };
    for (builder, [r, g, b]) in builders.into_iter().zip([U_COLOR, V_COLOR]).rev() {
        let mut paint = Paint { anti_alias: true, ..Paint::default() };
        paint.set_color_rgba8(r, g, b, 255);
        if let Some(path) = builder.finish() {
            pixmap.stroke_path(&path, &paint, &pen, Transform::identity(), None);
        }
    }
    RgbImage::from_fn(width, height, |x, y| {
        pixmap.pixel(x, y).map_or(Rgb([255; 3]), |p| Rgb([p.red(), p.green(), p.blue()]))
    })
}
