//! What each stage gave, as text, and whether two such texts say the same.

use crate::common::compare::{Apart, apart, lines};
use crate::common::sweep::ensure;
use fieldtrace::clean::LineImage;
use fieldtrace::drawing::Drawing;
use fieldtrace::field::{PolyVectorField, decode};
use fieldtrace::graph::StrokeGraph;
use fieldtrace::hooks::Observer;
use fieldtrace::load::Scan;
use fieldtrace::options::Options;
use fieldtrace::pipeline::Vectorizer;
use fieldtrace::streamline::Streamline;
use fieldtrace::write::{WriteOptions, to_svg};
use kurbo::{BezPath, Point};
use serde_json::{Value, json};

/// Pixels along the side of a block of the mask.
const BLOCK: usize = 8;
/// Pixels between samples of the field.
const STRIDE: usize = 5;

/// The results of all stages.
#[derive(Default)]
pub struct Stages {
    image: Option<LineImage>,
    field: Option<PolyVectorField>,
    streamlines: Vec<Streamline>,
    graph: StrokeGraph,
    drawing: Drawing,
}

impl Observer for Stages {
    fn on_line_image(&mut self, image: &mut LineImage) -> fieldtrace::Result<()> {
        self.image = Some(image.clone());
        Ok(())
    }
    fn on_field(&mut self, _: &LineImage, field: &mut PolyVectorField) -> fieldtrace::Result<()> {
        self.field = Some(field.clone());
        Ok(())
    }
    fn on_streamline(&mut self, _: &LineImage, streamline: &mut Streamline) -> fieldtrace::Result<bool> {
        self.streamlines.push(streamline.clone());
        Ok(true)
    }
    fn on_graph(&mut self, _: &LineImage, graph: &mut StrokeGraph) -> fieldtrace::Result<()> {
        self.graph = graph.clone();
        Ok(())
    }
    fn on_drawing(&mut self, drawing: &mut Drawing) -> fieldtrace::Result<()> {
        self.drawing = drawing.clone();
        Ok(())
    }
}

impl Stages {
    /// Runs all stages on a scan.
    pub fn of(scan: &Scan) -> Self {
        let mut stages = Self::default();
        let vectorizer = Vectorizer::new(Options::default()).expect("the defaults are in range");
        vectorizer.trace_observed(scan, &mut stages).expect("a trace");
        stages
    }

    fn image(&self) -> &LineImage {
        self.image.as_ref().expect("a line image")
    }
}

/// Rounded, to keep the files small.
fn round(value: f64, decimals: i32) -> f64 {
    let unit = 10f64.powi(decimals);
    (value * unit).round() / unit
}

/// One line for every item, so that changes show.
fn text(head: &Value, items: impl Iterator<Item = Value>) -> String {
    let items: Vec<String> = items.map(|item| item.to_string()).collect();
    format!("{{\"head\": {head},\n\"items\": [\n{}\n]}}\n", items.join(",\n"))
}

fn parse(text: &str) -> (Value, Vec<Value>) {
    let mut value: Value = serde_json::from_str(text).expect("JSON");
    let items = value["items"].as_array().expect("items").clone();
    (value["head"].take(), items)
}

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().expect("an array").iter().map(number).collect()
}

/// Whether a number of the head is within a share, or a small amount, of what it was.
fn close(key: &str, before: &Value, now: &Value, share: f64, amount: f64) -> Result<(), String> {
    let (a, b) = (number(&before[key]), number(&now[key]));
    ensure((a - b).abs() <= share * a.abs() + amount, || format!("{key} was {a} and is {b}"))
}

/// Line width, scale, noise, and how much of each block of pixels is ink.
pub fn clean_text(stages: &Stages) -> String {
    let image = stages.image();
    let (width, height) = image.mask.size();
    let head = json!({
        "width": width, "height": height, "scale": image.scale, "solids": image.solids.len(),
        "line_width": round(image.line_width, 3), "noise": round(image.noise.mean().along, 4),
    });
    let count = |x: usize, y: usize| {
        let rows = y * BLOCK..((y + 1) * BLOCK).min(height);
        let inked = |row: usize| {
            image.mask.row(row)[x * BLOCK..((x + 1) * BLOCK).min(width)].iter().filter(|&&ink| ink).count()
        };
        rows.map(inked).sum::<usize>()
    };
    let row = |y: usize| json!((0..width.div_ceil(BLOCK)).map(|x| count(x, y)).collect::<Vec<_>>());
    text(&head, (0..height.div_ceil(BLOCK)).map(row))
}

