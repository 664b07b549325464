#![doc = include_str!("graph_json.md")]

use super::document::{Document, WriteOptions};
use super::{Format, lacking};
use crate::drawing::{Color, Dashes, Fill};
use crate::error::{Error, Result};
use crate::graph::{Dot, Edge, Junction, JunctionKind, Page, StrokeGraph, Trail};
use kurbo::{BezPath, PathEl, Point, Vec2};
use petgraph::stable_graph::{EdgeIndex, NodeIndex};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// The member `format` of every file.
pub const FORMAT: &str = "fieldtrace-graph";
/// The version that is written and read.
pub const VERSION: u32 = 1;

/// Decimals of lengths and confidences.
const DECIMALS: i32 = 4;
/// Decimals of what fitting is measured by.
const FINE_DECIMALS: i32 = 8;
/// Coordinates and lengths keep to this many pixels.
const FARTHEST: f64 = 1e6;
/// An edge whose end is farther from its node than this many pixels follows the node.
const MOVED: f64 = 1e-3;

/// The graph that a drawing was made of, as [`to_json`] writes it.
pub(super) struct GraphJson;

impl Format for GraphJson {
    fn name(&self) -> &'static str {
        "json"
    }

    fn has_profiles(&self) -> bool {
        true
    }

    fn encode(&self, document: &Document, options: &WriteOptions) -> Result<Vec<u8>> {
        let graph = document.graph.ok_or_else(|| lacking("json", "the stroke graph that the drawing was made of"))?;
        let origin = serde_json::value::RawValue::from_string(options.origin()).ok();
        Ok(text(graph, origin).into_bytes())
    }
}

/// The members before the lists.
#[derive(Serialize, Deserialize)]
struct Head {
    format: String,
    version: u32,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    origin: Option<Box<serde_json::value::RawValue>>,
    width: f64,
    height: f64,
    #[serde(default)]
    dpi: Option<f64>,
    #[serde(default = "one")]
    scale: f64,
    line_width: f64,
    #[serde(default)]
    blur: f64,
}

#[derive(Serialize, Deserialize)]
struct NodeItem {
    id: u64,
    kind: JunctionKind,
    x: f64,
    y: f64,
    #[serde(default = "one")]
    confidence: f64,
}

#[derive(Serialize, Deserialize)]
struct EdgeItem {
    id: u64,
    from: u64,
    to: u64,
    points: Vec<[f64; 2]>,
    #[serde(default)]
    widths: Option<Vec<Option<f64>>>,
    #[serde(default)]
    noise: f64,
}

#[derive(Serialize, Deserialize)]
struct Step {
    edge: u64,
    #[serde(default)]
    reversed: bool,
}

#[derive(Serialize, Deserialize)]
struct StrokeItem {
    edges: Vec<Step>,
    #[serde(default)]
    closed: bool,
    #[serde(default)]
    color: Color,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    dashes: Option<DashItem>,
}

#[derive(Serialize, Deserialize)]
struct DashItem {
    dash: f64,
    gap: f64,
    #[serde(default)]
    offset: f64,
}

#[derive(Serialize, Deserialize)]
struct DotItem {
    x: f64,
    y: f64,
    diameter: f64,
    #[serde(default)]
    color: Color,
}

#[derive(Serialize, Deserialize)]
struct FillItem {
    rings: Vec<Vec<[f64; 2]>>,
    #[serde(default)]
    color: Color,
}

/// The lists.
#[derive(Deserialize)]
struct Lists {
    nodes: Vec<NodeItem>,
    edges: Vec<EdgeItem>,
    strokes: Vec<StrokeItem>,
    #[serde(default)]
    dots: Vec<DotItem>,
    #[serde(default)]
    fills: Vec<FillItem>,
}

fn one() -> f64 {
    1.0
}

fn round(value: f64, decimals: i32) -> f64 {
    let unit = 10f64.powi(decimals);
    (value * unit).round() / unit
}

/// A graph as JSON text: a head, and one line for each item of the lists; the same graph gives the same bytes.
pub fn to_json(graph: &StrokeGraph) -> String {
    text(graph, None)
}

