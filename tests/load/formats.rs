//! Pixels of each raster format and depth.

use crate::fixtures::{Png, assert_close, blocks, encode, fractions, gray, load};
use fieldtrace::load::{LoadOptions, load_bytes};
use image::{DynamicImage, GrayImage, ImageFormat, Luma, LumaA, Rgb, RgbImage, Rgba, RgbaImage};

fn png(width: u32, height: u32, depth: u8, color: u8, data: Vec<u8>) -> Vec<u8> {
    Png { width, height, depth, color, interlaced: false, chunks: &[], data }.bytes()
}

#[test]
fn png_grey_of_every_depth() {
    assert_eq!(gray(&png(5, 1, 1, 0, vec![0, 0b1010_0000])), [1.0, 0.0, 1.0, 0.0, 0.0]);
    assert_close(&gray(&png(4, 1, 2, 0, vec![0, 0b0001_1011])), &[0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0], 1e-6);
    assert_close(&gray(&png(3, 1, 4, 0, vec![0, 0x05, 0xF0])), &[0.0, 5.0 / 15.0, 1.0], 1e-6);
    assert_close(&gray(&png(3, 1, 8, 0, vec![0, 0, 77, 255])), &[0.0, 77.0 / 255.0, 1.0], 1e-7);
    let deep = gray(&png(2, 1, 16, 0, vec![0, 0x30, 0x39, 0x30, 0x3A]));
    assert_eq!(deep, [12345.0 / 65535.0, 12346.0 / 65535.0], "16 bits are kept");
}

#[test]
fn png_palette_with_transparency() {
    let chunks = [(b"PLTE", vec![255, 0, 0, 0, 0, 0, 10, 20, 30]), (b"tRNS", vec![255, 128, 0])];
    let data = vec![0, 0b0001_1000];
    let bytes = Png { width: 3, height: 1, depth: 2, color: 3, interlaced: false, chunks: &chunks, data }.bytes();
    let scan = load(&bytes).scan;
    assert_close(scan.gray.data(), &[0.2126, 127.0 / 255.0, 1.0], 1e-6);
    let rgb = scan.rgb.unwrap();
    assert_eq!(rgb.as_raw()[..], [255, 0, 0, 127, 127, 127, 255, 255, 255]);
}

#[test]
fn png_alpha_lies_over_white() {
    let image = RgbaImage::from_fn(3, 1, |x, _| Rgba([0, 0, 0, [0, 102, 255][x as usize]]));
    let scan = load(&encode(image, ImageFormat::Png)).scan;
    assert_close(scan.gray.data(), &[1.0, 0.6, 0.0], 1e-6);
    assert!(scan.rgb.is_none(), "black at any alpha is grey");
    let image = image::ImageBuffer::from_fn(2, 1, |x, _| LumaA([30000u16, [0, 32768][x as usize]]));
    let expected = 1.0 - 32768.0 / 65535.0 * (1.0 - 30000.0 / 65535.0);
    assert_close(&gray(&encode(DynamicImage::ImageLumaA16(image), ImageFormat::Png)), &[1.0, expected], 1e-6);
}

#[test]
fn png_interlaced() {
    let image = GrayImage::from_fn(11, 9, |x, y| Luma([(x * 20 + y * 3) as u8]));
    let passes = [(0, 0, 8, 8), (4, 0, 8, 8), (0, 4, 4, 8), (2, 0, 4, 4), (0, 2, 2, 4), (1, 0, 2, 2), (0, 1, 1, 2)];
    let mut data = Vec::new();
    for (x0, y0, dx, dy) in passes {
        for y in (y0..9).step_by(dy) {
            data.push(0);
            data.extend((x0..11).step_by(dx).map(|x| image.get_pixel(x, y as u32)[0]));
        }
    }
    let bytes = Png { width: 11, height: 9, depth: 8, color: 0, interlaced: true, chunks: &[], data }.bytes();
    assert_eq!(gray(&bytes), fractions(&image));
}

