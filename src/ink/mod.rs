//! What of a page is drawing: shadows, stains, ruling and whatever else lies beside the ink is taken off before anything
//! is measured.
//!
//! An [`InkEstimator`] says how much of each pixel is covered by ink. Where that is nothing, the page becomes blank; near
//! ink it stays as it was scanned, less its paper, so that the places of edges, widths and colours are measured on the
//! page itself and not on what an estimator made of it.

mod darkness;
mod learned;
mod paper;
mod plain;

pub(crate) use darkness::Darkness;
pub use learned::LearnedInk;
pub(crate) use plain::is_plain;

use crate::cancel::Cancel;
use crate::clean::Run;
use crate::error::{Error, Result};
use crate::load::Scan;
use crate::raster::Raster;

/// How far the blurred edge of a line reaches beyond the pixels that are known to be ink, in pixels.
const EDGE: i64 = 2;
/// Coverage from which a pixel tells whether ink is lighter than its paper.
const CORE: f32 = 0.7;

/// A source of ink coverage for pages.
pub trait InkEstimator: Send + Sync {
    /// The share of each pixel that is covered by ink of the drawing, 0 to 1, at the scan's size.
    ///
    /// # Errors
    /// Whatever the source says.
    fn estimate(&self, scan: &Scan) -> Result<Raster<f32>>;

    /// The same unless told to stop; polled as often as the source can.
    ///
    /// # Errors
    /// The token's, or whatever the source says.
    fn estimate_until(&self, scan: &Scan, cancel: &Cancel) -> Result<Raster<f32>> {
        cancel.check()?;
        self.estimate(scan)
    }
}

/// A page without what is not covered by ink: its paper is white, or black where the ink is lighter than the paper.
///
/// # Errors
/// [`Error::InkSize`] when the coverage is not of the scan's size.
pub fn drawn(scan: &Scan, coverage: &Raster<f32>) -> Result<Scan> {
    let page = scan.gray.size();
    if coverage.size() != page {
        return Err(Error::InkSize { ink: coverage.size(), page });
    }
    let near = widened(coverage, EDGE);
    let paper = paper::filled(|x, y| color(scan, x, y), near.mapped(false, |c| c == 0.0));
    let is_light = is_lighter(scan, coverage, &paper);
    let (width, height) = page;
    let ink = Raster::from_rows(width, height, [0.0; 3], |y, row| {
        for (x, to) in row.iter_mut().enumerate() {
            let (seen, paper) = (color(scan, x, y), paper[(x, y)]);
            *to = [0, 1, 2]
                .map(|c| near[(x, y)] * if is_light { added(seen[c], paper[c]) } else { taken(seen[c], paper[c]) });
        }
    });
    let shade = |ink: f32| if is_light { ink } else { 1.0 - ink };
    let bytes = |ink: [f32; 3]| ink.map(|ink| (255.0 * shade(ink)).round() as u8);
    let rgb = scan.rgb.as_ref().map(|_| ink.mapped([0; 3], bytes).into_rgb_image());
    Ok(Scan { gray: ink.mapped(0.0, |ink| shade(luma(ink))), rgb, dpi: scan.dpi })
}

/// The share of the paper's light that ink has taken.
fn taken(seen: f32, paper: f32) -> f32 {
    (1.0 - seen / paper.max(1e-3)).clamp(0.0, 1.0)
}

/// The share of the light which the paper lacks that ink has added.
fn added(seen: f32, paper: f32) -> f32 {
    taken(1.0 - seen, 1.0 - paper)
}

fn color(scan: &Scan, x: usize, y: usize) -> [f32; 3] {
    let gray = scan.gray[(x, y)];
    scan.rgb.as_ref().map_or([gray; 3], |rgb| rgb.get_pixel(x as u32, y as u32).0.map(|v| f32::from(v) / 255.0))
}

/// Lightness of a colour (Rec. 709).
fn luma([r, g, b]: [f32; 3]) -> f32 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

/// Whether most ink is lighter than the paper under it.
fn is_lighter(scan: &Scan, coverage: &Raster<f32>, paper: &Raster<[f32; 3]>) -> bool {
    let (width, height) = coverage.size();
    let cores = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).filter(|&p| coverage[p] > CORE);
    cores.map(|(x, y)| f64::from(luma(color(scan, x, y)) - luma(paper[(x, y)]))).sum::<f64>() > 0.0
}

/// The mean coverage of each region, by its number, of which these are all runs.
fn mean_coverage(runs: &[Run], coverage: &Raster<f32>) -> Vec<f64> {
    let mut sums = vec![(0usize, 0.0); runs.len()];
    for run in runs {
        let (pixels, covered) = &mut sums[run.region];
        *pixels += run.to - run.from;
        *covered += coverage.row(run.y)[run.from..run.to].iter().map(|c| f64::from(*c)).sum::<f64>();
    }
    sums.into_iter().map(|(pixels, covered)| covered / pixels.max(1) as f64).collect()
}

/// The most of each pixel and those around it.
fn widened(raster: &Raster<f32>, reach: i64) -> Raster<f32> {
    let (width, height) = raster.size();
    let most = |values: &mut dyn Iterator<Item = Option<f32>>| values.flatten().fold(0.0, f32::max);
    let rows = Raster::from_rows(width, height, 0.0, |y, row| {
        for (x, to) in row.iter_mut().enumerate() {
            *to = most(&mut (-reach..=reach).map(|d| raster.get(x as i64 + d, y as i64)));
        }
    });
    Raster::from_rows(width, height, 0.0, |y, row| {
        for (x, to) in row.iter_mut().enumerate() {
            *to = most(&mut (-reach..=reach).map(|d| rows.get(x as i64, y as i64 + d)));
        }
    })
}
