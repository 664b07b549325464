//! The same bytes on any number of threads.

use crate::desk::{Desk, large};

#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    let desk = Desk::with_many(9);
    desk.picture("in/net.png", &large());
    desk.trace(&["in", "-o", "first", "--jobs", "1"]).done();
    let first = desk.contents("first");
    assert_eq!(first.len(), 10);
    for (i, (jobs, threads)) in
        [("2", None), ("7", None), ("1", Some("3")), ("", Some("1")), ("", Some("5")), ("", None)]
            .into_iter()
            .enumerate()
    {
        let out = format!("out{i}");
        let mut command = desk.command(&["in", "-o", &out]);
        if !jobs.is_empty() {
            command.args(["--jobs", jobs]);
        }
        if let Some(threads) = threads {
            command.env("RAYON_NUM_THREADS", threads);
        }
        assert!(command.status().unwrap().success());
        assert_eq!(desk.contents(&out), first, "--jobs {jobs}, RAYON_NUM_THREADS {threads:?}");
    }
    // And so does each file on its own.
    for (name, svg) in &first {
        let input = format!("in/{}", name.replace("svg", "png"));
        desk.trace(&[&input, "-o", "alone.svg"]).done();
        assert_eq!(&desk.read("alone.svg"), svg, "{name}");
    }
}
