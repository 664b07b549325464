//! Many inputs on a number of threads, results as they come.

use crate::caller;
use crate::drawing::{Drawing, named};
use crate::error::raised;
use crate::hooks::Observers;
use crate::image::{Source, file};
use crate::options::{settings, write_options};
use crate::tracer::{Tracer, Work, vectorizer};
use fieldtrace::batch::{self, Destination, Event, FileTracer, Job, Plan, Traced, is_pattern};
use fieldtrace::cancel::Cancel;
use fieldtrace::load::pages_of_bytes;
use fieldtrace::write::graph_json::is_json;
use fieldtrace::{Error, Result};
use pyo3::exceptions::{PyRuntimeError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// How often signals are looked for.
const POLL: Duration = Duration::from_millis(40);
/// Results that may wait to be fetched.
const WAITING: usize = 64;

/// One input.
enum Item {
    /// A file that is traced to another.
    File(Job),
    /// An image whose drawing is kept.
    Image(Py<PyAny>),
    /// What could not be listed.
    Unreadable(String, Mutex<Option<Error>>),
}

/// What was made of one.
enum Made {
    /// Drawings, one for each page.
    Drawings(Mutex<Vec<Drawing>>),
    /// Files.
    Files(Traced),
}

/// What does the work.
enum Worker {
    /// In memory.
    Memory(Arc<Work>),
    /// To files.
    Files(Box<FileTracer>),
}

/// What became of one input: its place, the input, drawings, outputs, number of strokes, whether it was done before, the error,
/// seconds.
type Record = (usize, Py<PyAny>, Vec<Drawing>, Vec<PathBuf>, Option<usize>, bool, Option<PyErr>, f64);

/// A batch that runs; what `fieldtrace.Batch` is made of.
#[pyclass(frozen, module = "fieldtrace._native")]
pub struct Batch {
    parts: Mutex<Option<(Worker, Vec<Item>)>>,
    total: usize,
    others: usize,
    batch: batch::Batch,
    running: Mutex<Option<Running>>,
}

struct Running {
    records: Receiver<Record>,
    thread: JoinHandle<Result<()>>,
}

#[pymethods]
impl Batch {
    /// Over images whose drawings are kept.
    #[staticmethod]
    fn in_memory(
        tracer: &Tracer,
        inputs: Vec<Py<PyAny>>,
        recursive: bool,
        jobs: usize,
        timeout: Option<f64>,
        py: Python<'_>,
    ) -> PyResult<Self> {
        let mut items = Vec::new();
        let mut others = 0;
        for input in inputs {
            match listed(input.bind(py), recursive)? {
                None => items.push(Item::Image(input)),
                Some(plan) => {
                    others += plan.others;
                    for job in plan.jobs {
                        items.push(Item::Image(text(py, &job.input).unbind().into_any()));
                    }
                    items.extend(plan.unreadable.into_iter().map(unreadable));
                }
            }
        }
        Ok(Self::new(Worker::Memory(tracer.work()), items, others, jobs, limit(timeout)?))
    }

    /// Over files, each to one in a folder, or beside it.
    #[staticmethod]
    #[pyo3(signature = (options, functions, inputs, folder, format, force, recursive, jobs, timeout, write))]
    #[allow(clippy::too_many_arguments)]
    fn to_files(
        options: &Bound<'_, PyDict>,
        functions: &Bound<'_, PyDict>,
        inputs: Vec<PathBuf>,
        folder: PathBuf,
        format: &str,
        force: bool,
        recursive: bool,
        jobs: usize,
        timeout: Option<f64>,
        write: &Bound<'_, PyDict>,
    ) -> PyResult<Self> {
        let py = options.py();
        if let Some(name) = Observers::of(functions)?.first() {
            return Err(PyTypeError::new_err(format!(
                "{name} is for drawings in memory, not for a batch with an output"
            )));
        }
        let settings = settings(options)?;
        let (load, format, write) = (settings.load.clone(), named(py, format)?, write_options(Some(write))?);
        let fail = |e: Error| raised(py, &e);
        load.validate().map_err(fail)?;
        write.validate().map_err(fail)?;
        let tracer = FileTracer { load, format, write, force, ..FileTracer::new(vectorizer(settings, functions)?) };
        let to = Destination { folder: Some(folder), extension: format.name().into() };
        let plan = py.detach(|| Plan::new(&inputs, &to, recursive)).map_err(fail)?;
        let unlisted = plan.unreadable.into_iter().map(unreadable);
        let items = plan.jobs.into_iter().map(Item::File).chain(unlisted).collect();
        Ok(Self::new(Worker::Files(Box::new(tracer)), items, plan.others, jobs, limit(timeout)?))
    }

    /// Begins, where that has not been done; nothing is traced before.
    fn start(&self) {
        let Some((worker, items)) = lock(&self.parts).take() else { return };
        let batch = self.batch.clone();
        let (send, records) = sync_channel(WAITING);
        let thread = thread::spawn(move || work(&batch, &worker, items, &send));
        *lock(&self.running) = Some(Running { records, thread });
    }

    /// The next result, or None when there are no more. An exception of a signal's handler stops the batch.
    fn next(&self, py: Python<'_>) -> PyResult<Option<Record>> {
        self.start();
        loop {
            let next = py.detach(|| {
                let running = lock(&self.running);
                running.as_ref().map_or(Err(RecvTimeoutError::Disconnected), |r| r.records.recv_timeout(POLL))
            });
            match next {
                Ok(record) => return Ok(Some(record)),
                Err(RecvTimeoutError::Disconnected) => return self.end(py).map(|()| None),
                Err(RecvTimeoutError::Timeout) => {
                    if let Err(e) = py.check_signals() {
                        self.close(py);
                        return Err(e);
                    }
                }
            }
        }
    }

    /// Stops the batch and waits until it has stopped.
    fn close(&self, py: Python<'_>) {
        self.batch.cancel.cancel();
        drop(lock(&self.parts).take());
        py.detach(|| {
            if let Some(Running { records, thread }) = lock(&self.running).take() {
                drop(records);
                drop(thread.join());
            }
        });
    }

    /// Number of inputs.
    #[getter]
    fn total(&self) -> usize {
        self.total
    }

    /// Number of files of folders that are left out because they are of no kind that is read.
    #[getter]
    fn others(&self) -> usize {
        self.others
    }
}

impl Batch {
    fn new(worker: Worker, items: Vec<Item>, others: usize, jobs: usize, timeout: Option<Duration>) -> Self {
        let batch = batch::Batch { jobs, timeout, cancel: Cancel::default() };
        let total = items.len();
        Self { parts: Mutex::new(Some((worker, items))), total, others, batch, running: Mutex::new(None) }
    }

    /// Waits for the threads of a batch that is done.
    fn end(&self, py: Python<'_>) -> PyResult<()> {
        let running = lock(&self.running).take();
        let Some(Running { thread, .. }) = running else { return Ok(()) };
        match py.detach(|| thread.join()) {
            Ok(result) => result.map_err(|e| raised(py, &e)),
            Err(_) => Err(PyRuntimeError::new_err("the batch ended in a fault of the program")),
        }
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

fn limit(seconds: Option<f64>) -> PyResult<Option<Duration>> {
    let limit = |seconds| Duration::try_from_secs_f64(seconds).ok().filter(|limit| !limit.is_zero());
    let wrong = || pyo3::exceptions::PyValueError::new_err("timeout is to be a time in seconds above 0");
    seconds.map(|seconds| limit(seconds).ok_or_else(wrong)).transpose()
}

fn unreadable(error: Error) -> Item {
    let name = match &error {
        Error::List { path, .. } => path.display().to_string(),
        _ => String::new(),
    };
    Item::Unreadable(name, Mutex::new(Some(error)))
}

fn text<'py>(py: Python<'py>, path: &Path) -> Bound<'py, PyString> {
    PyString::new(py, &path.to_string_lossy())
}

/// The files that a folder or a pattern stands for; `None` for any other input.
fn listed(input: &Bound<'_, PyAny>, recursive: bool) -> PyResult<Option<Plan>> {
    if !input.is_instance_of::<PyString>() && !input.hasattr("__fspath__")? {
        return Ok(None);
    }
    let (py, path): (_, PathBuf) = (input.py(), input.extract()?);
    if !path.is_dir() && !is_pattern(&path) {
        return Ok(None);
    }
    // Nothing is written: an extension that no input has keeps outputs from meeting inputs.
    let nowhere = Destination { folder: None, extension: "in-memory".into() };
    py.detach(|| Plan::new(&[path], &nowhere, recursive)).map(Some).map_err(|e| raised(py, &e))
}

/// Works on all items and sends their records.
fn work(batch: &batch::Batch, worker: &Worker, items: Vec<Item>, send: &SyncSender<Record>) -> Result<()> {
    let tell = |event: Event<Item, Made>| {
        let Event::Finished { index, input, outcome } = event else { return };
        let record = Python::try_attach(|py| {
            let error = outcome.result.as_ref().err().map(|e| raised(py, e));
            let shown = match input {
                Item::File(job) => text(py, &job.input).unbind().into_any(),
                Item::Image(image) => image.clone_ref(py),
                Item::Unreadable(name, _) => PyString::new(py, name).unbind().into_any(),
            };
            let (mut drawings, mut outputs, mut strokes, mut skipped) = (Vec::new(), Vec::new(), None, false);
            match &outcome.result {
                Ok(Made::Drawings(made)) => {
                    drawings = std::mem::take(&mut *lock(made));
                    strokes = Some(drawings.iter().map(|drawing| drawing.drawing().strokes.len()).sum());
                }
                Ok(Made::Files(Traced::Drawn { strokes: count, outputs: files, .. })) => {
                    (strokes, outputs) = (Some(*count), files.clone());
                }
                Ok(Made::Files(Traced::Skipped)) => skipped = true,
                Err(_) => {}
            }
            (index, shown, drawings, outputs, strokes, skipped, error, outcome.seconds)
        });
        // Nobody may listen any more.
        if record.is_none_or(|record| send.send(record).is_err()) {
            batch.cancel.cancel();
        }
    };
    let one = |item: &Item, cancel: &Cancel| caller::within(None, cancel, |cancel| made(worker, item, cancel));
    batch.run(items, one, tell).map(drop)
}

/// What is made of one item.
fn made(worker: &Worker, item: &Item, cancel: &Cancel) -> Result<Made> {
    match (worker, item) {
        (Worker::Files(tracer), Item::File(job)) => tracer.trace(job, cancel).map(Made::Files),
        (Worker::Memory(work), Item::Image(image)) => {
            let source = caller::call("the input", {
                let image = Python::attach(|py| image.clone_ref(py));
                move |py| Source::of(image.bind(py))
            })?;
            drawings(work, source, cancel).map(|drawings| Made::Drawings(Mutex::new(drawings)))
        }
        (_, Item::Unreadable(_, error)) => Err(lock(error).take().unwrap_or(Error::Cancelled)),
        _ => Err(Error::Cancelled),
    }
}

/// The drawings of all pages of an image.
fn drawings(work: &Work, source: Source, cancel: &Cancel) -> Result<Vec<Drawing>> {
    let name = source.name();
    let bytes = match source {
        Source::File(path) => file(&path)?,
        Source::Bytes(bytes) => bytes,
        Source::Image(..) => return Ok(vec![work.trace(source, cancel)?]),
    };
    if is_json(&bytes) {
        return Ok(vec![work.trace(Source::Bytes(bytes), cancel)?]);
    }
    let pages = pages_of_bytes(&name, bytes, work.load())?;
    pages.iter().map(|(_, page)| work.scan(&page?.scan, cancel)).collect()
}
