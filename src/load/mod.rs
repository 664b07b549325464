//! Reads an input: a raster scan, or an SVG that is rendered first.
//!
//! After this stage: the image is upright, its transparency lies over white, its samples are as precise as they were
//! stored, and it has at least one pixel and at most [`LoadOptions::max_pixels`].

mod bitmap;
mod group3;
mod jpeg;
mod resolution;
pub mod svg;
mod tiff;

use crate::drawing::Drawing;
use crate::error::{Error, Result};
use crate::raster::Raster;
use image::{DynamicImage, RgbImage};
use std::io::{ErrorKind, Read};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

/// A drawing as it came in, before any cleaning.
#[derive(Clone, Debug)]
pub struct Scan {
    /// Lightness per pixel, 0 black to 1 white, alpha laid over white (over black where only that shows it), upright.
    pub gray: Raster<f32>,
    /// The colours, where the input has any; same size as `gray`.
    pub rgb: Option<RgbImage>,
    /// Dots per inch, where the input says.
    pub dpi: Option<f64>,
}

/// An image that is upright; what is transparent is laid over white, or over black where only that shows it.
impl From<&DynamicImage> for Scan {
    fn from(image: &DynamicImage) -> Self {
        bitmap::scan(image, None)
    }
}

/// What was read: the image to trace and, where the input was a vector drawing, the truth.
#[derive(Clone, Debug)]
pub struct Input {
    /// The image; for an SVG its rendering.
    pub scan: Scan,
    /// The strokes of an SVG input in pixels of its rendering; `None` for a raster input.
    pub drawing: Option<Drawing>,
}

/// What a reader of inputs may be told.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadOptions {
    /// Most pixels that an image may have; checked against the header, before anything is decoded.
    pub max_pixels: u64,
    /// Dots per inch in place of what the input says. An SVG is rendered at this resolution (96 is one pixel for one
    /// CSS pixel) unless `size` is given.
    pub dpi: Option<f64>,
    /// Longer side in pixels of the rendering of an SVG; raster inputs keep their size.
    pub size: Option<u32>,
}

impl Default for LoadOptions {
    fn default() -> Self {
        Self { max_pixels: 64_000_000, dpi: None, size: None }
    }
}

impl LoadOptions {
    /// Checks every range.
    ///
    /// # Errors
    /// [`Error::Option`] names the first option that is out of its range.
    pub fn validate(&self) -> Result<()> {
        let error = |option, reason: String| Err(Error::Option { option, reason });
        match (self.dpi, self.size) {
            (Some(dpi), _) if !resolution::plausible(dpi) => error("dpi", format!("{dpi} is not between 1 and 100000")),
            (_, Some(0)) => error("size", "0 is not a size in pixels".into()),
            _ => Ok(()),
        }
    }

    /// Checks a claimed size in pixels.
    fn check_size(&self, input: &str, width: u64, height: u64) -> Result<()> {
        if width == 0 || height == 0 {
            return Err(undecodable(input, "the image has no pixels"));
        }
        if width.saturating_mul(height) > self.max_pixels {
            return Err(Error::TooLarge { input: input.into(), width, height, limit: self.max_pixels });
        }
        Ok(())
    }
}

/// Reads an input file, or standard input where the path is `-`.
///
/// # Errors
/// [`Error::Read`] where the file cannot be read, and the errors of [`load_bytes`].
pub fn load(path: &Path, options: &LoadOptions) -> Result<Input> {
    load_bytes(&path.display().to_string(), &read_bytes(path)?, options)
}

/// The bytes of an input file, or of standard input where the path is `-`.
///
/// # Errors
/// [`Error::Read`].
pub fn read_bytes(path: &Path) -> Result<Vec<u8>> {
    read(path).map_err(|cause| Error::Read { input: path.display().to_string(), cause })
}

fn read(path: &Path) -> std::io::Result<Vec<u8>> {
    if path.as_os_str() == "-" {
        let mut bytes = Vec::new();
        std::io::stdin().lock().read_to_end(&mut bytes)?;
        return Ok(bytes);
    }
    if path.is_dir() {
        return Err(std::io::Error::new(ErrorKind::IsADirectory, "it is a folder, not a file"));
    }
    std::fs::read(path)
}

/// Reads an input that is already in memory; `name` is what errors call it.
///
/// The format is taken from the bytes, not from the name: PNG, JPEG, TIFF, WebP, BMP, GIF (first frame), PNM, SVG or
/// compressed SVG.
///
/// # Errors
/// [`Error::Decode`] where the bytes are not a whole image in one of these formats, [`Error::TooLarge`] where the
/// header claims more than [`LoadOptions::max_pixels`], [`Error::NothingVisible`] where an SVG paints nothing, and
/// [`Error::Option`] where an option is out of its range.
pub fn load_bytes(name: &str, bytes: &[u8], options: &LoadOptions) -> Result<Input> {
    options.validate()?;
    // The decoders are other people's code and read hostile bytes: what they trip over is an error like any other.
    catch_unwind(AssertUnwindSafe(|| dispatch(name, bytes, options)))
        .unwrap_or_else(|_| Err(undecodable(name, "the decoder gave up on the image: it is damaged")))
}

fn dispatch(name: &str, bytes: &[u8], options: &LoadOptions) -> Result<Input> {
    if bytes.is_empty() {
        return Err(undecodable(name, "the file is empty"));
    }
    if svg::is_svg(bytes) {
        return svg::load(name, bytes, options);
    }
    let scan = bitmap::load(name, bytes, options)?;
    Ok(Input { scan, drawing: None })
}

/// The error for bytes that are no image, with its reason brought to one line.
fn undecodable(input: &str, reason: impl std::fmt::Display) -> Error {
    let reason = reason.to_string().split_whitespace().collect::<Vec<_>>().join(" ");
    Error::Decode { input: input.into(), reason }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_out_of_range_are_named() {
        for dpi in [0.0, -300.0, f64::NAN, f64::INFINITY] {
            let error = LoadOptions { dpi: Some(dpi), ..LoadOptions::default() }.validate().unwrap_err();
            assert!(error.to_string().starts_with("dpi: "), "{error}");
        }
        let error = LoadOptions { size: Some(0), ..LoadOptions::default() }.validate().unwrap_err();
        assert!(error.to_string().starts_with("size: "), "{error}");
        assert!(LoadOptions::default().validate().is_ok());
    }

    #[test]
    fn sizes_are_checked_without_overflow() {
        let options = LoadOptions { max_pixels: 100, ..LoadOptions::default() };
        assert!(options.check_size("a", 10, 10).is_ok());
        assert!(matches!(options.check_size("a", 10, 11), Err(Error::TooLarge { .. })));
        assert!(matches!(options.check_size("a", u64::MAX, u64::MAX), Err(Error::TooLarge { .. })));
        assert!(matches!(options.check_size("a", 0, 5), Err(Error::Decode { .. })));
    }

    #[test]
    fn reasons_keep_to_one_line() {
        assert_eq!(undecodable("x.png", "broken\n  twice").to_string(), "x.png: broken twice");
    }
}
