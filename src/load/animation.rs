//! Animated GIF and WebP, whose frames are composited as a viewer shows them.

use super::bitmap::{Decoded, limits};
use super::plan::Header;
use super::{LoadOptions, undecodable};
use crate::error::Result;
use image::codecs::{gif::GifDecoder, webp::WebPDecoder};
use image::metadata::Orientation;
use image::{AnimationDecoder, Frames, ImageDecoder, ImageFormat, ImageResult};
use std::io::Cursor;

/// How many frames a file claims to have: 1 where it is no animation. Nothing is decoded.
pub(super) fn frames(format: ImageFormat, bytes: &[u8]) -> usize {
    match format {
        ImageFormat::Gif => gif_images(bytes).unwrap_or(1),
        ImageFormat::WebP => webp_frames(bytes),
        _ => 1,
    }
}

/// Images of a GIF, each a block that begins with a comma; as many as there are before the file breaks off.
fn gif_images(bytes: &[u8]) -> Option<usize> {
    let palette = |flags: u8| if flags & 0x80 == 0 { 0 } else { 3usize << ((flags & 7) + 1) };
    let sub_blocks = |mut at: usize| {
        while let Some(&length @ 1..) = bytes.get(at) {
            at += 1 + usize::from(length);
        }
        at + 1
    };
    let mut at = 13 + palette(*bytes.get(10)?);
    let mut images = 0;
    loop {
        at = match bytes.get(at) {
            Some(0x21) => sub_blocks(at + 2),
            Some(0x2C) => {
                images += 1;
                let Some(&flags) = bytes.get(at + 9) else { return Some(images) };
                sub_blocks(at + 11 + palette(flags))
            }
            _ => return Some(images),
        };
    }
}

/// The `ANMF` chunks of a WebP.
fn webp_frames(bytes: &[u8]) -> usize {
    let (mut at, mut frames) = (12, 0);
    while let Some(head) = bytes.get(at..at + 8) {
        frames += usize::from(head.starts_with(b"ANMF"));
        let length = u32::from_le_bytes([head[4], head[5], head[6], head[7]]) as usize;
        at += 8 + length.next_multiple_of(2);
    }
    frames
}

/// Goes through the frames of an animation in their order.
pub(super) struct Player<'a> {
    bytes: &'a [u8],
    format: ImageFormat,
    /// What is left, from the frame after the one that was last shown.
    rest: Option<Frames<'a>>,
    shown: usize,
}

impl<'a> Player<'a> {
    /// At the beginning; nothing is decoded.
    pub(super) fn new(bytes: &'a [u8], format: ImageFormat) -> Self {
        Self { bytes, format, rest: None, shown: 0 }
    }

    /// A frame, counted from 1, that comes after the one shown before.
    ///
    /// # Errors
    /// [`crate::Error::Decode`] and [`crate::Error::TooLarge`].
    pub(super) fn frame(&mut self, name: &str, number: usize, options: &LoadOptions) -> Result<Decoded> {
        let damaged = |e: image::ImageError| undecodable(name, e);
        let mut rest = match self.rest.take() {
            Some(rest) => rest,
            None if self.shown > 0 => return Err(undecodable(name, "a frame before it is damaged")),
            None => self.open(name, options)?,
        };
        let mut frame = None;
        while self.shown < number {
            self.shown += 1;
            frame = rest.next().transpose().map_err(damaged)?;
        }
        let image = frame.ok_or_else(|| undecodable(name, "the frame is missing"))?.into_buffer();
        let (width, height) = image.dimensions();
        let plan =
            Header { width, height, orientation: Orientation::NoTransforms, density: None }.plan(name, options)?;
        self.rest = Some(rest);
        Ok(Decoded { image: image.into(), plan })
    }

    /// All frames; their size is checked before the first is decoded.
    fn open(&self, name: &str, options: &LoadOptions) -> Result<Frames<'a>> {
        let damaged = |e: image::ImageError| undecodable(name, e);
        let input = Cursor::new(self.bytes);
        let checked = |(width, height): (u32, u32)| options.check_size(name, width.into(), height.into());
        fn limited<D: ImageDecoder>(mut decoder: D, options: &LoadOptions) -> ImageResult<D> {
            decoder.set_limits(limits(options))?;
            Ok(decoder)
        }
        if self.format == ImageFormat::Gif {
            let decoder = GifDecoder::new(input).and_then(|d| limited(d, options)).map_err(damaged)?;
            checked(decoder.dimensions())?;
            Ok(decoder.into_frames())
        } else {
            let decoder = WebPDecoder::new(input).and_then(|d| limited(d, options)).map_err(damaged)?;
            checked(decoder.dimensions())?;
            Ok(decoder.into_frames())
        }
    }
}
