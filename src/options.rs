//! The options of a trace, the same in the library and on the command line.

use crate::drawing::Color;
use crate::error::{Error, Result};

/// How ink is told from paper.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Threshold {
    /// Chosen from the image, locally where the light is uneven.
    #[default]
    Auto,
    /// A fixed darkness in `(0, 1)`: 0 is paper, 1 is black.
    Fixed(f64),
}

/// How the ink of the drawing is told from everything else on the page.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Ink {
    /// As with [`Ink::Threshold`] on a clean render, whose paper has nothing else on it, and where both tell the same ink; else
    /// as with [`Ink::Learned`].
    #[default]
    Auto,
    /// By a network that has seen shadows, stains, ruled paper, grain and much else that is not ink.
    Learned,
    /// By darkness alone.
    Threshold,
}

/// Whether the drawing is light on dark.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Invert {
    /// Decided from the image.
    #[default]
    Auto,
    /// Light lines on a dark ground.
    Yes,
    /// Dark lines on a light ground.
    No,
}

/// The width that is written for a stroke.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum StrokeWidth {
    /// That of the stroke's pen: strokes whose measured widths may be those of one pen share it.
    #[default]
    Pens,
    /// Measured for each stroke.
    Measured,
    /// One width for all: the drawing's median.
    Uniform,
    /// This many pixels of the input for all.
    Fixed(f64),
    /// Strokes are filled outlines, as wide at each place as the ink is.
    Outline,
    /// Measured all along each stroke ([`crate::Stroke::profile`]); beside it the mean.
    Profile,
}

/// What becomes of dashed lines.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Dashing {
    /// Every dash is a stroke.
    #[default]
    Keep,
    /// Dashes at even distances along one line are one dashed stroke.
    Join,
}

/// Up to which width ink is a line; wider ink is a solid region.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum MaxWidth {
    /// Decided from the image: what is long and even is a line.
    #[default]
    Auto,
    /// This many pixels of the input.
    Pixels(f64),
    /// This many millimetres; the input has to know its resolution.
    Millimetres(f64),
    /// Any width: nothing is a solid region.
    Unlimited,
}

/// What becomes of solid regions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Solids {
    /// They are filled.
    #[default]
    Fill,
    /// A stroke goes along their outlines.
    Outline,
    /// Strokes beside each other cover them, for machines that hold a pen.
    Hatch,
    /// They are left out.
    Drop,
}

/// What a trace may be told. The defaults are meant to do well on any drawing.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default, rename_all = "kebab-case"))]
#[non_exhaustive]
pub struct Options {
    /// Fit tolerance in line widths: how far a fitted curve may leave the measured centreline. Smaller
    /// follows the ink more closely and gives more segments. In `[0.01, 2]`.
    pub detail: f64,
    /// Strokes shorter than this many line widths are dropped, unless they are dots. In `[0, 1000]`.
    pub min_length: f64,
    /// Specks of ink of at most this many pixels are removed; `None` decides from the image.
    pub despeckle: Option<usize>,
    /// How the ink of the drawing is told from everything else on the page.
    pub ink: Ink,
    /// How ink is told from paper.
    pub threshold: Threshold,
    /// Whether the drawing is light on dark.
    pub invert: Invert,
    /// The width written for each stroke.
    pub width: StrokeWidth,
    /// Up to which width ink is a line.
    pub max_width: MaxWidth,
    /// What becomes of solid regions.
    pub solids: Solids,
    /// Breaks in a line of at most this many line widths of paper are bridged, where direction and distance agree.
    /// `None` bridges what a pencil leaves on a scan, and nothing on a clean render. In `[0, 100]`.
    pub gap: Option<f64>,
    /// What becomes of dashed lines.
    pub dashes: Dashing,
    /// Colours of which alone strokes and solid regions are drawn; all where there are none.
    pub only: Vec<Color>,
    /// Colours of which no stroke or solid region is drawn.
    pub ignore: Vec<Color>,
    /// How far a colour may be from one of `only` or `ignore` and still be meant, as a distance in Oklab: black and white are 1
    /// apart. In `[0, 1]`.
    pub color_tolerance: f64,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            detail: 0.1,
            min_length: 0.5,
            despeckle: None,
            ink: Ink::Auto,
            threshold: Threshold::Auto,
            invert: Invert::Auto,
            width: StrokeWidth::Pens,
            max_width: MaxWidth::Auto,
            solids: Solids::Fill,
            gap: None,
            dashes: Dashing::Keep,
            only: Vec::new(),
            ignore: Vec::new(),
            color_tolerance: 0.15,
        }
    }
}

