//! TIFF: what scanners write, from bilevel CCITT group 4 to 16-bit colour.
//!
//! The `tiff` crate is used directly, as `image` refuses palettes, 2 and 4 bits, and luma with chroma. Two things that
//! the crate leaves out are mended in the bytes before they reach it: the bit order of `FillOrder` 2, and palettes,
//! which are decoded as if they were grey to get at their indices.

mod directories;
mod samples;

pub(super) use directories::pages;

use super::bitmap::{Decoded, limits};
use super::plan::{Density, Header};
use super::{LoadOptions, group3, resolution, undecodable};
use crate::error::Result;
use directories::At;
use image::metadata::Orientation;
use image::{DynamicImage, Rgb};
use samples::Samples;
use std::borrow::Cow;
use tiff::decoder::{Decoder, Limits, ifd::Value};
use tiff::tags::{CompressionMethod, PhotometricInterpretation, Tag};
use tiff::{TiffError, TiffResult};

/// The tag that tells one-dimensional from two-dimensional group 3 coding.
const T4_OPTIONS: u16 = 292;

type Reader<'a> = Decoder<At<'a>>;

/// Decodes the page whose directory is at an offset.
///
/// # Errors
/// [`crate::Error::Decode`] and [`crate::Error::TooLarge`].
pub(super) fn decode(name: &str, bytes: &[u8], directory: u64, options: &LoadOptions) -> Result<Decoded> {
    let damaged = |e: TiffError| undecodable(name, e);
    let mut reader = open(bytes, directory, options).map_err(damaged)?;
    let (width, height) = reader.dimensions().map_err(damaged)?;
    let orientation = unsigned(&mut reader, Tag::Orientation).and_then(|o| Orientation::from_exif(o.try_into().ok()?));
    let orientation = orientation.unwrap_or(Orientation::NoTransforms);
    let plan = Header { width, height, orientation, density: density(&mut reader) }.plan(name, options)?;
    let compression = unsigned(&mut reader, Tag::Compression);
    if let Some(what) = compression.and_then(unsupported) {
        let reason = format!("the TIFF is compressed by {what}, which is not supported: save it with LZW or Deflate");
        return Err(undecodable(name, reason));
    }
    let palette = palette(&mut reader).map_err(damaged)?;
    let mended = mend(bytes, &mut reader, palette.is_some()).map_err(damaged)?;
    let mut reader = open(&mended, directory, options).map_err(damaged)?;
    let image = if compression == Some(u32::from(CompressionMethod::Fax3.to_u16())) {
        let strips = strips(&mut reader, &mended).map_err(damaged)?;
        group3::decode(&strips, width, height).map(DynamicImage::from)
    } else {
        Samples::read(&mut reader, &bounds(options)).map_err(damaged)?.image(palette.as_deref())
    };
    Ok(Decoded { image: image.map_err(|reason| undecodable(name, reason))?, plan })
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

/// A decoder at the page whose directory is at an offset.
fn open<'a>(bytes: &'a [u8], directory: u64, options: &LoadOptions) -> TiffResult<Reader<'a>> {
    Ok(Decoder::new(At::new(bytes, directory))?.with_limits(bounds(options)))
}

/// What the decoder may allocate.
fn bounds(options: &LoadOptions) -> Limits {
    let most = limits(options).max_alloc.and_then(|bytes| usize::try_from(bytes).ok()).unwrap_or(usize::MAX);
    let mut limits = Limits::default();
    limits.decoding_buffer_size = most;
    limits.intermediate_buffer_size = most;
    limits
}

/// The name of a compression that is not supported.
fn unsupported(compression: u32) -> Option<&'static str> {
    Some(match compression {
        2 => "Huffman codes of CCITT",
        6 => "JPEG of the old kind",
        32809 => "ThunderScan",
        34661 => "JBIG",
        34712 => "JPEG 2000",
        34887 => "LERC",
        34925 => "LZMA",
        34933 => "PNG",
        50000 => "Zstandard",
        50001 => "WebP",
        50002 | 52546 => "JPEG XL",
        _ => return None,
    })
}

fn unsigned(reader: &mut Reader, tag: Tag) -> Option<u32> {
    reader.find_tag_unsigned(tag).ok().flatten()
}

fn density(reader: &mut Reader) -> Option<Density> {
    let unit = unsigned(reader, Tag::ResolutionUnit).unwrap_or(2);
    let mut value = |tag| match reader.find_tag(tag).ok()?? {
        Value::Rational(n, d) => Some(f64::from(n) / f64::from(d)),
        Value::Float(v) => Some(f64::from(v)),
        Value::Short(v) => Some(f64::from(v)),
        Value::Unsigned(v) => Some(f64::from(v)),
        _ => None,
    };
    let (x, y) = (value(Tag::XResolution), value(Tag::YResolution));
    resolution::tiff_density(x, y, unit)
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
