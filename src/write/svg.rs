//! A drawing as SVG text.

use super::path_data::PathData;
use super::{Rounding, pen_order};
use crate::drawing::{Centreline, Color, Dashes, Drawing, Fill, Segment, Stroke};
use kurbo::{Point, RoundedRect};
use std::collections::BTreeMap;
use svg::node::Comment;
use svg::node::element::{Circle, Group, Line, Path, Rectangle, Title};
use svg::{Document, Node};

/// How a drawing is written as SVG.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SvgOptions {
    /// Decimals of coordinates and widths.
    pub precision: usize,
    /// The document's title, such as the name of the input.
    pub title: Option<String>,
}

impl Default for SvgOptions {
    fn default() -> Self {
        Self { precision: 2, title: None }
    }
}

/// A drawing as SVG text; the same drawing gives the same bytes.
///
/// `viewBox` is in pixels; `width` and `height` are in millimetres where the drawing knows its DPI. Each pen
/// colour is one Inkscape layer, lighter colours below darker ones, with its solid regions first and its
/// strokes in [`pen_order`]. Strokes that are one line, a circle or an upright rectangle are written as such,
/// and a dot as a path of almost no length, drawn by its round cap. Strokes and regions with a coordinate that
/// is not finite are left out.
pub fn to_svg(drawing: &Drawing, options: &SvgOptions) -> String {
    let rounding = Rounding::new(options.precision);
    let mut document = frame(drawing);
    if let Some(title) = &options.title {
        document.append(Title::new(printable(title)));
    }
    document.append(Comment::new(concat!("fieldtrace ", env!("CARGO_PKG_VERSION"))));
    let spare_width = median_width(drawing);
    for (number, (color, layer)) in layers(drawing).iter().rev().enumerate() {
        document.append(group(number + 1, *color, layer, spare_width, rounding));
    }
    let mut text = document.to_string();
    text.push('\n');
    text
}

/// The empty document with its sizes.
fn frame(drawing: &Drawing) -> Document {
    let exact = Rounding::new(4);
    let (width, height) = (exact.text(drawing.width), exact.text(drawing.height));
    let mut document = Document::new()
        .set("viewBox", format!("0 0 {width} {height}"))
        .set("xmlns:inkscape", "http://www.inkscape.org/namespaces/inkscape");
    match drawing.dpi.filter(|dpi| dpi.is_finite() && *dpi > 0.0) {
        Some(dpi) => {
            let mm = |pixels: f64| format!("{}mm", exact.text(pixels * 25.4 / dpi));
            document.assign("width", mm(drawing.width));
            document.assign("height", mm(drawing.height));
        }
        None => {
            document.assign("width", width);
            document.assign("height", height);
        }
    }
    document
}

/// Text without the characters that XML cannot hold.
fn printable(text: &str) -> String {
    let allowed = |c: &char| (*c >= ' ' && !matches!(*c, '\u{7f}'..='\u{9f}' | '\u{fffe}' | '\u{ffff}')) || *c == '\t';
    text.chars().filter(allowed).collect()
}

/// What one pen draws.
#[derive(Default)]
struct Layer<'a> {
    fills: Vec<&'a Fill>,
    strokes: Vec<&'a Stroke>,
}

fn layers(drawing: &Drawing) -> BTreeMap<Color, Layer<'_>> {
    let mut layers = BTreeMap::<Color, Layer>::new();
    for fill in drawing.fills.iter().filter(|f| f.outline.is_finite() && !f.outline.elements().is_empty()) {
        layers.entry(fill.color).or_default().fills.push(fill);
    }
    for stroke in drawing.strokes.iter().filter(|s| is_drawable(&s.centreline)) {
        layers.entry(stroke.color).or_default().strokes.push(stroke);
    }
    layers
}

fn is_drawable(centreline: &Centreline) -> bool {
    let finite = |s: &Segment| match s {
        Segment::Line(l) => l.is_finite(),
        Segment::Arc(a) => {
            a.center.is_finite() && a.radii.is_finite() && a.start_angle.is_finite() && a.sweep_angle.is_finite()
        }
        Segment::Cubic(c) => c.is_finite(),
    };
    match centreline {
        Centreline::Path { segments, .. } => !segments.is_empty() && segments.iter().all(finite),
        Centreline::Circle(c) => c.is_finite(),
        Centreline::Dot(p) => p.is_finite(),
    }
}

