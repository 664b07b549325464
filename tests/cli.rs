//! The program driven as a user would.

use fieldtrace::drawing::{Centreline, Drawing, Segment, Stroke};
use fieldtrace::render::render;
use image::{GrayImage, Luma};
use kurbo::{Circle, Line, Point};
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

/// A folder with drawings in it, gone at the end of the test.
struct Desk(TempDir);

impl Desk {
    /// With `drawing.png` (a cross, a circle and a dot) and `blank.png`.
    fn new() -> Self {
        let desk = Self(tempfile::tempdir().unwrap());
        desk.picture("drawing.png", &drawing());
        desk.picture("blank.png", &Drawing::new(40.0, 30.0));
        desk
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn picture(&self, name: &str, drawing: &Drawing) {
        let ink = render(drawing);
        let gray = GrayImage::from_fn(ink.width() as u32, ink.height() as u32, |x, y| {
            Luma([(255.0 * (1.0 - ink[(x as usize, y as usize)])).round() as u8])
        });
        gray.save(self.path(name)).unwrap();
    }

    fn command(&self, words: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_trace"));
        command.args(words).current_dir(self.0.path());
        command
    }

    fn trace(&self, words: &[&str]) -> Run {
        Run::of(self.command(words).stdin(Stdio::null()).output().unwrap())
    }

    fn trace_with_input(&self, words: &[&str], input: &[u8]) -> Run {
        let mut command = self.command(words);
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().unwrap();
        let mut stdin = child.stdin.take().unwrap();
        let _ = stdin.write_all(input); // the program may have given up on it
        drop(stdin);
        Run::of(child.wait_with_output().unwrap())
    }

    /// The files of the folder, sorted.
    fn names(&self) -> Vec<String> {
        names(self.0.path())
    }

    fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap()
    }
}

fn names(folder: &Path) -> Vec<String> {
    let name = |entry: std::io::Result<fs::DirEntry>| entry.unwrap().file_name().into_string().unwrap();
    let mut names: Vec<String> = fs::read_dir(folder).unwrap().map(name).collect();
    names.sort();
    names
}

/// How a run of the program ended.
struct Run {
    code: i32,
    stdout: Vec<u8>,
    stderr: String,
}

impl Run {
    fn of(output: Output) -> Self {
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert!(!stderr.contains("panicked"), "{stderr}");
        Self { code: output.status.code().expect("an exit code"), stdout: output.stdout, stderr }
    }

    #[track_caller]
    fn done(&self) -> &Self {
        assert_eq!(self.code, 0, "{}", self.stderr);
        self
    }

    /// Failed on a file, with one line that starts with `trace: ` and has all the words.
    #[track_caller]
    fn failed(&self, words: &[&str]) {
        assert_eq!(self.code, 1, "{}", self.stderr);
        assert_eq!(self.stderr.lines().count(), 1, "{}", self.stderr);
        assert!(self.stderr.starts_with("trace: "), "{}", self.stderr);
        words.iter().for_each(|word| assert!(self.stderr.contains(word), "no {word} in {}", self.stderr));
        assert!(self.stdout.is_empty());
    }

    #[track_caller]
    fn wrong_usage(&self, word: &str) {
        assert_eq!(self.code, 2, "{}", self.stderr);
        assert!(self.stderr.contains(word), "no {word} in {}", self.stderr);
        assert!(self.stdout.is_empty());
    }
}

fn drawing() -> Drawing {
    let mut drawing = Drawing::new(120.0, 90.0);
    let mut add = |centreline, width| drawing.strokes.push(Stroke::new(centreline, width));
    let line = |a, b| Centreline::Path { segments: vec![Segment::Line(Line::new(a, b))], closed: false };
    add(line((10.0, 10.0), (70.0, 60.0)), 3.0);
    add(line((70.0, 10.0), (10.0, 60.0)), 3.0);
    add(Centreline::Circle(Circle::new((95.0, 60.0), 18.0)), 3.0);
    add(Centreline::Dot(Point::new(100.0, 15.0)), 5.0);
    drawing
}

