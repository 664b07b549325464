//! Many cases of one rule, and the share of them that keep it.

use rayon::prelude::*;
use std::fmt::Debug;

/// Runs a rule over cases and requires that at least `floor` of them, as a share, keep it.
///
/// The failures are printed with what was wrong with each; with `-- --nocapture` the share is seen too.
#[track_caller]
pub fn sweep<C: Debug + Sync>(name: &str, floor: f64, cases: &[C], rule: impl Fn(&C) -> Result<(), String> + Sync) {
    require(name, floor, share(name, cases, rule));
}

/// Requires a share.
#[track_caller]
pub fn require(name: &str, floor: f64, share: f64) {
    assert!(share >= floor, "{name}: {share:.3} of the cases hold, {floor} must");
}

/// Runs a rule over cases and prints and gives the share of them that keep it.
pub fn share<C: Debug + Sync>(name: &str, cases: &[C], rule: impl Fn(&C) -> Result<(), String> + Sync) -> f64 {
    let results: Vec<Result<(), String>> = cases.par_iter().map(&rule).collect();
    report(name, cases, &results)
}

/// Prints and gives the share of the cases that keep a rule, and what is wrong with the others.
pub fn report<C: Debug>(name: &str, cases: &[C], results: &[Result<(), String>]) -> f64 {
    let passed = results.iter().filter(|r| r.is_ok()).count();
    let share = passed as f64 / cases.len() as f64;
    let failed = |(case, result): (&C, &Result<(), String>)| Some(format!("\n  {case:?}: {}", result.as_ref().err()?));
    let failures: String = cases.iter().zip(results).filter_map(failed).collect();
    println!("{name}: {passed} of {} cases, {share:.3}{failures}", cases.len());
    share
}

/// An error with a reason unless a condition holds.
pub fn ensure(condition: bool, reason: impl FnOnce() -> String) -> Result<(), String> {
    if condition { Ok(()) } else { Err(reason()) }
}

/// All pairs of two lists.
pub fn pairs<A: Copy, B: Copy>(a: &[A], b: &[B]) -> Vec<(A, B)> {
    a.iter().flat_map(|&a| b.iter().map(move |&b| (a, b))).collect()
}

/// Numbers from a first to a last, both included.
pub fn steps(first: f64, last: f64, step: f64) -> Vec<f64> {
    let count = ((last - first) / step).round() as usize;
    (0..=count).map(|i| first + step * i as f64).collect()
}
