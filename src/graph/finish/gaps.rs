//! Lines that go on behind a gap in their ink.
//!
//! Two free ends face one another when each lies on the other's course and the courses agree. A short gap between
//! them is bridged: a light pencil left it. Many of them at even distances along one line are dashes, which are kept
//! as they are, or joined into one dashed stroke where that is asked for.

use super::confidence::{PointsOfEdges, course, points_of_edges};
use crate::clean::LineImage;
use crate::drawing::Dashes;
use crate::graph::lines::arm_line;
use crate::graph::point_index::PointIndex;
use crate::graph::{Edge, JunctionKind, StrokeGraph, Trail};
use crate::options::{Dashing, Options};
use crate::streamline::{STEP, Tail, angle_between};
use kurbo::{CubicBez, Line, ParamCurve, ParamCurveNearest, Point};
use petgraph::stable_graph::{EdgeIndex, NodeIndex};
use petgraph::visit::EdgeRef;

/// The gap that is bridged in unsure ink, in line widths, when nothing else is asked for. In sure ink every gap was meant.
const UNSURE_GAP: f64 = 1.5;
/// Between dashes there is at most so much paper, in line widths.
const DASH_GAP: f64 = 8.0;
/// How far an end may lie beside the other's course: in line widths, and as a share of the distance.
const BESIDE: f64 = 0.25;
const BESIDE_SHARE: f64 = 0.15;
/// Courses turn by less than this (26 degrees) over a gap, beyond what their curvature makes of it.
const TURN: f64 = 0.45;
/// A stroke of less than this many of its widths is straight as far as its course can be told.
const SHORT: f64 = 4.0;
/// Widths differ by less than this factor.
const WIDTHS: f64 = 1.6;
/// Dashes are at least this many.
const FEWEST_DASHES: usize = 4;
/// Long and short dashes in turns are at least this many.
const FEWEST_ALTERNATING: usize = 5;
/// Lengths of dashes, and of the gaps between them, keep to their median but for this share and so many pixels.
const UNEVEN: f64 = 0.25;
const UNEVEN_PIXELS: f64 = 1.5;
/// A dash is at most this many times as long as the gap after it.
const LONGEST_DASH: f64 = 8.0;

/// One end of an open stroke, in the open.
pub(super) struct FreeEnd {
    pub node: NodeIndex,
    pub point: Point,
    /// Where its course leads to beside the end.
    pub aim: Point,
    pub course: Tail,
    width: f64,
    /// Length of its stroke.
    length: f64,
}

/// Two ends that face each other, and how badly.
#[derive(Clone, Copy)]
struct Link {
    ends: [usize; 2],
    /// Paper between their inks, in pixels.
    paper: f64,
    misfit: f64,
}

/// The links of a chain of dashes, and the pattern that it can be joined in.
type Dashed = (Vec<Link>, Option<Dashes>);

/// Bridges gaps and finds dashes, as the options ask. Returns how many gaps were bridged.
pub(in crate::graph) fn bridge(image: &LineImage, graph: &mut StrokeGraph, options: &Options) -> usize {
    let most = options.gap.unwrap_or(image.noise.grains()[1] * UNSURE_GAP) * image.line_width;
    let join = options.dashes == Dashing::Join;
    if most <= 0.0 && !join {
        return 0;
    }
    let finder = Finder::new(image, graph);
    let links = finder.links(most.max(DASH_GAP * image.line_width));
    let (dashed, plain) = finder.dashes(&links);
    let short: Vec<Link> =
        plain.into_iter().filter(|l| l.paper <= finder.bridged(l, options.gap) && finder.is_short(l)).collect();
    let mut seams: Vec<(Link, Option<Dashes>)> = short.into_iter().map(|link| (link, None)).collect();
    if join {
        let joined = dashed.into_iter().filter_map(|(links, dashes)| Some((links, dashes?)));
        seams.extend(joined.flat_map(|(links, dashes)| links.into_iter().map(move |l| (l, Some(dashes)))));
    }
    let ends = finder.ends;
    join_trails(graph, &ends, &seams);
    seams.len()
}

