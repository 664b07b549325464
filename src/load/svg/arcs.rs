//! Circular arcs, which a parsed SVG holds as cubic pieces of equal turn.

use crate::drawing::{Centreline, Segment};
use kurbo::{Arc, Circle, CubicBez, Point, Vec2};
use std::f64::consts::{FRAC_PI_2, TAU};

/// How far control points may be from those of an arc: this many chords, or the rounding of single precision in pixels.
const TOLERANCE: (f64, f64) = (1e-4, 1e-3);

/// How much the turns of an arc's pieces may differ, and a full turn be missed, in radians.
const SAME_TURN: f64 = 1e-2;

/// Turn in radians below which a piece tells no circle.
const LEAST_TURN: f64 = 0.1;

/// A cubic that stands for an arc.
#[derive(Clone, Copy)]
struct Turn {
    from: Point,
    to: Point,
    centre: Point,
    radius: f64,
    /// Signed, in radians.
    turn: f64,
}

/// The centreline of a chain of pieces with its arcs as such: neighbours on one circle that turn by the same angle are
/// one arc, and where they close, a circle.
pub(super) fn with_arcs(segments: &[Segment], closed: bool) -> Centreline {
    let mut whole: Vec<Segment> = Vec::new();
    let mut run: Vec<Turn> = Vec::new();
    for segment in segments {
        let turn = if let Segment::Cubic(c) = segment { Turn::of(c) } else { None };
        if !matches!((&turn, run.last()), (Some(next), Some(last)) if next.continues(last)) {
            whole.extend(arcs(&run));
            run.clear();
        }
        match turn {
            Some(turn) => run.push(turn),
            None => whole.push(*segment),
        }
    }
    match circle(&run) {
        Some(circle) if closed && whole.is_empty() => Centreline::Circle(circle),
        _ => {
            whole.extend(arcs(&run));
            Centreline::Path { segments: whole, closed }
        }
    }
}

impl Turn {
    /// The arc through a cubic's ends, if its control points are where those of the arc would be.
    fn of(cubic: &CubicBez) -> Option<Self> {
        let (out, home, chord) = (cubic.p1 - cubic.p0, cubic.p3 - cubic.p2, cubic.p3 - cubic.p0);
        let turn = out.cross(home).atan2(out.dot(home));
        if !(LEAST_TURN..FRAC_PI_2 + SAME_TURN).contains(&turn.abs()) {
            return None;
        }
        let arc = Self::through(cubic.p0, cubic.p3, turn);
        let arm = 4.0 / 3.0 * (0.25 * turn).abs().tan() * arc.radius;
        let along = Vec2::from_angle(chord.atan2() - 0.5 * turn) * arm;
        let off = (cubic.p0 + along).distance(cubic.p1);
        let back = Vec2::from_angle(chord.atan2() + 0.5 * turn) * arm;
        let off = off.max((cubic.p3 - back).distance(cubic.p2));
        (off <= TOLERANCE.1.max(TOLERANCE.0 * chord.hypot())).then_some(arc)
    }

    /// The arc between two points that turns by an angle of less than a full turn.
    fn through(from: Point, to: Point, turn: f64) -> Self {
        let chord = to - from;
        let centre = from.midpoint(to) + chord.turn_90() * (0.5 / (0.5 * turn).tan());
        Self { from, to, centre, radius: centre.distance(from), turn }
    }

    fn continues(&self, last: &Self) -> bool {
        let apart = self.centre.distance(last.centre).max((self.radius - last.radius).abs());
        apart <= 2.0 * TOLERANCE.1.max(TOLERANCE.0 * self.radius) && (self.turn - last.turn).abs() < SAME_TURN
    }

    fn segment(&self) -> Segment {
        let start = (self.from - self.centre).atan2();
        Segment::Arc(Arc::new(self.centre, (self.radius, self.radius), start, self.turn, 0.0))
    }
}

/// The arc of a run of pieces; more than a full turn stays in pieces.
fn arcs(run: &[Turn]) -> Vec<Segment> {
    let turn: f64 = run.iter().map(|t| t.turn).sum();
    match run {
        [first, .., last] if turn.abs() < TAU - SAME_TURN => {
            vec![Turn::through(first.from, last.to, turn).segment()]
        }
        _ => run.iter().map(Turn::segment).collect(),
    }
}

