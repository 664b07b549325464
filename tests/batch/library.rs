//! Batches in the library.

use crate::common::draw::{line, scan, sheet};
use crate::desk::{Desk, large};
use fieldtrace::Error;
use fieldtrace::batch::{Batch, Destination, Event, FileTracer, Plan, Share, Traced};
use fieldtrace::cancel::Cancel;
use fieldtrace::clean::LineImage;
use fieldtrace::drawing::Drawing;
use fieldtrace::estimate::FieldEstimator;
use fieldtrace::field::PolyVectorField;
use fieldtrace::graph::StrokeGraph;
use fieldtrace::hooks::Observer;
use fieldtrace::load::Scan;
use fieldtrace::options::Options;
use fieldtrace::pipeline::Vectorizer;
use fieldtrace::streamline::Streamline;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

fn vectorizer() -> Vectorizer {
    Vectorizer::new(Options::default()).unwrap()
}

fn batch(jobs: usize) -> Batch {
    Batch { jobs, ..Batch::default() }
}

#[test]
fn outcomes_keep_the_order_of_the_inputs_and_every_input_is_told() {
    for jobs in [0, 1, 2, 5, 64] {
        let (started, finished) = (Mutex::new(Vec::new()), Mutex::new(Vec::new()));
        let tell = |event: Event<u64, u64>| match event {
            Event::Started { index, input } => started.lock().unwrap().push((index, *input)),
            Event::Finished { index, input, outcome } => {
                assert_eq!(outcome.result.as_ref().unwrap(), &(input * input));
                finished.lock().unwrap().push((index, *input));
            }
        };
        let outcomes = batch(jobs).run((0..40).map(|i| 3 * i), |x, _| Ok(x * x), tell).unwrap();
        let squares: Vec<u64> = outcomes.into_iter().map(|o| o.result.unwrap()).collect();
        assert_eq!(squares, (0..40).map(|i| 9 * i * i).collect::<Vec<_>>());
        for told in [started, finished] {
            let mut told = told.into_inner().unwrap();
            told.sort_unstable();
            assert_eq!(told, (0..40).map(|i| (i as usize, 3 * i)).collect::<Vec<_>>());
        }
    }
    assert!(batch(2).run([0; 0], |_, _| Ok(()), |_| {}).unwrap().is_empty());
}

#[test]
fn no_more_inputs_are_worked_on_than_there_are_jobs() {
    for jobs in [1, 2, 4] {
        let (now, most) = (AtomicUsize::new(0), AtomicUsize::new(0));
        let work = |_: &i32, _: &Cancel| {
            most.fetch_max(now.fetch_add(1, Ordering::SeqCst) + 1, Ordering::SeqCst);
            std::thread::sleep(Duration::from_millis(3));
            now.fetch_sub(1, Ordering::SeqCst);
            Ok(())
        };
        batch(jobs).run(0..24, work, |_| {}).unwrap();
        assert!(most.into_inner() <= jobs);
    }
}

#[test]
fn scans_in_memory_are_traced_like_alone() {
    let scans: Vec<Scan> =
        (0..6).map(|i| scan(&sheet(60, 40, vec![line((8.0, 8.0 + 4.0 * f64::from(i)), (52.0, 30.0), 3.0)]))).collect();
    let vectorizer = vectorizer();
    let work = |scan: &&Scan, _: &Cancel| vectorizer.trace(scan);
    for (outcome, scan) in batch(3).run(&scans, work, |_| {}).unwrap().into_iter().zip(&scans) {
        assert_eq!(outcome.result.unwrap(), vectorizer.trace(scan).unwrap());
    }
}

/// Panics on narrow drawings.
struct Fragile;

impl FieldEstimator for Fragile {
    fn name(&self) -> &str {
        "fragile"
    }

    fn estimate(&self, image: &LineImage) -> fieldtrace::Result<PolyVectorField> {
        assert!(image.ink.width() >= 48, "too narrow:\n {} pixels", image.ink.width());
        fieldtrace::estimate::StructureTensor::default().estimate(image)
    }
}

#[test]
fn a_panic_is_the_failure_of_its_file_alone() {
    let desk = Desk::with_many(8);
    desk.picture("in/003.png", &sheet(40, 40, vec![line((8.0, 8.0), (32.0, 30.0), 3.0)]));
    let tracer = FileTracer::new(vectorizer().with_estimator(Fragile));
    let plan = Plan::new(&[desk.path("in")], &Destination::folder(desk.path("out")), false).unwrap();
    for jobs in [1, 3] {
        let outcomes = batch(jobs).run(&plan.jobs, |job, cancel| tracer.trace(job, cancel), |_| {}).unwrap();
        for (i, outcome) in outcomes.iter().enumerate() {
            match &outcome.result {
                Err(Error::Panicked { reason }) => {
                    assert_eq!((i, reason.as_str()), (3, "too narrow: 40 pixels"));
                }
                result => assert!(result.is_ok() && i != 3, "{i}: {result:?}"),
            }
        }
    }
    assert_eq!(desk.files("out").len(), 7);
}

