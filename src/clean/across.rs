//! The middles of lines, and all the ink that lies across them.
//!
//! What is measured at one pixel of a line depends on where its channels were sampled; their sums across the line do not.

use super::smooth;
use crate::raster::Raster;

/// Ink is looked at through a Gaussian of this many pixels, so that a lone pixel's noise does not count.
const BLUR: f32 = 0.8;
/// Lines up to about twice as many pixels wide are summed across; what is broader has a middle that no edge reaches.
const REACH: usize = 8;
/// The middle of a line has at least this share of the most ink across it,
const MIDDLE: f32 = 0.8;
/// its foot at most this share of what its middle has,
const FOOT: f32 = 0.08;
/// and between it and the next line there is less than this share, from which ink rises by at least the other.
const VALLEY: f32 = 0.6;
const RISE: f32 = 0.1;
/// Where ink of less than [`VALLEY`] is the same to within this share for so many pixels more, the line lies on a tinted area.
const EVEN: f32 = 0.01;
const EVEN_FOR: i64 = 3;
/// So many pixels around the middle of broad ink there is no less than [`MIDDLE`] of it.
const AROUND: i64 = 2;
/// Middles of lines within so many pixels, along and across, are looked at together: several times what a channel is off.
const TOGETHER: usize = 7;
/// The flanks of a line reach so many pixels beyond its middle.
const FLANKS: usize = 4;

/// The ways across a pixel.
const WAYS: [(i64, i64); 4] = [(1, 0), (0, 1), (1, 1), (1, -1)];

/// The middles of lines: for each pixel what is inked across it.
pub(super) struct Cores {
    /// In the middle of lines, and on their flanks where they were [spread](Self::spread), the absorbance of each channel
    /// across the line as a share of the largest; 0 elsewhere.
    pub tone: Raster<[f32; 3]>,
    /// Strength of the ink, the largest of its channels, without single pixels' noise.
    strength: Raster<f32>,
}

impl Cores {
    /// Finds ink stronger than `least` that is the middle of a line, from the absorbance of the channels.
    pub fn of(absorbance: &[Raster<f32>; 3], least: f32) -> Self {
        let channels = absorbance.each_ref().map(|channel| smooth(channel.clone(), BLUR));
        let (width, height) = channels[0].size();
        let at = |p: (usize, usize)| [0, 1, 2].map(|c| channels[c][p]);
        let strength = Raster::from_rows(width, height, 0.0, |y, row| {
            row.iter_mut().enumerate().for_each(|(x, s)| *s = at((x, y)).into_iter().fold(0.0, f32::max));
        });
        let tone = Raster::from_rows(width, height, [0.0; 3], |y, row| {
            for (x, tone) in row.iter_mut().enumerate().filter(|(x, _)| strength[(*x, y)] > least) {
                let sum = match shortest(&strength, (x as i64, y as i64)) {
                    Some(run) if run.most * MIDDLE <= strength[(x, y)] => {
                        let ground = run.ground(&strength).map_or([0.0; 3], at);
                        run.pixels().fold([0.0; 3], |sum, p| {
                            let here = at(p);
                            [0, 1, 2].map(|c| sum[c] + here[c] - ground[c])
                        })
                    }
                    None if is_broad(&strength, (x as i64, y as i64)) => at((x, y)),
                    _ => continue,
                };
                *tone = scaled(sum);
            }
        });
        Self { tone, strength }
    }

    /// The tone of all middles of lines around a pixel.
    ///
    /// The end of a line, or a line beside others, may be cut where one channel goes on: there its sum has a hue that is no
    /// ink's, but not the lines around it.
    pub fn around(&self, x: usize, y: usize) -> [f32; 3] {
        let rows = y.saturating_sub(TOGETHER)..(y + TOGETHER + 1).min(self.tone.height());
        let columns = x.saturating_sub(TOGETHER)..(x + TOGETHER + 1).min(self.tone.width());
        let tones = rows.flat_map(|y| &self.tone.row(y)[columns.clone()]);
        scaled(tones.fold([0.0; 3], |sum, tone| [0, 1, 2].map(|c| sum[c] + tone[c])))
    }

