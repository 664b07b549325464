//! Makes the pictures of this folder from its SVG sources, and the picture of the README from one of them.
//!
//! `cargo run --release --example make-samples`
//!
//! The pictures are the same on every run: all noise follows from fixed seeds.

mod paper;

use fieldtrace::drawing::{Color, Drawing};
use fieldtrace::load::{LoadOptions, load};
use fieldtrace::options::Options;
use fieldtrace::pipeline::Vectorizer;
use fieldtrace::raster::Raster;
use fieldtrace::render::render;
use image::codecs::jpeg::JpegEncoder;
use image::{GrayImage, Luma, Rgb, RgbImage};
use paper::Paper;
use std::error::Error;
use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};

fn main() -> Result<(), Box<dyn Error>> {
    save_png(&rendered("kettle")?, "kettle.png", None)?;
    save_png(&rendered("plan")?, "plan.png", Some(150.0))?;
    save_png(&Paper::INK.scan(&rendered("boat")?, 11), "boat.png", None)?;
    save_jpeg(&Paper::PENCIL.scan(&rendered("leaf")?, 7), "leaf.jpg")?;
    before_and_after("leaf.jpg", "before-after.png")
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("samples")
}

/// The lightness of a source at one pixel a unit.
fn rendered(name: &str) -> Result<Raster<f32>, fieldtrace::Error> {
    let options = LoadOptions::default().with(|o| o.dpi = Some(96.0.into()));
    Ok(load(&folder().join(name).with_extension("svg"), &options)?.scan.gray)
}

fn gray_image(light: &Raster<f32>) -> GrayImage {
    GrayImage::from_fn(light.width() as u32, light.height() as u32, |x, y| {
        Luma([(255.0 * light[(x as usize, y as usize)]).round() as u8])
    })
}

/// Writes a grey PNG, with its resolution where it has one.
fn save_png(light: &Raster<f32>, name: &str, dpi: Option<f64>) -> Result<(), Box<dyn Error>> {
    let file = BufWriter::new(File::create(folder().join(name))?);
    let mut encoder = png::Encoder::new(file, light.width() as u32, light.height() as u32);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::Eight);
    let per_metre = |dpi: f64| (dpi / 0.0254).round() as u32;
    encoder.set_pixel_dims(dpi.map(|dpi| png::PixelDimensions {
        xppu: per_metre(dpi),
        yppu: per_metre(dpi),
        unit: png::Unit::Meter,
    }));
    encoder.write_header()?.write_image_data(gray_image(light).as_raw())?;
    Ok(())
}

fn save_jpeg(light: &Raster<f32>, name: &str) -> Result<(), Box<dyn Error>> {
    let file = BufWriter::new(File::create(folder().join(name))?);
    JpegEncoder::new_with_quality(file, 85).encode_image(&gray_image(light))?;
    Ok(())
}

/// A scan beside its trace, every stroke of it in a colour of its own.
fn before_and_after(input: &str, output: &str) -> Result<(), Box<dyn Error>> {
    let scan = load(&folder().join(input), &LoadOptions::default())?.scan;
    let drawing = Vectorizer::new(Options::default())?.trace(&scan)?;
    let (width, height) = scan.gray.size();
    let gap = 12;
    let mut picture = RgbImage::from_pixel((2 * width + gap) as u32, height as u32, Rgb([255; 3]));
    for y in 0..height {
        for x in 0..width {
            // Few levels, for a small file.
            let level = ((scan.gray[(x, y)] * 12.0).round() * 255.0 / 12.0) as u8;
            picture.put_pixel(x as u32, y as u32, Rgb([level; 3]));
        }
    }
    const COLORS: [[u8; 3]; 6] =
        [[200, 30, 40], [20, 90, 190], [20, 140, 70], [200, 110, 0], [130, 50, 170], [0, 140, 150]];
    for (i, stroke) in drawing.strokes.iter().enumerate() {
        let alone = Drawing { strokes: vec![stroke.clone()], ..Drawing::new(drawing.width, drawing.height) };
        paint(&mut picture, (width + gap) as u32, &render(&alone), Color(COLORS[i % COLORS.len()]));
    }
    picture.save(folder().join(output))?;
    println!("{input}: {} strokes of {} pieces", drawing.strokes.len(), drawing.segment_count());
    Ok(())
}

/// Lays ink of a colour over a picture, from a column on.
fn paint(picture: &mut RgbImage, left: u32, ink: &Raster<f32>, color: Color) {
    for y in 0..ink.height() {
        for x in 0..ink.width() {
            let cover = ink[(x, y)];
            let pixel = picture.get_pixel_mut(left + x as u32, y as u32);
            for (channel, target) in pixel.0.iter_mut().zip(color.0) {
                *channel = (f32::from(*channel) * (1.0 - cover) + f32::from(target) * cover).round() as u8;
            }
        }
    }
}
