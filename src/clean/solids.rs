//! Regions far wider than the lines: strokes of a broad pen are lines of their own, others are kept as filled outlines.

use super::distance::distance;
use super::width::ridge_pixels;
use crate::drawing::{Color, Fill};
use crate::raster::{Mask, Raster};
use contour::ContourBuilder;
use image::Luma;
use imageproc::region_labelling::{Connectivity, connected_components};
use kurbo::{BezPath, Point};

/// A number per pixel: 0 outside, else that of the region.
type Labels = image::ImageBuffer<Luma<u32>, Vec<u32>>;

/// A region is wider than a line, or two side by side, when its half width is this many times that of the lines, plus
/// [`MARGIN`].
const FACTOR: f64 = 2.2;
const MARGIN: f64 = 1.5;
/// A region this many times longer than wide is a broad line if it is even: a disc of this share of its half width comes
/// everywhere,
const ELONGATED: f64 = 5.0;
const EVEN: f64 = 0.8;
/// but for so many squares of its half width, corners of its ends, and this share of its area.
const CORNERS: f64 = 1.5;
const UNEVEN: f64 = 0.03;
/// Nor is more of its ridge than this share, where broad lines cross, this many times as deep and half a pixel.
const DEEPER_SHARE: f64 = 0.1;
const DEEPER: f64 = 1.15;
/// Broad lines are looked for where at least this share of the ridge is as deep.
const BROAD_SHARE: f64 = 0.02;
/// An elongated region is solid only if it is more than this many times as wide as the other lines.
const BROADEST: f64 = 5.0;
/// A region is a knot where lines meet, and no solid, if they leave it over more than this share of its rim.
const KNOT: f64 = 0.33;
/// A region of at most a width that was asked for is a line if it has this many squares of its width.
const LONGER: f64 = 2.0;
/// Ink beside a solid region that is less than this many squares of the line width is its corner, not a line.
const CORNER: f64 = 4.0;

/// How deep the rim of a solid region is, whose ink lines run into, in pixels: an end is looked at within a pixel of it.
const RIM: f32 = 2.0;

/// Half the width, in pixels, from which ink is not a line of a width.
pub(super) fn half_width_of_wide(line_width: f64) -> f64 {
    FACTOR * 0.5 * line_width + MARGIN
}

/// Takes broad lines out of the mask and returns where they are; `None` where there are none. `widest` is half the width up to
/// which all ink is a line, where that is given.
pub(super) fn take_broad(mask: &mut Mask, depth: &Raster<f32>, line_width: f64, widest: Option<f64>) -> Option<Mask> {
    let radius = half_width_of_wide(line_width);
    if !is_deeper(depth, radius) {
        return None;
    }
    let ridge = ridge_pixels(mask, depth);
    let deep = ridge.iter().filter(|&&p| f64::from(depth[p]) > radius).count();
    if widest.is_none() && (deep as f64) < BROAD_SHARE * ridge.len() as f64 {
        return None;
    }
    let (region, labels, count) = regions(mask, depth, radius, line_width);
    let (mut is_broad, uneven) = broad_labels(&region, &labels, count, depth);
    if let Some(widest) = widest {
        is_broad = within(&labels, count, depth, widest);
    }
    if !is_broad.contains(&true) {
        return None;
    }
    let of_line = |x: usize, y: usize| is_broad[labels.get_pixel(x as u32, y as u32)[0] as usize];
    let broad = Raster::from_fn(mask.width(), mask.height(), |x, y| of_line(x, y) && !uneven[(x, y)]);
    labels.iter().zip(mask.data_mut()).for_each(|(label, ink)| *ink &= !is_broad[*label as usize]);
    Some(broad)
}

