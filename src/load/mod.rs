//! Reads an input: a raster scan, or an SVG that is rendered first.

use crate::drawing::Drawing;
use crate::error::{Error, Result};
use crate::raster::Raster;
use image::RgbImage;
use std::io::Read;
use std::path::Path;

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

/// How an input is read.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadOptions {
    /// Inputs of more pixels are refused.
    pub max_pixels: u64,
    /// Dots per inch, in place of what the input says.
    pub dpi: Option<f64>,
    /// Pixels along the longer side of an SVG's rendering.
    pub size: Option<u32>,
}

impl Default for LoadOptions {
    fn default() -> Self {
        Self { max_pixels: 80_000_000, dpi: None, size: None }
    }
}

/// What was read.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// The picture to be traced.
    pub scan: Scan,
    /// The shapes of an SVG input.
    pub drawing: Option<Drawing>,
}

/// Reads a file, or standard input where the path is `-`.
///
/// # Errors
/// [`Error::Read`], [`Error::Decode`], [`Error::TooLarge`] or [`Error::NothingVisible`].
pub fn load(path: &Path, options: &LoadOptions) -> Result<Loaded> {
    let name = path.display().to_string();
    let failed = |cause| Error::Read { input: name.clone(), cause };
    let bytes = if name == "-" {
        let mut bytes = Vec::new();
        std::io::stdin().lock().read_to_end(&mut bytes).map_err(failed)?;
        bytes
    } else {
        std::fs::read(path).map_err(failed)?
    };
    load_bytes(&name, &bytes, options)
}

/// Reads bytes; the name is for messages.
///
/// # Errors
/// [`Error::Decode`], [`Error::TooLarge`] or [`Error::NothingVisible`].
pub fn load_bytes(name: &str, bytes: &[u8], options: &LoadOptions) -> Result<Loaded> {
    let decode = |reason: String| Error::Decode { input: name.into(), reason };
    if bytes.is_empty() {
        return Err(decode("the file is empty".into()));
    }
    let image = image::load_from_memory(bytes).map_err(|e| decode(e.to_string()))?;
    let (width, height) = (u64::from(image.width()), u64::from(image.height()));
    if width * height > options.max_pixels {
        return Err(Error::TooLarge { input: name.into(), width, height, limit: options.max_pixels });
    }
    let luma = image.to_luma8();
    let gray = Raster::from_fn(width as usize, height as usize, |x, y| {
        f32::from(luma.get_pixel(x as u32, y as u32).0[0]) / 255.0
    });
    Ok(Loaded { scan: Scan { gray, rgb: None, dpi: options.dpi }, drawing: None })
}
