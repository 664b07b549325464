//! Lines that touch, or run into one another and part again, go on as they came.
//!
//! Where a circle touches a line, their inks are one for a while. A walk can come out of it by either arm, or end in it
//! because another took its course. The four arms of such a place, as they are outside the shared ink, tell what belongs
//! together: arms that are one line go on in each other's direction and bend alike. Where the walks say otherwise, the
//! shared stretch is taken out of them, and the arms are joined anew.

use crate::clean::LineImage;
use crate::graph::lines::{
    EndState, LARGEST_DEPARTURE, LEAST_GAIN, Line, Lines, THIN, arm_line, bridge, course, departure,
};
use crate::streamline::{STEP, Tail};
use kurbo::{Point, Vec2};
use petgraph::unionfind::UnionFind;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

/// A line is alone where its width can be measured for this many line widths.
const LASTING: f64 = 2.0;
/// So many line widths before shared ink, a walk's course is its own no more.
const BLUR: f64 = 0.5;
/// Stretches nearer to each other than this, in line widths, share their ink.
const NEAR: f64 = 1.3;
/// Arms further apart than this, in line widths, do not meet at one touch.
const LONGEST: f64 = 16.0;
/// What lies between two parts of one touch is at most so many line widths long.
const MIDDLE: f64 = 8.0;
/// An arm's course is that of this many line widths.
const OVER: f64 = 3.0;
/// All arms run along one another within this cosine's angle (40 degrees).
const ALONG_COS: f64 = 0.766;
/// Ink that a stroke runs through has at least this much of a line's.
const INKED: f32 = 0.4;

/// A stretch of a line in shared ink: indices of its points, empty at an end that stopped at another line.
#[derive(Clone, Debug)]
struct Stretch {
    line: usize,
    points: Range<usize>,
}

/// A line that goes into shared ink.
#[derive(Clone, Copy, Debug)]
struct Arm {
    line: usize,
    /// First point of the stretch.
    from: usize,
    /// Index of the last point outside, and whether the stretch comes after it.
    at: usize,
    forward: bool,
    tail: Tail,
}

/// Two arms that are one line.
type Link = [Arm; 2];

/// Joins the arms of every touch as they belong together. Returns how many touches there are where they were not.
pub(in crate::graph) fn part(image: &LineImage, lines: &mut Lines) -> usize {
    let turned: Lines = lines.iter().map(start_alone).collect::<Vec<_>>().into();
    let stretches: Vec<Stretch> = (0..lines.len()).flat_map(|i| stretches(image, &turned, i)).collect();
    if stretches.is_empty() {
        return 0;
    }
    let groups = shared(image, &turned, &stretches);
    let (mut repairs, mut left) = (Vec::new(), Vec::new());
    for group in groups {
        match repaired(image, &turned, &group) {
            Some(links) => repairs.push((group, links)),
            None => left.push(group),
        }
    }
    let whole = over_middles(image, left).into_iter();
    repairs.extend(whole.filter_map(|group| repaired(image, &turned, &group).map(|links| (group, links))));
    let count = repairs.len();
    if count > 0 {
        let (removed, links): (Vec<Vec<Stretch>>, Vec<[Link; 2]>) = repairs.into_iter().unzip();
        let removed = removed.concat();
        let parted = joined(&turned, &removed, links.as_flattened().as_flattened());
        let mut number = 0..;
        let lines = lines.edit();
        lines.retain(|_| number.next().is_some_and(|i| removed.iter().all(|stretch| stretch.line != i)));
        lines.extend(parted);
    }
    count
}

/// A line that, if it is closed, begins in the middle of where it is alone longest.
fn start_alone(line: &Line) -> Line {
    let mut line = line.clone();
    if !line.closed {
        return line;
    }
    let (mut at, mut longest) = (0, 0..0);
    for run in line.widths.chunk_by(|a, b| a.is_finite() == b.is_finite()) {
        if run[0].is_finite() && run.len() > longest.len() {
            longest = at..at + run.len();
        }
        at += run.len();
    }
    let first = longest.start.midpoint(longest.end);
    line.points.rotate_left(first);
    line.widths.rotate_left(first);
    line
}

