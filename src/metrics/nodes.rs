//! Where lines meet and where they end.
//!
//! Ink cannot show less than a pen's width. So an end within one pen (and at least 2 px) of a line touches it, be it
//! another line or the far part of its own, and an end that sticks out of a meeting by less than 0.6 pens is none.

use super::chain::{Chain, chains};
use super::cloud::at;
use super::noding::{Piece, pieces};
use crate::drawing::Drawing;
use kurbo::{Line, ParamCurveNearest, Point, Vec2};
use petgraph::unionfind::UnionFind;
use rstar::RTree;
use rstar::primitives::{GeomWithData, Line as Segment};
use std::collections::BTreeMap;

/// How far in pixels a line may be from the chain that stands for it.
const SIMPLER: f64 = 0.05;

/// Lines of at most this many pixels are dots.
const DOT: f64 = 0.5;

/// How far in pixels an end is drawn past the line that it touches, so that they cross.
const PAST: f64 = 1e-3;

/// Ends of pieces within this many pixels are one node.
const SAME_NODE: f64 = 0.6;

/// A piece of less than this many pixels from a node to itself is none.
const LOOP: f64 = 2.0;

/// A piece shorter than this is left by the arithmetic alone.
const NOTHING: f64 = 0.01;

/// The points of a drawing where lines meet and where they end.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Nodes {
    /// Where three or more pieces meet; those within 1.5 pens of one another are one.
    pub junctions: Vec<Point>,
    /// Free ends.
    pub ends: Vec<Point>,
}

/// The nodes of a drawing for a pen of a width in pixels.
pub fn nodes(drawing: &Drawing, pen: f64) -> Nodes {
    let size = (drawing.width.round() as usize, drawing.height.round() as usize);
    of_chains(&chains(drawing, size), pen)
}

/// The nodes of strokes on a raster.
pub(super) fn of_chains(chains: &[Chain], pen: f64) -> Nodes {
    let reach = pen.max(2.0);
    let simple = chains.iter().map(|c| Simple { points: simplified(&c.points), closed: c.closed });
    let lines: Vec<Simple> = simple.filter(|l| length(&l.points) > DOT).collect();
    let pieces: Vec<Piece> = pieces(&touching(&lines, reach)).into_iter().filter(|p| p.length > NOTHING).collect();
    let ends: Vec<Point> = pieces.iter().flat_map(|p| [p.start, p.end]).collect();
    let label = grouped(&ends, SAME_NODE);
    let degree = degrees(&pieces, &label, 0.6 * pen);
    let centre = centres(&ends, &label);
    let of_degree = |wanted: fn(usize) -> bool| -> Vec<Point> {
        centre.iter().zip(&degree).filter(|(_, d)| wanted(**d)).map(|(p, _)| *p).collect()
    };
    let junctions = of_degree(|d| d >= 3);
    let label = grouped(&junctions, 1.5 * reach);
    Nodes { junctions: centres(&junctions, &label), ends: of_degree(|d| d == 1) }
}

/// A line as few points.
struct Simple {
    points: Vec<Point>,
    closed: bool,
}

fn length(points: &[Point]) -> f64 {
    points.windows(2).map(|p| p[0].distance(p[1])).sum()
}

/// The fewest points by Douglas and Peucker (1973).
fn simplified(points: &[Point]) -> Vec<Point> {
    let mut kept = vec![false; points.len()];
    (kept[0], kept[points.len() - 1]) = (true, true);
    let mut open = vec![(0, points.len() - 1)];
    while let Some((from, to)) = open.pop() {
        let chord = Line::new(points[from], points[to]);
        let off = |i: usize| (i, chord.nearest(points[i], 1e-9).distance_sq);
        let farthest = (from + 1..to).map(off).max_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((i, _)) = farthest.filter(|(_, d)| *d > SIMPLER * SIMPLER) {
            kept[i] = true;
            open.extend([(from, i), (i, to)]);
        }
    }
    points.iter().zip(kept).filter(|(_, kept)| *kept).map(|(p, _)| *p).collect()
}

