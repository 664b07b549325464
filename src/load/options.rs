//! What a reader of inputs may be told.

use super::{resolution, undecodable};
use crate::error::{Error, Result};

/// What a reader of inputs may be told.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default, rename_all = "kebab-case"))]
#[non_exhaustive]
pub struct LoadOptions {
    /// Most pixels that an image may have, before and after its pixels are made square; checked against the header,
    /// before anything is decoded.
    pub max_pixels: u64,
    /// Dots per inch of the upright image, in place of what the input says. An SVG or a PDF is rendered at this
    /// resolution (the finer, where two are given) unless `size` is; without either, a PDF at 300 and an SVG at 96,
    /// which is one pixel for one CSS pixel, or as much more as makes it 512 pixels long.
    pub dpi: Option<Dpi>,
    /// Longer side in pixels of the rendering of an SVG or a PDF; raster inputs keep their size.
    pub size: Option<u32>,
    /// The page to read, counted from 1. Without it [`load`](super::load) refuses an input of several.
    pub page: Option<usize>,
    /// The part to read, as X, Y, width and height in pixels of the upright image (for an SVG or a PDF, of its
    /// rendering), before pixels are made square: what a viewer shows.
    pub crop: Option<[u32; 4]>,
}

impl Default for LoadOptions {
    fn default() -> Self {
        Self { max_pixels: 64_000_000, dpi: None, size: None, page: None, crop: None }
    }
}

/// A resolution in dots per inch.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
pub struct Dpi {
    /// Across the page.
    pub x: f64,
    /// Down the page.
    pub y: f64,
}

impl Dpi {
    /// The larger of the two.
    pub fn finer(self) -> f64 {
        self.x.max(self.y)
    }
}

/// The same both ways.
impl From<f64> for Dpi {
    fn from(dpi: f64) -> Self {
        Self { x: dpi, y: dpi }
    }
}

impl LoadOptions {
    /// The options with some of them set: `LoadOptions::default().with(|o| o.dpi = Some(300.0.into()))`.
    #[must_use]
    pub fn with(mut self, set: impl FnOnce(&mut Self)) -> Self {
        set(&mut self);
        self
    }

    /// Checks every range.
    ///
    /// # Errors
    /// [`Error::Option`] names the first option that is out of its range.
    pub fn validate(&self) -> Result<()> {
        let error = |option, reason: String| Err(Error::Option { option, reason });
        let wrong = self.dpi.and_then(|dpi| [dpi.x, dpi.y].into_iter().find(|&dpi| !resolution::plausible(dpi)));
        if let Some(dpi) = wrong {
            return error("dpi", format!("{dpi} is not between 1 and 100000"));
        }
        match self {
            Self { size: Some(0), .. } => error("size", "0 is not a size in pixels".into()),
            Self { page: Some(0), .. } => error("page", "pages are counted from 1".into()),
            Self { crop: Some([_, _, 0, _] | [_, _, _, 0]), .. } => error("crop", "the part has no pixels".into()),
            _ => Ok(()),
        }
    }

    /// Checks a claimed size in pixels.
    pub(super) fn check_size(&self, input: &str, width: u64, height: u64) -> Result<()> {
        if width == 0 || height == 0 {
            return Err(undecodable(input, "the image has no pixels"));
        }
        if width.saturating_mul(height) > self.max_pixels {
            return Err(Error::TooLarge { input: input.into(), width, height, limit: self.max_pixels });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_out_of_range_are_named() {
        let all = LoadOptions::default;
        let wrong = |options: LoadOptions| options.validate().unwrap_err().to_string();
        for dpi in [0.0, -300.0, f64::NAN, f64::INFINITY] {
            assert!(wrong(LoadOptions { dpi: Some(dpi.into()), ..all() }).starts_with("dpi: "));
            assert!(wrong(LoadOptions { dpi: Some(Dpi { x: 300.0, y: dpi }), ..all() }).starts_with("dpi: "));
        }
        assert!(wrong(LoadOptions { size: Some(0), ..all() }).starts_with("size: "));
        assert!(wrong(LoadOptions { page: Some(0), ..all() }).starts_with("page: "));
        assert!(wrong(LoadOptions { crop: Some([1, 2, 0, 4]), ..all() }).starts_with("crop: "));
        assert!(all().validate().is_ok());
    }

    #[test]
    fn sizes_are_checked_without_overflow() {
        let options = LoadOptions { max_pixels: 100, ..LoadOptions::default() };
        assert!(options.check_size("a", 10, 10).is_ok());
        assert!(matches!(options.check_size("a", 10, 11), Err(Error::TooLarge { .. })));
        assert!(matches!(options.check_size("a", u64::MAX, u64::MAX), Err(Error::TooLarge { .. })));
        assert!(matches!(options.check_size("a", 0, 5), Err(Error::Decode { .. })));
    }
}
