//! What traces under one set of options.

use crate::caller;
use crate::drawing::{Drawing, json_of};
use crate::hooks::{Field, Function, Ink, Observers, Watch, array, teller};
use crate::image::{Page, Source};
use crate::options::{Estimator, Settings, settings};
use fieldtrace::cancel::Cancel;
use fieldtrace::estimate::{FieldEstimator, StructureTensor, UNet};
use fieldtrace::load::LoadOptions;
use fieldtrace::num_complex::Complex32;
use fieldtrace::pipeline::Vectorizer;
use fieldtrace::unet::{Backend, Weights};
use fieldtrace::write::graph_json;
use fieldtrace::{Result, Scan};
use numpy::PyArray2;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};
use std::sync::Arc;

/// Traces images under one set of options; what `fieldtrace.Vectorizer` is made of.
#[pyclass(frozen, module = "fieldtrace._native")]
pub struct Tracer {
    work: Arc<Work>,
}

/// What a trace needs, for any thread.
pub struct Work {
    vectorizer: Vectorizer,
    load: LoadOptions,
    observers: Observers,
}

/// The arrays `c0`, `c2` and confidence of a field.
type Arrays<'py> = (Bound<'py, PyArray2<Complex32>>, Bound<'py, PyArray2<Complex32>>, Bound<'py, PyArray2<f32>>);

#[pymethods]
impl Tracer {
    /// Under options by the command's names, with functions of the caller's own.
    #[new]
    fn new(options: &Bound<'_, PyDict>, functions: &Bound<'_, PyDict>) -> PyResult<Self> {
        let settings = settings(options)?;
        let observers = Observers::of(functions)?;
        let load = settings.load.clone();
        let vectorizer = vectorizer(settings, functions)?;
        load.validate().map_err(|e| crate::error::raised(options.py(), &e))?;
        Ok(Self { work: Arc::new(Work { vectorizer, load, observers }) })
    }

    /// Traces an image.
    fn trace(&self, image: &Bound<'_, PyAny>) -> PyResult<Drawing> {
        let source = Source::of(image)?;
        caller::run(image.py(), |cancel| self.work.trace(source, cancel))
    }

    /// The curves of a stroke graph: a dict, or its JSON.
    fn draw(&self, graph: &Bound<'_, PyAny>) -> PyResult<Drawing> {
        let text = if graph.is_instance_of::<PyString>() { graph.extract()? } else { json_of(graph)? };
        caller::run(graph.py(), |cancel| {
            let graph = graph_json::from_json("the graph", text.as_bytes())?;
            self.work.draw(graph, cancel)
        })
    }

    /// The ink of an image.
    fn ink<'py>(&self, image: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let source = Source::of(image)?;
        let ink = caller::run(image.py(), |_| self.work.vectorizer.ink(&source.scan(&self.work.load)?))?;
        array(image.py(), ink)
    }

    /// The field of an image.
    fn field<'py>(&self, image: &Bound<'py, PyAny>) -> PyResult<Arrays<'py>> {
        let (py, source) = (image.py(), Source::of(image)?);
        let field = caller::run(py, |_| self.work.vectorizer.field(&source.scan(&self.work.load)?))?;
        let grid = |grid: &fieldtrace::raster::Raster<Complex32>| array(py, grid.clone());
        Ok((grid(field.c0())?, grid(field.c2())?, array(py, field.confidence().clone())?))
    }
}

impl Tracer {
    /// What a batch's threads take along.
    pub fn work(&self) -> Arc<Work> {
        self.work.clone()
    }
}

impl Work {
    /// How inputs are read.
    pub fn load(&self) -> &LoadOptions {
        &self.load
    }

    /// Reads and traces one image, or draws the graph that it holds.
    ///
    /// # Errors
    /// Why that cannot be done.
    pub fn trace(&self, source: Source, cancel: &Cancel) -> Result<Drawing> {
        match source.read(&self.load)? {
            Page::Scan(scan) => self.scan(&scan, cancel),
            Page::Graph(graph) => self.draw(*graph, cancel),
        }
    }

    /// Traces a scan.
    ///
    /// # Errors
    /// The estimators', the observers' and the token's.
    pub fn scan(&self, scan: &Scan, cancel: &Cancel) -> Result<Drawing> {
        let mut watch = Watch { observers: &self.observers, cancel: cancel.clone() };
        let graph = self.vectorizer.graph(scan, &mut watch)?;
        self.draw(graph, cancel)
    }

    fn draw(&self, graph: fieldtrace::graph::StrokeGraph, cancel: &Cancel) -> Result<Drawing> {
        let mut watch = Watch { observers: &self.observers, cancel: cancel.clone() };
        let drawing = self.vectorizer.draw(&graph, &mut watch)?;
        cancel.check()?;
        Ok(Drawing::new(drawing, Some(Arc::new(graph))))
    }
}

/// The vectorizer of some settings and functions.
///
/// # Errors
/// `OptionError`, and what is wrong with weights or functions.
pub fn vectorizer(settings: Settings, functions: &Bound<'_, PyDict>) -> PyResult<Vectorizer> {
    let py = functions.py();
    let field = Function::of(functions, "field_estimator")?.map(Field);
    let ink = Function::of(functions, "ink_estimator")?.map(Ink);
    let stage = Function::of(functions, "on_stage")?;
    let built = py.detach(|| {
        let estimator: Box<dyn FieldEstimator> = match field {
            Some(field) => Box::new(field),
            None => estimator(&settings)?,
        };
        let mut vectorizer = Vectorizer::with(settings.trace, estimator)?;
        for pass in &settings.without {
            vectorizer = vectorizer.without(pass)?;
        }
        if let Some(ink) = ink {
            vectorizer = vectorizer.with_ink_estimator(ink);
        }
        Ok(match stage {
            Some(stage) => vectorizer.reporting(teller(stage)),
            None => vectorizer,
        })
    });
    built.map_err(|e| crate::error::raised(py, &e))
}

fn estimator(settings: &Settings) -> Result<Box<dyn FieldEstimator>> {
    if settings.estimator == Estimator::Tensor {
        return Ok(Box::new(StructureTensor::default()));
    }
    let weights = settings.weights.as_deref().map_or_else(Weights::built_in, Weights::read)?;
    Ok(Box::new(UNet::new(&weights, Backend::named(&settings.device)?)?))
}
