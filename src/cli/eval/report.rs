//! Figures as a table and as JSON.

use super::cases::Case;
use crate::metrics::Measurement;
use serde_json::{Map, Value, json};
use std::fmt::Write;

/// The figures of one drawing under one estimator.
pub(super) struct Row {
    pub case: Case,
    pub estimator: String,
    pub measurement: Measurement,
}

/// Everything that was measured.
#[derive(Default)]
pub(super) struct Report {
    pub rows: Vec<Row>,
    /// Files without figures, each with the reason.
    pub left_out: Vec<String>,
}

/// Rows that are averaged.
pub(super) struct Group<'a> {
    pub estimator: &'a str,
    pub kind: &'a str,
    pub family: &'a str,
    pub rows: Vec<&'a Row>,
}

/// The family that stands for all.
pub(super) const ALL: &str = "all";

impl Report {
    /// A block for each estimator and kind of raster: with `files` a row for each drawing, then one for each family
    /// where there are several, and one for all. Columns are named by the figures.
    pub fn table(&self, files: bool) -> String {
        let groups = self.groups();
        let width = self.rows.iter().map(|r| r.case.name.chars().count()).filter(|_| files).max().unwrap_or(0);
        let width = groups.iter().map(|g| heading(g).chars().count()).max().unwrap_or(0).max(width).max(8);
        let mut text = String::new();
        let mut block = None;
        for group in &groups {
            if block != Some((group.estimator, group.kind)) {
                let gap = if block.is_some() { "\n" } else { "" };
                block = Some((group.estimator, group.kind));
                let names = Measurement::NAMES.map(|n| format!("{n:>w$}", w = column(n))).concat();
                let _ = writeln!(text, "{gap}{:width$}    n{names}", heading(group));
                let own = self.rows.iter().filter(|r| files && in_block(r, group));
                own.for_each(|r| line(&mut text, width, &r.case.name, 1, &r.measurement.values()));
            }
            line(&mut text, width, group.family, group.rows.len(), &means(&group.rows));
        }
        text
    }

    /// The same as JSON, with the figures of every drawing; what is not defined is `null`.
    pub fn json(&self) -> String {
        let drawing = |row: &Row| {
            let mut object = Map::new();
            object.insert("name".into(), row.case.name.clone().into());
            object.insert("family".into(), row.case.family().into());
            object.insert("kind".into(), row.case.kind.clone().into());
            object.insert("estimator".into(), row.estimator.clone().into());
            insert_figures(&mut object, &row.measurement.values());
            Value::from(object)
        };
        let mean = |group: &Group| {
            let mut object = Map::new();
            object.insert("family".into(), group.family.into());
            object.insert("kind".into(), group.kind.into());
            object.insert("estimator".into(), group.estimator.into());
            object.insert("n".into(), group.rows.len().into());
            insert_figures(&mut object, &means(&group.rows));
            Value::from(object)
        };
        let drawings: Vec<Value> = self.rows.iter().map(drawing).collect();
        let means: Vec<Value> = self.groups().iter().map(mean).collect();
        format!("{:#}\n", json!({ "means": means, "drawings": drawings, "left_out": self.left_out }))
    }

    /// The rows of each estimator, kind of raster and family, where there are several, and then of [`ALL`].
    pub fn groups(&self) -> Vec<Group<'_>> {
        let keys = |row: &Row| (row.estimator.clone(), row.case.kind.clone());
        let mut blocks: Vec<(String, String)> = self.rows.iter().map(keys).collect();
        // Estimators stay in the order of the command line.
        let mut seen = std::collections::BTreeSet::new();
        blocks.retain(|b| seen.insert(b.clone()));
        let order = |estimator: &str| self.rows.iter().position(|r| r.estimator == estimator);
        blocks.sort_by_key(|(estimator, _)| order(estimator));
        let mut groups = Vec::new();
        for (estimator, kind) in &blocks {
            let rows = || self.rows.iter().filter(|r| r.estimator == *estimator && r.case.kind == *kind);
            let mut families: Vec<&str> = rows().map(|r| r.case.family()).collect();
            families.sort_unstable();
            families.dedup();
            let Some(first) = rows().next() else { continue };
            let (estimator, kind) = (&*first.estimator, &*first.case.kind);
            if families.len() > 1 {
                let of = |family| rows().filter(|r| r.case.family() == family).collect();
                groups.extend(families.iter().map(|&family| Group { estimator, kind, family, rows: of(family) }));
            }
            groups.push(Group { estimator, kind, family: ALL, rows: rows().collect() });
        }
        groups
    }
}

fn in_block(row: &Row, group: &Group) -> bool {
    row.estimator == group.estimator && row.case.kind == group.kind
}

/// The estimator and kind of a group.
pub(super) fn heading(group: &Group) -> String {
    if group.kind.is_empty() { group.estimator.into() } else { format!("{}, {}", group.estimator, group.kind) }
}

/// The mean of each figure over the rows where it is defined; times are those of all pixels together.
pub(super) fn means(rows: &[&Row]) -> [f64; Measurement::NAMES.len()] {
    let values: Vec<_> = rows.iter().map(|r| r.measurement.values()).collect();
    let mut means: [f64; Measurement::NAMES.len()] = std::array::from_fn(|i| {
        let defined: Vec<f64> = values.iter().map(|v| v[i]).filter(|v| v.is_finite()).collect();
        defined.iter().sum::<f64>() / defined.len() as f64
    });
    let total = |f: fn(&Measurement) -> f64| rows.iter().map(|r| f(&r.measurement)).sum::<f64>();
    let [.., field, whole] = &mut means;
    *field = total(|m| m.field_seconds) / total(|m| m.megapixels);
    *whole = total(|m| m.seconds) / total(|m| m.megapixels);
    means
}

/// Width of a figure's column: room for its name and for figures below a thousand.
fn column(name: &str) -> usize {
    name.len().max(7) + 2
}

fn line(text: &mut String, width: usize, name: &str, count: usize, values: &[f64]) {
    let _ = write!(text, "{name:width$} {count:>4}");
    for (value, width) in values.iter().zip(Measurement::NAMES.map(column)) {
        let _ = if value.is_finite() { write!(text, "{value:>width$.3}") } else { write!(text, "{:>width$}", "-") };
    }
    text.push('\n');
}

fn insert_figures(object: &mut Map<String, Value>, values: &[f64]) {
    object.extend(Measurement::NAMES.iter().zip(values).map(|(name, value)| ((*name).into(), json!(value))));
}
