//! Makes the technical drawings of this folder, each as true strokes, a clean render, a scan and a hard page.
//!
//! `cargo run --release --features train --example make-quality`
//!
//! They are the same on every run: all that is random follows from fixed seeds. The icons are not made here.

mod technical;

use fieldtrace::drawing::Drawing;
use fieldtrace::raster::Raster;
use fieldtrace::render::render;
use fieldtrace::synth::{Kind, ScanStyle, page, scan};
use fieldtrace::write::{WriteOptions, to_svg};
use image::codecs::jpeg::JpegEncoder;
use image::{GrayImage, Luma, Rgb, RgbImage};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::error::Error;
use std::fs::{self, File};
use std::path::{Path, PathBuf};

/// Drawings of each kind.
const EACH: usize = 4;

/// JPEG quality of scans and pages.
const QUALITY: u8 = 85;

/// Kinds of hard pages, in turn.
const HARD: [Kind; 6] = [Kind::Pencil, Kind::Copy, Kind::Photo, Kind::Old, Kind::Ruled, Kind::Fax];

fn main() -> Result<(), Box<dyn Error>> {
    for (i, (kind, draw)) in technical::KINDS.into_iter().enumerate() {
        for j in 0..EACH {
            let mut rng = ChaCha8Rng::seed_from_u64((EACH * i + j) as u64);
            let drawing = technical::drawing(draw, &mut rng);
            let name = format!("technical-{kind}-{}", j + 1);
            fs::write(file(&name, "gt.svg"), to_svg(&drawing, &WriteOptions::default().with(|o| o.precision = 3)))?;
            let ink = render(&drawing);
            gray(&ink.map(|i| 1.0 - i)).save(file(&name, "clean.png"))?;
            let style = ScanStyle::draw(&mut rng);
            write_jpeg(&gray(&scan(&mut rng, &ink, &style)).into(), &file(&name, "scan.jpg"))?;
            write_jpeg(&hard(&drawing, HARD[(i + j) % HARD.len()], &mut rng).into(), &file(&name, "hard.jpg"))?;
        }
    }
    Ok(())
}

fn file(name: &str, extension: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/quality").join(format!("{name}.{extension}"))
}

/// A page with the drawing alone, at its own size: pages with writing or other marks beside it are passed over.
fn hard(drawing: &Drawing, kind: Kind, rng: &mut ChaCha8Rng) -> RgbImage {
    let size = (drawing.width as usize, drawing.height as usize);
    loop {
        let page = page(rng, kind, drawing.clone(), &Drawing::new(drawing.width, drawing.height));
        let alone = page.drawing.strokes.len() == drawing.strokes.len() && page.drawing.fills.is_empty();
        if alone && page.color[0].size() == size {
            return RgbImage::from_fn(size.0 as u32, size.1 as u32, |x, y| {
                Rgb([0, 1, 2].map(|c| byte(page.color[c][(x as usize, y as usize)])))
            });
        }
    }
}

fn gray(light: &Raster<f32>) -> GrayImage {
    GrayImage::from_fn(light.width() as u32, light.height() as u32, |x, y| {
        Luma([byte(light[(x as usize, y as usize)])])
    })
}

fn byte(light: f32) -> u8 {
    (255.0 * light).round() as u8
}

fn write_jpeg(image: &image::DynamicImage, path: &Path) -> Result<(), Box<dyn Error>> {
    JpegEncoder::new_with_quality(File::create(path)?, QUALITY).encode_image(image)?;
    Ok(())
}