struct Finder<'a> {
    image: &'a LineImage,
    graph: &'a StrokeGraph,
    points: PointsOfEdges,
    /// Two for each stroke: where it starts and where it ends; `None` where that is not in the open.
    ends: Vec<Option<FreeEnd>>,
}

impl<'a> Finder<'a> {
    fn new(image: &'a LineImage, graph: &'a StrokeGraph) -> Self {
        Self { image, graph, points: points_of_edges(graph), ends: free_ends(graph) }
    }

    /// Pairs of ends that face each other over at most `reach` pixels of paper, each end in one pair: the best first.
    fn links(&self, reach: f64) -> Vec<Link> {
        let index = index_of(&self.ends, 0..self.ends.len());
        let mut candidates = Vec::new();
        for (a, end) in self.ends.iter().enumerate() {
            let Some(end) = end else { continue };
            let radius = reach + WIDTHS * end.width.max(self.image.line_width);
            let near = index.near(end.point, radius).filter(|&b| b > a);
            candidates.extend(near.filter_map(|b| self.link(a, b)).filter(|l| l.paper <= reach));
        }
        candidates.sort_by(|x, y| (x.paper + x.misfit).total_cmp(&(y.paper + y.misfit)).then(x.ends.cmp(&y.ends)));
        retain_first(&mut candidates, self.ends.len(), |link| link.ends);
        candidates
    }

    /// The gap between two ends, if each lies on the other's course.
    fn link(&self, i: usize, j: usize) -> Option<Link> {
        let (a, b) = (self.ends[i].as_ref()?, self.ends[j].as_ref()?);
        let (width, distance) = (0.5 * (a.width + b.width), (b.point - a.point).hypot());
        if a.width.max(b.width) > WIDTHS * a.width.min(b.width) || distance < 1e-6 {
            return None;
        }
        let misfit = facing(self.graph, &self.ends, [i, j])?;
        let link = Link { ends: [i, j], paper: (distance - width).max(0.0), misfit };
        self.is_paper(a, b).then_some(link)
    }

    /// Whether there is nothing but paper between two ends.
    fn is_paper(&self, a: &FreeEnd, b: &FreeEnd) -> bool {
        let gap = Line::new(a.point, b.point);
        let inked = (1..8).filter(|k| self.image.ink.sample(gap.eval(f64::from(*k) / 8.0)) > 0.6).count();
        let reach = 0.5 * gap.length() + self.image.line_width;
        let middle = gap.midpoint();
        let own = |e| [a.node, b.node].iter().any(|&n| self.graph.graph.edges(n).any(|edge| edge.id() == e));
        let mut near = self.points.locate_within_distance([middle.x, middle.y], reach * reach);
        let blocked = near.any(|p| {
            let place = Point::new(p.geom()[0], p.geom()[1]);
            !own(p.data) && gap.nearest(place, 1e-6).distance_sq < (0.75 * self.image.line_width).powi(2)
        });
        inked < 7 && !blocked
    }

    /// Whether a gap is short beside the strokes that it parts.
    fn is_short(&self, link: &Link) -> bool {
        let length = |end: usize| self.ends[end].as_ref().map_or(0.0, |e| e.length);
        link.ends.iter().all(|&end| length(end) > 1.5 * link.paper.max(self.image.line_width))
    }

    /// The paper that is bridged where a link lies, in pixels.
    fn bridged(&self, link: &Link, gap: Option<f64>) -> f64 {
        let ends = link.ends.iter().filter_map(|&end| self.ends[end].as_ref());
        let grain = ends.map(|end| self.image.noise.at(end.point).grain()).fold(0.0, f64::max);
        gap.unwrap_or(UNSURE_GAP * grain) * self.image.line_width
    }

