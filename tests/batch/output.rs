//! What a batch writes, skips and says.

use crate::desk::Desk;
use std::collections::BTreeSet;
use std::fs::{self, File};
use std::time::{Duration, SystemTime};

#[test]
fn records_tell_everything_in_the_order_of_the_inputs() {
    let desk = Desk::with(&["in/b.png", "in/a.png", "in/c/d.png"]);
    desk.picture("in/blank.png", &fieldtrace::drawing::Drawing::new(20.0, 20.0));
    desk.put("in/bad.png", "this is no image");
    let run = desk.trace(&["in", "-r", "-o", "out", "--json", "--jobs", "3"]);
    run.ended(1, &["in/bad.png: this is not an image", "4 traced, 1 failed"]);
    let records = run.records();
    let inputs: Vec<&str> = records.iter().map(|r| r["input"].as_str().unwrap()).collect();
    assert_eq!(inputs, ["in/a.png", "in/b.png", "in/bad.png", "in/blank.png", "in/c/d.png"]);
    let keys = ["input", "output", "status", "seconds", "strokes", "junctions", "warnings", "error", "origin"];
    for record in &records {
        let found: BTreeSet<&str> = record.as_object().unwrap().keys().map(String::as_str).collect();
        assert_eq!(found, BTreeSet::from(keys));
        assert!(record["seconds"].as_f64().unwrap() > 0.0);
    }
    // The drawing of seed 0 is a cross.
    let cross = &records[1];
    assert_eq!((&cross["status"], &cross["output"]), (&"traced".into(), &"out/b.svg".into()));
    assert_eq!((&cross["strokes"], &cross["junctions"]), (&2.into(), &1.into()));
    assert!(cross["error"].is_null() && cross["warnings"].as_array().unwrap().is_empty());
    assert_eq!(cross["origin"]["program"], concat!("fieldtrace ", env!("CARGO_PKG_VERSION")));
    let bad = &records[2];
    assert_eq!(bad["status"], "failed");
    assert!(bad["error"].as_str().unwrap().contains("in/bad.png: this is not an image") && bad["strokes"].is_null());
    assert_eq!((&records[3]["strokes"], records[3]["warnings"].as_array().unwrap().len()), (&0.into(), 1));
    assert_eq!(desk.files("out"), ["a.svg", "b.svg", "blank.svg", "c/d.svg"]);
}

#[test]
fn newer_outputs_are_skipped_unless_forced() {
    let desk = Desk::with(&["in/a.png", "in/b.png", "in/c.png", "in/d.png"]);
    let words = ["in", "-o", "out", "--json"];
    let statuses = |words: &[&str]| -> Vec<String> {
        desk.trace(words).done().statuses().into_iter().map(|(_, status)| status).collect()
    };
    assert_eq!(statuses(&words), ["traced"; 4]);
    assert_eq!(statuses(&words), ["skipped"; 4]);
    assert_eq!(statuses(&["in", "-o", "out", "--json", "--force"]), ["traced"; 4]);
    // One input is newer, one output is gone, one is empty as after a power cut.
    let later = SystemTime::now() + Duration::from_secs(60);
    File::options().append(true).open(desk.path("in/a.png")).unwrap().set_modified(later).unwrap();
    fs::remove_file(desk.path("out/b.svg")).unwrap();
    desk.put("out/c.svg", "");
    assert_eq!(statuses(&words), ["traced", "traced", "traced", "skipped"]);
    assert!(!desk.read("out/c.svg").is_empty());
}

#[test]
fn other_options_are_another_trace_and_edited_outputs_are_kept() {
    let desk = Desk::with(&["in/a.png", "in/b.png"]);
    let statuses = |words: &[&str]| -> Vec<String> {
        desk.trace(&[&["in", "-o", "out", "--json"], words].concat()).statuses().into_iter().map(|(_, s)| s).collect()
    };
    assert_eq!(statuses(&[]), ["traced"; 2]);
    assert_eq!(statuses(&["--detail", "0.2"]), ["traced"; 2]);
    assert_eq!(statuses(&["--detail", "0.2"]), ["skipped"; 2]);
    let edited = desk.read("out/a.svg").replace("</svg>", "<!-- mine --></svg>");
    desk.put("out/a.svg", &edited);
    assert_eq!(statuses(&["--detail", "0.2"]), ["skipped"; 2]);
    assert_eq!(statuses(&["--detail", "0.3"]), ["failed", "traced"]);
    assert_eq!(desk.read("out/a.svg"), edited);
    assert_eq!(statuses(&["--detail", "0.3", "--force"]), ["traced"; 2]);
}

