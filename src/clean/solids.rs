//! Regions far wider than the lines are kept as filled outlines.

use super::distance::distance;
use crate::drawing::{Color, Fill};
use crate::raster::{Mask, Raster};
use contour::ContourBuilder;
use image::Luma;
use imageproc::region_labelling::{Connectivity, connected_components};
use kurbo::{BezPath, Point};

/// A number per pixel: 0 outside, else that of the region.
type Labels = image::ImageBuffer<Luma<u32>, Vec<u32>>;

/// A region is solid when its half width is this many times that of the lines, plus [`MARGIN`].
const FACTOR: f64 = 2.2;
const MARGIN: f64 = 1.5;
/// A region this many times longer than wide is a broad line,
const ELONGATED: f64 = 5.0;
/// unless it is more than this many times as wide as the other lines.
const BROADEST: f64 = 5.0;
/// Ink beside a solid region that is less than this many squares of the line width is its corner, not a line.
const CORNER: f64 = 4.0;

/// Takes the solid regions out of the mask and returns their outlines.
pub(super) fn take(mask: &mut Mask, ink: &Raster<f32>, depth: &Raster<f32>, line_width: f64) -> Vec<Fill> {
    let radius = FACTOR * 0.5 * line_width + MARGIN;
    if !depth.data().iter().any(|&d| f64::from(d) > radius) {
        return Vec::new();
    }
    let mut region = opened(mask, depth, radius);
    absorb_corners(&mut region, mask, line_width);
    let labels = connected_components(&region.to_gray_image(), Connectivity::Eight, Luma([0u8]));
    let count = labels.iter().copied().max().unwrap_or(0) as usize;
    let solid = solid_labels(&labels, count, depth, line_width);
    let boxes = bounding_boxes(&labels, count);
    let fills = (1..=count).filter(|&label| solid[label]).map(|label| {
        let outline = outline(&labels, label as u32, mask, ink, boxes[label]);
        Fill { outline, color: Color::BLACK }
    });
    let fills = fills.collect();
    for (label, ink) in labels.iter().zip(mask.data_mut()) {
        *ink &= !solid[*label as usize];
    }
    fills
}

/// Left, top, right and bottom of each label, the last two excluded.
fn bounding_boxes(labels: &Labels, count: usize) -> Vec<[usize; 4]> {
    let mut boxes = vec![[usize::MAX, usize::MAX, 0, 0]; count + 1];
    for (x, y, label) in labels.enumerate_pixels() {
        let (x, y, b) = (x as usize, y as usize, &mut boxes[label[0] as usize]);
        *b = [b[0].min(x), b[1].min(y), b[2].max(x + 1), b[3].max(y + 1)];
    }
    boxes
}

/// Morphological opening of the mask by a disc, grown back a little so that no rim stays behind.
fn opened(mask: &Mask, depth: &Raster<f32>, radius: f64) -> Mask {
    let to_core = distance(&depth.mapped(false, |d| f64::from(d) <= radius));
    let reach = radius + 1.5;
    Raster::from_rows(mask.width(), mask.height(), false, |y, row| {
        let pixels = row.iter_mut().zip(mask.row(y)).zip(to_core.row(y));
        pixels.for_each(|((opened, &inked), &d)| *opened = inked && f64::from(d) <= reach);
    })
}

/// Sharp corners, which no disc reaches into, go back to their region.
fn absorb_corners(region: &mut Mask, mask: &Mask, line_width: f64) {
    let rest = Raster::from_fn(mask.width(), mask.height(), |x, y| mask[(x, y)] && !region[(x, y)]);
    let labels = connected_components(&rest.to_gray_image(), Connectivity::Eight, Luma([0u8]));
    let count = labels.iter().copied().max().unwrap_or(0) as usize;
    let (mut area, mut touches) = (vec![0usize; count + 1], vec![false; count + 1]);
    for (x, y, label) in labels.enumerate_pixels() {
        let (x, y, label) = (i64::from(x), i64::from(y), label[0] as usize);
        area[label] += 1;
        let near = [(-1, 0), (1, 0), (0, -1), (0, 1)];
        touches[label] |= near.iter().any(|&(dx, dy)| region.get(x + dx, y + dy) == Some(true));
    }
    for (&label, solid) in labels.iter().zip(region.data_mut()) {
        let l = label as usize;
        *solid |= l > 0 && touches[l] && (area[l] as f64) < CORNER * line_width * line_width;
    }
}

