//! Inputs of several pages: counted, told apart, chosen.

use crate::fixtures::{blocks, encode, pdf};
use fieldtrace::Error;
use fieldtrace::load::{LoadOptions, Pages, load_bytes, load_pages, pages_of_bytes};
use image::codecs::gif::{GifEncoder, Repeat};
use image::{Frame, ImageFormat, Rgba, RgbaImage};
use std::io::Cursor;
use tiff::encoder::{TiffEncoder, TiffKind, colortype};
use tiff::tags::Tag;

/// Writes grey pages of 3 x 2 pixels: their levels, each with its subfile type.
fn write<K: TiffKind>(mut encoder: TiffEncoder<&mut Cursor<Vec<u8>>, K>, pages: &[(u8, u32)]) {
    for &(level, kind) in pages {
        let mut page = encoder.new_image::<colortype::Gray8>(3, 2).unwrap();
        page.encoder().write_tag(Tag::NewSubfileType, kind).unwrap();
        page.write_data(&[level; 6]).unwrap();
    }
}

fn small(pages: &[(u8, u32)]) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    write(TiffEncoder::new(&mut bytes).unwrap(), pages);
    bytes.into_inner()
}

fn big(pages: &[(u8, u32)]) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    write(TiffEncoder::new_big(&mut bytes).unwrap(), pages);
    bytes.into_inner()
}

/// The level of the first pixel of each page, of 255.
fn levels(pages: &Pages) -> Vec<u8> {
    pages.iter().map(|(_, page)| (page.unwrap().scan.gray.data()[0] * 255.0).round() as u8).collect()
}

fn open<'a>(bytes: &'a [u8], page: Option<usize>) -> Result<Pages<'a>, Error> {
    pages_of_bytes("a", bytes, &LoadOptions::default().with(|o| o.page = page))
}

#[test]
fn pages_of_a_tiff_without_thumbnails_and_masks() {
    let kinds = [(10, 2), (20, 3), (30, 0), (40, 4), (50, 1), (60, 2)];
    for bytes in [small(&kinds), big(&kinds)] {
        let pages = open(&bytes, None).unwrap();
        assert_eq!((pages.count(), pages.numbers()), (3, 1..=3));
        assert_eq!(levels(&pages), [10, 30, 60]);
        let third = pages.page(3).unwrap().scan;
        assert_eq!((third.gray.size(), third.gray[(0, 0)]), ((3, 2), 60.0 / 255.0));
        let second = open(&bytes, Some(2)).unwrap();
        assert_eq!((second.count(), levels(&second)), (3, vec![30]));
    }
}

#[test]
fn one_page_is_read_only_where_it_is_named_or_alone() {
    let bytes = small(&[(10, 2), (30, 2)]);
    let read = |page| load_bytes("scan.tif", &bytes, &LoadOptions::default().with(|o| o.page = page));
    let error = read(None).unwrap_err();
    assert!(matches!(error, Error::ManyPages { pages: 2, .. }), "{error:?}");
    assert_eq!(error.to_string(), "scan.tif: it has 2 pages (name one with --page)");
    assert_eq!(read(Some(2)).unwrap().scan.gray[(0, 0)], 30.0 / 255.0);
    let beyond = read(Some(3)).unwrap_err();
    assert_eq!(beyond.to_string(), "scan.tif: there is no page 3: it has 2 pages");
    assert!(matches!(open(&bytes, None).unwrap().page(0), Err(Error::NoSuchPage { page: 0, pages: 2, .. })));
    let alone = encode(blocks(), ImageFormat::Png);
    assert_eq!(open(&alone, Some(1)).unwrap().count(), 1);
    assert_eq!(open(&alone, Some(2)).unwrap_err().to_string(), "a: there is no page 2: it has 1 page");
    assert!(matches!(open(&alone, Some(0)), Err(Error::Option { option: "page", .. })));
}

#[test]
fn a_page_that_is_damaged_is_named_and_leaves_the_others() {
    let mut bytes = small(&[(10, 2), (30, 2), (50, 2)]);
    // The compression of the second page: 1 becomes one that there is not.
    let entry = [3, 1, 3, 0, 1, 0, 0, 0, 1, 0];
    let places: Vec<usize> = (0..bytes.len() - 10).filter(|&at| bytes[at..at + 10] == entry).collect();
    bytes[places[1] + 8] = 77;
    let pages = pages_of_bytes("scan.tif", bytes, &LoadOptions::default()).unwrap();
    let read: Vec<_> = pages.iter().map(|(number, page)| (number, page.map_err(|e| e.to_string()))).collect();
    assert!(read[0].1.is_ok() && read[2].1.is_ok() && read[2].0 == 3);
    let error = read[1].1.as_ref().unwrap_err();
    assert!(error.starts_with("scan.tif, page 2: "), "{error}");
}

#[test]
fn a_file_of_pages() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("fax.tif");
    std::fs::write(&path, small(&[(1, 2), (2, 2)])).unwrap();
    assert_eq!(levels(&load_pages(&path, &LoadOptions::default()).unwrap()), [1, 2]);
    let missing = load_pages(&folder.path().join("none"), &LoadOptions::default());
    assert!(matches!(missing, Err(Error::Read { .. })));
}

