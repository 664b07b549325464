//! Which pen drew what, on a page in colour.
//!
//! Colours are read in the middle of lines, where they are single, and grouped into few pens. A pen's colour is that of
//! its full ink: an edge, a blur or a line thinner than a pixel shows less of it. Lines are cut where their colour changes
//! for good, and strokes end there.

use super::lines::{Line, Place};
use super::{Dot, StrokeGraph, Trail};
use crate::clean::{JOINING, LineImage, profile_at, unblurred_width};
use crate::drawing::{Color, Fill};
use crate::raster::Raster;
use crate::streamline::STEP;
use kurbo::{Point, Shape, Vec2};
use petgraph::stable_graph::EdgeIndex;
use std::collections::{BTreeMap, BTreeSet};

/// Colours nearer than this are of one pen; lightness counts less, for pressure changes it.
const APART: f64 = 0.12;
const LIGHTNESS: f64 = 0.4;
/// Less chroma than this in Oklab is grey: what rounding leaves of it.
const GREY: f64 = 0.02;
/// Ink is full in the middle of a line of at least so many pixels of the scan that still has this share of its middle's ink
/// a quarter of its width beside it, or no more than this a pixel beyond its edge: no blur thins that.
const WIDE: f64 = 2.5;
const FLAT: f32 = 0.9;
const SHARP: f32 = 0.05;
/// Lines too thin for full ink have been black if they ever show this much.
const THIN_BLACK: f64 = 0.5;
/// Blur leaves at least this share of the ink of what passes for a line.
const LEAST_LEFT: f64 = 0.35;
/// Ink that lacks less than this of black is black: what rounding and compression take, or so many times what the ink
/// of its lines varies by.
const NEARLY: f64 = 0.03;
const GRAINS: f64 = 1.5;
/// Where the mean grain of a line is over this share, its colour is in part that of grain.
const UNSURE: f64 = 0.1;
/// Colours are first gathered in cells of this size.
const CELL: f64 = 0.02;
/// A pen draws at least this many line widths.
const LEAST_LENGTH: f64 = 4.0;
/// A line's colour has changed when it keeps the new one for this many line widths.
const LASTING: f64 = 3.0;
/// Every so many points of a line one colour is taken into account.
const STRIDE: usize = 4;

/// A colour along a line.
#[derive(Clone, Copy)]
struct Reading {
    color: Color,
    /// Whether it is that of full ink.
    full: bool,
    /// The length of line that it stands for, in pixels.
    length: f64,
}

/// The pens of a page.
pub(super) struct Pens<'a> {
    image: &'a LineImage,
    colors: &'a Raster<[u8; 3]>,
    /// The pens' colours; the first is that of most grey ink.
    pens: Vec<Color>,
}

impl<'a> Pens<'a> {
    /// The pens of a page; `None` when nothing is known of its colours.
    pub fn of(image: &'a LineImage, lines: &[Line], dots: &[Dot]) -> Option<Self> {
        let colors = image.colors.as_ref()?;
        let mut pens = Self { image, colors, pens: Vec::new() };
        let of_lines = lines.iter().flat_map(|line| pens.along(&line.points, &line.widths).into_iter().flatten());
        let of_dots = dots.iter().filter_map(|dot| pens.of_centre(dot));
        let mut readings: Vec<Reading> = of_lines.step_by(STRIDE).chain(of_dots).collect();
        for fill in &image.solids {
            let length = fill.outline.perimeter(1.0) / (STRIDE as f64 * STEP);
            readings.extend(pens.inside(fill).map(|color| Reading { color, full: true, length }));
        }
        pens.pens = cluster(&readings, LEAST_LENGTH * image.line_width / STRIDE as f64);
        pens.pens[0] = pens.steeped(pens.pens[0]);
        Some(pens)
    }

    /// Whether the colour of what lies at some points is in part that of grain.
    fn is_unsure(&self, points: &[Point]) -> bool {
        let grain = points.iter().map(|&p| self.image.noise.at(p).grain()).sum::<f64>();
        grain > UNSURE * points.len() as f64
    }

