//! A drawing as a page of PDF.

use super::curves::with_curves;
use super::document::{Document, PROGRAM, WriteOptions, known_dpi};
use super::layers::{Layer, layers};
use super::{Curves, Format};
use crate::drawing::{Centreline, Color, Drawing, Fill, Stroke};
use crate::error::Result;
use kurbo::{Affine, BezPath, PathEl, Point};
use pdf_writer::types::{LineCapStyle, LineJoinStyle};
use pdf_writer::{Content, Finish, Name, Pdf, Rect, Ref, TextStr};

/// Points in an inch.
const POINTS: f64 = 72.0;
/// Dots per inch of a drawing that does not know its own: CSS pixels.
const CSS_DPI: f64 = 96.0;

/// One page, each pen an optional content group, as viewers list layers.
pub(super) struct PdfPage;

impl Format for PdfPage {
    fn name(&self) -> &'static str {
        "pdf"
    }

    fn encode(&self, document: &Document, options: &WriteOptions) -> Result<Vec<u8>> {
        let curves = options.curves.unwrap_or(Curves::Bezier);
        Ok(page(&with_curves(document.drawing, curves, options.tolerance), options))
    }
}

fn page(drawing: &Drawing, options: &WriteOptions) -> Vec<u8> {
    let scale = POINTS / known_dpi(drawing).unwrap_or(CSS_DPI);
    let [catalog, tree, page, content, info] = [1, 2, 3, 4, 5].map(Ref::new);
    let layers = layers(drawing);
    let groups: Vec<(Ref, String)> =
        layers.iter().map(|l| (Ref::new(5 + l.number as i32), format!("Pen{}", l.number))).collect();
    let mut pdf = Pdf::new();

    let mut root = pdf.catalog(catalog);
    root.pages(tree);
    let mut properties = root.insert(Name(b"OCProperties")).dict();
    properties.insert(Name(b"OCGs")).array().items(groups.iter().map(|g| g.0));
    properties.insert(Name(b"D")).dict().insert(Name(b"Order")).array().items(groups.iter().map(|g| g.0));
    properties.finish();
    root.finish();
    pdf.pages(tree).kids([page]).count(1);

    let mut sheet = pdf.page(page);
    sheet.media_box(Rect::new(0.0, 0.0, (scale * drawing.width) as f32, (scale * drawing.height) as f32));
    sheet.parent(tree).contents(content);
    let mut resources = sheet.resources();
    let mut names = resources.insert(Name(b"Properties")).dict();
    for (id, name) in &groups {
        names.pair(Name(name.as_bytes()), *id);
    }
    names.finish();
    resources.finish();
    sheet.finish();

    for (layer, (id, _)) in layers.iter().zip(&groups) {
        let mut group = pdf.indirect(*id).dict();
        group.pair(Name(b"Type"), Name(b"OCG"));
        group.pair(Name(b"Name"), TextStr(&layer.name()));
    }
    let map = Affine::new([scale, 0.0, 0.0, -scale, 0.0, scale * drawing.height]);
    pdf.stream(content, &pictured(&layers, &groups, map));
    let mut about = pdf.document_info(info);
    if let Some(title) = &options.title {
        about.title(TextStr(title));
    }
    about.producer(TextStr(PROGRAM));
    about.keywords(TextStr(&options.origin()));
    about.finish();
    pdf.finish()
}

/// The marks on the page.
fn pictured(layers: &[Layer], groups: &[(Ref, String)], map: Affine) -> Vec<u8> {
    let scale = map.determinant().abs().sqrt();
    let mut content = Content::new();
    content.set_line_cap(LineCapStyle::RoundCap).set_line_join(LineJoinStyle::RoundJoin);
    for (layer, (_, name)) in layers.iter().zip(groups) {
        content.begin_marked_content_with_properties(Name(b"OC")).properties_named(Name(name.as_bytes()));
        let [r, g, b] = channels(layer.color);
        content.set_stroke_rgb(r, g, b).set_fill_rgb(r, g, b);
        for Fill { outline, .. } in &layer.fills {
            draw(&mut content, &(map * outline.clone()));
            content.fill_even_odd();
        }
        for stroke in &layer.strokes {
            pen(&mut content, stroke, scale);
            match &stroke.centreline {
                Centreline::Dot(p) => {
                    let p = map * *p;
                    draw(&mut content, &BezPath::from_vec(vec![PathEl::MoveTo(p), PathEl::LineTo(p)]));
                }
                centreline => draw(&mut content, &(map * centreline.to_path())),
            }
            content.stroke();
        }
        content.end_marked_content();
    }
    content.finish().into_vec()
}

fn channels(Color(rgb): Color) -> [f32; 3] {
    rgb.map(|v| f32::from(v) / 255.0)
}

/// Width and pattern of a stroke.
fn pen(content: &mut Content, stroke: &Stroke, scale: f64) {
    content.set_line_width((scale * stroke.width) as f32);
    match stroke.dashes {
        Some(d) => content.set_dash_pattern([d.dash, d.gap].map(|v| (scale * v) as f32), (scale * d.offset) as f32),
        None => content.set_dash_pattern([], 0.0),
    };
}

fn draw(content: &mut Content, path: &BezPath) {
    let f = |p: Point| (p.x as f32, p.y as f32);
    let mut at = Point::ZERO;
    for &el in path.elements() {
        match el {
            PathEl::MoveTo(p) => content.move_to(f(p).0, f(p).1),
            PathEl::LineTo(p) => content.line_to(f(p).0, f(p).1),
            PathEl::QuadTo(a, p) => {
                let (b, c) = (at + (a - at) * (2.0 / 3.0), p + (a - p) * (2.0 / 3.0));
                content.cubic_to(f(b).0, f(b).1, f(c).0, f(c).1, f(p).0, f(p).1)
            }
            PathEl::CurveTo(a, b, p) => content.cubic_to(f(a).0, f(a).1, f(b).0, f(b).1, f(p).0, f(p).1),
            PathEl::ClosePath => content.close_path(),
        };
        at = el.end_point().unwrap_or(at);
    }
}