    /// Chains of dashes with their links, and the links that are between none. Long and short dashes in turns, as a centre
    /// line has them, have no pattern that they could be joined in.
    fn dashes(&self, links: &[Link]) -> (Vec<Dashed>, Vec<Link>) {
        let partner = partners(self.ends.len(), links);
        let mut dashed = Vec::new();
        let mut is_dashed = vec![false; self.ends.len()];
        for chain in chains(self.ends.len() / 2, &partner) {
            let exits = chain.iter().filter_map(|&(stroke, backwards)| partner[2 * stroke + usize::from(!backwards)]);
            let of_chain: Vec<Link> = exits.map(|(_, link)| links[link]).collect();
            let row = self.row(&chain, &of_chain);
            let pattern = row.pattern();
            if pattern.is_some() || row.alternates() {
                of_chain.iter().for_each(|l| l.ends.iter().for_each(|&e| is_dashed[e] = true));
                dashed.push((of_chain, pattern));
            }
        }
        (dashed, links.iter().filter(|l| !is_dashed[l.ends[0]]).copied().collect())
    }

    /// How long the strokes of a chain are, and how far apart.
    fn row(&self, chain: &[(usize, bool)], links: &[Link]) -> Row {
        let lengths = chain.iter().map(|&(t, _)| length(self.graph, &self.graph.trails[t])).collect();
        let distance = |link: &Link| {
            let [a, b] = link.ends.map(|e| self.ends[e].as_ref().map_or(Point::ZERO, |e| e.point));
            (b - a).hypot()
        };
        Row { lengths, gaps: links.iter().map(distance).collect() }
    }
}

/// The lengths of strokes in a row and of the gaps after them, in pixels; a closed row has a gap after the last.
struct Row {
    lengths: Vec<f64>,
    gaps: Vec<f64>,
}

impl Row {
    fn is_closed(&self) -> bool {
        self.gaps.len() == self.lengths.len()
    }

    /// The even pattern of the row; `None` where it is not even.
    fn pattern(&self) -> Option<Dashes> {
        let Self { lengths, gaps } = self;
        let n = lengths.len();
        if n < FEWEST_DASHES {
            return None;
        }
        let inner = if self.is_closed() { &lengths[..] } else { &lengths[1..n - 1] };
        let (dash, gap) = (median(inner), median(gaps));
        // The pattern may begin and end within a dash.
        let whole = lengths[0].max(lengths[n - 1]) <= dash + unevenness(dash);
        if !is_even(inner) || !is_even(gaps) || !whole || dash > LONGEST_DASH * gap {
            return None;
        }
        let to_ends: f64 = lengths[1..n - 1].iter().chain(&gaps[..n - 2]).sum();
        let period = if self.is_closed() {
            (lengths.iter().sum::<f64>() + gaps.iter().sum::<f64>()) / n as f64
        } else {
            to_ends / (n - 2) as f64
        };
        let dash = dash.min(0.95 * period);
        let offset = if self.is_closed() || (dash - lengths[0]) < UNEVEN_PIXELS { 0.0 } else { dash - lengths[0] };
        Some(Dashes { dash, gap: period - dash, offset })
    }

    /// Whether every second stroke of an open row is of one length and the others of another, the first and the last
    /// perhaps cut short.
    fn alternates(&self) -> bool {
        let n = self.lengths.len();
        if n < FEWEST_ALTERNATING || self.is_closed() {
            return false;
        }
        let every_second = |first: usize| self.lengths[first..n - 1].iter().step_by(2).copied().collect::<Vec<f64>>();
        let (odd, even) = (every_second(1), every_second(2));
        let of = |k: usize| median(if k % 2 == 1 { &odd } else { &even });
        let whole = [0, n - 1].into_iter().all(|k| self.lengths[k] <= of(k) + unevenness(of(k)));
        is_even(&odd)
            && is_even(&even)
            && is_even(&self.gaps)
            && whole
            && of(1).max(of(2)) <= LONGEST_DASH * median(&self.gaps)
    }
}

