//! The lines of a drawing while they are repaired: one working set that owns them, their index and their ends.
//!
//! A pass asks first, of any line in parallel, and then edits. With an edit what was known of places and ends is
//! forgotten, and is found anew when somebody asks again.

mod course;
mod end;
mod index;
mod line;

pub(in crate::graph) use course::{LARGEST_DEPARTURE, LEAST_GAIN};
pub(in crate::graph) use course::{Lead, THIN, arm_line, bridge, continuation, course, departure};
pub(in crate::graph) use end::{End, end_id};
pub(in crate::graph) use index::Place;
pub use line::{EndState, Line};

use crate::clean::LineImage;
use index::Index;
use kurbo::{Line as Segment, Point, Vec2};
use std::ops::Deref;
use std::sync::OnceLock;

/// How much of a line around a place tells its width there, in points to either side: ten pixels.
const WIDTH_AROUND: usize = 20;

/// The lines of a drawing.
#[derive(Debug, Default)]
pub(in crate::graph) struct Lines {
    lines: Vec<Line>,
    index: OnceLock<Index>,
    ends: OnceLock<Vec<Option<End>>>,
}

impl Deref for Lines {
    type Target = [Line];

    fn deref(&self) -> &[Line] {
        &self.lines
    }
}

impl From<Vec<Line>> for Lines {
    fn from(lines: Vec<Line>) -> Self {
        Self { lines, ..Self::default() }
    }
}

/// What a pass asks.
impl Lines {
    /// The ends of all lines, by [`end_id`]; `None` for closed lines.
    pub fn ends(&self, image: &LineImage) -> &[Option<End>] {
        self.ends.get_or_init(|| end::ends(image, &self.lines))
    }

    /// Crossings of a short segment with all lines: place, point, fraction along the segment. In a stable order.
    pub fn crossings(&self, segment: Segment) -> Vec<(Place, Point, f64)> {
        self.index().crossings(&self.lines, segment)
    }

    /// The pieces of lines within `radius` of a point, each by its place nearest to the point, that place's point and its
    /// distance. The nearest first.
    pub fn near(&self, p: Point, radius: f64) -> Vec<(Place, Point, f64)> {
        self.index().near(&self.lines, p, radius)
    }

    fn index(&self) -> &Index {
        self.index.get_or_init(|| Index::new(&self.lines))
    }

    /// The point at a place.
    pub fn point(&self, place: Place) -> Point {
        self.lines[place.line].point_at(place.at)
    }

    /// Unit direction at a place.
    pub fn direction(&self, place: Place) -> Vec2 {
        self.lines[place.line].direction_at(place.at as usize)
    }

    /// Mean width around a place; the typical one where it cannot be measured.
    pub fn width(&self, place: Place, typical: f64) -> f64 {
        let widths = &self.lines[place.line].widths;
        let k = (place.at as usize).min(widths.len() - 1);
        let around = &widths[k.saturating_sub(WIDTH_AROUND)..(k + WIDTH_AROUND).min(widths.len())];
        let finite: Vec<f64> = around.iter().copied().filter(|w| w.is_finite()).collect();
        if finite.is_empty() { typical } else { finite.iter().sum::<f64>() / finite.len() as f64 }
    }
}

/// How a pass edits.
impl Lines {
    /// Cuts lines at places; every part keeps what is known of the line's own ends. Returns how many places there were.
    pub fn cut(&mut self, places: &[Place]) -> usize {
        let mut of_line = vec![Vec::new(); self.lines.len()];
        for place in places {
            of_line[place.line].push((place.at.round() as usize).min(self.lines[place.line].points.len() - 1));
        }
        if !places.is_empty() {
            let lines = self.edit();
            *lines = lines.iter().zip(of_line).flat_map(|(line, at)| parts(line, at)).collect();
        }
        places.len()
    }

    /// Leads an end to its place on another line.
    pub fn lead(&mut self, line: usize, side: usize, lead: Lead) {
        lead.apply(&mut self.edit()[line], side);
    }

    /// Takes points off an end, of which something new is known now.
    pub fn shorten(&mut self, line: usize, side: usize, count: usize, state: EndState) {
        let line = &mut self.edit()[line];
        line.shorten(side, count);
        line.ends[side] = state;
    }

    /// Any other edit. Lines may be added and dropped.
    pub fn edit(&mut self) -> &mut Vec<Line> {
        (self.index, self.ends) = (OnceLock::new(), OnceLock::new());
        &mut self.lines
    }
}

/// A line cut at some of its points.
fn parts(line: &Line, mut at: Vec<usize>) -> Vec<Line> {
    let n = line.points.len();
    at.sort_unstable();
    at.dedup();
    if at.is_empty() {
        vec![line.clone()]
    } else if line.closed {
        let around: Vec<usize> = (0..=n).map(|k| (at[0] + k) % n).collect();
        let inner: Vec<usize> = at.iter().map(|a| a - at[0]).collect();
        split(line, &around, &inner, [EndState::Parted; 2])
    } else {
        split(line, &(0..n).collect::<Vec<_>>(), &at, line.ends)
    }
}

/// The points of a line in some order, parted at some of them, which both parts keep.
fn split(line: &Line, order: &[usize], at: &[usize], ends: [EndState; 2]) -> Vec<Line> {
    let last = order.len() - 1;
    let inner = at.iter().copied().filter(|&k| k > 0 && k < last);
    let bounds: Vec<usize> = std::iter::once(0).chain(inner).chain([last]).collect();
    let part = |b: &[usize]| {
        let first = if b[0] == 0 { ends[0] } else { EndState::Parted };
        let second = if b[1] == last { ends[1] } else { EndState::Parted };
        line.part(order[b[0]..=b[1]].iter().copied(), [first, second])
    };
    bounds.windows(2).map(part).collect()
}

#[cfg(test)]
mod tests;