/// Takes the solid regions out of the mask, and their ink with them: it is no line's. Their pixels and their outlines. `widest`
/// is half the width from which all ink is solid, where that is given.
pub(super) fn take(
    mask: &mut Mask,
    ink: &mut Raster<f32>,
    depth: &Raster<f32>,
    line_width: f64,
    widest: Option<f64>,
) -> (Mask, Vec<Fill>) {
    let radius = half_width_of_wide(line_width).min(widest.unwrap_or(f64::INFINITY) + 0.5);
    if !is_deeper(depth, radius) {
        return (Raster::zeroed(mask.width(), mask.height()), Vec::new());
    }
    let (_, labels, count) = regions(mask, depth, radius, line_width);
    let mut solid = match widest {
        Some(_) => (0..=count).map(|label| label > 0).collect(),
        None => solid_labels(&labels, count, depth, line_width),
    };
    if widest.is_none() {
        let knots = knots(&labels, count, mask);
        solid.iter_mut().zip(knots).for_each(|(solid, knot)| *solid &= !knot);
    }
    let boxes = bounding_boxes(&labels, count);
    let fills = (1..=count).filter(|&label| solid[label]).map(|label| {
        let outline = outline(&labels, label as u32, mask, ink, boxes[label]);
        Fill { outline, color: Color::BLACK }
    });
    let fills = fills.collect();
    let region =
        Raster::from_fn(mask.width(), mask.height(), |x, y| solid[labels.get_pixel(x as u32, y as u32)[0] as usize]);
    mask.data_mut().iter_mut().zip(region.data()).for_each(|(ink, solid)| *ink &= !solid);
    take_ink(ink, &region);
    (region, fills)
}

/// Takes the ink of a region but for its rim, on which lines end.
fn take_ink(ink: &mut Raster<f32>, region: &Mask) {
    let depth = distance(region);
    ink.data_mut().iter_mut().zip(depth.data()).filter(|(_, d)| **d > RIM).for_each(|(ink, _)| *ink = 0.0);
}

/// Whether the ink is deeper than a radius somewhere.
fn is_deeper(depth: &Raster<f32>, radius: f64) -> bool {
    depth.data().iter().any(|&d| f64::from(d) > radius)
}

