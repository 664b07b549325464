//! Pixels that are not square, and parts of images.

use crate::fixtures::{Field, Png, blocks, encode, exif, fractions, page, pdf, short, tiff};
use fieldtrace::Error;
use fieldtrace::load::{Dpi, LoadOptions, Scan, load_bytes};
use image::codecs::jpeg::{JpegEncoder, PixelDensity, PixelDensityUnit};
use image::{ImageFormat, Rgb, RgbImage};

fn read(bytes: &[u8], options: &LoadOptions) -> Scan {
    load_bytes("a", bytes, options).unwrap().scan
}

fn crop(part: [u32; 4]) -> LoadOptions {
    LoadOptions::default().with(|o| o.crop = Some(part))
}

/// A fax of one bit: 102 x 49 pixels, half an inch each way at 204 x 98 dots per inch, with a black square of a quarter
/// of an inch in its middle.
fn fax(orientation: u16) -> Vec<u8> {
    let mut fields = page(102, 49, &[1], 1, 0);
    fields.extend([(282, Field::Rational(204, 1)), (283, Field::Rational(98, 1)), (296, short(2))]);
    fields.push((274, short(orientation)));
    let bit = |x: usize, y: usize| (26..77).contains(&x) && (12..37).contains(&y);
    let byte = |y: usize, i: usize| (0..8).fold(0, |b, k| b << 1 | u8::from(bit(i * 8 + k, y)));
    let rows: Vec<u8> = (0..49).flat_map(|y| (0..13).map(move |i| byte(y, i))).collect();
    tiff(false, &fields, &rows)
}

#[test]
fn a_fax_has_its_true_proportions() {
    let scan = read(&fax(1), &LoadOptions::default());
    assert_eq!((scan.gray.size(), scan.dpi), ((102, 102), Some(204.0)));
    let ink = |line: Vec<f32>| line.iter().map(|v| 1.0 - v).sum::<f32>();
    let across = ink((0..102).map(|x| scan.gray[(x, 51)]).collect());
    let down = ink((0..102).map(|y| scan.gray[(51, y)]).collect());
    assert!((across - 51.0).abs() < 1e-3 && (down - 25.0 * 102.0 / 49.0).abs() < 0.05, "{across} by {down}");
    assert!(scan.gray.data().iter().any(|v| (0.1..0.9).contains(v)), "edges are smooth");
    let turned = read(&fax(6), &LoadOptions::default());
    assert_eq!((turned.gray.size(), turned.dpi), ((102, 102), Some(204.0)), "the two change places with the axes");
}

#[test]
fn every_format_tells_both_resolutions() {
    let metres = |x: u32, y: u32, unit: u8| {
        let data = [&x.to_be_bytes()[..], &y.to_be_bytes(), &[unit]].concat();
        let rows = [0u8; 9].repeat(4);
        Png { width: 8, height: 4, depth: 8, color: 0, interlaced: false, chunks: &[(b"pHYs", data)], data: rows }
            .bytes()
    };
    let mut bmp = encode(blocks(), ImageFormat::Bmp);
    bmp[38..46].copy_from_slice(&[7874u32, 3937].map(u32::to_le_bytes).concat());
    let mut jpeg = Vec::new();
    let mut encoder = JpegEncoder::new(&mut jpeg);
    encoder.set_pixel_density(PixelDensity { density: (200, 100), unit: PixelDensityUnit::Inches });
    blocks().write_with_encoder(encoder).unwrap();
    let all = LoadOptions::default();
    for (name, bytes, size) in
        [("png", metres(7874, 3937, 1), (8, 8)), ("bmp", bmp, (24, 32)), ("jpeg", jpeg, (24, 32))]
    {
        let scan = read(&bytes, &all);
        assert_eq!((scan.gray.size(), scan.dpi), (size, Some(200.0)), "{name}");
    }
    let shape = read(&metres(1, 2, 0), &all);
    assert_eq!((shape.gray.size(), shape.dpi), ((16, 4), None), "the shape of a pixel alone");
    assert_eq!(read(&metres(7874, 7835, 1), &all).gray.size(), (8, 4), "less than one in a hundred is none");
    assert_eq!(read(&metres(7874, 79, 1), &all).gray.size(), (8, 4), "a slip");
    let mut jpeg = Vec::new();
    let mut encoder = JpegEncoder::new(&mut jpeg);
    image::ImageEncoder::set_exif_metadata(&mut encoder, exif(1, 240)).unwrap();
    blocks().write_with_encoder(encoder).unwrap();
    assert_eq!(read(&jpeg, &all).dpi, Some(240.0), "one holds for both");
}

