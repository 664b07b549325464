//! Whether an end reaches the line ahead of it.
//!
//! On a scan a narrow gap is not white and a light spot is not a gap. So the scan is compared with what it would be: a
//! pen of known width that ends at a distance from the middle of a line, its cap round, both under the scan's blur.
//! The darkness of pen and line is free. The distance that explains the pixels best, in least squares, tells whether
//! the two inks touch.

use crate::clean::{LineImage, profile_at, unblurred_width};
use kurbo::{Line, ParamCurveNearest, Point, Vec2};

/// Distances are tried from this far past the line's middle, up to that far before it, in pen widths.
const PAST: f64 = 0.25;
const BEFORE: f64 = 3.0;
/// How finely, in pixels.
const SPACING: f64 = 0.125;
/// Pixels are compared from this far past the line's middle, in pen widths, and up to that far beside the pen's edge.
const BEYOND: f64 = 0.2;
const BESIDE: f64 = 1.5;
/// Pixels nearer than this to another line's edge are left out.
const CLEAR_OF_OTHERS: f64 = 1.5;
/// A gap explains the pixels better than none by this factor of squared differences, and by so much more for each mean
/// squared difference that is left, as a share of full ink.
const CLEAR: f64 = 1.015;
const UNLIKE: f64 = 2.0;
/// With fewer pixels nothing is said.
const FEWEST: usize = 20;

/// A pen that comes up to a line.
#[derive(Clone, Debug)]
pub(super) struct Approach {
    /// Where the pen's course crosses the middle of the line.
    pub foot: Point,
    /// Unit direction of the course there, towards the line.
    pub heading: Vec2,
    /// Measured widths of pen and line, in pixels.
    pub widths: [f64; 2],
    /// The middle of the line around the foot.
    pub body: Vec<Line>,
    /// The middles of other lines nearby, with their widths.
    pub others: Vec<(Line, f64)>,
}

impl Approach {
    /// The middle of the paper between the pen's ink and the line's, where there clearly is some.
    pub fn gap(&self, image: &LineImage) -> Option<Point> {
        let [pen, body] = self.widths.map(|w| unblurred_width(w, image.blur));
        let pixels = self.pixels(image, pen, body);
        if pixels.len() < FEWEST {
            return None;
        }
        let error = |end: f64| misfit(&pixels, pen, image.blur.max(0.3), end);
        let count = ((PAST + BEFORE) * pen / SPACING) as usize;
        let tried = (0..=count).map(|k| SPACING * k as f64 - PAST * pen).map(|end| (end, error(end)));
        let tip = |end: f64| self.foot - self.heading * end;
        let touches = |end: f64| distance(&self.body, tip(end)) <= 0.5 * (pen + body);
        let (touching, apart): (Vec<_>, Vec<_>) = tried.partition(|(end, _)| touches(*end));
        let least = |a: &(f64, f64), b: &(f64, f64)| a.1.total_cmp(&b.1);
        let ((_, with), (end, without)) = (touching.into_iter().min_by(least)?, apart.into_iter().min_by(least)?);
        // The worse even the better one explains the pixels, the more it has to be the better one.
        let clear = CLEAR + UNLIKE * with.min(without) / pixels.len() as f64;
        (without * clear < with).then(|| tip(0.5 * (end - 0.5 * pen + 0.5 * body)))
    }

    /// The pixels that tell of the pen's end.
    fn pixels(&self, image: &LineImage, pen: f64, body: f64) -> Vec<Pixel> {
        let (beside, before) = (0.5 * pen + BESIDE, (BEFORE + 0.2) * pen);
        let side = before.max(beside) + 1.0;
        let near: Vec<&(Line, f64)> =
            self.others.iter().filter(|o| o.0.nearest(self.foot, 1e-6).distance_sq < 4.0 * side * side).collect();
        let (x0, y0) = ((self.foot.x - side) as i64, (self.foot.y - side) as i64);
        let mut pixels = Vec::new();
        for y in y0..=y0 + 2 * side.ceil() as i64 {
            for x in x0..=x0 + 2 * side.ceil() as i64 {
                let p = Point::new(x as f64 + 0.5, y as f64 + 0.5);
                let d = p - self.foot;
                let (along, across) = (-d.dot(self.heading), d.cross(self.heading));
                let inside = across.abs() < beside && along > -BEYOND * pen && along < before;
                let Some(ink) = image.ink.get(x, y).filter(|_| inside) else { continue };
                let hidden = |(line, width): &&(Line, f64)| {
                    line.nearest(p, 1e-6).distance_sq < (0.5 * width + CLEAR_OF_OTHERS).powi(2)
                };
                if near.iter().any(hidden) {
                    continue;
                }
                let covered = profile_at(distance(&self.body, p), body, image.blur.max(0.3));
                pixels.push(Pixel { along, across, covered, ink: f64::from(ink) });
            }
        }
        pixels
    }
}

/// A pixel beside a pen's course.
struct Pixel {
    /// Place along the course, away from the line, and across it.
    along: f64,
    across: f64,
    /// How much the line alone covers of it.
    covered: f64,
    ink: f64,
}

/// Sum of squared differences between the pixels and a pen that ends `end` pixels before the line's middle, with the
/// darkness of line and pen that make it least.
fn misfit(pixels: &[Pixel], pen: f64, blur: f64, end: f64) -> f64 {
    let (mut bb, mut bp, mut pp, mut bi, mut pi, mut ii) = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    for pixel in pixels {
        let past = (end - pixel.along).max(0.0);
        let of_pen = profile_at(pixel.across.hypot(past), pen, blur) * (1.0 - pixel.covered);
        let (b, p, i) = (pixel.covered, of_pen, pixel.ink);
        (bb, bp, pp) = (bb + b * b, bp + b * p, pp + p * p);
        (bi, pi, ii) = (bi + b * i, pi + p * i, ii + i * i);
    }
    let det = bb * pp - bp * bp;
    if det < 1e-9 {
        return ii;
    }
    let (body, pen) = ((bi * pp - pi * bp) / det, (pi * bb - bi * bp) / det);
    ii - body * bi - pen * pi
}

fn distance(chain: &[Line], p: Point) -> f64 {
    chain.iter().map(|l| l.nearest(p, 1e-6).distance_sq).fold(f64::MAX, f64::min).sqrt()
}
