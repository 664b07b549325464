//! Any work over any inputs, on a number of threads.

use crate::cancel::Cancel;
use crate::error::{Error, Result};
use rayon::ThreadPoolBuilder;
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// Stack of a thread in bytes: decoders and SVG readers nest deeper than a thread's usual two megabytes allow.
const STACK: usize = 16 << 20;

/// How a batch is run.
#[derive(Clone, Debug, Default)]
pub struct Batch {
    /// Threads, and with them the inputs that are worked on at a time; 0 is as many as there are cores.
    pub jobs: usize,
    /// The longest that one input may take.
    pub timeout: Option<Duration>,
    /// Stops the batch: inputs that are being worked on are given up and no others are begun.
    pub cancel: Cancel,
}

/// What became of one input.
#[derive(Debug)]
pub struct Outcome<R> {
    /// The work's result; [`Error::Cancelled`] where the batch was stopped before or during it.
    pub result: Result<R>,
    /// How long it took in seconds; 0 where it was not begun.
    pub seconds: f64,
}

/// What a batch tells while it runs, from any of its threads.
#[derive(Debug)]
pub enum Event<'a, T, R> {
    /// Work on an input begins.
    Started {
        /// Its place among the inputs.
        index: usize,
        /// The input.
        input: &'a T,
    },
    /// An input is done with; that happens once for each, in no certain order.
    Finished {
        /// Its place among the inputs.
        index: usize,
        /// The input.
        input: &'a T,
        /// What became of it.
        outcome: &'a Outcome<R>,
    },
}

impl Batch {
    /// Works on every input and gives the outcomes in the order of the inputs.
    ///
    /// Each thread takes the next input when it is done with one, and those that find none left help the others with
    /// the parallel parts of theirs. The work is given the token that it has to poll. An error or a panic of the work
    /// is the outcome of that input alone.
    ///
    /// # Errors
    /// [`Error::Option`] when the threads cannot be had.
    pub fn run<T, R, I>(
        &self,
        inputs: I,
        work: impl Fn(&T, &Cancel) -> Result<R> + Sync,
        tell: impl Fn(Event<T, R>) + Sync,
    ) -> Result<Vec<Outcome<R>>>
    where
        T: Sync,
        R: Send + Sync,
        I: IntoIterator<Item = T>,
    {
        let inputs: Vec<T> = inputs.into_iter().collect();
        let jobs = if self.jobs > 0 { self.jobs } else { rayon::current_num_threads() };
        let pool = ThreadPoolBuilder::new()
            .num_threads(jobs)
            .stack_size(STACK)
            .build()
            .map_err(|e| Error::Option { option: "jobs", reason: format!("{jobs} threads cannot be had: {e}") })?;
        let outcomes: Vec<OnceLock<Outcome<R>>> = inputs.iter().map(|_| OnceLock::new()).collect();
        let next = AtomicUsize::new(0);
        pool.broadcast(|_| {
            loop {
                let index = next.fetch_add(1, Ordering::Relaxed);
                let Some(input) = inputs.get(index) else { break };
                let outcome = outcomes[index].get_or_init(|| {
                    self.cancel.check().map_or_else(
                        |e| Outcome { result: Err(e), seconds: 0.0 },
                        |()| {
                            tell(Event::Started { index, input });
                            self.one(input, &work)
                        },
                    )
                });
                tell(Event::Finished { index, input, outcome });
            }
        });
        Ok(outcomes.into_iter().filter_map(OnceLock::into_inner).collect())
    }

    /// The outcome of one input.
    fn one<T, R>(&self, input: &T, work: impl Fn(&T, &Cancel) -> Result<R>) -> Outcome<R> {
        let start = Instant::now();
        let cancel = self.timeout.map_or_else(|| self.cancel.clone(), |limit| self.cancel.within(limit));
        let result = catch_unwind(AssertUnwindSafe(|| work(input, &cancel)))
            .unwrap_or_else(|panic| Err(Error::Panicked { reason: words(&*panic) }));
        Outcome { result, seconds: start.elapsed().as_secs_f64() }
    }
}

/// What a panic says of itself, in one line.
fn words(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().copied().or(panic.downcast_ref::<String>().map(String::as_str));
    text.unwrap_or("it does not say what").split_whitespace().collect::<Vec<_>>().join(" ")
}
