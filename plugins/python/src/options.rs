//! Options by the names that the command has for them.

use crate::error::{option, wrong_type};
use fieldtrace::Color;
use fieldtrace::load::{Dpi, LoadOptions};
use fieldtrace::options::{Dashing, Ink, Invert, Options, Preset, StrokeWidth, Threshold};
use fieldtrace::write::{Curves, Shapes, Units, WriteOptions};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyString};
use std::path::PathBuf;

/// Names of the options of a trace.
const TRACE: [&str; 22] = [
    "preset",
    "ink",
    "threshold",
    "invert",
    "despeckle",
    "detail",
    "min_length",
    "width",
    "gap",
    "dashes",
    "only",
    "ignore",
    "color_tolerance",
    "without",
    "estimator",
    "weights",
    "device",
    "page",
    "crop",
    "dpi",
    "size",
    "max_pixels",
];
/// Names of the options of what is written.
const WRITE: [&str; 7] = ["units", "precision", "shapes", "curves", "tolerance", "step", "title"];

/// Where directions come from, where that is not a function.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Estimator {
    /// The trained network.
    UNet,
    /// The structure tensor of the ink.
    Tensor,
}

/// What a trace is told.
pub struct Settings {
    /// How strokes are made.
    pub trace: Options,
    /// How inputs are read.
    pub load: LoadOptions,
    /// Where directions come from.
    pub estimator: Estimator,
    /// Weights of the network in place of its own.
    pub weights: Option<PathBuf>,
    /// What runs the network.
    pub device: String,
    /// Passes that are left out.
    pub without: Vec<String>,
}

/// The options of a trace; those that are `None` are as if not given.
///
/// # Errors
/// `TypeError` for an unknown option or a value of a wrong type, `OptionError` for one that is not among the choices.
pub fn settings(options: &Bound<'_, PyDict>) -> PyResult<Settings> {
    let preset = options.get_item("preset")?.filter(|value| !value.is_none());
    let presets = [("sketch", Preset::Sketch), ("plan", Preset::Plan), ("icon", Preset::Icon)];
    let preset = preset.map(|value| choice("preset", &value, &presets)).transpose()?;
    let mut trace = preset.map_or_else(Options::default, Options::preset);
    let mut load = LoadOptions::default();
    let (mut estimator, mut weights, mut without) = (Estimator::UNet, None, Vec::new());
    let mut device = "auto".to_owned();
    for (name, value) in options {
        let name: String = name.extract()?;
        if value.is_none() {
            known(&name, &TRACE, &value)?;
            continue;
        }
        match &*name {
            "preset" => {}
            "ink" => {
                let choices = [("auto", Ink::Auto), ("learned", Ink::Learned), ("threshold", Ink::Threshold)];
                trace.ink = choice(&name, &value, &choices)?;
            }
            "threshold" => trace.threshold = choice_or(&name, &value, &[("auto", Threshold::Auto)], Threshold::Fixed)?,
            "invert" => trace.invert = invert(&name, &value)?,
            "despeckle" => trace.despeckle = Some(whole(&name, &value)?),
            "detail" => trace.detail = number(&name, &value)?,
            "min_length" => trace.min_length = number(&name, &value)?,
            "width" => trace.width = width(&name, &value)?,
            "gap" => trace.gap = choice_or(&name, &value, &[("auto", None)], Some)?,
            "dashes" => {
                trace.dashes = choice(&name, &value, &[("keep", Dashing::Keep), ("join", Dashing::Join)])?;
            }
            "only" => trace.only = colors(&name, &value)?,
            "ignore" => trace.ignore = colors(&name, &value)?,
            "color_tolerance" => trace.color_tolerance = number(&name, &value)?,
            "without" => without = texts(&name, &value)?,
            "estimator" => {
                let choices = [("unet", Estimator::UNet), ("tensor", Estimator::Tensor)];
                estimator = choice(&name, &value, &choices)?;
            }
            "weights" => weights = Some(value.extract().map_err(|_| wrong_type(&name, "a path", &value))?),
            "device" => device = value.extract().map_err(|_| wrong_type(&name, "a name", &value))?,
            "page" => load.page = Some(whole(&name, &value)?),
            "crop" => load.crop = Some(crop(&name, &value)?),
            "dpi" => load.dpi = Some(dpi(&name, &value)?),
            "size" => load.size = Some(whole(&name, &value)?),
            "max_pixels" => load.max_pixels = whole(&name, &value)?,
            _ => known(&name, &TRACE, &value)?,
        }
    }
    Ok(Settings { trace, load, estimator, weights, device, without })
}

