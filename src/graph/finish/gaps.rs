//! Lines that go on behind a gap in their ink.
//!
//! Two free ends face one another when each lies on the other's course and the courses agree. A short gap between
//! them is bridged: a light pencil left it. Many of them at even distances along one line are dashes, which are kept
//! as they are, or joined into one dashed stroke where that is asked for.

use super::confidence::{PointsOfEdges, points_of_edges};
use super::dashes::Row;
use super::ends::{BESIDE, FreeEnd, chains, facing, free_ends, index_of, length, retain_first};
use crate::clean::LineImage;
use crate::drawing::Dashes;
use crate::graph::{Edge, JunctionKind, StrokeGraph, Trail};
use crate::options::{Dashing, Options};
use crate::streamline::STEP;
use kurbo::{CubicBez, Line, ParamCurve, ParamCurveNearest, Point};
use petgraph::visit::EdgeRef;

/// The gap that is bridged in unsure ink, in line widths, when nothing else is asked for. In sure ink every gap was meant.
const UNSURE_GAP: f64 = 1.5;
/// Between dashes there is at most so much paper, in line widths.
const DASH_GAP: f64 = 8.0;
/// Widths differ by less than this factor.
const WIDTHS: f64 = 1.6;
/// Ink, as a share of full ink; a gap that is ink all along is none.
const INKED: f32 = 0.6;
/// A line nearer to a gap than this, in line widths, lies in it.
const BLOCKED: f64 = 0.75;
/// A gap is short beside strokes that are longer than this many times as long.
const SHORT_GAP: f64 = 1.5;

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
        let inked = (1..8).filter(|k| self.image.ink.sample(gap.eval(f64::from(*k) / 8.0)) > INKED).count();
        let reach = 0.5 * gap.length() + self.image.line_width;
        let middle = gap.midpoint();
        let own = |e| [a.node, b.node].iter().any(|&n| self.graph.graph.edges(n).any(|edge| edge.id() == e));
        let mut near = self.points.locate_within_distance([middle.x, middle.y], reach * reach);
        let blocked = near.any(|p| {
            let place = Point::new(p.geom()[0], p.geom()[1]);
            !own(p.data) && gap.nearest(place, 1e-6).distance_sq < (BLOCKED * self.image.line_width).powi(2)
        });
        inked < 7 && !blocked
    }

    /// Whether a gap is short beside the strokes that it parts.
    fn is_short(&self, link: &Link) -> bool {
        let length = |end: usize| self.ends[end].as_ref().map_or(0.0, |e| e.length);
        link.ends.iter().all(|&end| length(end) > SHORT_GAP * link.paper.max(self.image.line_width))
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

/// For each end the other end of its gap, and the number of the link.
fn partners(count: usize, links: &[Link]) -> Vec<Option<(usize, usize)>> {
    let mut partner = vec![None; count];
    for (k, link) in links.iter().enumerate() {
        let [a, b] = link.ends;
        (partner[a], partner[b]) = (Some((b, k)), Some((a, k)));
    }
    partner
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
    Edge { widths: vec![f64::NAN; points.len()], points, noise: 0.0 }
}
