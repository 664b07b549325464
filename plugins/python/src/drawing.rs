//! The result of a trace.

use crate::error::{option, raised, wrong_type};
use crate::options::write_options;
use crate::stroke::{Solid, Stroke};
use fieldtrace::graph::StrokeGraph;
use fieldtrace::write::{Document, Format, encode, format_named, formats, graph_json, write_file};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A drawing: lines and solid regions, in pixels of the input.
///
/// It has a length, that of its strokes, and can be iterated, compared and pickled. Notebooks show it.
#[pyclass(frozen, module = "fieldtrace")]
pub struct Drawing {
    drawing: Arc<fieldtrace::Drawing>,
    graph: Option<Arc<StrokeGraph>>,
}

/// A function and what it makes the same drawing of.
type Pickled<'py> = (Bound<'py, PyAny>, (String, Option<String>));

impl Drawing {
    /// A drawing, and the graph that it was made of where that is known.
    pub fn new(drawing: fieldtrace::Drawing, graph: Option<Arc<StrokeGraph>>) -> Self {
        Self { drawing: Arc::new(drawing), graph }
    }

    /// The library's drawing.
    pub fn drawing(&self) -> &fieldtrace::Drawing {
        &self.drawing
    }

    fn encoded(&self, py: Python<'_>, format: &dyn Format, options: Option<&Bound<'_, PyDict>>) -> PyResult<Vec<u8>> {
        let options = write_options(options)?;
        let document = Document { drawing: &self.drawing, graph: self.graph.as_deref() };
        py.detach(|| encode(format, &document, &options)).map_err(|e| raised(py, &e))
    }

    fn graph_text(&self) -> Option<String> {
        self.graph.as_deref().map(graph_json::to_json)
    }
}

#[pymethods]
impl Drawing {
    /// Width of the canvas in pixels.
    #[getter]
    fn width(&self) -> f64 {
        self.drawing.width
    }

    /// Height of the canvas in pixels.
    #[getter]
    fn height(&self) -> f64 {
        self.drawing.height
    }

    /// Dots per inch, or None where the input did not tell.
    #[getter]
    fn dpi(&self) -> Option<f64> {
        self.drawing.dpi
    }

    /// The lines.
    #[getter]
    fn strokes(&self) -> Vec<Stroke> {
        let stroke = |index| Stroke { drawing: self.drawing.clone(), index };
        (0..self.drawing.strokes.len()).map(stroke).collect()
    }

    /// The solid regions, painted before the lines.
    #[getter]
    fn solids(&self) -> Vec<Solid> {
        let solid = |index| Solid { drawing: self.drawing.clone(), index };
        (0..self.drawing.fills.len()).map(solid).collect()
    }

