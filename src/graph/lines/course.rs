//! The course of a line towards a place, and how well one line goes on in another.

use crate::streamline::{STEP, Stop, Streamline, Tail, angle_between};
use kurbo::{CubicBez, ParamCurve, Point};

/// Of thinner pens than this, in pixels, courses are as long as of this one.
pub(in crate::graph) const THIN: f64 = 3.0;
/// How far from an arc the way from one arm to another may be, and what another pairing of arms must gain: [`departure`].
pub(in crate::graph) const LARGEST: f64 = 0.4;
pub(in crate::graph) const MARGIN: f64 = 0.2;
/// Weight of a turn that the arms' curvature does not explain; in narrow bends it is measured too small.
const BENT: f64 = 0.5;

/// Indices of a line's points from so many pixels after one of them on, over that many; `step` is 1 or -1, the way that
/// they are taken.
pub(in crate::graph) fn run(line: &Streamline, at: i64, step: i64, from: f64, over: f64) -> Vec<usize> {
    let (from, to) = ((from / STEP) as i64, ((from + over) / STEP) as i64);
    let n = line.points.len() as i64;
    let index = |k: i64| if line.closed { (at + step * k).rem_euclid(n) } else { at + step * k };
    let to = if line.closed { to.min(n) } else { to };
    (from..to).map(index).take_while(|k| (0..n).contains(k)).map(|k| k as usize).collect()
}

/// The course of a run of points, towards its first.
pub(in crate::graph) fn course(line: &Streamline, run: &[usize]) -> Option<Tail> {
    let oldest_first: Vec<Point> = run.iter().rev().map(|&k| line.points[k]).collect();
    (oldest_first.len() > 5).then(|| Tail::fit(&oldest_first, 0.1)).flatten()
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

/// From one arm to another, smoothly; neither end is included.
pub(in crate::graph) fn bridge(a: &Tail, b: &Tail) -> Vec<Point> {
    let chord = (b.point - a.point).hypot();
    let third = chord / 3.0;
    let curve = CubicBez::new(a.point, a.point + a.heading * third, b.point + b.heading * third, b.point);
    let count = (chord / STEP).ceil().max(2.0) as usize;
    (1..count).map(|k| curve.eval(k as f64 / count as f64)).collect()
}

/// The last points of a line, from where it meets another on, and how many points of its own they replace.
pub(in crate::graph) struct Ending {
    pub points: Vec<Point>,
    pub replaced: usize,
}

impl Ending {
    pub fn apply(self, line: &mut Streamline, side: usize) {
        if side == 1 {
            line.reverse();
        }
        let count = self.points.len();
        line.points.splice(..self.replaced, self.points);
        line.widths.splice(..self.replaced, vec![f64::NAN; count]);
        if side == 1 {
            line.reverse();
        }
        line.stops[side] = Stop::Joined;
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

    #[test]
    fn runs_end_with_a_line_and_go_on_round_a_closed_one() {
        let points: Vec<Point> = (0..10).map(|k| Point::new(STEP * f64::from(k), 0.0)).collect();
        let widths = vec![1.0; points.len()];
        let line = |closed| Streamline {
            points: points.clone(),
            widths: widths.clone(),
            closed,
            stops: [crate::streamline::Stop::InkEnd; 2],
        };
        assert_eq!(run(&line(false), 7, 1, 0.0, 4.0), [7, 8, 9]);
        assert_eq!(run(&line(false), 3, -1, STEP, 4.0), [2, 1, 0]);
        assert_eq!(run(&line(true), 8, 1, STEP, 2.0), [9, 0, 1, 2]);
        assert_eq!(run(&line(true), 0, 1, 0.0, 100.0).len(), 10);
    }
}
