//! From a field and the ink to streamlines.
//!
//! Direction comes from the field, position from the ink: a walk follows the root nearest to its heading and is
//! pulled back to the middle of the ink at each step, except inside junctions, where the cross profile says
//! nothing about the line that is being followed. A streamline covers ink for its own direction only, so others
//! may cross it but not run along it (Bessmeltsev & Solomon 2019, section 5, with a seed order of our own). Long straight
//! lines that others end at, and circles that others touch, cover their ink before any walk begins. Ink that no streamline
//! covers in the end gets seeds of its own, so that nothing is lost.

mod coverage;
pub(crate) mod heading;
mod islands;
mod relax;
mod ring;
mod seeds;
mod straight;
mod walk;

pub(crate) use heading::{Tail, angle_between};

use crate::cancel::Cancel;
use crate::clean::LineImage;
use crate::error::{Error, Result};
use crate::field::FrameField;
use coverage::Coverage;
use islands::Island;
use kurbo::Point;
use rayon::prelude::*;
use ring::Rings;
use seeds::Seed;
use straight::Straights;
use walk::Walker;

/// Why a walk stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Stop {
    /// The ink ended.
    InkEnd,
    /// It ran into ink that another streamline, or an earlier part of its own, covers in the same direction.
    Merged,
    /// The line left the image.
    Border,
    /// The line ran into a solid region.
    Solid,
}

/// A traced centreline: points about half a pixel apart.
#[derive(Clone, Debug, PartialEq)]
pub struct Streamline {
    /// The points, in pixels of the line image. A closed streamline does not repeat its first point.
    pub points: Vec<Point>,
    /// Measured ink width at each point, in pixels; NaN inside junctions, where it cannot be measured.
    pub widths: Vec<f64>,
    /// Whether the last point joins the first.
    pub closed: bool,
    /// Why the walk stopped at the first and at the last point; of no meaning when closed.
    pub stops: [Stop; 2],
}

impl Streamline {
    /// Checks what the later stages rely on, after somebody else may have changed it.
    ///
    /// # Errors
    /// [`Error::Broken`].
    pub(crate) fn validate(&self) -> Result<()> {
        let reason = match (self.points.len(), self.widths.len()) {
            (points, widths) if points != widths => format!("{points} points have {widths} widths"),
            (0, _) => "a streamline has no points".into(),
            _ if !self.points.iter().all(|p| p.is_finite()) => "a point is not finite".into(),
            _ => return Ok(()),
        };
        Err(Error::Broken { stage: "streamline", reason })
    }
}

/// Distance between points, in pixels.
pub(crate) const STEP: f64 = 0.5;

/// Traces all ink along the field, most certain seeds first.
///
/// # Errors
/// The token's.
pub fn trace(image: &LineImage, frames: &FrameField, cancel: &Cancel) -> Result<Vec<Streamline>> {
    let ink_pixels = image.mask.count();
    let trace = |island: &Island| trace_island(image, frames, island, ink_pixels, cancel);
    let islands = islands::islands(image, &seeds::seeds(image, frames));
    let traced: Vec<Vec<(usize, Streamline)>> = islands.par_iter().map(trace).collect::<Result<_>>()?;
    let mut streamlines: Vec<(usize, Streamline)> = traced.into_iter().flatten().collect();
    streamlines.sort_by_key(|(rank, _)| *rank);
    Ok(streamlines.into_iter().map(|(_, streamline)| streamline).collect())
}

/// The streamlines of an island, each with its seed's rank; those of ink that was left over come last.
fn trace_island(
    image: &LineImage,
    frames: &FrameField,
    island: &Island,
    ink_pixels: usize,
    cancel: &Cancel,
) -> Result<Vec<(usize, Streamline)>> {
    let coverage = Coverage::new(image, island.bounds, ink_pixels);
    let mut tracing = Tracing { image, frames, coverage, straights: Straights::default(), streamlines: Vec::new() };
    tracing.lay_straights(&island.seeds, cancel)?;
    tracing.lay_rings(&island.seeds, cancel)?;
    for id in 0..tracing.straights.len() {
        cancel.check()?;
        tracing.extend(id);
    }
    for (rank, seed) in &island.seeds {
        cancel.check()?;
        tracing.sow(*rank, seed);
    }
    for part in &island.parts {
        for seed in seeds::leftover(image, frames, &tracing.coverage, *part) {
            cancel.check()?;
            tracing.sow(usize::MAX, &seed);
        }
    }
    Ok(tracing.streamlines)
}

/// An island while it is traced.
struct Tracing<'a> {
    image: &'a LineImage,
    frames: &'a FrameField,
    coverage: Coverage<'a>,
    straights: Straights,
    streamlines: Vec<(usize, Streamline)>,
}

impl Tracing<'_> {
    /// Lays the long straight lines through seeds over their ink, where it is not covered yet.
    fn lay_straights(&mut self, seeds: &[(usize, Seed)], cancel: &Cancel) -> Result<()> {
        for (rank, seed) in seeds {
            cancel.check()?;
            if !self.coverage.is_painted(seed.point) {
                self.straights.lay(self.image, &mut self.coverage, *rank, seed);
            }
        }
        Ok(())
    }

    /// Traces the circles through seeds that other lines touch.
    fn lay_rings(&mut self, seeds: &[(usize, Seed)], cancel: &Cancel) -> Result<()> {
        let mut rings = Rings::default();
        for (rank, seed) in seeds {
            cancel.check()?;
            if self.coverage.is_painted(seed.point) {
                continue;
            }
            let Some(ring) = rings.find(self.image, self.frames, seed) else { continue };
            let line = ring.streamline(self.image);
            let streamline = (self.straights.len() + self.streamlines.len()) as u32;
            self.coverage.lay(streamline, &line.points, &line.widths, |p| ring.heading(p));
            self.streamlines.push((*rank, line));
        }
        Ok(())
    }

    /// Traces the line that a straight line is part of, unless that is traced already.
    fn extend(&mut self, id: usize) {
        let Some((rank, straight)) = self.straights.take(id) else { return };
        let (streamline, _) = self.walked(id, |walker| walker.extend(&straight));
        self.streamlines.push((rank, streamline));
    }

    /// A line as it was walked, settled on its ink, and how many pixels of that are new.
    fn walked(&mut self, id: usize, walk: impl FnOnce(&mut Walker) -> Streamline) -> (Streamline, usize) {
        let mut walker = Walker::new(self.image, self.frames, &mut self.coverage, &mut self.straights, id as u32);
        let mut streamline = walk(&mut walker);
        let width = walker.width();
        relax::relax(self.image, &mut streamline, width);
        let fresh = self.coverage.paint(&streamline.points, &streamline.widths);
        (streamline, fresh)
    }

    /// Traces the line through a seed, unless its ink is covered.
    fn sow(&mut self, rank: usize, seed: &Seed) {
        if self.coverage.is_painted(seed.point) {
            return;
        }
        let before = self.coverage.len();
        let id = self.straights.len() + self.streamlines.len();
        let (streamline, fresh) = self.walked(id, |walker| walker.trace(seed));
        // Less ink of its own than half a dot: a bump on another line's edge.
        if (fresh as f64) < 0.4 * self.image.line_width * self.image.line_width {
            self.coverage.truncate(before);
        } else {
            self.streamlines.push((rank, streamline));
        }
    }
}
