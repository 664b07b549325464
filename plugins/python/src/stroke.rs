//! Lines and solid regions of a drawing.

use fieldtrace::kurbo::{self, BezPath, PathEl, Point, Shape};
use fieldtrace::{Centreline, Drawing};
use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::sync::Arc;

/// Accuracy of the Bezier curves of arcs, in pixels.
const ROUND: f64 = 1e-3;

/// A line of a drawing: its centreline, and the pen that drew it. Lengths are in pixels of the input, y points down.
#[pyclass(frozen, module = "fieldtrace")]
pub struct Stroke {
    pub(crate) drawing: Arc<Drawing>,
    pub(crate) index: usize,
}

impl Stroke {
    /// The library's stroke.
    pub fn stroke(&self) -> &fieldtrace::Stroke {
        &self.drawing.strokes[self.index]
    }
}

#[pymethods]
impl Stroke {
    /// Points on the centreline, a float64 array of shape (n, 2), x before y: no point of the line is further from the
    /// polyline than `tolerance` pixels. A closed stroke ends with its first point; a dot has one point.
    #[pyo3(signature = (tolerance = 0.1))]
    fn points<'py>(&self, py: Python<'py>, tolerance: f64) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let line = &self.stroke().centreline;
        if let Centreline::Dot(p) = line {
            return points(py, &[*p]);
        }
        let mut rings = flattened(&line.to_path(), tolerance)?;
        points(py, &rings.pop().unwrap_or_default())
    }

    /// The centreline as cubic Bezier curves, a float64 array of shape (k, 4, 2): for each piece its start, two control
    /// points and its end. Lines and arcs are curves like any other here; a dot is one curve of no length.
    #[getter]
    fn beziers<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let cubics = self.stroke().centreline.cubics();
        let numbers = cubics.iter().flat_map(|c| [c.p0, c.p1, c.p2, c.p3]).flat_map(|p| [p.x, p.y]).collect();
        PyArray1::from_vec(py, numbers).reshape([cubics.len(), 4, 2])
    }

    /// Width of the pen.
    #[getter]
    fn width(&self) -> f64 {
        self.stroke().width
    }

    /// Widths at even distances along the centreline, a float64 array of shape (m,), from its start to its end: of drawings
    /// that were traced with `width="profile"`. None in others.
    #[getter]
    fn widths<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        let profile = &self.stroke().profile;
        (!profile.is_empty()).then(|| PyArray1::from_slice(py, profile))
    }

    /// Colour of the ink as '#rrggbb'.
    #[getter]
    fn color(&self) -> String {
        self.stroke().color.to_string()
    }

    /// Whether the line ends where it starts.
    #[getter]
    fn closed(&self) -> bool {
        self.stroke().centreline.is_closed()
    }

    /// 'path', 'circle' or 'dot'.
    #[getter]
    fn kind(&self) -> &'static str {
        match self.stroke().centreline {
            Centreline::Path { .. } => "path",
            Centreline::Circle(_) => "circle",
            Centreline::Dot(_) => "dot",
        }
    }

    /// Length of the centreline.
    #[getter]
    fn length(&self) -> f64 {
        self.stroke().centreline.to_path().perimeter(ROUND)
    }

    /// Of a dashed line, the lengths of a dash and of a gap, and how far into the pattern the line starts; else None.
    #[getter]
    fn dashes(&self) -> Option<(f64, f64, f64)> {
        self.stroke().dashes.map(|d| (d.dash, d.gap, d.offset))
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Self>().is_ok_and(|other| self.stroke() == other.get().stroke())
    }

    fn __repr__(&self) -> String {
        let Point { x, y } = self.stroke().centreline.start();
        let closed = if self.closed() { " closed" } else { "" };
        let (kind, width, length, color) = (self.kind(), self.width(), self.length(), self.color());
        format!("<Stroke{closed} {kind} from {x:.1},{y:.1}, {length:.1} px long, {width:.2} px wide, {color}>")
    }
}

/// A solid region of a drawing, too wide to be a line; inside by the even-odd rule.
#[pyclass(frozen, module = "fieldtrace")]
pub struct Solid {
    pub(crate) drawing: Arc<Drawing>,
    pub(crate) index: usize,
}

impl Solid {
    /// The library's region.
    pub fn fill(&self) -> &fieldtrace::Fill {
        &self.drawing.fills[self.index]
    }
}

#[pymethods]
impl Solid {
    /// The outlines, of the region and of the holes in it, each a float64 array of shape (n, 2) whose last point is its first.
    #[pyo3(signature = (tolerance = 0.1))]
    fn rings<'py>(&self, py: Python<'py>, tolerance: f64) -> PyResult<Vec<Bound<'py, PyArray2<f64>>>> {
        flattened(&self.fill().outline, tolerance)?.iter().map(|ring| points(py, ring)).collect()
    }

    /// Colour of the ink as '#rrggbb'.
    #[getter]
    fn color(&self) -> String {
        self.fill().color.to_string()
    }

    fn __repr__(&self) -> String {
        let (size, color) = (self.fill().outline.area().abs(), self.color());
        format!("<Solid of {size:.0} square px, {color}>")
    }
}

/// The polylines of a path, one for each of its parts.
fn flattened(path: &BezPath, tolerance: f64) -> PyResult<Vec<Vec<Point>>> {
    if !(tolerance.is_finite() && tolerance > 0.0) {
        return Err(PyValueError::new_err(format!("tolerance: {tolerance} is not above 0")));
    }
    let mut lines: Vec<Vec<Point>> = Vec::new();
    kurbo::flatten(path, tolerance, |element| match element {
        PathEl::MoveTo(p) => lines.push(vec![p]),
        PathEl::LineTo(p) => lines.last_mut().into_iter().for_each(|line| line.push(p)),
        _ => lines.last_mut().into_iter().for_each(close),
    });
    Ok(lines)
}

/// Leads a line back to its start, unless it is there but for rounding.
fn close(line: &mut Vec<Point>) {
    let (start, end) = (line[0], line[line.len() - 1]);
    if line.len() > 1 && (end - start).hypot() < 1e-6 {
        line.pop();
    }
    line.push(start);
}

fn points<'py>(py: Python<'py>, points: &[Point]) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let numbers = points.iter().flat_map(|p| [p.x, p.y]).collect();
    PyArray1::from_vec(py, numbers).reshape([points.len(), 2])
}