/// The options of what is written.
///
/// # Errors
/// Those of [`settings`].
pub fn write_options(options: Option<&Bound<'_, PyDict>>) -> PyResult<WriteOptions> {
    let mut write = WriteOptions::default();
    let mut precision = None;
    for (name, value) in options.into_iter().flatten() {
        let name: String = name.extract()?;
        if value.is_none() {
            known(&name, &WRITE, &value)?;
            continue;
        }
        match &*name {
            "units" => write.units = choice(&name, &value, &[("px", Units::Pixels), ("mm", Units::Millimetres)])?,
            "precision" => precision = Some(whole::<usize>(&name, &value)?),
            "shapes" => write.shapes = choice(&name, &value, &[("plain", Shapes::Plain), ("path", Shapes::Path)])?,
            "curves" => {
                let choices = [("bezier", Curves::Bezier), ("arcs", Curves::Arcs), ("lines", Curves::Lines)];
                write.curves = Some(choice(&name, &value, &choices)?);
            }
            "tolerance" => write.tolerance = number(&name, &value)?,
            "step" => write.step = number(&name, &value)?,
            "title" => write.title = Some(value.extract().map_err(|_| wrong_type(&name, "a text", &value))?),
            _ => known(&name, &WRITE, &value)?,
        }
    }
    if let (Some(9..), Some(options)) = (precision, options) {
        return Err(option(options.py(), "precision", "not a whole number between 0 and 8"));
    }
    // Of a millimetre, a pixel is a tenth.
    write.precision = precision.unwrap_or(if write.units == Units::Millimetres { 3 } else { 2 });
    Ok(write)
}

/// Refuses an option that there is not, with the name that may have been meant.
fn known(name: &str, names: &[&str], value: &Bound<'_, PyAny>) -> PyResult<()> {
    if names.contains(&name) {
        return Ok(());
    }
    let alike: Vec<String> =
        value.py().import("difflib")?.call_method1("get_close_matches", (name, names.to_vec(), 1))?.extract()?;
    let meant = alike.first().map(|alike| format!(" (did you mean '{alike}'?)")).unwrap_or_default();
    Err(PyTypeError::new_err(format!("there is no option '{name}'{meant}")))
}

fn number(name: &str, value: &Bound<'_, PyAny>) -> PyResult<f64> {
    let wrong = || wrong_type(name, "a number", value);
    if value.is_instance_of::<PyBool>() { Err(wrong()) } else { value.extract().map_err(|_| wrong()) }
}

fn whole<T: for<'py> FromPyObjectOwned<'py>>(name: &str, value: &Bound<'_, PyAny>) -> PyResult<T> {
    let wrong = || wrong_type(name, "a whole number", value);
    if value.is_instance_of::<PyBool>() {
        return Err(wrong());
    }
    if value.extract::<i64>().is_ok_and(|number| number < 0) {
        return Err(option(value.py(), name, &format!("{value} is below 0")));
    }
    value.extract().map_err(|_| wrong())
}

/// One of some names.
fn choice<T: Copy>(name: &str, value: &Bound<'_, PyAny>, choices: &[(&str, T)]) -> PyResult<T> {
    let names = || choices.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ");
    let text = value.cast::<PyString>().map_err(|_| wrong_type(name, &format!("one of {}", names()), value))?;
    let text = text.to_cow()?;
    let found = choices.iter().find(|(name, _)| *name == text).map(|(_, choice)| *choice);
    found.ok_or_else(|| option(value.py(), name, &format!("\"{text}\" is not one of {}", names())))
}

/// One of some names or a number.
fn choice_or<T: Copy>(
    name: &str,
    value: &Bound<'_, PyAny>,
    choices: &[(&str, T)],
    other: impl Fn(f64) -> T,
) -> PyResult<T> {
    if value.is_instance_of::<PyString>() { choice(name, value, choices) } else { number(name, value).map(other) }
}

fn width(name: &str, value: &Bound<'_, PyAny>) -> PyResult<StrokeWidth> {
    let choices = [
        ("pens", StrokeWidth::Pens),
        ("measured", StrokeWidth::Measured),
        ("uniform", StrokeWidth::Uniform),
        ("outline", StrokeWidth::Outline),
        ("profile", StrokeWidth::Profile),
    ];
    choice_or(name, value, &choices, StrokeWidth::Fixed)
}

fn invert(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Invert> {
    match value.cast::<PyBool>() {
        Ok(value) => Ok(if value.is_true() { Invert::Yes } else { Invert::No }),
        Err(_) => choice(name, value, &[("auto", Invert::Auto), ("yes", Invert::Yes), ("no", Invert::No)]),
    }
}

/// One number or two.
fn dpi(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Dpi> {
    match value.extract() {
        Ok((x, y)) => Ok(Dpi { x, y }),
        Err(_) => number(name, value).map(Dpi::from),
    }
}

fn crop(name: &str, value: &Bound<'_, PyAny>) -> PyResult<[u32; 4]> {
    value.extract().map_err(|_| wrong_type(name, "four whole numbers: x, y, width, height", value))
}

/// One text or several.
fn texts(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Vec<String>> {
    if let Ok(text) = value.extract::<String>() {
        return Ok(vec![text]);
    }
    value.extract().map_err(|_| wrong_type(name, "a text or several", value))
}

/// Colours as CSS writes them.
fn colors(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Vec<Color>> {
    let color = |text: String| {
        let color = text.parse::<svgtypes::Color>();
        let color = color
            .map_err(|_| option(value.py(), name, &format!("\"{text}\" is not a colour such as #c00000 or red")))?;
        Ok(Color([color.red, color.green, color.blue]))
    };
    texts(name, value)?.into_iter().map(color).collect()
}
