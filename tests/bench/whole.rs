//! How long does it take from the bytes of a PNG to those of an SVG?

use crate::page::{SIDE, page};
use divan::Bencher;
use divan::counter::ItemsCount;
use fieldtrace::load::{LoadOptions, load_bytes};
use fieldtrace::options::Options;
use fieldtrace::pipeline::Vectorizer;
use fieldtrace::write::{WriteOptions, to_svg};
use image::{GrayImage, ImageFormat, Luma};
use std::io::Cursor;

fn png() -> Vec<u8> {
    let gray = page().gray;
    let lightness = |x: u32, y: u32| Luma([(gray[(x as usize, y as usize)] * 255.0).round() as u8]);
    let image = GrayImage::from_fn(SIDE as u32, SIDE as u32, lightness);
    let mut bytes = Cursor::new(Vec::new());
    image.write_to(&mut bytes, ImageFormat::Png).expect("memory can be written");
    bytes.into_inner()
}

#[divan::bench]
fn whole(bencher: Bencher) {
    let (png, vectorizer) = (png(), Vectorizer::new(Options::default()).expect("the defaults are in range"));
    bencher.counter(ItemsCount::new(SIDE * SIDE)).bench(|| {
        let scan = load_bytes("page", &png, &LoadOptions::default()).expect("it was just written").scan;
        to_svg(&vectorizer.trace(&scan).expect("the built-in estimator never fails"), &WriteOptions::default())
    });
}
