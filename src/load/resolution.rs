//! Dots per inch, as each format says it.

use super::jpeg;
use image::ImageFormat;
use std::io::Cursor;

/// Metres in an inch.
const INCH: f64 = 0.0254;

/// Whether a resolution in dots per inch can be meant.
pub(super) fn plausible(dpi: f64) -> bool {
    (1.0..=100_000.0).contains(&dpi)
}

/// Dots per inch of the bytes of a PNG, JPEG or BMP, or of Exif metadata; `None` where neither says.
///
/// A wrong or missing resolution is no reason to refuse an image, so nothing here fails.
pub(super) fn dpi(format: ImageFormat, bytes: &[u8], exif: Option<&[u8]>) -> Option<f64> {
    let own = match format {
        ImageFormat::Png => png_dpi(bytes),
        ImageFormat::Jpeg => jpeg::markers(bytes).dpi,
        ImageFormat::Bmp => bmp_dpi(bytes),
        _ => None,
    };
    own.filter(|&d| plausible(d)).or_else(|| exif_dpi(exif?)).filter(|&d| plausible(d))
}

/// Dots per inch of a TIFF-style resolution and its unit: 2 is per inch, 3 per centimetre, all else is no resolution.
pub(super) fn tiff_dpi(resolution: f64, unit: u32) -> Option<f64> {
    let dpi = match unit {
        2 => resolution,
        3 => resolution * 2.54,
        _ => return None,
    };
    plausible(dpi).then(|| snap(dpi, 1e-6))
}

/// The `pHYs` chunk.
fn png_dpi(bytes: &[u8]) -> Option<f64> {
    let reader = png::Decoder::new(Cursor::new(bytes)).read_info().ok()?;
    let dims = reader.info().pixel_dims?;
    matches!(dims.unit, png::Unit::Meter).then(|| per_metre(f64::from(dims.xppu)))
}

/// `biXPelsPerMeter` of a `BITMAPINFOHEADER` or longer.
fn bmp_dpi(bytes: &[u8]) -> Option<f64> {
    let int = |at: usize| Some(i32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?));
    (int(14)? >= 40).then(|| int(38)).flatten().filter(|&n| n > 0).map(|n| per_metre(f64::from(n)))
}

/// Whole dots per inch lose up to half a pixel per metre when they are stored per metre: that is given back.
fn per_metre(density: f64) -> f64 {
    snap(density * INCH, INCH / 2.0)
}

fn snap(value: f64, tolerance: f64) -> f64 {
    let whole = value.round();
    if (value - whole).abs() <= tolerance { whole } else { value }
}

/// `XResolution` in the unit of `ResolutionUnit` (inches where it is missing).
fn exif_dpi(raw: &[u8]) -> Option<f64> {
    use exif::{In, Tag};
    let raw = raw.strip_prefix(b"Exif\0\0").unwrap_or(raw);
    let data = exif::Reader::new().read_raw(raw.to_vec()).ok()?;
    let unit = data.get_field(Tag::ResolutionUnit, In::PRIMARY).and_then(|f| f.value.get_uint(0)).unwrap_or(2);
    match &data.get_field(Tag::XResolution, In::PRIMARY)?.value {
        exif::Value::Rational(values) => tiff_dpi(values.first()?.to_f64(), unit),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_resolutions_survive_being_stored_per_metre() {
        for dpi in [72u32, 96, 150, 200, 254, 300, 600, 1200, 2400] {
            let stored = (f64::from(dpi) / INCH).round();
            assert_eq!(per_metre(stored), f64::from(dpi));
        }
        assert_eq!(per_metre(11830.0), 11830.0 * INCH);
    }

    #[test]
    fn units_and_nonsense() {
        assert_eq!(tiff_dpi(300.0, 2), Some(300.0));
        assert_eq!(tiff_dpi(118.110236, 3), Some(300.0));
        assert_eq!(tiff_dpi(118.5, 3), Some(118.5 * 2.54));
        assert_eq!(tiff_dpi(300.0, 1), None);
        assert_eq!(tiff_dpi(f64::NAN, 2), None);
        assert_eq!(tiff_dpi(0.0, 2), None);
    }

    #[test]
    fn exif_is_read_with_and_without_its_prefix() {
        // Big-endian, one directory with XResolution (rational at 50) and ResolutionUnit.
        let mut raw = b"MM\0*\0\0\0\x08\0\x02".to_vec();
        raw.extend([0x01, 0x1A, 0, 5, 0, 0, 0, 1, 0, 0, 0, 38]);
        raw.extend([0x01, 0x28, 0, 3, 0, 0, 0, 1, 0, 3, 0, 0]);
        raw.extend([0, 0, 0, 0]);
        raw.extend([0, 0, 0, 100, 0, 0, 0, 1]);
        assert_eq!(exif_dpi(&raw), Some(254.0));
        assert_eq!(exif_dpi(&[b"Exif\0\0".to_vec(), raw.clone()].concat()), Some(254.0));
        for end in 0..raw.len() {
            exif_dpi(&raw[..end]);
        }
    }
}
