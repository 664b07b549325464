//! A [`FieldEstimator`] that finds the 2-PolyVector field by minimising a quadratic energy over the ink.
//!
//! This is the field of Bessmeltsev & Solomon, *Vectorization of Line Drawings via PolyVector Fields* (2019), section 4.
//! Unknown at every ink pixel are the complex `c0`, `c2` of `f(z) = z^4 + c2 z^2 + c0`, whose roots are the two
//! directions. The energy is
//!
//! ```text
//! E =     sum_edges  w |f(tau)|^2                              alignment
//!   + b   sum_links  |c0_i - c0_j|^2 + |c2_i - c2_j|^2         smoothness
//!   + a   sum_edges  w |f(i tau)|^2                            the normal as second root
//! ```
//!
//! - *Alignment*: the tangent `tau` of each edge, that is the gradient turned by 90 degrees, is to be a root. The
//!   weight `w` is the squared length of the gradient; its mean over the sides of each piece of ink is scaled to 1, so
//!   that pale lines are followed as closely as black ones.
//! - *Smoothness*: between pixels at each other's sides and both on the ink. It carries the directions into the middle of
//!   a line, where there is no gradient, and the directions of both lines into their crossing.
//! - *The normal*: where only one direction is seen, the other is the normal, as in the authors' published program. On an
//!   edge, the first and the third term together are smallest at `c2 = 0`, `c0 = -tau^4`. The weight `a` is small: enough
//!   that the scatter of edge directions along one line is not taken for two shallow directions, no more, since it also
//!   acts at crossings.
//!
//! `E` is quadratic, so one linear system gives its minimum, and pieces of ink that do not touch are systems of their
//! own, solved in parallel. Weighting the edges again by how well the solution fits them, and solving again, was tried:
//! it takes sharp curves for outliers and made the field worse.
//!
//! The solver is conjugate gradients of our own with an incomplete factorisation of the five-point stencil as
//! preconditioner. Some tens of iterations of linear cost do; a sparse Cholesky library would add a large dependency for
//! a matrix that has two numbers beside its diagonal. A piece is solved in one thread and in one order, so the result
//! does not depend on the number of threads.

mod components;
mod gradient;
mod solve;
mod system;

use components::{Component, components};
use fieldtrace::clean::LineImage;
use fieldtrace::estimate::FieldEstimator;
use fieldtrace::field::PolyVectorField;
use fieldtrace::raster::Raster;
use fieldtrace::{Error, Result};
use gradient::{Moments, SIDES, moments};
use num_complex::{Complex32, Complex64};
use rayon::prelude::*;
use system::{Pair, System, Weights};

/// Estimates fields by minimising the energy.
///
/// Weights are relative to the alignment term, whose mean weight is 1 at each side of an ink pixel that faces paper.
/// The defaults were chosen on drawings made at random: lines, curves and circles, 2 to 10 pixels wide.
#[derive(Clone, Debug, PartialEq)]
pub struct EnergyEstimator {
    /// Weight of the smoothness term on an image without grain, over 0. The term is the same at any line width: it
    /// sums squared differences over an area.
    pub smoothness: f64,
    /// How much grain along the lines adds to the smoothness: it is multiplied by `1 + grain * along`, with the mean
    /// [`LineImage::noise`], where that says that ink is unsure.
    pub grain: f64,
    /// Weight of the term that makes the normal the second direction where only one is seen, over 0 and up to 1.
    pub normal: f64,
    /// Residual at which the solver stops, as a share of the right-hand side.
    pub accuracy: f64,
    /// Most iterations of the solver.
    pub max_iterations: usize,
}

impl Default for EnergyEstimator {
    fn default() -> Self {
        Self { smoothness: 6.0, grain: 160.0, normal: 0.01, accuracy: 1e-4, max_iterations: 2000 }
    }
}

/// Confidence where there is no direction to be seen, such as in the middle of a dot.
const LEAST_CONFIDENCE: f32 = 0.05;

