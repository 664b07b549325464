//! The shape of a network.

use super::features::Input;
use serde::{Deserialize, Serialize};

/// Added to the variance in a batch norm before its root.
pub(crate) const EPSILON: f64 = 1e-5;

/// Shape of a network.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct UNetConfig {
    /// Channels of the first level; each level down has twice as many.
    pub width: usize,
    /// Number of poolings.
    pub levels: usize,
    /// Side of the square of pixels that the first level takes as one, 1 or 2: input pixels become channels, and
    /// the head gives each its own coefficients. 1 is the paper's network; 2 costs a quarter.
    pub patch: usize,
    /// What the network is shown.
    pub input: Input,
    /// Share of the newest batch in the norms' running statistics. Crops differ much from one another, so the
    /// default averages over many batches; 1 fits training on one image.
    pub momentum: f64,
}

impl Default for UNetConfig {
    fn default() -> Self {
        Self { width: 16, levels: 3, patch: 2, input: Input::Tensor, momentum: 0.03 }
    }
}

impl UNetConfig {
    /// The network of the paper.
    pub fn paper() -> Self {
        Self { width: 16, levels: 4, patch: 1, input: Input::Ink, ..Self::default() }
    }

    /// Whether there can be such a network.
    pub fn is_sound(&self) -> bool {
        (1..=1024).contains(&self.width) && self.levels <= 8 && (1..=2).contains(&self.patch)
    }

    /// Image sides have to be multiples of this many pixels.
    pub fn multiple(&self) -> usize {
        self.patch << self.levels
    }

    /// Pixels that the first level takes as one.
    pub(crate) fn cells(&self) -> usize {
        self.patch * self.patch
    }

    /// Input and output channels of the encoder's blocks, full resolution first.
    pub(crate) fn down(&self) -> Vec<[usize; 2]> {
        let first = [self.input.channels() * self.cells(), self.width];
        let lower = (1..=self.levels).map(|l| [self.width << (l - 1), self.width << l]);
        std::iter::once(first).chain(lower).collect()
    }

    /// Channels that the decoder's blocks take from below and from the skip, and give, lowest resolution first.
    pub(crate) fn up(&self) -> Vec<[usize; 3]> {
        (0..self.levels).rev().map(|l| [self.width << (l + 1), self.width << l, self.width << l]).collect()
    }
}
