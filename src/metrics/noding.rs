//! Lines cut where they meet.

use super::cloud::at;
use kurbo::{Line, Point};
use rstar::{AABB, RTree, RTreeObject};
use std::collections::BTreeSet;

/// Points closer than this many pixels are the same.
const SAME: f64 = 1e-9;

/// Digits after which two pieces are one piece drawn twice, as a factor on pixels.
const KEY: f64 = 1e6;

/// A piece of a line between two places where lines meet or end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Piece {
    pub start: Point,
    pub end: Point,
    /// In pixels.
    pub length: f64,
}

/// One straight segment of a line.
struct Straight {
    line: usize,
    /// Number within the line.
    index: usize,
    chord: Line,
}

impl RTreeObject for Straight {
    type Envelope = AABB<[f64; 2]>;
    fn envelope(&self) -> Self::Envelope {
        AABB::from_corners(at(self.chord.p0), at(self.chord.p1))
    }
}

/// Cuts lines, given as chains of points, where they cross, touch or begin to overlap, themselves included. What was
/// drawn twice is there once.
pub(super) fn pieces(lines: &[Vec<Point>]) -> Vec<Piece> {
    let straight = |(line, points): (usize, &Vec<Point>)| {
        let chord = move |(index, p): (usize, &[Point])| Straight { line, index, chord: Line::new(p[0], p[1]) };
        points.windows(2).enumerate().map(chord).collect::<Vec<_>>()
    };
    let tree = RTree::bulk_load(lines.iter().enumerate().flat_map(straight).collect());
    let mut seen = BTreeSet::new();
    let mut pieces = Vec::new();
    for (line, points) in lines.iter().enumerate() {
        let cuts = |index: usize| cuts(&tree, lines, line, index);
        pieces.extend(split(points, cuts).into_iter().filter(|p| seen.insert(key(p))).map(|p| piece(&p)));
    }
    pieces
}

/// Where other segments cut one, as parameters along it, sorted; its own ends are 0 and 1.
fn cuts(tree: &RTree<Straight>, lines: &[Vec<Point>], line: usize, index: usize) -> Vec<f64> {
    let own = Line::new(lines[line][index], lines[line][index + 1]);
    let around = AABB::from_corners(
        [own.p0.x.min(own.p1.x) - SAME, own.p0.y.min(own.p1.y) - SAME],
        [own.p0.x.max(own.p1.x) + SAME, own.p0.y.max(own.p1.y) + SAME],
    );
    let mut cuts = Vec::new();
    for other in tree.locate_in_envelope_intersecting(&around) {
        if (other.line, other.index) == (line, index) {
            continue;
        }
        // Neighbours share a point where the line just goes on.
        let last = lines[line].len() - 2;
        let ring = lines[line][0] == lines[line][last + 1];
        let follows = |a: usize, b: usize| a + 1 == b || (ring && a == last && b == 0);
        let (before, after) =
            (other.line == line && follows(other.index, index), other.line == line && follows(index, other.index));
        let [start, end] = [own.p0, own.p1].map(|p| touching(other.chord, p).is_some());
        let [first, last] = [other.chord.p0, other.chord.p1].map(|p| touching(own, p));
        let reached = [first.filter(|_| !after), last.filter(|_| !before)];
        cuts.extend(reached.into_iter().flatten());
        // Neighbours that go back over one another are cut where they turn.
        let back = start && end || first.is_some() && last.is_some();
        cuts.extend((start && (!before || back)).then_some(0.0));
        cuts.extend((end && (!after || back)).then_some(1.0));
        if !before && !after {
            cuts.extend(crossing(own, other.chord));
        }
    }
    cuts.sort_by(f64::total_cmp);
    cuts
}

/// Where along a segment a point lies on it.
fn touching(segment: Line, p: Point) -> Option<f64> {
    let length = segment.p0.distance(segment.p1);
    if length == 0.0 {
        return (p.distance(segment.p0) <= SAME).then_some(0.0);
    }
    let along = (segment.p1 - segment.p0) / length;
    let t = (p - segment.p0).dot(along).clamp(0.0, length);
    ((segment.p0 + along * t).distance(p) <= SAME).then_some(t / length)
}

/// Where along a segment another crosses it.
fn crossing(a: Line, b: Line) -> Option<f64> {
    let (u, v, offset) = (a.p1 - a.p0, b.p1 - b.p0, b.p0 - a.p0);
    let area = u.cross(v);
    let (t, s) = (offset.cross(v) / area, offset.cross(u) / area);
    let within = |t: f64| (0.0..=1.0).contains(&t);
    (within(t) && within(s)).then_some(t)
}

/// A line as chains of points from cut to cut.
fn split(points: &[Point], cuts: impl Fn(usize) -> Vec<f64>) -> Vec<Vec<Point>> {
    let mut chains = vec![vec![points[0]]];
    for (i, p) in points.windows(2).enumerate() {
        for t in cuts(i) {
            let at = p[0].lerp(p[1], t);
            let chain = chains.last_mut().expect("there is always one");
            let same = chain.last() == Some(&at);
            if !same {
                chain.push(at);
            }
            if chain.len() > 1 {
                chains.push(vec![at]);
            }
        }
        let chain = chains.last_mut().expect("there is always one");
        if chain.last() != Some(&p[1]) {
            chain.push(p[1]);
        }
    }
    chains.retain(|c| c.len() > 1);
    chains
}

fn piece(chain: &[Point]) -> Piece {
    let length = chain.windows(2).map(|p| p[0].distance(p[1])).sum();
    Piece { start: chain[0], end: chain[chain.len() - 1], length }
}

/// What two pieces have in common that are one: all points, from whichever end.
fn key(chain: &[Point]) -> Vec<[i64; 2]> {
    let mut key: Vec<[i64; 2]> = chain.iter().map(|p| [p.x, p.y].map(|v| (v * KEY).round() as i64)).collect();
    if key.first() > key.last() {
        key.reverse();
    }
    key
}
