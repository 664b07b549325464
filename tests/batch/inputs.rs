//! Which files a batch takes, and where their traces go.

use crate::desk::{Desk, assert_whole};
use std::fs;

#[test]
fn files_go_to_the_folder() {
    let desk = Desk::with(&["a.png", "sub/b.png", "c.d.png"]);
    for words in [&["a.png", "sub/b.png", "c.d.png", "-o", "out"][..], &["batch", "a.png", "-o", "one"]] {
        desk.trace(words).done();
    }
    assert_eq!(desk.files("out"), ["a.svg", "b.svg", "c.d.svg"]);
    assert_eq!(desk.files("one"), ["a.svg"]);
    desk.contents("out").iter().for_each(|(_, svg)| assert_whole(svg));
    assert!(desk.read("out/a.svg").contains("<title>a.png</title>"));
}

#[test]
fn without_a_folder_outputs_lie_beside_their_inputs() {
    let desk = Desk::with(&["a.png", "sub/b.png", "in/c.png"]);
    desk.trace(&["a.png", "sub/b.png", "in"]).done();
    assert_eq!(desk.files(""), ["a.png", "a.svg", "in/c.png", "in/c.svg", "sub/b.png", "sub/b.svg"]);
    desk.trace(&["*.png", "--format", "dxf"]).done();
    assert!(desk.read("a.dxf").contains("ENTITIES"));
}

#[test]
fn inputs_of_one_name_and_several_extensions_get_an_output_each() {
    let desk = Desk::with(&["in/a.png", "in/b.png"]);
    image::open(desk.path("in/a.png")).unwrap().save(desk.path("in/a.bmp")).unwrap();
    desk.trace(&["in", "-o", "out"]).done();
    assert_eq!(desk.files("out"), ["a.bmp.svg", "a.png.svg", "b.svg"]);
}

#[test]
fn one_file_takes_what_a_batch_takes() {
    let desk = Desk::with(&["a.png"]);
    let run = desk.trace(&["a.png", "-o", "out.svg", "--json", "--jobs", "1", "--timeout", "60"]);
    assert_eq!(run.done().count("traced"), 1);
    assert_whole(&desk.read("out.svg"));
    assert_eq!(desk.trace(&["a.png", "-o", "out.svg", "--json"]).done().count("skipped"), 1);
}

#[test]
fn a_trace_is_the_same_alone_and_in_a_batch() {
    let desk = Desk::with(&["a.png", "b.png"]);
    desk.trace(&["a.png", "b.png", "-o", "out", "--detail", "0.2", "--precision", "3"]).done();
    desk.trace(&["a.png", "-o", "alone.svg", "--detail", "0.2", "--precision", "3"]).done();
    assert_eq!(desk.read("out/a.svg"), desk.read("alone.svg"));
}

#[test]
fn one_file_with_a_folder_for_output_is_a_batch() {
    let desk = Desk::with(&["a.png"]);
    fs::create_dir(desk.path("there")).unwrap();
    for (output, folder) in [("there", "there"), ("new/", "new"), ("deep/er/", "deep/er")] {
        desk.trace(&["a.png", "-o", output]).done();
        assert_eq!(desk.files(folder), ["a.svg"]);
    }
    desk.trace(&["a.png", "-o", "file"]).done();
    assert!(desk.path("file").is_file());
}

#[test]
fn folders_give_their_raster_images() {
    let desk = Desk::with(&["in/a.png", "in/B.PNG", "in/deep/c.png", "in/deep/er/d.png"]);
    desk.draw("in/.hidden.png", 5);
    desk.draw("in/.cache/e.png", 6);
    desk.put("in/notes.txt", "not an image");
    desk.put("in/drawn.svg", "<svg xmlns='http://www.w3.org/2000/svg' width='9' height='9'/>");
    fs::create_dir(desk.path("in/folder.png")).unwrap();
    desk.trace(&["in", "-o", "flat"]).done();
    assert_eq!(desk.files("flat"), ["B.svg", "a.svg"]);
    for flag in ["-r", "--recursive"] {
        desk.trace(&["in", flag, "-o", "tree", "--force"]).done();
        assert_eq!(desk.files("tree"), ["B.svg", "a.svg", "deep/c.svg", "deep/er/d.svg"]);
    }
}