    /// Black for what hardly differs from it.
    fn steeped(&self, grey: Color) -> Color {
        let lacking = f64::from(grey.0.into_iter().max().unwrap_or(0)) / 255.0;
        if lacking < NEARLY.max(GRAINS * self.image.noise.mean().along) { Color::BLACK } else { grey }
    }

    /// The colour at each point of a line; `None` where the line is not alone. On a scan, the mean of what is near, so that
    /// grain does not count.
    fn along(&self, points: &[Point], widths: &[f64]) -> Vec<Option<Reading>> {
        let mut sorted: Vec<f64> = widths.iter().copied().filter(|width| width.is_finite()).collect();
        sorted.sort_by(f64::total_cmp);
        let Some(&typical) = sorted.get(sorted.len() / 2) else { return vec![None; points.len()] };
        let heading = |k: usize| points[(k + 1).min(points.len() - 1)] - points[k.saturating_sub(1)];
        let is_unsure = self.is_unsure(points);
        let at = |k: usize| {
            let reading = if is_unsure {
                self.unsure_reading(points[k], typical, STEP)
            } else {
                self.reading(points[k], heading(k), widths[k], STEP)
            };
            reading.filter(|_| widths[k].is_finite())
        };
        let readings: Vec<Option<Reading>> = (0..points.len()).map(at).collect();
        let lasting = 0.5 * LASTING * self.image.line_width / STEP;
        let mean = |k: usize| {
            let reach = if is_unsure { lasting as usize } else { 0 };
            let near = &readings[k.saturating_sub(reach)..(k + reach + 1).min(readings.len())];
            Reading { color: mean(near.iter().flatten().map(|reading| reading.color)), ..readings[k]? }.into()
        };
        (0..points.len()).map(mean).collect()
    }

    /// The colour of unsure ink at a place of a line of a width.
    fn unsure_reading(&self, p: Point, width: f64, length: f64) -> Option<Reading> {
        let color = self.color_among([p].into_iter())?;
        // What grey lines lack of black on paper is pressure, and paper between the grains.
        let color = Some(self.unblurred(color, width)).filter(|color| !is_grey(*color)).unwrap_or(Color::BLACK);
        Some(Reading { color, full: true, length })
    }

    /// The colour of the ink at a place of a line of a heading and a width.
    fn reading(&self, p: Point, heading: Vec2, width: f64, length: f64) -> Option<Reading> {
        let image = self.image;
        let normal = if heading.hypot2() > 0.0 { heading.normalize().turn_90() } else { Vec2::new(1.0, 0.0) };
        // Along the line the next pixel may be of another ink, across it is not.
        let color = self.color_among([-1.0, 0.0, 1.0].map(|k| p + normal * (k * image.page_scale)).into_iter())?;
        let beside = |offset: f64| [-offset, offset].map(|offset| image.ink.sample(p + normal * offset));
        let [inner, outer] = [beside(0.25 * width), beside(0.5 * width + image.page_scale)];
        let middle = image.ink.sample(p);
        let shows_all = inner[0].min(inner[1]) >= FLAT * middle || outer[0].min(outer[1]) <= SHARP * middle;
        Some(Reading { color, full: shows_all && width >= WIDE * image.page_scale, length })
    }

    /// The colour that the middle of a line of a width had before it was blurred.
    fn unblurred(&self, color: Color, width: f64) -> Color {
        // Of the blur, what the ink was smoothed by is not in the colours.
        let smoothing = JOINING * self.image.page_scale;
        let blur = (self.image.blur.powi(2) - smoothing.powi(2)).max(0.0).sqrt();
        if blur <= 0.0 {
            return color;
        }
        let left = profile_at(0.0, unblurred_width(width, self.image.blur), blur).max(LEAST_LEFT);
        Color(color.0.map(|v| (255.0 - f64::from(255 - v) / left).round() as u8))
    }

