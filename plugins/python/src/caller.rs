//! Between Python's thread and the one that works for it.
//!
//! A trace runs on a thread of its own while the one that asked for it waits without the interpreter's lock, looks for signals,
//! and runs whatever functions of the caller's own the trace calls: these see the thread that they expect.

use fieldtrace::cancel::Cancel;
use fieldtrace::{Error, Result};
use pyo3::prelude::*;
use rayon::ThreadPool;
use std::cell::RefCell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::thread;
use std::time::Duration;

/// How often signals are looked for.
const POLL: Duration = Duration::from_millis(40);
/// Stack of the thread that works, in bytes: decoders and SVG readers nest deep.
const STACK: usize = 16 << 20;

/// What the waiting thread is asked to run.
type Task = Box<dyn FnOnce(Python<'_>) + Send>;

/// For whom this thread works.
struct Caller {
    /// The waiting thread; functions of a batch, for which nobody waits, are run where they are called.
    post: Option<Sender<Task>>,
    /// Stops this piece of work.
    cancel: Cancel,
    /// What a function raised that has no way of its own to say so.
    failure: Option<PyErr>,
}

thread_local! {
    static CALLER: RefCell<Option<Caller>> = const { RefCell::new(None) };
}

/// Runs work on a thread of its own, with a token that is cancelled by an exception of a signal's handler, as Ctrl-C's.
///
/// # Errors
/// That exception, or the work's.
pub fn run<R: Send>(py: Python<'_>, work: impl FnOnce(&Cancel) -> Result<R> + Send) -> PyResult<R> {
    let cancel = Cancel::default();
    let mut raised = None;
    let result = py.detach(|| {
        thread::scope(|scope| {
            let (post, tasks) = channel::<Task>();
            let cancel = &cancel;
            let body = move || on_threads(|| within(Some(post), cancel, work));
            let worker = thread::Builder::new().stack_size(STACK).spawn_scoped(scope, body).map_err(threadless)?;
            loop {
                match tasks.recv_timeout(POLL) {
                    Ok(task) => Python::attach(task),
                    Err(RecvTimeoutError::Disconnected) => break,
                    Err(RecvTimeoutError::Timeout) => {
                        if let Err(e) = Python::attach(|py| py.check_signals()) {
                            cancel.cancel();
                            raised = Some(e);
                        }
                    }
                }
            }
            worker.join().unwrap_or_else(|_| Err(Error::Panicked { reason: "a thread ended early".into() }))
        })
    });
    match raised {
        Some(e) => Err(e),
        None => result.map_err(|e| crate::error::raised(py, &e)),
    }
}

fn threadless(cause: std::io::Error) -> Error {
    Error::caller("starting a thread", cause)
}

/// Runs a piece of work that is stopped by a token, or by a function of the caller's that fails.
///
/// # Errors
/// The work's.
pub fn within<R>(post: Option<Sender<Task>>, cancel: &Cancel, work: impl FnOnce(&Cancel) -> Result<R>) -> Result<R> {
    let own = Cancel::default().or(cancel);
    CALLER.set(Some(Caller { post, cancel: own.clone(), failure: None }));
    let result = catch_unwind(AssertUnwindSafe(|| work(&own)));
    let failure = CALLER.take().and_then(|caller| caller.failure);
    match (failure, result) {
        (Some(failure), _) => Err(Error::caller("a function of the caller's", failure)),
        (None, Ok(result)) => result,
        (None, Err(panic)) => {
            let text = panic.downcast_ref::<&str>().copied().or(panic.downcast_ref::<String>().map(String::as_str));
            Err(Error::Panicked { reason: text.unwrap_or("it does not say what").into() })
        }
    }
}

/// Runs something with the interpreter's lock: on the thread that waits for this one's work, or else here.
///
/// # Errors
/// What it raises, as the failure of a part of the caller's own; it comes out of the trace as it was raised.
pub fn call<R: Send + 'static>(part: &str, task: impl FnOnce(Python<'_>) -> PyResult<R> + Send + 'static) -> Result<R> {
    let post = CALLER.with_borrow(|caller| caller.as_ref().and_then(|caller| caller.post.clone()));
    let result = match post {
        None => Python::attach(task),
        Some(post) => {
            let (answer, answers) = channel();
            // The waiting thread is there for as long as this one works.
            let _ = post.send(Box::new(move |py| drop(answer.send(task(py)))));
            drop(post);
            answers.recv().map_err(|_| Error::Cancelled)?
        }
    };
    result.map_err(|e| Error::caller(part, e))
}

/// Stops the work that this thread is at, which then fails with an exception.
pub fn fail(error: Error) {
    let Error::Caller { cause, .. } = error else { return };
    CALLER.with_borrow_mut(|caller| {
        if let (Some(caller), Ok(raised)) = (caller.as_mut(), cause.downcast::<PyErr>()) {
            caller.cancel.cancel();
            caller.failure.get_or_insert(*raised);
        }
    });
}

/// Runs work where its parallel parts have threads.
///
/// A process that was forked has none of the threads that its parent had: there a pool of its own stands in for the global one.
fn on_threads<R: Send>(work: impl FnOnce() -> R + Send) -> R {
    static FIRST: OnceLock<u32> = OnceLock::new();
    static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);
    let process = std::process::id();
    if *FIRST.get_or_init(|| process) == process {
        return work();
    }
    let pool = {
        let mut kept = POOL.lock().unwrap_or_else(PoisonError::into_inner);
        match &*kept {
            Some((owner, pool)) if *owner == process => Some(pool.clone()),
            _ => {
                // A parent's pool cannot be ended here: it waits for threads that do not exist.
                std::mem::forget(kept.take());
                let pool = rayon::ThreadPoolBuilder::new().stack_size(STACK).build().map(Arc::new).ok();
                *kept = pool.clone().map(|pool| (process, pool));
                pool
            }
        }
    };
    match pool {
        Some(pool) => pool.install(work),
        None => work(),
    }
}
