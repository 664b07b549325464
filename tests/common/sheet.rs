//! Sheets of figures to look at: what was drawn beside what was traced.

use fieldtrace::drawing::{Centreline, Drawing, Stroke};
use kurbo::{Affine, Point};
use std::fmt::Write;
use std::path::Path;

/// A figure with its trace and what is wrong with it.
pub struct Figure {
    pub label: String,
    pub truth: Drawing,
    pub traced: Drawing,
    pub fault: Option<String>,
}

/// Figures on a sheet, and in a row.
const MOST: usize = 48;
const ROW: usize = 6;
/// Room for words under a figure, and between figures.
const WORDS: f64 = 26.0;
const GAP: f64 = 8.0;

/// Leaves `NAME.svg` in the folder `tmp/sheets` of Cargo's target directory: figures with faults first, in red, then
/// some of the others.
pub fn write(name: &str, figures: &[Figure]) {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("sheets");
    std::fs::create_dir_all(&folder).expect("a folder for sheets");
    std::fs::write(folder.join(format!("{}.svg", name.replace(' ', "-"))), sheet(figures)).expect("a sheet");
}

fn sheet(figures: &[Figure]) -> String {
    let mut shown: Vec<&Figure> = Vec::new();
    for faulty in [true, false] {
        let some: Vec<&Figure> = figures.iter().filter(|f| f.fault.is_some() == faulty).collect();
        let room = if faulty { MOST - ROW } else { MOST.saturating_sub(shown.len()) };
        // Spread over the sweep rather than the first of it.
        let count = some.len().min(room);
        shown.extend((0..count).map(|i| some[i * some.len() / count]));
    }
    let Some(first) = shown.first() else { return String::new() };
    let (width, height) = (2.0 * first.truth.width, first.truth.height + WORDS);
    let rows = shown.len().div_ceil(ROW);
    let size = |count: usize, side: f64| count as f64 * (side + GAP);
    let mut text = format!(
        r#"<svg xmlns="http://www.w3.org/2000/svg" width="{0}" height="{1}"><rect width="{0}" height="{1}" fill="white"/>"#,
        size(ROW, width),
        size(rows, height),
    );
    for (i, figure) in shown.iter().enumerate() {
        let place = (size(i % ROW, width) + 0.5 * GAP, size(i / ROW, height) + 0.5 * GAP);
        cell(&mut text, figure, place);
    }
    text + "</svg>\n"
}

/// The drawing, and to its right the trace over the drawing's pale ink.
fn cell(text: &mut String, figure: &Figure, (x, y): (f64, f64)) {
    let Drawing { width, height, .. } = figure.truth;
    let fault = figure.fault.as_deref();
    let frame = if fault.is_some() { "#d00000" } else { "#c0c0c0" };
    let _ = write!(
        text,
        r#"<g transform="translate({x} {y})" fill="none" stroke-linecap="round" stroke-linejoin="round">"#
    );
    let _ = write!(text, r#"<rect width="{}" height="{height}" stroke="{frame}" stroke-width="0.5"/>"#, 2.0 * width);
    ink(text, &figure.truth, "#000", 0.0);
    ink(text, &figure.truth, "#d8d8d8", width);
    for (i, stroke) in figure.traced.strokes.iter().enumerate() {
        traced(text, stroke, COLORS[i % COLORS.len()], width);
    }
    for fill in &figure.traced.fills {
        let d = moved(&fill.outline, width).to_svg();
        let _ = write!(text, r##"<path d="{d}" fill="#f08c00" fill-opacity="0.6"/>"##);
    }
    let words = [(figure.label.as_str(), "#444", 8.0), (fault.unwrap_or(""), "#d00000", 19.0)];
    for (words, color, below) in words {
        let words = words.replace('<', "under ").replace('&', "and");
        let _ = write!(
            text,
            r#"<text y="{}" font-family="sans-serif" font-size="7" fill="{color}">{words}</text>"#,
            height + below
        );
    }
    text.push_str("</g>");
}

const COLORS: [&str; 8] = ["#d00000", "#0060e0", "#00903c", "#a000c0", "#c07000", "#008c9c", "#e0007a", "#5a5a00"];

fn moved(path: &kurbo::BezPath, right: f64) -> kurbo::BezPath {
    Affine::translate((right, 0.0)) * path
}

/// Ink as it was drawn.
fn ink(text: &mut String, drawing: &Drawing, color: &str, right: f64) {
    for fill in &drawing.fills {
        let _ = write!(text, r#"<path d="{}" fill="{color}"/>"#, moved(&fill.outline, right).to_svg());
    }
    for stroke in &drawing.strokes {
        let d = path_data(stroke, right);
        let _ = write!(text, r#"<path d="{d}" stroke="{color}" stroke-width="{}"/>"#, stroke.width);
    }
}

/// A traced centreline, with its ends.
fn traced(text: &mut String, stroke: &Stroke, color: &str, right: f64) {
    let d = path_data(stroke, right);
    let _ = write!(text, r#"<path d="{d}" stroke="{color}" stroke-width="0.8"/>"#);
    let _ =
        write!(text, r#"<path d="{d}" stroke="{color}" stroke-opacity="0.25" stroke-width="{:.2}"/>"#, stroke.width);
    if !stroke.centreline.is_closed() {
        for Point { x, y } in [stroke.centreline.start(), stroke.centreline.end()] {
            let _ = write!(text, r#"<circle cx="{:.2}" cy="{y:.2}" r="1.4" fill="{color}"/>"#, x + right);
        }
    }
}

fn path_data(stroke: &Stroke, right: f64) -> String {
    match stroke.centreline {
        Centreline::Dot(p) => format!("M{:.2} {:.2}h0.01", p.x + right, p.y),
        _ => moved(&stroke.centreline.to_path(), right).to_svg(),
    }
}
