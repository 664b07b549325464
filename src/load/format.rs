//! Which format bytes are in, by what they begin with.

use super::undecodable;
use crate::error::Result;
use image::ImageFormat;

/// A format that is read here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    /// One of the `image` crate.
    Raster(ImageFormat),
    /// SVG, compressed or not.
    #[cfg(feature = "svg-input")]
    Svg,
    /// PDF.
    #[cfg(feature = "formats")]
    Pdf,
    /// JPEG XL, bare or in its container.
    #[cfg(feature = "formats")]
    JpegXl,
    /// JPEG 2000, bare or in its container.
    #[cfg(feature = "formats")]
    Jpeg2000,
    /// AVIF.
    #[cfg(feature = "avif")]
    Avif,
}

/// What is read, for those whose file is something else.
const SUPPORTED: &str = if cfg!(feature = "formats") {
    "PNG, JPEG, TIFF, PDF, SVG, WebP, BMP, GIF, PNM, TGA, QOI, JPEG XL and JPEG 2000 are"
} else {
    "PNG, JPEG, TIFF, BMP and PNM are"
};

/// What ends a TGA file of version 2.
const TGA_FOOTER: &[u8] = b"TRUEVISION-XFILE.\0";

/// The format of a file. TGA, which begins with nothing of its own, may be told by the name.
///
/// # Errors
/// [`crate::Error::Decode`] where it is none that is read here, with its name and what to do where they are known.
pub(super) fn detect(name: &str, bytes: &[u8]) -> Result<Format> {
    #[cfg(feature = "svg-input")]
    if super::svg::is_svg(bytes) {
        return Ok(Format::Svg);
    }
    if let Some(format) = beyond(bytes) {
        return format.map_err(|what| undecodable(name, format!("{what} is not supported by this build")));
    }
    if let Some((what, remedy)) = foreign(bytes) {
        return Err(undecodable(name, format!("{what} is not supported: {remedy}")));
    }
    let tga = || name.to_ascii_lowercase().ends_with(".tga").then_some(ImageFormat::Tga);
    let footed = bytes.ends_with(TGA_FOOTER).then_some(ImageFormat::Tga);
    // The `image` crate does not know TIFF with offsets of 64 bits by sight.
    let big_tiff = bytes.starts_with(b"II+\0") || bytes.starts_with(b"MM\0+");
    let known = || if big_tiff { Some(ImageFormat::Tiff) } else { image::guess_format(bytes).ok() };
    match footed.or_else(known).or_else(tga) {
        None => Err(undecodable(name, format!("this is not an image in a known format ({SUPPORTED})"))),
        Some(format) if format.reading_enabled() => Ok(Format::Raster(format)),
        Some(format) => Err(undecodable(name, format!("{} is not supported ({SUPPORTED})", format.to_mime_type()))),
    }
}

/// The brands in the `ftyp` box that a file of the ISO base format begins with.
fn brands(bytes: &[u8]) -> impl Iterator<Item = &[u8]> {
    let length = bytes.get(..4).map_or(0, |b| u32::from_be_bytes([b[0], b[1], b[2], b[3]]) as usize);
    let is_ftyp = bytes.get(4..8) == Some(b"ftyp");
    let content = bytes.get(8..length.clamp(8, 256).min(bytes.len())).filter(|_| is_ftyp).unwrap_or_default();
    // The second four bytes are a version.
    content.chunks_exact(4).enumerate().filter(|(i, _)| *i != 1).map(|(_, brand)| brand)
}