/// The lines with every end that is near a line drawn to it.
fn touching(lines: &[Simple], reach: f64) -> Vec<Vec<Point>> {
    let straight = |(i, l): (usize, &Simple)| {
        let segment = move |p: &[Point]| GeomWithData::new(Segment::new(at(p[0]), at(p[1])), i);
        l.points.windows(2).map(segment).collect::<Vec<_>>()
    };
    let tree: RTree<GeomWithData<Segment<[f64; 2]>, usize>> =
        RTree::bulk_load(lines.iter().enumerate().flat_map(straight).collect());
    let foot = |end: Point, line: usize, far_part: &[Point]| {
        let others = tree.locate_within_distance(at(end), reach * reach).filter(|s| s.data != line);
        let others = others.map(|s| {
            let (from, to): ((f64, f64), (f64, f64)) = (s.geom().from.into(), s.geom().to.into());
            Line::new(from, to)
        });
        let own = far_part.windows(2).map(|p| Line::new(p[0], p[1]));
        let near = others.chain(own).map(|l| (l, l.nearest(end, 1e-9)));
        let nearest = near.min_by(|a, b| a.1.distance_sq.total_cmp(&b.1.distance_sq))?;
        let (line, found) = nearest;
        (found.distance_sq <= reach * reach).then(|| line.p0.lerp(line.p1, found.t))
    };
    let drawn = |(i, line): (usize, &Simple)| {
        let mut points = line.points.clone();
        if !line.closed {
            let mut turned = points.clone();
            turned.reverse();
            let start = foot(points[0], i, &far_part(&points, reach)).map(|f| past(points[0], f));
            let end = foot(turned[0], i, &far_part(&turned, reach)).map(|f| past(turned[0], f));
            points = start.into_iter().chain(points).chain(end).collect();
        }
        points
    };
    lines.iter().enumerate().map(drawn).collect()
}

/// What of a line its own start may touch: all but the first four reaches of a line of more than six.
fn far_part(points: &[Point], reach: f64) -> Vec<Point> {
    if length(points) <= 6.0 * reach {
        return Vec::new();
    }
    let mut left = 4.0 * reach;
    for (i, p) in points.windows(2).enumerate() {
        let step = p[0].distance(p[1]);
        if left < step {
            let start = p[0].lerp(p[1], left / step);
            return std::iter::once(start).chain(points[i + 1..].iter().copied()).collect();
        }
        left -= step;
    }
    Vec::new()
}

/// A little past the foot, seen from an end.
fn past(end: Point, foot: Point) -> Point {
    let way = foot - end;
    let unit = if way.hypot() > 1e-9 { way.normalize() } else { Vec2::ZERO };
    foot + unit * PAST
}

/// For each point the number of its group; groups are of points that a chain of steps within `reach` joins.
fn grouped(points: &[Point], reach: f64) -> Vec<usize> {
    let located = points.iter().enumerate().map(|(i, p)| GeomWithData::new(at(*p), i)).collect();
    let tree: RTree<GeomWithData<[f64; 2], usize>> = RTree::bulk_load(located);
    let mut groups = UnionFind::<usize>::new(points.len());
    for (i, p) in points.iter().enumerate() {
        for near in tree.locate_within_distance(at(*p), reach * reach) {
            groups.union(i, near.data);
        }
    }
    let mut numbers = BTreeMap::new();
    (0..points.len())
        .map(|i| {
            let next = numbers.len();
            *numbers.entry(groups.find(i)).or_insert(next)
        })
        .collect()
}

/// The mean point of each group.
fn centres(points: &[Point], label: &[usize]) -> Vec<Point> {
    let count = label.iter().max().map_or(0, |l| l + 1);
    let mut sums = vec![(Vec2::ZERO, 0.0); count];
    for (p, &l) in points.iter().zip(label) {
        sums[l] = (sums[l].0 + p.to_vec2(), sums[l].1 + 1.0);
    }
    sums.into_iter().map(|(sum, n)| (sum / n).to_point()).collect()
}

/// How many pieces end in each node, once those that are no lines are gone: loops of less than [`LOOP`], and free ends
/// that stick out of a meeting by less than `spur`.
fn degrees(pieces: &[Piece], label: &[usize], spur: f64) -> Vec<usize> {
    let count = label.iter().max().map_or(0, |l| l + 1);
    let nodes = |i: usize| [label[2 * i], label[2 * i + 1]];
    let is_loop = |i: &usize| nodes(*i)[0] == nodes(*i)[1] && pieces[*i].length < LOOP;
    let mut left: Vec<usize> = (0..pieces.len()).filter(|i| !is_loop(i)).collect();
    loop {
        let mut degree = vec![0; count];
        left.iter().flat_map(|&i| nodes(i)).for_each(|n| degree[n] += 1);
        let before = left.len();
        left.retain(|&i| {
            let [a, b] = nodes(i).map(|n| degree[n]);
            !(pieces[i].length < spur && a.min(b) == 1 && a.max(b) >= 3)
        });
        if left.len() == before {
            return degree;
        }
    }
}
