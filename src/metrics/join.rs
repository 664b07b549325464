//! Strokes that end at one point where nothing else is are one: a rectangle is the same line work as one path and as four.

use super::chain::Chain;
use super::cloud::{Cloud, at};
use kurbo::Point;
use rstar::RTree;
use rstar::primitives::GeomWithData;
use std::collections::BTreeMap;

/// Ends are at one point within half a pen, or this many pixels where that is more.
const NEAREST: f64 = 1.0;
/// A stroke passes an end if a part of it does that is so many of these distances away from its own ends.
const END_PARTS: f64 = 2.5;

/// An end of a chain: which, and whether it is the last point.
type End = (usize, bool);

/// The chains, joined where exactly two ends meet and no other line passes.
pub(super) fn joined(chains: &[Chain], pen: f64) -> Vec<Chain> {
    let reach = (0.5 * pen).max(NEAREST);
    let mates = mates(chains, reach);
    let mut done = vec![false; chains.len()];
    let mut out = Vec::new();
    for k in 0..chains.len() {
        if done[k] {
            continue;
        }
        let (start, is_loop) = first_of(k, &mates);
        out.push(followed(chains, start, is_loop, &mates, &mut done));
    }
    out
}

/// For each end the one that it is joined with.
fn mates(chains: &[Chain], reach: f64) -> BTreeMap<End, End> {
    let open = || (0..chains.len()).filter(|&k| !chains[k].closed && chains[k].points.len() > 1);
    let ends: Vec<GeomWithData<[f64; 2], End>> = open()
        .flat_map(|k| [(k, false), (k, true)])
        .map(|end| GeomWithData::new(at(place(chains, end)), end))
        .collect();
    let bodies = bodies(chains, reach);
    let tree = RTree::bulk_load(ends);
    let pair = |end: End| {
        let p = at(place(chains, end));
        let near: Vec<End> = tree.locate_within_distance(p, reach * reach).map(|found| found.data).collect();
        let passed = bodies.locate_within_distance(p, reach * reach).next().is_some();
        if near.len() == 2 && !passed { near.into_iter().find(|other| *other != end) } else { None }
    };
    let crowd = |end: End| tree.locate_within_distance(at(place(chains, end)), reach * reach).count();
    let of_end = |end: End| Some((end, pair(end).filter(|&other| crowd(other) == 2)?));
    open().flat_map(|k| [(k, false), (k, true)]).filter_map(of_end).collect()
}

/// The samples of all chains without the parts at their ends.
fn bodies(chains: &[Chain], reach: f64) -> RTree<[f64; 2]> {
    let samples = Cloud::new(chains).samples;
    let mut last = vec![0; chains.len()];
    samples.iter().for_each(|s| last[s.stroke] = last[s.stroke].max(s.number));
    let length = |k: usize| chains[k].points.windows(2).map(|p| p[0].distance(p[1])).sum::<f64>();
    let step: Vec<f64> = (0..chains.len()).map(|k| length(k) / last[k].max(1) as f64).collect();
    let is_body = |stroke: usize, number: usize| {
        let nearer = number.min(last[stroke] - number);
        chains[stroke].closed || step[stroke] * nearer as f64 > END_PARTS * reach
    };
    RTree::bulk_load(samples.iter().filter(|s| is_body(s.stroke, s.number)).map(|s| at(s.position)).collect())
}

fn place(chains: &[Chain], (k, last): End) -> Point {
    let points = &chains[k].points;
    points[if last { points.len() - 1 } else { 0 }]
}

/// The end at which the joined line of a chain begins, and whether it closes.
fn first_of(k: usize, mates: &BTreeMap<End, End>) -> (End, bool) {
    let mut end = (k, false);
    while let Some(&(other, last)) = mates.get(&end) {
        if other == k {
            return ((k, false), true);
        }
        end = (other, !last);
    }
    (end, false)
}

/// The chains one after the other from an end on.
fn followed(chains: &[Chain], start: End, is_loop: bool, mates: &BTreeMap<End, End>, done: &mut [bool]) -> Chain {
    let first = &chains[start.0];
    let mut line = Chain { points: Vec::new(), pieces: 0, closed: first.closed || is_loop, ..first.clone() };
    let mut enter = start;
    loop {
        let (k, from_last) = enter;
        done[k] = true;
        let points = chains[k].points.iter().copied();
        if from_last {
            line.points.extend(points.rev())
        } else {
            line.points.extend(points)
        }
        line.pieces += chains[k].pieces;
        match mates.get(&(k, !from_last)) {
            Some(&next) if !done[next.0] => enter = next,
            _ => break,
        }
    }
    if is_loop {
        line.points.push(line.points[0]);
    }
    line
}
