//! Lines that took each other's arms are cut.
//!
//! Where two lines run through shared ink, at a crossing or along a touch, both walks may come out by the other's
//! arm. The four arms, as they run outside the shared ink, are compared: when another pairing turns less than the
//! walks did, both lines are cut in the middle of it, and their parts are paired anew.

use crate::clean::LineImage;
use crate::graph::lines::{LARGEST_DEPARTURE, LEAST_GAIN, Lines, Place, course, departure};
use crate::streamline::STEP;
use rayon::prelude::*;

/// Lines nearer to each other than this, in line widths, share ink.
const TOUCH: f64 = 0.6;
/// Longest stretch of shared ink, in line widths.
const LONGEST: f64 = 8.0;
/// Parts of one line are different lines when they are this many line widths apart along it.
const OWN: f64 = 6.0;
/// A stretch goes on over this many points that share nothing, and where the other line's place moves on by no more than so
/// many line widths.
const INTERRUPTED: f64 = 4.0;
const JUMP: f64 = 2.0;
/// Arms begin this many line widths outside the shared ink; their course is that of so many.
const AWAY: f64 = 0.75;
const OVER: f64 = 5.0;

/// A stretch of shared ink: first and last place on each of two lines.
#[derive(Clone, Copy, Debug)]
struct Shared {
    a: [Place; 2],
    b: [Place; 2],
}

/// The places at which lines should be cut.
pub(in crate::graph) fn cuts(image: &LineImage, lines: &Lines) -> Vec<Place> {
    let of_line = |i: usize| shared(image, lines, i).into_iter().filter_map(|s| cut(image, lines, s));
    let cuts: Vec<[Place; 2]> = (0..lines.len()).into_par_iter().flat_map_iter(of_line).collect();
    cuts.concat()
}

/// The stretches that a line shares with those after it, and with later parts of its own.
fn shared(image: &LineImage, lines: &Lines, i: usize) -> Vec<Shared> {
    let line = &lines[i];
    let mut stretches: Vec<Shared> = Vec::new();
    let own = OWN * image.line_width / STEP;
    // Where a width was measured, the line is alone.
    for k in (0..line.points.len()).filter(|&k| !line.is_alone(k)) {
        let here = Place { line: i, at: k as f64 };
        for (place, ..) in lines.near(line.points[k], TOUCH * image.line_width) {
            if place.line < i || (place.line == i && place.at < here.at + own) {
                continue;
            }
            // Passes of one line are told apart by where on it they are.
            let goes_on = |s: &&mut Shared| {
                let [a, b] = [s.a[1], s.b[1]];
                b.line == place.line
                    && here.at - a.at <= INTERRUPTED
                    && (place.at - b.at).abs() * STEP <= JUMP * image.line_width
            };
            match stretches.iter_mut().find(goes_on) {
                Some(stretch) => (stretch.a[1], stretch.b[1]) = (here, place),
                None => stretches.push(Shared { a: [here; 2], b: [place; 2] }),
            }
        }
    }
    stretches
}

/// Where both lines are to be cut, if another pairing of their arms is better.
fn cut(image: &LineImage, lines: &Lines, shared: Shared) -> Option<[Place; 2]> {
    if (shared.a[1].at - shared.a[0].at) * STEP > LONGEST * image.line_width {
        return None;
    }
    let [away, over] = [AWAY, OVER].map(|widths| widths * image.line_width);
    let arm = |place: Place, step: i64| {
        let line = &lines[place.line];
        course(line, &line.run(place.at.round() as i64, step, away, over))
    };
    let [a0, a1] = [arm(shared.a[0], -1)?, arm(shared.a[1], 1)?];
    let forwards = shared.b[1].at >= shared.b[0].at;
    let [b0, b1] = [arm(shared.b[0], if forwards { -1 } else { 1 })?, arm(shared.b[1], if forwards { 1 } else { -1 })?];
    let middle = |[from, to]: [Place; 2]| Place { line: from.line, at: 0.5 * (from.at + to.at) };
    let places = [middle(shared.a), middle(shared.b)];
    let walked = departure(&a0, &a1) + departure(&b0, &b1);
    let others = [[departure(&a0, &b0), departure(&a1, &b1)], [departure(&a0, &b1), departure(&a1, &b0)]];
    let better =
        |pair: &[f64; 2]| pair.iter().all(|t| *t < LARGEST_DEPARTURE) && pair[0] + pair[1] + LEAST_GAIN < walked;
    others.iter().any(better).then_some(places)
}
