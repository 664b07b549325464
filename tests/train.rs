//! `trace train`, and traces under the weights that it gives.
#![cfg(feature = "train")]

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

/// A run of a few seconds.
const TINY: &str = "
steps = 4
batch = 4
crop = 16
sheet = 32
crops_a_sheet = 2
warmup = 2
validate_every = 2
validation_sheets = 2

[network]
width = 4
levels = 1
";

fn trace(dir: &Path, words: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_trace")).current_dir(dir).args(words).output().unwrap()
}

fn done(output: &Output) -> String {
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{said}");
    said
}

fn refused(output: &Output, code: i32, word: &str) {
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{said}");
    assert!(said.contains(word), "{said}");
}

/// The lines of a run's metrics without the seconds.
fn metrics(run: &Path) -> Vec<String> {
    let text = fs::read_to_string(run.join("metrics.csv")).unwrap();
    text.lines().map(|l| l.split(',').enumerate().filter(|(i, _)| *i != 1).map(|(_, v)| v).collect()).collect()
}

#[test]
fn a_run_stops_goes_on_and_gives_weights_to_trace_with() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path();
    fs::write(dir.join("tiny.toml"), TINY).unwrap();
    let said = done(&trace(dir, &["train", "tiny.toml", "-o", "whole", "--steps", "4"]));
    assert!(said.contains("step 4 of 4: done"), "{said}");
    for file in
        ["best.safetensors", "last.safetensors", "metrics.csv", "curves.svg", "examples.png", "checkpoint/state.json"]
    {
        assert!(dir.join("whole").join(file).is_file(), "{file}");
    }
    assert_eq!(metrics(&dir.join("whole")).len(), 3);
    refused(&trace(dir, &["train", "tiny.toml", "-o", "whole"]), 1, "already");
    refused(&trace(dir, &["train", "-o", "none", "--resume"]), 1, "no run to go on with");
    // A run that is done stays as it is.
    let before = metrics(&dir.join("whole"));
    done(&trace(dir, &["train", "-o", "whole", "--resume"]));
    assert_eq!(before, metrics(&dir.join("whole")));
    done(&trace(dir, &["train", "tiny.toml", "-o", "more", "--from", "whole/best.safetensors", "-q"]));

    let kettle = Path::new(env!("CARGO_MANIFEST_DIR")).join("samples/kettle.png");
    let kettle = kettle.to_str().unwrap();
    let field = |name: &str, more: &[&str]| {
        done(&trace(dir, &[&["field", kettle, "-o", name], more].concat()));
        fs::read(dir.join(name)).unwrap()
    };
    let own = field("own.npz", &["--weights", "whole/best.safetensors"]);
    assert_ne!(own, field("built-in.npz", &[]));
    assert_ne!(own, field("tensor.npz", &["--estimator", "tensor"]));
    refused(&trace(dir, &[kettle, "-o", "x.svg", "--weights", "missing.safetensors"]), 1, "missing.safetensors");
    refused(&trace(dir, &[kettle, "-o", "x.svg", "--weights", "tiny.toml"]), 1, "tiny.toml");
    assert!(!dir.join("x.svg").exists());
}

#[test]
fn what_cannot_be_trained_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path();
    fs::write(dir.join("odd.toml"), "crop = 30").unwrap();
    refused(&trace(dir, &["train", "odd.toml", "-o", "run"]), 1, "crop");
    refused(&trace(dir, &["train", "missing.toml", "-o", "run"]), 1, "missing.toml");
    refused(&trace(dir, &["train", "-o", "run", "--svgs", "nowhere"]), 1, "nowhere");
    fs::create_dir(dir.join("blank")).unwrap();
    refused(&trace(dir, &["train", "-o", "run", "--svgs", "blank"]), 1, "no SVG with strokes");
    refused(&trace(dir, &["train", "-o", "run", "--device", "tpu"]), 2, "tpu");
    #[cfg(not(feature = "gpu"))]
    refused(&trace(dir, &["train", "-o", "run", "--device", "gpu"]), 2, "--features gpu");
    assert!(!dir.join("run").exists());
}
