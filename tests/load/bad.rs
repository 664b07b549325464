//! Bad inputs give an error of one line that starts with their name, and no panic.

use crate::fixtures::{Png, blocks, encode, group4, page, pdf, short, tiff};
use fieldtrace::Error;
use fieldtrace::load::{LoadOptions, load, load_bytes};
use image::{DynamicImage, ImageFormat};
use proptest::prelude::*;
use std::path::Path;

const SVG: &str = "<svg xmlns='http://www.w3.org/2000/svg' width='64' height='32'>\
    <g transform='rotate(5)'><path d='M2 2Q10 20 30 4T60 9' stroke='#123' stroke-dasharray='3 1' fill='none'/>\
    <circle cx='20' cy='20' r='5'/><text x='3' y='9'>hello</text></g></svg>";

/// One valid file of each format.
fn samples() -> Vec<(&'static str, Vec<u8>)> {
    let grey = DynamicImage::ImageLuma8(blocks());
    let color = DynamicImage::ImageRgba8(grey.to_rgba8());
    let stripes = grey.to_rgb8();
    let mut fields = page(24, 16, &[1], 4, 0);
    fields.push((266, short(2)));
    let fax: Vec<u8> = group4(24, 16, |x, y| x == y || x == 7).iter().map(|b| b.reverse_bits()).collect();
    vec![
        ("png", encode(grey.clone(), ImageFormat::Png)),
        ("jpeg", encode(grey.clone(), ImageFormat::Jpeg)),
        ("tiff", encode(grey.clone(), ImageFormat::Tiff)),
        ("webp", encode(color.clone(), ImageFormat::WebP)),
        ("bmp", encode(grey.clone(), ImageFormat::Bmp)),
        ("gif", encode(color.clone(), ImageFormat::Gif)),
        ("pnm", encode(grey, ImageFormat::Pnm)),
        ("qoi", encode(stripes.clone(), ImageFormat::Qoi)),
        ("a.tga", encode(stripes, ImageFormat::Tga)),
        ("jxl", include_bytes!("fixtures/colour.jxl").to_vec()),
        ("jp2", include_bytes!("fixtures/grey.jp2").to_vec()),
        #[cfg(feature = "avif")]
        ("avif", include_bytes!("fixtures/alpha.avif").to_vec()),
        ("pdf", pdf(&[("1 0 0 RG 9 9 m 20 20 l S", 24, 16, "")])),
        ("svg", SVG.into()),
        ("fax", tiff(true, &fields, &fax)),
        ("old fax", tiff(false, &page(8, 2, &[1], 3, 0), &[0x00, 0x18, 0xE0, 0x00, 0x4D, 0x45])),
    ]
}

fn options() -> LoadOptions {
    LoadOptions::default().with(|o| o.max_pixels = 1 << 20)
}

#[track_caller]
fn error(name: &str, bytes: &[u8]) -> String {
    let error = load_bytes(name, bytes, &options()).expect_err(name);
    let text = error.to_string();
    assert!(text.starts_with(&format!("{name}: ")) && !text.contains('\n'), "{text}");
    assert!(!text.contains("gave up"), "{text}");
    text
}

#[test]
fn files_that_cannot_be_read() {
    let folder = tempfile::tempdir().unwrap();
    for path in [folder.path(), &folder.path().join("missing.png"), Path::new("")] {
        let error = load(path, &options()).unwrap_err();
        assert!(matches!(&error, Error::Read { input, .. } if Path::new(input) == path), "{error:?}");
    }
    let path = folder.path().join("a.png");
    std::fs::write(&path, encode(blocks(), ImageFormat::Png)).unwrap();
    assert_eq!(load(&path, &options()).unwrap().scan.gray.size(), (24, 16));
    std::fs::write(&path, []).unwrap();
    let error = load(&path, &options()).unwrap_err().to_string();
    assert_eq!(error, format!("{}: the file is empty", path.display()));
}

#[test]
fn what_is_no_image() {
    assert!(error("note.txt", b"hello, world").contains("not an image in a known format"));
    assert!(error("plan.pdf", b"%PDF-1.4\n%").contains("the PDF is damaged"));
    assert!(error("plan.eps", b"%!PS-Adobe-3.0 EPSF-3.0\n").contains("save it as PDF"));
    assert!(error("icon.ico", b"\0\0\x01\0\x01\0\x10\x10").contains("is not supported"));
    error("page.html", b"<!DOCTYPE html><html><body>x</body></html>");
    error("broken.svg", b"<svg xmlns='http://www.w3.org/2000/svg' width='5' height='5'><path");
    error(
        "far.svg",
        b"<svg xmlns='http://www.w3.org/2000/svg' width='5' height='5'><path d='M0 0A1e60 1e60 0 0 1 5 5'/></svg>",
    );
    error("zero.svg", b"<svg xmlns='http://www.w3.org/2000/svg' width='0' height='5'/>");
    error("broken.svgz", b"\x1F\x8B\x08\0\0\0\0\0\0\x03garbage");
    error("empty.pgm", b"P5\n0 0\n255\n");
}

