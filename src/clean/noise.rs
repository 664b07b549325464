//! How far the ink of lines can be trusted, place by place.
//!
//! Measured on the lines themselves: at places along the medial ridge, the ink in the cross-section (its mass) and the middle
//! of the cross-section are followed along the line for a few widths. About the parabola that fits best, a renderer's
//! anti-aliased line keeps both to within what sampling by pixels costs; pencil, paper grain, blur of a copy and JPEG move them.
//! Where pixels have two levels only, a line's middle is known to no more than a pixel's share, however even it looks.
//! Places near one another are averaged on a coarse grid, with the page's own mean where they are few.

use super::smooth;
use super::threshold::Paper;
use super::width::{Ridge, RidgePlace};
use crate::raster::Raster;
use kurbo::Point;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// How far the ink can be trusted at a place.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Noise {
    /// Standard deviation, across a line, of its middle about a smooth course; in pixels of the scan.
    pub across: f64,
    /// Standard deviation, along a line, of the ink in its cross-section, as a share of it, beyond what sampling by pixels
    /// costs.
    pub along: f64,
    /// Standard deviation of the blur of a line's edges, in pixels of the scan; an edge that cuts its pixels
    /// in half has 0.8.
    pub blur: f64,
}

impl Noise {
    /// How much this ink is to be borne with: 0 where it is as sure as a render's, 1 where it is as unsure as pencil's.
    pub fn grain(self) -> f64 {
        ramp(self.along, ALONG).max(ramp(self.across, ACROSS)).max(ramp(self.blur, BLUR))
    }

    /// The part of `across` that neighbouring points of a line share, so that they do not scatter by it: that of rounding.
    pub(crate) fn hidden(self) -> f64 {
        self.across * ramp(self.across, ACROSS)
    }

    /// What holds for sure ink, for unsure ink, and between the two for ink between them.
    pub(crate) fn between(self, sure: f64, unsure: f64) -> f64 {
        sure + (unsure - sure) * self.grain()
    }
}

/// How far a value has come from one to the other.
fn ramp(value: f64, [sure, unsure]: [f64; 2]) -> f64 {
    ((value - sure) / (unsure - sure)).clamp(0.0, 1.0)
}

/// Ink is a render's up to the first deviation and a pencil's from the second on; empirical, guarded by the sweeps of
/// `tests/papers.rs`.
const ALONG: [f64; 2] = [0.024, 0.03];
const ACROSS: [f64; 2] = [0.1, 0.2];
const BLUR: [f64; 2] = [0.85, 1.0];

/// Sampling by pixels moves the ink of the cross-section of a line one pixel wide by this share, and of wider ones by less: over
/// the power 1.5 of their width. Empirical, guarded by `a_render_is_sure_at_every_angle_and_width`.
const SAMPLING: f64 = 0.1;
/// Ink on the rim of a line between these is a level of its own: neither paper nor full.
const BETWEEN: [f32; 2] = [0.08, 0.92];
/// So much of the rim of oblique lines is between them at least where a renderer knows shades.
const SHADED: f64 = 0.3;
/// The deviation of a place that is rounded to whole pixels.
const ROUNDING: f64 = 0.289;

/// How far along a line it is measured to either side, in line widths, and the least and most of it in pixels.
const REACH: f64 = 1.5;
const LEAST_REACH: f64 = 4.0;
const MOST_REACH: f64 = 10.0;
/// Paper that belongs to a line's cross-section to either side, in pixels.
const MARGIN: f64 = 1.25;
/// Distance between samples across, in pixels.
const SPACING: f64 = 0.5;
/// A cross-section whose margin has this share of the ink in its middle is not that of one line.
const OPEN: f32 = 0.5;
/// Where a cross-section has less than this share of its line's ink, the line has ended.
const ENDED: f64 = 0.4;
/// No single place counts for more than this much noise: junctions pass for it.
const MOST_ACROSS: f64 = 0.5;
const MOST_ALONG: f64 = 0.2;

