//! TIFF: what scanners write, from bilevel CCITT group 4 to 16-bit colour.
//!
//! The `tiff` crate is used directly, as `image` refuses palettes, 2 and 4 bits, and luma with chroma. Two things that
//! the crate leaves out are mended in the bytes before they reach it: the bit order of `FillOrder` 2, and palettes,
//! which are decoded as if they were grey to get at their indices.

use super::bitmap::Decoded;
use super::{LoadOptions, group3, resolution, undecodable};
use crate::error::Result;
use image::metadata::Orientation;
use image::{DynamicImage, ImageBuffer, Luma, Rgb, Rgba};
use std::borrow::Cow;
use std::io::Cursor;
use tiff::decoder::{Decoder, DecodingResult, Limits, ifd::Value};
use tiff::tags::{CompressionMethod, PhotometricInterpretation, Tag};
use tiff::{ColorType, TiffError, TiffResult};

/// The tag that tells one-dimensional from two-dimensional group 3 coding.
const T4_OPTIONS: u16 = 292;

type Reader<'a> = Decoder<Cursor<&'a [u8]>>;

/// Decodes the first full-size page.
///
/// # Errors
/// [`crate::Error::Decode`] and [`crate::Error::TooLarge`].
pub(super) fn decode(name: &str, bytes: &[u8], options: &LoadOptions) -> Result<Decoded> {
    let damaged = |e: TiffError| undecodable(name, e);
    let mut reader = open(bytes, options).map_err(damaged)?;
    let (width, height) = reader.dimensions().map_err(damaged)?;
    options.check_size(name, width.into(), height.into())?;
    let orientation = unsigned(&mut reader, Tag::Orientation).and_then(|o| Orientation::from_exif(o.try_into().ok()?));
    let dpi = dpi(&mut reader);
    let palette = palette(&mut reader).map_err(damaged)?;
    let mended = mend(bytes, &mut reader, palette.is_some()).map_err(damaged)?;
    let mut reader = open(&mended, options).map_err(damaged)?;
    let image = if unsigned(&mut reader, Tag::Compression) == Some(u32::from(CompressionMethod::Fax3.to_u16())) {
        let strips = strips(&mut reader, &mended).map_err(damaged)?;
        group3::decode(&strips, width, height).map(DynamicImage::from)
    } else {
        Samples::read(&mut reader).map_err(damaged)?.image(palette.as_deref())
    };
    let image = image.map_err(|reason| undecodable(name, reason))?;
    Ok(Decoded { image, orientation: orientation.unwrap_or(Orientation::NoTransforms), dpi })
}

/// The data of a CCITT group 3 page, which the decoder does not know.
fn strips<'a>(reader: &mut Reader, bytes: &'a [u8]) -> TiffResult<group3::Strips<'a>> {
    let ranges =
        reader.get_tag_u64_vec(Tag::StripOffsets)?.into_iter().zip(reader.get_tag_u64_vec(Tag::StripByteCounts)?);
    let clip = |at: u64| usize::try_from(at).unwrap_or(usize::MAX).min(bytes.len());
    let white_is_zero = u32::from(PhotometricInterpretation::WhiteIsZero.to_u16());
    Ok(group3::Strips {
        data: ranges.map(|(at, count)| &bytes[clip(at)..clip(at.saturating_add(count))]).collect(),
        rows: unsigned(reader, Tag::RowsPerStrip).unwrap_or(u32::MAX),
        two_dimensional: unsigned(reader, Tag::Unknown(T4_OPTIONS)).unwrap_or(0) & 1 == 1,
        white_is_zero: unsigned(reader, Tag::PhotometricInterpretation) == Some(white_is_zero),
    })
}

/// A decoder at the first page that is not a thumbnail.
fn open<'a>(bytes: &'a [u8], options: &LoadOptions) -> TiffResult<Reader<'a>> {
    let most = usize::try_from(options.max_pixels.saturating_mul(16)).unwrap_or(usize::MAX).saturating_add(1 << 20);
    let mut limits = Limits::default();
    limits.decoding_buffer_size = most;
    limits.intermediate_buffer_size = most;
    let mut reader = Decoder::new(Cursor::new(bytes))?.with_limits(limits);
    let reduced = |reader: &mut Reader| unsigned(reader, Tag::NewSubfileType).unwrap_or(0) & 1 == 1;
    while reduced(&mut reader) && reader.more_images() {
        reader.next_image()?;
    }
    Ok(reader)
}

fn unsigned(reader: &mut Reader, tag: Tag) -> Option<u32> {
    reader.find_tag_unsigned(tag).ok().flatten()
}

