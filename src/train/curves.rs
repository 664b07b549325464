//! Learning curves as a picture.

use crate::error::{Error, Result};
use crate::write::write_file;
use std::fs;
use std::path::Path;
use svg::Document;
use svg::node::element::{Line, Polyline, Rectangle, Text};

/// Size of one panel in pixels.
const PANEL: (f64, f64) = (420.0, 260.0);
const MARGIN: f64 = 56.0;

/// Colour-blind safe (Okabe and Ito).
const COLORS: [&str; 4] = ["#0072b2", "#56b4e9", "#d55e00", "#e69f00"];

/// Which columns of the metrics a panel shows, both axes of numbers: steps across, logarithmic upwards.
const PANELS: [Panel; 2] = [
    ("loss", &["loss", "alignment", "clean_mse", "scan_mse"]),
    ("degrees", &["clean_ink_deg", "clean_junction_deg", "scan_ink_deg", "scan_junction_deg"]),
];
/// The same where ink is trained.
const INK_PANELS: [Panel; 2] = [
    ("loss", &["loss", "entropy", "dice"]),
    ("error of coverage", &["clean_mae", "photo_mae", "copy_mae", "pencil_mae"]),
];

type Panel = (&'static str, &'static [&'static str]);

/// Draws the metrics of a run, a CSV with a header, to an SVG.
///
/// # Errors
/// [`Error::Read`] and [`Error::Write`].
pub fn draw(metrics: &Path, out: &Path) -> Result<()> {
    let read = |cause| Error::Read { input: metrics.display().to_string(), cause };
    let text = fs::read_to_string(metrics).map_err(read)?;
    let table = Table::new(&text);
    let (width, height) = (PANEL.0 + 2.0 * MARGIN, PANEL.1 + 2.0 * MARGIN);
    let panels = if table.names.contains(&"entropy") { INK_PANELS } else { PANELS };
    let count = panels.len() as f64;
    let paper = Rectangle::new().set("width", "100%").set("height", "100%").set("fill", "white");
    let mut document = Document::new().set("viewBox", (0.0, 0.0, count * width, height)).add(paper);
    for (i, (title, columns)) in panels.into_iter().enumerate() {
        document = panel(document, i as f64 * width + MARGIN, title, &table, columns);
    }
    write_file(out, document.to_string().as_bytes())
}

struct Table<'a> {
    names: Vec<&'a str>,
    rows: Vec<Vec<f64>>,
}

impl<'a> Table<'a> {
    fn new(text: &'a str) -> Self {
        let mut lines = text.lines();
        let names = lines.next().unwrap_or_default().split(',').collect();
        let rows = lines.map(|l| l.split(',').map(|v| v.parse().unwrap_or(f64::NAN)).collect()).collect();
        Self { names, rows }
    }

    /// Pairs of the first column, the step, and a named one, where that is positive.
    fn series(&self, name: &str) -> Vec<(f64, f64)> {
        let Some(k) = self.names.iter().position(|n| *n == name) else { return Vec::new() };
        let pairs = self.rows.iter().filter_map(|r| Some((*r.first()?, *r.get(k)?)));
        pairs.filter(|(_, value)| *value > 0.0).collect()
    }
}

fn panel(mut document: Document, left: f64, title: &str, table: &Table, columns: &[&str]) -> Document {
    let series: Vec<_> = columns.iter().map(|c| table.series(c)).collect();
    let all = || series.iter().flatten();
    let last = all().map(|p| p.0).fold(1.0, f64::max);
    let low = all().map(|p| p.1).fold(f64::MAX, f64::min).min(1e6);
    let high = all().map(|p| p.1).fold(f64::MIN, f64::max).max(low * 1.1);
    let x = |step: f64| left + step / last * PANEL.0;
    let y = |value: f64| MARGIN + PANEL.1 * (1.0 - (value / low).ln() / (high / low).ln());
    let label = |text: String, x: f64, y: f64, anchor: &str, color: &str| {
        let font = ("sans-serif", 12);
        let text = Text::new(text).set("x", x).set("y", y).set("text-anchor", anchor).set("fill", color.to_owned());
        text.set("font-family", font.0).set("font-size", font.1)
    };
    for t in [0.0, 0.25, 0.5, 0.75, 1.0] {
        let value = low * (high / low).powf(t);
        let grid = Line::new().set("x1", left).set("x2", left + PANEL.0).set("y1", y(value)).set("y2", y(value));
        document = document.add(grid.set("stroke", "#cccccc"));
        document = document.add(label(format!("{value:.3}"), left - 6.0, y(value) + 4.0, "end", "black"));
        document = document.add(label(format!("{:.0}", t * last), x(t * last), y(low) + 18.0, "middle", "black"));
    }
    document = document.add(label(format!("{title} by step"), left, MARGIN - 30.0, "start", "black"));
    for (i, ((points, name), color)) in series.iter().zip(columns).zip(COLORS).enumerate() {
        let line: Vec<String> = points.iter().map(|p| format!("{:.1},{:.1}", x(p.0), y(p.1))).collect();
        let pen = Polyline::new().set("points", line.join(" ")).set("fill", "none").set("stroke", color);
        let name = label((*name).into(), left + i as f64 * PANEL.0 / 4.0, MARGIN - 12.0, "start", color);
        document = document.add(pen.set("stroke-width", 1.5)).add(name);
    }
    document
}
