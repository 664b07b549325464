//! From what Python calls an image to a scan.

use fieldtrace::image::{DynamicImage, ImageBuffer, Luma, LumaA, Pixel, Rgb, Rgba};
use fieldtrace::load::{Dpi, Input, LoadOptions, load_bytes, load_image, read_bytes};
use fieldtrace::write::graph_json;
use fieldtrace::{Error, Result, Scan};
use numpy::{Element, PyArray3, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyString};
use std::path::{Path, PathBuf};

/// What errors call an image in memory.
const NAME: &str = "the image";

/// An image that can be read without Python.
pub enum Source {
    /// A file.
    File(PathBuf),
    /// The bytes of a file.
    Bytes(Vec<u8>),
    /// Samples, and the dots per inch that their source told.
    Image(DynamicImage, Option<Dpi>),
}

/// What was read.
pub enum Page {
    /// An image.
    Scan(Scan),
    /// A stroke graph in JSON, of which nothing but the curves is to be made.
    Graph(Box<fieldtrace::graph::StrokeGraph>),
}

impl Source {
    /// Of a path, bytes, an array or a picture of Pillow.
    ///
    /// # Errors
    /// `TypeError` for anything else, and what `fieldtrace/images.py` raises.
    pub fn of(value: &Bound<'_, PyAny>) -> PyResult<Self> {
        if let Ok(bytes) = value.cast::<PyBytes>() {
            return Ok(Self::Bytes(bytes.as_bytes().to_vec()));
        }
        if value.is_instance_of::<PyString>() || value.hasattr("__fspath__")? {
            return Ok(Self::File(value.extract()?));
        }
        let read = value.py().import("fieldtrace.images")?.call_method1("samples", (value,))?;
        if let Ok(bytes) = read.cast::<PyBytes>() {
            return Ok(Self::Bytes(bytes.as_bytes().to_vec()));
        }
        let (samples, dpi): (Bound<'_, PyAny>, Option<(f64, f64)>) = read.extract()?;
        Ok(Self::Image(image(&samples)?, dpi.map(|(x, y)| Dpi { x, y })))
    }

    /// What errors call it.
    pub fn name(&self) -> String {
        match self {
            Self::File(path) => path.display().to_string(),
            Self::Bytes(_) | Self::Image(..) => NAME.into(),
        }
    }

    /// Reads it as one page, or the graph that it holds.
    ///
    /// # Errors
    /// Why that cannot be done.
    pub fn read(self, options: &LoadOptions) -> Result<Page> {
        let scan = |input: Input| Page::Scan(input.scan);
        match self {
            Self::File(path) => read(&path.display().to_string(), &file(&path)?, options),
            Self::Bytes(bytes) => read(NAME, &bytes, options),
            Self::Image(image, dpi) => {
                let options = options.clone().with(|o| o.dpi = options.dpi.or(dpi));
                load_image(NAME, image, &options).map(scan)
            }
        }
    }

    /// Reads the scan of one page.
    ///
    /// # Errors
    /// Why that cannot be done.
    pub fn scan(self, options: &LoadOptions) -> Result<Scan> {
        let name = self.name();
        match self.read(options)? {
            Page::Scan(scan) => Ok(scan),
            Page::Graph(_) => {
                let reason = "it is a stroke graph, not an image".into();
                Err(Error::Decode { input: name, reason })
            }
        }
    }
}

/// The bytes of a file.
///
/// # Errors
/// [`Error::Read`].
pub fn file(path: &Path) -> Result<Vec<u8>> {
    read_bytes(path)
}

fn read(name: &str, bytes: &[u8], options: &LoadOptions) -> Result<Page> {
    if !graph_json::is_json(bytes) {
        return load_bytes(name, bytes, options).map(|input| Page::Scan(input.scan));
    }
    let mut graph = graph_json::from_json(name, bytes)?;
    graph.page.dpi = options.dpi.map(|dpi| dpi.x).or(graph.page.dpi);
    Ok(Page::Graph(Box::new(graph)))
}

/// The image of contiguous samples, `(height, width, channels)`, of 8 or 16 bits or single floats.
fn image(samples: &Bound<'_, PyAny>) -> PyResult<DynamicImage> {
    if let Ok(samples) = samples.cast::<PyArray3<u8>>() {
        return bits(
            samples,
            DynamicImage::ImageLuma8,
            DynamicImage::ImageLumaA8,
            DynamicImage::ImageRgb8,
            DynamicImage::ImageRgba8,
        );
    }
    if let Ok(samples) = samples.cast::<PyArray3<u16>>() {
        return bits(
            samples,
            DynamicImage::ImageLuma16,
            DynamicImage::ImageLumaA16,
            DynamicImage::ImageRgb16,
            DynamicImage::ImageRgba16,
        );
    }
    let samples = samples.cast::<PyArray3<f32>>().map_err(PyErr::from)?;
    let grey = |image: ImageBuffer<Luma<f32>, Vec<f32>>| {
        let (width, height) = image.dimensions();
        let data = image.into_raw().into_iter().flat_map(|v| [v; 3]).collect();
        DynamicImage::ImageRgb32F(filled(width, height, data))
    };
    let grey_alpha = |image: ImageBuffer<LumaA<f32>, Vec<f32>>| {
        let (width, height) = image.dimensions();
        let data = image.pixels().flat_map(|&LumaA([v, alpha])| [v, v, v, alpha]).collect();
        DynamicImage::ImageRgba32F(filled(width, height, data))
    };
    bits(samples, grey, grey_alpha, DynamicImage::ImageRgb32F, DynamicImage::ImageRgba32F)
}

/// The image of samples by the number of their channels.
fn bits<T: Element + Copy>(
    samples: &Bound<'_, PyArray3<T>>,
    grey: impl Fn(ImageBuffer<Luma<T>, Vec<T>>) -> DynamicImage,
    grey_alpha: impl Fn(ImageBuffer<LumaA<T>, Vec<T>>) -> DynamicImage,
    rgb: impl Fn(ImageBuffer<Rgb<T>, Vec<T>>) -> DynamicImage,
    rgba: impl Fn(ImageBuffer<Rgba<T>, Vec<T>>) -> DynamicImage,
) -> PyResult<DynamicImage>
where
    Luma<T>: Pixel<Subpixel = T>,
    LumaA<T>: Pixel<Subpixel = T>,
    Rgb<T>: Pixel<Subpixel = T>,
    Rgba<T>: Pixel<Subpixel = T>,
{
    let samples = samples.try_readonly()?;
    let shape = samples.as_array().dim();
    let data = samples.as_slice()?.to_vec();
    let (height, width, channels) = shape;
    let side = |length: usize| u32::try_from(length).unwrap_or(u32::MAX);
    let (width, height) = (side(width), side(height));
    Ok(match channels {
        1 => grey(filled(width, height, data)),
        2 => grey_alpha(filled(width, height, data)),
        3 => rgb(filled(width, height, data)),
        _ => rgba(filled(width, height, data)),
    })
}

/// The picture of as many samples as it has.
fn filled<P: Pixel>(width: u32, height: u32, data: Vec<P::Subpixel>) -> ImageBuffer<P, Vec<P::Subpixel>> {
    ImageBuffer::from_raw(width, height, data).unwrap_or_else(|| ImageBuffer::new(0, 0))
}
