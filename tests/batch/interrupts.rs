//! Interrupts from the keyboard.

use crate::desk::{Desk, Run, assert_whole, large};
use crate::faults::wait_for_files;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

fn interrupt(child: &Child) {
    signal(child, "INT");
}

fn signal(child: &Child, name: &str) {
    let done = Command::new("sh").args(["-c", &format!("kill -{name} {}", child.id())]).status().unwrap();
    assert!(done.success());
}

#[test]
fn an_interrupt_abandons_what_is_begun_and_tells_what_was_done() {
    let desk = Desk::with_many(6);
    for i in 0..8 {
        desk.picture(&format!("in/x{i:02}.png"), &large());
    }
    for (jobs, out, name) in [("1", "one", "INT"), ("2", "two", "INT"), ("2", "three", "TERM")] {
        let mut child = desk.command(&["in", "-o", out, "--json", "--jobs", jobs]).spawn().unwrap();
        wait_for_files(&desk.path(out), &mut child);
        signal(&child, name);
        let run = Run::of(child.wait_with_output().unwrap());
        run.ended(130, &["trace: interrupted: ", " left undone"]);
        let (traced, left) = (run.count("traced"), run.count("interrupted"));
        assert_eq!((run.records().len(), traced + left), (14, 14));
        assert!(
            traced > 0 && left > 0 && run.stderr.contains(&format!("{traced} traced, {left} left")),
            "{}",
            run.stderr
        );
        // Whole files only, and nothing beside them.
        let files = desk.contents(out);
        files.iter().for_each(|(_, svg)| assert_whole(svg));
        assert!(files.iter().all(|(name, _)| name.ends_with(".svg")) && files.len() == traced);
    }
    let done = desk.files("two").len();
    let run = desk.trace(&["in", "-o", "two", "--json"]);
    assert_eq!((run.done().count("skipped"), run.count("traced")), (done, 14 - done));
}

#[test]
fn a_second_interrupt_ends_at_once() {
    let desk = Desk::with_many(3);
    // Reading a pipe that nobody writes to cannot be given up. It comes first.
    assert!(Command::new("mkfifo").arg(desk.path("a-pipe")).status().unwrap().success());
    let mut child = desk.command(&["in", "a-pipe", "-o", "out", "--jobs", "2"]).spawn().unwrap();
    wait_for_files(&desk.path("out"), &mut child);
    interrupt(&child);
    std::thread::sleep(Duration::from_millis(100));
    assert!(child.try_wait().unwrap().is_none(), "the first interrupt waits for the file");
    // Interrupts that come at once may be taken for one.
    let start = Instant::now();
    while child.try_wait().unwrap().is_none() {
        assert!(start.elapsed() < Duration::from_secs(60), "the second interrupt is not heard");
        interrupt(&child);
        std::thread::sleep(Duration::from_millis(50));
    }
    assert_eq!(child.wait().unwrap().code(), Some(130));
    desk.contents("out").iter().for_each(|(_, svg)| assert_whole(svg));
}

#[test]
fn a_batch_under_nohup_outlives_its_terminal() {
    let desk = Desk::with_many(30);
    let line = format!("trap '' HUP; exec {} in -o out --jobs 1", env!("CARGO_BIN_EXE_trace"));
    let mut command = Command::new("sh");
    command.args(["-c", &line]).current_dir(desk.path(""));
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    wait_for_files(&desk.path("out"), &mut child);
    signal(&child, "HUP");
    Run::of(child.wait_with_output().unwrap()).done();
    assert_eq!(desk.files("out").len(), 30);
}