    /// Gives the flanks of lines the tone of the nearest middle, of two as near that with more ink.
    pub fn spread(&mut self) {
        for _ in 0..FLANKS {
            let (before, strength) = (&self.tone, &self.strength);
            self.tone = Raster::from_rows(before.width(), before.height(), [0.0; 3], |y, row| {
                for (x, (to, &own)) in row.iter_mut().zip(before.row(y)).enumerate() {
                    let around = || (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (x as i64 + dx, y as i64 + dy)));
                    let known = || {
                        around()
                            .filter(|&(i, j)| before.get(i, j).is_some_and(is_known))
                            .map(|(i, j)| (i as usize, j as usize))
                    };
                    *to = match is_known(own) || strength[(x, y)] <= 0.0 {
                        true => own,
                        false => {
                            known().max_by(|&a, &b| strength[a].total_cmp(&strength[b])).map_or(own, |p| before[p])
                        }
                    };
                }
            });
        }
    }
}

/// Channels as shares of the largest.
fn scaled(sum: [f32; 3]) -> [f32; 3] {
    let most = sum.into_iter().fold(f32::MIN_POSITIVE, f32::max);
    sum.map(|channel| channel / most)
}

/// Whether a pixel's tone was measured.
pub(super) fn is_known(tone: [f32; 3]) -> bool {
    tone != [0.0; 3]
}

/// The ink across a line.
struct Run {
    at: (i64, i64),
    way: (i64, i64),
    /// Pixels to both sides.
    sides: [i64; 2],
    /// The strongest ink.
    most: f32,
}

impl Run {
    fn length(&self) -> f64 {
        (self.sides[0] + self.sides[1]) as f64 * f64::from((self.way.0.abs() + self.way.1.abs()) as i32).sqrt()
    }

    /// The end with less ink, where the line lies on a tinted area.
    fn ground(&self, strength: &Raster<f32>) -> Option<(usize, usize)> {
        let ends = [self.pixels().next()?, self.pixels().last()?];
        let tinted = ends.iter().all(|&end| strength[end] >= FOOT * self.most);
        ends.into_iter().filter(|_| tinted).min_by(|&a, &b| strength[a].total_cmp(&strength[b]))
    }

    fn pixels(&self) -> impl Iterator<Item = (usize, usize)> {
        let ((x, y), (dx, dy)) = (self.at, self.way);
        (-self.sides[0]..=self.sides[1]).map(move |k| ((x + k * dx) as usize, (y + k * dy) as usize))
    }
}

/// The shortest way across the ink at a pixel; `None` where it ends nowhere near to both sides.
fn shortest(strength: &Raster<f32>, at: (i64, i64)) -> Option<Run> {
    let runs = WAYS.into_iter().filter_map(|way| {
        let (before, most_before) = foot(strength, at, (-way.0, -way.1))?;
        let (after, most_after) = foot(strength, at, way)?;
        Some(Run { at, way, sides: [before, after], most: most_before.max(most_after) })
    });
    runs.min_by(|a, b| a.length().total_cmp(&b.length()))
}

/// How many pixels one way the ink ends or other ink begins, and the strongest ink up to there; `None` where that is out of
/// reach.
fn foot(strength: &Raster<f32>, (x, y): (i64, i64), (dx, dy): (i64, i64)) -> Option<(i64, f32)> {
    let own = strength[(x as usize, y as usize)];
    let (mut most, mut least, mut lowest) = (own, own, 0);
    for k in 1..=REACH as i64 {
        let Some(ink) = strength.get(x + k * dx, y + k * dy) else { return Some((k - 1, most)) };
        if ink < FOOT * own {
            return Some((k, most));
        }
        if least < VALLEY * own && ink > least + RISE * own {
            return Some((lowest, most));
        }
        if ink < least - EVEN * own {
            (least, lowest) = (ink, k);
        }
        if least < VALLEY * own && k - lowest >= EVEN_FOR {
            return Some((lowest, most));
        }
        most = most.max(ink);
    }
    None
}

/// Whether the ink around a pixel that no line's edge is near is no less than there.
fn is_broad(strength: &Raster<f32>, (x, y): (i64, i64)) -> bool {
    let least = MIDDLE * strength[(x as usize, y as usize)];
    WAYS.into_iter()
        .flat_map(|(dx, dy)| [(dx, dy), (-dx, -dy)])
        .all(|(dx, dy)| strength.get(x + AROUND * dx, y + AROUND * dy).is_none_or(|ink| ink >= least))
}
