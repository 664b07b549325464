//! The common frame of all overlays: the lightened input below, a legend under it.

use crate::error::{Error, Result};
use crate::load::Scan;
use crate::write::Rounding;
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use image::{DynamicImage, ImageFormat, Rgb, RgbImage};
use kurbo::{BezPath, PathEl, Point};
use std::io::Cursor;
use std::sync::{Arc, OnceLock};
use svg::node::element::{Group, Image, Rectangle, Text};
use svg::{Document, Node};
use usvg::fontdb::{Database, FaceInfo, Family, Query};

/// Decimals in overlays: they are for the eye.
pub(super) const DECIMALS: usize = 3;
/// The longer side up to which a PNG is enlarged, at most [`MOST_SCALE`] times.
const PNG_SIDE: f64 = 2400.0;
const MOST_SCALE: f64 = 8.0;

/// What one entry of a legend says.
pub(super) struct Entry {
    /// Any CSS colour.
    pub(super) color: String,
    /// The words beside it.
    pub(super) label: String,
}

/// An entry of a legend.
pub(super) fn entry(color: &str, label: impl Into<String>) -> Entry {
    Entry { color: color.into(), label: label.into() }
}

/// An SVG over the input that is being put together.
pub(super) struct Overlay {
    width: f64,
    height: f64,
    nodes: Vec<Box<dyn Node>>,
}

impl Overlay {
    /// The lightened input alone.
    pub(super) fn over(scan: &Scan) -> Self {
        let (width, height) = (scan.gray.width() as f64, scan.gray.height() as f64);
        let mut overlay = Self { width, height, nodes: Vec::new() };
        if width * height > 0.0 {
            overlay.add(embedded(&DynamicImage::ImageRgb8(lightened(scan)), width, height));
        }
        overlay
    }

    /// A length that can be seen and hides little: a few pixels of the PNG.
    pub(super) fn unit(&self) -> f64 {
        3.2 / png_scale(self.width, self.height)
    }

    /// The input's size.
    pub(super) fn size(&self) -> (f64, f64) {
        (self.width, self.height)
    }

    /// Appends a node in pixels of the input.
    pub(super) fn add(&mut self, node: impl Into<Box<dyn Node>>) {
        self.nodes.push(node.into());
    }

    /// The SVG, with a legend in a strip below the input.
    pub(super) fn finish(self, legend: &[Entry]) -> String {
        let font = (self.width / 45.0).clamp(3.0, 60.0);
        let (legend, height) = legend_strip(legend, self.width.max(20.0 * font), self.height, font);
        let (width, height) = (self.width.max(20.0 * font), self.height + height);
        let exact = Rounding::new(DECIMALS);
        let view = format!("0 0 {} {}", exact.text(width), exact.text(height));
        let mut document = Document::new()
            .set("xmlns:xlink", "http://www.w3.org/1999/xlink")
            .set("width", exact.text(width))
            .set("height", exact.text(height))
            .set("viewBox", view)
            .add(Rectangle::new().set("width", "100%").set("height", "100%").set("fill", "#fff"));
        self.nodes.into_iter().for_each(|node| document.append(node));
        document.append(legend);
        format!("{document}\n")
    }
}

/// The legend and its height; entries flow into lines.
fn legend_strip(entries: &[Entry], width: f64, top: f64, font: f64) -> (Group, f64) {
    let exact = Rounding::new(DECIMALS);
    let mut group = Group::new().set("font-family", "sans-serif").set("font-size", exact.text(font));
    let (mut x, mut y) = (0.5 * font, top + 1.5 * font);
    for entry in entries {
        let advance = font * (2.2 + 0.6 * entry.label.chars().count() as f64);
        if x > font && x + advance > width {
            (x, y) = (0.5 * font, y + 1.5 * font);
        }
        let square = Rectangle::new()
            .set("x", exact.text(x))
            .set("y", exact.text(y - 0.75 * font))
            .set("width", exact.text(0.8 * font))
            .set("height", exact.text(0.8 * font))
            .set("fill", entry.color.as_str());
        let label = Text::new(entry.label.as_str())
            .set("x", exact.text(x + 1.1 * font))
            .set("y", exact.text(y))
            .set("fill", "#222");
        group.append(square);
        group.append(label);
        x += advance;
    }
    let height = if entries.is_empty() { 0.0 } else { y + 0.7 * font - top };
    (group, height)
}

/// The input in pale colours.
fn lightened(scan: &Scan) -> RgbImage {
    let pale = |v: u8| 185 + (u16::from(v) * 70 / 255) as u8;
    RgbImage::from_fn(scan.gray.width() as u32, scan.gray.height() as u32, |x, y| match &scan.rgb {
        Some(rgb) => Rgb(rgb.get_pixel(x, y).0.map(pale)),
        None => Rgb([pale((scan.gray[(x as usize, y as usize)].clamp(0.0, 1.0) * 255.0).round() as u8); 3]),
    })
}

