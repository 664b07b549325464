//! The widths of the pens that a drawing was made with.
//!
//! Widths are measured with an error, so strokes of one pen differ a little. Pens are told by description length: a pen more
//! says each stroke's width more closely, but each stroke then has to say which pen it is of.

use crate::drawing::{Centreline, Color, Stroke};
use kurbo::Shape;
use std::collections::BTreeMap;

/// Standard deviation of a measured width: this share of it, and this many pixels (empirical, guarded by
/// `tests/widths.rs`).
const ERROR_SHARE: f64 = 0.04;
const ERROR_PIXELS: f64 = 0.1;
/// A stroke of at least so many widths counts in full: its ends and junctions are a small part of it.
const FULL_LENGTH: f64 = 4.0;
/// Strokes whose widths differ by less than this share are one from the start.
const BIN: f64 = 0.005;
/// What a pen costs by itself, in nats: its width, to a few hundredths.
const PEN_PRICE: f64 = 3.0;

/// Strokes that are taken for those of one pen.
#[derive(Clone)]
struct Pen {
    weight: f64,
    /// Mean width.
    width: f64,
    strokes: Vec<usize>,
}

/// Gives each stroke the width of its pen; dots keep their own. `pixel` is a pixel of the scan in the unit of the widths.
pub(super) fn snap(strokes: &mut [Stroke], pixel: f64) {
    let mut by_color: BTreeMap<Color, BTreeMap<i64, Pen>> = BTreeMap::new();
    for (k, stroke) in strokes.iter().enumerate() {
        if matches!(stroke.centreline, Centreline::Dot(_)) || stroke.width.is_nan() || stroke.width <= 0.0 {
            continue;
        }
        let length = stroke.centreline.to_path().perimeter(0.1);
        let weight = (length / (FULL_LENGTH * stroke.width)).clamp(1e-3, 1.0);
        let one = Pen { weight, width: stroke.width, strokes: vec![k] };
        let bin = (stroke.width.ln() / BIN).floor() as i64;
        let bins = by_color.entry(stroke.color).or_default();
        bins.entry(bin).and_modify(|pen| *pen = joined(pen, &one)).or_insert(one);
    }
    for bins in by_color.into_values() {
        for pen in told_apart(bins.into_values().collect(), pixel) {
            pen.strokes.iter().for_each(|&k| strokes[k].width = pen.width);
        }
    }
}

fn joined(a: &Pen, b: &Pen) -> Pen {
    let weight = a.weight + b.weight;
    let width = (a.weight * a.width + b.weight * b.width) / weight;
    Pen { weight, width, strokes: [&a.strokes[..], &b.strokes[..]].concat() }
}

/// Joins neighbours, the likest first, until every joining would cost more than it saves.
fn told_apart(mut pens: Vec<Pen>, pixel: f64) -> Vec<Pen> {
    loop {
        let costs = pens.windows(2).map(|pair| cost_of_joining(&pair[0], &pair[1], pixel));
        let least = costs.enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
        let Some((k, _)) = least.filter(|(_, cost)| *cost < 0.0) else { return pens };
        let next = pens.remove(k + 1);
        pens[k] = joined(&pens[k], &next);
    }
}

/// How many nats more it takes to say the widths of two pens' strokes by one pen.
fn cost_of_joining(a: &Pen, b: &Pen, pixel: f64) -> f64 {
    let all = a.weight + b.weight;
    let error = (ERROR_SHARE * 0.5 * (a.width + b.width)).hypot(ERROR_PIXELS * pixel);
    let strain = a.weight * b.weight / all * (a.width - b.width).powi(2) / (2.0 * error * error);
    let choice = |part: f64| -part * (part / all).ln();
    strain - choice(a.weight) - choice(b.weight) - PEN_PRICE
}
