//! Drawings of two levels: their staircases are noise, not detail.

mod common;

use common::compare::body_apart;
use common::draw::{Pen, arc, circle, line, polar, scan, scan_by, sheet, trace};
use common::sweep::{ensure, pairs, steps, sweep};
use fieldtrace::drawing::Drawing;
use kurbo::Point;

const CENTER: Point = Point::new(60.3, 60.7);

fn one_bit(truth: &Drawing) -> Drawing {
    trace(&scan_by(truth, Pen { anti_alias: false, ..Pen::default() }))
}

#[test]
fn a_straight_line_is_one_piece_at_any_angle() {
    let angles = [steps(2.0, 90.0, 4.0), vec![0.0, 0.5, 1.0, 89.0]].concat();
    let mut pieces = Vec::new();
    for (angle, width) in pairs(&angles, &[1.0, 2.0, 3.0]) {
        let truth = sheet(120, 120, vec![line(polar(CENTER, angle, 52.0), polar(CENTER, angle + 180.0, 52.0), width)]);
        let traced = one_bit(&truth);
        let apart = body_apart(&truth, &traced, 3.0).mean;
        assert!(apart < 0.35, "{angle} degrees, {width} wide: {apart:.2} off");
        pieces.push(traced.segment_count());
    }
    let mean = pieces.iter().sum::<usize>() as f64 / pieces.len() as f64;
    assert!(mean <= 1.1, "{mean:.2} pieces a line: {pieces:?}");
}

#[test]
fn circles_and_arcs_are_what_they_are_in_grey() {
    let cases = pairs(&pairs(&[8.0, 20.0, 45.0], &[1.0, 2.0, 3.0]), &[1.2, 3.0, 7.0]);
    sweep("one bit, round", 0.9, &cases, |&((radius, width), sweep)| {
        let stroke = if sweep > 6.3 { circle(CENTER, radius, width) } else { arc(CENTER, radius, 0.7, sweep, width) };
        let truth = sheet(120, 120, vec![stroke]);
        let (grey, traced) = (trace(&scan(&truth)), one_bit(&truth));
        let (a, b) = (grey.segment_count(), traced.segment_count());
        ensure(b <= a, || format!("{b} pieces, {a} in grey"))?;
        let apart = body_apart(&truth, &traced, 3.0).mean;
        ensure(apart < 0.35, || format!("{apart:.2} off"))
    });
}