/// A picture inside an SVG, spread over `width x height` from the origin.
pub(super) fn embedded(picture: &DynamicImage, width: f64, height: f64) -> Image {
    let mut png = Cursor::new(Vec::new());
    picture.write_to(&mut png, ImageFormat::Png).expect("a picture with pixels can be held as PNG");
    let data = format!("data:image/png;base64,{}", BASE64_STANDARD.encode(png.into_inner()));
    Image::new()
        .set("width", width)
        .set("height", height)
        .set("preserveAspectRatio", "none")
        .set("image-rendering", "optimizeSpeed")
        .set("xlink:href", data)
}

/// Path data as absolute commands.
pub(super) fn path_data(path: &BezPath) -> String {
    use std::fmt::Write;
    let exact = Rounding::new(DECIMALS);
    let p = |p: Point| format!("{} {}", exact.text(p.x), exact.text(p.y));
    let mut text = String::new();
    for element in path.elements() {
        let _ = match *element {
            PathEl::MoveTo(a) => write!(text, "M{}", p(a)),
            PathEl::LineTo(a) => write!(text, "L{}", p(a)),
            PathEl::QuadTo(a, b) => write!(text, "Q{} {}", p(a), p(b)),
            PathEl::CurveTo(a, b, c) => write!(text, "C{} {} {}", p(a), p(b), p(c)),
            PathEl::ClosePath => write!(text, "Z"),
        };
    }
    text
}

/// A chain of points as a path.
pub(super) fn chain(points: impl IntoIterator<Item = Point>, closed: bool) -> BezPath {
    let mut path = BezPath::new();
    for (i, p) in points.into_iter().enumerate() {
        if i == 0 { path.move_to(p) } else { path.line_to(p) }
    }
    if closed && !path.elements().is_empty() {
        path.close_path();
    }
    path
}

/// The `i`-th of any number of colours, neighbours far apart in hue, all dark enough on a pale ground.
pub(super) fn color(i: usize) -> String {
    let hue = (i as f64 * 0.618_033_988_75).fract();
    let level = [0.82, 0.62][i % 2];
    let channel = |shift: f64| {
        let t = ((hue + shift).fract() * 6.0 - 3.0).abs() - 1.0;
        (255.0 * level * t.clamp(0.0, 1.0)) as u8
    };
    format!("#{:02x}{:02x}{:02x}", channel(0.0), channel(2.0 / 3.0), channel(1.0 / 3.0))
}

/// How many times a PNG of this size is enlarged.
pub(super) fn png_scale(width: f64, height: f64) -> f64 {
    (PNG_SIDE / width.max(height)).floor().clamp(1.0, MOST_SCALE)
}

/// An SVG as a PNG picture; small ones are enlarged, up to eight times.
///
/// # Errors
/// [`Error::Decode`] when the text is not an SVG that can be drawn.
pub fn to_png(svg: &str) -> Result<Vec<u8>> {
    let decode = |reason: String| Error::Decode { input: "the overlay".into(), reason };
    let options = usvg::Options { fontdb: fonts(), ..usvg::Options::default() };
    let tree = usvg::Tree::from_str(svg, &options).map_err(|e| decode(e.to_string()))?;
    let scale = png_scale(tree.size().width().into(), tree.size().height().into()) as f32;
    let pixels = |side: f32| (side * scale).ceil() as u32;
    let mut pixmap = resvg::tiny_skia::Pixmap::new(pixels(tree.size().width()), pixels(tree.size().height()))
        .ok_or_else(|| decode("it is too large to be drawn".into()))?;
    resvg::render(&tree, resvg::tiny_skia::Transform::from_scale(scale, scale), &mut pixmap.as_mut());
    pixmap.encode_png().map_err(|e| decode(e.to_string()))
}

/// The system's fonts, with one that exists as the sans-serif.
fn fonts() -> Arc<Database> {
    static FONTS: OnceLock<Arc<Database>> = OnceLock::new();
    let load = || {
        let mut fonts = Database::new();
        fonts.load_system_fonts();
        let sans = Query { families: &[Family::SansSerif], ..Query::default() };
        if fonts.query(&sans).is_none() {
            let is_sans = |f: &&FaceInfo| f.families.iter().any(|(name, _)| name.contains("Sans"));
            let face = fonts.faces().find(is_sans).or_else(|| fonts.faces().next());
            let found = face.and_then(|f| f.families.first().cloned());
            if let Some((family, _)) = found {
                fonts.set_sans_serif_family(family);
            }
        }
        Arc::new(fonts)
    };
    FONTS.get_or_init(load).clone()
}