    /// The colour of the pixel with the most ink among those at some places.
    fn color_among(&self, places: impl Iterator<Item = Point>) -> Option<Color> {
        let pixel = |v: f64| (v / self.image.page_scale).floor() as i64;
        let pixels = places.filter_map(|p| self.colors.get(pixel(p.x), pixel(p.y)));
        pixels.min_by_key(|rgb| rgb.iter().min().copied()).map(Color)
    }

    /// The colour of a solid region at a place: of the pixel around it with the most ink, or, so that grain does not count,
    /// of its own on a scan.
    fn color_at(&self, p: Point) -> Option<Color> {
        let steps = if self.is_unsure(&[p]) { 0..=0 } else { -1..=1 };
        let step = |x: i32, y: i32| Vec2::new(x.into(), y.into()) * self.image.page_scale;
        self.color_among(steps.clone().flat_map(|y| steps.clone().map(move |x| p + step(x, y))))
    }

    /// The middle of the colours inside a solid region.
    fn inside(&self, fill: &Fill) -> Option<Color> {
        const GRID: usize = 12;
        let bounds = fill.outline.bounding_box();
        let cell = |k: usize| (k as f64 + 0.5) / GRID as f64;
        let grid = (0..GRID * GRID).map(|k| {
            Point::new(bounds.x0 + cell(k % GRID) * bounds.width(), bounds.y0 + cell(k / GRID) * bounds.height())
        });
        let inside = grid.filter(|p| fill.outline.winding(*p) % 2 != 0 && self.image.solid.at(*p) == Some(true));
        let colors = |points: &mut dyn Iterator<Item = Point>| -> Vec<(Color, f64)> {
            points.filter_map(|p| self.color_at(p)).map(|color| (color, 1.0)).collect()
        };
        // A sliver may lie between the points of the grid, but not beside its own outline.
        median(colors(&mut { inside }))
            .or_else(|| median(colors(&mut fill.outline.elements().iter().filter_map(|el| el.end_point()))))
    }

    /// The colour of a solid region: its own, unless it is nearly a pen's.
    fn of_fill(&self, color: Color) -> Color {
        let pen = self.pens[self.pen(color)];
        if distance(place(color), place(pen)) < 0.5 * APART { pen } else { self.steeped(color) }
    }

    /// The number of the pen nearest to a colour.
    fn pen(&self, color: Color) -> usize {
        nearest(color, &self.pens)
    }

    /// The pen of each point of a line, steadied: what does not last is taken for the colour around it. `None` where
    /// the line is not alone.
    fn of_points(&self, points: &[Point], widths: &[f64]) -> Vec<Option<usize>> {
        let readings = self.along(points, widths);
        let grey = |reading: &Reading| is_grey(reading.color);
        let greys = || readings.iter().flatten().filter(|reading| grey(reading));
        // Of greys only full ink tells the pen; where there is none, the line has one pen, by its strongest ink.
        let of_thin = if greys().any(|reading| reading.full) { None } else { strongest(greys().copied().collect()) };
        let of_thin = of_thin.map(|color| self.pen(color));
        let pen = |reading: Reading| {
            if reading.full || !grey(&reading) { Some(self.pen(reading.color)) } else { of_thin }
        };
        let pens: Vec<Option<usize>> = readings.iter().map(|reading| reading.and_then(pen)).collect();
        let measured: Vec<usize> = (0..pens.len()).filter(|&k| pens[k].is_some()).collect();
        let least = ((LASTING * self.image.line_width / STEP) as usize).max(2);
        let most = self.majority(measured.iter().filter_map(|&k| pens[k]));
        let mut current = most;
        let mut steady = pens.clone();
        for run in measured.chunk_by(|&a, &b| pens[a] == pens[b]) {
            if run.len() >= least {
                current = pens[run[0]];
            }
            run.iter().for_each(|&k| steady[k] = current);
        }
        steady
    }

