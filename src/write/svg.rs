//! A drawing as SVG text.

use super::curves::with_curves;
use super::document::{Document, MILLIMETRES, Shapes, WriteOptions, in_frame, known_dpi};
use super::layers::{Layer, layers};
use super::path_data::PathData;
use super::{Format, Rounding};
use crate::drawing::{Centreline, Dashes, Drawing, Fill, Segment, Stroke};
use crate::error::Result;
use flate2::{Compression, GzBuilder};
use kurbo::{Arc, Point, RoundedRect};
use std::f64::consts::TAU;
use std::io::Write;
use svg::node::Text;
use svg::node::element::{Circle, Element, Group, Line, Path, Rectangle, Title};
use svg::{Document as Root, Node};

/// SVG text.
pub(super) struct Svg;

impl Format for Svg {
    fn name(&self) -> &'static str {
        "svg"
    }

    fn encode(&self, document: &Document, options: &WriteOptions) -> Result<Vec<u8>> {
        Ok(to_svg(&options.in_units(document.drawing)?, options).into_bytes())
    }
}

/// Compressed SVG text.
pub(super) struct Svgz;

impl Format for Svgz {
    fn name(&self) -> &'static str {
        "svgz"
    }

    fn encode(&self, document: &Document, options: &WriteOptions) -> Result<Vec<u8>> {
        Svg.encode(document, options)
    }

    fn pack(&self, bytes: Vec<u8>) -> Vec<u8> {
        let mut packed = GzBuilder::new().write(Vec::new(), Compression::best());
        packed.write_all(&bytes).and_then(|()| packed.finish()).expect("memory takes all bytes")
    }
}

/// A drawing as SVG text; the same drawing gives the same bytes.
///
/// `viewBox` is in units of the drawing, or what [`WriteOptions::frame`] says; `width` and `height` are in millimetres
/// where the drawing knows its DPI. Each pen colour is one Inkscape layer, lighter colours below darker ones, with its
/// solid regions first and its strokes in [`super::pen_order`]. Strokes that are one line, a circle or an upright
/// rectangle are written as such unless paths alone are wanted, and a dot as a path of almost no length, drawn by its
/// round cap. Each element has its own colour and width, for programs that do not look at those of the layer. Strokes
/// and regions with a coordinate that is not finite are left out.
pub fn to_svg(drawing: &Drawing, options: &WriteOptions) -> String {
    let mut drawing = std::borrow::Cow::Borrowed(drawing);
    let mut root = frame(&drawing, options);
    if let Some(frame) = &options.frame {
        drawing = std::borrow::Cow::Owned(in_frame(frame, &drawing));
    }
    if let Some(curves) = options.curves {
        drawing = std::borrow::Cow::Owned(with_curves(&drawing, curves, options.tolerance));
    }
    if let Some(title) = &options.title {
        root.append(Title::new(printable(title)));
    }
    let mut metadata = Element::new("metadata");
    metadata.append(Text::new(options.origin()));
    root.append(metadata);
    let pen = Pen { rounding: Rounding::new(options.precision), shapes: options.shapes };
    layers(&drawing).iter().for_each(|layer| root.append(pen.group(layer)));
    let mut text = root.to_string();
    text.push('\n');
    text
}

/// The empty document with its sizes.
fn frame(drawing: &Drawing, options: &WriteOptions) -> Root {
    let exact = Rounding::new(4);
    let root = Root::new().set("xmlns:inkscape", "http://www.inkscape.org/namespaces/inkscape");
    if let Some(frame) = &options.frame {
        let [left, top, width, height] = frame.view_box.map(|side| exact.text(side));
        let sides = [("width", &frame.width), ("height", &frame.height)];
        let root = root.set("viewBox", format!("{left} {top} {width} {height}"));
        return sides.into_iter().fold(root, |root, (name, side)| match side {
            Some(side) => root.set(name, side.as_str()),
            None => root,
        });
    }
    let (width, height) = (exact.text(drawing.width), exact.text(drawing.height));
    let root = root.set("viewBox", format!("0 0 {width} {height}"));
    match known_dpi(drawing) {
        Some(dpi) => {
            let mm = |pixels: f64| format!("{}mm", exact.text(pixels * MILLIMETRES / dpi));
            root.set("width", mm(drawing.width)).set("height", mm(drawing.height))
        }
        None => root.set("width", width).set("height", height),
    }
}

