//! The shape of a network.

use super::features::Input;
use serde::{Deserialize, Serialize};

/// Added to the variance in a batch norm before its root.
pub(crate) const EPSILON: f64 = 1e-5;

/// What a network says of each pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Default)]
#[serde(rename_all = "lowercase")]
pub enum Output {
    /// `Re c0`, `Im c0`, `Re c2`, `Im c2` of a 2-PolyVector field.
    #[default]
    Field,
    /// The log-odds of ink.
    Ink,
}

impl Output {
    /// Numbers a pixel.
    pub fn channels(self) -> usize {
        match self {
            Self::Field => 4,
            Self::Ink => 1,
        }
    }
}

/// Shape of a network.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct UNetConfig {
    /// Channels of the first level; each level down has twice as many.
    pub width: usize,
    /// Most channels of any level; `None` is no limit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub widest: Option<usize>,
    /// Number of poolings.
    pub levels: usize,
    /// Side of the square of pixels that the first level takes as one, 1 or 2: input pixels become channels, and
    /// the head gives each its own coefficients. 1 is the paper's network; 2 costs a quarter.
    pub patch: usize,
    /// What the network is shown.
    pub input: Input,
    /// What it says; ink is seen in colour, and a field in ink.
    pub output: Output,
    /// Share of the newest batch in the norms' running statistics. Crops differ much from one another, so the
    /// default averages over many batches; 1 fits training on one image.
    pub momentum: f64,
}

impl Default for UNetConfig {
    fn default() -> Self {
        let (input, output) = (Input::Tensor, Output::Field);
        Self { width: 16, widest: None, levels: 3, patch: 2, input, output, momentum: 0.03 }
    }
}

impl UNetConfig {
    /// The network of the paper.
    pub fn paper() -> Self {
        Self { width: 16, levels: 4, patch: 1, input: Input::Ink, ..Self::default() }
    }

    /// The network that finds ink on a page.
    pub fn ink() -> Self {
        let (input, output) = (Input::Color, Output::Ink);
        Self { width: 12, widest: Some(48), levels: 4, patch: 2, input, output, ..Self::default() }
    }

    /// Whether there can be such a network.
    pub fn is_sound(&self) -> bool {
        let fits = (self.input == Input::Color) == (self.output == Output::Ink);
        let is_width = |n: usize| (1..=1024).contains(&n);
        is_width(self.width)
            && self.widest.is_none_or(is_width)
            && self.levels <= 8
            && (1..=2).contains(&self.patch)
            && fits
    }

    /// Image sides have to be multiples of this many pixels.
    pub fn multiple(&self) -> usize {
        self.patch << self.levels
    }

    /// Pixels that the first level takes as one.
    pub(crate) fn cells(&self) -> usize {
        self.patch * self.patch
    }

    /// Channels of a level, counted from full resolution.
    pub(crate) fn channels(&self, level: usize) -> usize {
        (self.width << level).min(self.widest.unwrap_or(usize::MAX))
    }

    /// Numbers that the head gives for each pixel of the first level.
    pub(crate) fn outputs(&self) -> usize {
        self.output.channels() * self.cells()
    }

    /// Input and output channels of the encoder's blocks, full resolution first.
    pub(crate) fn down(&self) -> Vec<[usize; 2]> {
        let first = [self.input.channels() * self.cells(), self.channels(0)];
        let lower = (1..=self.levels).map(|l| [self.channels(l - 1), self.channels(l)]);
        std::iter::once(first).chain(lower).collect()
    }

    /// Channels that the decoder's blocks take from below and from the skip, and give, lowest resolution first.
    pub(crate) fn up(&self) -> Vec<[usize; 3]> {
        (0..self.levels).rev().map(|l| [self.channels(l + 1), self.channels(l), self.channels(l)]).collect()
    }
}
