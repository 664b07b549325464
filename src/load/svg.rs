//! SVG inputs: parsed by `usvg`, rendered by `resvg` over white.

mod arcs;
mod radii;
mod strokes;

pub use strokes::drawing;

use super::plan::Plan;
use super::{Dpi, Input, LoadOptions, undecodable};
use crate::drawing::Drawing;
use crate::error::{Error, Result};
use crate::place::Frame;
use flate2::read::GzDecoder;
use image::{DynamicImage, ImageReader, RgbaImage};
use kurbo::{Affine, Rect, Shape, Vec2};
use resvg::tiny_skia::{Color, Pixmap, Transform};
use std::borrow::Cow;
use std::io::{Cursor, Read};
use std::sync::{Arc, OnceLock};
use usvg::fontdb::Database;
use usvg::roxmltree::{Document, ParsingOptions};
use usvg::{ImageHrefResolver, Tree};

/// Longer side in pixels below which a drawing is enlarged where neither a size nor a resolution was asked for.
const SMALLEST_SIDE: f64 = 512.0;

/// Most bytes that a compressed SVG may unpack to.
const LARGEST_TEXT: u64 = 256 << 20;

/// CSS pixels in an inch.
const CSS_DPI: f64 = 96.0;

const GZIP: [u8; 2] = [0x1F, 0x8B];

/// Whether bytes are an SVG or a compressed file, which only an SVG may be.
pub(super) fn is_svg(bytes: &[u8]) -> bool {
    let text = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes).trim_ascii_start();
    bytes.starts_with(&GZIP) || text.starts_with(b"<")
}

/// Parses and renders an SVG.
///
/// # Errors
/// [`Error::Decode`], [`Error::TooLarge`] and [`Error::NothingVisible`].
pub(super) fn load(name: &str, bytes: &[u8], options: &LoadOptions) -> Result<Input> {
    let text = unpack(name, bytes)?;
    let (tree, frame) = parse(name, &text, options)?;
    let scale = scale(&tree, options);
    let canvas = canvas(&tree, scale);
    options.check_size(name, canvas.0, canvas.1)?;
    let too_large = || undecodable(name, format!("a rendering of {} x {} pixels is too large", canvas.0, canvas.1));
    let size = (u32::try_from(canvas.0).map_err(|_| too_large())?, u32::try_from(canvas.1).map_err(|_| too_large())?);
    let plan = Plan::rendered(name, size, options.dpi.map_or(scale * CSS_DPI, Dpi::finer), options)?;
    let image = render(&tree, scale, size).ok_or_else(too_large)?;
    if image.as_raw().iter().all(|&v| v == 255) {
        return Err(Error::NothingVisible { input: name.into() });
    }
    let scan = plan.scan(DynamicImage::ImageRgba8(image));
    let mut drawing = drawing(&tree, scale);
    drawing.dpi = scan.dpi;
    if let Some(corner) = plan.corner() {
        crop(&mut drawing, corner, scan.gray.size());
    }
    let frame = Some(frame).filter(|_| plan.corner().is_none());
    Ok(Input { scan, drawing: Some(drawing), frame })
}

/// How an SVG says its size. Without a view box, units are CSS pixels.
fn frame(document: &Document, tree: &Tree) -> Frame {
    let root = document.root_element();
    let attribute = |name: &str| root.attribute(name).map(str::to_owned);
    let size = tree.size();
    let whole = [0.0, 0.0, f64::from(size.width()), f64::from(size.height())];
    let own = root.attribute("viewBox").and_then(|text| text.parse::<svgtypes::ViewBox>().ok());
    let view_box = own.map_or(whole, |own| [own.x, own.y, own.w, own.h]);
    Frame { width: attribute("width"), height: attribute("height"), view_box }
}

fn unpack<'a>(name: &str, bytes: &'a [u8]) -> Result<Cow<'a, [u8]>> {
    if !bytes.starts_with(&GZIP) {
        return Ok(Cow::Borrowed(bytes));
    }
    let mut text = Vec::new();
    GzDecoder::new(bytes).take(LARGEST_TEXT + 1).read_to_end(&mut text).map_err(|e| undecodable(name, e))?;
    if text.len() as u64 > LARGEST_TEXT {
        return Err(undecodable(name, "the compressed SVG unpacks to more than 256 MB"));
    }
    Ok(Cow::Owned(text))
}

/// The tree of a text, and how it says its size.
fn parse(name: &str, text: &[u8], options: &LoadOptions) -> Result<(Tree, Frame)> {
    // `usvg` refuses more than a million elements or a thousand inside one another on its own.
    let mut parser = usvg::Options { image_href_resolver: embedded_images(options.max_pixels), ..Default::default() };
    // Reading the system's fonts takes longer than a whole trace. Where there are none, text is left out.
    if text.windows(5).any(|w| w == b"<text") || text.windows(5).any(|w| w == b":text") {
        parser.fontdb = system_fonts();
    }
    let document = document(name, text)?;
    let tree = Tree::from_xmltree(&document, &parser).map_err(|e| undecodable(name, e))?;
    let frame = frame(&document, &tree);
    Ok((tree, frame))
}