#[test]
fn lossless_formats_keep_grey_and_colour() {
    let color = RgbImage::from_fn(7, 5, |x, y| Rgb([(x * 30) as u8, (y * 50) as u8, 200]));
    use ImageFormat::{Bmp, Gif, Png, Pnm, Qoi, Tiff, WebP};
    for format in [Png, Tiff, WebP, Bmp, Pnm, Qoi] {
        let scan = load(&encode(color.clone(), format)).scan;
        assert_eq!(scan.rgb.as_ref(), Some(&color), "{format:?}");
        assert_eq!(scan.gray.size(), (7, 5));
        let expected = (0.2126 * 30.0 + 0.7152 * 100.0 + 0.0722 * 200.0) / 255.0;
        assert!((scan.gray[(1, 2)] - expected).abs() < 1e-6, "{format:?}");
    }
    let line = GrayImage::from_fn(9, 4, |x, y| Luma([if x == y { 0 } else { 255 }]));
    for format in [Png, Tiff, WebP, Bmp, Pnm, Gif, Qoi] {
        let image = DynamicImage::ImageLuma8(line.clone());
        let image = if matches!(format, Gif | WebP | Qoi) { image.to_rgba8().into() } else { image };
        let scan = load(&encode(image, format)).scan;
        assert_eq!(scan.gray.data(), fractions(&line), "{format:?}");
        assert!(scan.rgb.is_none() && scan.dpi.is_none(), "{format:?}");
    }
}

#[test]
fn pnm_of_every_kind() {
    assert_eq!(gray(b"P1\n3 1\n1 0 1\n"), [0.0, 1.0, 0.0], "in a bitmap 1 is black");
    assert_eq!(gray(b"P4\n3 1\n\xA0"), [0.0, 1.0, 0.0]);
    assert_eq!(gray(b"P2\n3 1\n15\n0 5 15\n"), [0.0, 85.0 / 255.0, 1.0], "samples count to the maximum");
    assert_eq!(gray(b"P5\n2 1\n255\n\x00\x4D"), [0.0, 77.0 / 255.0]);
    assert_eq!(gray(b"P5\n2 1\n65535\n\x30\x39\xFF\xFF"), [12345.0 / 65535.0, 1.0]);
    assert_close(&gray(b"P5\n2 1\n1023\n\x03\xFF\x01\xFF"), &[1.0, 511.0 / 1023.0], 1e-5);
    assert_eq!(gray(b"P6\n1 1\n255\n\x40\x40\x40"), [64.0 / 255.0]);
    let pam = b"P7\nWIDTH 1\nHEIGHT 1\nDEPTH 2\nMAXVAL 255\nTUPLTYPE GRAYSCALE_ALPHA\nENDHDR\n\x00\x33";
    assert_close(&gray(pam), &[0.8], 1e-6);
}

#[test]
fn jpeg_grey_and_colour() {
    let image = blocks();
    let mut bytes = Vec::new();
    let encoder = image::codecs::jpeg::JpegEncoder::new_with_quality(&mut bytes, 100);
    image.write_with_encoder(encoder).unwrap();
    assert_close(&gray(&bytes), &fractions(&image), 0.01);
    let grey_in_colour = DynamicImage::ImageLuma8(image.clone()).to_rgb8();
    let scan = load(&encode(grey_in_colour, ImageFormat::Jpeg)).scan;
    assert_close(scan.gray.data(), &fractions(&image), 0.03);
    assert!(scan.rgb.is_none());
    let blue = load(&encode(RgbImage::from_pixel(16, 16, Rgb([20, 40, 230])), ImageFormat::Jpeg)).scan;
    let rgb = blue.rgb.unwrap();
    assert!(rgb.pixels().all(|p| p.0.iter().zip([20, 40, 230]).all(|(&a, b)| a.abs_diff(b) < 8)));
}

