//! A line of the drawing, and what is known of its ends.

use crate::streamline::{STEP, Stop, Streamline};
use kurbo::{Line as Segment, Point, Vec2};

/// What the graph knows of an end of a line.
///
/// | state | set by | read by |
/// |---|---|---|
/// | `Open` | the walk, where the ink ended | cusp; contacts, for blunt corners |
/// | `RanIn` | the walk; overlap, fork | tangency, cusp, fork; contacts and node, which follow it further |
/// | `CutOff` | the walk, at the border or a solid region | gap before a body, tangent end; contacts, free end, assemble |
/// | `Parted` | tangency, colour change, swapped arms, wrong arm | the end's course; assemble, which forgets its last points |
/// | `Lifted` | gap before a body | tangent end; contacts |
/// | `Led` | cusp, tangent end | tangent end; contacts and node, which take its place as it is |
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum EndState {
    /// Its ink ends here.
    #[default]
    Open,
    /// It ran into ink of another line, or of an earlier part of its own, that goes the same way.
    RanIn,
    /// The line itself goes on, out of the image or under a solid region: this is no pen's end.
    CutOff,
    /// It was cut from another part of a line here.
    Parted,
    /// The pen was lifted here: there is paper between this line and the next.
    Lifted,
    /// It was led to its place on another line, at a small angle or none.
    Led,
}

impl From<Stop> for EndState {
    fn from(stop: Stop) -> Self {
        match stop {
            Stop::InkEnd => Self::Open,
            Stop::Merged => Self::RanIn,
            Stop::Border | Stop::Solid => Self::CutOff,
        }
    }
}

/// A line of the drawing: points about half a pixel apart.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Line {
    /// The points, in pixels of the line image. A closed line does not repeat its first point.
    pub points: Vec<Point>,
    /// Measured ink width at each point, in pixels; NaN where the line is not alone.
    pub widths: Vec<f64>,
    /// Whether the last point joins the first.
    pub closed: bool,
    /// What is known of the first and of the last point; of no meaning when closed.
    pub ends: [EndState; 2],
}

impl From<&Streamline> for Line {
    fn from(walk: &Streamline) -> Self {
        let (points, widths) = (walk.points.clone(), walk.widths.clone());
        Self { points, widths, closed: walk.closed, ends: walk.stops.map(EndState::from) }
    }
}

/// The places of a line: indices of points, and fractional ones between them.
impl Line {
    /// Index of the point that is `k` points from an end: 0 is the side of the first point, 1 that of the last.
    pub(in crate::graph) fn inwards(&self, side: usize, k: usize) -> usize {
        if side == 0 { k } else { self.points.len() - 1 - k }
    }

    /// The point that is `k` points from an end.
    pub(in crate::graph) fn at_end(&self, side: usize, k: usize) -> Point {
        self.points[self.inwards(side, k)]
    }

    /// Whether only this line's ink was seen at a point, so that its width could be measured.
    pub(in crate::graph) fn is_alone(&self, k: usize) -> bool {
        self.widths[k].is_finite()
    }

    /// Number of straight pieces; a closed line has one more that leads back.
    pub(in crate::graph) fn piece_count(&self) -> usize {
        if self.closed { self.points.len() } else { self.points.len().saturating_sub(1) }
    }

    /// The straight piece from one of the points on.
    pub(in crate::graph) fn piece(&self, k: usize) -> Segment {
        Segment::new(self.points[k], self.points[(k + 1) % self.points.len()])
    }

    /// The point at a fractional index.
    pub(in crate::graph) fn point_at(&self, at: f64) -> Point {
        let n = self.points.len();
        let k = at.floor() as usize;
        let next = if self.closed { k + 1 } else { (k + 1).min(n - 1) };
        self.points[k % n].lerp(self.points[next % n], at - at.floor())
    }

    /// Unit direction from one of the points on.
    pub(in crate::graph) fn direction_at(&self, k: usize) -> Vec2 {
        let n = self.points.len();
        let k = k.min(self.piece_count().saturating_sub(1));
        let (a, b) = if self.closed {
            (self.points[(k + n - 2) % n], self.points[(k + 3) % n])
        } else {
            (self.points[k.saturating_sub(2)], self.points[(k + 3).min(n - 1)])
        };
        let d = b - a;
        if d.hypot() > 1e-9 { d.normalize() } else { Vec2::new(1.0, 0.0) }
    }

    /// Indices of the points within `reach` pixels along the line from a fractional index.
    pub(in crate::graph) fn around(&self, at: f64, reach: f64) -> impl Iterator<Item = usize> + use<> {
        let (n, closed) = (self.points.len() as i64, self.closed);
        let (at, span) = (at.round() as i64, (reach / STEP) as i64);
        let indices = (at - span..=at + span).map(move |k| if closed { k.rem_euclid(n) } else { k });
        indices.filter(move |k| (0..n).contains(k)).map(|k| k as usize)
    }