/// Side of a cell of the map, in pixels of the scan.
const CELL: f64 = 48.0;
/// What is known beforehand counts as much as this many places: of the page, that its lines are like its paper; of a cell,
/// that it is like the page.
const PRIOR: f32 = 8.0;
/// The cells are blurred by a Gaussian of one cell, which spreads a place over so many.
const SPREAD: f32 = 4.0 * std::f32::consts::PI;
/// The noise along lines that grainy paper lets expect.
const USUAL: f64 = 0.06;

/// [`Noise`] as a function of place.
#[derive(Clone, Debug, PartialEq)]
pub struct NoiseMap {
    /// Side of a cell in pixels of the raster.
    cell: f64,
    across: Raster<f32>,
    along: Raster<f32>,
    blur: Raster<f32>,
}

impl NoiseMap {
    /// The same noise everywhere.
    pub fn even(noise: Noise) -> Self {
        let one = |value: f64| Raster::filled(1, 1, value as f32);
        Self { cell: f64::MAX, across: one(noise.across), along: one(noise.along), blur: one(noise.blur) }
    }

    /// The noise at a place.
    pub fn at(&self, p: Point) -> Noise {
        let (width, height) = self.across.size();
        let within = |v: f64, cells: usize| (v / self.cell).clamp(0.5, cells as f64 - 0.5);
        let place = Point::new(within(p.x, width), within(p.y, height));
        let at = |grid: &Raster<f32>| f64::from(grid.sample(place));
        Noise { across: at(&self.across), along: at(&self.along), blur: at(&self.blur) }
    }

    /// The noise at the middle of a pixel.
    pub(crate) fn at_pixel(&self, x: usize, y: usize) -> Noise {
        self.at(Point::new(x as f64 + 0.5, y as f64 + 0.5))
    }

    /// Whether all ink is as sure as a render's.
    pub fn is_sure(&self) -> bool {
        self.cells().all(|noise| noise.grain() == 0.0)
    }

    /// The mean over the page.
    pub fn mean(&self) -> Noise {
        let mean = |r: &Raster<f32>| f64::from(r.data().iter().sum::<f32>()) / r.data().len() as f64;
        Noise { across: mean(&self.across), along: mean(&self.along), blur: mean(&self.blur) }
    }

    /// The least and the most [`Noise::grain`] on the page.
    pub fn grains(&self) -> [f64; 2] {
        self.cells().map(Noise::grain).fold([1.0, 0.0], |[least, most], g| [least.min(g), most.max(g)])
    }

    /// The map of a resampled raster: the same noise at places that many times as far from the corner.
    pub(crate) fn scaled(mut self, scale: f64) -> Self {
        self.cell *= scale;
        self
    }

    /// The map of the same raster where each pixel of the scan stands for a block of a finer one, so many a side.
    pub(crate) fn of_finer(self, block: usize) -> Self {
        let finer = |lengths: Raster<f32>| lengths.map(|length| block as f32 * length);
        Self { across: finer(self.across), blur: finer(self.blur), ..self }
    }

    /// Whether every number is a possible one.
    pub(crate) fn is_valid(&self) -> bool {
        let grids = [&self.across, &self.along, &self.blur];
        let possible = |grid: &Raster<f32>| grid.data().iter().all(|v| (0.0..1e4).contains(v));
        let like = |grid: &Raster<f32>| grid.size() == self.across.size();
        self.cell > 0.0 && !self.across.data().is_empty() && grids.iter().all(|grid| like(grid) && possible(grid))
    }

    fn cells(&self) -> impl Iterator<Item = Noise> {
        let grids = self.across.data().iter().zip(self.along.data()).zip(self.blur.data());
        grids.map(|((&across, &along), &blur)| Noise { across: across.into(), along: along.into(), blur: blur.into() })
    }