#[test]
fn the_option_has_both_resolutions_too() {
    let bytes = encode(blocks(), ImageFormat::Png);
    let options = |x, y| LoadOptions::default().with(|o| o.dpi = Some(Dpi { x, y }));
    let scan = read(&bytes, &options(300.0, 150.0));
    assert_eq!((scan.gray.size(), scan.dpi), ((24, 32), Some(300.0)));
    assert!((scan.gray[(20, 28)] - 120.0 / 255.0).abs() < 1e-5 && (scan.gray[(4, 4)] - 0.0).abs() < 1e-5);
    let square = read(&fax(1), &options(200.0, 200.0));
    assert_eq!((square.gray.size(), square.dpi), ((102, 49), Some(200.0)));
    let color = encode(RgbImage::from_pixel(4, 4, Rgb([200, 10, 30])), ImageFormat::Png);
    let rgb = read(&color, &options(100.0, 200.0)).rgb.unwrap();
    assert!(rgb.dimensions() == (8, 4) && rgb.pixels().all(|p| p.0 == [200, 10, 30]));
    let limit = options(300.0, 150.0).with(|o| o.max_pixels = 700);
    let error = load_bytes("a", &bytes, &limit).unwrap_err();
    assert!(matches!(error, Error::TooLarge { width: 24, height: 32, .. }), "{error:?}");
}

#[test]
fn a_part_is_that_of_the_upright_image() {
    let bytes = encode(blocks(), ImageFormat::Png);
    let part = read(&bytes, &crop([6, 5, 4, 6])).gray;
    let whole = fractions(&blocks());
    let expected: Vec<f32> = (5..11).flat_map(|y| whole[y * 24 + 6..y * 24 + 10].to_vec()).collect();
    assert_eq!((part.size(), part.data()), ((4, 6), &expected[..]));
    let mut fields = page(24, 16, &[8], 1, 1);
    fields.push((274, short(6)));
    let turned = read(&tiff(false, &fields, blocks().as_raw()), &crop([8, 0, 8, 8])).gray;
    assert!(turned.data().iter().all(|&v| v == 0.0), "the first block is at the right");
    let stretched = read(&fax(1), &crop([26, 12, 51, 25]));
    assert_eq!((stretched.gray.size(), stretched.dpi), ((51, 52), Some(204.0)), "before pixels are made square");
    assert!(stretched.gray.data().iter().all(|&v| v < 1e-5));
}

#[test]
fn a_part_outside_is_an_error_that_tells_the_size() {
    let bytes = encode(blocks(), ImageFormat::Png);
    for part in [[0, 0, 25, 16], [20, 0, 5, 1], [24, 0, 1, 1], [u32::MAX, 0, u32::MAX, 1]] {
        let error = load_bytes("a.png", &bytes, &crop(part)).unwrap_err().to_string();
        assert!(error.starts_with("a.png: the part ") && error.contains("24 x 16 pixels"), "{error}");
    }
    let none = load_bytes("a.png", &bytes, &crop([1, 1, 0, 1])).unwrap_err();
    assert!(matches!(none, Error::Option { option: "crop", .. }), "{none:?}");
}

#[test]
fn a_part_of_a_rendering() {
    let text = "<svg xmlns='http://www.w3.org/2000/svg' width='100' height='100'>\
        <g stroke='black'><path d='M10 50H90' stroke-width='4'/><path d='M5 5H20'/></g><rect x='60' y='10' width='9' height='9'/></svg>";
    let options = crop([30, 40, 50, 20]).with(|o| o.size = Some(100));
    let input = load_bytes("a.svg", text.as_bytes(), &options).unwrap();
    assert_eq!(input.scan.gray.size(), (50, 20));
    assert!(input.scan.gray[(25, 10)] == 0.0 && input.scan.gray[(25, 2)] == 1.0);
    let drawing = input.drawing.unwrap();
    assert_eq!((drawing.width, drawing.height, drawing.strokes.len(), drawing.fills.len()), (50.0, 20.0, 1, 0));
    let line = &drawing.strokes[0].centreline;
    assert!(line.start().distance(kurbo::Point::new(-20.0, 10.0)) < 1e-6, "{line:?}");
    let page = pdf(&[("10 10 20 20 re f", 72, 72, "")]);
    let options = crop([10, 42, 20, 20]).with(|o| o.dpi = Some(72.0.into()));
    let part = read(&page, &options);
    assert!(part.gray.size() == (20, 20) && part.gray.data().iter().all(|&v| v == 0.0));
}
