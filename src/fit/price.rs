//! What it takes to tell where points lie beside a piece, in units in which a line costs 4.
//!
//! Points that scatter by the deviation that is taken for noise cost one a piece, where they are independent of one another.
//! Two kinds of noise are not independent from point to point, and are told by waves, runs of points to one side of a piece:
//!
//! - Ink is drawn in steps, of a pixel where it has two levels and of a quarter of one where a rasteriser looked at four rows.
//!   The steps of a line that is all but level are longer than any piece. Any course within half a step explains them, so
//!   there a wave costs what its points do, but no more than one independent point, and only what lies beyond costs more.
//! - A hand trembles. How far is told once for a piece, and then each wave by its height.

use super::Tolerance;
use super::samples::Samples;

/// Half the width of an even law, in its standard deviations: the square root of 3.
const EVEN: f64 = 1.732;
/// The deviation of an edge that was drawn in steps of a quarter of a pixel of the scan: `1 / (4 sqrt 12)`.
pub(super) const QUARTER_STEPS: f64 = 0.072;

/// Price of saying that a hand trembles: that of a cubic, as both tell four numbers.
const TREMOR: f64 = 8.0;
/// A wave that is higher than this share of the line's width, or longer than so many widths, is no tremor but what was to be
/// drawn.
const HIGHEST: f64 = 0.2;
const LONGEST: f64 = 8.0;
/// Points of less weight than this lie inside junctions and tell no wave's height.
const LEAST_WEIGHT: f64 = 0.5;
/// Beyond so many times the steps or the highest wave, root mean square, points are no noise.
const FAR: f64 = 2.0;

/// A point beside a piece, and how many it stands for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Offset {
    pub weight: f64,
    pub count: f64,
    /// Distance to the left.
    pub by: f64,
}

/// The sum of squared distances of points from a piece, and that of their weights.
#[derive(Clone, Copy, Debug)]
pub(super) struct Misfit {
    pub error: f64,
    pub weight: f64,
}

/// The prices of a section's points.
#[derive(Clone, Copy, Debug)]
pub(super) struct Prices {
    /// Standard deviation that is taken for noise.
    deviation: f64,
    /// How far to both sides of a piece the ink's steps lead, and to those of a line.
    steps: f64,
    steps_of_line: f64,
    /// Independent points in each.
    independent: f64,
    /// The highest wave of a tremor; 0 where there is none.
    highest: f64,
    width: f64,
}

impl Prices {
    /// The prices where no hand trembles.
    pub fn new(samples: &Samples, tolerance: Tolerance) -> Self {
        // Neighbouring points share ink: about one in a line width is independent.
        let independent = (samples.length() / samples.len() as f64 / tolerance.width).min(1.0);
        let steps_of_line = EVEN * samples.noise.max(QUARTER_STEPS * tolerance.pixel);
        Self {
            deviation: tolerance.scatter(samples),
            steps: EVEN * samples.noise,
            steps_of_line,
            independent,
            highest: 0.0,
            width: tolerance.width,
        }
    }

    /// The prices of lines.
    pub fn of_lines(self) -> Self {
        Self { steps: self.steps_of_line, ..self }
    }

    /// The prices where a hand trembles.
    pub fn with_tremor(self) -> Self {
        Self { highest: HIGHEST * self.width, ..self }
    }

    /// The price of points whose distances are independent.
    fn independent(&self, error: f64) -> f64 {
        error * self.independent / (self.deviation * self.deviation)
    }

    /// The price of points by their squared distances, and by their offsets where these tell more.
    pub fn of(&self, misfit: Misfit, offsets: impl Fn() -> Vec<Offset>) -> f64 {
        let independent = self.independent(misfit.error);
        let far = FAR * self.steps.max(self.highest);
        if independent < 1.0 || misfit.error > far * far * misfit.weight {
            return independent;
        }
        let offsets = offsets();
        let waves = || offsets.chunk_by(|a, b| (a.by < 0.0) == (b.by < 0.0));
        let drawn = waves().map(|wave| self.of_steps(wave)).sum::<f64>();
        if self.highest == 0.0 {
            return drawn;
        }
        drawn.min(TREMOR + waves().map(|wave| self.of_wave(wave)).sum::<f64>())
    }

    /// The price of a wave that is no tremor.
    fn of_steps(&self, wave: &[Offset]) -> f64 {
        let sum = |f: &dyn Fn(f64) -> f64| wave.iter().map(|o| o.weight * o.count * f(o.by.abs())).sum::<f64>();
        let independent = self.independent(sum(&|by| by * by));
        if self.steps == 0.0 {
            return independent;
        }
        let deviation = self.steps / EVEN;
        let within = sum(&|by| by.min(self.steps).powi(2)) / sum(&|_| deviation * deviation).max(f64::MIN_POSITIVE);
        independent.min(within + self.independent(sum(&|by| (by - self.steps).max(0.0).powi(2))))
    }

    /// The price of a wave of a tremor, if it is one.
    fn of_wave(&self, wave: &[Offset]) -> f64 {
        let drawn = self.of_steps(wave);
        let of_line = wave.iter().filter(|o| o.weight > LEAST_WEIGHT);
        let height = of_line.map(|o| (o.by.abs() - self.steps).max(0.0)).fold(0.0, f64::max);
        let widths = wave.iter().map(|o| o.count).sum::<f64>() * self.independent;
        if height > self.highest || widths > LONGEST { drawn } else { drawn.min((height / self.deviation).ln_1p()) }
    }
}