fn stretches(image: &LineImage, lines: &Lines, i: usize) -> Vec<Stretch> {
    let line = &lines[i];
    let n = line.points.len();
    let lasting = (LASTING * image.line_width / STEP) as usize;
    let mut stretches: Vec<Stretch> = Vec::new();
    let mut at = 0;
    for run in line.widths.chunk_by(|a, b| a.is_finite() == b.is_finite()) {
        let points = at..at + run.len();
        at = points.end;
        let is_alone = run[0].is_finite() && run.len() >= lasting;
        match stretches.last_mut() {
            _ if is_alone => {}
            Some(last) if last.points.end == points.start => last.points.end = points.end,
            _ => stretches.push(Stretch { line: i, points }),
        }
    }
    if !line.closed {
        let ends = [(line.ends[0], 0), (line.ends[1], n)];
        let bare = |&(state, at): &(EndState, usize)| {
            state == EndState::RanIn && stretches.iter().all(|s| s.points.start != at && s.points.end != at)
        };
        let bare: Vec<usize> = ends.iter().filter(|e| bare(e)).map(|e| e.1).collect();
        stretches.extend(bare.into_iter().map(|at| Stretch { line: i, points: at..at }));
    }
    let blur = (BLUR * image.line_width / STEP) as usize;
    for Stretch { points, .. } in &mut stretches {
        *points = points.start.saturating_sub(blur)..(points.end + blur).min(n);
    }
    stretches
}

/// The groups of stretches that share their ink.
fn shared(image: &LineImage, lines: &Lines, stretches: &[Stretch]) -> Vec<Vec<Stretch>> {
    let mut of_line = vec![Vec::new(); lines.len()];
    stretches.iter().enumerate().for_each(|(s, stretch)| of_line[stretch.line].push(s));
    let mut groups = UnionFind::new(stretches.len());
    for (s, stretch) in stretches.iter().enumerate() {
        let line = &lines[stretch.line];
        let points = stretch.points.start.saturating_sub(1)..(stretch.points.end + 1).min(line.points.len());
        for k in points.step_by(2) {
            for (place, ..) in lines.near(line.points[k], NEAR * image.line_width) {
                let at = place.at.round() as usize;
                let holds = |other: &&usize| {
                    let points = &stretches[**other].points;
                    (points.start.saturating_sub(1)..=points.end).contains(&at)
                };
                of_line[place.line].iter().filter(holds).for_each(|&other| {
                    groups.union(s, other);
                });
            }
        }
    }
    grouped(stretches.to_vec(), &mut groups).into_values().collect()
}

/// The stretches of each group, by its root.
fn grouped(stretches: Vec<Stretch>, groups: &mut UnionFind<usize>) -> BTreeMap<usize, Vec<Stretch>> {
    let mut members: BTreeMap<usize, Vec<Stretch>> = BTreeMap::new();
    for (s, stretch) in stretches.into_iter().enumerate() {
        members.entry(groups.find_mut(s)).or_default().push(stretch);
    }
    members
}