    /// The stroke graph as a dict: nodes where lines meet, edges between them, and strokes as walks through it. It is what the
    /// format json holds, and what `Vectorizer.draw` takes.
    fn graph<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        match py.detach(|| self.graph_text()) {
            Some(text) => graph_of(py, &text),
            None => Err(PyValueError::new_err("the drawing has no graph: its strokes were changed after the trace")),
        }
    }

    /// The same drawing with other strokes, such as some of its own. It has no graph.
    fn with_strokes(&self, strokes: Vec<PyRef<'_, Stroke>>) -> Self {
        let strokes = strokes.iter().map(|stroke| stroke.stroke().clone()).collect();
        let drawing = &*self.drawing;
        let drawing = fieldtrace::Drawing { strokes, fills: drawing.fills.clone(), ..*drawing };
        Self::new(drawing, None)
    }

    /// SVG text. Options: units ('px' or 'mm'), precision (decimals), shapes ('plain' or 'path'), curves ('bezier', 'arcs' or
    /// 'lines'), tolerance (pixels, for arcs and lines), title.
    #[pyo3(signature = (**options))]
    fn to_svg(&self, py: Python<'_>, options: Option<&Bound<'_, PyDict>>) -> PyResult<String> {
        let svg = self.encoded(py, named(py, "svg")?, options)?;
        String::from_utf8(svg).map_err(|e| PyValueError::new_err(e.to_string()))
    }

    /// The bytes of a file in a format, one of `fieldtrace.formats()`, with the options of `to_svg`, and step (pixels between
    /// the points of a CSV).
    #[pyo3(signature = (format, **options))]
    fn encode<'py>(
        &self,
        py: Python<'py>,
        format: &str,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Bound<'py, PyBytes>> {
        Ok(PyBytes::new(py, &self.encoded(py, named(py, format)?, options)?))
    }

    /// Writes a file, whole or not at all: in the format of its extension, or that of a name. Options are those of `encode`.
    #[pyo3(signature = (path, format = None, **options))]
    fn save(
        &self,
        py: Python<'_>,
        path: PathBuf,
        format: Option<&str>,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<()> {
        let format = match format {
            Some(format) => named(py, format)?,
            None => by_extension(py, &path)?,
        };
        let bytes = self.encoded(py, format, options)?;
        py.detach(|| write_file(&path, &bytes)).map_err(|e| raised(py, &e))
    }

    fn _repr_svg_(&self, py: Python<'_>) -> PyResult<String> {
        self.to_svg(py, None)
    }

    fn __len__(&self) -> usize {
        self.drawing.strokes.len()
    }

    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.strokes().into_pyobject(py)?.into_any().call_method0("__iter__")
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Self>().is_ok_and(|other| self.drawing == other.get().drawing)
    }

    fn __repr__(&self) -> String {
        let count = |count: usize, what: &str| format!("{count} {what}{}", if count == 1 { "" } else { "s" });
        let (width, height) = (self.drawing.width, self.drawing.height);
        let solids = match self.drawing.fills.len() {
            0 => String::new(),
            fills => format!(", {}", count(fills, "solid")),
        };
        let dpi = self.drawing.dpi.map(|dpi| format!(", {dpi:.0} dpi")).unwrap_or_default();
        format!("<Drawing {width} x {height} px{dpi}: {}{solids}>", count(self.drawing.strokes.len(), "stroke"))
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Pickled<'py>> {
        let text = serde_json::to_string(&*self.drawing).map_err(|e| PyValueError::new_err(e.to_string()))?;
        Ok((py.get_type::<Self>().getattr("_from_json")?, (text, self.graph_text())))
    }

    /// What pickling keeps, back again.
    #[staticmethod]
    fn _from_json(py: Python<'_>, drawing: &str, graph: Option<&str>) -> PyResult<Self> {
        let drawing = serde_json::from_str(drawing).map_err(|e| PyValueError::new_err(e.to_string()))?;
        let graph = graph.map(|graph| graph_json::from_json("the graph", graph.as_bytes())).transpose();
        Ok(Self::new(drawing, graph.map_err(|e| raised(py, &e))?.map(Arc::new)))
    }
}

/// The format of a name.
///
/// # Errors
/// `OptionError`.
pub fn named(py: Python<'_>, name: &str) -> PyResult<&'static dyn Format> {
    format_named(name).ok_or_else(|| option(py, "format", &format!("\"{name}\" is not one of {}", names())))
}

fn by_extension(py: Python<'_>, path: &Path) -> PyResult<&'static dyn Format> {
    let extension = path.extension().unwrap_or_default().to_string_lossy();
    format_named(&extension).ok_or_else(|| {
        let reason = format!("{}: its extension is not one of {}", path.display(), names());
        option(py, "format", &reason)
    })
}

fn names() -> String {
    formats().iter().map(|format| format.name()).collect::<Vec<_>>().join(", ")
}

/// The dict of a graph's JSON.
///
/// # Errors
/// Never, but for want of memory.
pub fn graph_of<'py>(py: Python<'py>, text: &str) -> PyResult<Bound<'py, PyAny>> {
    py.import("json")?.call_method1("loads", (text,))
}

/// The JSON of a graph's dict.
///
/// # Errors
/// `TypeError` where it is none.
pub fn json_of(graph: &Bound<'_, PyAny>) -> PyResult<String> {
    if !graph.is_instance_of::<PyDict>() {
        return Err(wrong_type("the graph", "a dict", graph));
    }
    graph.py().import("json")?.call_method1("dumps", (graph,))?.extract()
}
