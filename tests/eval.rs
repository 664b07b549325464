//! `trace eval` driven as a user would.

use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use tempfile::TempDir;

/// A cross and a circle.
const DRAWING: &str = "<path d='M20 20L100 90M90 15L25 95'/><circle cx='150' cy='60' r='30'/>";

/// A line and an arc.
const OTHER: &str = "<path d='M15 100L80 20'/><path d='M100 90A40 40 0 0 1 180 90'/>";

fn svg(body: &str) -> String {
    format!(
        "<svg xmlns='http://www.w3.org/2000/svg' width='200' height='120'>\
         <g fill='none' stroke='black' stroke-width='3' stroke-linecap='round'>{body}</g></svg>"
    )
}

/// A folder with `a-cross.svg` and `b-arc.svg`.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a-cross.svg"), svg(DRAWING)).unwrap();
    fs::write(folder.path().join("b-arc.svg"), svg(OTHER)).unwrap();
    folder
}

/// Draws an SVG's rendering to a file, at a size in pixels.
fn picture(text: &str, size: u32, path: &Path) {
    use fieldtrace::load::{LoadOptions, load_bytes};
    let options = LoadOptions::default().with(|o| o.size = Some(size));
    let gray = load_bytes("drawing", text.as_bytes(), &options).unwrap().scan.gray;
    let bytes = gray.data().iter().map(|v| (255.0 * v).round() as u8).collect();
    image::GrayImage::from_raw(gray.width() as u32, gray.height() as u32, bytes).unwrap().save(path).unwrap();
}

fn run(folder: &Path, words: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_trace")).arg("eval").args(words).current_dir(folder).output().unwrap()
}

/// Standard output of a run that ends well.
#[track_caller]
fn text(folder: &Path, words: &[&str]) -> String {
    let output = run(folder, words);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

#[track_caller]
fn json(folder: &Path, words: &[&str]) -> Value {
    serde_json::from_str(&text(folder, &[words, &["--json", "-"]].concat())).unwrap()
}

/// Fails on a file, which the message names.
#[track_caller]
fn failed(folder: &Path, words: &[&str], reasons: &[&str]) {
    let output = run(folder, words);
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{stderr}");
    reasons.iter().for_each(|reason| assert!(stderr.contains(reason), "no {reason} in {stderr}"));
    assert!(!stderr.contains("panicked") && output.stdout.is_empty(), "{stderr}");
}

/// The rows with a first word.
fn rows<'a>(table: &'a str, name: &str) -> Vec<Vec<&'a str>> {
    let words = table.lines().map(|line| line.split_whitespace().collect::<Vec<_>>());
    words.filter(|words| words.first() == Some(&name)).collect()
}

fn kinds(report: &Value) -> Vec<(String, String)> {
    let text = |row: &Value, key: &str| row[key].as_str().unwrap().to_owned();
    report["drawings"].as_array().unwrap().iter().map(|d| (text(d, "name"), text(d, "kind"))).collect()
}

#[test]
fn clean_drawings_are_traced_well() {
    let report = json(folder().path(), &["."]);
    let drawings = report["drawings"].as_array().unwrap();
    assert_eq!(drawings.len(), 2);
    for drawing in drawings {
        let figure = |name: &str| drawing[name].as_f64().unwrap_or_else(|| panic!("{name} in {drawing}"));
        for name in ["f1_0.5", "junction_f1", "endpoint_f1", "integrity", "purity", "iou"] {
            assert!(figure(name) > 0.93 && figure(name) <= 1.0, "{name} in {drawing}");
        }
        assert!(figure("chamfer") < 0.3 && figure("ink_deg") < 3.0 && figure("s_per_mp") > 0.0, "{drawing}");
        assert!(figure("field_s_per_mp") > 0.0 && figure("field_s_per_mp") < figure("s_per_mp"), "{drawing}");
        assert_eq!(figure("paths_ratio"), 1.0, "{drawing}");
    }
    assert!(drawings[1]["junction_deg"].is_null(), "there is no junction");
    assert_eq!(report["left_out"].as_array().unwrap().len(), 0);
}

