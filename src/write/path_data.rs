//! The `d` attribute of an SVG path.

use super::Rounding;
use crate::drawing::Segment;
use kurbo::{Arc, BezPath, PathEl, Point};
use std::f64::consts::PI;

/// Arcs longer than this are written in two halves. The ends of a longer arc are so near to each other
/// that rounding them would turn the whole arc.
const LONGEST_ARC: f64 = 1.5 * PI;

/// How far a dot's path goes: some programs do not draw a path of no length at all.
const DOT_LENGTH: &str = "0.01";

/// A path as absolute commands, each number rounded once, so that errors do not add up.
pub(super) struct PathData {
    rounding: Rounding,
    text: String,
    at: Point,
    start: Point,
}

impl PathData {
    /// An empty path.
    pub(super) fn new(rounding: Rounding) -> Self {
        Self { rounding, text: String::new(), at: Point::ZERO, start: Point::ZERO }
    }

    /// A dot: the round cap makes it visible.
    pub(super) fn dot(rounding: Rounding, p: Point) -> String {
        let mut data = Self::new(rounding);
        data.move_to(p);
        data.text.push('h');
        data.text.push_str(DOT_LENGTH);
        data.text
    }

    /// A chain of pieces; one that rounds to a point is written as a dot.
    pub(super) fn chain(rounding: Rounding, segments: &[Segment], closed: bool) -> String {
        let mut data = Self::new(rounding);
        let start = segments[0].start();
        data.move_to(start);
        let bare = data.text.len();
        for (i, segment) in segments.iter().enumerate() {
            let last = closed && i + 1 == segments.len();
            let end = if last { start } else { segment.end() };
            match segment {
                Segment::Line(_) if last => {} // Z draws it
                Segment::Line(_) => data.line_to(end),
                Segment::Arc(arc) => data.arc(arc, end),
                Segment::Cubic(c) => data.cubic_to(c.p1, c.p2, end),
            }
        }
        if data.text.len() == bare {
            return Self::dot(rounding, start);
        }
        if closed {
            data.close();
        }
        data.text
    }

    /// The outline of a filled region.
    pub(super) fn outline(rounding: Rounding, path: &BezPath) -> String {
        let mut data = Self::new(rounding);
        for element in path.elements() {
            match *element {
                PathEl::MoveTo(p) => data.move_to(p),
                PathEl::LineTo(p) => data.line_to(p),
                PathEl::QuadTo(a, p) => data.command('Q', &[a, p]),
                PathEl::CurveTo(a, b, p) => data.cubic_to(a, b, p),
                PathEl::ClosePath => data.close(),
            }
        }
        data.text
    }

    fn number(&mut self, value: f64) {
        if self.text.ends_with(|c: char| c.is_ascii_digit()) {
            self.text.push(' ');
        }
        self.text.push_str(&self.rounding.text(value));
    }

    /// Appends a command whose last point becomes the current one.
    fn command(&mut self, letter: char, points: &[Point]) {
        self.text.push(letter);
        for &p in points {
            self.at = self.rounding.point(p);
            self.number(self.at.x);
            self.number(self.at.y);
        }
    }

    fn move_to(&mut self, p: Point) {
        self.command('M', &[p]);
        self.start = self.at;
    }

    fn line_to(&mut self, p: Point) {
        let to = self.rounding.point(p);
        match (to.x == self.at.x, to.y == self.at.y) {
            (true, true) => return,
            (false, true) => {
                self.text.push('H');
                self.number(to.x);
            }
            (true, false) => {
                self.text.push('V');
                self.number(to.y);
            }
            (false, false) => self.command('L', &[to]),
        }
        self.at = to;
    }

    fn cubic_to(&mut self, a: Point, b: Point, p: Point) {
        let points = [a, b, p];
        if points.iter().any(|&q| self.rounding.point(q) != self.at) {
            self.command('C', &points);
        }
    }

    fn close(&mut self) {
        self.text.push('Z');
        self.at = self.start;
    }