fn dpi(reader: &mut Reader) -> Option<f64> {
    let unit = unsigned(reader, Tag::ResolutionUnit).unwrap_or(2);
    let value = match reader.find_tag(Tag::XResolution).ok()?? {
        Value::Rational(n, d) => f64::from(n) / f64::from(d),
        Value::Float(v) => f64::from(v),
        Value::Short(v) => f64::from(v),
        Value::Unsigned(v) => f64::from(v),
        _ => return None,
    };
    resolution::tiff_dpi(value, unit)
}

/// The colours of a palette image; `None` for any other.
fn palette(reader: &mut Reader) -> TiffResult<Option<Vec<Rgb<u8>>>> {
    let photometric = unsigned(reader, Tag::PhotometricInterpretation);
    if photometric != Some(u32::from(PhotometricInterpretation::RGBPalette.to_u16())) {
        return Ok(None);
    }
    let map = reader.get_tag_u16_vec(Tag::ColorMap)?;
    // The values are of 16 bits; some writers store 8.
    let shift = if map.iter().all(|&v| v < 256) { 0 } else { 8 };
    let n = map.len() / 3;
    let channel = |i: usize| (map[i] >> shift) as u8;
    Ok(Some((0..n).map(|i| Rgb([channel(i), channel(n + i), channel(2 * n + i)])).collect()))
}

/// The file with its bits in the order, and its photometric interpretation of the kind, that the decoder knows.
fn mend<'a>(bytes: &'a [u8], reader: &mut Reader, palette: bool) -> TiffResult<Cow<'a, [u8]>> {
    let mut mended = Cow::Borrowed(bytes);
    let jpeg = unsigned(reader, Tag::Compression) == Some(u32::from(CompressionMethod::ModernJPEG.to_u16()));
    if unsigned(reader, Tag::FillOrder) == Some(2) && !jpeg {
        reverse_bits(reader, mended.to_mut())?;
    }
    if palette && let Some(ifd) = reader.ifd_pointer() {
        // Where the entry is not found the decoder says what it makes of the palette.
        let _ = read_as_gray(mended.to_mut(), ifd.0);
    }
    Ok(mended)
}

/// Reverses the bits of each byte of the strips or tiles.
fn reverse_bits(reader: &mut Reader, bytes: &mut [u8]) -> TiffResult<()> {
    let tiled = reader.find_tag(Tag::TileOffsets)?.is_some();
    let (offsets, counts) =
        if tiled { (Tag::TileOffsets, Tag::TileByteCounts) } else { (Tag::StripOffsets, Tag::StripByteCounts) };
    let ranges = reader.get_tag_u64_vec(offsets)?.into_iter().zip(reader.get_tag_u64_vec(counts)?);
    let mut done = 0;
    for (offset, count) in ranges {
        // Chunks come in order and apart from one another in any sound file; this keeps others from taking long.
        let start = usize::try_from(offset).unwrap_or(usize::MAX).max(done).min(bytes.len());
        let end = usize::try_from(offset.saturating_add(count)).unwrap_or(usize::MAX).clamp(start, bytes.len());
        bytes[start..end].iter_mut().for_each(|b| *b = b.reverse_bits());
        done = end;
    }
    Ok(())
}

/// Sets the photometric interpretation in the directory at `ifd` to "black is zero".
fn read_as_gray(bytes: &mut [u8], ifd: u64) -> Option<()> {
    let little = bytes.starts_with(b"II");
    let short = |b: &[u8], at: usize| {
        let pair = [*b.get(at)?, *b.get(at + 1)?];
        Some(if little { u16::from_le_bytes(pair) } else { u16::from_be_bytes(pair) })
    };
    let big = short(bytes, 2)? == 43;
    let (head, entry, value) = if big { (8, 20, 12) } else { (2, 12, 8) };
    let first = usize::try_from(ifd).ok()?.checked_add(head)?;
    let at = (first..bytes.len())
        .step_by(entry)
        .find(|&at| short(bytes, at) == Some(Tag::PhotometricInterpretation.to_u16()))?;
    let one = if little { 1u16.to_le_bytes() } else { 1u16.to_be_bytes() };
    bytes.get_mut(at + value..at + value + 2)?.copy_from_slice(&one);
    Some(())
}

/// The decoded samples and how they lie.
struct Samples {
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
    fn read(reader: &mut Reader) -> TiffResult<Self> {
        let (width, height) = reader.dimensions()?;
        let color = reader.colortype()?;
        let extra = reader.find_tag_unsigned_vec::<u16>(Tag::ExtraSamples)?.unwrap_or_default();
        let mut data = DecodingResult::U8(Vec::new());
        let layout = reader.read_image_to_buffer(&mut data)?;
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
    fn image(&self, palette: Option<&[Rgb<u8>]>) -> std::result::Result<DynamicImage, String> {
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