/// Which labels are solid regions rather than broad lines of even width.
fn solid_labels(labels: &Labels, count: usize, depth: &Raster<f32>, line_width: f64) -> Vec<bool> {
    let mut area = vec![0usize; count + 1];
    let mut deepest = vec![0f32; count + 1];
    for (&label, &d) in labels.iter().zip(depth.data()) {
        area[label as usize] += 1;
        deepest[label as usize] = deepest[label as usize].max(d);
    }
    let mut solid: Vec<bool> = (0..=count)
        .map(|l| {
            let width = 2.0 * f64::from(deepest[l]) - 1.0;
            (area[l] as f64) < ELONGATED * width * width || width > BROADEST * line_width
        })
        .collect();
    solid[0] = false;
    solid
}

/// The outline of a region: the half-ink contour (marching squares) as closed polygons, holes included.
///
/// The paper's edge pixels around the region take part, for their anti-aliasing; lines that run into it do not.
fn outline(labels: &Labels, label: u32, mask: &Mask, ink: &Raster<f32>, bounds: [usize; 4]) -> BezPath {
    const RIM: i64 = 2;
    let (left, top) = (bounds[0] as i64 - RIM, bounds[1] as i64 - RIM);
    let (width, height) = (bounds[2] - bounds[0] + 2 * RIM as usize, bounds[3] - bounds[1] + 2 * RIM as usize);
    let value = |x: i64, y: i64| -> f64 {
        let Some(is_ink) = mask.get(x, y) else { return 0.0 };
        let own = labels.get_pixel(x as u32, y as u32)[0] == label;
        if own || !is_ink { f64::from(ink[(x as usize, y as usize)].min(1.0)) } else { 0.0 }
    };
    let cells = (0..height as i64).flat_map(|y| (0..width as i64).map(move |x| (x, y)));
    let values: Vec<f64> = cells.map(|(x, y)| value(left + x, top + y)).collect();
    let contours = ContourBuilder::new(width, height, true).contours(&values, &[0.5]).unwrap_or_default();
    let mut path = BezPath::new();
    for polygon in contours.iter().flat_map(|c| c.geometry()) {
        for ring in std::iter::once(polygon.exterior()).chain(polygon.interiors()) {
            let mut points = ring.0.iter().map(|c| Point::new(c.x + left as f64, c.y + top as f64));
            if let Some(first) = points.next() {
                path.move_to(first);
                points.for_each(|p| path.line_to(p));
                path.close_path();
            }
        }
    }
    path
}

#[cfg(test)]
mod tests {
    use super::*;
    use kurbo::Shape;

    #[test]
    fn a_disc_beside_a_line_is_a_fill_of_its_area() {
        let centre = Point::new(60.3, 49.8);
        let ink = Raster::from_fn(160, 100, |x, y| {
            let p = Point::new(x as f64 + 0.5, y as f64 + 0.5);
            let disc = (20.0 - (p - centre).hypot() + 0.5).clamp(0.0, 1.0);
            let line = (1.5 - (p.x - 130.0).abs() + 0.5).clamp(0.0, 1.0);
            disc.max(line) as f32
        });
        let mut mask = ink.map(|i| i > 0.5);
        let depth = distance(&mask);
        let fills = take(&mut mask, &ink, &depth, 3.0);
        assert_eq!(fills.len(), 1);
        let area = fills[0].outline.area().abs();
        assert!((area / (std::f64::consts::PI * 400.0) - 1.0).abs() < 0.01, "{area}");
        let middle = fills[0].outline.bounding_box().center();
        assert!((middle - centre).hypot() < 0.2, "{middle:?}");
        assert!(mask[(130, 50)] && !mask[(60, 50)]);
    }
}
