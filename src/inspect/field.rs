//! Ink and field.

use super::overlay::{DECIMALS, Overlay, embedded, entry, png_scale};
use crate::clean::LineImage;
use crate::field::{Frame, FrameField, PolyVectorField};
use crate::load::Scan;
use crate::raster::Raster;
use crate::write::Rounding;
use image::{DynamicImage, Rgb, RgbImage, Rgba, RgbaImage};
use kurbo::{Point, Vec2};
use std::fmt::Write;
use svg::node::element::{Group, Path};

/// Most frames that are drawn; beyond it, the grid of drawn pixels gets coarser.
const MOST_TICKS: usize = 30_000;
/// Pixels of the PNG that a tick should have, and the coarsest grid that it may cost.
const TICK_LENGTH: f64 = 8.0;
const COARSEST: f64 = 3.0;
/// Steps of confidence that can be told apart.
const SHADES: usize = 4;
const U_COLOR: &str = "#d00000";
const V_COLOR: &str = "#0050d0";

/// A coverage by ink, 0 to 1, as a picture: black where all of a pixel is covered.
pub fn coverage_picture(coverage: &Raster<f32>) -> DynamicImage {
    DynamicImage::ImageLuma8(coverage.map(|c| (255.0 * (1.0 - c).clamp(0.0, 1.0)).round() as u8).into_image())
}

/// What cleaning made of a scan, a whole number of times the size of the line image: ink of lines in black, solid regions in
/// orange, and ink that was thrown away in pale blue.
pub fn ink_picture(image: &LineImage) -> RgbImage {
    let (width, height) = image.ink.size();
    let solid = solid_coverage(image);
    let scale = png_scale(width as f64, height as f64) as usize;
    RgbImage::from_fn((width * scale) as u32, (height * scale) as u32, |x, y| {
        let at = (x as usize / scale, y as usize / scale);
        if image.mask[at] {
            Rgb([0, 0, 0])
        } else if solid.as_ref().is_some_and(|s| s[at]) {
            Rgb([240, 140, 0])
        } else {
            let faint = (110.0 * image.ink[at].clamp(0.0, 1.0)) as u8;
            Rgb([255 - faint, 255 - faint, 255])
        }
    })
}

/// The pixels inside solid regions; `None` where there are none.
fn solid_coverage(image: &LineImage) -> Option<Raster<bool>> {
    let (width, height) = image.ink.size();
    let mut drawing = crate::drawing::Drawing::new(width as f64, height as f64);
    drawing.fills = image.solids.clone();
    (!drawing.fills.is_empty()).then(|| crate::render::render(&drawing).map(|c| c > 0.5))
}

/// The two directions as ticks on a grid of ink pixels, `u` red and `v` blue, over a shade of confidence;
/// the field may have any size over the same picture.
pub fn field_overlay(scan: &Scan, field: &PolyVectorField) -> String {
    let mut overlay = Overlay::over(scan);
    let (width, height) = overlay.size();
    let defined = field.confidence().data().iter().filter(|&&c| c > 0.0).count();
    if width * height > 0.0 && defined > 0 {
        overlay.add(embedded(&DynamicImage::ImageRgba8(shade(field)), width, height));
        let pixel = width / field.size().0 as f64;
        let seen = (TICK_LENGTH / (png_scale(width, height) * pixel)).clamp(1.0, COARSEST);
        let step = (defined as f64 / MOST_TICKS as f64).sqrt().max(seen).ceil() as usize;
        overlay.add(ticks(field, step, pixel));
    }
    overlay.finish(&[
        entry(U_COLOR, "u, the stronger root"),
        entry(V_COLOR, "v, the weaker root"),
        entry("#ffc800", format!("confidence, {defined} pixels")),
    ])
}

/// Confidence as an amber veil.
fn shade(field: &PolyVectorField) -> RgbaImage {
    let (width, height) = field.size();
    RgbaImage::from_fn(width as u32, height as u32, |x, y| {
        let confidence = field.confidence()[(x as usize, y as usize)];
        Rgba([255, 200, 0, (120.0 * confidence) as u8])
    })
}

/// Ticks as one path for each root and shade of confidence.
fn ticks(field: &PolyVectorField, step: usize, pixel: f64) -> Group {
    let frames = FrameField::new(field.clone());
    let mut paths = [const { [const { String::new() }; SHADES] }; 2];
    let (width, height) = field.size();
    for y in (0..height).step_by(step) {
        for x in (0..width).step_by(step) {
            let Some(Frame { u, v }) = frames.at_pixel(x, y) else { continue };
            let confidence = field.confidence()[(x, y)];
            let shade = ((confidence * SHADES as f32) as usize).min(SHADES - 1);
            let center = Point::new(x as f64 + 0.5, y as f64 + 0.5);
            for (path, direction) in paths.iter_mut().zip([u, v]) {
                tick(&mut path[shade], center, 0.42 * step as f64 * direction, pixel);
            }
        }
    }
    let width = Rounding::new(DECIMALS).text(0.14 * step as f64 * pixel);
    let mut group = Group::new().set("fill", "none").set("stroke-width", width).set("stroke-linecap", "round");
    for (path, color) in paths.into_iter().zip([U_COLOR, V_COLOR]).rev() {
        for (shade, data) in path.into_iter().enumerate().filter(|(_, data)| !data.is_empty()) {
            let opacity = 0.25 + 0.75 * (shade + 1) as f64 / SHADES as f64;
            group = group.add(Path::new().set("d", data).set("stroke", color).set("opacity", opacity));
        }
    }
    group
}

fn tick(data: &mut String, center: Point, half: Vec2, pixel: f64) {
    let exact = Rounding::new(DECIMALS);
    let text = |p: Point| format!("{} {}", exact.text(p.x * pixel), exact.text(p.y * pixel));
    let _ = write!(data, "M{}L{}", text(center - half), text(center + half));
}