/// The elements of a text whose arcs can all be taken apart.
fn document<'a>(name: &str, text: &'a [u8]) -> Result<Document<'a>> {
    let text = std::str::from_utf8(text).map_err(|e| undecodable(name, e))?;
    let options = ParsingOptions { allow_dtd: true, ..Default::default() };
    let document = Document::parse_with_options(text, options).map_err(|e| undecodable(name, e))?;
    match radii::too_large(&document) {
        Some(radius) => Err(undecodable(name, format!("an arc has a radius of {radius:e}"))),
        None => Ok(document),
    }
}

/// The fonts of the system, read once.
fn system_fonts() -> Arc<Database> {
    static FONTS: OnceLock<Arc<Database>> = OnceLock::new();
    let fonts = FONTS.get_or_init(|| {
        let mut fonts = Database::new();
        fonts.load_system_fonts();
        Arc::new(fonts)
    });
    Arc::clone(fonts)
}

/// Shows images that are part of the file and of bearable size; other files are none of an SVG's business.
fn embedded_images(max_pixels: u64) -> ImageHrefResolver<'static> {
    let resolve = ImageHrefResolver::default_data_resolver();
    let bearable = move |data: &[u8]| {
        if is_svg(data) {
            return unpack("", data).is_ok_and(|text| document("", &text).is_ok());
        }
        let reader = ImageReader::new(Cursor::new(data)).with_guessed_format().ok();
        let size = reader.and_then(|r| r.into_dimensions().ok());
        size.is_none_or(|(w, h)| u64::from(w) * u64::from(h) <= max_pixels)
    };
    ImageHrefResolver {
        resolve_data: Box::new(move |mime: &str, data: Arc<Vec<u8>>, parser: &usvg::Options| {
            bearable(&data).then(|| resolve(mime, data, parser)).flatten()
        }),
        resolve_string: Box::new(|_, _| None),
    }
}

/// Pixels of the rendering for one CSS pixel.
fn scale(tree: &Tree, options: &LoadOptions) -> f64 {
    let longer = f64::from(tree.size().width().max(tree.size().height()));
    match (options.size, options.dpi) {
        (Some(size), _) => f64::from(size) / longer,
        (None, Some(dpi)) => dpi.finer() / CSS_DPI,
        (None, None) => (SMALLEST_SIDE / longer).max(1.0),
    }
}

/// Width and height in whole pixels that hold the drawing at a scale.
fn canvas(tree: &Tree, scale: f64) -> (u64, u64) {
    // Sizes are single precision: what is over a whole number by less than that is no pixel of its own.
    let side = |css: f32| ((f64::from(css) * scale * (1.0 - 1e-6)).ceil() as u64).max(1);
    (side(tree.size().width()), side(tree.size().height()))
}

/// Makes a drawing that of the part of its canvas that has a corner and a size in pixels: what lies wholly outside is
/// left out, all else is kept whole.
fn crop(drawing: &mut Drawing, corner: (u32, u32), size: (usize, usize)) {
    let shift = Vec2::new(-f64::from(corner.0), -f64::from(corner.1));
    let part = Rect::new(0.0, 0.0, size.0 as f64, size.1 as f64);
    (drawing.width, drawing.height) = (part.width(), part.height());
    drawing.strokes.retain_mut(|stroke| {
        stroke.centreline = stroke.centreline.transformed(1.0, shift);
        let bounds = stroke.centreline.to_path().bounding_box().inflate(stroke.width / 2.0, stroke.width / 2.0);
        bounds.overlaps(part)
    });
    drawing.fills.retain_mut(|fill| {
        fill.outline.apply_affine(Affine::translate(shift));
        fill.outline.bounding_box().overlaps(part)
    });
}

/// The rendering over white; `None` where the canvas cannot be had.
fn render(tree: &Tree, scale: f64, (width, height): (u32, u32)) -> Option<RgbaImage> {
    let mut pixmap = Pixmap::new(width, height)?;
    pixmap.fill(Color::WHITE);
    resvg::render(tree, Transform::from_scale(scale as f32, scale as f32), &mut pixmap.as_mut());
    RgbaImage::from_raw(width, height, pixmap.take())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_markup_and_gzip_count_as_svg() {
        assert!(is_svg(b"\xEF\xBB\xBF  \n<?xml version='1.0'?><svg/>"));
        assert!(is_svg(b"\x1F\x8B\x08"));
        assert!(!is_svg(b"P1 1 1 0") && !is_svg(b"\x89PNG") && !is_svg(b""));
    }

    #[test]
    fn the_scale_follows_size_then_resolution_then_the_smallest_side() {
        let tree = |w: f64, h: f64| {
            let text = format!("<svg xmlns='http://www.w3.org/2000/svg' width='{w}' height='{h}'/>");
            Tree::from_str(&text, &usvg::Options::default()).unwrap()
        };
        let options = |size, dpi: Option<f64>| LoadOptions { size, dpi: dpi.map(Into::into), ..LoadOptions::default() };
        assert_eq!(canvas(&tree(24.0, 12.0), scale(&tree(24.0, 12.0), &options(None, None))), (512, 256));
        assert_eq!(scale(&tree(2000.0, 100.0), &options(None, None)), 1.0);
        assert_eq!(scale(&tree(24.0, 12.0), &options(None, Some(192.0))), 2.0);
        for size in [1, 7, 333, 1000, 4096] {
            let t = tree(33.3, 77.7);
            assert_eq!(canvas(&t, scale(&t, &options(Some(size), Some(300.0)))).1, u64::from(size));
        }
    }
}