#[test]
fn a_panic_in_a_parallel_part_is_caught_too() {
    use rayon::prelude::*;
    let work = |i: &usize, _: &Cancel| -> fieldtrace::Result<usize> {
        Ok((0..1000).into_par_iter().map(|k| if *i == 5 && k == 700 { panic!("at {k}") } else { 1 }).sum())
    };
    for jobs in [1, 4] {
        let outcomes = batch(jobs).run(0..12, work, |_| {}).unwrap();
        for (i, outcome) in outcomes.into_iter().enumerate() {
            match outcome.result {
                Err(Error::Panicked { reason }) => assert_eq!((i, reason.as_str()), (5, "at 700")),
                result => assert_eq!((result.unwrap(), i == 5), (1000, false)),
            }
        }
    }
}

#[test]
fn a_stopped_batch_begins_nothing_more() {
    for jobs in [1, 3] {
        let batch = batch(jobs);
        let begun = AtomicUsize::new(0);
        let work = |_: &usize, _: &Cancel| {
            if begun.fetch_add(1, Ordering::SeqCst) == 4 {
                batch.cancel.cancel();
            }
            Ok(())
        };
        let told = AtomicUsize::new(0);
        let tell = |event: Event<usize, ()>| {
            if let Event::Finished { .. } = event {
                told.fetch_add(1, Ordering::SeqCst);
            }
        };
        let outcomes = batch.run(0..50, work, tell).unwrap();
        let undone = outcomes.iter().filter(|o| matches!(o.result, Err(Error::Cancelled))).count();
        let begun = begun.load(Ordering::SeqCst);
        assert_eq!((outcomes.len(), undone + begun, told.into_inner()), (50, 50, 50));
        assert!((5..5 + jobs).contains(&begun), "{begun}");
    }
}

#[test]
fn the_time_of_a_file_is_its_own() {
    let desk = Desk::with_many(4);
    desk.picture("in/net.png", &large());
    let tracer = FileTracer::new(vectorizer());
    let plan = Plan::new(&[desk.path("in")], &Destination::folder(desk.path("out")), false).unwrap();
    let limit = Duration::from_nanos(1);
    let rushed = Batch { timeout: Some(limit), ..batch(2) };
    for outcome in rushed.run(&plan.jobs, |job, cancel| tracer.trace(job, cancel), |_| {}).unwrap() {
        assert!(matches!(outcome.result, Err(Error::TimedOut { limit: told }) if told == limit));
    }
    assert!(desk.files("out").is_empty());
    let ample = Batch { timeout: Some(Duration::from_secs(3600)), ..batch(2) };
    let outcomes = ample.run(&plan.jobs, |job, cancel| tracer.trace(job, cancel), |_| {}).unwrap();
    assert!(outcomes.iter().all(|o| matches!(o.result, Ok(Traced::Drawn { .. }))));
}

/// Stops the trace when it sees the result of a stage, and counts what it sees after that.
struct Stopper {
    at: usize,
    seen: usize,
    cancel: Cancel,
}

impl Stopper {
    fn see(&mut self, stage: usize) {
        assert!(self.cancel.check().is_ok() || stage == self.at, "stage {stage} was reached after {}", self.at);
        self.seen = stage;
        if stage == self.at {
            self.cancel.cancel();
        }
    }
}

impl Observer for Stopper {
    fn cancel(&self) -> Cancel {
        self.cancel.clone()
    }
    fn on_line_image(&mut self, _: &mut LineImage) -> fieldtrace::Result<()> {
        self.see(1);
        Ok(())
    }
    fn on_field(&mut self, _: &LineImage, _: &mut PolyVectorField) -> fieldtrace::Result<()> {
        self.see(2);
        Ok(())
    }
    fn on_streamline(&mut self, _: &LineImage, _: &mut Streamline) -> fieldtrace::Result<bool> {
        self.see(3);
        Ok(true)
    }
    fn on_graph(&mut self, _: &LineImage, _: &mut StrokeGraph) -> fieldtrace::Result<()> {
        self.see(4);
        Ok(())
    }
    fn on_drawing(&mut self, _: &mut Drawing) -> fieldtrace::Result<()> {
        self.see(5);
        Ok(())
    }
}

#[test]
fn every_stage_polls_the_token() {
    let scan = scan(&large());
    for at in 0..=6 {
        let cancel = Cancel::default();
        if at == 0 {
            cancel.cancel();
        }
        let mut stopper = Stopper { at, seen: 0, cancel };
        let result = vectorizer().trace_observed(&scan, &mut stopper);
        match at {
            0..=4 => assert!(matches!(result, Err(Error::Cancelled)) && stopper.seen == at, "{at}"),
            _ => assert!(result.is_ok() && stopper.seen == 5),
        }
    }
}

#[test]
fn shares_divide_any_list() {
    let desk = Desk::new();
    (0..23).for_each(|i| desk.put(&format!("in/{i}.png"), "x"));
    let plan = || Plan::new(&[desk.path("in")], &Destination::folder(desk.path("out")), false).unwrap();
    for count in [1, 2, 5, 23, 40] {
        let share = |number: usize| plan().share(format!("{number}/{count}").parse::<Share>().unwrap()).jobs;
        let mut all: Vec<_> = (1..=count).flat_map(share).collect();
        let sizes: Vec<usize> = (1..=count).map(|number| share(number).len()).collect();
        assert!(sizes.iter().max().unwrap() - sizes.iter().min().unwrap() <= 1, "{sizes:?}");
        all.sort();
        assert_eq!(all, plan().jobs);
    }
}
