//! TIFF as scanners write it.

use crate::fixtures::{Field, assert_close, blocks, encode, fractions, gray, group4, load, page, short, tiff};
use ::tiff::encoder::{Compression, DeflateLevel, TiffEncoder, colortype};
use fieldtrace::load::{LoadOptions, load_bytes};
use image::{Rgb, RgbImage};
use std::io::Cursor;

/// A bilevel drawing: true is ink.
fn ink(x: usize, y: usize) -> bool {
    x.abs_diff(2 * y) < 3 || (30..33).contains(&x)
}

const SIZE: (usize, usize) = (45, 20);

fn expected() -> Vec<f32> {
    let pixel = |i: usize| if ink(i % SIZE.0, i / SIZE.0) { 0.0 } else { 1.0 };
    (0..SIZE.0 * SIZE.1).map(pixel).collect()
}

/// Rows of packed bits, most significant first, with ink as 1.
fn packed() -> Vec<u8> {
    let byte = |y, i| (0..8).fold(0, |b, k| b << 1 | u8::from(i * 8 + k < SIZE.0 && ink(i * 8 + k, y)));
    (0..SIZE.1).flat_map(|y| (0..SIZE.0.div_ceil(8)).map(move |i| byte(y, i))).collect()
}

fn fax() -> Vec<u8> {
    group4(SIZE.0, SIZE.1, ink)
}

fn bilevel(compression: u16, photometric: u16, fill_order: Option<u16>, strip: &[u8]) -> Vec<u8> {
    let mut fields = page(SIZE.0 as u32, SIZE.1 as u32, &[1], compression, photometric);
    fields.extend(fill_order.map(|o| (266, short(o))));
    tiff(false, &fields, strip)
}

fn inverted(bytes: &[u8]) -> Vec<u8> {
    bytes.iter().map(|b| !b).collect()
}

fn reversed(bytes: &[u8]) -> Vec<u8> {
    bytes.iter().map(|b| b.reverse_bits()).collect()
}

#[test]
fn one_bit_in_both_interpretations_and_bit_orders() {
    assert_eq!(gray(&bilevel(1, 0, None, &packed())), expected());
    assert_eq!(gray(&bilevel(1, 1, None, &inverted(&packed()))), expected());
    assert_eq!(gray(&bilevel(1, 0, Some(2), &reversed(&packed()))), expected());
    assert_eq!(gray(&bilevel(1, 1, Some(1), &inverted(&packed()))), expected());
}

#[test]
fn ccitt_group_4_in_both_interpretations_and_bit_orders() {
    assert_eq!(gray(&bilevel(4, 0, None, &fax())), expected());
    assert_eq!(gray(&bilevel(4, 0, Some(2), &reversed(&fax()))), expected());
    let negative: Vec<f32> = expected().iter().map(|v| 1.0 - v).collect();
    assert_eq!(gray(&bilevel(4, 1, None, &fax())), negative, "as stored: white on black");
}

/// CCITT group 3 data of 8 x 2 pixels: 3 white, 2 black, 3 white; 8 black. Without an end of page, as libtiff has it.
fn group3() -> Vec<u8> {
    let end_of_line = "000000000001";
    let (first, second) = (["1000", "11", "1000"].concat(), ["00110101", "000101"].concat());
    let bits = [end_of_line, &first, end_of_line, &second].concat();
    let byte = |c: &[u8]| c.iter().enumerate().fold(0, |b, (i, &v)| b | (v - b'0') << (7 - i));
    bits.as_bytes().chunks(8).map(byte).collect()
}

#[test]
fn ccitt_group_3_in_both_interpretations_and_bit_orders() {
    let rows = |photometric, order: u16, data: &[u8]| {
        let mut fields = page(8, 2, &[1], 3, photometric);
        fields.push((266, short(order)));
        gray(&tiff(true, &fields, data))
    };
    let expected = [1., 1., 1., 0., 0., 1., 1., 1., 0., 0., 0., 0., 0., 0., 0., 0.];
    assert_eq!(rows(0, 1, &group3()), expected);
    assert_eq!(rows(0, 2, &reversed(&group3())), expected);
    assert_eq!(rows(1, 1, &group3()), expected.map(|v| 1.0 - v));
}