/// Whether text is an SVG that a reader takes, and the number of its strokes.
#[track_caller]
fn strokes(svg: &str) -> usize {
    usvg::Tree::from_str(svg, &usvg::Options::default()).expect("valid SVG");
    svg.matches("stroke-width=").count()
}

#[test]
fn the_output_is_named_after_the_input() {
    let desk = Desk::new();
    desk.trace(&["drawing.png"]).done();
    assert_eq!(desk.names(), ["blank.png", "drawing.png", "drawing.svg"]);
    let svg = desk.read("drawing.svg");
    strokes(&svg);
    assert!(svg.contains("viewBox=\"0 0 120 90\"") && svg.contains("<title>drawing.png</title>"), "{svg}");
}

#[test]
fn the_output_may_be_named() {
    let desk = Desk::new();
    desk.trace(&["drawing.png", "-o", "a.svg"]).done();
    desk.trace(&["--output=b", "drawing.png"]).done();
    assert_eq!(desk.read("a.svg"), desk.read("b"));
    assert!(!desk.path("drawing.svg").exists());
}

#[test]
fn standard_input_and_output_serve() {
    let desk = Desk::new();
    desk.trace(&["drawing.png"]).done();
    let png = fs::read(desk.path("drawing.png")).unwrap();
    let piped = desk.trace_with_input(&["-"], &png);
    let text = String::from_utf8(piped.done().stdout.clone()).unwrap();
    // The checksum is over the title too.
    let body = |svg: &str| svg.split("</metadata>").nth(1).unwrap().to_string();
    assert_eq!(body(&text), body(&desk.read("drawing.svg")));
    assert_eq!(desk.trace(&["drawing.png", "-o", "-"]).done().stdout, desk.read("drawing.svg").into_bytes());
    desk.trace_with_input(&["-", "-o", "c.svg"], &png).done();
    assert_eq!(desk.read("c.svg"), text);
}

#[test]
fn two_runs_give_the_same_bytes() {
    let desk = Desk::new();
    for (output, threads) in [("a.svg", "1"), ("b.svg", "3")] {
        let mut command = desk.command(&["drawing.png", "-o", output]);
        Run::of(command.env("RAYON_NUM_THREADS", threads).output().unwrap()).done();
    }
    assert_eq!(desk.read("a.svg"), desk.read("b.svg"));
    for output in ["a.npz", "b.npz"] {
        desk.trace(&["field", "drawing.png", "-o", output]).done();
    }
    assert_eq!(fs::read(desk.path("a.npz")).unwrap(), fs::read(desk.path("b.npz")).unwrap());
}

#[test]
fn the_strokes_are_found() {
    let desk = Desk::new();
    let run = desk.trace(&["drawing.png"]);
    assert_eq!(run.done().stderr, "");
    assert_eq!(strokes(&desk.read("drawing.svg")), 4, "{}", desk.read("drawing.svg"));
}

#[test]
fn no_ink_is_an_empty_drawing_and_a_warning() {
    let desk = Desk::new();
    let run = desk.trace(&["blank.png"]);
    assert_eq!(run.done().stderr.lines().count(), 1, "{}", run.stderr);
    assert!(run.stderr.starts_with("trace: blank.png: warning: no ink"), "{}", run.stderr);
    assert_eq!(strokes(&desk.read("blank.svg")), 0);
    for quiet in ["--quiet", "-q"] {
        assert_eq!(desk.trace(&["blank.png", quiet]).done().stderr, "");
    }
}

#[test]
fn verbose_tells_the_stages() {
    let desk = Desk::new();
    for flag in ["-v", "--verbose"] {
        let run = desk.trace(&["drawing.png", flag]);
        for word in ["load", "120 x 90", "clean", "estimate", "graph", "fit", "strokes", "write", " s "] {
            assert!(run.done().stderr.contains(word), "no {word} in {}", run.stderr);
        }
    }
    desk.trace(&["drawing.png", "-v", "-q"]).wrong_usage("cannot be used with");
}