/// The width for strokes whose own is not a number.
fn median_width(drawing: &Drawing) -> f64 {
    let mut widths: Vec<f64> = drawing.strokes.iter().map(|s| s.width).filter(|w| w.is_finite()).collect();
    widths.sort_by(f64::total_cmp);
    widths.get(widths.len() / 2).copied().unwrap_or(1.0)
}

fn group(number: usize, color: Color, layer: &Layer, spare_width: f64, rounding: Rounding) -> Group {
    let color = color.to_string();
    let mut group = Group::new()
        .set("id", format!("layer{number}"))
        .set("inkscape:groupmode", "layer")
        .set("inkscape:label", format!("Pen {color}"))
        .set("fill", "none")
        .set("stroke", color.as_str())
        .set("stroke-linecap", "round")
        .set("stroke-linejoin", "round");
    for fill in &layer.fills {
        let path = Path::new()
            .set("d", PathData::outline(rounding, &fill.outline))
            .set("fill", color.as_str())
            .set("fill-rule", "evenodd")
            .set("stroke", "none");
        group.append(path);
    }
    for (i, reversed) in pen_order(&layer.strokes) {
        let turned;
        let stroke = if reversed {
            turned = layer.strokes[i].reversed();
            &turned
        } else {
            layer.strokes[i]
        };
        let width = if stroke.width.is_finite() { stroke.width } else { spare_width };
        let width = rounding.text(width.max(rounding.step()));
        append(&mut group, &stroke.centreline, Pen { width, dashes: stroke.dashes }, rounding);
    }
    group
}

/// How a stroke is drawn.
struct Pen {
    width: String,
    dashes: Option<Dashes>,
}

impl Pen {
    /// Sets the attributes of the pen on an element.
    fn apply<E: Node + Clone>(&self, mut element: E, rounding: Rounding) -> E {
        element.assign("stroke-width", self.width.as_str());
        if let Some(Dashes { dash, gap, offset }) = self.dashes {
            // The pattern repeats, so its errors add up.
            let fine = |v: f64| rounding.finer(2).text(v);
            element.assign("stroke-dasharray", format!("{} {}", fine(dash), fine(gap)));
            if offset >= rounding.step() {
                element.assign("stroke-dashoffset", fine(offset));
            }
        }
        element
    }
}

/// Appends a stroke in its plainest form.
fn append(group: &mut Group, centreline: &Centreline, pen: Pen, rounding: Rounding) {
    let text = |value: f64| rounding.text(value);
    let path = |d: String| pen.apply(Path::new().set("d", d), rounding);
    // A pattern starts where the line does, which a rectangle does not say.
    let rect = if pen.dashes.is_none() { centreline.as_rounded_rect(1e-6) } else { None };
    let rect = rect.filter(|r| r.width().min(r.height()) >= rounding.step());
    if let Some(rect) = rect {
        group.append(pen.apply(rectangle(&rect, rounding), rounding));
        return;
    }
    match centreline {
        Centreline::Path { segments, closed } => match (&segments[..], closed) {
            ([Segment::Line(l)], false) if rounding.point(l.p0) != rounding.point(l.p1) => {
                let line = Line::new()
                    .set("x1", text(l.p0.x))
                    .set("y1", text(l.p0.y))
                    .set("x2", text(l.p1.x))
                    .set("y2", text(l.p1.y));
                group.append(pen.apply(line, rounding));
            }
            _ => group.append(path(PathData::chain(rounding, segments, *closed))),
        },
        Centreline::Circle(c) if c.radius.abs() >= rounding.step() => {
            let circle =
                Circle::new().set("cx", text(c.center.x)).set("cy", text(c.center.y)).set("r", text(c.radius.abs()));
            group.append(pen.apply(circle, rounding));
        }
        Centreline::Circle(c) => group.append(path(PathData::dot(rounding, c.center))),
        Centreline::Dot(p) => group.append(path(PathData::dot(rounding, *p))),
    }
}

fn rectangle(rounded: &RoundedRect, rounding: Rounding) -> Rectangle {
    let (rect, radius) = (rounded.rect(), rounded.radii().top_left);
    // Corners are rounded, not sizes: the far edges are as near to where they were as all else.
    let (start, end) = (rounding.point(rect.origin()), rounding.point(Point::new(rect.x1, rect.y1)));
    let text = |value: f64| rounding.text(value);
    let plain = Rectangle::new()
        .set("x", text(start.x))
        .set("y", text(start.y))
        .set("width", text(end.x - start.x))
        .set("height", text(end.y - start.y));
    if radius >= rounding.step() { plain.set("rx", text(radius)) } else { plain }
}