    /// An arc from the current point to `end`, which is the arc's own end but for rounding.
    fn arc(&mut self, arc: &Arc, end: Point) {
        if arc.sweep_angle.abs() <= LONGEST_ARC {
            return self.short_arc(arc, end);
        }
        let sweep_angle = arc.sweep_angle / 2.0;
        let first = Arc { sweep_angle, ..*arc };
        let second = Arc { start_angle: arc.start_angle + sweep_angle, sweep_angle, ..*arc };
        self.short_arc(&first, Segment::Arc(first).end());
        self.short_arc(&second, end);
    }

    /// The radius is computed anew from the rounded ends and the true height of the arc over its chord, and
    /// is printed as finely as that height asks: near half a circle the height hangs on the radius by a
    /// square root, and two decimals would move the arc's middle by a pixel.
    fn short_arc(&mut self, arc: &Arc, end: Point) {
        let to = self.rounding.point(end);
        let half_chord = 0.5 * (to - self.at).hypot();
        let height = arc.radii.x.abs() * (1.0 - (0.5 * arc.sweep_angle).cos());
        if half_chord == 0.0 || height < 0.25 * self.rounding.step() {
            return self.line_to(end);
        }
        let radius = (half_chord * half_chord + height * height) / (2.0 * height);
        let sensitivity = (radius / (radius - height) - 1.0).abs();
        let extra = if sensitivity < 1e6 { sensitivity.max(1.0).log10().ceil() as usize } else { 6 };
        let radius = self.rounding.finer(extra).text(radius);
        let (large, sweep) = (u8::from(height > half_chord), u8::from(arc.sweep_angle > 0.0));
        self.text.push_str(&format!("A{radius} {radius} 0 {large} {sweep}"));
        self.at = to;
        self.number(to.x);
        self.number(to.y);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kurbo::{CubicBez, Line};

    fn chain(segments: &[Segment], closed: bool) -> String {
        PathData::chain(Rounding::new(2), segments, closed)
    }

    fn line(a: (f64, f64), b: (f64, f64)) -> Segment {
        Segment::Line(Line::new(a, b))
    }

    #[test]
    fn straight_pieces_use_the_short_commands() {
        let segments =
            [line((1.0, 1.0), (5.0, 1.001)), line((5.0, 1.0), (5.0, 9.5)), line((5.0, 9.5), (-0.001, 10.126))];
        assert_eq!(chain(&segments, false), "M1 1H5V9.5L0 10.13");
    }

    #[test]
    fn a_closing_line_is_left_to_the_close_command() {
        let segments = [line((1.0, 1.0), (5.0, 1.0)), line((5.0, 1.0), (3.0, 4.0)), line((3.0, 4.0), (1.0, 1.0))];
        assert_eq!(chain(&segments, true), "M1 1H5L3 4Z");
    }

    #[test]
    fn a_closing_curve_ends_at_the_start_exactly() {
        let c = CubicBez::new((1.0, 1.0), (9.0, 1.0), (9.0, 9.0), (1.0049, 1.0051));
        assert_eq!(chain(&[Segment::Cubic(c)], true), "M1 1C9 1 9 9 1 1Z");
    }

    #[test]
    fn arcs_carry_their_flags() {
        let arc = |sweep: f64| Segment::Arc(Arc::new((10.0, 10.0), (5.0, 5.0), 0.0, sweep, 0.0));
        assert_eq!(chain(&[arc(0.5 * PI)], false), "M15 10A5 5 0 0 1 10 15");
        assert_eq!(chain(&[arc(-0.5 * PI)], false), "M15 10A5 5 0 0 0 10 5");
        assert_eq!(chain(&[arc(1.5 * PI)], false), "M15 10A5 5 0 1 1 10 5");
        assert_eq!(chain(&[arc(2.0 * PI)], true), "M15 10A5 5 0 0 1 5 10A5 5 0 0 1 15 10Z");
    }

    #[test]
    fn what_rounds_to_nothing_is_a_dot() {
        assert_eq!(chain(&[line((1.0, 1.0), (1.001, 1.001))], false), "M1 1h0.01");
        assert_eq!(chain(&[line((1.0, 1.0), (1.001, 1.001))], true), "M1 1h0.01");
    }
}
