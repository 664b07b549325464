//! Raster formats of one image: decoded, and lightness and colour told from samples of every kind.

use super::format::Format;
use super::plan::{Header, Plan};
use super::{LoadOptions, Scan, jpeg, resolution, undecodable};
use crate::error::Result;
use crate::raster::Raster;
use image::metadata::Orientation;
use image::{DynamicImage, ImageBuffer, ImageDecoder, ImageFormat, ImageReader, ImageResult, Limits, Pixel};
use rayon::prelude::*;
use std::io::Cursor;

/// Spread between channels, of 1, up to which an image still counts as grey: what JPEG makes of a grey original.
const COLOR_THRESHOLD: f32 = 8.5 / 255.0;

/// Less than this share of the tonal range beside its ground is not seen: a few steps of 8 bits.
const UNSEEN: f32 = 8.5 / 255.0;

/// Rec. 709 luma of the stored values.
const LUMA: [f32; 3] = [0.2126, 0.7152, 0.0722];

/// An image as stored, and what is to be made of it.
pub(super) struct Decoded {
    /// The samples as stored.
    pub image: DynamicImage,
    /// What makes a scan of it.
    pub plan: Plan,
}

/// What a decoder may allocate: enough for any image within the options.
pub(super) fn limits(options: &LoadOptions) -> Limits {
    let mut limits = Limits::no_limits();
    limits.max_alloc = Some(options.max_pixels.saturating_mul(16).saturating_add(1 << 20));
    limits
}

/// Decodes the one image of a file.
///
/// # Errors
/// [`crate::Error::Decode`] and [`crate::Error::TooLarge`].
pub(super) fn decode(name: &str, bytes: &[u8], format: Format, options: &LoadOptions) -> Result<Decoded> {
    let damaged = |e: image::ImageError| undecodable(name, e);
    #[cfg(feature = "formats")]
    let jp2 = if format == Format::Jpeg2000 { super::jp2::boxes(bytes) } else { Default::default() };
    #[cfg(feature = "formats")]
    if let Some(fault) = jp2.fault {
        return Err(undecodable(name, fault));
    }
    let mut decoder = open(bytes, format, options).map_err(damaged)?;
    let (width, height) = decoder.dimensions();
    options.check_size(name, width.into(), height.into())?;
    if format == Format::Raster(ImageFormat::Jpeg) && !jpeg::markers(bytes).complete {
        return Err(undecodable(name, "the JPEG is cut short: it has no end marker"));
    }
    let orientation = match format {
        Format::Raster(_) => decoder.orientation().unwrap_or(Orientation::NoTransforms),
        // Decoders of other formats turn the image themselves.
        #[cfg(feature = "formats")]
        _ => Orientation::NoTransforms,
    };
    let exif = decoder.exif_metadata().ok().flatten();
    let density = match format {
        Format::Raster(format) => resolution::density(format, bytes, exif.as_deref()),
        #[cfg(feature = "formats")]
        _ => jp2.density,
        #[cfg(not(feature = "formats"))]
        #[allow(unreachable_patterns)] // without SVG
        _ => None,
    };
    let plan = Header { width, height, orientation, density }.plan(name, options)?;
    let image = DynamicImage::from_decoder(decoder).map_err(damaged)?;
    Ok(Decoded { image, plan })
}

/// A decoder that has read the header.
fn open<'a>(bytes: &'a [u8], format: Format, options: &LoadOptions) -> ImageResult<Box<dyn ImageDecoder + 'a>> {
    // Dimensions have their own check; this bounds what a decoder allocates on the way to them.
    let limits = limits(options);
    Ok(match format {
        Format::Raster(format) => {
            let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
            reader.limits(limits);
            Box::new(reader.into_decoder()?)
        }
        #[cfg(feature = "formats")]
        Format::Jpeg2000 => Box::new(hayro_jpeg2000::Image::new(bytes, &Default::default())?),
        #[allow(unreachable_patterns)] // without the further formats
        _ => {
            let hint = image::error::ImageFormatHint::Unknown;
            return Err(image::ImageError::Unsupported(hint.into()));
        }
    })
}

/// A sample of any type as a fraction of its range.
trait Unit: Copy + Sync {
    fn unit(self) -> f32;
}

impl Unit for u8 {
    fn unit(self) -> f32 {
        f32::from(self) / 255.0
    }
}

impl Unit for u16 {
    fn unit(self) -> f32 {
        f32::from(self) / 65535.0
    }
}

impl Unit for f32 {
    fn unit(self) -> f32 {
        if self.is_nan() { 1.0 } else { self.clamp(0.0, 1.0) }
    }
}

/// Lightness and, where there is any, colour of an upright image.
pub(super) fn scan(image: &DynamicImage, dpi: Option<f64>) -> Scan {
    match image {
        DynamicImage::ImageLuma8(b) => scan_buffer(b, dpi),
        DynamicImage::ImageLumaA8(b) => scan_buffer(b, dpi),
        DynamicImage::ImageRgb8(b) => scan_buffer(b, dpi),
        DynamicImage::ImageRgba8(b) => scan_buffer(b, dpi),
        DynamicImage::ImageLuma16(b) => scan_buffer(b, dpi),
        DynamicImage::ImageLumaA16(b) => scan_buffer(b, dpi),
        DynamicImage::ImageRgb16(b) => scan_buffer(b, dpi),
        DynamicImage::ImageRgba16(b) => scan_buffer(b, dpi),
        DynamicImage::ImageRgb32F(b) => scan_buffer(b, dpi),
        other => scan_buffer(&other.to_rgba32f(), dpi),
    }
}