/// Text without the characters that XML cannot hold.
fn printable(text: &str) -> String {
    let allowed = |c: &char| (*c >= ' ' && !matches!(*c, '\u{7f}'..='\u{9f}' | '\u{fffe}' | '\u{ffff}')) || *c == '\t';
    text.chars().filter(allowed).collect()
}

/// Writes what lies in a layer.
struct Pen {
    rounding: Rounding,
    shapes: Shapes,
}

impl Pen {
    fn group(&self, layer: &Layer) -> Group {
        let color = layer.color.to_string();
        let mut group = Group::new()
            .set("id", format!("pen{}", layer.number))
            .set("inkscape:groupmode", "layer")
            .set("inkscape:label", layer.name())
            .set("fill", "none")
            .set("stroke-linecap", "round")
            .set("stroke-linejoin", "round");
        for fill in &layer.fills {
            group.append(self.region(fill, &color));
        }
        for stroke in &layer.strokes {
            group.append(self.stroke(stroke, &color));
        }
        group
    }

    fn region(&self, fill: &Fill, color: &str) -> Path {
        Path::new()
            .set("d", PathData::outline(self.rounding, &fill.outline))
            .set("fill", color)
            .set("fill-rule", "evenodd")
            .set("stroke", "none")
    }

    /// A stroke with its colour, width and pattern.
    fn stroke(&self, stroke: &Stroke, color: &str) -> Element {
        let mut element = self.shape(stroke);
        element.assign("stroke", color);
        element.assign("stroke-width", self.rounding.text(stroke.width.max(self.rounding.step())));
        if let Some(Dashes { dash, gap, offset }) = stroke.dashes {
            // The pattern repeats, so its errors add up.
            let fine = |v: f64| self.rounding.finer(2).text(v);
            element.assign("stroke-dasharray", format!("{} {}", fine(dash), fine(gap)));
            if offset >= self.rounding.step() {
                element.assign("stroke-dashoffset", fine(offset));
            }
        }
        element
    }

    /// The bare form of a stroke: the plainest there is, or a path.
    fn shape(&self, stroke: &Stroke) -> Element {
        let rounding = self.rounding;
        let path = |d: String| Path::new().set("d", d).into();
        if self.shapes == Shapes::Plain
            && let Some(element) = self.plain(stroke)
        {
            return element;
        }
        match &stroke.centreline {
            Centreline::Path { segments, closed } => path(PathData::chain(rounding, segments, *closed)),
            Centreline::Circle(c) if c.radius.abs() >= rounding.step() => {
                let around = Arc::new(c.center, (c.radius.abs(), c.radius.abs()), 0.0, TAU, 0.0);
                path(PathData::chain(rounding, &[Segment::Arc(around)], true))
            }
            Centreline::Circle(c) => path(PathData::dot(rounding, c.center)),
            Centreline::Dot(p) => path(PathData::dot(rounding, *p)),
        }
    }

    /// A stroke that is a line, a circle or an upright rectangle.
    fn plain(&self, stroke: &Stroke) -> Option<Element> {
        let rounding = self.rounding;
        let text = |value: f64| rounding.text(value);
        // A pattern starts where the line does, which a rectangle does not say.
        let rect = if stroke.dashes.is_none() { stroke.centreline.as_rounded_rect(1e-6) } else { None };
        if let Some(rect) = rect.filter(|r| r.width().min(r.height()) >= rounding.step()) {
            return Some(rectangle(&rect, rounding).into());
        }
        match &stroke.centreline {
            Centreline::Path { segments, closed: false } => match &segments[..] {
                [Segment::Line(l)] if rounding.point(l.p0) != rounding.point(l.p1) => {
                    let from = Line::new().set("x1", text(l.p0.x)).set("y1", text(l.p0.y));
                    Some(from.set("x2", text(l.p1.x)).set("y2", text(l.p1.y)).into())
                }
                _ => None,
            },
            Centreline::Circle(c) if c.radius.abs() >= rounding.step() => {
                let centre = Circle::new().set("cx", text(c.center.x)).set("cy", text(c.center.y));
                Some(centre.set("r", text(c.radius.abs())).into())
            }
            _ => None,
        }
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