#[test]
fn every_option_is_taken() {
    let desk = Desk::new();
    let all: [&[&str]; 30] = [
        &["--detail", "0.3"],
        &["--min-length", "2"],
        &["--despeckle", "4"],
        &["--threshold", "auto"],
        &["--threshold", "0.5"],
        &["--invert", "auto"],
        &["--invert", "yes"],
        &["--invert", "no"],
        &["--width", "pens"],
        &["--width", "measured"],
        &["--width", "outline"],
        &["--width", "profile"],
        &["--max-width", "none"],
        &["--max-width", "20"],
        &["--max-width", "2mm", "--dpi", "100"],
        &["--solids", "outline"],
        &["--solids", "hatch"],
        &["--solids", "drop"],
        &["--units", "mm", "--dpi", "100"],
        &["--shapes", "path"],
        &["--curves", "lines", "--tolerance", "0.2"],
        &["--crop", "0,0,60,60"],
        &["--format", "svg"],
        &["--width", "uniform"],
        &["--width", "2.5"],
        &["--precision", "0"],
        &["--size", "100"],
        &["--preset", "sketch"],
        &["--preset", "plan"],
        &["--preset", "icon"],
    ];
    for words in all {
        desk.trace(&[&["drawing.png", "-o", "out.svg"], words].concat()).done();
        strokes(&desk.read("out.svg"));
    }
}

#[test]
fn width_and_precision_show_in_the_output() {
    let desk = Desk::new();
    desk.trace(&["drawing.png", "--width", "2.5"]).done();
    let svg = desk.read("drawing.svg");
    assert_eq!(svg.matches("stroke-width=\"2.5\"").count(), strokes(&svg));
    desk.trace(&["drawing.png", "--precision", "0"]).done();
    let svg = desk.read("drawing.svg");
    let shapes = svg.lines().filter(|l| ["<path", "<line", "<circle"].iter().any(|shape| l.starts_with(shape)));
    assert!(!shapes.collect::<String>().replace("h0.01", "").contains('.'), "{svg}");
}

#[test]
fn dpi_gives_millimetres() {
    let desk = Desk::new();
    desk.trace(&["drawing.png", "--dpi", "60"]).done();
    let svg = desk.read("drawing.svg");
    assert!(svg.contains("width=\"50.8mm\"") && svg.contains("height=\"38.1mm\""), "{svg}");
}

#[test]
fn max_pixels_refuses_and_is_raised() {
    let desk = Desk::new();
    desk.trace(&["drawing.png", "--max-pixels", "1000"]).failed(&["drawing.png: ", "120 x 90", "--max-pixels"]);
    assert_eq!(desk.names(), ["blank.png", "drawing.png"]);
    desk.trace(&["drawing.png", "--max-pixels", "10800"]).done();
}

#[test]
fn the_debug_folder_holds_a_picture_of_each_stage() {
    let desk = Desk::new();
    desk.trace(&["drawing.png", "--debug-dir", "look/at/it"]).done();
    let expected = [
        "1-ink.png",
        "2-field.png",
        "2-field.svg",
        "3-streamlines.png",
        "3-streamlines.svg",
        "4-graph.png",
        "4-graph.svg",
        "5-strokes.png",
        "5-strokes.svg",
    ];
    let (passes, stages): (Vec<String>, Vec<String>) = names(&desk.path("look/at/it"))
        .into_iter()
        .partition(|name| name.starts_with("4-") && !name.starts_with("4-graph"));
    assert_eq!(stages, expected);
    let numbers: Vec<&str> = passes.iter().filter_map(|name| name.strip_prefix("4-")?.split('-').next()).collect();
    assert!(numbers.is_sorted() && numbers.iter().all(|number| number.parse::<usize>().is_ok()), "{passes:?}");
    desk.trace(&["drawing.png", "-o", "b.svg"]).done();
    assert_eq!(desk.read("drawing.svg"), desk.read("b.svg"));
    desk.trace(&["drawing.png", "--debug-dir", "blank.png"]).failed(&["blank.png: cannot be written"]);
}

/// An array of the size of `drawing.png` in an archive of NumPy's.
fn array<T: npyz::Deserialize>(archive: &Path, name: &str) -> Vec<T> {
    let mut archive = zip::ZipArchive::new(fs::File::open(archive).unwrap()).unwrap();
    let array = npyz::NpyFile::new(archive.by_name(&format!("{name}.npy")).unwrap()).unwrap();
    assert_eq!(array.shape(), [90, 120]);
    array.into_vec().unwrap()
}