#[test]
fn the_table_has_a_row_for_each_family_and_for_all() {
    let folder = folder();
    let table = text(folder.path(), &["."]);
    for (name, count) in [("a", "1"), ("b", "1"), ("all", "2")] {
        let [row] = &rows(&table, name)[..] else { panic!("{name} in {table}") };
        assert_eq!((row[1], row.len()), (count, 17), "{table}");
    }
    assert!(rows(&table, "a-cross").is_empty());
    let files = text(folder.path(), &[".", "--files"]);
    assert_eq!(rows(&files, "a-cross").len(), 1, "{files}");
    let alone = text(folder.path(), &["b-arc.svg"]);
    assert!(rows(&alone, "b").is_empty() && rows(&alone, "all").len() == 1, "{alone}");
    let [row] = &rows(&alone, "all")[..] else { unreachable!() };
    assert_eq!(row[3], "-", "no junction, no error there: {alone}");
}

#[test]
fn the_means_are_those_of_the_drawings() {
    let report = json(folder().path(), &["."]);
    for name in ["chamfer", "iou", "ink_deg", "segs_ratio"] {
        let of = |list: &str, i: usize| report[list][i][name].as_f64().unwrap();
        assert_eq!(report["means"][2]["family"], "all");
        assert!((of("means", 2) - 0.5 * (of("drawings", 0) + of("drawings", 1))).abs() < 1e-9, "{name}");
    }
}

#[test]
fn rasters_are_paired_with_their_truth() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    fs::rename(path("a-cross.svg"), path("a-cross.gt.svg")).unwrap();
    picture(&svg(DRAWING), 300, &path("a-cross.png"));
    picture(&svg(DRAWING), 400, &path("a-cross.big.png"));
    picture(&svg(DRAWING), 200, &path("stranger.png"));
    fs::write(path("a-cross.txt"), "no picture").unwrap();
    let cross = |kinds: &[&str]| kinds.iter().map(|k| ("a-cross".to_owned(), (*k).to_owned())).collect::<Vec<_>>();
    let found = |words: &[&str]| kinds(&json(folder.path(), words));
    assert_eq!(found(&["."]), cross(&["", "big"]), "other SVGs are traces where truths are marked");
    assert_eq!(found(&[".", "--kind", "big"]), cross(&["big"]));
    assert_eq!(found(&[".", "--kind", "big,render"]), cross(&["big", "render"]));
    assert_eq!(found(&["a-cross.png", "a-cross.big.png"]), cross(&["", "big"]));
    assert_eq!(found(&["a-cross.png", "."]), cross(&["", "big"]), "what is named twice counts once");
    assert_eq!(found(&["b-arc.svg"]), [("b-arc".to_owned(), "render".to_owned())]);
    for drawing in json(folder.path(), &["."])["drawings"].as_array().unwrap() {
        assert!(drawing["chamfer"].as_f64().unwrap() < 0.4, "the truth is scaled to the raster: {drawing}");
    }
}

#[test]
fn estimators_are_compared_in_their_order() {
    let table = text(folder().path(), &[".", "--estimators", "tensor,tensor"]);
    assert_eq!(rows(&table, "tensor,").len(), 1, "{table}");
}

#[test]
fn options_of_a_trace_are_taken() {
    let folder = folder();
    let plain = json(folder.path(), &["."]);
    let wide = json(folder.path(), &[".", "--width", "9", "--size", "256"]);
    assert!(wide["means"][2]["iou"].as_f64() < plain["means"][2]["iou"].as_f64());
}

#[test]
fn json_goes_to_a_file_beside_the_table() {
    let folder = folder();
    let table = text(folder.path(), &[".", "--json", "figures.json"]);
    assert_eq!(rows(&table, "all").len(), 1);
    let report: Value = serde_json::from_str(&fs::read_to_string(folder.path().join("figures.json")).unwrap()).unwrap();
    assert_eq!(report["means"].as_array().unwrap().len(), 3);
}

