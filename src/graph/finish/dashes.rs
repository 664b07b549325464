//! Whether strokes in a row are dashes: by their lengths, and those of the gaps between them.

use crate::drawing::Dashes;

/// Dashes are at least this many.
const FEWEST_DASHES: usize = 4;
/// Long and short dashes in turns are at least this many.
const FEWEST_ALTERNATING: usize = 5;
/// Lengths of dashes, and of the gaps between them, keep to their median but for this share and so many pixels.
const UNEVEN: f64 = 0.25;
const UNEVEN_PIXELS: f64 = 1.5;
/// A dash is at most this many times as long as the gap after it.
const LONGEST_DASH: f64 = 8.0;
/// A dash fills no more than this share of a pattern, or no gap would be seen.
const MOST_DASH: f64 = 0.95;

/// The lengths of strokes in a row and of the gaps after them, in pixels; a closed row has a gap after the last.
pub(super) struct Row {
    pub lengths: Vec<f64>,
    pub gaps: Vec<f64>,
}

impl Row {
    fn is_closed(&self) -> bool {
        self.gaps.len() == self.lengths.len()
    }

    /// The even pattern of the row; `None` where it is not even.
    pub fn pattern(&self) -> Option<Dashes> {
        let Self { lengths, gaps } = self;
        let n = lengths.len();
        if n < FEWEST_DASHES {
            return None;
        }
        let inner = if self.is_closed() { &lengths[..] } else { &lengths[1..n - 1] };
        let (dash, gap) = (median(inner), median(gaps));
        // The pattern may begin and end within a dash.
        let whole = lengths[0].max(lengths[n - 1]) <= dash + unevenness(dash);
        if !is_even(inner) || !is_even(gaps) || !whole || dash > LONGEST_DASH * gap {
            return None;
        }
        let to_ends: f64 = lengths[1..n - 1].iter().chain(&gaps[..n - 2]).sum();
        let period = if self.is_closed() {
            (lengths.iter().sum::<f64>() + gaps.iter().sum::<f64>()) / n as f64
        } else {
            to_ends / (n - 2) as f64
        };
        let dash = dash.min(MOST_DASH * period);
        let offset = if self.is_closed() || (dash - lengths[0]) < UNEVEN_PIXELS { 0.0 } else { dash - lengths[0] };
        Some(Dashes { dash, gap: period - dash, offset })
    }

    /// Whether every second stroke of an open row is of one length and the others of another, the first and the last
    /// perhaps cut short.
    pub fn alternates(&self) -> bool {
        let n = self.lengths.len();
        if n < FEWEST_ALTERNATING || self.is_closed() {
            return false;
        }
        let every_second = |first: usize| self.lengths[first..n - 1].iter().step_by(2).copied().collect::<Vec<f64>>();
        let (odd, even) = (every_second(1), every_second(2));
        let of = |k: usize| median(if k % 2 == 1 { &odd } else { &even });
        let whole = [0, n - 1].into_iter().all(|k| self.lengths[k] <= of(k) + unevenness(of(k)));
        is_even(&odd)
            && is_even(&even)
            && is_even(&self.gaps)
            && whole
            && of(1).max(of(2)) <= LONGEST_DASH * median(&self.gaps)
    }
}

/// How far lengths of a typical length may be from it.
fn unevenness(typical: f64) -> f64 {
    UNEVEN * typical + UNEVEN_PIXELS
}

fn is_even(values: &[f64]) -> bool {
    let middle = median(values);
    values.iter().all(|v| (v - middle).abs() <= unevenness(middle))
}

/// The middle of some values, of which there is one at least.
pub(super) fn median(values: &[f64]) -> f64 {
    let mut values = values.to_vec();
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Dashes of a length with gaps, the first so much shorter.
    fn row(dash: f64, gap: f64, count: usize, short: f64) -> Row {
        let lengths = (0..count).map(|k| if k == 0 { dash - short } else { dash }).collect();
        Row { lengths, gaps: vec![gap; count - 1] }
    }

    #[test]
    fn an_even_row_has_its_pattern() {
        for (dash, gap) in [(6.0, 4.0), (12.0, 3.0), (9.0, 9.0)] {
            for short in [0.0, 3.0, 5.0] {
                let found = row(dash, gap, 8, short).pattern().expect("even");
                assert!((found.dash - dash).abs() < 1e-9 && (found.gap - gap).abs() < 1e-9, "{found:?}");
                assert!((found.offset - short).abs() < 1e-9, "{found:?}");
            }
        }
    }

    #[test]
    fn few_uneven_and_long_strokes_are_no_dashes() {
        assert!(row(6.0, 4.0, FEWEST_DASHES - 1, 0.0).pattern().is_none());
        assert!(row(80.0, 4.0, 8, 0.0).pattern().is_none());
        let uneven = Row { lengths: vec![6.0, 12.0, 25.0, 6.0, 6.0, 18.0], gaps: vec![4.0; 5] };
        assert!(uneven.pattern().is_none() && !uneven.alternates());
    }

    #[test]
    fn long_and_short_in_turns_alternate_and_have_no_pattern() {
        for (long, short) in [(20.0, 4.0), (12.0, 5.0)] {
            let lengths = (0..7).map(|k| if k % 2 == 0 { long } else { short }).collect();
            let row = Row { lengths, gaps: vec![4.0; 6] };
            assert!(row.alternates() && row.pattern().is_none());
        }
    }
}
