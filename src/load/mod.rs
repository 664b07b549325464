//! Reads an input: a raster scan, or an SVG that is rendered first.
//!
//! After this stage: the image is upright, its transparency lies over white, its samples are as precise as they were
//! stored, its pixels are square, and it has at least one pixel and at most [`LoadOptions::max_pixels`].
//!
//! Where a file says that pixels lie less densely one way than the other, as a fax does, the image is resampled at the
//! finer resolution: pixels then are those of the resampled image.
//!
//! [`load`] reads an input of one page, and [`load_pages`] one of any number, page by page. [`load_image`] takes what another
//! program has decoded.

#[cfg(feature = "formats")]
mod animation;
#[cfg(feature = "avif")]
mod avif;
mod bitmap;
mod format;
mod geo;
mod group3;
#[cfg(feature = "formats")]
mod jp2;
mod jpeg;
#[cfg(feature = "formats")]
mod jxl;
mod options;
mod pages;
#[cfg(feature = "formats")]
mod pdf;
mod plan;
mod resolution;
mod square;
#[cfg(feature = "svg-input")]
pub mod svg;
mod tiff;

use crate::drawing::Drawing;
use crate::error::{Error, Result};
use crate::place::Frame;
use crate::raster::Raster;
use image::metadata::Orientation;
use image::{DynamicImage, GrayImage, RgbImage, RgbaImage};
use std::borrow::Cow;
use std::io::{ErrorKind, Read};
use std::path::Path;

#[cfg(feature = "files")]
pub(crate) use geo::for_scan;
pub use geo::georeference;
pub use options::{Dpi, LoadOptions};
pub use pages::Pages;

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

impl From<&GrayImage> for Scan {
    fn from(image: &GrayImage) -> Self {
        bitmap::scan(&DynamicImage::ImageLuma8(image.clone()), None)
    }
}

impl From<&RgbImage> for Scan {
    fn from(image: &RgbImage) -> Self {
        bitmap::scan(&DynamicImage::ImageRgb8(image.clone()), None)
    }
}

impl From<&RgbaImage> for Scan {
    fn from(image: &RgbaImage) -> Self {
        bitmap::scan(&DynamicImage::ImageRgba8(image.clone()), None)
    }
}

/// What was read: the image to trace and, where the input was a vector drawing, the truth.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Input {
    /// The image; for an SVG its rendering.
    pub scan: Scan,
    /// The strokes of an SVG input in pixels of its rendering; `None` for a raster input.
    pub drawing: Option<Drawing>,
    /// How an SVG input says its size; `None` for others and for a part of one.
    pub frame: Option<Frame>,
}

/// Reads an input file of one page, or the one page of it that the options name; `-` is standard input.
///
/// # Errors
/// [`Error::Read`] where the file cannot be read, and the errors of [`load_bytes`].
pub fn load(path: &Path, options: &LoadOptions) -> Result<Input> {
    load_pages(path, options)?.only()
}

/// Opens an input file of any number of pages, or standard input where the path is `-`.
///
/// # Errors
/// [`Error::Read`] where the file cannot be read, and the errors of [`pages_of_bytes`].
pub fn load_pages(path: &Path, options: &LoadOptions) -> Result<Pages<'static>> {
    Pages::open(&path.display().to_string(), Cow::Owned(read_bytes(path)?), options)
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

/// Reads an input of one page that is already in memory, or the one page that the options name; `name` is what errors
/// call it.
///
/// The format is taken from the bytes: PNG, JPEG, TIFF, BMP, PNM, with the feature `svg-input` SVG or compressed SVG,
/// and with the feature `formats` PDF, WebP, GIF, TGA, QOI, JPEG XL and JPEG 2000, and with `avif` AVIF. A TGA of the first version has
/// nothing that tells what it is, so there the name counts.
///
/// # Errors
/// [`Error::Decode`] where the bytes are not a whole image in one of these formats or the part to read is not within
/// it, [`Error::TooLarge`] where the header claims more than [`LoadOptions::max_pixels`], [`Error::ManyPages`] where
/// there are several pages and none is named, [`Error::NoSuchPage`] where there are fewer than the one named,
/// [`Error::NothingVisible`] where an SVG paints nothing, and [`Error::Option`] where an option is out of its range.
pub fn load_bytes(name: &str, bytes: &[u8], options: &LoadOptions) -> Result<Input> {
    pages_of_bytes(name, bytes, options)?.only()
}

/// The scan of an image that another program has decoded, read under the options as a file with that one page would be: its
/// size is checked, a part taken, its pixels made square. `name` is what errors call it.
///
/// ```
/// use fieldtrace::load::{LoadOptions, load_image};
///
/// let image = image::DynamicImage::new_luma8(40, 30);
/// let part = LoadOptions::default().with(|o| { o.crop = Some([10, 5, 20, 15]); o.dpi = Some(300.0.into()); });
/// let scan = load_image("in memory", image, &part)?.scan;
/// assert_eq!((scan.gray.size(), scan.dpi), ((20, 15), Some(300.0)));
/// # Ok::<(), fieldtrace::Error>(())
/// ```
///
/// # Errors
/// [`Error::TooLarge`], [`Error::NoSuchPage`], [`Error::Decode`] where the image has no pixels or the part to read is not
/// within it, and [`Error::Option`] where an option is out of its range.
pub fn load_image(name: &str, image: DynamicImage, options: &LoadOptions) -> Result<Input> {
    options.validate()?;
    if let Some(page) = options.page.filter(|&page| page > 1) {
        return Err(Error::NoSuchPage { input: name.into(), page, pages: 1 });
    }
    let (width, height) = (image.width(), image.height());
    let header = plan::Header { width, height, orientation: Orientation::NoTransforms, density: None };
    let plan = header.plan(name, options)?;
    Ok(Input { scan: plan.scan(image), drawing: None, frame: None })
}

/// Opens an input of any number of pages that is already in memory; `name` is what errors call it.
///
/// ```
/// use fieldtrace::load::{LoadOptions, pages_of_bytes};
///
/// let pages = pages_of_bytes("a.pbm", &b"P1 2 1 0 1"[..], &LoadOptions::default())?;
/// assert_eq!(pages.count(), 1);
/// for (number, page) in pages.iter() {
///     assert_eq!((number, page?.scan.gray.data()), (1, &[1.0, 0.0][..]));
/// }
/// # Ok::<(), fieldtrace::Error>(())
/// ```
///
/// # Errors
/// [`Error::Decode`] where the bytes are in no format that is read or their list of pages is damaged,
/// [`Error::NoSuchPage`] where there are fewer pages than the one named, and [`Error::Option`] where an option is out
/// of its range. Pages are not decoded yet.
pub fn pages_of_bytes<'a>(name: &str, bytes: impl Into<Cow<'a, [u8]>>, options: &LoadOptions) -> Result<Pages<'a>> {
    Pages::open(name, bytes.into(), options)
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
    fn reasons_keep_to_one_line() {
        assert_eq!(undecodable("x.png", "broken\n  twice").to_string(), "x.png: broken twice");
    }
}
