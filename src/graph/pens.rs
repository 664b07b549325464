//! Which pen drew what, on a page in colour.
//!
//! Colours are read in the middle of lines, where they are single, and grouped into few pens. Lines are cut where
//! their colour changes for good, and strokes end there.

use super::lines::{Line, Place};
use super::{Dot, StrokeGraph, Trail};
use crate::clean::LineImage;
use crate::drawing::{Color, Fill};
use crate::raster::Raster;
use crate::streamline::STEP;
use kurbo::{Point, Shape};
use petgraph::stable_graph::EdgeIndex;
use std::collections::BTreeMap;

/// Colours nearer than this are of one pen; lightness counts less, for pressure changes it.
const APART: f64 = 0.12;
const LIGHTNESS: f64 = 0.4;
/// Less chroma than this in Oklab is grey, and grey ink is one black pen.
const GREY: f64 = 0.045;
/// Colours are first gathered in cells of this size.
const CELL: f64 = 0.02;
/// A pen draws at least this many line widths.
const LEAST_LENGTH: f64 = 4.0;
/// A line's colour has changed when it keeps the new one for this many line widths.
const LASTING: f64 = 3.0;
/// Every so many points of a line one colour is taken into account.
const STRIDE: usize = 4;

/// The pens of a page.
pub(super) struct Pens<'a> {
    image: &'a LineImage,
    colors: &'a Raster<[u8; 3]>,
    /// The pens' colours; the first is black.
    pens: Vec<Color>,
}

impl<'a> Pens<'a> {
    /// The pens of a page; `None` when it is not in colour.
    pub fn of(image: &'a LineImage, lines: &[Line], dots: &[Dot]) -> Option<Self> {
        let colors = image.colors.as_ref()?;
        let mut pens = Self { image, colors, pens: Vec::new() };
        let of_lines = lines.iter().flat_map(|line| {
            let measured = (0..line.points.len()).filter(|&k| line.widths[k].is_finite()).step_by(STRIDE);
            measured.map(|k| (line.points[k], STRIDE as f64 * STEP))
        });
        let of_dots = dots.iter().map(|dot| (dot.centre, dot.diameter));
        let mut samples: Vec<(Color, f64)> =
            of_lines.chain(of_dots).filter_map(|(p, length)| Some((pens.color_at(p)?, length))).collect();
        for fill in &image.solids {
            let length = fill.outline.perimeter(1.0);
            samples.extend(pens.inside(fill).map(|color| (color, length)));
        }
        pens.pens = cluster(&samples, LEAST_LENGTH * image.line_width);
        Some(pens)
    }

    /// The colour of the ink at a place: that of the pixel around it with the most ink.
    fn color_at(&self, p: Point) -> Option<Color> {
        let (x, y) = ((p.x / self.image.scale).floor() as i64, (p.y / self.image.scale).floor() as i64);
        let around = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (x + dx, y + dy)));
        let pixels = around.filter_map(|(x, y)| self.colors.get(x, y));
        pixels.min_by_key(|rgb| rgb.iter().min().copied()).map(Color)
    }

    /// The middle of the colours inside a solid region.
    fn inside(&self, fill: &Fill) -> Option<Color> {
        const GRID: usize = 12;
        let bounds = fill.outline.bounding_box();
        let cell = |k: usize| (k as f64 + 0.5) / GRID as f64;
        let grid = (0..GRID * GRID).map(|k| {
            Point::new(bounds.x0 + cell(k % GRID) * bounds.width(), bounds.y0 + cell(k / GRID) * bounds.height())
        });
        let inside = grid.filter(|p| fill.outline.winding(*p) % 2 != 0 && self.image.ink.sample(*p) > 0.6);
        median(inside.filter_map(|p| self.color_at(p)).map(|color| (color, 1.0)).collect())
    }

    /// The number of the pen nearest to a colour.
    fn pen(&self, color: Color) -> usize {
        nearest(color, &self.pens)
    }

    /// The pen of each point of a line, steadied: what does not last is taken for the colour around it. `None` where
    /// the line is not alone.
    fn of_points(&self, points: &[Point], widths: &[f64]) -> Vec<Option<usize>> {
        let pens: Vec<Option<usize>> = points
            .iter()
            .zip(widths)
            .map(|(&p, w)| self.color_at(p).filter(|_| w.is_finite()).map(|c| self.pen(c)))
            .collect();
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

    /// The colour of a dot.
    fn of_dot(&self, dot: &Dot) -> Color {
        self.color_at(dot.centre).map_or(Color::BLACK, |color| self.pens[self.pen(color)])
    }

    /// Gives dots, strokes and regions their pens' colours; strokes are split where edges of two pens follow one another.
    /// Returns how many strokes are in colour.
    pub fn paint(&self, graph: &mut StrokeGraph) -> usize {
        for dot in &mut graph.dots {
            dot.color = self.of_dot(dot);
        }
        for fill in &mut graph.fills {
            fill.color = self.inside(fill).map_or(Color::BLACK, |color| self.pens[self.pen(color)]);
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

/// Few colours that stand for weighted samples: black for what is grey, then the others, the most used first.
///
/// Agglomeration: cells of the colour space are merged, the nearest two first, up to [`APART`]. What stays below
/// `least` in weight is no pen of its own.
fn cluster(samples: &[(Color, f64)], least: f64) -> Vec<Color> {
    let mut cells: BTreeMap<[i64; 3], Vec<(Color, f64)>> = BTreeMap::new();
    for &(color, weight) in samples.iter().filter(|(color, _)| !is_grey(*color)) {
        cells.entry(place(color).map(|v| (v / CELL).floor() as i64)).or_default().push((color, weight));
    }
    let mut clusters: Vec<Vec<(Color, f64)>> = cells.into_values().collect();
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
    let weight = |c: &[(Color, f64)]| c.iter().map(|s| s.1).sum::<f64>();
    clusters.retain(|c| weight(c) >= least);
    clusters.sort_by(|a, b| weight(b).total_cmp(&weight(a)));
    std::iter::once(Color::BLACK).chain(clusters.into_iter().filter_map(median)).collect()
}

/// The pen nearest to a colour; grey is the first pen's alone.
fn nearest(color: Color, pens: &[Color]) -> usize {
    if is_grey(color) {
        return 0;
    }
    let apart = |pen: usize| distance(place(color), place(pens[pen]));
    (1..pens.len()).min_by(|&a, &b| apart(a).total_cmp(&apart(b))).unwrap_or(0)
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

fn centre(samples: &[(Color, f64)]) -> [f64; 3] {
    let total: f64 = samples.iter().map(|s| s.1).sum();
    [0, 1, 2].map(|k| samples.iter().map(|&(color, w)| w * place(color)[k]).sum::<f64>() / total)
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
                samples.push((Color([0, 1, 2].map(|c| channel(c).saturating_sub(noise[c]))), 1.0));
            }
        }
        samples.extend((0..40u8).map(|k| (Color([40 + k, 42 + k, 45 + k]), 1.0)));
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
        let samples = [(Color([200, 20, 20]), 100.0), (Color([20, 20, 220]), 3.0)];
        assert_eq!(cluster(&samples, 10.0), [Color::BLACK, Color([200, 20, 20])]);
    }
}