    /// The noise of a page's raw ink at the places of its ridge, where its paper lets expect so much.
    pub(super) fn of(ink: &Raster<f32>, ridge: &Ridge, paper: Paper) -> Self {
        let places: Vec<(Point, Measured)> =
            ridge.places.par_iter().filter_map(|place| Some((place.point, Measured::of(ink, place)?))).collect();
        let cells = |pixels: usize| ((pixels as f64 / CELL).round() as usize).max(1);
        let (columns, rows) = (cells(ink.width()), cells(ink.height()));
        let mean = |prior: f64, value: &dyn Fn(&Measured) -> Option<f64>| {
            let (mut sum, mut count) = (Raster::filled(columns, rows, 0.0f32), Raster::filled(columns, rows, 0.0f32));
            for (p, place) in &places {
                let cell = |v: f64, cells: usize| ((v / CELL) as usize).min(cells - 1);
                let at = (cell(p.x, columns), cell(p.y, rows));
                if let Some(value) = value(place) {
                    sum[at] += value as f32;
                    count[at] += 1.0;
                }
            }
            let total = |r: &Raster<f32>| r.data().iter().sum::<f32>();
            let of_page = (total(&sum) + PRIOR * prior as f32) / (total(&count) + PRIOR);
            let (sum, count) = (smooth(sum, 1.0), smooth(count, 1.0));
            Raster::from_fn(columns, rows, |x, y| {
                (SPREAD * sum[(x, y)] + PRIOR * of_page) / (SPREAD * count[(x, y)] + PRIOR)
            })
        };
        // Grain of the paper is in the ink as well: what has gone through a lens is never as sure as a render.
        let (expected, least) = if paper.grain > 0.0 { (USUAL, ALONG[1] as f32) } else { (0.0, 0.0) };
        let along = mean(expected, &|place| Some(place.along)).map(|along| along.max(least));
        let shaded = mean(if paper.shades { SHADED } else { 0.0 }, &|place| place.shaded);
        let across = mean(0.0, &|place| Some(place.across));
        let rounding = shaded.map(|shaded| ROUNDING as f32 * (1.0 - shaded / SHADED as f32).max(0.0));
        let across = Raster::from_fn(columns, rows, |x, y| across[(x, y)].hypot(rounding[(x, y)]));
        Self { cell: CELL, across, along, blur: mean(0.0, &|place| Some(place.blur)) }
    }
}

/// What is measured around a place.
struct Measured {
    across: f64,
    along: f64,
    /// Share of the rim that is shaded; `None` where the line keeps to the pixels, which says nothing.
    shaded: Option<f64>,
    blur: f64,
}

impl Measured {
    /// `None` where there is not one line alone.
    fn of(ink: &Raster<f32>, place: &RidgePlace) -> Option<Self> {
        let reach = (REACH * place.width).clamp(LEAST_REACH, MOST_REACH).round();
        let place = &turned(ink, place, 0.5 * reach)?;
        let along = place.normal.turn_90();
        let steps = -reach as i32..=reach as i32;
        let section = |s: i32| Section::of(ink, place.point + along * f64::from(s), place);
        let sections: Vec<Section> = steps.map(section).collect::<Option<_>>()?;
        let (masses, middles) = (sections.iter().map(|s| s.mass), sections.iter().map(|s| s.middle));
        let (mass, middle) = (Course::of(masses), Course::of(middles));
        let sampling = SAMPLING * place.width.max(1.0).powf(-1.5);
        let unsteady = mass.deviation / mass.level.max(1e-6);
        // How far the line leaves an axis on its way.
        let way = along * (2.0 * reach) + place.normal * (2.0 * middle.slope);
        let oblique = way.x.abs().min(way.y.abs()) > 1.0;
        Some(Self {
            across: middle.deviation.min(MOST_ACROSS),
            along: (unsteady * unsteady - sampling * sampling).max(0.0).sqrt().min(MOST_ALONG),
            blur: blur_of_steepest(sections.iter().map(|s| s.steepest).sum::<f64>() / sections.len() as f64),
            shaded: oblique.then(|| sections.iter().map(|s| s.shaded).sum::<f64>() / sections.len() as f64),
        })
    }
}

