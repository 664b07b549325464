//! A folder with drawings in it, and the program run there.

use crate::common::draw::{circle, dot, line, polar, scan, sheet};
use fieldtrace::drawing::Drawing;
use image::{GrayImage, Luma};
use kurbo::Point;
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

/// A folder, gone at the end of the test.
pub struct Desk(TempDir);

impl Desk {
    /// An empty one.
    pub fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    /// With a small drawing for each name.
    pub fn with(names: &[&str]) -> Self {
        let desk = Self::new();
        names.iter().enumerate().for_each(|(seed, name)| desk.draw(name, seed));
        desk
    }

    /// With `in/000.png` and so on.
    pub fn with_many(count: usize) -> Self {
        let desk = Self::new();
        (0..count).for_each(|i| desk.draw(&format!("in/{i:03}.png"), i));
        desk
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Writes bytes, and makes the folders on the way.
    pub fn put(&self, name: &str, bytes: impl AsRef<[u8]>) {
        fs::create_dir_all(self.path(name).parent().unwrap()).unwrap();
        fs::write(self.path(name), bytes).unwrap();
    }

    /// A small drawing of its own for each seed.
    pub fn draw(&self, name: &str, seed: usize) {
        self.picture(name, &small(seed));
    }

    pub fn picture(&self, name: &str, drawing: &Drawing) {
        fs::create_dir_all(self.path(name).parent().unwrap()).unwrap();
        let gray = scan(drawing).gray;
        let image = GrayImage::from_fn(gray.width() as u32, gray.height() as u32, |x, y| {
            Luma([(255.0 * gray[(x as usize, y as usize)]).round() as u8])
        });
        image.save(self.path(name)).unwrap();
    }

    pub fn command(&self, words: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_trace"));
        command.args(words).current_dir(self.0.path());
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    pub fn trace(&self, words: &[&str]) -> Run {
        Run::of(self.command(words).output().unwrap())
    }

    /// All files, by their paths in the folder, sorted.
    pub fn files(&self, folder: &str) -> Vec<String> {
        let root = self.path(folder);
        let mut files = Vec::new();
        collect(&root, &root, &mut files);
        files.sort();
        files
    }

    pub fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap()
    }

    /// The contents of all files in a folder.
    pub fn contents(&self, folder: &str) -> Vec<(String, String)> {
        self.files(folder).into_iter().map(|name| (name.clone(), self.read(&format!("{folder}/{name}")))).collect()
    }
}

fn collect(root: &Path, folder: &Path, files: &mut Vec<String>) {
    for entry in fs::read_dir(folder).into_iter().flatten() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            collect(root, &path, files);
        } else {
            files.push(path.strip_prefix(root).unwrap().to_str().unwrap().replace('\\', "/"));
        }
    }
}

/// A few lines that no other seed has.
fn small(seed: usize) -> Drawing {
    let centre = Point::new(24.0, 24.0);
    let turn = 7.0 * seed as f64;
    let mut strokes = vec![line(polar(centre, turn, 17.0), polar(centre, turn + 180.0, 17.0), 2.5)];
    match seed % 3 {
        0 => strokes.push(line(polar(centre, turn + 80.0, 15.0), polar(centre, turn - 100.0, 15.0), 2.5)),
        1 => strokes.push(circle(polar(centre, turn + 90.0, 12.0), 6.0, 2.0)),
        _ => strokes.push(dot(polar(centre, turn + 90.0, 12.0), 5.0)),
    }
    sheet(48, 48, strokes)
}

/// A net of lines that takes a while.
pub fn large() -> Drawing {
    let at = |k: usize| 12.0 + 24.0 * k as f64;
    let end = at(9) + 12.0;
    let across = (0..10).map(|k| line((8.0, at(k)), (end - 8.0, at(k) + 3.0), 3.0));
    let down = (0..10).map(|k| line((at(k), 8.0), (at(k) + 3.0, end - 8.0), 3.0));
    sheet(end as usize, end as usize, across.chain(down).collect())
}

/// How a run of the program ended.
pub struct Run {
    pub code: i32,
    pub stdout: String,
    pub stderr: String,
}

impl Run {
    pub fn of(output: Output) -> Self {
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert!(!stderr.contains("panicked"), "{stderr}");
        let code = output.status.code().expect("an exit code");
        Self { code, stdout: String::from_utf8(output.stdout).unwrap(), stderr }
    }

    #[track_caller]
    pub fn done(&self) -> &Self {
        self.ended(0, &[])
    }

    /// Ended with a code, and said all the words.
    #[track_caller]
    pub fn ended(&self, code: i32, words: &[&str]) -> &Self {
        assert_eq!(self.code, code, "{}", self.stderr);
        words.iter().for_each(|word| assert!(self.stderr.contains(word), "no {word} in {}", self.stderr));
        self
    }

    /// The lines of JSON.
    pub fn records(&self) -> Vec<Value> {
        self.stdout.lines().map(|line| serde_json::from_str(line).expect("a record")).collect()
    }

    /// The status of each input, in order.
    pub fn statuses(&self) -> Vec<(String, String)> {
        let text = |value: &Value| value.as_str().expect("text").to_owned();
        self.records().iter().map(|record| (text(&record["input"]), text(&record["status"]))).collect()
    }

    /// How many inputs have a status.
    pub fn count(&self, status: &str) -> usize {
        self.statuses().iter().filter(|(_, is)| is == status).count()
    }
}

/// Whether text is a whole SVG with strokes.
#[track_caller]
pub fn assert_whole(svg: &str) {
    usvg::Tree::from_str(svg, &usvg::Options::default()).expect("valid SVG");
    assert!(svg.trim_end().ends_with("</svg>") && svg.contains("stroke-width="), "{svg}");
}