#[test]
fn a_report_has_the_figures_and_the_worst_traces() {
    let folder = folder();
    let path = |name: &str| folder.path().join("out").join(name);
    // Strokes that its ink does not show.
    picture(&svg(OTHER), 200, &folder.path().join("a-cross.scan.png"));
    picture(&svg(OTHER), 200, &folder.path().join("b-arc.scan.png"));
    text(folder.path(), &[".", "--kind", "scan", "--report", "out", "--worst", "1"]);
    let page = fs::read_to_string(path("report.md")).unwrap();
    for family in ["| a | 1 |", "| b | 1 |", "| all | 2 |"] {
        assert!(page.contains(family), "no {family} in {page}");
    }
    assert!(page.contains("1. **a-cross**: junction_f1 0.000") && !page.contains("**b-arc**"), "{page}");
    let picture = image::open(path("unet-scan-1-a-cross.png")).unwrap().to_rgb8();
    assert!(picture.pixels().any(|p| p.0[0] > 200 && p.0[1] < 60), "what was traced is in colour");
    assert_eq!(fs::read_dir(path("")).unwrap().count(), 2);
    text(folder.path(), &[".", "--report", "all"]);
    assert_eq!(fs::read_dir(folder.path().join("all")).unwrap().count(), 3);
    assert_eq!(run(folder.path(), &[".", "--worst", "1"]).status.code(), Some(2), "of which report?");
    failed_late(folder.path(), &[".", "--report", "a-cross.svg"], "a-cross.svg: ");
}

/// Ends with an error about a file, after the table.
#[track_caller]
fn failed_late(folder: &Path, words: &[&str], reason: &str) {
    let output = run(folder, words);
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.code() == Some(1) && stderr.contains(reason) && !stderr.contains("panicked"), "{stderr}");
}

#[test]
fn what_cannot_be_compared_is_reported_and_left_out() {
    let folder = folder();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("c-blot.svg", &svg("<path d='M10 10H60V60Z' fill='black' stroke='none'/>"));
    write("d-cut.svg", "<svg");
    let output = run(folder.path(), &[".", "--json", "-"]);
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success() && stderr.lines().count() == 2, "{stderr}");
    assert!(stderr.contains("c-blot.svg: has no strokes: left out") && stderr.contains("d-cut.svg: "), "{stderr}");
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((report["drawings"].as_array().unwrap().len(), report["left_out"].as_array().unwrap().len()), (2, 2));
    assert!(run(folder.path(), &[".", "-q"]).stderr.is_empty());
    failed(folder.path(), &["c-blot.svg"], &["c-blot.svg: has no strokes"]);
}

#[test]
fn nothing_to_compare_is_an_error() {
    let folder = folder();
    fs::create_dir(folder.path().join("empty")).unwrap();
    picture(&svg(OTHER), 200, &folder.path().join("stranger.png"));
    failed(folder.path(), &["empty"], &["empty: no SVG"]);
    failed(folder.path(), &["stranger.png"], &["stranger.png: no SVG"]);
    failed(folder.path(), &["nosuch"], &["nosuch: cannot be read"]);
    failed(folder.path(), &[".", "--kind", "scan"], &["of kind scan"]);
    assert_eq!(run(folder.path(), &[]).status.code(), Some(2));
    assert_eq!(run(folder.path(), &[".", "--estimators", "oracle"]).status.code(), Some(2));
}

#[test]
fn the_samples_are_found_with_their_truths() {
    let samples = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("samples");
    let report = json(&samples, &["kettle.png", "boat.png"]);
    assert_eq!(kinds(&report), [("boat".to_owned(), String::new()), ("kettle".to_owned(), String::new())]);
    for drawing in report["drawings"].as_array().unwrap() {
        assert!(drawing["f1_2"].as_f64().unwrap() > 0.95 && drawing["ink_deg"].as_f64().unwrap() < 6.0, "{drawing}");
    }
}

#[test]
fn the_drawings_of_the_guide_are_all_there_and_traced_well() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let report = json(root, &["tests/quality", "--kind", "clean"]);
    let drawings = report["drawings"].as_array().unwrap();
    for family in ["lucide-", "technical-"] {
        let of = drawings.iter().filter(|d| d["name"].as_str().unwrap().starts_with(family));
        assert_eq!(of.count(), 24);
    }
    for drawing in drawings {
        assert!(drawing["f1_1"].as_f64().unwrap() > 0.99, "{}", drawing["name"]);
        for end in ["scan.jpg", "hard.jpg"] {
            let page = root.join(format!("tests/quality/{}.{end}", drawing["name"].as_str().unwrap()));
            assert!(page.exists() || page.with_extension("png").exists(), "{}", page.display());
        }
    }
}
