//! Reads an input: a raster scan, or an SVG that is rendered first.

use crate::raster::Raster;
use image::RgbImage;

/// A drawing as it came in, before any cleaning.
#[derive(Clone, Debug)]
pub struct Scan {
    /// Lightness per pixel, 0 black to 1 white, alpha laid over white, upright.
    pub gray: Raster<f32>,
    /// The colours, where the input has any; same size as `gray`.
    pub rgb: Option<RgbImage>,
    /// Dots per inch, where the input says.
    pub dpi: Option<f64>,
}
