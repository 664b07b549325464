//! What a batch says while it runs and at its end.

use crate::Error;
use crate::batch::{Event, Job, Outcome, Plan, Traced};
use crate::cli::args::TalkArgs;
use crate::cli::failure::{Failure, one_line};
use crate::cli::target;
use crate::cli::vectorize::{EMPTY, UNLIKE};
use crate::write::Origin;
use indicatif::{ProgressBar, ProgressStyle};
use serde::Serialize;
use std::collections::BTreeMap;
use std::io::{self, Write};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// The progress line: how many are done, at what rate, how long it will take, and what was begun last.
const PROGRESS: &str = "{wide_bar:.cyan} {pos} of {len}, {per_sec}, {eta} left  {msg}";

/// Tells the progress on standard error and writes records to standard output.
pub(crate) struct Report {
    start: Instant,
    verbose: bool,
    quiet: bool,
    bar: ProgressBar,
    records: Option<Mutex<Records>>,
}

impl Report {
    /// Begins to tell. A progress line is drawn on a terminal only.
    pub(crate) fn new(plan: &Plan, talk: &TalkArgs, json: bool) -> Self {
        let bar = if talk.quiet { ProgressBar::hidden() } else { ProgressBar::new(plan.jobs.len() as u64) };
        bar.set_style(ProgressStyle::with_template(PROGRESS).unwrap_or_else(|_| ProgressStyle::default_bar()));
        bar.enable_steady_tick(Duration::from_millis(200));
        let records = json.then(|| {
            let mut records = Records::default();
            for error in &plan.unreadable {
                records.write(&Record::unreadable(error));
            }
            Mutex::new(records)
        });
        Self { start: Instant::now(), verbose: talk.verbose, quiet: talk.quiet, bar, records }
    }

    /// Tells an event.
    pub(crate) fn tell(&self, event: Event<&Job, Traced>) {
        match event {
            Event::Started { input: job, .. } => self.bar.set_message(target::name(&job.input)),
            Event::Finished { index, input: job, outcome } => {
                self.bar.inc(1);
                if self.verbose {
                    let (seconds, name) = (outcome.seconds, target::name(&job.input));
                    self.bar.suspend(|| eprintln!("{seconds:>8.3} s  {name}: {}", status(&outcome.result)));
                }
                if let Some(records) = &self.records {
                    let mut records = records.lock().unwrap_or_else(PoisonError::into_inner);
                    self.bar.suspend(|| records.finished(index, Record::of(job, outcome)));
                }
            }
        }
    }

    /// Names what went wrong and counts the rest; a failure if there was any.
    pub(crate) fn end(self, plan: &Plan, outcomes: &[Outcome<Traced>]) -> Result<(), Failure> {
        self.bar.finish_and_clear();
        for error in &plan.unreadable {
            eprintln!("trace: {}", Failure::of("", error));
        }
        let mut count = Count { failed: plan.unreadable.len(), others: plan.others, ..Count::default() };
        for (job, outcome) in plan.jobs.iter().zip(outcomes) {
            let name = target::name(&job.input);
            match &outcome.result {
                Err(Error::Cancelled) => count.left += 1,
                Err(error) => {
                    count.failed += 1;
                    eprintln!("trace: {}", Failure::of(&name, error));
                }
                Ok(Traced::Skipped) => count.skipped += 1,
                Ok(drawn) => {
                    count.traced += 1;
                    for warning in warnings(drawn).iter().filter(|_| !self.quiet) {
                        eprintln!("trace: {name}: warning: {warning}");
                    }
                }
            }
        }
        let text = count.text(self.start.elapsed());
        let unwritten = self.records.and_then(|r| r.into_inner().unwrap_or_else(PoisonError::into_inner).error);
        match unwritten {
            _ if count.left > 0 => Err(Failure::Interrupted(format!("interrupted: {text}"))),
            Some(error) => Err(Failure::File(format!("-: the records cannot be written: {error}; {text}"))),
            None if count.failed > 0 => Err(Failure::File(text)),
            None => {
                if !self.quiet {
                    eprintln!("trace: {text}");
                }
                Ok(())
            }
        }
    }
}