/// A format that the `image` crate does not know and that is read here, or its name where this build leaves it out.
fn beyond(bytes: &[u8]) -> Option<std::result::Result<Format, &'static str>> {
    // Mail programs and printers put lines before the header of a PDF.
    let inside = || bytes[..bytes.len().min(1024)].windows(5).any(|w| w == b"%PDF-");
    let pdf = bytes.starts_with(b"%PDF-") || (image::guess_format(bytes).is_err() && inside());
    let jxl = [&b"\xFF\x0A"[..], b"\0\0\0\x0CJXL \r\n\x87\n"].iter().any(|magic| bytes.starts_with(magic));
    let jp2 = [&b"\xFF\x4F\xFF\x51"[..], b"\0\0\0\x0CjP  \r\n\x87\n"].iter().any(|magic| bytes.starts_with(magic));
    let avif = brands(bytes).any(|brand| brand == b"avif" || brand == b"avis");
    #[cfg(feature = "avif")]
    let last = Ok(Format::Avif);
    #[cfg(not(feature = "avif"))]
    let last = Err("AVIF");
    #[cfg(feature = "formats")]
    let formats = [Ok(Format::Pdf), Ok(Format::JpegXl), Ok(Format::Jpeg2000), last];
    #[cfg(not(feature = "formats"))]
    let formats = [Err("PDF"), Err("JPEG XL"), Err("JPEG 2000"), last];
    [pdf, jxl, jp2, avif].into_iter().zip(formats).find_map(|(is, format)| is.then_some(format))
}

/// A format that drawings come in and that is not read here, and what can be done with it.
fn foreign(bytes: &[u8]) -> Option<(&'static str, &'static str)> {
    if brands(bytes).any(|brand| matches!(brand, b"heic" | b"heix" | b"heim" | b"heis" | b"hevc" | b"mif1")) {
        return Some(("HEIC", "save it as PNG or JPEG"));
    }
    let starts: [(&[u8], &str, &str); 7] = [
        (b"%!PS", "PostScript", "save it as PDF"),
        (b"\xC5\xD0\xD3\xC6", "PostScript", "save it as PDF"),
        (b"8BPS", "PSD", "save it as PNG or TIFF"),
        (b"gimp xcf", "XCF", "export it as PNG"),
        (b"AT&TFORM", "DjVu", "save it as PDF or PNG"),
        (b"AC10", "DWG", "plot it as PDF"),
        (b"\0\0\x01\0", "ICO", "save it as PNG"),
    ];
    starts.iter().find(|(magic, ..)| bytes.starts_with(magic)).map(|&(_, what, remedy)| (what, remedy))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_formats_are_named_with_a_remedy() {
        let error = |bytes: &[u8]| detect("plan", bytes).unwrap_err().to_string();
        assert_eq!(error(b"%!PS-Adobe-3.0 EPSF"), "plan: PostScript is not supported: save it as PDF");
        assert_eq!(error(b"8BPS\0\x01"), "plan: PSD is not supported: save it as PNG or TIFF");
        let heic = b"\0\0\0\x18ftypmif1\0\0\0\0mif1heic";
        assert_eq!(error(heic), "plan: HEIC is not supported: save it as PNG or JPEG");
        assert!(error(b"hello world").contains("not an image in a known format"));
        assert!(error(b"").contains("not an image in a known format"));
    }

    #[test]
    #[cfg(feature = "formats")]
    fn formats_are_told_by_their_bytes() {
        let of = |bytes: &[u8]| detect("-", bytes).unwrap();
        assert_eq!(of(b"%PDF-1.7\n"), Format::Pdf);
        assert_eq!(of(b"\x1B%-12345X@PJL\n%PDF-1.4\n"), Format::Pdf);
        assert_eq!(of(b"\xFF\x0A\xFA\x7F"), Format::JpegXl);
        assert_eq!(of(b"\xFF\x4F\xFF\x51\0\x2F"), Format::Jpeg2000);
        #[cfg(feature = "avif")]
        assert_eq!(of(b"\0\0\0\x1Cftypmif1\0\0\0\0mif1avifmiaf"), Format::Avif);
        assert_eq!(of(b"qoif\0\0\0\x01"), Format::Raster(ImageFormat::Qoi));
        assert_eq!(of(&[&[0; 40][..], TGA_FOOTER].concat()), Format::Raster(ImageFormat::Tga));
        assert_eq!(detect("A.TGA", &[0, 0, 2, 0, 0]).unwrap(), Format::Raster(ImageFormat::Tga));
        assert!(detect("a.tif", &[0, 0, 2, 0, 0]).is_err());
    }
}