#[test]
fn the_field_is_written_in_each_format() {
    let desk = Desk::new();
    for output in ["f.npz", "f.png", "f.svg"] {
        desk.trace(&["field", "drawing.png", "-o", output]).done();
    }
    for name in ["c0", "c2"] {
        let coefficients = array::<num_complex::Complex32>(&desk.path("f.npz"), name);
        assert!(coefficients.iter().any(|c| c.norm() > 0.5), "{name}");
    }
    assert!(array::<u8>(&desk.path("f.npz"), "mask").iter().all(|&m| m < 2));
    assert!(image::open(desk.path("f.png")).is_ok());
    usvg::Tree::from_str(&desk.read("f.svg"), &usvg::Options::default()).unwrap();
}

#[test]
fn pictures_and_fields_overwrite_nothing_unasked() {
    let desk = Desk::new();
    for (command, output) in [("field", "f.npz"), ("field", "f.svg"), ("ink", "ink.png")] {
        fs::write(desk.path(output), "mine").unwrap();
        desk.trace(&[command, "drawing.png", "-o", output]).failed(&["exists already", "--force"]);
        assert_eq!(desk.read(output), "mine");
        desk.trace(&[command, "drawing.png", "-o", output, "--force"]).done();
        assert_ne!(fs::read(desk.path(output)).unwrap(), b"mine");
    }
}

#[test]
fn the_field_covers_the_ink() {
    let desk = Desk::new();
    desk.trace(&["field", "drawing.png", "-o", "f.npz"]).done();
    let mask = array::<u8>(&desk.path("f.npz"), "mask");
    let ink = render(&drawing());
    let full: Vec<usize> = (0..ink.data().len()).filter(|&i| ink.data()[i] > 0.99).collect();
    let covered = full.iter().filter(|&&i| mask[i] == 1).count();
    assert!(covered as f64 > 0.97 * full.len() as f64, "{covered} of {}", full.len());
}

#[test]
fn the_field_asks_for_a_format() {
    let desk = Desk::new();
    desk.trace(&["field", "drawing.png"]).wrong_usage("--output");
    desk.trace(&["field", "drawing.png", "-o", "f.txt"]).wrong_usage("f.txt: a field is written as");
    desk.trace(&["field", "drawing.png", "-o", "drawing.png"]).wrong_usage("overwrite the input");
    desk.trace(&["field", "nosuch.png", "-o", "f.npz"]).failed(&["nosuch.png: "]);
    assert_eq!(desk.names(), ["blank.png", "drawing.png"]);
}

#[test]
fn a_file_with_the_name_of_a_subcommand_is_reached_by_its_path() {
    let desk = Desk::new();
    fs::copy(desk.path("drawing.png"), desk.path("field")).unwrap();
    desk.trace(&["./field"]).done();
    assert!(desk.path("field.svg").exists());
}

#[test]
fn wrong_usage_ends_with_two() {
    let desk = Desk::new();
    let cases: [(&[&str], &str); 24] = [
        (&[], "Usage: trace"),
        (&["--no-such-flag", "drawing.png"], "--no-such-flag"),
        (&["drawing.png", "--format", "dwg"], "svg, svgz, dxf"),
        (&["drawing.png", "--max-width", "wide"], "neither auto, none"),
        (&["drawing.png", "--solids", "melt"], "fill, outline, hatch, drop"),
        (&["feild", "drawing.png"], "feild: no such file; the subcommand is called field"),
        (&["drawing.png", "--detail", "7"], "--detail: 7 is not between 0.01 and 2"),
        (&["drawing.png", "--detail", "much"], "not a number"),
        (&["drawing.png", "--detail", "NaN"], "not a number"),
        (&["drawing.png", "--min-length", "-1"], "--min-length: -1 is not between"),
        (&["drawing.png", "--despeckle", "-1"], "-1"),
        (&["drawing.png", "--threshold", "1.5"], "--threshold: 1.5 is not between"),
        (&["drawing.png", "--threshold", "dark"], "neither auto nor a number"),
        (&["drawing.png", "--invert", "maybe"], "not one of auto, yes, no"),
        (&["drawing.png", "--width", "0"], "--width: 0 is not between"),
        (&["drawing.png", "--width", "thick"], "neither pens, measured"),
        (&["drawing.png", "--gap", "wide"], "neither auto nor a number"),
        (&["drawing.png", "--gap", "-1"], "--gap: -1 is not between 0 and 100"),
        (&["drawing.png", "--dashes", "maybe"], "not one of keep, join"),
        (&["drawing.png", "--precision", "9"], "between 0 and 8"),
        (&["drawing.png", "--dpi", "0"], "between 1 and 100000"),
        (&["drawing.png", "--size", "0"], "--size"),
        (&["drawing.png", "--max-pixels", "0"], "--max-pixels"),
        (&["drawing.png", "--preset", "art"], "sketch, plan, icon"),
    ];
    for (words, message) in cases {
        desk.trace(words).wrong_usage(message);
    }
    assert_eq!(desk.names(), ["blank.png", "drawing.png"]);
}

