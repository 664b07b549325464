//! Many inputs in one go.
//!
//! A [`Plan`] says what is to be traced to where: inputs are found, outputs that would meet are refused, and a
//! [`Share`] of it may be taken. A [`Batch`] runs any work over any inputs on a number of threads, one of them at a
//! time on each, and gives a result for each whatever happens to the others. [`FileTracer`] is the work of a plan's
//! jobs: it reads, traces and writes one file, unless that has been done before.
//!
//! ```
//! use fieldtrace::batch::{Batch, Destination, Event, FileTracer, Plan};
//! use fieldtrace::options::Options;
//! use fieldtrace::pipeline::Vectorizer;
//!
//! # let folder = tempfile::tempdir()?;
//! # let folder = folder.path();
//! let plan = Plan::new(&["samples/*.png".into(), "samples/leaf.jpg".into()], &Destination::folder(folder), false)?;
//! let tracer = FileTracer::new(Vectorizer::new(Options::default())?);
//! let say = |event: Event<_, _>| {
//!     if let Event::Started { input, .. } = event {
//!         println!("{input:?}");
//!     }
//! };
//! let outcomes = Batch::default().run(&plan.jobs, |job, cancel| tracer.trace(job, cancel), say)?;
//! assert!(outcomes.iter().all(|outcome| outcome.result.is_ok()));
//! assert!(folder.join("kettle.svg").exists() && folder.join("leaf.svg").exists());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod file;
mod find;
mod plan;
mod run;

pub use file::{FileTracer, Traced, page_path, title_of};
pub use find::is_pattern;
pub use plan::{Destination, Job, Plan, Share};
pub use run::{Batch, Event, Outcome};