/// How far lengths of a typical length may be from it.
fn unevenness(typical: f64) -> f64 {
    UNEVEN * typical + UNEVEN_PIXELS
}

fn is_even(values: &[f64]) -> bool {
    let middle = median(values);
    values.iter().all(|v| (v - middle).abs() <= unevenness(middle))
}

/// The ends of all strokes, two for each: where it starts and where it ends; `None` where that is not in the open.
pub(super) fn free_ends(graph: &StrokeGraph) -> Vec<Option<FreeEnd>> {
    graph.trails.iter().flat_map(|trail| [0, 1].map(|side| free_end(graph, trail, side))).collect()
}

/// Some of the ends, findable by place.
pub(super) fn index_of(ends: &[Option<FreeEnd>], some: impl Iterator<Item = usize>) -> PointIndex {
    PointIndex::new(some.filter_map(|i| Some((i, ends[i].as_ref()?.point))))
}

/// Keeps of pairs of ends, of which there are `count`, those whose ends are in none before them.
pub(super) fn retain_first<T>(pairs: &mut Vec<T>, count: usize, ends: impl Fn(&T) -> [usize; 2]) {
    let mut taken = vec![false; count];
    pairs.retain(|pair| {
        let free = ends(pair).iter().all(|&end| !taken[end]);
        if free {
            ends(pair).into_iter().for_each(|end| taken[end] = true);
        }
        free
    });
}

/// How far two ends lie beside each other's course, if they agree: one line of one pen with a gap.
pub(super) fn facing(graph: &StrokeGraph, ends: &[Option<FreeEnd>], [i, j]: [usize; 2]) -> Option<f64> {
    let (a, b) = (ends[i].as_ref()?, ends[j].as_ref()?);
    let distance = (b.point - a.point).hypot();
    // The two ends of one stroke close it only when it is far longer than the gap.
    let closes = i / 2 == j / 2 && a.length < 4.0 * distance;
    if closes || graph.trails[i / 2].color != graph.trails[j / 2].color {
        return None;
    }
    let beside = |from: &FreeEnd, to: &FreeEnd| {
        let d = to.point - from.point;
        let s = d.dot(from.course.heading);
        let off = d.dot(from.course.heading.turn_90()) - 0.5 * from.course.curvature * s * s;
        (s > 0.0).then_some(off.abs())
    };
    let misfit = beside(a, b)?.max(beside(b, a)?);
    // Both head into the gap, so the second curves the other way.
    let bend = 0.5 * (a.course.curvature - b.course.curvature) * distance;
    let turn = angle_between(a.course.heading, -b.course.heading) - bend;
    (misfit <= BESIDE * graph.page.line_width + BESIDE_SHARE * distance && turn.abs() <= TURN).then_some(misfit)
}

/// The end of a stroke at its start (0) or its last point (1), where it is in the open.
fn free_end(graph: &StrokeGraph, trail: &Trail, side: usize) -> Option<FreeEnd> {
    if trail.closed {
        return None;
    }
    let &(edge, reversed) = if side == 0 { trail.edges.first()? } else { trail.edges.last()? };
    let at_source = (side == 0) != reversed;
    let (source, target) = graph.graph.edge_endpoints(edge)?;
    let node = if at_source { source } else { target };
    if graph.graph[node].kind != JunctionKind::FreeEnd {
        return None;
    }
    let finite: Vec<f64> = graph.graph[edge].widths.iter().copied().filter(|w| w.is_finite()).collect();
    let width = if finite.is_empty() { graph.page.line_width } else { median(&finite) };
    let point = graph.graph[node].position;
    let course = course(graph, edge, at_source)?;
    let length = length(graph, trail);
    let (aim, course) = if length < SHORT * width && trail.edges.len() == 1 {
        // Of a dash, the chord says most.
        let chord = point - graph.graph[if at_source { target } else { source }].position;
        (point, Tail { heading: chord / chord.hypot().max(1e-9), curvature: 0.0, ..course })
    } else {
        // The course was measured a little before the end.
        let (aim, heading) = arm_line(&course, point, graph.page.line_width);
        (aim, Tail { heading, ..course })
    };
    Some(FreeEnd { node, point, aim, course, width, length })
}