#[test]
fn the_input_is_not_overwritten() {
    let desk = Desk::new();
    let svg = r#"<svg xmlns="http://www.w3.org/2000/svg" width="9" height="9"><path d="M1 1h7" stroke="red"/></svg>"#;
    fs::write(desk.path("a.svg"), svg).unwrap();
    desk.trace(&["a.svg"]).wrong_usage("a.svg: the output would overwrite the input");
    desk.trace(&["a.svg", "-o", "./a.svg"]).wrong_usage("overwrite the input");
    assert_eq!(desk.read("a.svg"), svg);
}

#[test]
fn other_formats_are_refused() {
    let desk = Desk::new();
    desk.trace(&["drawing.png", "-o", "out.PNG"]).wrong_usage("out.PNG: png is not among the kinds of output");
    desk.trace(&["drawing.png", "-o", "out.dwg"]).wrong_usage("dwg is not among");
}

#[test]
fn bad_files_are_named_with_the_reason() {
    let desk = Desk::new();
    fs::write(desk.path("empty.png"), b"").unwrap();
    fs::write(desk.path("text.png"), b"this is no image\nat all\n").unwrap();
    let png = fs::read(desk.path("drawing.png")).unwrap();
    fs::write(desk.path("cut.png"), &png[..png.len() / 2]).unwrap();
    let before = desk.names();
    desk.trace(&["nosuch.png"]).failed(&["nosuch.png: ", "No such file"]);
    for name in ["empty.png", "text.png", "cut.png"] {
        desk.trace(&[name]).failed(&[&format!("{name}: ")]);
        desk.trace(&[name, "-q", "-o", "-"]).failed(&[&format!("{name}: ")]);
    }
    desk.trace_with_input(&["-"], b"").failed(&["-: "]);
    desk.trace_with_input(&["-"], &png[..40]).failed(&["-: "]);
    assert_eq!(desk.names(), before);
}

#[test]
fn odd_sizes_are_no_error() {
    let desk = Desk::new();
    for (name, width, height) in [("1.png", 1, 1), ("2.png", 20_000, 3), ("3.png", 2, 700)] {
        for level in [0, 128, 255] {
            GrayImage::from_pixel(width, height, Luma([level])).save(desk.path(name)).unwrap();
            desk.trace(&[name, "-o", "out.svg"]).done();
            let svg = desk.read("out.svg");
            strokes(&svg);
            assert!(svg.contains(&format!("viewBox=\"0 0 {width} {height}\"")), "{svg}");
        }
    }
}

