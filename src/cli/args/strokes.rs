//! How ink is told from paper, and strokes are made of it.

use super::parse_number;
use crate::drawing::Color;
use crate::options::{self, Dashing, Ink, Invert, MaxWidth, Options, Solids, StrokeWidth, Threshold};
use clap::{Args, ValueEnum};
use std::str::FromStr;

/// How ink is told from paper.
#[derive(Debug, Args)]
#[command(next_help_heading = "Ink")]
pub(crate) struct CleanArgs {
    /// Options that suit a kind of drawing; those given beside it override it
    #[arg(long, value_name = "KIND")]
    preset: Option<Preset>,
    /// How ink is told from what else is on the page: `learned` by a network that has seen shadows, stains and ruled paper,
    /// `threshold` by darkness alone, `auto` by the network except where both tell the same ink
    /// [default: auto]
    #[arg(long, value_name = "HOW", value_parser = parse_ink)]
    ink: Option<Ink>,
    /// Darkness from which a pixel is ink: `auto`, or between 0 (paper) and 1 (black) [default: auto]
    #[arg(long, value_name = "T", value_parser = parse_threshold, allow_negative_numbers = true)]
    threshold: Option<Threshold>,
    /// Whether the lines are lighter than the ground [default: auto]
    #[arg(long, value_name = "WHEN", value_parser = parse_invert)]
    invert: Option<Invert>,
    /// Remove specks of at most this many pixels [default: decided from the image]
    #[arg(long, value_name = "N")]
    despeckle: Option<usize>,
}

/// How strokes are made.
#[derive(Debug, Args)]
#[command(next_help_heading = "Strokes")]
pub(crate) struct FitArgs {
    /// How far a curve may leave the ink's centre, in line widths: less follows closer, with more
    /// pieces [default: 0.1]
    #[arg(long, value_name = "W", value_parser = parse_number, allow_negative_numbers = true)]
    detail: Option<f64>,
    /// Drop strokes shorter than this many line widths, unless they are dots [default: 0.5]
    #[arg(long, value_name = "W", value_parser = parse_number, allow_negative_numbers = true)]
    min_length: Option<f64>,
    /// Stroke widths: `pens` for the widths of the pens that were used, `measured` for each stroke's own, `uniform` for the
    /// drawing's median, a number of pixels, `outline` for filled outlines that keep the taper of each, or `profile`
    /// for widths along each stroke where the format has them, and outlines where not [default: pens]
    #[arg(long, value_name = "WIDTH", value_parser = parse_width, allow_negative_numbers = true)]
    width: Option<StrokeWidth>,
    /// Up to which width ink is a line, in pixels or as `2mm`; wider ink is a solid region. `none` makes all ink lines,
    /// `auto` tells by length and evenness [default: auto]
    #[arg(long, value_name = "WIDTH", value_parser = parse_max_width, allow_negative_numbers = true)]
    max_width: Option<MaxWidth>,
    /// Solid regions: `fill` them, draw their `outline`, `hatch` them for a pen, or `drop` them [default: fill]
    #[arg(long, value_name = "HOW", value_parser = parse_solids)]
    solids: Option<Solids>,
    /// Bridge breaks in a line of at most this many line widths, where direction and distance agree;
    /// `auto` does so for a pencil's on a scan [default: auto]
    #[arg(long, value_name = "W", value_parser = parse_gap, allow_negative_numbers = true)]
    gap: Option<Gap>,
    /// Dashes at even distances: `keep` each as a stroke, or `join` them into a dashed one [default: keep]
    #[arg(long, value_name = "WHAT", value_parser = parse_dashes)]
    dashes: Option<Dashing>,
    /// Draw only strokes and solids of this colour, such as '#c00000' or red; may be given more than once
    #[arg(long, value_name = "COLOR", value_parser = parse_color)]
    only: Vec<Color>,
    /// Leave out strokes and solids of this colour; may be given more than once
    #[arg(long, value_name = "COLOR", value_parser = parse_color)]
    ignore: Vec<Color>,
    /// How far from the colour of --only or --ignore ink may be: 0 is that colour alone, black and white are 1 apart
    /// [default: 0.15]
    #[arg(long, value_name = "D", value_parser = parse_number, allow_negative_numbers = true)]
    color_tolerance: Option<f64>,
    /// Leave out a pass between streamlines and graph, by its name
    #[arg(long, value_name = "PASS", hide = true)]
    pub(crate) without: Vec<String>,
}

/// Line widths of paper, or `None` for `auto`.
#[derive(Clone, Copy, Debug)]
struct Gap(Option<f64>);

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Preset {
    /// Pencil and ink: looser curves, short strokes dropped
    Sketch,
    /// Technical plans: a tight fit, small details kept
    Plan,
    /// Icons: a tight fit, one width for all strokes
    Icon,
}