#[test]
fn files_of_other_kinds_are_counted() {
    let desk = Desk::with(&["in/a.png"]);
    desk.put("in/notes.txt", "notes");
    desk.put("in/table.ods", "table");
    let run = desk.trace(&["in", "-o", "out"]);
    assert!(run.done().stderr.contains("1 traced, 2 of other kinds left out"), "{}", run.stderr);
}

#[test]
fn the_summary_names_every_failure() {
    let desk = Desk::with(&["in/a.png", "in/b.png"]);
    for name in ["in/x.png", "in/y.png", "in/z.png"] {
        desk.put(name, "no image");
    }
    let run = desk.trace(&["in", "nosuch.png", "-o", "out"]);
    run.ended(1, &["in/x.png: ", "in/y.png: ", "in/z.png: ", "nosuch.png: cannot be read", "2 traced, 4 failed"]);
    assert_eq!(run.stderr.lines().count(), 5, "{}", run.stderr);
    assert!(run.stderr.lines().all(|line| line.starts_with("trace: ")), "{}", run.stderr);
    // Failures are told however quiet, and they are tried again while the rest is skipped.
    let again = desk.trace(&["in", "nosuch.png", "-o", "out", "--quiet"]);
    again.ended(1, &["in/x.png: ", "in/y.png: ", "in/z.png: ", "nosuch.png", "0 traced, 2 skipped", "4 failed"]);
}

#[test]
fn pipes_get_plain_lines_and_quiet_says_nothing() {
    let desk = Desk::with_many(3);
    desk.picture("in/blank.png", &fieldtrace::drawing::Drawing::new(20.0, 20.0));
    let run = desk.trace(&["in", "-o", "out"]);
    assert_eq!(run.done().stdout, "");
    let lines: Vec<&str> = run.stderr.lines().collect();
    assert!(matches!(lines[..], [warning, summary]
        if warning.starts_with("trace: in/blank.png: warning: no ink") && summary.starts_with("trace: 4 traced in ")));
    assert!(!run.stderr.contains(['\r', '\x1b']), "{:?}", run.stderr);
    for quiet in ["-q", "--quiet"] {
        let run = desk.trace(&["in", "-o", "out", quiet, "--force"]);
        assert_eq!((run.done().stderr.as_str(), run.stdout.as_str()), ("", ""));
    }
    let verbose = desk.trace(&["in", "-o", "out", "-v"]);
    verbose.done().ended(0, &["s  in/000.png: skipped", "s  in/blank.png: skipped"]);
}

/// What the program writes to a terminal, by way of `script`; `None` where there is none.
#[cfg(target_os = "linux")]
fn on_terminal(desk: &Desk, words: &str, environment: &[(&str, &str)]) -> Option<String> {
    let line = format!("{} {words}", env!("CARGO_BIN_EXE_trace"));
    let mut command = std::process::Command::new("script");
    command.args(["-qec", &line, "/dev/null"]).current_dir(desk.path("")).stdin(std::process::Stdio::null());
    command.env("TERM", "xterm").env_remove("NO_COLOR").envs(environment.iter().copied());
    let output = command.output().ok()?;
    assert!(output.status.success());
    Some(String::from_utf8_lossy(&output.stdout).into_owned())
}

#[cfg(target_os = "linux")]
#[test]
fn a_terminal_gets_a_progress_line() {
    let desk = Desk::with_many(12);
    let words = "in -o out --force --jobs 1";
    let Some(shown) = on_terminal(&desk, words, &[]) else { return };
    assert!(shown.contains(" of 12, ") && shown.contains(" left") && shown.contains("\x1b[36m"), "{shown:?}");
    let plain = on_terminal(&desk, words, &[("NO_COLOR", "1")]).unwrap();
    assert!(plain.contains(" of 12, ") && !plain.contains("\x1b[36m"), "{plain:?}");
    for silent in [format!("{words} -q"), format!("{words} 2>/dev/null")] {
        assert_eq!(on_terminal(&desk, &silent, &[]).unwrap(), "");
    }
}
