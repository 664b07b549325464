//! Tracing for JavaScript: what the modules in `js` call.
//!
//! Options come as JSON ([`mod@options`]); strokes go out as plain
//! arrays of numbers, which JavaScript sees as typed ones.

mod options;

use fieldtrace::clean::LineImage;
use fieldtrace::field::PolyVectorField;
use fieldtrace::graph::StrokeGraph;
use fieldtrace::hooks::{Observer, Stage};
use fieldtrace::image::{DynamicImage, RgbaImage};
use fieldtrace::load::{LoadOptions, load_bytes, load_image};
use fieldtrace::streamline::Streamline;
use fieldtrace::write::graph_json::{from_json, to_json};
use fieldtrace::write::{Document, WriteOptions, encode, format_named, formats};
use fieldtrace::{Drawing, Scan, Vectorizer};
use js_sys::{Float32Array, Function};
use options::{options, trace_options};
use std::error::Error;
use wasm_bindgen::prelude::*;

/// One in so many points of a streamline is told of.
const THINNED: usize = 4;

/// Traces images under one set of options.
#[wasm_bindgen]
pub struct Tracer {
    vectorizer: Vectorizer,
}

#[wasm_bindgen]
impl Tracer {
    /// One with options as JSON.
    #[wasm_bindgen(constructor)]
    pub fn new(options: &str) -> Result<Tracer, JsError> {
        let vectorizer = Vectorizer::new(trace_options(options)?).map_err(|e| thrown(&e))?;
        Ok(Self { vectorizer })
    }

    /// Traces the content of a file; `name` is for messages. `report` is called with the name of each stage as it
    /// begins, `found` with the points of each streamline, x before y, as it is found.
    pub fn file(
        &self,
        name: &str,
        bytes: &[u8],
        load: &str,
        report: Option<Function>,
        found: Option<Function>,
    ) -> Result<Traced, JsError> {
        let input = load_bytes(name, bytes, &options::<LoadOptions>(load)?).map_err(|e| thrown(&e))?;
        self.scan(&input.scan, Watch { report, found })
    }

    /// Traces pixels, red, green, blue and alpha by rows.
    pub fn pixels(
        &self,
        rgba: Vec<u8>,
        width: u32,
        height: u32,
        load: &str,
        report: Option<Function>,
        found: Option<Function>,
    ) -> Result<Traced, JsError> {
        let image = RgbaImage::from_raw(width, height, rgba);
        let image = image.ok_or_else(|| JsError::new("there are fewer pixels than the size says"))?;
        let input = load_image("image", DynamicImage::ImageRgba8(image), &options::<LoadOptions>(load)?)
            .map_err(|e| thrown(&e))?;
        self.scan(&input.scan, Watch { report, found })
    }

    /// Draws a stroke graph, as [`Traced::graph`] gives it.
    pub fn graph(&self, json: &str) -> Result<Traced, JsError> {
        let graph = from_json("graph", json.as_bytes()).map_err(|e| thrown(&e))?;
        let drawing = self.vectorizer.draw(&graph, &mut Watch::default()).map_err(|e| thrown(&e))?;
        Ok(Traced { graph, drawing })
    }
}

impl Tracer {
    fn scan(&self, scan: &Scan, mut watch: Watch) -> Result<Traced, JsError> {
        watch.begins(Stage::Clean);
        let graph = self.vectorizer.graph(scan, &mut watch).map_err(|e| thrown(&e))?;
        let drawing = self.vectorizer.draw(&graph, &mut watch).map_err(|e| thrown(&e))?;
        Ok(Traced { graph, drawing })
    }
}

/// Tells functions of JavaScript's how far a trace is. What they throw is their own affair.
#[derive(Default)]
struct Watch {
    report: Option<Function>,
    found: Option<Function>,
}

impl Watch {
    fn begins(&self, stage: Stage) {
        if let Some(report) = &self.report {
            let _ = report.call1(&JsValue::NULL, &stage.to_string().into());
        }
    }
}

impl Observer for Watch {
    fn on_line_image(&mut self, _image: &mut LineImage) -> fieldtrace::Result<()> {
        self.begins(Stage::Estimate);
        Ok(())
    }

    fn on_field(&mut self, _image: &LineImage, _field: &mut PolyVectorField) -> fieldtrace::Result<()> {
        self.begins(Stage::Trace);
        Ok(())
    }

    fn on_streamline(&mut self, image: &LineImage, line: &mut Streamline) -> fieldtrace::Result<bool> {
        if let Some(found) = &self.found {
            let last = line.points.len().saturating_sub(1);
            let kept = line.points.iter().enumerate().filter(|(i, _)| i % THINNED == 0 || *i == last);
            let numbers: Vec<f32> = kept.flat_map(|(_, p)| [p.x, p.y]).map(|v| (v / image.scale) as f32).collect();
            let _ = found.call1(&JsValue::NULL, &Float32Array::from(&numbers[..]));
        }
        Ok(true)
    }

    fn on_graph(&mut self, _image: &LineImage, _graph: &mut StrokeGraph) -> fieldtrace::Result<()> {
        self.begins(Stage::Fit);
        Ok(())
    }
}