    fn majority(&self, pens: impl Iterator<Item = usize>) -> Option<usize> {
        let mut counts = vec![0usize; self.pens.len()];
        pens.for_each(|pen| counts[pen] += 1);
        let best = (0..counts.len()).max_by_key(|&pen| (counts[pen], usize::MAX - pen))?;
        (counts[best] > 0).then_some(best)
    }

    /// The places at which the colour of a line changes for good.
    pub fn changes(&self, lines: &[Line]) -> Vec<Place> {
        let mut places = Vec::new();
        for (i, line) in lines.iter().enumerate() {
            let pens = self.of_points(&line.points, &line.widths);
            let measured: Vec<usize> = (0..pens.len()).filter(|&k| pens[k].is_some()).collect();
            let changed = measured.windows(2).filter(|pair| pens[pair[0]] != pens[pair[1]]);
            let before = places.len();
            places.extend(changed.map(|pair| Place { line: i, at: 0.5 * (pair[0] + pair[1]) as f64 }));
            if let (true, Some(&first), Some(&last)) = (line.closed, measured.first(), measured.last())
                && (pens[first] != pens[last] || places.len() > before)
            {
                places.push(Place { line: i, at: 0.0 });
            }
        }
        places
    }

    fn of_centre(&self, dot: &Dot) -> Option<Reading> {
        let Dot { centre, diameter, .. } = *dot;
        if self.is_unsure(&[centre]) {
            return self.unsure_reading(centre, diameter, diameter);
        }
        self.reading(centre, Vec2::ZERO, diameter, diameter)
    }

    /// The colour of a dot.
    fn of_dot(&self, dot: &Dot) -> Color {
        self.of_centre(dot).map_or(Color::BLACK, |reading| self.pens[self.pen(reading.color)])
    }

    /// Gives dots, strokes and regions their pens' colours; strokes are split where edges of two pens follow one another.
    /// Returns how many strokes are in colour.
    pub fn paint(&self, graph: &mut StrokeGraph) -> usize {
        for dot in &mut graph.dots {
            dot.color = self.of_dot(dot);
        }
        for fill in &mut graph.fills {
            fill.color = self.inside(fill).map_or(Color::BLACK, |color| self.of_fill(color));
        }
        let pens: BTreeMap<EdgeIndex, Option<usize>> = graph
            .graph
            .edge_indices()
            .map(|e| {
                let edge = &graph.graph[e];
                (e, self.majority(self.of_points(&edge.points, &edge.widths).into_iter().flatten()))
            })
            .collect();
        let trails = std::mem::take(&mut graph.trails);
        graph.trails = trails.into_iter().flat_map(|trail| self.split(trail, &pens)).collect();
        graph.trails.iter().filter(|trail| trail.color != Color::BLACK).count()
    }

    /// A trail as one for each run of edges of one pen; an edge of no colour of its own goes with the one before it.
    fn split(&self, mut trail: Trail, pens: &BTreeMap<EdgeIndex, Option<usize>>) -> Vec<Trail> {
        let own = |edge: &(EdgeIndex, bool)| pens.get(&edge.0).copied().flatten();
        let first = trail.edges.iter().find_map(own).unwrap_or(0);
        let mut current = first;
        let mut of_edges: Vec<usize> = Vec::with_capacity(trail.edges.len());
        for edge in &trail.edges {
            current = own(edge).unwrap_or(current);
            of_edges.push(current);
        }
        if of_edges.iter().all(|&pen| pen == first) {
            trail.color = self.pens[first];
            return vec![trail];
        }
        if trail.closed {
            // A closed trail of two colours is open lines from one change to the next.
            let n = of_edges.len();
            let start = (0..n).find(|&k| of_edges[k] != of_edges[(k + n - 1) % n]).unwrap_or(0);
            trail.edges.rotate_left(start);
            of_edges.rotate_left(start);
        }
        let indices: Vec<usize> = (0..of_edges.len()).collect();
        let runs = indices.chunk_by(|&a, &b| of_edges[a] == of_edges[b]);
        runs.map(|run| Trail {
            edges: run.iter().map(|&k| trail.edges[k]).collect(),
            closed: false,
            color: self.pens[of_edges[run[0]]],
            dashes: None,
        })
        .collect()
    }
}

