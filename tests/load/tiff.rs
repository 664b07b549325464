//! TIFF as scanners write it.

use crate::fixtures::{Field, assert_close, gray, load, page, short, tiff};
use fax::{Color, VecWriter, encoder::Encoder};

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

fn group4() -> Vec<u8> {
    let mut encoder = Encoder::new(VecWriter::new());
    for y in 0..SIZE.1 {
        let row = (0..SIZE.0).map(|x| if ink(x, y) { Color::Black } else { Color::White });
        encoder.encode_line(row, SIZE.0 as u16).unwrap();
    }
    encoder.finish().unwrap().finish()
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
    assert_eq!(gray(&bilevel(4, 0, None, &group4())), expected());
    assert_eq!(gray(&bilevel(4, 0, Some(2), &reversed(&group4()))), expected());
    let negative: Vec<f32> = expected().iter().map(|v| 1.0 - v).collect();
    assert_eq!(gray(&bilevel(4, 1, None, &group4())), negative, "as stored: white on black");
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
        fields.push((284, short(1)));
        tiff(false, &fields, &[255, 0, 0, 1, 2, 200])
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