/// The place with its normal turned to the line's course: that of a place is one of few directions.
fn turned(ink: &Raster<f32>, place: &RidgePlace, reach: f64) -> Option<RidgePlace> {
    let along = place.normal.turn_90();
    let middle = |s: f64| Some(Section::of(ink, place.point + along * s, place)?.middle);
    let slope = (middle(reach)? - middle(-reach)?) / (2.0 * reach);
    Some(RidgePlace { normal: (place.normal - along * slope).normalize(), ..*place })
}

/// The ink across a line.
struct Section {
    /// Sum of the ink, in pixels.
    mass: f64,
    /// Where its middle lies along the normal, in pixels.
    middle: f64,
    /// Share of the rim's two sides where the ink is between paper and full.
    shaded: f64,
    /// The largest step from one pixel to the next on the way out, as a share of the ink in the middle.
    steepest: f64,
}

impl Section {
    fn of(ink: &Raster<f32>, p: Point, place: &RidgePlace) -> Option<Self> {
        let half = 0.5 * place.width + MARGIN;
        let count = (half / SPACING).ceil() as i32;
        let at = |k: i32| ink.sample(p + place.normal * (SPACING * f64::from(k)));
        let core = at(0).max(place.ink);
        if at(count).max(at(-count)) > OPEN * core {
            return None;
        }
        let (mut mass, mut moment, mut shaded) = (0.0, 0.0, 0.0);
        for k in -count..=count {
            let value = f64::from(at(k));
            mass += value;
            moment += value * SPACING * f64::from(k);
        }
        let middle = moment / mass.max(1e-6);
        for side in [-0.5, 0.5] {
            let rim = ink.at(p + place.normal * (middle + side * place.width));
            shaded += if rim.is_some_and(|i| (BETWEEN[0]..BETWEEN[1]).contains(&i)) { 0.5 } else { 0.0 };
        }
        // Samples are half a pixel apart.
        let steepest = |side: i32| (-1..count - 1).map(|k| at(side * k) - at(side * (k + 2))).fold(0.0, f32::max);
        let steepest = f64::from(0.5 * (steepest(1) + steepest(-1)) / core.max(1e-3));
        let mass = SPACING * mass;
        (mass > ENDED * place.width * f64::from(place.ink)).then_some(Self { mass, middle, shaded, steepest })
    }
}

/// The deviation of the Gaussian blur under which an edge falls by so much from one pixel to the next.
fn blur_of_steepest(steepest: f64) -> f64 {
    (steepest.max(0.1) * TAU.sqrt()).recip()
}

/// The parabola that fits evenly spaced values best, over `[-1, 1]`.
struct Course {
    level: f64,
    slope: f64,
    /// Standard deviation of the values about it.
    deviation: f64,
}

impl Course {
    fn of(values: impl ExactSizeIterator<Item = f64> + Clone) -> Self {
        let n = values.len() as f64;
        let half = 0.5 * (n - 1.0);
        let placed = || values.clone().enumerate().map(|(k, y)| ((k as f64 - half) / half, y));
        let sum = |f: &dyn Fn(f64, f64) -> f64| placed().map(|(x, y)| f(x, y)).sum::<f64>();
        let (x2, x4) = (sum(&|x, _| x * x), sum(&|x, _| x.powi(4)));
        let (y0, y1, y2) = (sum(&|_, y| y), sum(&|x, y| x * y), sum(&|x, y| x * x * y));
        let bend = (y2 - x2 * y0 / n) / (x4 - x2 * x2 / n);
        let (slope, level) = (y1 / x2, (y0 - bend * x2) / n);
        let square = sum(&|x, y| (y - level - slope * x - bend * x * x).powi(2));
        Self { level, slope, deviation: (square / (n - 3.0)).sqrt() }
    }
}

#[cfg(test)]
mod tests {
    use super::super::blur::profile_at;
    use super::super::distance::distance;
    use super::*;
    use kurbo::Vec2;