/// Gives lines the pens of broader ones, which show their full ink, where those are nearly theirs.
pub(super) fn share(graph: &mut StrokeGraph, broader: &StrokeGraph) {
    let pens: BTreeSet<Color> = broader.trails.iter().map(|trail| trail.color).collect();
    let shared = |color: &mut Color| {
        let like = pens.iter().filter(|pen| is_grey(**pen) == is_grey(*color));
        let apart = |pen: &Color| distance(place(*pen), place(*color));
        let nearest = like.min_by(|a, b| apart(a).total_cmp(&apart(b))).filter(|pen| apart(pen) < APART);
        *color = nearest.copied().unwrap_or(*color);
    };
    graph.trails.iter_mut().map(|trail| &mut trail.color).for_each(shared);
    graph.dots.iter_mut().map(|dot| &mut dot.color).for_each(shared);
}

/// Few colours that stand for many: greys, then the others, the most used first; black where there is no grey.
///
/// Agglomeration: cells of the colour space are merged, the nearest two first, up to [`APART`]. What stays below
/// `least` in length is no pen of its own. Only where it is full does ink tell greys apart: less of black is grey as well.
fn cluster(readings: &[Reading], least: f64) -> Vec<Color> {
    let (greys, colors): (Vec<Reading>, Vec<Reading>) = readings.iter().partition(|reading| is_grey(reading.color));
    let (full, thin): (Vec<Reading>, Vec<Reading>) = greys.into_iter().partition(|reading| reading.full);
    let mut pens = clusters(&full, least);
    let darkest = pens.iter().map(|pen| place(*pen)[0]).fold(f64::INFINITY, f64::min);
    if let Some(grey) = strongest(thin).filter(|grey| place(*grey)[0] < darkest - APART) {
        let ink = 1.0 - f64::from(grey.0[0]) / 255.0;
        pens.push(if ink > THIN_BLACK { Color::BLACK } else { grey });
    }
    if pens.is_empty() {
        pens.push(Color::BLACK);
    }
    pens.extend(clusters(&colors, least));
    pens
}