fn length(graph: &StrokeGraph, trail: &Trail) -> f64 {
    let of_edge = |e: EdgeIndex| graph.graph[e].points.windows(2).map(|w: &[Point]| (w[1] - w[0]).hypot()).sum::<f64>();
    trail.edges.iter().map(|&(e, _)| of_edge(e)).sum()
}

fn median(values: &[f64]) -> f64 {
    let mut values = values.to_vec();
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// For each end the other end of its gap, and the number of the link.
fn partners(count: usize, links: &[Link]) -> Vec<Option<(usize, usize)>> {
    let mut partner = vec![None; count];
    for (k, link) in links.iter().enumerate() {
        let [a, b] = link.ends;
        (partner[a], partner[b]) = (Some((b, k)), Some((a, k)));
    }
    partner
}

/// Strokes in chains over their gaps; `true` walks a stroke backwards.
pub(super) fn chains(strokes: usize, partner: &[Option<(usize, usize)>]) -> Vec<Vec<(usize, bool)>> {
    let mut used = vec![false; strokes];
    let open = (0..partner.len()).filter(|&e| partner[e].is_none());
    let mut chains = Vec::new();
    for start in open.chain(0..partner.len()) {
        let (mut chain, mut entry) = (Vec::new(), Some(start));
        while let Some(end) = entry.filter(|e| !used[e / 2]) {
            used[end / 2] = true;
            chain.push((end / 2, end % 2 == 1));
            entry = partner[end ^ 1].map(|(other, _)| other);
        }
        if !chain.is_empty() {
            chains.push(chain);
        }
    }
    chains
}

/// Joins strokes over gaps: an edge leads over each, and the strokes become one.
fn join_trails(graph: &mut StrokeGraph, ends: &[Option<FreeEnd>], seams: &[(Link, Option<Dashes>)]) {
    if seams.is_empty() {
        return;
    }
    let links: Vec<Link> = seams.iter().map(|s| s.0).collect();
    let partner = partners(ends.len(), &links);
    let trails = std::mem::take(&mut graph.trails);
    for chain in chains(trails.len(), &partner) {
        let mut joined = Trail { edges: Vec::new(), ..trails[chain[0].0].clone() };
        for &(stroke, backwards) in &chain {
            joined.append(&trails[stroke], backwards);
            let exit = 2 * stroke + usize::from(!backwards);
            let Some((entry, link)) = partner[exit] else { continue };
            let (Some(from), Some(to)) = (&ends[exit], &ends[entry]) else { continue };
            for node in [from.node, to.node] {
                graph.graph[node].kind = JunctionKind::Gap;
                graph.graph[node].confidence =
                    (-(seams[link].0.misfit / (BESIDE * graph.page.line_width)).powi(2)).exp();
            }
            joined.edges.push((graph.graph.add_edge(from.node, to.node, over(from, to)), false));
            joined.dashes = joined.dashes.or(seams[link].1);
            joined.closed |= entry / 2 == chain[0].0;
        }
        graph.trails.push(joined);
    }
}

/// The edge over a gap: it leaves and arrives as the strokes do.
fn over(from: &FreeEnd, to: &FreeEnd) -> Edge {
    let distance = (to.point - from.point).hypot();
    let (a, b) = (from.course.heading * (distance / 3.0), to.course.heading * (distance / 3.0));
    let curve = CubicBez::new(from.point, from.point + a, to.point + b, to.point);
    let count = (distance / STEP).ceil().max(1.0) as usize;
    let mut points: Vec<Point> = (0..=count).map(|k| curve.eval(k as f64 / count as f64)).collect();
    (points[0], points[count]) = (from.point, to.point);
    Edge { widths: vec![f64::NAN; points.len()], points }
}