/// The regions into which a disc of a radius fits, with their corners: their pixels, the number of each, and how many.
fn regions(mask: &Mask, depth: &Raster<f32>, radius: f64, line_width: f64) -> (Mask, Labels, usize) {
    let mut region = opened(mask, depth, radius);
    absorb_corners(&mut region, mask, line_width);
    let labels = connected_components(&region.to_gray_image(), Connectivity::Eight, Luma([0u8]));
    let count = labels.iter().copied().max().unwrap_or(0) as usize;
    (region, labels, count)
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

/// Which labels are long lines of even width, and the pixels of all that are not even: where other lines end at them.
fn broad_labels(region: &Mask, labels: &Labels, count: usize, depth: &Raster<f32>) -> (Vec<bool>, Mask) {
    let label = |x: usize, y: usize| labels.get_pixel(x as u32, y as u32)[0] as usize;
    let (mut ridge, mut area, mut lost) = (vec![Vec::new(); count + 1], vec![0.0; count + 1], vec![0.0; count + 1]);
    for (x, y) in ridge_pixels(region, depth) {
        ridge[label(x, y)].push(f64::from(depth[(x, y)]));
    }
    ridge.iter_mut().for_each(|depths| depths.sort_by(f64::total_cmp));
    let quantile =
        |q: f64| move |depths: &Vec<f64>| depths.get((depths.len() as f64 * q) as usize).copied().unwrap_or(0.0);
    let half: Vec<f64> = ridge.iter().map(quantile(0.5)).collect();
    let deeper: Vec<f64> = ridge.iter().map(quantile(1.0 - DEEPER_SHARE)).collect();
    let disc = |x: usize, y: usize| EVEN * half[label(x, y)];
    let is_core = |x: usize, y: usize| region[(x, y)] && f64::from(depth[(x, y)]) > disc(x, y);
    let to_core = distance(&Raster::from_fn(region.width(), region.height(), |x, y| !is_core(x, y)));
    let uneven = |x: usize, y: usize| region[(x, y)] && f64::from(to_core[(x, y)]) > disc(x, y) + 1.0;
    let uneven = Raster::from_fn(region.width(), region.height(), uneven);
    for (l, &uneven) in labels.iter().zip(uneven.data()) {
        area[*l as usize] += 1.0;
        lost[*l as usize] += f64::from(uneven);
    }
    let is_broad = |l: usize| {
        let (half, deeper) = (half[l], deeper[l]);
        let long = area[l] >= ELONGATED * (2.0 * half - 1.0).powi(2);
        l > 0 && long && lost[l] <= CORNERS * half * half + UNEVEN * area[l] && deeper <= DEEPER * half + 0.5
    };
    ((0..=count).map(is_broad).collect(), uneven)
}

/// Which labels are solid regions rather than lines somewhat broader than the others.
fn solid_labels(labels: &Labels, count: usize, depth: &Raster<f32>, line_width: f64) -> Vec<bool> {
    let mut area = vec![0usize; count + 1];
    labels.iter().for_each(|&label| area[label as usize] += 1);
    let deepest = deepest(labels, count, depth);
    let mut solid: Vec<bool> = (0..=count)
        .map(|l| {
            let width = 2.0 * f64::from(deepest[l]) - 1.0;
            (area[l] as f64) < ELONGATED * width * width || width > BROADEST * line_width
        })
        .collect();
    solid[0] = false;
    solid
}

/// Which labels are no wider than asked and longer than wide, so that a line can be drawn of them.
fn within(labels: &Labels, count: usize, depth: &Raster<f32>, widest: f64) -> Vec<bool> {
    let mut area = vec![0usize; count + 1];
    labels.iter().for_each(|&label| area[label as usize] += 1);
    let is_line = |(l, d): (usize, f32)| {
        let width = 2.0 * f64::from(d) - 1.0;
        l > 0 && f64::from(d) <= widest + 0.5 && area[l] as f64 >= LONGER * width * width
    };
    deepest(labels, count, depth).into_iter().enumerate().map(is_line).collect()
}

/// The greatest depth of each label.
fn deepest(labels: &Labels, count: usize, depth: &Raster<f32>) -> Vec<f32> {
    let mut deepest = vec![0f32; count + 1];
    for (&label, &d) in labels.iter().zip(depth.data()) {
        deepest[label as usize] = deepest[label as usize].max(d);
    }
    deepest[0] = 0.0;
    deepest
}

/// Which labels have rims that are mostly ink of lines that leave there.
fn knots(labels: &Labels, count: usize, mask: &Mask) -> Vec<bool> {
    let (mut rim, mut inked) = (vec![0usize; count + 1], vec![0usize; count + 1]);
    for (x, y, label) in labels.enumerate_pixels().filter(|(_, _, label)| label[0] > 0) {
        for (dx, dy) in [(-1, 0), (1, 0), (0, -1), (0, 1)] {
            let (x, y) = (i64::from(x) + dx, i64::from(y) + dy);
            // The page's edge is no rim.
            let Some(ink) = mask.get(x, y) else { continue };
            if labels.get_pixel(x as u32, y as u32)[0] == 0 {
                rim[label[0] as usize] += 1;
                inked[label[0] as usize] += usize::from(ink);
            }
        }
    }
    rim.iter().zip(inked).map(|(&rim, inked)| inked as f64 > KNOT * rim as f64).collect()
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
        let mut ink = Raster::from_fn(160, 100, |x, y| {
            let p = Point::new(x as f64 + 0.5, y as f64 + 0.5);
            let disc = (20.0 - (p - centre).hypot() + 0.5).clamp(0.0, 1.0);
            let line = (1.5 - (p.x - 130.0).abs() + 0.5).clamp(0.0, 1.0);
            disc.max(line) as f32
        });
        let mut mask = ink.map(|i| i > 0.5);
        let depth = distance(&mask);
        let (solid, fills) = take(&mut mask, &mut ink, &depth, 3.0, None);
        assert_eq!(fills.len(), 1);
        let area = fills[0].outline.area().abs();
        assert!((area / (std::f64::consts::PI * 400.0) - 1.0).abs() < 0.01, "{area}");
        let middle = fills[0].outline.bounding_box().center();
        assert!((middle - centre).hypot() < 0.2, "{middle:?}");
        assert!(mask[(130, 50)] && !mask[(60, 50)]);
        assert!(!solid[(130, 50)] && solid[(60, 50)]);
        assert!(ink[(130, 50)] > 0.9 && (44..77).all(|x| ink[(x, 50)] == 0.0) && ink[(41, 50)] > 0.9);
    }
}
