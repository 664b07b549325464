//! Dots per inch, as each format says it.

use super::jpeg;
use super::plan::Density;
use image::ImageFormat;
use std::io::Cursor;

/// Metres in an inch.
const INCH: f64 = 0.0254;

/// Whether a resolution in dots per inch can be meant.
pub(super) fn plausible(dpi: f64) -> bool {
    (1.0..=100_000.0).contains(&dpi)
}

/// The density that the bytes of a PNG, JPEG or BMP, or Exif metadata, tell; `None` where neither does.
///
/// A wrong or missing resolution is no reason to refuse an image, so nothing here fails.
pub(super) fn density(format: ImageFormat, bytes: &[u8], exif: Option<&[u8]>) -> Option<Density> {
    let own = match format {
        ImageFormat::Png => png_density(bytes),
        ImageFormat::Jpeg => jpeg::markers(bytes).density,
        ImageFormat::Bmp => bmp_density(bytes),
        _ => None,
    };
    own.filter(Density::is_size).or_else(|| exif_density(exif?)).or(own)
}

/// The density of a TIFF-style resolution across and down, and its unit: 1 is none, 2 an inch, 3 a centimetre.
pub(super) fn tiff_density(x: Option<f64>, y: Option<f64>, unit: u32) -> Option<Density> {
    let dpi = |factor: f64| {
        let dpi = |v: Option<f64>| v.map(|v| snap(v * factor, 1e-6));
        Density::inch(dpi(x), dpi(y))
    };
    match unit {
        1 => Density::shape(x?, y?),
        2 => dpi(1.0),
        3 => dpi(2.54),
        _ => None,
    }
}

/// The `pHYs` chunk.
fn png_density(bytes: &[u8]) -> Option<Density> {
    let reader = png::Decoder::new(Cursor::new(bytes)).read_info().ok()?;
    let dims = reader.info().pixel_dims?;
    let (x, y) = (f64::from(dims.xppu), f64::from(dims.yppu));
    match dims.unit {
        png::Unit::Meter => Density::inch(Some(per_metre(x)), Some(per_metre(y))),
        png::Unit::Unspecified => Density::shape(x, y),
    }
}

/// `biXPelsPerMeter` and `biYPelsPerMeter` of a `BITMAPINFOHEADER` or longer.
fn bmp_density(bytes: &[u8]) -> Option<Density> {
    let int = |at: usize| Some(i32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?));
    let dpi = |at: usize| int(at).filter(|&n| n > 0).map(|n| per_metre(f64::from(n)));
    if int(14)? >= 40 { Density::inch(dpi(38), dpi(42)) } else { None }
}

/// Whole dots per inch lose up to half a pixel per metre when they are stored per metre: that is given back.
fn per_metre(density: f64) -> f64 {
    snap(density * INCH, INCH / 2.0)
}

fn snap(value: f64, tolerance: f64) -> f64 {
    let whole = value.round();
    if (value - whole).abs() <= tolerance { whole } else { value }
}

/// `XResolution` and `YResolution` in the unit of `ResolutionUnit` (inches where it is missing).
#[cfg(feature = "formats")]
pub(super) fn exif_density(raw: &[u8]) -> Option<Density> {
    use exif::{In, Tag};
    let raw = raw.strip_prefix(b"Exif\0\0").unwrap_or(raw);
    let data = exif::Reader::new().read_raw(raw.to_vec()).ok()?;
    let unit = data.get_field(Tag::ResolutionUnit, In::PRIMARY).and_then(|f| f.value.get_uint(0)).unwrap_or(2);
    let value = |tag| match &data.get_field(tag, In::PRIMARY)?.value {
        exif::Value::Rational(values) => Some(values.first()?.to_f64()),
        _ => None,
    };
    tiff_density(value(Tag::XResolution), value(Tag::YResolution), unit)
}

#[cfg(not(feature = "formats"))]
pub(super) fn exif_density(_raw: &[u8]) -> Option<Density> {
    None
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
        let dpi = |value, unit| tiff_density(Some(value), None, unit).and_then(|density| density.dpi());
        assert_eq!(dpi(300.0, 2), Some(300.0));
        assert_eq!(dpi(118.110236, 3), Some(300.0));
        assert_eq!(dpi(118.5, 3), Some(118.5 * 2.54));
        assert_eq!(dpi(300.0, 1), None);
        assert_eq!(dpi(f64::NAN, 2), None);
        assert_eq!(dpi(0.0, 2), None);
        assert_eq!(tiff_density(Some(2.0), Some(1.0), 1), Density::shape(2.0, 1.0));
    }

    #[cfg(feature = "formats")]
    #[test]
    fn exif_is_read_with_and_without_its_prefix() {
        // Big-endian, one directory with XResolution (rational at 50) and ResolutionUnit.
        let mut raw = b"MM\0*\0\0\0\x08\0\x02".to_vec();
        raw.extend([0x01, 0x1A, 0, 5, 0, 0, 0, 1, 0, 0, 0, 38]);
        raw.extend([0x01, 0x28, 0, 3, 0, 0, 0, 1, 0, 3, 0, 0]);
        raw.extend([0, 0, 0, 0]);
        raw.extend([0, 0, 0, 100, 0, 0, 0, 1]);
        let dpi = |raw: &[u8]| exif_density(raw).and_then(|density| density.dpi());
        assert_eq!(dpi(&raw), Some(254.0));
        assert_eq!(dpi(&[b"Exif\0\0".to_vec(), raw.clone()].concat()), Some(254.0));
        for end in 0..raw.len() {
            exif_density(&raw[..end]);
        }
    }
}