impl FieldEstimator for EnergyEstimator {
    fn name(&self) -> &str {
        "energy"
    }

    /// The field on the mask. The confidence is `sqrt |c0|`, the geometric mean of the moduli of the roots' squares: 1
    /// where the edges around agree, less where the smoothness had to reconcile them, and never under 0.05.
    ///
    /// # Errors
    /// [`Error::Estimate`] where a weight is out of its range.
    fn estimate(&self, image: &LineImage) -> Result<PolyVectorField> {
        self.validate()?;
        let pieces = components(&image.mask);
        let solved: Vec<Vec<Pair>> = pieces.par_iter().map(|piece| self.solve(image, piece)).collect();
        assemble(image.mask.size(), &pieces, &solved)
    }
}

impl EnergyEstimator {
    fn validate(&self) -> Result<()> {
        let positive = |x: f64| x.is_finite() && x > 0.0;
        let weights = positive(self.smoothness) && positive(self.accuracy) && positive(self.normal);
        if weights && self.normal <= 1.0 && self.grain.is_finite() && self.grain >= 0.0 {
            return Ok(());
        }
        Err(Error::Estimate { estimator: "energy".into(), reason: format!("a weight is out of its range: {self:?}") })
    }

    /// `(c2, c0)` at each pixel of one piece of ink.
    fn solve(&self, image: &LineImage, piece: &Component) -> Vec<Pair> {
        let noise = image.noise.mean();
        let weights = Weights {
            smoothness: self.smoothness * (1.0 + self.grain * noise.grain() * noise.along),
            normal: self.normal,
        };
        let system = System::new(piece, &edges(image, piece), &weights);
        solve::solve(&system, self.accuracy, self.max_iterations).0
    }
}

/// The edges at each pixel of a piece, their mean weight 1 at each side that faces paper.
fn edges(image: &LineImage, piece: &Component) -> Vec<Moments> {
    let mut edges: Vec<_> = piece.pixels.iter().map(|&(x, y)| moments(image, x as usize, y as usize)).collect();
    let is_paper = |x: i64, y: i64| image.mask.get(x, y) == Some(false);
    let facing =
        |&(x, y): &(u32, u32)| SIDES.iter().filter(|(dx, dy)| is_paper(i64::from(x) + dx, i64::from(y) + dy)).count();
    let sides: usize = piece.pixels.iter().map(facing).sum();
    let total: f64 = edges.iter().map(|m| m.m0).sum();
    if sides > 0 && total > 0.0 {
        edges.iter_mut().for_each(|m| *m = *m * (sides as f64 / total));
    }
    edges
}

/// The field of all pieces. A pixel without a direction gets the axes.
fn assemble((width, height): (usize, usize), pieces: &[Component], solved: &[Vec<Pair>]) -> Result<PolyVectorField> {
    let zero = Complex32::new(0.0, 0.0);
    let (mut c0, mut c2) = (Raster::filled(width, height, zero), Raster::filled(width, height, zero));
    let mut confidence = Raster::filled(width, height, 0.0);
    let narrow = |z: Complex64| Complex32::new(z.re as f32, z.im as f32);
    for (piece, solved) in pieces.iter().zip(solved) {
        for (&(x, y), &[quadratic, constant]) in piece.pixels.iter().zip(solved) {
            let pixel = (x as usize, y as usize);
            let seen = quadratic.norm() + constant.norm() > 1e-2;
            (c2[pixel], c0[pixel]) =
                if seen { (narrow(quadratic), narrow(constant)) } else { (zero, Complex32::new(-1.0, 0.0)) };
            let strength = if seen { constant.norm().sqrt() as f32 } else { 0.0 };
            confidence[pixel] = strength.clamp(LEAST_CONFIDENCE, 1.0);
        }
    }
    PolyVectorField::new(c0, c2, confidence)
}