/// How many files there are of each kind.
#[derive(Default)]
struct Count {
    traced: usize,
    skipped: usize,
    failed: usize,
    left: usize,
    others: usize,
}

impl Count {
    fn text(&self, time: Duration) -> String {
        let kinds = [
            (self.traced, "traced"),
            (self.skipped, "skipped as done before"),
            (self.failed, "failed"),
            (self.left, "left undone"),
            (self.others, "of other kinds left out"),
        ];
        let told = kinds.iter().enumerate().filter(|(i, (count, _))| *i == 0 || *count > 0);
        let told: Vec<String> = told.map(|(_, (count, kind))| format!("{count} {kind}")).collect();
        format!("{} in {:.1} s", told.join(", "), time.as_secs_f64())
    }
}

fn status(result: &crate::Result<Traced>) -> &'static str {
    match result {
        Ok(Traced::Drawn { .. }) => "traced",
        Ok(Traced::Skipped) => "skipped",
        Err(Error::Cancelled) => "interrupted",
        Err(_) => "failed",
    }
}

fn warnings(traced: &Traced) -> &'static [&'static str] {
    match traced {
        Traced::Drawn { strokes: 0, fills: 0, .. } => &[EMPTY],
        Traced::Drawn { unlike: true, .. } => &[UNLIKE],
        _ => &[],
    }
}

/// A line of JSON about one file.
#[derive(Default, Serialize)]
struct Record {
    input: String,
    output: Option<String>,
    /// All outputs, where an input has several pages.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    outputs: Vec<String>,
    status: &'static str,
    seconds: f64,
    strokes: Option<usize>,
    junctions: Option<usize>,
    warnings: &'static [&'static str],
    error: Option<String>,
    /// What was made from what, and how.
    origin: Option<Origin>,
}

impl Record {
    fn of(job: &Job, outcome: &Outcome<Traced>) -> Self {
        let mut record = Self {
            input: job.input.display().to_string(),
            output: Some(job.output.display().to_string()),
            status: status(&outcome.result),
            seconds: outcome.seconds,
            warnings: outcome.result.as_ref().map_or(&[], warnings),
            error: outcome.result.as_ref().err().map(|e| one_line(e)),
            ..Self::default()
        };
        if let Ok(Traced::Drawn { strokes, junctions, outputs, origin, .. }) = &outcome.result {
            (record.strokes, record.junctions) = (Some(*strokes), Some(*junctions));
            record.origin = Some(Origin::clone(origin));
            if outputs.len() > 1 {
                record.outputs = outputs.iter().map(|output| output.display().to_string()).collect();
                record.output = None;
            }
        }
        record
    }

    /// What could not be listed; its name is in the message.
    fn unreadable(error: &Error) -> Self {
        let input = match error {
            Error::List { path, .. } => path.display().to_string(),
            _ => String::new(),
        };
        Self { input, status: "failed", error: Some(one_line(error)), ..Self::default() }
    }
}

/// Writes records in the order of the inputs, each as soon as those before it are written.
#[derive(Default)]
struct Records {
    next: usize,
    waiting: BTreeMap<usize, Record>,
    error: Option<io::Error>,
}

impl Records {
    fn finished(&mut self, index: usize, record: Record) {
        self.waiting.insert(index, record);
        while let Some(record) = self.waiting.remove(&self.next) {
            self.next += 1;
            self.write(&record);
        }
    }

    /// Writes one line, unless an earlier one could not be written. A reader that has gone away is not an error.
    fn write(&mut self, record: &Record) {
        if self.error.is_some() {
            return;
        }
        let mut out = io::stdout().lock();
        let line = serde_json::to_string(record).map_err(io::Error::from);
        match line.and_then(|line| writeln!(out, "{line}")).and_then(|()| out.flush()) {
            Err(e) if e.kind() != io::ErrorKind::BrokenPipe => self.error = Some(e),
            _ => {}
        }
    }
}
