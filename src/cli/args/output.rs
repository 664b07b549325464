//! What is written, and where.

use super::parse_number;
use crate::cli::failure::Failure;
use crate::cli::target;
use crate::write::{Curves, Format, Shapes, Units, WriteOptions, format_named, formats};
use clap::{Args, ValueEnum};
use std::path::{Path, PathBuf};

/// Decimals in pixels, and in millimetres, where a pixel is a tenth of one.
const DECIMALS: [usize; 2] = [2, 3];

/// What is written.
#[derive(Debug, Args)]
#[command(next_help_heading = "Output")]
pub(crate) struct OutputArgs {
    /// Kind of the output: svg, svgz, dxf, pdf, geojson, csv, or json for the stroke graph
    /// [default: by the extension of OUT, svg for others]
    #[arg(long, value_name = "NAME", value_parser = parse_format)]
    format: Option<&'static str>,
    /// Unit of coordinates and widths in SVG and CSV [default: px]
    #[arg(long, value_name = "UNIT")]
    units: Option<UnitName>,
    /// Decimals of the coordinates and widths [default: 2, 3 in millimetres]
    #[arg(long, value_name = "N", value_parser = parse_precision)]
    precision: Option<usize>,
    /// Pieces of strokes: `bezier`, `arcs` with lines, or `lines` alone [default: what suits the format]
    #[arg(long, value_name = "KIND")]
    curves: Option<CurveKind>,
    /// Elements of an SVG: `plain` for lines, circles and rectangles where they serve, `path` for paths alone
    /// [default: plain]
    #[arg(long, value_name = "KIND")]
    shapes: Option<ShapeKind>,
    /// How far arcs and lines may leave the curve that they are written for, in pixels [default: 0.1]
    #[arg(long, value_name = "PX", value_parser = parse_number, allow_negative_numbers = true)]
    tolerance: Option<f64>,
    /// Distance between the points of a CSV, in pixels [default: 1]
    #[arg(long, value_name = "PX", value_parser = parse_number, allow_negative_numbers = true)]
    step: Option<f64>,
    /// Also write the stroke graph, as JSON that can be corrected and traced on
    #[arg(long, value_name = "FILE")]
    pub(crate) graph: Option<PathBuf>,
    /// Also write a picture of each stage, laid over the input, to this folder
    #[arg(long, value_name = "DIR")]
    pub(crate) debug_dir: Option<PathBuf>,
    /// Overwrite files that this program did not write, and trace again what is done already
    #[arg(long)]
    pub(crate) force: bool,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum UnitName {
    /// Pixels of the input
    Px,
    /// Millimetres
    Mm,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum ShapeKind {
    /// Lines, circles and rectangles where they serve
    Plain,
    /// Paths alone
    Path,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum CurveKind {
    /// As fitted: lines, arcs and Bezier curves
    Bezier,
    /// Lines and arcs
    Arcs,
    /// Lines alone
    Lines,
}

impl OutputArgs {
    /// The format that was asked for by name, or by the extension of the output's name.
    pub(crate) fn format(&self, output: Option<&Path>) -> Result<&'static dyn Format, Failure> {
        let svg = || format_named("svg").expect("SVG is always written");
        if let Some(name) = self.format {
            return Ok(format_named(name).unwrap_or_else(svg));
        }
        let Some(output) = output else { return Ok(svg()) };
        let extension = target::extension(output);
        match format_named(&extension) {
            Some(format) => Ok(format),
            None if target::is_other_kind(&extension) => {
                let names: Vec<&str> = formats().iter().map(|format| format.name()).collect();
                let (name, names) = (target::name(output), names.join(", "));
                Err(Failure::Usage(format!("{name}: {extension} is not among the kinds of output: {names}")))
            }
            None => Ok(svg()),
        }
    }

    /// The library's form.
    pub(crate) fn options(&self) -> WriteOptions {
        let default = WriteOptions::default();
        let metric = matches!(self.units, Some(UnitName::Mm));
        WriteOptions {
            precision: self.precision.unwrap_or(DECIMALS[usize::from(metric)]),
            units: if metric { Units::Millimetres } else { Units::Pixels },
            shapes: match self.shapes {
                Some(ShapeKind::Path) => Shapes::Path,
                Some(ShapeKind::Plain) | None => Shapes::Plain,
            },
            curves: self.curves.map(|kind| match kind {
                CurveKind::Bezier => Curves::Bezier,
                CurveKind::Arcs => Curves::Arcs,
                CurveKind::Lines => Curves::Lines,
            }),
            tolerance: self.tolerance.unwrap_or(default.tolerance),
            step: self.step.unwrap_or(default.step),
            ..default
        }
    }
}

fn parse_format(text: &str) -> Result<&'static str, String> {
    let names = || formats().iter().map(|format| format.name()).collect::<Vec<_>>().join(", ");
    format_named(text).map(|format| format.name()).ok_or_else(|| format!("not one of {}", names()))
}

fn parse_precision(text: &str) -> Result<usize, String> {
    text.parse().ok().filter(|n| *n <= 8).ok_or_else(|| "not a whole number between 0 and 8".into())
}