#[test]
fn grey_of_every_depth_in_both_byte_orders() {
    for big in [false, true] {
        let one = |bits: u16, photometric, strip: &[u8], width| {
            gray(&tiff(big, &page(width, 1, &[bits], 1, photometric), strip))
        };
        assert_close(&one(2, 1, &[0b0001_1011], 4), &[0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0], 1e-6);
        assert_close(&one(4, 1, &[0x05, 0xF0], 3), &[0.0, 1.0 / 3.0, 1.0], 1e-6);
        assert_close(&one(4, 0, &[0x05, 0xF0], 3), &[1.0, 2.0 / 3.0, 0.0], 1e-6);
        assert_eq!(one(8, 1, &[0, 77, 255], 3), [0.0, 77.0 / 255.0, 1.0]);
        let word = if big { 12345u16.to_be_bytes() } else { 12345u16.to_le_bytes() };
        assert_eq!(one(16, 1, &word, 1), [12345.0 / 65535.0]);
        assert_eq!(one(16, 0, &word, 1), [(65535.0 - 12345.0) / 65535.0]);
        let float = if big { 0.25f32.to_be_bytes() } else { 0.25f32.to_le_bytes() };
        let mut fields = page(1, 1, &[32], 1, 1);
        fields.push((339, short(3)));
        assert_eq!(gray(&tiff(big, &fields, &float)), [(0.25f32 * 65535.0).round() / 65535.0]);
    }
}

#[test]
fn palettes_of_every_depth() {
    for (bits, strip) in [(1u16, vec![0b0100_0000u8]), (4, vec![0x01]), (8, vec![0, 1])] {
        for big in [false, true] {
            let mut map = vec![0u16; 3 << bits];
            let n = 1 << bits;
            (map[0], map[n], map[2 * n]) = (0xFFFF, 0x8080, 0);
            map[1] = 0x2020;
            let mut fields = page(2, 1, &[bits], 1, 3);
            fields.push((320, Field::Short(map)));
            let rgb = load(&tiff(big, &fields, &strip)).scan.rgb.unwrap();
            assert_eq!(rgb.as_raw()[..], [255, 128, 0, 32, 0, 0], "{bits} bits");
        }
    }
}

#[test]
fn colour_planes_and_alpha() {
    let planar = {
        let mut fields = page(2, 1, &[8, 8, 8], 1, 2);
        fields.push((284, short(2)));
        fields.push((273, Field::Long(vec![8, 10, 12])));
        fields.push((279, Field::Long(vec![2; 3])));
        tiff(false, &fields, &[255, 1, 0, 2, 0, 200])
    };
    assert_eq!(load(&planar).scan.rgb.unwrap().as_raw()[..], [255, 0, 0, 1, 2, 200]);
    let alpha = |kind: u16, sample: [u8; 4]| {
        let mut fields = page(1, 1, &[8; 4], 1, 2);
        fields.push((338, short(kind)));
        gray(&tiff(false, &fields, &sample))[0]
    };
    let half = 1.0 - 128.0 / 255.0 * (1.0 - 200.0 / 255.0);
    assert!((alpha(2, [200, 200, 200, 128]) - half).abs() < 1e-6, "straight");
    assert!((alpha(1, [100, 100, 100, 128]) - half).abs() < 4e-3, "premultiplied");
    let mut fields = page(1, 1, &[8, 8], 1, 1);
    fields.push((338, short(2)));
    assert_close(&gray(&tiff(false, &fields, &[0, 51])), &[0.8], 1e-6);
}

#[test]
fn printing_colours_and_luma_with_chroma() {
    let one = |photometric, sample: &[u8]| {
        let mut fields = page(1, 1, &vec![8; sample.len()], 1, photometric);
        fields.push((530, Field::Short(vec![1, 1])));
        load(&tiff(false, &fields, sample)).scan
    };
    assert_eq!(one(5, &[0, 0, 0, 0]).gray.data(), [1.0]);
    assert_eq!(one(5, &[0, 0, 0, 255]).gray.data(), [0.0]);
    assert_eq!(one(5, &[0, 255, 255, 0]).rgb.unwrap().as_raw()[..], [255, 0, 0]);
    assert_eq!(one(6, &[150, 128, 128]).gray.data(), [150.0 / 255.0]);
    assert_eq!(one(6, &[76, 85, 255]).rgb.unwrap().as_raw()[..], [254, 0, 0]);
}

#[test]
fn every_common_compression() {
    let color = RgbImage::from_fn(37, 23, |x, y| Rgb([(x * 6) as u8, (y * 11) as u8, 90]));
    let compressions = [
        Compression::Lzw,
        Compression::Deflate(DeflateLevel::Balanced),
        Compression::Packbits,
        Compression::Uncompressed,
    ];
    for compression in compressions {
        let mut bytes = Cursor::new(Vec::new());
        let mut encoder = TiffEncoder::new(&mut bytes).unwrap().with_compression(compression);
        encoder.write_image::<colortype::RGB8>(37, 23, color.as_raw()).unwrap();
        assert_eq!(load(bytes.get_ref()).scan.rgb.as_ref(), Some(&color));
    }
}