#[test]
fn an_output_that_cannot_be_written_is_named() {
    let desk = Desk::new();
    fs::create_dir(desk.path("folder.svg")).unwrap();
    desk.trace(&["drawing.png", "-o", "no/such/a.svg"]).failed(&["no/such/a.svg: cannot be written: the folder"]);
    desk.trace(&["drawing.png", "-o", "folder.svg"]).failed(&["folder.svg: cannot be written: it is a folder"]);
    desk.trace(&["drawing.png", "-o", "drawing.png/a.svg"]).failed(&["a.svg: cannot be written"]);
    fs::write(desk.path("old.svg"), "old").unwrap();
    let mut permissions = fs::metadata(desk.path("old.svg")).unwrap().permissions();
    permissions.set_readonly(true);
    fs::set_permissions(desk.path("old.svg"), permissions).unwrap();
    desk.trace(&["drawing.png", "-o", "old.svg"]).failed(&["old.svg: exists"]);
    desk.trace(&["drawing.png", "-o", "old.svg", "--force"]).failed(&["old.svg: cannot be written: it is read-only"]);
    assert_eq!(desk.read("old.svg"), "old");
    assert_eq!(desk.names(), ["blank.png", "drawing.png", "folder.svg", "old.svg"]);
}

#[test]
fn a_failure_leaves_an_older_output_as_it_was() {
    let desk = Desk::new();
    fs::write(desk.path("out.svg"), "older").unwrap();
    fs::write(desk.path("bad.png"), b"bad").unwrap();
    desk.trace(&["bad.png", "-o", "out.svg"]).failed(&["bad.png: "]);
    assert_eq!(desk.read("out.svg"), "older");
}

#[test]
fn a_reader_that_goes_away_is_no_error() {
    let desk = Desk::new();
    let mut command = desk.command(&["field", "drawing.png", "-o", "-", "-q"]);
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take()); // closed before the program writes
    let run = Run::of(child.wait_with_output().unwrap());
    assert_eq!(run.done().stderr, "");
}

#[test]
fn help_and_version_go_to_standard_output() {
    let desk = Desk::new();
    let help = String::from_utf8(desk.trace(&["--help"]).done().stdout.clone()).unwrap();
    let options = [
        "--output",
        "--detail",
        "--min-length",
        "--despeckle",
        "--threshold",
        "--invert",
        "--width",
        "--precision",
        "--dpi",
        "--size",
        "--max-pixels",
        "--preset",
        "--debug-dir",
        "--recursive",
        "--manifest",
        "--shard",
        "--force",
        "--jobs",
        "--timeout",
        "--json",
        "--quiet",
        "--verbose",
        "Examples:",
        "field",
        "batch",
    ];
    options.iter().for_each(|word| assert!(help.contains(word), "{word}"));
    let version = String::from_utf8(desk.trace(&["--version"]).done().stdout.clone()).unwrap();
    assert_eq!(version.trim(), concat!("trace ", env!("CARGO_PKG_VERSION")));
    desk.trace(&["field", "--help"]).done();
}

#[test]
fn a_graph_is_written_and_traced_on() {
    let desk = Desk::new();
    desk.trace(&["drawing.png", "-o", "a.svg", "--graph", "a.json"]).done();
    desk.trace(&["drawing.png", "-o", "b.json"]).done();
    assert_eq!(desk.read("a.json"), desk.read("b.json"));
    desk.trace(&["a.json", "-o", "c.svg"]).done();
    let body = |name: &str| desk.read(name).split("</metadata>").nth(1).unwrap().to_string();
    assert_eq!(body("a.svg"), body("c.svg"));
    let piped = desk.trace_with_input(&["-", "-o", "-"], desk.read("a.json").as_bytes());
    assert!(String::from_utf8(piped.done().stdout.clone()).unwrap().contains("</svg>"));
    desk.trace(&["a.json", "-o", "d.svg", "--width", "9"]).done();
    assert!(desk.read("d.svg").contains("stroke-width=\"9\""));
    desk.trace(&["a.json", "-o", "a.json"]).wrong_usage("overwrite");
    desk.trace(&["drawing.png", "-o", "e.svg", "--graph", "e.svg"]).wrong_usage("one file");
    desk.trace(&["a.json", "-o", "e.svg", "--debug-dir", "look"]).wrong_usage("--debug-dir");
    fs::write(desk.path("bad.json"), desk.read("a.json").replace("\"from\":0", "\"from\":999")).unwrap();
    desk.trace(&["bad.json", "-o", "e.svg"]).failed(&["bad.json: edges[", "].from: there is no node 999"]);
    fs::write(desk.path("cut.json"), &desk.read("a.json")[..300]).unwrap();
    desk.trace(&["cut.json", "-o", "e.svg"]).failed(&["cut.json: line "]);
    assert!(!desk.path("e.svg").exists() && !desk.path("look").exists());
}

