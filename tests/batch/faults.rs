//! Things that break while a batch runs: nothing is lost, nothing is half written, every input is accounted for.

use crate::desk::{Desk, Run, assert_whole, large};
use std::fs;
use std::os::unix::fs::symlink;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant, SystemTime};

/// Waits until a folder has some files.
pub fn wait_for_files(folder: &Path, child: &mut Child) {
    let start = Instant::now();
    let svgs = || {
        fs::read_dir(folder)
            .into_iter()
            .flatten()
            .flatten()
            .filter(|e| e.path().extension().is_some_and(|e| e == "svg"))
    };
    while svgs().next().is_none() {
        assert!(start.elapsed() < Duration::from_secs(60) && child.try_wait().unwrap().is_none(), "nothing is written");
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// Runs a line of shell in the folder, where `trace` is the program.
fn shell(desk: &Desk, line: &str) -> Run {
    let line = line.replace("trace", env!("CARGO_BIN_EXE_trace"));
    let mut command = Command::new("sh");
    command.args(["-c", &line]).current_dir(desk.path("")).stdin(Stdio::null());
    Run::of(command.output().unwrap())
}

#[test]
fn a_folder_that_cannot_be_made_is_said_before_any_work() {
    let desk = Desk::with_many(3);
    desk.put("file", "kept");
    for output in ["file/out", "file/", "/proc/none/out", "/dev/null/out"] {
        desk.trace(&["in", "-o", output]).ended(1, &[output.trim_end_matches('/'), "cannot be written"]);
    }
    desk.trace(&["in", "-o", "file"]).ended(1, &["file: cannot be written"]);
    assert_eq!(desk.read("file"), "kept");
}

#[test]
fn a_folder_that_refuses_files_fails_each_of_them() {
    let desk = Desk::with_many(3);
    desk.draw("in/sub/x.png", 9);
    // Nobody makes files in /proc, and a file is in the way of the folder `sub`.
    let run = desk.trace(&["in", "-o", "/proc", "--json"]);
    assert_eq!(run.ended(1, &["/proc/000.svg: cannot be written", "/proc/002.svg", "3 failed"]).count("failed"), 3);
    desk.put("out/sub", "in the way");
    let run = desk.trace(&["in", "-r", "-o", "out", "--json"]);
    assert_eq!(run.ended(1, &["out/sub: cannot be written", "3 traced, 1 failed"]).count("traced"), 3);
    assert_eq!(desk.files("out"), ["000.svg", "001.svg", "002.svg", "sub"]);
}

#[test]
fn a_full_disk_fails_what_does_not_fit_and_keeps_the_rest() {
    let desk = Desk::with_many(4);
    desk.trace(&["in", "-o", "whole"]).done();
    // No file may be written to.
    let run = shell(&desk, "trap '' XFSZ; ulimit -f 0; trace in -o out --json");
    assert_eq!(run.ended(1, &["out/000.svg: cannot be written", "0 traced, 4 failed"]).count("failed"), 4);
    assert!(desk.files("out").is_empty(), "{:?}", desk.files("out"));
    // Older outputs stay as they were.
    desk.put("out/002.svg", "older");
    let run = shell(&desk, "trap '' XFSZ; ulimit -f 0; trace in -o out --json --force");
    assert_eq!(run.ended(1, &["4 failed"]).count("failed"), 4);
    assert_eq!(desk.contents("out"), [("002.svg".into(), "older".into())]);
    // Space has been made.
    let run = desk.trace(&["in", "-o", "out", "--force", "--json"]);
    assert_eq!(run.done().count("traced"), 4);
    assert_eq!(desk.contents("out"), desk.contents("whole"));
}

#[test]
fn a_full_device_fails_its_file_alone() {
    let desk = Desk::with_many(4);
    fs::create_dir(desk.path("out")).unwrap();
    symlink("/dev/full", desk.path("out/001.svg")).unwrap();
    let run = desk.trace(&["in", "-o", "out", "--json"]);
    run.ended(1, &["out/001.svg: cannot be written: No space left", "3 traced, 1 failed"]);
    assert_eq!(run.records()[1]["status"], "failed");
    assert_eq!(desk.files("out").len(), 4);
}

#[test]
fn records_that_cannot_be_written_are_said_and_the_drawings_are_there() {
    let desk = Desk::with_many(3);
    let run = shell(&desk, "trace in -o out --json > /dev/full");
    run.ended(1, &["the records cannot be written: No space left", "3 traced"]);
    desk.contents("out").iter().for_each(|(_, svg)| assert_whole(svg));
    assert_eq!(desk.files("out").len(), 3);
    let run = shell(&desk, "trace in -o again --json | true");
    assert_eq!((run.code, desk.files("again").len()), (0, 3));
}

#[test]
fn a_file_that_goes_away_fails_alone() {
    let desk = Desk::with_many(40);
    let mut child = desk.command(&["in", "-o", "out", "--json", "--jobs", "1"]).spawn().unwrap();
    wait_for_files(&desk.path("out"), &mut child);
    fs::remove_file(desk.path("in/039.png")).unwrap();
    let run = Run::of(child.wait_with_output().unwrap());
    run.ended(1, &["in/039.png: cannot be read: No such file", "39 traced, 1 failed"]);
    assert_eq!((run.records().len(), run.count("traced"), desk.files("out").len()), (40, 39, 39));
}

#[test]
fn what_cannot_be_listed_is_named_and_the_rest_is_traced() {
    let desk = Desk::with_many(2);
    symlink("loop", desk.path("loop")).unwrap();
    symlink(desk.path("in"), desk.path("in/round")).unwrap();
    symlink("nowhere.png", desk.path("in/dead.png")).unwrap();
    let run = desk.trace(&["in", "loop", "in/dead.png", "-r", "-o", "out", "--json"]);
    run.ended(1, &["loop: cannot be read", "in/dead.png: cannot be read: No such file", "2 traced, 2 failed"]);
    assert_eq!(run.records().len(), 4);
    assert_eq!(desk.files("out"), ["000.svg", "001.svg"]);
}

#[test]
fn a_killed_batch_goes_on_where_it_stopped() {
    let desk = Desk::with_many(40);
    desk.picture("in/999.png", &large());
    desk.trace(&["in", "-o", "whole"]).done();
    for round in 0..4 {
        let mut child = desk.command(&["in", "-o", "out", "--json", "--jobs", "2"]).spawn().unwrap();
        wait_for_files(&desk.path("out"), &mut child);
        std::thread::sleep(Duration::from_millis(7 * round));
        let _ = child.kill();
        let output = child.wait_with_output().unwrap();
        // What was told is there, and what is there is whole.
        let told = String::from_utf8(output.stdout).unwrap();
        for line in told.lines().filter(|line| line.ends_with('}')) {
            let record: serde_json::Value = serde_json::from_str(line).unwrap();
            assert!(desk.path(record["output"].as_str().unwrap()).exists(), "{line}");
        }
        for (name, svg) in desk.contents("out").iter().filter(|(name, _)| name.ends_with(".svg")) {
            assert_eq!(svg, &desk.read(&format!("whole/{name}")), "{name}");
        }
    }
    let before = desk.files("out").iter().filter(|name| name.ends_with(".svg")).count();
    // What was being written when it was killed is cleared away once it is old.
    desk.put("out/.trace-killed.tmp", "half");
    for name in desk.files("out").iter().filter(|name| name.ends_with(".tmp")) {
        let file = fs::File::options().append(true).open(desk.path("out").join(name)).unwrap();
        file.set_modified(SystemTime::now() - Duration::from_secs(3600)).unwrap();
    }
    let run = desk.trace(&["in", "-o", "out", "--json"]);
    assert_eq!((run.done().count("skipped"), run.count("traced")), (before, 41 - before));
    assert_eq!(desk.contents("out"), desk.contents("whole"));
}

#[test]
fn a_file_that_takes_too_long_is_given_up() {
    let desk = Desk::with_many(3);
    desk.picture("in/net.png", &large());
    let run = desk.trace(&["in", "-o", "out", "--timeout", "0.000001", "--json"]);
    run.ended(1, &["in/net.png: given up after 0.000001 seconds", "4 failed"]);
    assert_eq!((run.count("failed"), desk.files("out").len()), (4, 0));
    assert_eq!(desk.trace(&["in", "-o", "out", "--timeout", "600", "--json"]).done().count("traced"), 4);
}
