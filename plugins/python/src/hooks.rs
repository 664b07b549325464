//! Functions of the caller's own: estimators of ink and of directions, and observers.

use crate::caller::{call, fail};
use crate::drawing::{Drawing, graph_of, json_of};
use fieldtrace::cancel::Cancel;
use fieldtrace::clean::LineImage;
use fieldtrace::estimate::FieldEstimator;
use fieldtrace::field::PolyVectorField;
use fieldtrace::graph::StrokeGraph;
use fieldtrace::hooks::{Observer, Stage};
use fieldtrace::ink::InkEstimator;
use fieldtrace::num_complex::Complex32;
use fieldtrace::raster::Raster;
use fieldtrace::{Error, Result, Scan};
use numpy::{Element, PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::Arc;

/// A function of the caller's own, by the name of the option that it came in.
pub struct Function {
    name: &'static str,
    function: Arc<Py<PyAny>>,
}

impl Function {
    /// The function of an option, where there is one.
    ///
    /// # Errors
    /// `TypeError` where it cannot be called.
    pub fn of(functions: &Bound<'_, PyDict>, name: &'static str) -> PyResult<Option<Self>> {
        let Some(function) = functions.get_item(name)?.filter(|function| !function.is_none()) else {
            return Ok(None);
        };
        if !function.is_callable() {
            return Err(crate::error::wrong_type(name, "a function", &function));
        }
        Ok(Some(Self { name, function: Arc::new(function.unbind()) }))
    }

    /// Calls it where Python is.
    fn with<R: Send + 'static>(
        &self,
        task: impl FnOnce(&Bound<'_, PyAny>) -> PyResult<R> + Send + 'static,
    ) -> Result<R> {
        let function = self.function.clone();
        call(self.name, move |py| task(function.bind(py)))
    }
}

/// Ink by a function of the page.
pub struct Ink(pub Function);

impl InkEstimator for Ink {
    fn estimate(&self, scan: &Scan) -> Result<Raster<f32>> {
        let (width, height) = scan.gray.size();
        let (gray, rgb) = match &scan.rgb {
            Some(rgb) => (Vec::new(), Some(rgb.as_raw().clone())),
            None => (scan.gray.data().to_vec(), None),
        };
        let ink = self.0.with(move |function| {
            let py = function.py();
            let page = match rgb {
                Some(rgb) => PyArray1::from_vec(py, rgb).reshape([height, width, 3])?.into_any(),
                None => PyArray1::from_vec(py, gray).reshape([height, width])?.into_any(),
            };
            coverage(&function.call1((page,))?)
        })?;
        fitting(ink, (width, height))
    }
}

/// Directions by a function of the darkness of lines and of their mask.
pub struct Field(pub Function);

impl FieldEstimator for Field {
    fn name(&self) -> &str {
        "field_estimator"
    }

    fn estimate(&self, image: &LineImage) -> Result<PolyVectorField> {
        let size = image.ink.size();
        let (ink, mask) = (image.ink.clone(), image.mask.clone());
        let (c0, c2, confidence) = self.0.with(move |function| {
            let py = function.py();
            let (darkness, mask) = (array(py, ink)?, array(py, mask)?);
            let given = function.call1((&darkness, mask))?;
            let parts = py.import("fieldtrace.images")?.call_method1("field", (given, darkness.getattr("shape")?))?;
            let (c0, c2, confidence) = parts.extract::<(Bound<'_, PyAny>, Bound<'_, PyAny>, Bound<'_, PyAny>)>()?;
            Ok((raster::<Complex32>(&c0)?, raster::<Complex32>(&c2)?, raster::<f32>(&confidence)?))
        })?;
        let field = PolyVectorField::new(c0, c2, confidence)?;
        if field.size() == size { Ok(field) } else { Err(Error::FieldSize { field: field.size(), image: size }) }
    }
}

/// Functions that see what each stage made.
#[derive(Default)]
pub struct Observers {
    on_ink: Option<Function>,
    on_graph: Option<Function>,
    on_drawing: Option<Function>,
}

impl Observers {
    /// Those among some functions.
    ///
    /// # Errors
    /// `TypeError` where one cannot be called.
    pub fn of(functions: &Bound<'_, PyDict>) -> PyResult<Self> {
        Ok(Self {
            on_ink: Function::of(functions, "on_ink")?,
            on_graph: Function::of(functions, "on_graph")?,
            on_drawing: Function::of(functions, "on_drawing")?,
        })
    }

    /// The name of the first that there is.
    pub fn first(&self) -> Option<&'static str> {
        [&self.on_ink, &self.on_graph, &self.on_drawing].into_iter().flatten().map(|function| function.name).next()
    }
}

/// What is told of each stage as it begins.
pub fn teller(function: Function) -> impl Fn(Stage) + Send + Sync {
    move |stage| {
        let said = function.with(move |function| function.call1((stage.to_string(),)).map(drop));
        if let Err(e) = said {
            fail(e);
        }
    }
}

/// The observers of one trace.
pub struct Watch<'a> {
    /// The functions.
    pub observers: &'a Observers,
    /// What stops the trace.
    pub cancel: Cancel,
}

