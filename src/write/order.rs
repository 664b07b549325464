//! The order in which a plotter would draw strokes.

use crate::drawing::Stroke;
use kurbo::Point;
use rstar::RTree;
use rstar::primitives::GeomWithData;

/// How far apart in the order two moves may be to be exchanged.
const WINDOW: usize = 48;
/// Passes over all strokes that look for exchanges.
const PASSES: usize = 4;

/// An order of strokes with little travel between them, starting at the origin: each stroke's index, and
/// whether it is to be walked from its end to its start.
///
/// Greedy: the nearest stroke end that is left, over both ends of open strokes; then exchanges of
/// neighbours (2-opt within a window) while they help. `O(n log n)` in practice. Strokes whose ends are
/// not finite come last, in the order given.
pub fn pen_order(strokes: &[&Stroke]) -> Vec<(usize, bool)> {
    let ends: Vec<[Point; 2]> = strokes.iter().map(|s| [s.centreline.start(), s.centreline.end()]).collect();
    let (finite, other): (Vec<usize>, Vec<usize>) =
        (0..ends.len()).partition(|&i| ends[i].iter().all(|p| p.is_finite()));
    let mut order = greedy(&ends, &finite);
    for _ in 0..PASSES {
        if !exchange(&ends, &mut order) {
            break;
        }
    }
    order.extend(other.into_iter().map(|i| (i, false)));
    order
}

/// Distance travelled with the pen up over strokes in an order, starting at the origin, in pixels.
pub fn pen_up_length(strokes: &[&Stroke], order: &[(usize, bool)]) -> f64 {
    let mut at = Point::ZERO;
    let mut total = 0.0;
    for &(i, reversed) in order {
        let (start, end) = (strokes[i].centreline.start(), strokes[i].centreline.end());
        let (first, last) = if reversed { (end, start) } else { (start, end) };
        total += at.distance(first);
        at = last;
    }
    total
}

type End = GeomWithData<[f64; 2], (usize, bool)>;

/// The tree's entry for walking a stroke from one of its ends.
fn entry(ends: &[[Point; 2]], i: usize, reversed: bool) -> End {
    let p = ends[i][usize::from(reversed)];
    End::new([p.x, p.y], (i, reversed))
}

fn greedy(ends: &[[Point; 2]], strokes: &[usize]) -> Vec<(usize, bool)> {
    let open = |i: usize| ends[i][0] != ends[i][1];
    let mut entries: Vec<End> = strokes.iter().map(|&i| entry(ends, i, false)).collect();
    entries.extend(strokes.iter().filter(|&&i| open(i)).map(|&i| entry(ends, i, true)));
    let mut left = RTree::bulk_load(entries);
    let mut order = Vec::with_capacity(strokes.len());
    let mut at = [0.0, 0.0];
    while let Some(&nearest) = left.nearest_neighbor(&at) {
        let (i, reversed) = nearest.data;
        left.remove(&entry(ends, i, false));
        left.remove(&entry(ends, i, true));
        let end = ends[i][usize::from(!reversed)];
        at = [end.x, end.y];
        order.push((i, reversed));
    }
    order
}

/// One pass that turns round each run of strokes whose turning shortens the two moves at its ends.
fn exchange(ends: &[[Point; 2]], order: &mut [(usize, bool)]) -> bool {
    let first = |&(i, reversed): &(usize, bool)| ends[i][usize::from(reversed)];
    let last = |&(i, reversed): &(usize, bool)| ends[i][usize::from(!reversed)];
    let mut changed = false;
    for from in 0..order.len() {
        let before = if from == 0 { Point::ZERO } else { last(&order[from - 1]) };
        for to in from..(from + WINDOW).min(order.len()) {
            let next = order.get(to + 1).map(first);
            let cost = |a: Point, b: Point| before.distance(a) + next.map_or(0.0, |n| b.distance(n));
            let (now, turned) =
                (cost(first(&order[from]), last(&order[to])), cost(last(&order[to]), first(&order[from])));
            if turned < now - 1e-9 {
                order[from..=to].reverse();
                order[from..=to].iter_mut().for_each(|step| step.1 = !step.1);
                changed = true;
            }
        }
    }
    changed
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::{Centreline, Segment};
    use kurbo::Line;

    fn stroke(a: (f64, f64), b: (f64, f64)) -> Stroke {
        let centreline = Centreline::Path { segments: vec![Segment::Line(Line::new(a, b))], closed: false };
        Stroke::new(centreline, 1.0)
    }

    /// A fixed sequence of numbers in `[0, 1)` that looks random.
    fn numbers(count: usize) -> Vec<f64> {
        let mut state = 12345u64;
        let mut next = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        (0..count).map(|_| next()).collect()
    }

    fn scattered(count: usize) -> Vec<Stroke> {
        let numbers = numbers(4 * count);
        let at = |n: &[f64]| (1000.0 * n[0], 1000.0 * n[1]);
        numbers.chunks(4).map(|n| stroke(at(n), (at(n).0 + 10.0 * n[2], at(n).1 + 10.0 * n[3]))).collect()
    }

    #[test]
    fn a_dashed_line_is_drawn_from_one_end_to_the_other() {
        let dashes =
            [stroke((30.0, 0.0), (25.0, 0.0)), stroke((0.0, 0.0), (5.0, 0.0)), stroke((10.0, 0.0), (15.0, 0.0))];
        let strokes: Vec<&Stroke> = dashes.iter().collect();
        assert_eq!(pen_order(&strokes), [(1, false), (2, false), (0, true)]);
    }

    #[test]
    fn every_stroke_is_drawn_once_and_the_travel_is_short() {
        let strokes = scattered(2000);
        let strokes: Vec<&Stroke> = strokes.iter().collect();
        let order = pen_order(&strokes);
        let mut seen: Vec<usize> = order.iter().map(|o| o.0).collect();
        seen.sort_unstable();
        assert!(seen.into_iter().eq(0..strokes.len()));
        // A tour over n random points in a square of side a is about 0.71 sqrt(n) a long.
        let length = pen_up_length(&strokes, &order);
        assert!(length < 1.05 * 0.7124 * 2000f64.sqrt() * 1000.0, "{length}");
        assert_eq!(order, pen_order(&strokes));
    }

    #[test]
    fn many_strokes_take_little_time() {
        let strokes = scattered(50_000);
        let strokes: Vec<&Stroke> = strokes.iter().collect();
        let start = std::time::Instant::now();
        assert_eq!(pen_order(&strokes).len(), 50_000);
        assert!(start.elapsed().as_secs_f64() < 20.0, "{:?}", start.elapsed());
    }

    #[test]
    fn strokes_at_one_place_and_without_a_place_are_kept() {
        let strokes =
            [stroke((f64::NAN, 0.0), (1.0, 0.0)), stroke((2.0, 2.0), (2.0, 2.0)), stroke((2.0, 2.0), (2.0, 2.0))];
        let strokes: Vec<&Stroke> = strokes.iter().collect();
        let order = pen_order(&strokes);
        assert_eq!((order.len(), order[2]), (3, (0, false)));
    }
}
