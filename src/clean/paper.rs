//! The lightness of the paper, which uneven light makes a smooth function of place.

use super::smooth;
use crate::raster::{Raster, between};

/// Side of the cells in which paper is measured, in pixels: several line widths, so that most of a cell is paper.
const CELL: usize = 16;
/// Darker than this share of the page's lightest paper is not paper but a solid region.
const SOLID_SHARE: f32 = 0.6;

/// Paper lightness on a coarse grid of one sample per [`CELL`] x [`CELL`] pixels.
pub(super) struct Paper(Raster<f32>);

/// Measures the paper: an upper quantile per cell, solid regions bridged, smoothed.
pub(super) fn paper_level(light: &Raster<f32>) -> Paper {
    let [paper] = paper_levels([light]);
    paper
}

/// Measures the paper in several channels: a region that is solid in one of them is paper in none.
pub(super) fn paper_levels<const N: usize>(channels: [&Raster<f32>; N]) -> [Paper; N] {
    let cells = channels.map(cell_levels);
    let lightest = cells.each_ref().map(|cells| {
        let mut sorted = cells.data().to_vec();
        sorted.sort_by(f32::total_cmp);
        sorted[(sorted.len() - 1) * 9 / 10].max(1e-3)
    });
    let (columns, rows) = cells[0].size();
    let is_paper = Raster::from_fn(columns, rows, |x, y| {
        cells.iter().zip(lightest).all(|(cells, lightest)| cells[(x, y)] > SOLID_SHARE * lightest)
    });
    // Normalised convolution: cells that are not paper take their neighbours' level.
    let weight = smooth(is_paper.map(|is_paper| if is_paper { 1.0 } else { 1e-4 }), 1.2);
    std::array::from_fn(|c| {
        let weighted = smooth(
            Raster::from_fn(columns, rows, |x, y| if is_paper[(x, y)] { cells[c][(x, y)] } else { lightest[c] * 1e-4 }),
            1.2,
        );
        Paper(Raster::from_fn(columns, rows, |x, y| weighted[(x, y)] / weight[(x, y)]))
    })
}

/// The upper quantile of each cell.
fn cell_levels(light: &Raster<f32>) -> Raster<f32> {
    Raster::from_rows(light.width().div_ceil(CELL), light.height().div_ceil(CELL), 0.0, |cy, row| {
        let mut values = Vec::new();
        row.iter_mut()
            .enumerate()
            .for_each(|(cx, cell)| *cell = cell_quantile(light, cx * CELL, cy * CELL, &mut values));
    })
}

/// Upper quantile of one cell, taken over twice the cell so that neighbours agree. `values` is room to work in.
fn cell_quantile(light: &Raster<f32>, x0: usize, y0: usize, values: &mut Vec<f32>) -> f32 {
    let half = CELL / 2;
    let (left, right) = (x0.saturating_sub(half), (x0 + CELL + half).min(light.width()));
    let (top, bottom) = (y0.saturating_sub(half), (y0 + CELL + half).min(light.height()));
    values.clear();
    values.extend((top..bottom).step_by(2).flat_map(|y| light.row(y)[left..right].iter().step_by(2).copied()));
    let k = (values.len() - 1) * 4 / 5;
    // On a clean page the lightest value is nearly all there is.
    let lightest = values.iter().copied().fold(f32::MIN, f32::max);
    if values.iter().filter(|&&v| v == lightest).count() >= values.len() - k {
        return lightest;
    }
    *values.select_nth_unstable_by(k, f32::total_cmp).1
}

/// Ink as the share of light that the paper's level has lost, 0 to 1.
pub(super) fn divide(light: &Raster<f32>, paper: &Paper) -> Raster<f32> {
    let grid = &paper.0;
    let spread = |v: &[f32]| v.iter().fold((f32::MAX, f32::MIN), |(a, b), &x| (a.min(x), b.max(x)));
    let (low, high) = spread(grid.data());
    if high - low < 2.0 / 255.0 {
        let level = high.max(1e-3);
        return light.mapped(0.0, |g| (1.0 - g / level).clamp(0.0, 1.0));
    }
    // Bilinear: along the rows of the grid first.
    let rows = Raster::from_rows(light.width(), grid.height(), 0.0, |cell, row| {
        for (x, level) in row.iter_mut().enumerate() {
            let (i, next, t) = between(x, CELL, grid.width());
            *level = mix(grid[(i, cell)], grid[(next, cell)], t);
        }
    });
    Raster::from_rows(light.width(), light.height(), 0.0, |y, row| {
        let (i, next, t) = between(y, CELL, grid.height());
        for ((ink, &g), (&a, &b)) in row.iter_mut().zip(light.row(y)).zip(rows.row(i).iter().zip(rows.row(next))) {
            *ink = (1.0 - g / mix(a, b, t).max(1e-3)).clamp(0.0, 1.0);
        }
    })
}

fn mix(a: f32, b: f32, t: f32) -> f32 {
    a + (b - a) * t
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uneven_light_divides_away() {
        let shade = |x: usize, y: usize| 0.9 - 0.3 * (x as f32 / 200.0) - 0.1 * (y as f32 / 150.0);
        let line = |y: usize| (70..73).contains(&y);
        let light = Raster::from_fn(200, 150, |x, y| if line(y) { 0.3 * shade(x, y) } else { shade(x, y) });
        let ink = divide(&light, &paper_level(&light));
        // An upper quantile of a sloping cell lies above its middle.
        for y in 10..140 {
            for x in 10..190 {
                let expected = if line(y) { 0.7 } else { 0.0 };
                assert!((ink[(x, y)] - expected).abs() < 0.06, "({x}, {y}): {}", ink[(x, y)]);
            }
        }
    }

    #[test]
    fn a_large_solid_is_not_paper() {
        let light =
            Raster::from_fn(300, 300, |x, y| if (90..210).contains(&x) && (90..210).contains(&y) { 0.1 } else { 1.0 });
        let ink = divide(&light, &paper_level(&light));
        assert!(ink[(150, 150)] > 0.8);
        assert!(ink[(20, 20)] < 0.01);
    }
}