/// A small GIF whose header claims 65535 x 65535 pixels.
fn wide_gif() -> Vec<u8> {
    let mut bytes = encode(DynamicImage::ImageLuma8(blocks()).to_rgba8(), ImageFormat::Gif);
    bytes[6..10].fill(0xFF);
    bytes
}

#[test]
fn claims_beyond_the_limit_are_refused_before_decoding() {
    let data = vec![0];
    let bytes = Png { width: 10_000, height: 10_000, depth: 8, color: 2, interlaced: false, chunks: &[], data }.bytes();
    let limit = LoadOptions::default().with(|o| o.max_pixels = 50_000_000);
    let error = load_bytes("claim.png", &bytes, &limit).unwrap_err();
    assert!(matches!(error, Error::TooLarge { width: 10_000, height: 10_000, limit: 50_000_000, .. }), "{error:?}");
    assert!(error.to_string().starts_with("claim.png: 10000 x 10000 pixels"));
    for (name, bytes) in [
        ("a.tif", tiff(false, &page(60_000, 60_000, &[1], 4, 0), &[0])),
        ("a.pgm", b"P5\n100000 100000\n255\n".to_vec()),
        ("a.svg", b"<svg xmlns='http://www.w3.org/2000/svg' width='1e7' height='1e7'/>".to_vec()),
        ("a.gif", wide_gif()),
    ] {
        let error = load_bytes(name, &bytes, &LoadOptions::default()).unwrap_err();
        assert!(matches!(error, Error::TooLarge { .. }), "{name}: {error:?}");
    }
    let roomy = LoadOptions::default().with(|o| o.max_pixels = 200_000_000);
    let fits = load_bytes("claim.png", &bytes, &roomy).unwrap_err();
    assert!(matches!(fits, Error::Decode { .. }), "within the limit it is damaged: {fits:?}");
}

#[test]
fn files_cut_short() {
    for (name, bytes) in samples() {
        load_bytes(name, &bytes, &options()).unwrap();
        if name == "pdf" {
            continue; // What is whole in it is found without its end.
        }
        for part in [0.3, 0.6, 0.9] {
            let end = (bytes.len() as f64 * part) as usize;
            error(name, &bytes[..end]);
        }
    }
}

fn damaged() -> impl Strategy<Value = Vec<u8>> {
    let samples = samples();
    let change = (any::<prop::sample::Index>(), any::<u8>());
    let changes = prop::collection::vec(change, 0..6);
    (prop::sample::select(samples), changes, prop::option::of(any::<prop::sample::Index>())).prop_map(
        |((_, mut bytes), changes, end)| {
            for (at, value) in changes {
                let at = at.index(bytes.len());
                bytes[at] = value;
            }
            end.into_iter().for_each(|end| bytes.truncate(end.index(bytes.len() + 1)));
            bytes
        },
    )
}

/// Reads bytes of unknown worth: either an image or an error that is well formed.
fn read_any(bytes: &[u8]) -> Result<(), TestCaseError> {
    match load_bytes("any", bytes, &options()) {
        Ok(input) => prop_assert!(input.scan.gray.data().iter().all(|v| (0.0..=1.0).contains(v))),
        Err(error) => {
            let text = error.to_string();
            prop_assert!(text.starts_with("any: ") && !text.contains('\n'), "{}", text);
            prop_assert!(!text.contains("gave up"), "{}", text);
        }
    }
    Ok(())
}

/// Enough to meet every format many times and keep the suite fast.
const CASES: u32 = 400;

proptest! {
    #![proptest_config(ProptestConfig { cases: CASES, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        read_any(&bytes)?;
    }

    #[test]
    fn random_bytes_after_a_magic_never_panic(
        (_, sample) in prop::sample::select(samples()),
        head in 2usize..40,
        bytes in prop::collection::vec(any::<u8>(), 0..200),
    ) {
        read_any(&[&sample[..head.min(sample.len())], &bytes].concat())?;
    }

    #[test]
    fn damaged_files_never_panic(bytes in damaged()) {
        read_any(&bytes)?;
    }
}