impl Observer for Watch<'_> {
    fn cancel(&self) -> Cancel {
        self.cancel.clone()
    }

    fn on_ink(&mut self, _: &Scan, ink: &mut Raster<f32>) -> Result<()> {
        let Some(function) = &self.observers.on_ink else { return Ok(()) };
        let seen = ink.clone();
        let changed = function.with(move |function| {
            let changed = function.call1((array(function.py(), seen)?,))?;
            if changed.is_none() { Ok(None) } else { coverage(&changed).map(Some) }
        })?;
        if let Some(changed) = changed {
            *ink = fitting(changed, ink.size())?;
        }
        Ok(())
    }

    fn on_graph(&mut self, _: &LineImage, graph: &mut StrokeGraph) -> Result<()> {
        let Some(function) = &self.observers.on_graph else { return Ok(()) };
        let seen = fieldtrace::write::graph_json::to_json(graph);
        let changed = function.with(move |function| {
            let changed = function.call1((graph_of(function.py(), &seen)?,))?;
            if changed.is_none() { Ok(None) } else { json_of(&changed).map(Some) }
        })?;
        if let Some(changed) = changed {
            *graph = fieldtrace::write::graph_json::from_json("on_graph", changed.as_bytes())?;
        }
        Ok(())
    }

    fn on_drawing(&mut self, drawing: &mut fieldtrace::Drawing) -> Result<()> {
        let Some(function) = &self.observers.on_drawing else { return Ok(()) };
        let seen = Drawing::new(drawing.clone(), None);
        let changed = function.with(move |function| {
            let changed = function.call1((seen,))?;
            if changed.is_none() {
                return Ok(None);
            }
            let drawing = changed.cast::<Drawing>().map_err(PyErr::from)?;
            Ok(Some(drawing.get().drawing().clone()))
        })?;
        if let Some(changed) = changed {
            *drawing = changed;
        }
        Ok(())
    }
}

/// The samples of a grid as an array `(height, width)`.
pub fn array<T: Element + Copy>(py: Python<'_>, raster: Raster<T>) -> PyResult<Bound<'_, PyArray2<T>>> {
    let (width, height) = raster.size();
    PyArray1::from_vec(py, raster.data().to_vec()).reshape([height, width])
}

/// The grid of an array `(height, width)`.
fn raster<T: Element + Copy>(array: &Bound<'_, PyAny>) -> PyResult<Raster<T>> {
    let array = array.cast::<PyArray2<T>>().map_err(PyErr::from)?.try_readonly()?;
    let (height, width) = array.as_array().dim();
    let data = array.as_array().iter().copied().collect();
    Ok(Raster::from_vec(width, height, data).unwrap_or_else(|| Raster::from_fn(0, 0, |_, _| unreachable!())))
}

/// The grid of whatever stands for coverage.
fn coverage(given: &Bound<'_, PyAny>) -> PyResult<Raster<f32>> {
    raster(&given.py().import("fieldtrace.images")?.call_method1("coverage", (given,))?)
}

/// Ink of the size of a page.
fn fitting(ink: Raster<f32>, page: (usize, usize)) -> Result<Raster<f32>> {
    if ink.size() == page { Ok(ink) } else { Err(Error::InkSize { ink: ink.size(), page }) }
}