#[test]
fn every_format_is_written_by_its_extension_and_by_its_name() {
    let desk = Desk::new();
    let begins: [(&str, &[u8]); 7] = [
        ("svg", b"<svg"),
        ("svgz", b"\x1f\x8b"),
        ("dxf", b"999\n{\"program\""),
        ("pdf", b"%PDF-"),
        ("geojson", b"{\"type\":\"FeatureCollection\""),
        ("csv", b"stroke,x,y,width,color\n"),
        ("json", b"{\n\"format\":\"fieldtrace-graph\""),
    ];
    for (format, begin) in begins {
        let [by_extension, by_name] = [format!("out.{format}"), format!("named-{format}")];
        desk.trace(&["drawing.png", "-o", &by_extension]).done();
        desk.trace(&["drawing.png", "-o", &by_name, "--format", format]).done();
        let [bytes, named] = [&by_extension, &by_name].map(|name| fs::read(desk.path(name)).unwrap());
        assert!(bytes.starts_with(begin), "{format}: {:?}", String::from_utf8_lossy(&bytes[..40]));
        assert_eq!(bytes, named, "{format}");
        desk.trace(&["drawing.png", "--format", format]).done();
        assert!(desk.path("drawing.png").with_extension(format).exists());
    }
}

#[test]
fn only_untouched_outputs_are_overwritten() {
    let desk = Desk::new();
    for output in ["out.svg", "out.dxf", "out.pdf", "out.geojson", "out.svgz", "out.json"] {
        fs::write(desk.path(output), "somebody's own").unwrap();
        desk.trace(&["drawing.png", "-o", output]).failed(&[output, "exists", "--force"]);
        assert_eq!(desk.read(output), "somebody's own");
        desk.trace(&["drawing.png", "-o", output, "--force"]).done();
        desk.trace(&["drawing.png", "-o", output, "--detail", "0.2"]).done();
    }
    let edited = desk.read("out.svg").replace("stroke=\"#", "stroke=\"#0");
    fs::write(desk.path("out.svg"), &edited).unwrap();
    desk.trace(&["drawing.png", "-o", "out.svg"]).failed(&["out.svg: exists and is not, or no longer"]);
    assert_eq!(desk.read("out.svg"), edited);
}

#[test]
fn an_output_tells_program_input_and_options() {
    let desk = Desk::new();
    desk.trace(&["drawing.png", "-o", "out.svg", "--detail", "0.25"]).done();
    let svg = desk.read("out.svg");
    let text = svg.split("<metadata>").nth(1).unwrap().split("</metadata>").next().unwrap();
    let origin: serde_json::Value = serde_json::from_str(text).unwrap();
    assert_eq!(origin["program"], concat!("fieldtrace ", env!("CARGO_PKG_VERSION")));
    assert!(origin["input"].as_str().unwrap().starts_with("sha256:"));
    assert_eq!(origin["options"]["trace"]["detail"], 0.25);
}

#[test]
fn pages_get_an_output_each() {
    let desk = Desk::new();
    let gray = image::open(desk.path("drawing.png")).unwrap().to_luma8();
    let mut tiff = std::io::Cursor::new(Vec::new());
    let mut encoder = tiff::encoder::TiffEncoder::new(&mut tiff).unwrap();
    for _ in 0..3 {
        encoder.write_image::<tiff::encoder::colortype::Gray8>(gray.width(), gray.height(), gray.as_raw()).unwrap();
    }
    fs::write(desk.path("book.tif"), tiff.into_inner()).unwrap();
    let run = desk.trace(&["book.tif"]);
    assert!(run.done().stderr.contains("3 pages, to book-1.svg to book-3.svg"), "{}", run.stderr);
    assert!(!desk.path("book.svg").exists());
    let body = |name: &str| desk.read(name).split("</metadata>").nth(1).unwrap().to_string();
    assert_eq!(body("book-1.svg"), body("book-3.svg"));
    desk.trace(&["book.tif", "--page", "2", "-o", "two.svg"]).done();
    assert_eq!(body("two.svg"), body("book-2.svg"));
    desk.trace(&["book.tif", "--page", "4"]).failed(&["book.tif", "3 pages"]);
    desk.trace(&["book.tif", "-o", "-"]).wrong_usage("--page");
    desk.trace(&["book.tif", "-o", "out/"]).done();
    desk.trace(&["book.tif", "-o", "out/", "--json"]).done();
    assert!(desk.path("out/book-2.svg").exists());
}