fn scan_buffer<P: Pixel<Subpixel: Unit>>(image: &ImageBuffer<P, Vec<P::Subpixel>>, dpi: Option<f64>) -> Scan {
    let (width, height) = (image.width() as usize, image.height() as usize);
    let (samples, channels) = (image.as_raw().as_slice(), usize::from(P::CHANNEL_COUNT));
    let rows = || samples.par_chunks_exact(channels * width.max(1));
    let row = |y: usize| &samples[y * width * channels..(y + 1) * width * channels];
    let ground = ground::<P>(samples);
    let gray = Raster::from_rows(width, height, 0.0, |y, to| {
        to.iter_mut().zip(colors::<P>(row(y), ground)).for_each(|(gray, color)| *gray = luma(color));
    });
    let colored =
        channels >= 3 && rows().any(|row| colors::<P>(row, ground).any(|color| spread(color) > COLOR_THRESHOLD));
    let byte = |v: f32| (v * 255.0).round() as u8;
    let rgb = colored.then(|| {
        Raster::from_rows(width, height, [0; 3], |y, to| {
            to.iter_mut().zip(colors::<P>(row(y), ground)).for_each(|(rgb, color)| *rgb = color.map(byte));
        })
    });
    Scan { gray, rgb: rgb.map(Raster::into_rgb_image), dpi }
}

/// The lightness of what an image with transparency is laid over: white, unless nothing would be seen on white but
/// something on black.
fn ground<P: Pixel<Subpixel: Unit>>(samples: &[P::Subpixel]) -> f32 {
    if P::CHANNEL_COUNT % 2 == 1 {
        return 1.0;
    }
    let most = |ground: f32| {
        let pixels = samples.par_chunks_exact(P::CHANNEL_COUNT.into());
        pixels.map(|pixel| (luma(over(P::from_slice(pixel), ground)) - ground).abs()).reduce(|| 0.0, f32::max)
    };
    if most(1.0) < UNSEEN && most(0.0) > UNSEEN { 0.0 } else { 1.0 }
}

/// The colours of some pixels, given by their samples, in front of a grey.
fn colors<P: Pixel<Subpixel: Unit>>(samples: &[P::Subpixel], ground: f32) -> impl Iterator<Item = [f32; 3]> {
    samples.chunks_exact(P::CHANNEL_COUNT.into()).map(move |pixel| over(P::from_slice(pixel), ground))
}

/// Red, green and blue in `[0, 1]` of a pixel in front of a grey.
fn over<P: Pixel<Subpixel: Unit>>(pixel: &P, ground: f32) -> [f32; 3] {
    let (color, alpha) = match *pixel.channels() {
        [l] => ([l.unit(); 3], 1.0),
        [l, a] => ([l.unit(); 3], a.unit()),
        [r, g, b] => ([r.unit(), g.unit(), b.unit()], 1.0),
        [r, g, b, a] => ([r.unit(), g.unit(), b.unit()], a.unit()),
        _ => ([ground; 3], 1.0),
    };
    if alpha == 1.0 { color } else { color.map(|c| c * alpha + ground * (1.0 - alpha)) }
}

/// Lightness; exact for greys.
fn luma([r, g, b]: [f32; 3]) -> f32 {
    if r == g && g == b { r } else { LUMA[0] * r + LUMA[1] * g + LUMA[2] * b }
}

fn spread([r, g, b]: [f32; 3]) -> f32 {
    r.max(g).max(b) - r.min(g).min(b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{Luma, LumaA, Rgb, RgbImage, Rgba};

    #[test]
    fn alpha_lies_over_white() {
        assert_eq!(luma(over(&LumaA([0u8, 0]), 1.0)), 1.0);
        assert_eq!(luma(over(&LumaA([0u8, 255]), 1.0)), 0.0);
        assert!((luma(over(&Rgba([0u8, 0, 0, 51]), 1.0)) - 0.8).abs() < 1e-6);
    }

    #[test]
    fn white_ink_on_nothing_lies_over_black() {
        let ink = |x: u32| if x == 1 { LumaA([255u8, 255]) } else { LumaA([255, 0]) };
        let white = scan(&DynamicImage::ImageLumaA8(ImageBuffer::from_fn(3, 1, |x, _| ink(x))), None);
        assert_eq!(white.gray.data(), [0.0, 1.0, 0.0]);
        let nothing = scan(&DynamicImage::ImageLumaA8(ImageBuffer::from_pixel(3, 1, LumaA([255, 0]))), None);
        assert_eq!(nothing.gray.data(), [1.0; 3]);
    }

    #[test]
    fn greys_are_exact_in_every_depth() {
        for v in 0..=255u8 {
            assert_eq!(luma(over(&Rgb([v; 3]), 1.0)), f32::from(v) / 255.0);
        }
        assert_eq!(luma(over(&Luma([12345u16]), 1.0)), 12345.0 / 65535.0);
        assert_eq!(luma(over(&Rgb([0.25f32; 3]), 1.0)), 0.25);
        assert_eq!(luma(over(&Rgb([f32::NAN; 3]), 1.0)), 1.0);
    }

    #[test]
    fn colour_is_kept_only_where_there_is_some() {
        let nearly_grey = DynamicImage::ImageRgb8(RgbImage::from_pixel(2, 2, Rgb([100, 104, 108])));
        assert!(scan(&nearly_grey, None).rgb.is_none());
        let mut red = RgbImage::from_pixel(2, 2, Rgb([255; 3]));
        red.put_pixel(1, 0, Rgb([255, 0, 0]));
        let got = scan(&DynamicImage::ImageRgb8(red.clone()), Some(300.0));
        assert_eq!((got.rgb, got.dpi), (Some(red), Some(300.0)));
        assert!((got.gray[(1, 0)] - LUMA[0]).abs() < 1e-6);
    }
}