/// Groups that a short piece of a line joins, as one: in the middle of a touch, two lines can look like a single one.
fn over_middles(image: &LineImage, groups: Vec<Vec<Stretch>>) -> Vec<Vec<Stretch>> {
    let mut numbered: Vec<(usize, Stretch)> =
        groups.into_iter().enumerate().flat_map(|(g, group)| group.into_iter().map(move |s| (g, s))).collect();
    numbered.sort_by_key(|(_, s)| (s.line, s.points.start));
    let mut whole: Vec<Stretch> = Vec::new();
    let mut is_joined = Vec::new();
    let mut of_group: BTreeMap<usize, usize> = BTreeMap::new();
    let mut groups = UnionFind::new(numbered.len());
    for (g, stretch) in numbered {
        let middle = |last: &Stretch| (stretch.points.start.saturating_sub(last.points.end)) as f64 * STEP;
        let joins =
            |last: &&mut Stretch| last.line == stretch.line && middle(last) <= MIDDLE * image.line_width.max(THIN);
        match whole.last_mut().filter(joins) {
            Some(last) => {
                last.points.end = stretch.points.end;
                *is_joined.last_mut().expect("one of each") = true;
            }
            None => {
                whole.push(stretch);
                is_joined.push(false);
            }
        }
        let place = whole.len() - 1;
        groups.union(*of_group.entry(g).or_insert(place), place);
    }
    let joined: BTreeSet<usize> = (0..whole.len()).filter(|&s| is_joined[s]).map(|s| groups.find_mut(s)).collect();
    grouped(whole, &mut groups)
        .into_iter()
        .filter_map(|(root, group)| joined.contains(&root).then_some(group))
        .collect()
}

/// The pairing of a touch's four arms, if it is not that of the walks.
fn repaired(image: &LineImage, lines: &Lines, group: &[Stretch]) -> Option<[Link; 2]> {
    let lw = image.line_width.max(THIN);
    let arms: Vec<Arm> = group.iter().flat_map(|stretch| arms(lines, stretch, lw)).collect();
    let arms: [Arm; 4] = arms.try_into().ok()?;
    let middle = arms.iter().fold(Vec2::ZERO, |sum, arm| sum + 0.25 * arm.tail.point.to_vec2()).to_point();
    let heading = |arm: &Arm| arm_line(&arm.tail, middle, image.line_width).1;
    let axis = heading(&arms[0]);
    if arms.iter().any(|arm| heading(arm).dot(axis).abs() < ALONG_COS) {
        return None;
    }
    let (a, b): (Vec<Arm>, Vec<Arm>) = arms.iter().partition(|arm| heading(arm).dot(axis) > 0.0);
    let (Ok([a0, a1]), Ok([b0, b1])) = (<[Arm; 2]>::try_from(a), <[Arm; 2]>::try_from(b)) else { return None };
    let cost = |[a, b]: &Link| departure(&a.tail, &b.tail);
    let mut pairings = [[[a0, b0], [a1, b1]], [[a0, b1], [a1, b0]]];
    let costs = pairings.map(|p| p.iter().map(cost).fold((0.0, 0.0f64), |(sum, most), c| (sum + c, most.max(c))));
    let better = usize::from(costs[1].0 < costs[0].0);
    if costs[better].0 + LEAST_GAIN > costs[1 - better].0 || costs[better].1 > LARGEST_DEPARTURE {
        return None;
    }
    pairings.swap(0, better);
    let best = pairings[0];
    let is_walked = |[a, b]: &Link| (a.line, a.from) == (b.line, b.from);
    let fits = |link: &Link| {
        let [a, b] = link.map(|arm| arm.tail);
        let ahead = (b.point - a.point).dot(a.heading) > 0.0 && (a.point - b.point).dot(b.heading) > 0.0;
        let is_inked = |p: &Point| image.ink.sample(*p) > INKED;
        ahead && (a.point - b.point).hypot() <= LONGEST * lw && bridge(&a, &b).iter().all(is_inked)
    };
    (!best.iter().all(is_walked) && best.iter().all(fits)).then_some(best)
}