/// Named sets of options for common kinds of drawing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Preset {
    /// Pencil and ink sketches: looser curves, more specks removed.
    Sketch,
    /// Technical plans: tight fit, small details kept.
    Plan,
    /// Icons: tight fit, one width for all strokes.
    Icon,
}

impl Options {
    /// The options with some of them set: `Options::default().with(|o| o.gap = Some(2.0))`.
    #[must_use]
    pub fn with(mut self, set: impl FnOnce(&mut Self)) -> Self {
        set(&mut self);
        self
    }

    /// The options of a preset.
    pub fn preset(preset: Preset) -> Self {
        let default = Self::default();
        match preset {
            Preset::Sketch => Self { detail: 0.2, min_length: 1.5, ..default },
            Preset::Plan => Self { detail: 0.06, min_length: 0.25, ..default },
            Preset::Icon => Self { detail: 0.06, width: StrokeWidth::Uniform, ..default },
        }
    }

    /// Whether ink of a colour is drawn.
    pub fn takes(&self, color: Color) -> bool {
        let among = |colors: &[Color]| colors.iter().any(|c| c.distance(color) <= self.color_tolerance);
        (self.only.is_empty() || among(&self.only)) && !among(&self.ignore)
    }

    /// The same options with lengths in pixels of an input of a resolution.
    ///
    /// # Errors
    /// [`Error::Option`] where a length is in millimetres and the resolution is not known.
    pub(crate) fn in_pixels(&self, dpi: Option<f64>) -> Result<Self> {
        let max_width = match (self.max_width, dpi) {
            (MaxWidth::Millimetres(mm), Some(dpi)) => MaxWidth::Pixels(mm * dpi / 25.4),
            (MaxWidth::Millimetres(_), None) => {
                let reason = "millimetres need a resolution, which the input does not tell".into();
                return Err(Error::Option { option: "max-width", reason });
            }
            (other, _) => other,
        };
        Ok(Self { max_width, ..self.clone() })
    }

    /// The same options for an input of which blocks of pixels have become one.
    pub(crate) fn reduced(&self, block: usize) -> Self {
        let max_width = match self.max_width {
            MaxWidth::Pixels(width) => MaxWidth::Pixels(width / block as f64),
            other => other,
        };
        Self { max_width, ..self.clone() }
    }

    /// Checks every range.
    ///
    /// # Errors
    /// [`Error::Option`] names the first option that is out of its range.
    pub fn validate(&self) -> Result<()> {
        let within = |option, value: f64, low: f64, high: f64| {
            let ok = value >= low && value <= high;
            let reason = format!("{value} is not between {low} and {high}");
            if ok { Ok(()) } else { Err(Error::Option { option, reason }) }
        };
        within("detail", self.detail, 0.01, 2.0)?;
        within("min-length", self.min_length, 0.0, 1000.0)?;
        within("color-tolerance", self.color_tolerance, 0.0, 1.0)?;
        if let Some(gap) = self.gap {
            within("gap", gap, 0.0, 100.0)?;
        }
        if let MaxWidth::Pixels(width) | MaxWidth::Millimetres(width) = self.max_width {
            within("max-width", width, 0.001, 100_000.0)?;
        }
        if let Threshold::Fixed(t) = self.threshold {
            within("threshold", t, 0.001, 0.999)?;
        }
        if let StrokeWidth::Fixed(px) = self.width {
            within("width", px, 0.01, 1000.0)?;
        }
        Ok(())
    }
}
