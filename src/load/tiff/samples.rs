//! The samples of a decoded TIFF page, made an image of the types of `image`.

use image::{DynamicImage, ImageBuffer, Luma, Rgb, Rgba};
use std::io::{Read, Seek};
use std::num::NonZeroUsize;
use tiff::decoder::{BufferLayoutPreference, ChunkType, Decoder, DecodingResult, Limits};
use tiff::tags::{PlanarConfiguration, Tag};
use tiff::{ColorType, TiffError, TiffFormatError, TiffResult};

/// The decoded samples and how they lie.
pub(super) struct Samples {
    data: DecodingResult,
    color: ColorType,
    premultiplied: bool,
    width: u32,
    height: u32,
    /// Bits of a sample.
    bits: usize,
    /// Samples from one pixel to the next.
    step: usize,
    /// Elements of `data` from one row to the next.
    row: usize,
    /// Elements of `data` from one channel to the next where each has a plane of its own, else 1.
    plane: usize,
}

impl Samples {
    /// Decodes the page that a reader is at.
    ///
    /// # Errors
    /// What the decoder says.
    pub(super) fn read(reader: &mut Decoder<impl Read + Seek>, limits: &Limits) -> TiffResult<Self> {
        let (width, height) = reader.dimensions()?;
        let color = reader.colortype()?;
        let extra = reader.find_tag_unsigned_vec::<u16>(Tag::ExtraSamples)?.unwrap_or_default();
        let separate =
            reader.find_tag_unsigned(Tag::PlanarConfiguration)? == Some(PlanarConfiguration::Planar.to_u16());
        let (data, layout) = if separate && reader.get_chunk_type() == ChunkType::Tile {
            tiles(reader, limits)?
        } else {
            let mut data = DecodingResult::U8(Vec::new());
            let layout = reader.read_image_to_buffer(&mut data)?;
            (data, layout)
        };
        let element = usize::from(color.bit_depth()).div_ceil(8);
        let row = layout.row_stride.map_or(0, |n| n.get()) / element;
        let (step, plane) = match layout.planes {
            0 | 1 => (usize::from(color.num_samples()), 1),
            _ => (1, layout.plane_stride.map_or(0, |n| n.get()) / element),
        };
        let premultiplied = extra.first() == Some(&1);
        Ok(Self { data, color, premultiplied, width, height, bits: color.bit_depth().into(), step, row, plane })
    }

    /// The image in the types of `image`, palettes resolved.
    ///
    /// # Errors
    /// The reason in words where samples are missing or of a kind that is not known.
    pub(super) fn image(&self, palette: Option<&[Rgb<u8>]>) -> std::result::Result<DynamicImage, String> {
        self.check()?;
        if let Some(palette) = palette {
            let full = ((1u32 << self.bits.min(16)) - 1) as f32;
            let color = |x, y| {
                let index = (self.sample(x, y, 0) * full).round() as usize;
                palette.get(index).copied().unwrap_or(Rgb([255; 3]))
            };
            return Ok(ImageBuffer::from_fn(self.width, self.height, color).into());
        }
        let (width, height) = (self.width, self.height);
        Ok(match (self.is_gray(), self.bits <= 8) {
            (true, true) => ImageBuffer::from_fn(width, height, |x, y| Luma([to_byte(self.sample(x, y, 0))])).into(),
            (true, false) => ImageBuffer::from_fn(width, height, |x, y| Luma([to_word(self.sample(x, y, 0))])).into(),
            (false, true) => ImageBuffer::from_fn(width, height, |x, y| Rgba(self.rgba(x, y).map(to_byte))).into(),
            (false, false) => ImageBuffer::from_fn(width, height, |x, y| Rgba(self.rgba(x, y).map(to_word))).into(),
        })
    }

    /// Whether every sample that will be asked for is there and of a type that is known.
    fn check(&self) -> std::result::Result<(), String> {
        let length = match &self.data {
            DecodingResult::U8(v) => v.len(),
            DecodingResult::U16(v) => v.len(),
            DecodingResult::U32(v) => v.len(),
            DecodingResult::F16(v) => v.len(),
            DecodingResult::F32(v) => v.len(),
            DecodingResult::F64(v) => v.len(),
            _ => return Err("signed TIFF samples are not supported".into()),
        };
        if matches!(self.color, ColorType::Lab(_)) || (self.bits < 8 && ![1, 2, 4].contains(&self.bits)) {
            return Err(format!("TIFF samples of the kind {:?} are not supported", self.color));
        }
        let planes = if self.plane > 1 { usize::from(self.color.num_samples()) } else { 1 };
        let needed = self.row * self.height as usize + (planes - 1) * self.plane;
        let columns = (self.width as usize * self.step * self.bits.min(8)).div_ceil(8);
        let whole = length >= needed && self.row >= columns;
        if whole { Ok(()) } else { Err("the TIFF has fewer samples than its size asks for".into()) }
    }

    fn is_gray(&self) -> bool {
        matches!(self.color, ColorType::Gray(_))
            || matches!(self.color, ColorType::Multiband { num_samples: n, .. } if n != 2)
    }