#[test]
fn tiles_of_colours_together_and_apart() {
    let color = RgbImage::from_fn(37, 23, |x, y| Rgb([(x * 6) as u8, (y * 11) as u8, 90]));
    let sample = |x: u32, y: u32, c: usize| if x < 37 && y < 23 { color.get_pixel(x, y)[c] } else { 0 };
    let corners = || (0..23u32).step_by(16).flat_map(|y| (0..37u32).step_by(16).map(move |x| (x, y)));
    let within = || (0..16u32).flat_map(|y| (0..16u32).map(move |x| (x, y)));
    let together: Vec<u8> = corners()
        .flat_map(|(x0, y0)| within().flat_map(move |(x, y)| [0, 1, 2].map(|c| (x0 + x, y0 + y, c))))
        .map(|(x, y, c)| sample(x, y, c))
        .collect();
    let apart: Vec<u8> = (0..3)
        .flat_map(|c| corners().flat_map(move |(x0, y0)| within().map(move |(x, y)| (x0 + x, y0 + y, c))))
        .map(|(x, y, c)| sample(x, y, c))
        .collect();
    for (planar, count, data) in [(1, 6, together), (2, 18, apart)] {
        let size = (data.len() / count) as u32;
        let mut fields = page(37, 23, &[8; 3], 1, 2);
        fields.retain(|field| field.0 != 278);
        fields.extend([(284, short(planar)), (322, short(16)), (323, short(16))]);
        fields.push((324, Field::Long((0..count as u32).map(|i| 8 + i * size).collect())));
        fields.push((325, Field::Long(vec![size; count])));
        for big in [false, true] {
            let rgb = load(&tiff(big, &fields, &data)).scan.rgb;
            assert_eq!(rgb.as_ref(), Some(&color), "planes {planar}");
        }
    }
}

#[test]
fn jpeg_inside() {
    let grey = encode(blocks(), image::ImageFormat::Jpeg);
    assert_close(&gray(&tiff(false, &page(24, 16, &[8], 7, 1), &grey)), &fractions(&blocks()), 0.05);
    let mut jpeg = Vec::new();
    let mut encoder = jpeg_encoder::Encoder::new(&mut jpeg, 100);
    encoder.set_sampling_factor(jpeg_encoder::SamplingFactor::R_4_2_0);
    encoder.encode(&[[200u8, 30, 40]; 24 * 16].concat(), 24, 16, jpeg_encoder::ColorType::Rgb).unwrap();
    let rgb = load(&tiff(true, &page(24, 16, &[8; 3], 7, 6), &jpeg)).scan.rgb.unwrap();
    assert!(rgb.pixels().all(|p| p.0.iter().zip([200u8, 30, 40]).all(|(&a, b)| a.abs_diff(b) < 4)), "{rgb:?}");
}

#[test]
fn thumbnails_are_passed_over() {
    let mut bytes = Cursor::new(Vec::new());
    let mut encoder = TiffEncoder::new(&mut bytes).unwrap();
    let mut thumbnail = encoder.new_image::<colortype::Gray8>(2, 1).unwrap();
    thumbnail.encoder().write_tag(::tiff::tags::Tag::NewSubfileType, 1u32).unwrap();
    thumbnail.write_data(&[1, 2]).unwrap();
    encoder.write_image::<colortype::Gray8>(24, 16, blocks().as_raw()).unwrap();
    assert_eq!(gray(bytes.get_ref()), fractions(&blocks()));
}

#[test]
fn what_is_not_supported_is_named() {
    let reason = |fields: &[(u16, Field)]| {
        load_bytes("a.tif", &tiff(false, fields, &[0; 64]), &LoadOptions::default()).unwrap_err().to_string()
    };
    let huffman = reason(&page(8, 8, &[1], 2, 0));
    assert!(huffman.starts_with("a.tif: ") && huffman.contains("Huffman"), "{huffman}");
    let zstd = reason(&page(8, 8, &[8], 50000, 1));
    assert!(zstd.contains("Zstandard") && zstd.contains("save it with LZW"), "{zstd}");
    let mut fields = page(8, 8, &[1], 3, 0);
    fields.push((292, Field::Long(vec![1])));
    assert!(reason(&fields).contains("two-dimensional"), "{}", reason(&fields));
    assert!(reason(&page(8, 8, &[1], 3, 0)).contains("rows"), "zeros are no rows");
    let lab = reason(&page(2, 2, &[8; 3], 1, 9));
    assert!(lab.starts_with("a.tif: ") && lab.contains("Lab"), "{lab}");
}
