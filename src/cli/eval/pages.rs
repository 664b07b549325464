//! A report to read: the figures by family, and pictures of the worst traces.

use super::report::{ALL, Group, Report, Row, heading, means};
use crate::Error;
use crate::cli::failure::Failure;
use crate::cli::target;
use crate::metrics::Measurement;
use crate::write::write_file;
use std::fmt::Write;
use std::fs;
use std::path::Path;

/// The figures by which traces are told apart: where strokes meet, where they run, and whether they are whole.
const JUDGED: [&str; 3] = ["junction_f1", "f1_0.5", "integrity"];

/// Writes `report.md` to a folder, with the pictures of the `worst` traces of each estimator and kind of raster;
/// `picture` draws one as PNG.
pub(super) fn write(
    folder: &Path,
    report: &Report,
    worst: usize,
    picture: impl Fn(&Row) -> Result<Vec<u8>, Failure>,
) -> Result<(), Failure> {
    let failed = |e: Error| Failure::of(&target::name(folder), &e);
    fs::create_dir_all(folder).map_err(|cause| failed(Error::Write { path: folder.to_owned(), cause }))?;
    let mut text = String::from("# Traces against the strokes that were drawn\n");
    let groups = report.groups();
    for block in groups.chunk_by(|a, b| heading(a) == heading(b)) {
        let _ = writeln!(text, "\n## {}\n\n{}", heading(&block[0]), table(block));
        let Some(all) = block.iter().find(|g| g.family == ALL) else { continue };
        let shown = worst_of(&all.rows, worst);
        if !shown.is_empty() {
            text.push_str(LEGEND);
        }
        for (i, row) in shown.into_iter().enumerate() {
            let file = file_name(row, i + 1);
            write_file(&folder.join(&file), &picture(row)?).map_err(failed)?;
            let name = &row.case.name;
            let _ = writeln!(text, "\n{}. **{name}**: {}\n\n   ![{name}](<{file}>)", i + 1, judged(row));
        }
    }
    for reason in &report.left_out {
        let _ = writeln!(text, "\nLeft out: {reason}");
    }
    write_file(&folder.join("report.md"), text.as_bytes()).map_err(failed)
}

const LEGEND: &str = "The worst traces, over what was drawn: rings are where true strokes meet (small ones: end), crosses \
where traced ones do; each traced stroke has a colour of its own.\n";

/// The means of each family as a Markdown table.
fn table(groups: &[Group]) -> String {
    let mut text = format!("| family | n | {} |\n|---|", Measurement::NAMES.join(" | "));
    text.push_str(&"---:|".repeat(1 + Measurement::NAMES.len()));
    for group in groups {
        let _ = write!(text, "\n| {} | {} |", group.family, group.rows.len());
        means(&group.rows).iter().for_each(|value| {
            let _ = if value.is_finite() { write!(text, " {value:.3} |") } else { write!(text, " |") };
        });
    }
    text.push('\n');
    text
}

/// The rows of the lowest mean of the figures that judge, the lowest first.
fn worst_of<'a>(rows: &[&'a Row], count: usize) -> Vec<&'a Row> {
    let mut rows = rows.to_vec();
    let mark = |row: &Row| JUDGED.map(|name| figure(row, name)).iter().sum::<f64>();
    rows.sort_by(|a, b| mark(a).total_cmp(&mark(b)));
    rows.truncate(count);
    rows
}

fn figure(row: &Row, name: &str) -> f64 {
    let values = row.measurement.values();
    Measurement::NAMES.iter().position(|n| *n == name).map_or(f64::NAN, |i| values[i])
}

fn judged(row: &Row) -> String {
    JUDGED.map(|name| format!("{name} {:.3}", figure(row, name))).join(", ")
}

/// The estimator, kind and name of a row, without what a file's name cannot hold.
fn file_name(row: &Row, rank: usize) -> String {
    let parts = [&*row.estimator, &row.case.kind, &rank.to_string(), &row.case.name];
    let parts: Vec<&str> = parts.into_iter().filter(|part| !part.is_empty()).collect();
    let plain = |c: char| if c.is_alphanumeric() || "-_.".contains(c) { c } else { '_' };
    parts.join("-").chars().map(plain).collect::<String>() + ".png"
}