    /// A channel of a pixel as a fraction of its range.
    fn sample(&self, x: u32, y: u32, channel: usize) -> f32 {
        let (x, y) = (x as usize, y as usize);
        let (base, column) = if self.plane > 1 { (channel * self.plane, x) } else { (0, x * self.step + channel) };
        let line = base + y * self.row;
        match &self.data {
            DecodingResult::U8(v) if self.bits < 8 => {
                let (bit, mask) = (column * self.bits, (1u8 << self.bits) - 1);
                let byte = v[line + bit / 8] >> (8 - self.bits - bit % 8);
                f32::from(byte & mask) / f32::from(mask)
            }
            DecodingResult::U8(v) => f32::from(v[line + column]) / 255.0,
            DecodingResult::U16(v) => f32::from(v[line + column]) / 65535.0,
            DecodingResult::U32(v) => v[line + column] as f32 / u32::MAX as f32,
            DecodingResult::F16(v) => v[line + column].to_f32(),
            DecodingResult::F32(v) => v[line + column],
            DecodingResult::F64(v) => v[line + column] as f32,
            _ => 1.0,
        }
    }

    /// Red, green, blue and straight alpha of a pixel.
    fn rgba(&self, x: u32, y: u32) -> [f32; 4] {
        let s = |channel| self.sample(x, y, channel);
        match self.color {
            ColorType::RGB(_) => [s(0), s(1), s(2), 1.0],
            ColorType::RGBA(_) => self.straight([s(0), s(1), s(2), s(3)]),
            ColorType::Multiband { .. } | ColorType::GrayA(_) => self.straight([s(0), s(0), s(0), s(1)]),
            ColorType::CMYK(_) | ColorType::CMYKA(_) => {
                let light = 1.0 - s(3);
                [(1.0 - s(0)) * light, (1.0 - s(1)) * light, (1.0 - s(2)) * light, 1.0]
            }
            ColorType::YCbCr(_) => ycbcr(s(0), s(1) - 128.0 / 255.0, s(2) - 128.0 / 255.0),
            _ => [s(0), s(0), s(0), 1.0],
        }
    }

    fn straight(&self, [r, g, b, a]: [f32; 4]) -> [f32; 4] {
        if self.premultiplied && a > 0.0 { [r / a, g / a, b / a, a] } else { [r, g, b, a] }
    }
}

/// All planes of a page whose planes are in tiles: there the decoder takes the last tiles of all planes but the first for
/// whole ones, and writes beyond their plane.
fn tiles(
    reader: &mut Decoder<impl Read + Seek>,
    limits: &Limits,
) -> TiffResult<(DecodingResult, BufferLayoutPreference)> {
    let inconsistent = || TiffError::FormatError(TiffFormatError::InconsistentSizesEncountered);
    let stride = |length: Option<NonZeroUsize>| length.map_or(0, NonZeroUsize::get);
    let bits = usize::from(reader.colortype()?.bit_depth());
    let [(width, height), (across, down)] =
        [reader.dimensions()?, reader.chunk_dimensions()].map(|(w, h)| (w as usize, h as usize));
    let layout = reader.image_buffer_layout()?;
    let mut data = DecodingResult::U8(Vec::new());
    data.resize_to(&layout, limits)?;
    let mut buffer = data.as_buffer(0);
    let bytes = buffer.as_bytes_mut();
    let corners = (0..layout.planes).flat_map(|plane| {
        let rows = (0..height).step_by(down.max(1));
        rows.flat_map(move |y| (0..width).step_by(across.max(1)).map(move |x| (plane, x, y)))
    });
    for (index, (plane, x, y)) in (0..).zip(corners) {
        let shape = reader.image_chunk_buffer_layout(index)?;
        if shape.complete_len > limits.intermediate_buffer_size {
            return Err(TiffError::LimitsExceeded);
        }
        let mut tile = vec![0; shape.complete_len];
        reader.read_chunk_bytes(index, &mut tile)?;
        let first = plane * stride(layout.plane_stride) + y * stride(layout.row_stride) + x * bits / 8;
        for (k, row) in tile.chunks_exact(stride(shape.row_stride).max(1)).take(height - y).enumerate() {
            let start = first + k * stride(layout.row_stride);
            bytes.get_mut(start..start + row.len()).ok_or_else(inconsistent)?.copy_from_slice(row);
        }
    }
    Ok((data, layout))
}

/// ITU-R BT.601, full range.
fn ycbcr(y: f32, cb: f32, cr: f32) -> [f32; 4] {
    [y + 1.402 * cr, y - 0.344_136 * cb - 0.714_136 * cr, y + 1.772 * cb, 1.0]
}

fn to_byte(v: f32) -> u8 {
    (v * 255.0).round() as u8
}

fn to_word(v: f32) -> u16 {
    (v * 65535.0).round() as u16
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn luma_with_chroma_follows_the_primaries() {
        let bytes = |c: [u8; 3]| {
            let [y, cb, cr] = c.map(|v| f32::from(v) / 255.0);
            ycbcr(y, cb - 128.0 / 255.0, cr - 128.0 / 255.0).map(to_byte)
        };
        assert_eq!(bytes([255, 128, 128]), [255, 255, 255, 255]);
        assert_eq!(bytes([76, 85, 255]), [254, 0, 0, 255]);
        assert_eq!(bytes([0, 128, 128]), [0, 0, 0, 255]);
    }

    #[test]
    fn depths_come_back_exactly() {
        for v in 0..=255u8 {
            assert_eq!(to_byte(f32::from(v) / 255.0), v);
        }
        for v in 0..=65535u16 {
            assert_eq!(to_word(f32::from(v) / 65535.0), v);
        }
    }
}
