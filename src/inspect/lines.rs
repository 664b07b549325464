//! What a pass of the graph did to the lines.

use super::graph::{disc, line_group};
use super::overlay::{Overlay, chain, color, entry, path_data};
use crate::graph::{EndState, Line};
use crate::load::Scan;
use kurbo::Affine;
use std::collections::HashSet;
use svg::node::element::{Group, Path};

/// Lines that are no longer.
const GONE: &str = "#ff9090";
/// Lines that were left alone.
const KEPT: &str = "#909090";

/// Lines before and after a pass: wide and pale what is no longer, in colours with a dot at each end what is new, and thin
/// and grey what was left alone. `scale` is pixels of the line image per pixel of the scan.
pub fn lines_overlay(scan: &Scan, scale: f64, before: &[Line], after: &[Line]) -> String {
    let mut overlay = Overlay::over(scan);
    let unit = overlay.unit();
    let to_scan = Affine::scale(1.0 / scale);
    let path = |line: &Line| path_data(&(to_scan * chain(line.points.iter().copied(), line.closed)));
    let (was, is): (HashSet<_>, HashSet<_>) = (before.iter().map(key).collect(), after.iter().map(key).collect());
    let gone: Vec<&Line> = before.iter().filter(|line| !is.contains(&key(line))).collect();
    let (kept, new): (Vec<&Line>, Vec<&Line>) = after.iter().partition(|line| was.contains(&key(line)));
    for (some, width, stroke) in [(&gone, 3.0, GONE), (&kept, 0.4, KEPT)] {
        let group = line_group(width * unit).set("stroke", stroke);
        overlay.add(some.iter().fold(group, |group, line| group.add(Path::new().set("d", path(line)))));
    }
    let (mut lines, mut ends) = (line_group(0.8 * unit), Group::new());
    for (i, line) in new.iter().enumerate() {
        lines = lines.add(Path::new().set("d", path(line)).set("stroke", color(i)));
        for &end in line.points.first().into_iter().chain(line.points.last()).filter(|_| !line.closed) {
            let dot = disc(to_scan * end, 1.1 * unit);
            ends = ends.add(Path::new().set("d", path_data(&dot)).set("fill", color(i)));
        }
    }
    overlay.add(lines);
    overlay.add(ends);
    overlay.finish(&[
        entry(GONE, format!("{} lines gone (wide)", gone.len())),
        entry(&color(0), format!("{} new (a dot at each end)", new.len())),
        entry(KEPT, format!("{} left alone (thin)", kept.len())),
    ])
}

/// Two lines of the same key look the same, and are known to end alike.
fn key(line: &Line) -> (bool, [EndState; 2], Vec<[u64; 2]>) {
    (line.closed, line.ends, line.points.iter().map(|p| [p.x.to_bits(), p.y.to_bits()]).collect())
}