fn text(graph: &StrokeGraph, origin: Option<Box<serde_json::value::RawValue>>) -> String {
    let page = &graph.page;
    let to_scan = |length: f64| round(length / page.scale, DECIMALS);
    let pair = |p: Point| [to_scan(p.x), to_scan(p.y)];
    let head = Head {
        format: FORMAT.into(),
        version: VERSION,
        origin,
        width: page.width,
        height: page.height,
        dpi: page.dpi,
        scale: page.scale,
        line_width: round(page.line_width / page.scale, FINE_DECIMALS),
        blur: round(page.blur / page.scale, FINE_DECIMALS),
    };
    // Numbers without gaps, so that a graph that is read and written again stays as it is.
    let node_ids: BTreeMap<NodeIndex, u64> = graph.graph.node_indices().zip(0..).collect();
    let edge_ids: BTreeMap<EdgeIndex, u64> = graph.graph.edge_indices().zip(0..).collect();
    let nodes = node_ids.iter().map(|(&n, &id)| {
        let Junction { position, kind, confidence } = graph.graph[n];
        let [x, y] = pair(position);
        line(&NodeItem { id, kind, x, y, confidence: round(confidence, DECIMALS) })
    });
    let edges = edge_ids.iter().filter_map(|(&e, &id)| {
        let (from, to) = graph.graph.edge_endpoints(e)?;
        let Edge { points, widths, noise } = &graph.graph[e];
        let points = points.iter().map(|&p| pair(p)).collect();
        let widths = widths.iter().map(|w| w.is_finite().then(|| to_scan(*w))).collect();
        let (from, to) = (node_ids[&from], node_ids[&to]);
        let noise = round(noise / page.scale, FINE_DECIMALS);
        Some(line(&EdgeItem { id, from, to, points, widths: Some(widths), noise }))
    });
    let strokes = graph.trails.iter().map(|trail| {
        let edges = trail.edges.iter().map(|&(e, reversed)| Step { edge: edge_ids[&e], reversed }).collect();
        let dashes = trail.dashes.map(|Dashes { dash, gap, offset }| DashItem {
            dash: to_scan(dash),
            gap: to_scan(gap),
            offset: to_scan(offset),
        });
        line(&StrokeItem { edges, closed: trail.closed, color: trail.color, dashes })
    });
    let dots = graph.dots.iter().map(|dot| {
        let [x, y] = pair(dot.centre);
        line(&DotItem { x, y, diameter: to_scan(dot.diameter), color: dot.color })
    });
    let fills = graph.fills.iter().map(|fill| {
        let rings = fill.rings().into_iter().map(|ring| ring.into_iter().map(pair).collect()).collect();
        line(&FillItem { rings, color: fill.color })
    });
    let head = line(&head);
    let lists = [
        list("nodes", nodes.collect()),
        list("edges", edges.collect()),
        list("strokes", strokes.collect()),
        list("dots", dots.collect()),
        list("fills", fills.collect()),
    ];
    format!("{{\n{},\n{}\n}}\n", &head[1..head.len() - 1], lists.join(",\n"))
}

fn line(item: &impl Serialize) -> String {
    serde_json::to_string(item).expect("plain data is always JSON")
}

fn list(name: &str, items: Vec<String>) -> String {
    if items.is_empty() { format!("\"{name}\": []") } else { format!("\"{name}\": [\n{}\n]", items.join(",\n")) }
}

/// Whether the bytes are JSON rather than an image: they begin with a brace.
pub fn is_json(bytes: &[u8]) -> bool {
    let text = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    text.trim_ascii_start().starts_with(b"{")
}

/// Reads a graph; `name` is what errors call the file.
///
/// # Errors
/// [`Error::Graph`] with the place and the reason where the bytes are not a graph in this format.
pub fn from_json(name: &str, bytes: &[u8]) -> Result<StrokeGraph> {
    let text = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    let wrong = |(place, reason): Wrong| Error::Graph { input: name.into(), place, reason };
    let head: Head = parse(text).map_err(wrong)?;
    check_head(&head).map_err(wrong)?;
    let lists: Lists = parse(text).map_err(wrong)?;
    Reader::new(&head).read(lists).map_err(wrong)
}

/// A place and a reason.
type Wrong = (String, String);

fn parse<'a, T: Deserialize<'a>>(text: &'a [u8]) -> std::result::Result<T, Wrong> {
    serde_json::from_slice(text).map_err(|e| {
        let (place, reason) = (format!("line {}, column {}", e.line(), e.column()), e.to_string());
        let known = format!(" at line {} column {}", e.line(), e.column());
        (place, reason.strip_suffix(&known).unwrap_or(&reason).to_string())
    })
}

fn within(place: impl Into<String>, value: f64, low: f64, high: f64) -> std::result::Result<f64, Wrong> {
    let ok = value >= low && value <= high;
    if ok { Ok(value) } else { Err((place.into(), format!("{value} is not between {low} and {high}"))) }
}

