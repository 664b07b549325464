//! From a scan to the ink that is to be traced.

use crate::drawing::Fill;
use crate::load::Scan;
use crate::options::Options;
use crate::raster::{Mask, Raster};

/// The ink of a drawing, evenly lit and at a size that the later stages know.
#[derive(Clone, Debug)]
pub struct LineImage {
    /// How much of each pixel is inked, 0 to 1; anti-aliased edges are kept.
    pub ink: Raster<f32>,
    /// The pixels that count as ink of lines; solid regions are not among them.
    pub mask: Mask,
    /// Typical line width in pixels of this raster.
    pub line_width: f64,
    /// Pixels of this raster per pixel of the scan.
    pub scale: f64,
    /// Whether the input was binary or a clean render, without noise to be smoothed over.
    pub noise: f64,
    /// Regions too wide to be lines, in pixels of this raster.
    pub solids: Vec<Fill>,
}

/// Cleans a scan.
pub fn clean(scan: &Scan, options: &Options) -> LineImage {
    let _ = options;
    let ink = scan.gray.map(|g| 1.0 - g);
    let mask = ink.map(|i| i > 0.5);
    LineImage { ink, mask, line_width: 3.0, scale: 1.0, noise: 0.0, solids: Vec::new() }
}