/// The circle of a run of pieces that turns once around.
fn circle(run: &[Turn]) -> Option<Circle> {
    let turn: f64 = run.iter().map(|t| t.turn).sum();
    let mean = |f: fn(&Turn) -> f64| run.iter().map(f).sum::<f64>() / run.len() as f64;
    ((turn.abs() - TAU).abs() < SAME_TURN)
        .then(|| Circle::new((mean(|t| t.centre.x), mean(|t| t.centre.y)), mean(|t| t.radius)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use kurbo::{PathSeg, Shape};

    /// The pieces of an arc as they come out of the parser, in single precision.
    fn pieces(arc: Arc) -> Vec<Segment> {
        let single = |p: Point| Point::new(f64::from(p.x as f32), f64::from(p.y as f32));
        let piece = |s| match s {
            PathSeg::Cubic(c) => Segment::Cubic(CubicBez::new(single(c.p0), single(c.p1), single(c.p2), single(c.p3))),
            other => panic!("{other:?} in an arc"),
        };
        arc.to_path(0.1).segments().map(piece).collect()
    }

    #[test]
    fn arcs_come_back_whole() {
        for radius in [2.0, 17.0, 300.0, 2000.0] {
            for degrees in [-300.0f64, -180.0, -20.0, 30.0, 90.0, 91.0, 179.0, 180.0, 270.0, 350.0] {
                let arc = Arc::new((400.0, 250.0), (radius, radius), 0.7, degrees.to_radians(), 0.0);
                let Centreline::Path { segments, closed: false } = with_arcs(&pieces(arc), false) else { panic!() };
                let [Segment::Arc(found)] = segments[..] else { panic!("{degrees} degrees: {segments:?}") };
                let apart = found.center.distance(arc.center).max((found.radii.x - radius).abs());
                // Half a digit of single precision, the more the closer the ends are.
                let close = 1e-4 * radius.max(10.0);
                assert!(apart < close && (found.sweep_angle - arc.sweep_angle).abs() < 1e-3, "{degrees}: {found:?}");
            }
        }
    }

    #[test]
    fn a_closed_turn_is_a_circle_and_an_open_one_is_not() {
        for radius in [0.5, 6.0, 90.0, 4000.0] {
            let arc = Arc::new((40.0, 25.0), (radius, radius), 0.0, -TAU, 0.0);
            let Centreline::Circle(found) = with_arcs(&pieces(arc), true) else { panic!("{radius}") };
            assert!(found.center.distance(arc.center) < 1e-3 && (found.radius - radius).abs() < 1e-3, "{found:?}");
            assert!(matches!(with_arcs(&pieces(arc), false), Centreline::Path { .. }));
        }
    }

    #[test]
    fn ends_stay_where_they_were() {
        let arc = Arc::new((40.0, 25.0), (30.0, 30.0), 0.3, 4.0, 0.0);
        let pieces = pieces(arc);
        let whole = with_arcs(&pieces, false);
        assert!(whole.start().distance(pieces[0].start()) < 1e-9);
        assert!(whole.end().distance(pieces[pieces.len() - 1].end()) < 1e-9);
    }

    #[test]
    fn other_curves_stay_as_they_are() {
        let half = Arc::new((40.0, 25.0), (30.0, 30.0), 0.0, 3.0, 0.0);
        let other = Arc::new((40.0, 25.0), (30.0, 30.0), 3.0, 1.0, 0.0);
        let both = [pieces(half), pieces(other)].concat();
        let Centreline::Path { segments, .. } = with_arcs(&both, false) else { panic!() };
        assert_eq!(segments.len(), 2, "turns differ");
        let free = [Segment::Cubic(CubicBez::new((0.0, 0.0), (3.0, 9.0), (20.0, 12.0), (30.0, 2.0)))];
        let Centreline::Path { segments, .. } = with_arcs(&free, false) else { panic!() };
        assert_eq!(segments, free);
    }
}