fn check_head(head: &Head) -> std::result::Result<(), Wrong> {
    if head.format != FORMAT {
        return Err(("format".into(), format!("\"{}\" is not \"{FORMAT}\"", head.format)));
    }
    if head.version != VERSION {
        return Err(("version".into(), format!("{} is not {VERSION}, the one that can be read", head.version)));
    }
    within("width", head.width, 1.0, FARTHEST)?;
    within("height", head.height, 1.0, FARTHEST)?;
    within("scale", head.scale, 0.001, 1000.0)?;
    within("line_width", head.line_width, 0.01, FARTHEST)?;
    within("blur", head.blur, 0.0, FARTHEST)?;
    head.dpi.map_or(Ok(()), |dpi| within("dpi", dpi, 1.0, 100_000.0).map(drop))
}

/// Puts a graph together from its lists.
struct Reader {
    scale: f64,
    graph: StrokeGraph,
    nodes: BTreeMap<u64, NodeIndex>,
    edges: BTreeMap<u64, EdgeIndex>,
}

impl Reader {
    fn new(head: &Head) -> Self {
        let page = Page {
            width: head.width,
            height: head.height,
            dpi: head.dpi,
            scale: head.scale,
            line_width: head.line_width * head.scale,
            blur: head.blur * head.scale,
        };
        let graph = StrokeGraph { page, ..StrokeGraph::default() };
        Self { scale: head.scale, graph, nodes: BTreeMap::new(), edges: BTreeMap::new() }
    }

    fn read(mut self, lists: Lists) -> std::result::Result<StrokeGraph, Wrong> {
        for (i, item) in lists.nodes.iter().enumerate() {
            self.node(&format!("nodes[{i}]"), item)?;
        }
        for (i, item) in lists.edges.iter().enumerate() {
            self.edge(&format!("edges[{i}]"), item)?;
        }
        let mut drawn = BTreeSet::new();
        for (i, item) in lists.strokes.iter().enumerate() {
            let trail = self.trail(&format!("strokes[{i}]"), item, &mut drawn)?;
            self.graph.trails.push(trail);
        }
        for (i, item) in lists.dots.iter().enumerate() {
            let centre = self.point(&format!("dots[{i}]"), [item.x, item.y])?;
            let diameter = self.scale * within(format!("dots[{i}].diameter"), item.diameter, 0.01, FARTHEST)?;
            self.graph.dots.push(Dot { centre, diameter, color: item.color });
        }
        for (i, item) in lists.fills.iter().enumerate() {
            let fill = self.fill(&format!("fills[{i}]"), item)?;
            self.graph.fills.push(fill);
        }
        Ok(self.graph)
    }

    fn point(&self, place: &str, [x, y]: [f64; 2]) -> std::result::Result<Point, Wrong> {
        within(place, x, -FARTHEST, FARTHEST)?;
        within(place, y, -FARTHEST, FARTHEST)?;
        Ok(Point::new(x * self.scale, y * self.scale))
    }

    fn node(&mut self, place: &str, item: &NodeItem) -> std::result::Result<(), Wrong> {
        let position = self.point(place, [item.x, item.y])?;
        let confidence = within(format!("{place}.confidence"), item.confidence, 0.0, 1.0)?;
        let index = self.graph.graph.add_node(Junction { position, kind: item.kind, confidence });
        match self.nodes.insert(item.id, index) {
            None => Ok(()),
            Some(_) => Err((format!("{place}.id"), format!("there are two nodes {}", item.id))),
        }
    }