    const SIDE: usize = 320;

    /// Lines of a width at an angle in radians, 20 pixels apart, as a function of the distance from the nearest one's
    /// middle and of the place.
    fn lines(angle: f64, ink: impl Fn(f64, Point) -> f64) -> Raster<f32> {
        let normal = Vec2::from_angle(angle);
        Raster::from_fn(SIDE, SIDE, |x, y| {
            let p = Point::new(x as f64 + 0.5, y as f64 + 0.5);
            let across = p.to_vec2().dot(normal);
            ink((across + 3.3).rem_euclid(20.0) - 10.0, p) as f32
        })
    }

    fn noise(ink: &Raster<f32>) -> NoiseMap {
        let mask = ink.map(|i| i > 0.4);
        NoiseMap::of(ink, &Ridge::of(ink, &mask, &distance(&mask)), Paper::of(ink))
    }

    fn anti_aliased(distance: f64, width: f64) -> f64 {
        (0.5 * width - distance.abs() + 0.5).clamp(0.0, 1.0)
    }

    /// A number of a place, about uniform in [-1, 1], that changes every three pixels.
    fn random(p: Point) -> f64 {
        ((p.x / 3.0).floor() * 12.9898 + (p.y / 3.0).floor() * 78.233).sin() * 43758.5453 % 1.0
    }

    #[test]
    fn a_render_is_sure_at_every_angle_and_width() {
        for width in [1.5, 2.0, 3.0, 4.5, 8.0] {
            for angle in (0..12).map(|k| 0.13 + 0.26 * f64::from(k)) {
                let noise = noise(&lines(angle, |d, _| anti_aliased(d, width)));
                assert!(noise.mean().grain() < 0.1, "{width} {angle:.2}: {:?}", noise.mean());
            }
        }
    }

    #[test]
    fn two_levels_are_known_to_a_rounding() {
        for width in [1.0, 2.0, 3.0, 5.0] {
            for angle in (0..12).map(|k| 0.13 + 0.26 * f64::from(k)) {
                let noise = noise(&lines(angle, |d, _| f64::from(u8::from(d.abs() < 0.5 * width)))).mean();
                assert!(noise.across > 0.25 && noise.grain() == 1.0, "{width} {angle:.2}: {noise:?}");
            }
        }
    }

    #[test]
    fn blur_is_measured_at_the_edges() {
        for (width, blur) in [(3.0, 1.0), (5.0, 1.0), (5.0, 1.4)] {
            let noise = noise(&lines(0.4, |d, _| profile_at(d, width, blur))).mean();
            assert!((noise.blur / blur - 1.0).abs() < 0.2, "{width} {blur}: {noise:?}");
        }
    }

    #[test]
    fn grain_along_a_line_is_measured_where_it_is() {
        for grain in [0.3, 0.6] {
            let ink = lines(0.4, |d, p| {
                let tooth = if p.x > 0.5 * SIDE as f64 { grain * (0.5 + 0.5 * random(p)) } else { 0.0 };
                anti_aliased(d, 4.0) * (1.0 - tooth)
            });
            let noise = noise(&ink);
            let (left, right) = (noise.at(Point::new(24.0, 160.0)), noise.at(Point::new(296.0, 160.0)));
            assert!(left.grain() < 0.2 && right.along > 0.1 * grain, "{grain}: {left:?} {right:?}");
        }
    }

    #[test]
    fn a_resampled_raster_has_the_same_noise_where_it_lies_then() {
        let ink = lines(0.4, |d, p| anti_aliased(d, 4.0) * if p.x > 160.0 { 0.7 + 0.3 * random(p) } else { 1.0 });
        let noise = noise(&ink);
        let twice = noise.clone().scaled(2.0);
        for p in [Point::new(20.0, 50.0), Point::new(200.0, 90.0), Point::new(319.0, 319.0)] {
            assert_eq!(noise.at(p), twice.at(Point::new(2.0 * p.x, 2.0 * p.y)));
        }
    }
}