/// A drawing with the graph it was made of. Lengths are in pixels of the input, y points down.
#[wasm_bindgen]
pub struct Traced {
    graph: StrokeGraph,
    drawing: Drawing,
}

#[wasm_bindgen]
impl Traced {
    /// Width of the canvas.
    #[wasm_bindgen(getter)]
    pub fn width(&self) -> f64 {
        self.drawing.width
    }

    /// Height of the canvas.
    #[wasm_bindgen(getter)]
    pub fn height(&self) -> f64 {
        self.drawing.height
    }

    /// Dots per inch, where they are known.
    #[wasm_bindgen(getter)]
    pub fn dpi(&self) -> Option<f64> {
        self.drawing.dpi
    }

    /// The cubic Bezier pieces of all strokes one after another, eight numbers each: start, two handles, end.
    pub fn beziers(&self) -> Vec<f64> {
        let cubics = self.drawing.strokes.iter().flat_map(|stroke| stroke.centreline.cubics());
        cubics.flat_map(|c| [c.p0, c.p1, c.p2, c.p3]).flat_map(|p| [p.x, p.y]).collect()
    }

    /// How many of the pieces are each stroke's.
    pub fn counts(&self) -> Vec<u32> {
        self.drawing.strokes.iter().map(|stroke| stroke.centreline.cubics().len() as u32).collect()
    }

    /// Widths of the strokes.
    pub fn widths(&self) -> Vec<f64> {
        self.drawing.strokes.iter().map(|stroke| stroke.width).collect()
    }

    /// Widths along the strokes, at even distances, one stroke after another; empty where they were not asked for.
    pub fn profiles(&self) -> Vec<f64> {
        self.drawing.strokes.iter().flat_map(|stroke| stroke.profile.iter().copied()).collect()
    }

    /// How many of those are each stroke's.
    #[wasm_bindgen(js_name = profileCounts)]
    pub fn profile_counts(&self) -> Vec<u32> {
        self.drawing.strokes.iter().map(|stroke| stroke.profile.len() as u32).collect()
    }

    /// Colours of the strokes, 0xrrggbb.
    pub fn colors(&self) -> Vec<u32> {
        self.drawing.strokes.iter().map(|stroke| number(stroke.color)).collect()
    }

    /// Which strokes end where they start: 1, else 0.
    pub fn closed(&self) -> Vec<u8> {
        self.drawing.strokes.iter().map(|stroke| stroke.centreline.is_closed().into()).collect()
    }

    /// Three numbers for each stroke: the lengths of its dashes and gaps, and how far into the pattern it starts; zeros for
    /// an unbroken one.
    pub fn dashes(&self) -> Vec<f64> {
        let of = |stroke: &fieldtrace::Stroke| stroke.dashes.map_or([0.0; 3], |d| [d.dash, d.gap, d.offset]);
        self.drawing.strokes.iter().flat_map(of).collect()
    }

    /// The outlines of the solid regions as paths of SVG.
    #[wasm_bindgen(js_name = solidPaths)]
    pub fn solid_paths(&self) -> Vec<String> {
        self.drawing.fills.iter().map(|fill| fill.outline.to_svg()).collect()
    }

    /// Their colours, 0xrrggbb.
    #[wasm_bindgen(js_name = solidColors)]
    pub fn solid_colors(&self) -> Vec<u32> {
        self.drawing.fills.iter().map(|fill| number(fill.color)).collect()
    }

    /// The stroke graph as JSON, which may be changed and given to [`Tracer::graph`].
    pub fn graph(&self) -> String {
        to_json(&self.graph)
    }

    /// The drawing as JSON, for [`write`].
    pub fn drawing(&self) -> Result<String, JsError> {
        serde_json::to_string(&self.drawing).map_err(|e| thrown(&e))
    }
}

/// The bytes of a file in a format, of a drawing and its graph as [`Traced`] gives them, under options as JSON.
#[wasm_bindgen]
pub fn write(drawing: &str, graph: &str, title: Option<String>, format: &str, how: &str) -> Result<Vec<u8>, JsError> {
    let Some(kind) = format_named(format) else {
        return Err(JsError::new(&format!("format: {format} is none of {}", format_names().join(", "))));
    };
    let drawing: Drawing = serde_json::from_str(drawing).map_err(|e| thrown(&e))?;
    let graph = from_json("graph", graph.as_bytes()).map_err(|e| thrown(&e))?;
    let mut how = options::<WriteOptions>(how)?;
    how.title = title;
    encode(kind, &Document { drawing: &drawing, graph: Some(&graph) }, &how).map_err(|e| thrown(&e))
}

/// The names of the formats that drawings are written in.
#[wasm_bindgen]
pub fn format_names() -> Vec<String> {
    formats().iter().map(|format| format.name().into()).collect()
}

fn number(color: fieldtrace::Color) -> u32 {
    let [r, g, b] = color.0;
    u32::from_be_bytes([0, r, g, b])
}

/// An error with its causes, which JavaScript throws.
fn thrown(error: &dyn Error) -> JsError {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        text = format!("{text}: {error}");
        cause = error.source();
    }
    JsError::new(&text)
}
