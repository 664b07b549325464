//! Lines drawn by a trembling hand have hardly more pieces than calm ones.

mod common;

use common::compare::strokes_apart;
use common::draw::{polyline, scan, sheet, trace};
use fieldtrace::drawing::Drawing;
use kurbo::{CubicBez, ParamCurve, ParamCurveArclen, ParamCurveDeriv, Point};
use std::f64::consts::TAU;

/// Lines and curves, as cubics.
const SHAPES: [[(f64, f64); 4]; 3] = [
    [(16.0, 30.0), (48.0, 50.0), (80.0, 70.0), (112.0, 90.0)],
    [(16.0, 100.0), (30.0, 10.0), (90.0, 20.0), (112.0, 100.0)],
    [(14.0, 60.0), (60.0, -20.0), (70.0, 150.0), (114.0, 60.0)],
];

/// A shape under waves of about a length that rise to a height.
fn drawn([a, b, c, d]: [(f64, f64); 4], width: f64, height: f64, length: f64) -> Drawing {
    let curve = CubicBez::new(a, b, c, d);
    let count = 2 * curve.arclen(1e-3) as usize;
    let point = |k: usize| -> Point {
        let t = curve.inv_arclen(0.5 * k as f64, 1e-3);
        let phase = TAU * 0.5 * k as f64 / length;
        // Three waves that are in no proportion.
        let wave = (phase.sin() + (0.83 * phase + 1.0).sin() + (1.21 * phase + 2.0).sin()) / 3.0;
        curve.eval(t) + curve.deriv().eval(t).to_vec2().normalize().turn_90() * (height * wave)
    };
    let points: Vec<Point> = (0..=count).map(point).collect();
    sheet(128, 128, vec![polyline(&points, false, width)])
}

#[test]
fn a_trembling_line_has_less_than_twice_the_pieces_of_a_calm_one() {
    let (mut pieces, mut calm_pieces) = (0, 0);
    for shape in SHAPES {
        for width in [2.0, 3.0, 4.0, 6.0] {
            let calm = trace(&scan(&drawn(shape, width, 0.0, 3.0))).segment_count();
            for height in [0.2, 0.5, 1.0_f64] {
                let height = height.min(0.25 * width);
                for length in [3.0, 6.0, 12.0, 20.0] {
                    let truth = drawn(shape, width, height, length);
                    let traced = trace(&scan(&truth));
                    pieces += traced.segment_count();
                    calm_pieces += calm;
                    let apart = strokes_apart(&truth, &traced).mean;
                    assert!(apart < 0.7 * height + 0.15, "{width} wide, {height} by {length}: {apart:.2} off");
                }
            }
        }
    }
    let ratio = pieces as f64 / calm_pieces as f64;
    println!("{pieces} pieces, {calm_pieces} without tremor");
    assert!(ratio <= 1.9, "{ratio:.2} times as many pieces");
}

#[test]
fn a_bump_that_was_drawn_is_kept() {
    for width in [2.0, 3.0, 4.0] {
        let bump = |x: f64| 0.6 * width * (-((x - 64.0) / (1.5 * width)).powi(2)).exp();
        let points: Vec<Point> = (16..=112).map(|x| Point::new(f64::from(x), 64.3 - bump(f64::from(x)))).collect();
        let truth = sheet(128, 128, vec![polyline(&points, false, width)]);
        let apart = strokes_apart(&truth, &trace(&scan(&truth))).max;
        assert!(apart < 0.25 * width, "{width} wide: {apart:.2} off");
    }
}
