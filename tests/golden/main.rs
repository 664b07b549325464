//! Every stage on the samples, beside what it gave before.
//!
//! A folder a stage, a file a sample. Compared by geometry, not by bytes: a change that moves a line by less than the
//! tolerance passes. After a change that is meant, look at `trace --debug-dir` and refresh all files with
//!
//! `FIELDTRACE_BLESS=1 cargo test --test golden`

#[path = "../common/mod.rs"]
mod common;
mod stages;

use fieldtrace::load::{LoadOptions, Scan, load};
use stages::Stages;
use std::fs;
use std::path::{Path, PathBuf};

const SAMPLES: [&str; 4] = ["kettle.png", "plan.png", "boat.png", "leaf.jpg"];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn scan(sample: &str) -> Scan {
    load(&root().join("samples").join(sample), &LoadOptions::default()).expect("the sample").scan
}

fn golden_file(stage: &str, sample: &str, extension: &str) -> PathBuf {
    root().join("tests/golden").join(stage).join(sample).with_extension(extension)
}

/// Compares what a stage gives on every sample with the golden files, or writes them anew.
#[track_caller]
fn check(
    stage: &str,
    extension: &str,
    text: impl Fn(&Stages) -> String,
    compare: impl Fn(&str, &str) -> Result<(), String>,
) {
    let bless = std::env::var_os("FIELDTRACE_BLESS").is_some_and(|v| v != "0");
    let mut wrong = Vec::new();
    for sample in SAMPLES {
        let now = text(&Stages::of(&scan(sample)));
        let file = golden_file(stage, sample, extension);
        if bless {
            fs::create_dir_all(file.parent().expect("a folder")).expect("the folder");
            fs::write(&file, now).expect("the golden file");
            continue;
        }
        let before = fs::read_to_string(&file).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
        if let Err(reason) = compare(&before, &now) {
            wrong.push(format!("{stage} of {sample}: {reason}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn clean() {
    check("clean", "json", stages::clean_text, stages::compare_clean);
}

#[test]
fn field() {
    check("field", "json", stages::field_text, stages::compare_field);
}

#[test]
fn streamlines() {
    check("streamlines", "json", stages::streamlines_text, stages::compare_streamlines);
}

#[test]
fn graph() {
    check("graph", "json", stages::graph_text, stages::compare_graph);
}

#[test]
fn fit() {
    check("fit", "svg", stages::fit_text, stages::compare_fit);
}

/// A comparison that lets everything pass would go unnoticed.
#[test]
fn the_comparisons_see_a_difference() {
    let (one, other) = (Stages::of(&scan("kettle.png")), Stages::of(&scan("boat.png")));
    type Text = fn(&Stages) -> String;
    type Compare = fn(&str, &str) -> Result<(), String>;
    let all: [(Text, Compare); 5] = [
        (stages::clean_text, stages::compare_clean),
        (stages::field_text, stages::compare_field),
        (stages::streamlines_text, stages::compare_streamlines),
        (stages::graph_text, stages::compare_graph),
        (stages::fit_text, stages::compare_fit),
    ];
    for (text, compare) in all {
        assert_eq!(compare(&text(&one), &text(&one)), Ok(()));
        assert!(compare(&text(&one), &text(&other)).is_err());
    }
}