/// The library's options: the preset's, overridden by those that were given.
pub(crate) fn options(clean: &CleanArgs, fit: Option<&FitArgs>) -> Options {
    let base = match clean.preset {
        None => Options::default(),
        Some(Preset::Sketch) => Options::preset(options::Preset::Sketch),
        Some(Preset::Plan) => Options::preset(options::Preset::Plan),
        Some(Preset::Icon) => Options::preset(options::Preset::Icon),
    };
    Options {
        detail: fit.and_then(|f| f.detail).unwrap_or(base.detail),
        min_length: fit.and_then(|f| f.min_length).unwrap_or(base.min_length),
        despeckle: clean.despeckle.or(base.despeckle),
        ink: clean.ink.unwrap_or(base.ink),
        threshold: clean.threshold.unwrap_or(base.threshold),
        invert: clean.invert.unwrap_or(base.invert),
        width: fit.and_then(|f| f.width).unwrap_or(base.width),
        max_width: fit.and_then(|f| f.max_width).unwrap_or(base.max_width),
        solids: fit.and_then(|f| f.solids).unwrap_or(base.solids),
        gap: fit.and_then(|f| f.gap).map_or(base.gap, |Gap(gap)| gap),
        dashes: fit.and_then(|f| f.dashes).unwrap_or(base.dashes),
        only: fit.map_or(base.only, |f| f.only.clone()),
        ignore: fit.map_or(base.ignore, |f| f.ignore.clone()),
        color_tolerance: fit.and_then(|f| f.color_tolerance).unwrap_or(base.color_tolerance),
    }
}

/// A colour as CSS writes it.
fn parse_color(text: &str) -> Result<Color, String> {
    let color = svgtypes::Color::from_str(text).map_err(|_| "not a colour such as #c00000 or red")?;
    Ok(Color([color.red, color.green, color.blue]))
}

fn parse_threshold(text: &str) -> Result<Threshold, String> {
    match text {
        "auto" => Ok(Threshold::Auto),
        _ => parse_number(text).map(Threshold::Fixed).map_err(|_| "neither auto nor a number".into()),
    }
}

fn parse_ink(text: &str) -> Result<Ink, String> {
    match text {
        "auto" => Ok(Ink::Auto),
        "learned" => Ok(Ink::Learned),
        "threshold" => Ok(Ink::Threshold),
        _ => Err("not one of auto, learned, threshold".into()),
    }
}

fn parse_invert(text: &str) -> Result<Invert, String> {
    match text {
        "auto" => Ok(Invert::Auto),
        "yes" => Ok(Invert::Yes),
        "no" => Ok(Invert::No),
        _ => Err("not one of auto, yes, no".into()),
    }
}

fn parse_gap(text: &str) -> Result<Gap, String> {
    match text {
        "auto" => Ok(Gap(None)),
        _ => parse_number(text).map(|w| Gap(Some(w))).map_err(|_| "neither auto nor a number".into()),
    }
}

fn parse_max_width(text: &str) -> Result<MaxWidth, String> {
    let number =
        |text: &str| parse_number(text).map_err(|_| "neither auto, none, a number of pixels nor as 2mm".into());
    match (text, text.strip_suffix("mm"), text.strip_suffix("px")) {
        ("auto", ..) => Ok(MaxWidth::Auto),
        ("none", ..) => Ok(MaxWidth::Unlimited),
        (_, Some(mm), _) => number(mm.trim()).map(MaxWidth::Millimetres),
        (_, _, Some(px)) => number(px.trim()).map(MaxWidth::Pixels),
        _ => number(text).map(MaxWidth::Pixels),
    }
}

fn parse_solids(text: &str) -> Result<Solids, String> {
    match text {
        "fill" => Ok(Solids::Fill),
        "outline" => Ok(Solids::Outline),
        "hatch" => Ok(Solids::Hatch),
        "drop" => Ok(Solids::Drop),
        _ => Err("not one of fill, outline, hatch, drop".into()),
    }
}

fn parse_dashes(text: &str) -> Result<Dashing, String> {
    match text {
        "keep" => Ok(Dashing::Keep),
        "join" => Ok(Dashing::Join),
        _ => Err("not one of keep, join".into()),
    }
}

fn parse_width(text: &str) -> Result<StrokeWidth, String> {
    match text {
        "pens" => Ok(StrokeWidth::Pens),
        "measured" => Ok(StrokeWidth::Measured),
        "uniform" => Ok(StrokeWidth::Uniform),
        "outline" => Ok(StrokeWidth::Outline),
        "profile" => Ok(StrokeWidth::Profile),
        _ => parse_number(text)
            .map(StrokeWidth::Fixed)
            .map_err(|_| "neither pens, measured, uniform, outline, profile nor a number".into()),
    }
}