    fn edge(&mut self, place: &str, item: &EdgeItem) -> std::result::Result<(), Wrong> {
        let node = |member: &str, id: u64| match self.nodes.get(&id) {
            Some(&index) => Ok(index),
            None => Err((format!("{place}.{member}"), format!("there is no node {id}"))),
        };
        let (from, to) = (node("from", item.from)?, node("to", item.to)?);
        let count = item.points.len();
        if count < 2 {
            return Err((format!("{place}.points"), format!("{count} points are too few, two are needed")));
        }
        let widths = item.widths.clone().unwrap_or_else(|| vec![None; count]);
        if widths.len() != count {
            return Err((format!("{place}.widths"), format!("{} widths for {count} points", widths.len())));
        }
        let mut points = Vec::with_capacity(count);
        for (k, &p) in item.points.iter().enumerate() {
            points.push(self.point(&format!("{place}.points[{k}]"), p)?);
        }
        let width = |(k, w): (usize, &Option<f64>)| match w {
            None => Ok(f64::NAN),
            Some(w) => Ok(self.scale * within(format!("{place}.widths[{k}]"), *w, 0.0, FARTHEST)?),
        };
        let widths = widths.iter().enumerate().map(width).collect::<std::result::Result<_, Wrong>>()?;
        follow(&mut points, self.graph.graph[from].position, self.graph.graph[to].position, MOVED * self.scale);
        let noise = self.scale * within(format!("{place}.noise"), item.noise, 0.0, FARTHEST)?;
        let index = self.graph.graph.add_edge(from, to, Edge { points, widths, noise });
        match self.edges.insert(item.id, index) {
            None => Ok(()),
            Some(_) => Err((format!("{place}.id"), format!("there are two edges {}", item.id))),
        }
    }

    fn trail(
        &self,
        place: &str,
        item: &StrokeItem,
        drawn: &mut BTreeSet<EdgeIndex>,
    ) -> std::result::Result<Trail, Wrong> {
        let mut edges = Vec::with_capacity(item.edges.len());
        let (mut first, mut last) = (None, None);
        for (k, step) in item.edges.iter().enumerate() {
            let wrong = |reason: String| (format!("{place}.edges[{k}]"), reason);
            let id = step.edge;
            let &edge = self.edges.get(&id).ok_or_else(|| wrong(format!("there is no edge {id}")))?;
            if !drawn.insert(edge) {
                return Err(wrong(format!("edge {id} is in a stroke already")));
            }
            let (a, b) = self.graph.graph.edge_endpoints(edge).expect("an edge that was added");
            let (a, b) = if step.reversed { (b, a) } else { (a, b) };
            if last.is_some_and(|last| last != a) {
                return Err(wrong(format!("edge {id} does not start where the one before it ends")));
            }
            (first, last) = (first.or(Some(a)), Some(b));
            edges.push((edge, step.reversed));
        }
        if edges.is_empty() {
            return Err((format!("{place}.edges"), "a stroke needs an edge".into()));
        }
        if item.closed && first != last {
            return Err((place.into(), "it is said to be closed, and does not end where it starts".into()));
        }
        let mut dashes = None;
        if let Some(DashItem { dash, gap, offset }) = item.dashes {
            for (member, value) in [("dash", dash), ("gap", gap)] {
                within(format!("{place}.dashes.{member}"), value, 0.01, FARTHEST)?;
            }
            within(format!("{place}.dashes.offset"), offset, 0.0, FARTHEST)?;
            dashes = Some(Dashes { dash, gap, offset }.scaled(self.scale));
        }
        Ok(Trail { edges, closed: item.closed, color: item.color, dashes })
    }

    fn fill(&self, place: &str, item: &FillItem) -> std::result::Result<Fill, Wrong> {
        let mut outline = BezPath::new();
        for (r, ring) in item.rings.iter().enumerate() {
            let place = format!("{place}.rings[{r}]");
            if ring.len() < 3 {
                return Err((place, format!("{} points are too few for an outline", ring.len())));
            }
            for (k, &p) in ring.iter().enumerate() {
                let p = self.point(&format!("{place}[{k}]"), p)?;
                outline.push(if k == 0 { PathEl::MoveTo(p) } else { PathEl::LineTo(p) });
            }
            outline.close_path();
        }
        Ok(Fill { outline, color: item.color })
    }
}

/// Lets the points of an edge follow its nodes: each moves by a share of an end's move that falls evenly along the
/// edge to none at the other end. An end within `slack` of its node just takes its place.
fn follow(points: &mut [Point], from: Point, to: Point, slack: f64) {
    let last = points.len() - 1;
    let moves = [from - points[0], to - points[last]].map(|m| if m.hypot() <= slack { Vec2::ZERO } else { m });
    if moves != [Vec2::ZERO; 2] {
        let steps: Vec<f64> = points.windows(2).map(|p| (p[1] - p[0]).hypot()).collect();
        let total: f64 = steps.iter().sum::<f64>().max(f64::MIN_POSITIVE);
        let mut walked = 0.0;
        for (k, p) in points.iter_mut().enumerate() {
            let t = walked / total;
            *p += moves[0] * (1.0 - t) + moves[1] * t;
            walked += steps.get(k).copied().unwrap_or(0.0);
        }
    }
    (points[0], points[last]) = (from, to);
}