#[test]
fn a_folder_may_be_traced_in_place_again_and_again() {
    let desk = Desk::with(&["in/a.png", "in/deep/b.png"]);
    for status in ["traced", "skipped"] {
        let run = desk.trace(&["in", "-r", "-o", "in", "--json"]);
        assert_eq!(run.done().count(status), 2, "{}", run.stdout);
    }
    assert_eq!(desk.files("in"), ["a.png", "a.svg", "deep/b.png", "deep/b.svg"]);
}

#[test]
fn patterns_keep_the_folders_that_they_leave_open() {
    let desk = Desk::with(&["in/x/a1.png", "in/x/a2.png", "in/y/a1.png", "in/y/b1.png", "in/y/z/a3.png"]);
    let cases: [(&str, &[&str]); 5] = [
        ("in/x/a*.png", &["a1.svg", "a2.svg"]),
        ("in/?/a1.png", &["x/a1.svg", "y/a1.svg"]),
        ("in/[x]/a[!1].png", &["x/a2.svg"]),
        ("in/**/a*.png", &["x/a1.svg", "x/a2.svg", "y/a1.svg", "y/z/a3.svg"]),
        ("in/y/*", &["a1.svg", "b1.svg"]),
    ];
    for (i, (pattern, expected)) in cases.into_iter().enumerate() {
        let out = format!("out{i}");
        desk.trace(&[pattern, "-o", &out]).done();
        assert_eq!(desk.files(&out), expected, "{pattern}");
    }
}

#[test]
fn what_exists_is_no_pattern() {
    let desk = Desk::with(&["a[1].png", "a1.png", "what?/a.png", "[set]/b.png"]);
    desk.trace(&["a[1].png", "-o", "out/"]).done();
    assert_eq!(desk.files("out"), ["a[1].svg"]);
    desk.trace(&["what?", "[set]", "-o", "folders"]).done();
    assert_eq!(desk.files("folders"), ["a.svg", "b.svg"]);
    fs::remove_file(desk.path("a[1].png")).unwrap();
    desk.trace(&["a[1].png", "-o", "then/"]).done();
    assert_eq!(desk.files("then"), ["a1.svg"]);
}

#[test]
fn two_inputs_with_one_output_are_refused_before_any_work() {
    let desk = Desk::with(&["x/a.png", "y/a.png", "x/b.png", "y/b.png", "c.png"]);
    fs::copy(desk.path("c.png"), desk.path("c.tif.png")).unwrap();
    let run = desk.trace(&["c.png", "x", "y", "-o", "out"]);
    run.ended(2, &["x/a.png, y/a.png", "out/a.svg", "x/b.png, y/b.png"]);
    assert_eq!((run.stderr.lines().count(), desk.path("out").exists()), (1, false), "{}", run.stderr);
    desk.trace(&["c.png", "c.tif.png", "-o", "out"]).done();
}

#[test]
fn an_input_that_is_named_twice_is_traced_once() {
    let desk = Desk::with(&["in/a.png", "in/b.png"]);
    let run = desk.trace(&["in", "in/a.png", "./in/a.png", "in/*.png", "-o", "out", "--json"]);
    assert_eq!(run.done().records().len(), 2, "{}", run.stdout);
}

#[test]
fn no_input_is_overwritten() {
    let desk = Desk::with(&["a.png", "in/b.png"]);
    let svg = "<svg xmlns='http://www.w3.org/2000/svg' width='9' height='9'><path d='M1 1h7' stroke='red'/></svg>";
    desk.put("s.svg", svg);
    desk.put("in/t.svg", svg);
    desk.trace(&["a.png", "s.svg", "-o", "."]).ended(2, &["s.svg", "overwritten"]);
    desk.trace(&["in/*", "-o", "in"]).ended(2, &["t.svg", "overwritten"]);
    assert_eq!((desk.read("s.svg"), desk.read("in/t.svg")), (svg.into(), svg.into()));
    assert_eq!(desk.files(""), ["a.png", "in/b.png", "in/t.svg", "s.svg"]);
    desk.trace(&["a.png", "s.svg", "-o", "out"]).done();
}

