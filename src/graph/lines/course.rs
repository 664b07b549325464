//! The course of a line towards a place, and how well one line goes on in another.
//!
//! There are two measures, for two situations. Where the ways of lines through shared ink are known for longer than a
//! junction, [`departure`] compares what lies between two arms with an arc. At a node, which is a point, [`continuation`]
//! compares the arms' directions there.

use super::line::{EndState, Line};
use crate::streamline::{STEP, Tail, angle_between};
use kurbo::{CubicBez, ParamCurve, Point, Vec2};

/// Of thinner pens than this, in pixels, courses are as long as of this one.
pub(in crate::graph) const THIN: f64 = 3.0;
/// The way from one arm to another departs from an arc by less than this, radians: [`departure`]. Another pairing of arms is
/// better by at least so much. Empirical, guarded by `encounters.rs`.
pub(in crate::graph) const LARGEST_DEPARTURE: f64 = 0.4;
pub(in crate::graph) const LEAST_GAIN: f64 = 0.2;
/// Weight of a turn that the arms' curvature does not explain; in narrow bends it is measured too small.
const BENT: f64 = 0.5;
/// A jump in curvature counts as the turn that it makes over this many line widths.
const CURVATURE_SPAN: f64 = 3.0;
/// A jump in curvature counts for no more than this, radians (14 degrees): curvature is measured worse than direction.
const LARGEST_JUMP: f64 = 0.25;
/// An arm goes on bending for no longer than this many line widths: its curvature was measured over as many.
const BENDING: f64 = 5.0;
/// The standard deviation of a line's points about its course, in pixels: curvature that it explains is not kept.
const JITTER: f64 = 0.1;
/// A course takes more points than these.
const FEWEST: usize = 5;

/// The course of a run of points of a line, towards the first of them; `None` where they are too few.
pub(in crate::graph) fn course(line: &Line, run: &[usize]) -> Option<Tail> {
    let oldest_first: Vec<Point> = run.iter().rev().map(|&k| line.points[k]).collect();
    (oldest_first.len() > FEWEST).then(|| Tail::fit(&oldest_first, JITTER)).flatten()
}

/// How far the way from one arm to another, both heading into it, is from an arc that goes on as both bend, in radians: an
/// arc leaves its chord by the angle by which it comes back to it, and by both together it turns as much as its curvature
/// says.
pub(in crate::graph) fn departure(a: &Tail, b: &Tail) -> f64 {
    let chord = b.point - a.point;
    let (leaving, coming) = (angle_between(a.heading, chord), angle_between(chord, -b.heading));
    let bend = 0.5 * (a.curvature - b.curvature) * chord.hypot();
    (leaving - coming).abs() + BENT * (leaving + coming - bend).abs()
}

/// An arm as a straight line: its course, bent by its curvature up to where it passes a point.
pub(in crate::graph) fn arm_line(tail: &Tail, towards: Point, line_width: f64) -> (Point, Vec2) {
    let normal = tail.heading.turn_90();
    let s = (towards - tail.point).dot(tail.heading).clamp(0.0, BENDING * line_width);
    let point = tail.point + tail.heading * s + normal * (0.5 * tail.curvature * s * s);
    let d = tail.heading + normal * (tail.curvature * s);
    (point, d.normalize())
}

/// How badly one arm of a node continues another, both heading into it, in radians: the turn between them, and
/// the jump in curvature over a couple of line widths.
pub(in crate::graph) fn continuation(a: &Tail, b: &Tail, at: Point, line_width: f64) -> f64 {
    let (_, into) = arm_line(a, at, line_width);
    let (_, out) = arm_line(b, at, line_width);
    let jump = (CURVATURE_SPAN * line_width * (a.curvature + b.curvature)).abs().min(LARGEST_JUMP);
    angle_between(into, -out).abs() + jump
}

/// From one arm to another, smoothly; neither end is included.
pub(in crate::graph) fn bridge(a: &Tail, b: &Tail) -> Vec<Point> {
    let chord = (b.point - a.point).hypot();
    let third = chord / 3.0;
    let curve = CubicBez::new(a.point, a.point + a.heading * third, b.point + b.heading * third, b.point);
    let count = (chord / STEP).ceil().max(2.0) as usize;
    (1..count).map(|k| curve.eval(k as f64 / count as f64)).collect()
}

/// The way of a line to its place on another: the last points, from that place on, and how many of the line's own they
/// replace.
pub(in crate::graph) struct Lead {
    pub points: Vec<Point>,
    pub replaced: usize,
}

impl Lead {
    pub(super) fn apply(self, line: &mut Line, side: usize) {
        if side == 1 {
            line.reverse();
        }
        let count = self.points.len();
        line.points.splice(..self.replaced, self.points);
        line.widths.splice(..self.replaced, vec![f64::NAN; count]);
        if side == 1 {
            line.reverse();
        }
        line.ends[side] = EndState::Led;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kurbo::Vec2;

    /// The two ends of a gap in a circle, of an angle.
    fn gap(radius: f64, angle: f64) -> [Tail; 2] {
        let end = |at: f64, sign: f64| Tail {
            point: (radius * Vec2::from_angle(at)).to_point(),
            heading: sign * Vec2::from_angle(at).turn_90(),
            curvature: sign / radius,
        };
        [end(0.0, 1.0), end(angle, -1.0)]
    }

    #[test]
    fn an_arc_goes_on_in_itself_and_a_kink_does_not() {
        for radius in [15.0, 60.0, 400.0] {
            for angle in [0.1, 0.4, 0.9] {
                let [a, b] = gap(radius, angle);
                // The curvature counts over the chord, which is a little shorter than the arc.
                assert!(departure(&a, &b) < 0.02, "{radius} {angle}");
                let straight = |tail: Tail| Tail { curvature: 0.0, ..tail };
                let kink = departure(&straight(a), &straight(b));
                assert!((kink - BENT * angle).abs() < 1e-9, "{radius} {angle}: {kink}");
                let aside = Tail { heading: -b.heading.turn_90(), ..b };
                assert!(departure(&a, &aside) > 1.0, "{radius} {angle}");
            }
        }
    }

    #[test]
    fn a_bridge_over_a_gap_in_a_circle_lies_on_it() {
        for radius in [15.0, 60.0, 400.0] {
            let [a, b] = gap(radius, 0.7);
            let bridge = bridge(&a, &b);
            let off = bridge.iter().map(|p| (p.to_vec2().hypot() - radius).abs()).fold(0.0, f64::max);
            assert!(off < 0.01 * radius, "{radius}: {off}");
            let all: Vec<Point> = [vec![a.point], bridge, vec![b.point]].concat();
            assert!(all.windows(2).all(|w| (w[1] - w[0]).hypot() < 1.2 * STEP));
        }
    }
}
