//! JPEG XL, decoded by `jxl-oxide`; the frames of an animation are pages.

use super::bitmap::{Decoded, limits};
use super::plan::Header;
use super::{LoadOptions, resolution, undecodable};
use crate::error::Result;
use image::metadata::Orientation;
use image::{DynamicImage, ImageBuffer, Pixel};
use jxl_oxide::{AllocTracker, FrameBufferSample, ImageStream, JxlImage};

/// How many frames a file has that are to be seen: 1 where it is no animation. No pixel is decoded.
pub(super) fn frames(bytes: &[u8], options: &LoadOptions) -> usize {
    open(bytes, options).map_or(1, |image| image.num_loaded_keyframes().max(1))
}

/// Decodes a frame, counted from 1.
///
/// # Errors
/// [`crate::Error::Decode`] and [`crate::Error::TooLarge`].
pub(super) fn decode(name: &str, bytes: &[u8], number: usize, options: &LoadOptions) -> Result<Decoded> {
    let image = open(bytes, options).map_err(|e| undecodable(name, e))?;
    let exif = image.aux_boxes().first_exif().ok();
    let density = exif.and_then(|exif| resolution::exif_density(exif.map(|raw| raw.payload()).unwrap_or(&[])));
    // The decoder turns the image itself.
    let (width, height, orientation) = (image.width(), image.height(), Orientation::NoTransforms);
    let plan = Header { width, height, orientation, density }.plan(name, options)?;
    if !image.is_loading_done() {
        return Err(undecodable(name, "the JPEG XL is cut short"));
    }
    let deep = image.image_header().metadata.bit_depth.bits_per_sample() > 8;
    let render = image.render_frame(number - 1).map_err(|e| undecodable(name, e))?;
    let mut stream = render.stream();
    let image = if deep { samples::<u16>(&mut stream) } else { samples::<u8>(&mut stream) };
    let image =
        image.ok_or_else(|| undecodable(name, "the colours of the JPEG XL are of a kind that is not supported"))?;
    Ok(Decoded { image, plan })
}

/// A file whose header and list of frames are read.
fn open(bytes: &[u8], options: &LoadOptions) -> jxl_oxide::Result<JxlImage> {
    let most = limits(options).max_alloc.and_then(|bytes| usize::try_from(bytes).ok()).unwrap_or(usize::MAX);
    // A decoder works on several planes of single precision beside those that it gives.
    let tracker = AllocTracker::with_limit(most.saturating_mul(4));
    JxlImage::builder().alloc_tracker(tracker).read(bytes)
}

/// The pixels of a frame; `None` for more channels than red, green, blue and alpha.
fn samples<S: FrameBufferSample + Default + Copy>(stream: &mut ImageStream) -> Option<DynamicImage>
where
    image::Luma<S>: Pixel<Subpixel = S>,
    image::LumaA<S>: Pixel<Subpixel = S>,
    image::Rgb<S>: Pixel<Subpixel = S>,
    image::Rgba<S>: Pixel<Subpixel = S>,
    DynamicImage: From<ImageBuffer<image::Luma<S>, Vec<S>>>
        + From<ImageBuffer<image::LumaA<S>, Vec<S>>>
        + From<ImageBuffer<image::Rgb<S>, Vec<S>>>
        + From<ImageBuffer<image::Rgba<S>, Vec<S>>>,
{
    let (width, height, channels) = (stream.width(), stream.height(), stream.channels());
    let mut data = vec![S::default(); width as usize * height as usize * channels as usize];
    stream.write_to_buffer(&mut data);
    Some(match channels {
        1 => ImageBuffer::<image::Luma<S>, _>::from_raw(width, height, data)?.into(),
        2 => ImageBuffer::<image::LumaA<S>, _>::from_raw(width, height, data)?.into(),
        3 => ImageBuffer::<image::Rgb<S>, _>::from_raw(width, height, data)?.into(),
        4 => ImageBuffer::<image::Rgba<S>, _>::from_raw(width, height, data)?.into(),
        _ => return None,
    })
}