#[test]
fn a_manifest_lists_inputs() {
    let desk = Desk::with(&["in/a b.png", "in/c.png", "d.png", "e.png"]);
    desk.put("list", "in/a b.png\r\n\nin/c.png\n./d.png");
    desk.trace(&["--manifest", "list", "-o", "out"]).done();
    assert_eq!(desk.files("out"), ["a b.svg", "c.svg", "d.svg"]);
    desk.trace(&["e.png", "--manifest=list", "-o", "more"]).done();
    assert_eq!(desk.files("more").len(), 4);
    desk.trace(&["--manifest", "nosuch", "-o", "out"]).ended(1, &["nosuch: cannot be read"]);
    desk.put("empty", "\n");
    desk.trace(&["--manifest", "empty", "-o", "out"]).ended(2, &["nothing to trace"]);
    desk.put("binary", [0xff, 0xfe, b'\n']);
    desk.trace(&["--manifest", "binary", "-o", "out"]).ended(1, &["binary: cannot be read"]);
}

#[test]
fn shares_are_stable_and_make_the_whole() {
    let desk = Desk::with_many(11);
    let mut seen = Vec::new();
    for number in 1..=4 {
        let share = format!("{number}/4");
        let words = ["in", "-o", "out", "--shard", &share, "--json"];
        let first = desk.trace(&words).done().statuses();
        assert!(first.iter().all(|(_, status)| status == "traced") && (2..=3).contains(&first.len()), "{first:?}");
        let again = desk.trace(&words).done().statuses();
        assert!(again.iter().zip(&first).all(|(a, b)| a.0 == b.0 && a.1 == "skipped"), "{again:?}");
        seen.extend(first.into_iter().map(|(input, _)| input));
    }
    seen.sort();
    assert_eq!(seen, (0..11).map(|i| format!("in/{i:03}.png")).collect::<Vec<_>>());
    assert_eq!(desk.files("out").len(), 11);
    assert_eq!(desk.trace(&["in", "-o", "out", "--shard", "20/20", "--json"]).done().stdout, "");
    for wrong in ["0/4", "5/4", "1", "a/b", "1/0", "-1/4"] {
        desk.trace(&["in", "-o", "out", &format!("--shard={wrong}")]).ended(2, &["--shard"]);
    }
}

#[test]
fn what_makes_no_batch_is_wrong_usage() {
    let desk = Desk::with(&["a.png", "b.png", "in/c.png"]);
    fs::create_dir(desk.path("none")).unwrap();
    let before = desk.files("");
    let cases: [(&[&str], &str); 10] = [
        (&["a.png", "b.png", "-o", "-"], "standard output"),
        (&["a.png", "-", "-o", "out"], "standard input"),
        (&["a.png", "b.png", "-o", "out.svg"], "out.svg"),
        (&["a.png", "--force", "-o", "out.PNG"], "out.PNG"),
        (&["in", "-o", "out", "--debug-dir", "look"], "--debug-dir"),
        (&["none", "-o", "out"], "nothing to trace"),
        (&["x*.png", "-o", "out"], "x*.png: no such file, and no file matches"),
        (&["a[.png", "-o", "out"], "a[.png: no such file, and no pattern"),
        (&["in", "-o", "out", "--jobs", "0"], "--jobs"),
        (&["in", "-o", "out", "--detail", "9"], "--detail: 9 is not between"),
    ];
    for (words, message) in cases {
        desk.trace(words).ended(2, &[message]);
    }
    for wrong in ["0", "-1", "soon", "inf", "1e300"] {
        desk.trace(&["in", "-o", "out", "--timeout", wrong]).ended(2, &["--timeout"]);
    }
    assert_eq!(desk.files(""), before);
}