fn clusters(readings: &[Reading], least: f64) -> Vec<Color> {
    let mut cells: BTreeMap<[i64; 3], Vec<Reading>> = BTreeMap::new();
    for &reading in readings {
        cells.entry(place(reading.color).map(|v| (v / CELL).floor() as i64)).or_default().push(reading);
    }
    let mut clusters: Vec<Vec<Reading>> = cells.into_values().collect();
    let mut centres: Vec<[f64; 3]> = clusters.iter().map(|c| centre(c)).collect();
    loop {
        let pairs = (0..centres.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
        let nearest = pairs
            .map(|(i, j)| (distance(centres[i], centres[j]), i, j))
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .filter(|&(d, ..)| d < APART);
        let Some((_, i, j)) = nearest else { break };
        let other = clusters.swap_remove(i);
        centres.swap_remove(i);
        clusters[j].extend(other);
        centres[j] = centre(&clusters[j]);
    }
    clusters.retain(|c| length(c) >= least);
    clusters.sort_by(|a, b| length(b).total_cmp(&length(a)));
    clusters.into_iter().filter_map(|cluster| full_ink(cluster, least)).collect()
}

/// The colour of full ink: the median of where it is seen, or else the strongest ink. What shows it for less than `least` in
/// length is where thin lines meet, and their inks mix.
fn full_ink(readings: Vec<Reading>, least: f64) -> Option<Color> {
    let full: Vec<Reading> = readings.iter().filter(|reading| reading.full).copied().collect();
    if length(&full) < least {
        return strongest(readings);
    }
    median(full.into_iter().map(|reading| (reading.color, reading.length)).collect())
}

/// The colour of lines that are too thin to show full ink: the median of the stronger half.
fn strongest(mut readings: Vec<Reading>) -> Option<Color> {
    readings.sort_by_key(|reading| reading.color.0.iter().map(|&v| u32::from(v)).sum::<u32>());
    readings.truncate(readings.len().div_ceil(2));
    median(readings.into_iter().map(|reading| (reading.color, reading.length)).collect())
}

fn length(readings: &[Reading]) -> f64 {
    readings.iter().map(|reading| reading.length).sum()
}

/// The pen nearest to a colour, among greys or among the others if it has any.
fn nearest(color: Color, pens: &[Color]) -> usize {
    let apart = |pen: usize| distance(place(color), place(pens[pen]));
    let like = (0..pens.len()).filter(|&pen| is_grey(pens[pen]) == is_grey(color));
    like.min_by(|&a, &b| apart(a).total_cmp(&apart(b))).unwrap_or(0)
}

fn is_grey(color: Color) -> bool {
    let [_, a, b] = color.oklab();
    a.hypot(b) < GREY
}

/// A colour's place in the space in which pens are told apart.
fn place(color: Color) -> [f64; 3] {
    let [l, a, b] = color.oklab();
    [LIGHTNESS * l, a, b]
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}

fn centre(readings: &[Reading]) -> [f64; 3] {
    let total = length(readings);
    [0, 1, 2].map(|k| readings.iter().map(|r| r.length * place(r.color)[k]).sum::<f64>() / total)
}

fn mean(colors: impl Iterator<Item = Color>) -> Color {
    let (sum, count) = colors
        .fold(([0u32; 3], 0), |(sum, count), color| ([0, 1, 2].map(|c| sum[c] + u32::from(color.0[c])), count + 1));
    Color(sum.map(|channel| (channel / count.max(1)) as u8))
}

/// The weighted median of each channel.
fn median(samples: Vec<(Color, f64)>) -> Option<Color> {
    if samples.is_empty() {
        return None;
    }
    let half = 0.5 * samples.iter().map(|s| s.1).sum::<f64>();
    Some(Color([0, 1, 2].map(|channel| {
        let mut values: Vec<(u8, f64)> = samples.iter().map(|(color, w)| (color.0[channel], *w)).collect();
        values.sort_by_key(|v| v.0);
        let mut sum = 0.0;
        let middle = values.iter().find(|(_, w)| {
            sum += w;
            sum >= half
        });
        middle.map_or(0, |v| v.0)
    })))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn full(color: Color, length: f64) -> Reading {
        Reading { color, full: true, length }
    }

    #[test]
    fn many_shades_of_few_inks_are_few_pens() {
        let inks = [[210, 30, 30], [30, 60, 200], [20, 140, 60], [250, 230, 20], [160, 190, 250], [240, 130, 10]];
        let mut samples = Vec::new();
        for ink in inks {
            for k in 0..40u8 {
                // Pressure, and a little noise of each channel.
                let press = 0.85 + 0.15 * f64::from(k % 8) / 7.0;
                let noise = [k % 5, k % 3, k % 7];
                let channel = |c: usize| (255.0 - press * f64::from(255 - ink[c])) as u8;
                samples.push(full(Color([0, 1, 2].map(|c| channel(c).saturating_sub(noise[c]))), 1.0));
            }
        }
        samples.extend((0..40u8).map(|k| full(Color([40 + k, 42 + k, 45 + k]), 1.0)));
        let pens = cluster(&samples, 10.0);
        assert_eq!(pens.len(), 1 + inks.len(), "{pens:?}");
        for ink in inks {
            let pen = pens[nearest(Color(ink), &pens)];
            assert!(distance(place(pen), place(Color(ink))) < 0.05, "{ink:?} {pen:?}");
        }
        let mut reversed = samples;
        reversed.reverse();
        assert_eq!(cluster(&reversed, 10.0), pens);
    }

    #[test]
    fn a_stray_colour_is_no_pen() {
        let samples = [full(Color([200, 20, 20]), 100.0), full(Color([20, 20, 220]), 3.0)];
        assert_eq!(cluster(&samples, 10.0), [Color::BLACK, Color([200, 20, 20])]);
    }
}