#[test]
fn jpeg_in_printing_colours() {
    use jpeg_encoder::{ColorType, Encoder};
    for kind in [ColorType::Cmyk, ColorType::CmykAsYcck] {
        let inks = [[0, 0, 0, 0], [0, 0, 0, 255], [0, 255, 255, 0], [0, 0, 0, 128]];
        let data: Vec<u8> = (0..8 * 32).flat_map(|i| inks[i % 32 / 8]).collect();
        let mut bytes = Vec::new();
        Encoder::new(&mut bytes, 100).encode(&data, 32, 8, kind).unwrap();
        let scan = load(&bytes).scan;
        let row: Vec<f32> = (0..4).map(|i| scan.gray[(i * 8 + 4, 4)]).collect();
        assert_close(&row, &[1.0, 0.0, 0.2126, 127.0 / 255.0], 0.02);
        assert!(scan.rgb.unwrap().get_pixel(20, 4).0.iter().zip([255u8, 0, 0]).all(|(&a, b)| a.abs_diff(b) < 6));
    }
}

#[test]
fn tga_is_told_by_its_footer_or_by_its_name() {
    let color = RgbImage::from_fn(7, 5, |x, y| Rgb([(x * 30) as u8, (y * 50) as u8, 200]));
    let mut bytes = encode(color.clone(), ImageFormat::Tga);
    let read = |name: &str, bytes: &[u8]| load_bytes(name, bytes, &LoadOptions::default()).map(|input| input.scan.rgb);
    assert_eq!(read("a/DRAWING.TGA", &bytes).unwrap().as_ref(), Some(&color));
    assert!(read("-", &bytes).is_err());
    bytes.extend([0; 8]);
    bytes.extend(b"TRUEVISION-XFILE.\0");
    assert_eq!(read("-", &bytes).unwrap().as_ref(), Some(&color));
}

/// Red, green and blue stripes over white, as the fixtures in colour have them.
fn stripes() -> RgbImage {
    let colors = [[255, 0, 0], [0, 128, 0], [20, 40, 230]];
    RgbImage::from_fn(24, 16, |x, y| Rgb(if y < 8 { colors[x as usize / 8] } else { [255; 3] }))
}

#[track_caller]
fn assert_stripes(bytes: &[u8], tolerance: u8, inset: u32) {
    let scan = load(bytes).scan;
    let (got, expected) = (scan.rgb.expect("colours"), stripes());
    assert_eq!(got.dimensions(), (24, 16));
    let inside = |v: u32| v % 8 >= inset && v % 8 < 8 - inset;
    for (x, y, p) in got.enumerate_pixels().filter(|(x, y, _)| inside(*x) && inside(*y)) {
        let expected = expected.get_pixel(x, y);
        assert!(p.0.iter().zip(expected.0).all(|(a, b)| a.abs_diff(b) <= tolerance), "{x} {y}: {p:?} {expected:?}");
    }
}

#[test]
fn jpeg_xl_bare_and_in_its_container() {
    assert_eq!(gray(include_bytes!("fixtures/grey.jxl")), fractions(&blocks()));
    assert_stripes(include_bytes!("fixtures/colour.jxl"), 0, 0);
}

#[test]
fn jpeg_2000_bare_and_in_its_container() {
    assert_eq!(gray(include_bytes!("fixtures/grey.jp2")), fractions(&blocks()));
    assert_stripes(include_bytes!("fixtures/colour.j2k"), 0, 0);
}

#[cfg(feature = "avif")]
#[test]
fn avif_of_several_kinds() {
    assert_close(&gray(include_bytes!("fixtures/grey.avif")), &fractions(&blocks()), 0.005);
    assert_close(&gray(include_bytes!("fixtures/deep.avif")), &fractions(&blocks()), 0.005);
    assert_stripes(include_bytes!("fixtures/colour.avif"), 3, 0);
    assert_stripes(include_bytes!("fixtures/alpha.avif"), 14, 2);
}

#[test]
fn odd_sizes_are_images_too() {
    assert_eq!(load(&encode(GrayImage::from_pixel(1, 1, Luma([9])), ImageFormat::Png)).scan.gray.size(), (1, 1));
    let wide = GrayImage::from_fn(20_000, 3, |x, _| Luma([(x % 251) as u8]));
    for format in [ImageFormat::Png, ImageFormat::Tiff, ImageFormat::Pnm] {
        assert_eq!(gray(&encode(wide.clone(), format)), fractions(&wide), "{format:?}");
    }
    assert_eq!(load(&encode(wide, ImageFormat::Jpeg)).scan.gray.size(), (20_000, 3));
}
