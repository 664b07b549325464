//! Orientation and resolution of each format that has them.

use crate::fixtures::{Field, Png, assert_close, blocks, encode, exif, fractions, load, page, short, tiff};
use fieldtrace::load::{LoadOptions, load_bytes};
use image::codecs::jpeg::{JpegEncoder, PixelDensity, PixelDensityUnit};
use image::codecs::png::PngEncoder;
use image::codecs::webp::WebPEncoder;
use image::{GrayImage, ImageEncoder, ImageFormat, Luma};

/// The image that is seen where `stored` has an Exif orientation: where row 0 and column 0 lie is its definition.
fn upright(stored: &GrayImage, orientation: u16) -> GrayImage {
    let (w, h) = stored.dimensions();
    let (width, height) = if orientation < 5 { (w, h) } else { (h, w) };
    let mut seen = GrayImage::new(width, height);
    for (x, y, &p) in stored.enumerate_pixels() {
        let (left, top) = ((x, w - 1 - x), (y, h - 1 - y));
        let (x, y) = match orientation {
            2 => (left.1, top.0),
            3 => (left.1, top.1),
            4 => (left.0, top.1),
            5 => (top.0, left.0),
            6 => (top.1, left.0),
            7 => (top.1, left.1),
            8 => (top.0, left.1),
            _ => (left.0, top.0),
        };
        seen.put_pixel(x, y, p);
    }
    seen
}

fn with_exif(mut encoder: impl ImageEncoder, image: &GrayImage, exif: Vec<u8>) {
    encoder.set_exif_metadata(exif).unwrap();
    image.write_with_encoder(encoder).unwrap();
}

#[test]
fn every_orientation_is_turned_upright() {
    let stored = blocks();
    for orientation in 1..=8 {
        let seen = upright(&stored, orientation);
        let (mut png, mut jpeg, mut webp) = (Vec::new(), Vec::new(), Vec::new());
        with_exif(PngEncoder::new(&mut png), &stored, exif(orientation, 300));
        with_exif(JpegEncoder::new_with_quality(&mut jpeg, 100), &stored, exif(orientation, 300));
        with_exif(WebPEncoder::new_lossless(&mut webp), &stored, exif(orientation, 300));
        let mut fields = page(24, 16, &[8], 1, 1);
        fields.push((274, short(orientation)));
        let tiff = tiff(false, &fields, stored.as_raw());
        for (name, bytes, tolerance) in
            [("png", png, 0.0), ("jpeg", jpeg, 0.01), ("webp", webp, 0.0), ("tiff", tiff, 0.0)]
        {
            let scan = load(&bytes).scan;
            let size = (seen.width() as usize, seen.height() as usize);
            assert_eq!(scan.gray.size(), size, "{name} {orientation}");
            assert_close(scan.gray.data(), &fractions(&seen), tolerance);
        }
    }
}

#[test]
fn png_resolution() {
    let dpi = |per_metre: u32, unit: u8| {
        let data = [&per_metre.to_be_bytes()[..], &per_metre.to_be_bytes(), &[unit]].concat();
        let chunks = [(b"pHYs", data)];
        let data = vec![0, 0];
        load(&Png { width: 1, height: 1, depth: 8, color: 0, interlaced: false, chunks: &chunks, data }.bytes())
            .scan
            .dpi
    };
    assert_eq!(dpi(11811, 1), Some(300.0));
    assert_eq!(dpi(2835, 1), Some(72.0));
    assert_eq!(dpi(10_000, 1), Some(254.0));
    assert_eq!(dpi(1, 0), None, "a ratio is no resolution");
    assert_eq!(dpi(0, 1), None);
}

#[test]
fn jpeg_resolution() {
    let dpi = |density: Option<PixelDensity>, exif: Option<Vec<u8>>| {
        let mut bytes = Vec::new();
        let mut encoder = JpegEncoder::new(&mut bytes);
        density.into_iter().for_each(|d| encoder.set_pixel_density(d));
        exif.into_iter().for_each(|e| encoder.set_exif_metadata(e).unwrap());
        blocks().write_with_encoder(encoder).unwrap();
        load(&bytes).scan.dpi
    };
    assert_eq!(dpi(Some(PixelDensity::dpi(300)), None), Some(300.0));
    let metric = PixelDensity { density: (100, 100), unit: PixelDensityUnit::Centimeters };
    assert_eq!(dpi(Some(metric), None), Some(254.0));
    assert_eq!(dpi(None, None), None);
    assert_eq!(dpi(None, Some(exif(1, 240))), Some(240.0));
}

#[test]
fn tiff_resolution() {
    let dpi = |big_endian, n, d, unit: Option<u16>| {
        let mut fields = page(1, 1, &[8], 1, 1);
        fields.push((282, Field::Rational(n, d)));
        fields.extend(unit.map(|u| (296, short(u))));
        load(&tiff(big_endian, &fields, &[0])).scan.dpi
    };
    assert_eq!(dpi(false, 6000, 10, Some(2)), Some(600.0));
    assert_eq!(dpi(true, 300, 1, None), Some(300.0));
    assert_eq!(dpi(true, 100, 1, Some(3)), Some(254.0));
    assert_eq!(dpi(false, 300, 1, Some(1)), None);
    assert_eq!(dpi(false, 1, 0, Some(2)), None);
}

#[test]
fn bmp_resolution() {
    let mut bytes = encode(GrayImage::from_pixel(2, 2, Luma([7])), ImageFormat::Bmp);
    bytes[38..42].copy_from_slice(&23622u32.to_le_bytes());
    assert_eq!(load(&bytes).scan.dpi, Some(600.0));
    bytes[38..42].copy_from_slice(&(-1i32).to_le_bytes());
    assert_eq!(load(&bytes).scan.dpi, None);
}

#[test]
fn the_option_overrides_the_file() {
    let mut bytes = Vec::new();
    let mut encoder = JpegEncoder::new(&mut bytes);
    encoder.set_pixel_density(PixelDensity::dpi(300));
    blocks().write_with_encoder(encoder).unwrap();
    let options = LoadOptions::default().with(|o| o.dpi = Some(150.0.into()));
    let scan = load_bytes("x.jpg", &bytes, &options).unwrap().scan;
    assert_eq!((scan.dpi, scan.gray.size()), (Some(150.0), (24, 16)));
}