/// The same size and scale, line widths within 3 per cent, the mask within 2 per cent of its ink.
pub fn compare_clean(before: &str, now: &str) -> Result<(), String> {
    let ((a, blocks_a), (b, blocks_b)) = (parse(before), parse(now));
    for key in ["width", "height", "scale", "solids"] {
        close(key, &a, &b, 0.0, 1e-9)?;
    }
    close("line_width", &a, &b, 0.03, 0.0)?;
    close("noise", &a, &b, 0.3, 0.005)?;
    let counts = |blocks: &[Value]| -> Vec<f64> { blocks.iter().flat_map(numbers).collect() };
    let (a, b) = (counts(&blocks_a), counts(&blocks_b));
    let off: f64 = a.iter().zip(&b).map(|(a, b)| (a - b).abs()).sum();
    let share = off / a.iter().sum::<f64>();
    ensure(share <= 0.02, || format!("{share:.3} of the mask changed"))
}

/// Both directions in degrees at every few pixels of the mask.
pub fn field_text(stages: &Stages) -> String {
    let image = stages.image();
    let field = stages.field.as_ref().expect("a field");
    let (width, height) = field.size();
    let degrees = |d: kurbo::Vec2| round(d.atan2().to_degrees().rem_euclid(180.0), 1);
    let sample = |x: usize, y: usize| {
        let here = image.mask[(x, y)] && field.confidence()[(x, y)] > 0.0;
        let frame = here.then(|| decode(field.c0()[(x, y)], field.c2()[(x, y)])).flatten()?;
        Some(json!([x, y, degrees(frame.u), degrees(frame.v)]))
    };
    let pixels = (0..height).step_by(STRIDE).flat_map(|y| (0..width).step_by(STRIDE).map(move |x| (x, y)));
    text(&json!({ "width": width, "height": height }), pixels.filter_map(|(x, y)| sample(x, y)))
}

/// Defined on the same pixels but for 3 per cent; directions within 2 degrees in the mean, whichever comes first.
pub fn compare_field(before: &str, now: &str) -> Result<(), String> {
    let ((a, samples_a), (b, samples_b)) = (parse(before), parse(now));
    close("width", &a, &b, 0.0, 0.0)?;
    close("height", &a, &b, 0.0, 0.0)?;
    let (a, b): (Vec<_>, Vec<_>) = (samples_a.iter().map(numbers).collect(), samples_b.iter().map(numbers).collect());
    let between = |p: f64, q: f64| {
        let d = (p - q).rem_euclid(180.0);
        d.min(180.0 - d)
    };
    let (mut errors, mut common) = (0.0, 0.0);
    for p in &a {
        let Some(q) = b.iter().find(|q| q[..2] == p[..2]) else { continue };
        let straight = between(p[2], q[2]) + between(p[3], q[3]);
        let swapped = between(p[2], q[3]) + between(p[3], q[2]);
        errors += 0.5 * straight.min(swapped);
        common += 1.0;
    }
    let share = common / a.len().max(b.len()) as f64;
    ensure(share >= 0.97, || format!("{share:.3} of the pixels are in both"))?;
    let mean = errors / common;
    ensure(mean <= 2.0, || format!("directions differ by {mean:.2} degrees"))
}

/// Every fourth point of every streamline, which is two pixels.
pub fn streamlines_text(stages: &Stages) -> String {
    let point = |p: &Point| json!([round(p.x, 1), round(p.y, 1)]);
    let line = |s: &Streamline| {
        let last = s.points.last().filter(|_| !s.closed).or(s.points.first());
        json!(s.points.iter().step_by(4).chain(last).map(point).collect::<Vec<_>>())
    };
    text(&json!({ "count": stages.streamlines.len() }), stages.streamlines.iter().map(line))
}