    /// Indices of the points from `from` pixels after one of them on, over so many pixels; `step` is 1 or -1, the way that
    /// they are taken.
    pub(in crate::graph) fn run(&self, at: i64, step: i64, from: f64, over: f64) -> Vec<usize> {
        let (from, to) = ((from / STEP) as i64, ((from + over) / STEP) as i64);
        let n = self.points.len() as i64;
        let index = |k: i64| if self.closed { (at + step * k).rem_euclid(n) } else { at + step * k };
        let to = if self.closed { to.min(n) } else { to };
        (from..to).map(index).take_while(|k| (0..n).contains(k)).map(|k| k as usize).collect()
    }
}

/// The edits that a line bears by itself.
impl Line {
    /// The same line from its other end.
    pub(in crate::graph) fn reverse(&mut self) {
        self.points.reverse();
        self.widths.reverse();
        self.ends.reverse();
    }

    /// The same line so that it begins at an end.
    pub(in crate::graph) fn oriented(mut self, side: usize) -> Self {
        if side == 1 {
            self.reverse();
        }
        self
    }

    /// The part over some indices, in their order.
    pub(in crate::graph) fn part(&self, indices: impl Iterator<Item = usize> + Clone, ends: [EndState; 2]) -> Self {
        let points = indices.clone().map(|k| self.points[k]).collect();
        Self { points, widths: indices.map(|k| self.widths[k]).collect(), closed: false, ends }
    }

    /// Goes on over points at which its width cannot be told.
    pub(in crate::graph) fn lead_on(&mut self, points: Vec<Point>) {
        self.widths.resize(self.points.len() + points.len(), f64::NAN);
        self.points.extend(points);
    }

    /// Goes on along another line, from its first point to its end.
    pub(in crate::graph) fn append(&mut self, other: Self) {
        self.points.extend(other.points);
        self.widths.extend(other.widths);
        self.ends[1] = other.ends[1];
    }

    /// Takes points off an end.
    pub(in crate::graph) fn shorten(&mut self, side: usize, count: usize) {
        let n = self.points.len();
        let kept = if side == 0 { count.min(n)..n } else { 0..n - count.min(n) };
        (self.points, self.widths) = (self.points[kept.clone()].to_vec(), self.widths[kept].to_vec());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(count: usize, closed: bool) -> Line {
        let points: Vec<Point> = (0..count).map(|k| Point::new(STEP * k as f64, 0.0)).collect();
        Line { widths: vec![1.0; points.len()], points, closed, ends: [EndState::Open; 2] }
    }

    #[test]
    fn runs_end_with_a_line_and_go_on_round_a_closed_one() {
        let (open, closed) = (line(10, false), line(10, true));
        assert_eq!(open.run(7, 1, 0.0, 4.0), [7, 8, 9]);
        assert_eq!(open.run(3, -1, STEP, 4.0), [2, 1, 0]);
        assert_eq!(closed.run(8, 1, STEP, 2.0), [9, 0, 1, 2]);
        assert_eq!(closed.run(0, 1, 0.0, 100.0).len(), 10);
    }

    #[test]
    fn a_line_is_the_same_from_both_of_its_ends() {
        for closed in [false, true] {
            let line = line(9, closed);
            let back = line.clone().oriented(1);
            for k in 0..9 {
                assert_eq!(line.at_end(0, k), back.at_end(1, k));
                assert_eq!(line.inwards(1, k), 8 - k);
            }
            assert_eq!(back.oriented(1), line);
        }
    }

    #[test]
    fn places_lie_on_their_pieces() {
        for closed in [false, true] {
            let line = line(9, closed);
            for k in 0..line.piece_count() {
                let middle = line.point_at(k as f64 + 0.5);
                assert!((middle - line.piece(k).midpoint()).hypot() < 1e-12, "{closed} {k}");
            }
            assert_eq!(line.around(4.2, 1.0).collect::<Vec<_>>(), [2, 3, 4, 5, 6]);
            assert_eq!(line.around(0.0, 1.0).count(), if closed { 5 } else { 3 });
        }
    }

    #[test]
    fn shortening_takes_off_at_one_end_only() {
        for side in [0, 1] {
            for count in [0, 1, 5, 9, 20] {
                let (before, mut after) = (line(9, false), line(9, false));
                after.shorten(side, count);
                assert_eq!(after.points.len(), 9usize.saturating_sub(count));
                assert_eq!(after.points.len(), after.widths.len());
                let same = after.points.first().is_none_or(|_| after.at_end(1 - side, 0) == before.at_end(1 - side, 0));
                assert!(same, "{side} {count}");
            }
        }
    }
}