/// Frames of a GIF of 4 x 2 pixels: black; a white pixel over it at the left; nothing new.
fn gif() -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = GifEncoder::new(&mut bytes);
    encoder.set_repeat(Repeat::Infinite).unwrap();
    let clear = Rgba([0, 0, 0, 0]);
    let black = RgbaImage::from_pixel(4, 2, Rgba([0, 0, 0, 255]));
    let mut white = RgbaImage::from_pixel(4, 2, clear);
    white.put_pixel(0, 0, Rgba([255; 4]));
    for image in [black, white, RgbaImage::from_pixel(4, 2, clear)] {
        encoder.encode_frame(Frame::new(image)).unwrap();
    }
    drop(encoder);
    bytes
}

#[test]
fn frames_of_a_gif_lie_over_one_another() {
    let bytes = gif();
    let pages = open(&bytes, None).unwrap();
    assert_eq!((pages.count(), levels(&pages)), (3, vec![0, 255, 255]));
    let second = pages.page(2).unwrap().scan.gray;
    assert_eq!(second.data(), [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], "the first shows through");
    assert_eq!(levels(&open(&bytes, Some(2)).unwrap()), [255]);
    assert!(matches!(load_bytes("a", &bytes, &LoadOptions::default()), Err(Error::ManyPages { pages: 3, .. })));
}

#[test]
fn frames_of_a_webp() {
    let still = |level: u8| {
        let image = RgbaImage::from_pixel(3, 2, Rgba([level, level, level, 255]));
        encode(image, ImageFormat::WebP)[12..].to_vec()
    };
    let chunk = |kind: &[u8], data: &[u8]| [kind, &(data.len() as u32).to_le_bytes(), data].concat();
    let frame = |level| {
        let head = [0, 0, 0, 0, 0, 0, 2, 0, 0, 1, 0, 0, 100, 0, 0, 2];
        chunk(b"ANMF", &[&head[..], &still(level)].concat())
    };
    let canvas = chunk(b"VP8X", &[0x12, 0, 0, 0, 2, 0, 0, 1, 0, 0]);
    let body = [b"WEBP".to_vec(), canvas, chunk(b"ANIM", &[0; 6]), frame(40), frame(200)].concat();
    let bytes = chunk(b"RIFF", &body);
    let pages = open(&bytes, None).unwrap();
    assert_eq!((pages.count(), levels(&pages)), (2, vec![40, 200]));
    assert_eq!(pages.page(2).unwrap().scan.gray.size(), (3, 2));
}

#[test]
fn animations_keep_to_the_limits() {
    let mut bytes = gif();
    bytes[6..10].fill(0xFF);
    let pages = open(&bytes, None).unwrap();
    for (_, page) in pages.iter() {
        assert!(matches!(page, Err(Error::TooLarge { width: 65535, .. } | Error::Decode { .. })));
    }
    assert!(matches!(pages.page(2), Err(Error::TooLarge { .. })));
}

#[test]
fn pages_of_a_pdf() {
    let bytes = pdf(&[("0 0 72 36 re f", 72, 72, ""), ("0 0 36 72 re f", 72, 72, ""), ("", 144, 36, "/Rotate 90")]);
    let pages = open(&bytes, None).unwrap();
    assert_eq!(pages.count(), 3);
    let scans: Vec<_> = pages.iter().map(|(_, page)| page.unwrap().scan).collect();
    let sizes: Vec<_> = scans.iter().map(|s| (s.gray.size(), s.dpi)).collect();
    assert_eq!(sizes, [((300, 300), Some(300.0)), ((300, 300), Some(300.0)), ((150, 600), Some(300.0))]);
    let (lower, left) = (&scans[0].gray, &scans[1].gray);
    assert_eq!((lower[(10, 10)], lower[(10, 290)], lower[(290, 290)]), (1.0, 0.0, 0.0));
    assert_eq!((left[(10, 10)], left[(10, 290)], left[(290, 290)]), (0.0, 0.0, 1.0));
    assert!(scans[2].gray.data().iter().all(|&v| v == 1.0) && scans[2].rgb.is_none());
}

#[test]
fn the_size_of_a_rendered_page_follows_the_options() {
    let bytes = pdf(&[("1 0 0 RG 4 w 0 10 m 100 10 l S", 100, 50, "")]);
    let read = |options: LoadOptions| load_bytes("plan.pdf", &bytes, &options);
    let scan = read(LoadOptions::default().with(|o| o.dpi = Some(72.0.into()))).unwrap().scan;
    assert_eq!((scan.gray.size(), scan.dpi), ((100, 50), Some(72.0)));
    let rgb = scan.rgb.expect("a red line");
    assert_eq!((rgb.get_pixel(50, 40).0, rgb.get_pixel(50, 10).0), ([255, 0, 0], [255; 3]));
    let scan = read(LoadOptions::default().with(|o| o.size = Some(1000))).unwrap().scan;
    assert_eq!((scan.gray.size(), scan.dpi), ((1000, 500), Some(720.0)));
    let error = read(LoadOptions::default().with(|o| o.max_pixels = 10_000)).unwrap_err();
    assert!(matches!(error, Error::TooLarge { width: 417, height: 209, .. }), "{error:?}");
}

#[test]
fn a_pdf_that_cannot_be_read_says_why() {
    let error = |bytes: &[u8]| load_bytes("a.pdf", bytes, &LoadOptions::default()).unwrap_err().to_string();
    assert_eq!(error(include_bytes!("fixtures/locked.pdf")), "a.pdf: the PDF needs a password: save it without one");
    assert_eq!(error(b"%PDF-1.4\n%"), "a.pdf: the PDF is damaged: no pages are found in it");
    assert!(error(&pdf(&[])).contains("no pages"));
}