/// The lines that go into a stretch, at either of its ends.
fn arms(lines: &Lines, stretch: &Stretch, line_width: f64) -> Vec<Arm> {
    let line = &lines[stretch.line];
    let Range { start, end } = stretch.points;
    let arm = |at: usize, forward: bool, outside: Vec<usize>| {
        // Up to where the line is in shared ink again.
        let alone = outside.iter().take_while(|&&k| line.is_alone(k)).count();
        let tail = course(line, &outside[..alone])?;
        Some(Arm { line: stretch.line, from: start, at, forward, tail })
    };
    let outside = |at: i64, step: i64| line.run(at, step, 0.0, OVER * line_width);
    let (before, after) = (outside(start as i64 - 1, -1), outside(end as i64, 1));
    let both = [(before, true), (after, false)].into_iter();
    both.filter_map(|(outside, forward)| arm(*outside.first()?, forward, outside)).collect()
}

/// A part of a line between stretches that were taken out, and the arms that its ends are, if any.
struct Piece {
    line: Line,
    arms: [Option<usize>; 2],
}

/// The lines that had stretches, without them and with their arms linked: each even one with the one after it.
fn joined(lines: &Lines, removed: &[Stretch], arms: &[Arm]) -> Vec<Line> {
    let mut pieces: Vec<Piece> = Vec::new();
    for (i, line) in lines.iter().enumerate() {
        let mut gaps: Vec<Range<usize>> = removed.iter().filter(|s| s.line == i).map(|s| s.points.clone()).collect();
        if gaps.is_empty() {
            continue;
        }
        gaps.sort_by_key(|gap| gap.start);
        let n = line.points.len();
        let from = if line.closed { gaps[0].end } else { 0 };
        let bounds = gaps.iter().flat_map(|gap| [gap.start, gap.end]);
        let mut bounds: Vec<usize> = std::iter::once(0).chain(bounds).chain(std::iter::once(n)).collect();
        if line.closed {
            // From the end of the first gap once around to its beginning.
            bounds = bounds[2..bounds.len() - 1].iter().copied().chain([n + gaps[0].start]).collect();
        }
        let arm = |at: usize, forward: bool| {
            arms.iter().position(|arm| (arm.line, arm.at, arm.forward) == (i, at % n, forward))
        };
        for part in bounds.chunks_exact(2).filter(|part| part[0] < part[1]) {
            let state = |at: usize, end: usize, side: usize| {
                if at == end && !line.closed { line.ends[side] } else { EndState::Parted }
            };
            let ends = [state(part[0], from, 0), state(part[1], n, 1)];
            let line = line.part((part[0]..part[1]).map(|k| k % n), ends);
            pieces.push(Piece { line, arms: [arm(part[0], false), arm(part[1] - 1, true)] });
        }
    }
    chained(pieces, arms)
}

/// The pieces one after the other as their arms are linked.
fn chained(pieces: Vec<Piece>, arms: &[Arm]) -> Vec<Line> {
    let mut of_arm = vec![None; arms.len()];
    for (p, piece) in pieces.iter().enumerate() {
        piece.arms.iter().enumerate().for_each(|(side, arm)| {
            if let Some(arm) = arm {
                of_arm[*arm] = Some((p, side));
            }
        });
    }
    let mut used = vec![false; pieces.len()];
    let mut out = Vec::new();
    // Chains with a beginning first; what is left goes round.
    let begins = (0..pieces.len()).flat_map(|p| [(p, 0), (p, 1)]).filter(|&(p, side)| pieces[p].arms[side].is_none());
    for (first, side) in begins.chain((0..pieces.len()).map(|p| (p, 0))) {
        if used[first] {
            continue;
        }
        used[first] = true;
        let mut line = pieces[first].line.clone().oriented(side);
        let mut leaving = pieces[first].arms[1 - side];
        while let Some((arm, next)) = leaving.and_then(|arm| Some((arm, of_arm[arm ^ 1]?))) {
            line.lead_on(bridge(&arms[arm].tail, &arms[arm ^ 1].tail));
            let (p, side) = next;
            if used[p] {
                line.closed = true;
                break;
            }
            used[p] = true;
            line.append(pieces[p].line.clone().oriented(side));
            leaving = pieces[p].arms[1 - side];
        }
        out.push(line);
    }
    out
}