/// A tenth more or fewer of them, 0.2 pixels apart in the mean.
pub fn compare_streamlines(before: &str, now: &str) -> Result<(), String> {
    let ((a, lines_a), (b, lines_b)) = (parse(before), parse(now));
    close("count", &a, &b, 0.1, 1.0)?;
    let path = |line: &Value| {
        let mut path = BezPath::new();
        for point in line.as_array().expect("points") {
            let p = numbers(point);
            if path.is_empty() { path.move_to((p[0], p[1])) } else { path.line_to((p[0], p[1])) }
        }
        path
    };
    let paths = |lines: &[Value]| -> Vec<BezPath> { lines.iter().map(path).collect() };
    within(apart(&paths(&lines_a), &paths(&lines_b)), 0.2, 6.0)
}

fn within(apart: Apart, mean: f64, max: f64) -> Result<(), String> {
    ensure(apart.mean <= mean && apart.max <= max, || format!("{apart:.3?}"))
}

/// Nodes with their kinds, and how many strokes and dots there are.
pub fn graph_text(stages: &Stages) -> String {
    let graph = &stages.graph;
    let head = json!({ "trails": graph.trails.len(), "dots": graph.dots.len() });
    let mut nodes: Vec<(f64, f64, String)> = graph
        .graph
        .node_weights()
        .map(|n| (round(n.position.y, 1), round(n.position.x, 1), format!("{:?}", n.kind)))
        .collect();
    nodes.sort_by(|a, b| a.partial_cmp(b).expect("finite"));
    text(&head, nodes.into_iter().map(|(y, x, kind)| json!([x, y, kind])))
}

/// As many strokes and dots but for a twentieth; nine of ten nodes of the same kind within two pixels.
pub fn compare_graph(before: &str, now: &str) -> Result<(), String> {
    let ((a, nodes_a), (b, nodes_b)) = (parse(before), parse(now));
    close("trails", &a, &b, 0.05, 0.0)?;
    close("dots", &a, &b, 0.05, 0.0)?;
    // The first point of a closed line is arbitrary.
    let placed = |nodes: Vec<Value>| -> Vec<Value> { nodes.into_iter().filter(|n| n[2] != "Seam").collect() };
    let (a, b) = (placed(nodes_a), placed(nodes_b));
    let same = |p: &Value, q: &Value| {
        p[2] == q[2] && (number(&p[0]) - number(&q[0])).hypot(number(&p[1]) - number(&q[1])) <= 2.0
    };
    let found = |from: &[Value], to: &[Value]| from.iter().filter(|p| to.iter().any(|q| same(p, q))).count();
    let share = (found(&a, &b) + found(&b, &a)) as f64 / (a.len() + b.len()) as f64;
    ensure(share >= 0.9, || format!("{share:.3} of the nodes are in both"))
}

/// The SVG as it is written.
pub fn fit_text(stages: &Stages) -> String {
    to_svg(&stages.drawing, &WriteOptions::default())
}

/// As many strokes but for a twentieth and pieces but for an eighth, 0.1 pixels apart in the mean and 2 at most, and
/// as wide in the mean.
pub fn compare_fit(before: &str, now: &str) -> Result<(), String> {
    let read = |text: &str| {
        let tree = usvg::Tree::from_str(text, &usvg::Options::default()).expect("SVG");
        fieldtrace::load::svg::drawing(&tree, 1.0)
    };
    let (a, b) = (read(before), read(now));
    let size = |d: &Drawing| {
        let width = d.strokes.iter().map(|s| s.width).sum::<f64>() / d.strokes.len() as f64;
        json!({ "strokes": d.strokes.len(), "pieces": d.segment_count(), "width": width, "fills": d.fills.len() })
    };
    let (sizes_a, sizes_b) = (size(&a), size(&b));
    close("strokes", &sizes_a, &sizes_b, 0.05, 0.0)?;
    close("pieces", &sizes_a, &sizes_b, 0.125, 1.0)?;
    close("width", &sizes_a, &sizes_b, 0.03, 0.0)?;
    close("fills", &sizes_a, &sizes_b, 0.0, 0.0)?;
    within(apart(&lines(&a), &lines(&b)), 0.1, 2.0)
}
