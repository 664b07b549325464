//! Seeded line drawings, scans of them and pages with them: every epoch of training sees new ones.

mod motifs;
mod noise;
mod page;
mod placed;
mod scan;
mod shapes;

pub use page::{Kind, Page, page};
#[cfg(test)]
pub(crate) use placed::mapped;
pub use placed::placed;
pub use scan::{ScanStyle, clean_ink, scan};

use crate::drawing::{Centreline, Drawing, Stroke};
use kurbo::Point;
use rand::Rng;
use shapes::{arc_from, open, within};
use std::f64::consts::TAU;

/// How the strokes of one drawing are drawn.
#[derive(Clone, Copy, Debug)]
struct Style {
    /// Typical pen width in pixels.
    width: f64,
    /// How far single strokes leave it: standard deviation of the logarithm.
    mix: f64,
    /// How large shapes are, 1 to 5.
    scale: f64,
    /// Whether strokes are drawn by hand with a thin pen.
    freehand: bool,
}

impl Style {
    /// Widths from 1 to 12 px, most between 2 and 5.
    fn draw(rng: &mut impl Rng) -> Self {
        let width = if rng.random_bool(0.8) { within(rng, 2.0, 5.0) } else { (within(rng, 0.0, 12f64.ln())).exp() };
        let mix = if rng.random_bool(0.6) { 0.0 } else { 0.35 };
        let scale = if rng.random_bool(0.3) { 1.0 } else { within(rng, 0.0, 5f64.ln()).exp() };
        let freehand = rng.random_bool(0.25);
        let width = if freehand { within(rng, 1.0, 3.5) } else { width };
        Self { width, mix, scale, freehand }
    }

    fn pen(&self, rng: &mut impl Rng) -> f64 {
        (self.width * (self.mix * noise::gaussian(rng)).exp()).clamp(1.0, 12.0)
    }
}

/// A drawing under construction.
struct Sheet {
    drawing: Drawing,
    style: Style,
}

impl Sheet {
    fn add(&mut self, rng: &mut impl Rng, centreline: Centreline) {
        let width = self.style.pen(rng);
        self.drawing.strokes.push(Stroke::new(centreline, width));
    }

    /// A place on the canvas, or a little outside.
    fn place(&self, rng: &mut impl Rng) -> Point {
        let (w, h) = (self.drawing.width, self.drawing.height);
        Point::new(within(rng, -0.05, 1.05) * w, within(rng, -0.05, 1.05) * h)
    }
}

/// A drawing of `size x size` pixels: shapes, forced junctions of all kinds, near-parallels, tangencies, dashes,
/// details and dense parts.
pub fn drawing(rng: &mut impl Rng, size: usize) -> Drawing {
    let style = Style::draw(rng);
    let mut sheet = Sheet { drawing: Drawing::new(size as f64, size as f64), style };
    // About one motif on every 50 x 50 pixels, fewer where the pen is wide.
    let area = (size * size) as f64 / 2500.0;
    let density = within(rng, 0.3, 1.2) / (style.width / 3.5).max(0.8) / style.scale;
    let motifs = (area * density).ceil().max(1.0) as usize;
    for _ in 0..motifs {
        motifs::motif(rng, &mut sheet);
    }
    sheet.drawing
}

/// A drawing of lines and circular arcs only, all of them at least partly in sight, drawn with one pen of 1.5 to 4 px.
pub fn primitives(rng: &mut impl Rng, size: usize, count: usize) -> Drawing {
    let side = size as f64;
    let mut drawing = Drawing::new(side, side);
    let width = within(rng, 1.5, 4.0);
    for _ in 0..count {
        let start = Point::new(within(rng, 0.1, 0.9) * side, within(rng, 0.1, 0.9) * side);
        let (angle, length) = (within(rng, 0.0, TAU), within(rng, 0.3, 0.9) * side);
        let bend = if rng.random_bool(0.5) { 0.0 } else { within(rng, -2.5, 2.5) };
        let centreline = open(vec![arc_from(start, angle, length, bend)]);
        drawing.strokes.push(Stroke::new(centreline, width));
    }
    drawing
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clean;
    use crate::ground_truth;
    use crate::load::Scan;
    use crate::options::Options;
    use crate::render::render;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    #[test]
    fn the_same_seed_draws_the_same() {
        let draw = |seed| drawing(&mut ChaCha8Rng::seed_from_u64(seed), 128);
        assert_eq!(draw(5), draw(5));
        assert_ne!(draw(5), draw(6));
    }

    #[test]
    fn drawings_have_ink_and_junctions_and_paper() {
        let (mut ink, mut junctions) = (0, 0);
        for seed in 0..20 {
            let truth = ground_truth::field(&drawing(&mut ChaCha8Rng::seed_from_u64(seed), 128));
            ink += truth.ink.count();
            junctions += truth.near_junction.count();
        }
        let all = 20 * 128 * 128;
        assert!(ink > all / 30 && ink < all / 3, "{ink} of {all}");
        assert!(junctions > ink / 10, "{junctions}");
    }

    #[test]
    fn a_scan_of_a_drawing_still_shows_its_ink() {
        for seed in 0..20 {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            let drawing = drawing(&mut rng, 128);
            let coverage = render(&drawing);
            let style = ScanStyle::draw(&mut rng);
            let gray = scan(&mut rng, &coverage, &style);
            let ink = clean::clean(&Scan { gray, rgb: None, dpi: None }, &Options::default()).ink;
            if ink.size() != coverage.size() {
                continue;
            }
            let mean = |on: bool| {
                let picked = coverage.data().iter().zip(ink.data()).filter(|(c, _)| (**c > 0.9) == on);
                let (sum, n) = picked.fold((0.0, 0.0), |(s, n), (_, i)| (s + i, n + 1.0));
                sum / f32::max(n, 1.0)
            };
            assert!(mean(true) > mean(false) + 0.3, "seed {seed}: {} {}", mean(true), mean(false));
        }
    }
}
