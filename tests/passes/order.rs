//! The table of passes: every row says what it must, and leaving one out leaves out only that one.

use crate::common::draw::{circle, line, scan, sheet};
use crate::figure::Figure;
use fieldtrace::graph::passes;
use fieldtrace::options::Options;
use fieldtrace::pipeline::Vectorizer;
use std::collections::BTreeSet;
use std::path::Path;

/// Whether a file of the integration tests has a test of a name.
fn has_test(program: &str, test: &str) -> bool {
    let tests = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests");
    let texts = [
        tests.join(format!("{program}.rs")),
        tests.join(program).join("repairs.rs"),
        tests.join(program).join("finishes.rs"),
    ];
    texts
        .iter()
        .filter_map(|file| std::fs::read_to_string(file).ok())
        .any(|text| text.contains(&format!("fn {test}()")))
}

#[test]
fn every_pass_is_guarded_by_a_test_that_exists() {
    for pass in passes() {
        let (program, test) = pass.guarded_by.split_once("::").unwrap_or(("", ""));
        assert!(has_test(program, test), "{}: {:?}", pass.name, pass.guarded_by);
        assert!(!pass.why.is_empty(), "{}", pass.name);
    }
}

#[test]
fn names_are_each_passs_own() {
    let names: BTreeSet<&str> = passes().map(|pass| pass.name).collect();
    assert_eq!(names.len(), passes().count());
}

#[test]
fn a_pass_that_is_left_out_does_not_run() {
    let drawing = sheet(96, 96, vec![line((10.0, 40.0), (86.0, 44.0), 3.0), circle((48.0, 60.0), 17.0, 3.0)]);
    let figure = Figure::walked(&scan(&drawing), Options::default());
    for pass in passes() {
        let changes = figure.graph(&[pass.name]);
        assert!(!changes.trails.is_empty(), "{}", pass.name);
        assert!(figure.ran(&[pass.name]).iter().all(|name| *name != pass.name));
        assert_eq!(
            figure.ran(&[]).len(),
            figure.ran(&[pass.name]).len() + usize::from(figure.changes(pass.name).is_some())
        );
    }
}

#[test]
fn no_other_name_is_left_out() {
    let vectorizer = || Vectorizer::new(Options::default()).expect("the defaults are in range");
    for name in ["", "dots", "Cusp", "assemble"] {
        assert!(vectorizer().without(name).is_err(), "{name}");
    }
    assert!(vectorizer().without("cusp").is_ok());
}
