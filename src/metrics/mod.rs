//! How good a trace is, against the strokes that were drawn.
//!
//! All lengths are pixels of the raster, onto which both drawings are stretched. The *pen* is the median width of the
//! true strokes. A figure that is not defined, such as a distance to nothing, is NaN.
//!
//! | figure | definition |
//! |---|---|
//! | `ink_deg`, `junction_deg` | [`AngularError`] of the field |
//! | `f1_0.5`, `f1_1`, `f1_2` | harmonic mean of the shares of both drawings' length within 0.5, 1 and 2 px of the other |
//! | `chamfer` | mean distance of the drawings' lengths to the other drawing, the mean of both ways |
//! | `junction_f1`, `endpoint_f1` | points where lines meet and where they end ([`nodes`]), paired within 1.25 pens, and at least 3 px |
//! | `integrity` | share of the true length that is followed by one path, the best for its stroke: near it and within 35 degrees of its direction |
//! | `purity` | the same the other way round: share of the traced length that keeps to one true stroke. For both, strokes of either drawing that end at one point where nothing else is are joined first |
//! | `iou` | inked pixels of both over inked pixels of either |
//! | `paths_ratio`, `segs_ratio` | traced over true number of strokes, and of pieces; a circle is four pieces |
//! | `field_s_per_mp` | seconds that the field of it took for each million pixels |
//! | `s_per_mp` | seconds that the trace took for each million pixels |
//!
//! Centrelines are compared by samples half a pixel apart. A solid region of a trace counts as ink alone, and one of
//! the truth not at all.

mod chain;
mod cloud;
mod distance;
mod field;
mod follow;
mod join;
mod matching;
mod measure;
mod nodes;
mod noding;
mod overlap;
#[cfg(test)]
mod tests;

pub use field::AngularError;
#[cfg(feature = "train")]
pub(crate) use field::{pair, single};
pub use measure::{Measurement, measure};
pub use nodes::{Nodes, nodes};

use crate::drawing::Drawing;
use crate::error::{Error, Result};
use crate::field::PolyVectorField;
use crate::load::{LoadOptions, load_bytes};
use crate::raster::Mask;
use chain::{Chain, chains};
use cloud::Cloud;
use distance::Distances;
use follow::follow;
use join::joined;
use matching::f1;

/// The figures of a trace.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct LineScore {
    /// Length found within 0.5, 1 and 2 px.
    pub f1: [f64; 3],
    /// Mean distance in pixels.
    pub chamfer: f64,
    /// Points where lines meet.
    pub junction_f1: f64,
    /// Points where lines end.
    pub endpoint_f1: f64,
    /// Whether true strokes stay whole.
    pub integrity: f64,
    /// Whether traced strokes keep to one true stroke.
    pub purity: f64,
    /// Overlap of the ink.
    pub iou: f64,
    /// Traced over true number of strokes.
    pub paths_ratio: f64,
    /// Traced over true number of pieces.
    pub segs_ratio: f64,
}

/// Strokes that were drawn, on the raster that they were drawn to.
pub struct Truth {
    size: (usize, usize),
    chains: Vec<Chain>,
    cloud: Cloud,
    pen: f64,
    nodes: Nodes,
    ink: Mask,
}

impl Truth {
    /// The truth of a raster of `size` pixels; `None` where no stroke has any length.
    pub fn new(drawing: &Drawing, size: (usize, usize)) -> Option<Self> {
        let chains = chains(drawing, size);
        let cloud = Cloud::new(&chains);
        if cloud.length() == 0.0 {
            return None;
        }
        let pen = median(chains.iter().map(|c| c.width).collect());
        let nodes = nodes::of_chains(&chains, pen);
        let ink = overlap::ink(&chains, size);
        Some(Self { size, chains, cloud, pen, nodes, ink })
    }

    /// The median width of the strokes in pixels.
    pub fn pen(&self) -> f64 {
        self.pen
    }

    /// How good a trace is, as SVG text: what others see of it, roundings included. One without strokes has every
    /// share 0 and no distance.
    ///
    /// # Errors
    /// [`crate::Error::Decode`] where it is no SVG.
    pub fn score(&self, svg: &str) -> Result<LineScore> {
        let traced = Traced::read(svg, self.size)?;
        let pieces = |chains: &[Chain]| chains.iter().map(|c| c.pieces).sum::<usize>() as f64;
        let mut score = LineScore {
            f1: [0.0; 3],
            chamfer: f64::NAN,
            junction_f1: 0.0,
            endpoint_f1: 0.0,
            integrity: 0.0,
            purity: 0.0,
            iou: overlap::iou(&self.ink, &traced.ink),
            paths_ratio: traced.chains.len() as f64 / self.chains.len() as f64,
            segs_ratio: pieces(&traced.chains) / pieces(&self.chains),
        };
        if !traced.chains.is_empty() {
            let cloud = Cloud::new(&traced.chains);
            let distances = Distances::between(&self.cloud, &cloud);
            let nodes = nodes::of_chains(&traced.chains, self.pen);
            let radius = (1.25 * self.pen).max(3.0);
            score.f1 = [0.5, 1.0, 2.0].map(|reach| distances.f1(reach));
            score.chamfer = distances.chamfer();
            score.junction_f1 = f1(&self.nodes.junctions, &nodes.junctions, radius);
            score.endpoint_f1 = f1(&self.nodes.ends, &nodes.ends, radius);
            let [truth, trace] = [&self.chains, &traced.chains].map(|chains| Cloud::new(&joined(chains, self.pen)));
            score.integrity = follow(&truth, &trace, self.pen);
            score.purity = follow(&trace, &truth, self.pen);
        }
        Ok(score)
    }

    /// How far the directions of a field are from those of the strokes.
    ///
    /// # Errors
    /// [`crate::Error::FieldSize`] when the field is not of the raster's size.
    pub fn angular_error(&self, field: &PolyVectorField) -> Result<AngularError> {
        field::angular_error(self, field)
    }
}

/// A trace on the raster of its truth.
struct Traced {
    chains: Vec<Chain>,
    ink: Mask,
}

impl Traced {
    /// Reads SVG text at the size of a raster.
    fn read(svg: &str, (width, height): (usize, usize)) -> Result<Self> {
        // The raster itself was bearable.
        let size = u32::try_from(width.max(height)).ok();
        let options = LoadOptions { size, max_pixels: u64::MAX, ..LoadOptions::default() };
        let input = match load_bytes("trace", svg.as_bytes(), &options) {
            Err(Error::NothingVisible { .. }) => {
                return Ok(Self { chains: Vec::new(), ink: Mask::filled(width, height, false) });
            }
            input => input?,
        };
        let chains = input.drawing.map_or_else(Vec::new, |d| chains(&d, (width, height)));
        Ok(Self { chains, ink: overlap::dark(&input.scan.gray, (width, height)) })
    }
}

/// The mean of the two middle values where there is no middle one.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let n = values.len();
    0.5 * (values[(n - 1) / 2] + values[n / 2])
}