#[test]
fn an_svg_keeps_its_units_and_its_view_box() {
    let desk = Desk::new();
    let shapes = r##"<path d="M0 0L150 60" stroke="#c00" stroke-width="4"/>"##;
    for (size, view) in [
        ("width=\"100mm\" height=\"50mm\"", "-10 -5 200 100"),
        ("width=\"300\" height=\"300\"", "-10 -5 200 100"),
        ("", "-10 -5 200 100"),
    ] {
        let svg = format!("<svg xmlns=\"http://www.w3.org/2000/svg\" {size} viewBox=\"{view}\">{shapes}</svg>");
        fs::write(desk.path("in.svg"), svg).unwrap();
        desk.trace(&["in.svg", "-o", "out.svg"]).done();
        let out = desk.read("out.svg");
        assert!(out.contains(&format!("viewBox=\"{view}\"")), "{out}");
        assert!(size.split(' ').all(|attribute| out.contains(attribute)), "{out}");
        let number = |name: &str| -> f64 {
            out.split(&format!(" {name}=\"")).nth(1).unwrap().split('"').next().unwrap().parse().unwrap()
        };
        let (ends, way) = ([number("x1"), number("y1"), number("x2"), number("y2")], 2.5);
        assert!((ends[0].min(ends[2]) - 0.0).abs() < way && (ends[0].max(ends[2]) - 150.0).abs() < way, "{ends:?}");
        assert!((ends[1].min(ends[3]) - 0.0).abs() < way && (ends[1].max(ends[3]) - 60.0).abs() < way, "{ends:?}");
        assert!((number("stroke-width") - 4.0).abs() < 0.2);
    }
}

#[test]
fn shells_and_readers_are_told_of_the_command() {
    let desk = Desk::new();
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let text = String::from_utf8(desk.trace(&["completions", shell]).done().stdout.clone()).unwrap();
        assert!(text.contains("max-width"), "{shell}");
    }
    let page = String::from_utf8(desk.trace(&["man"]).done().stdout.clone()).unwrap();
    assert!(page.contains(".TH trace 1") && page.contains("max\\-width"));
    assert!(String::from_utf8(desk.trace(&["help"]).done().stdout.clone()).unwrap().contains("Usage: trace"));
    if !cfg!(feature = "train") {
        desk.trace(&["train", "-o", "run"]).wrong_usage("--features train");
    }
}

#[test]
fn ink_is_chosen_by_its_colour() {
    let desk = Desk::new();
    let image = image::RgbImage::from_fn(90, 60, |x, y| {
        let ink = if (12..15).contains(&y) { [200, 0, 0] } else { [0, 0, 0] };
        let is_inked = (10..80).contains(&x) && [12, 40].iter().any(|from| (*from..from + 3).contains(&y));
        image::Rgb(if is_inked { ink } else { [255; 3] })
    });
    image.save(desk.path("two.png")).unwrap();
    let strokes = |words: &[&str]| {
        let mut all = vec!["two.png", "-o", "-"];
        all.extend(words);
        let output = desk.command(&all).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap().matches("<line").count()
    };
    assert_eq!(strokes(&[]), 2);
    assert_eq!(strokes(&["--only", "#c80000"]), 1);
    assert_eq!(strokes(&["--ignore", "black"]), 1);
    assert_eq!(strokes(&["--only", "red", "--color-tolerance", "0.01"]), 0);
    assert_eq!(strokes(&["--only", "#c80000", "--only", "black"]), 2);
    let wrong = desk.command(&["two.png", "--only", "redish"]).output().unwrap();
    assert_eq!(wrong.status.code(), Some(2));
}
