//! The corpora of the fuzz targets and the inputs that once broke something, replayed.

#[path = "../fuzz/src/lib.rs"]
#[allow(dead_code)] // what only the fuzzer needs
mod targets;

use rayon::prelude::*;
use std::fs;
use std::panic::catch_unwind;
use std::path::{Path, PathBuf};

/// Most bytes of an input and most inputs of a target: what keeps the replay short.
const LARGEST: u64 = 16 << 10;
const MOST: usize = 128;

/// The inputs of a target, sorted.
fn inputs(target: &str) -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz");
    let folders = [root.join("corpus").join(target), root.join("regressions").join(target)];
    let files = folders.iter().flat_map(|folder| fs::read_dir(folder).into_iter().flatten());
    let mut paths: Vec<PathBuf> = files.map(|file| file.unwrap().path()).collect();
    paths.sort();
    paths
}

/// Runs a target on all of its inputs and names those that break it.
fn replay(target: &str, run: fn(&[u8])) {
    let paths = inputs(target);
    assert!((8..=MOST).contains(&paths.len()), "{} inputs", paths.len());
    let broken: Vec<&PathBuf> = paths
        .par_iter()
        .filter(|path| {
            let bytes = fs::read(path).unwrap();
            assert!(bytes.len() as u64 <= LARGEST, "{} is too large", path.display());
            catch_unwind(|| run(&bytes)).is_err()
        })
        .collect();
    assert!(broken.is_empty(), "{target}: {broken:#?}");
}

#[test]
fn images() {
    replay("image", targets::image);
}

#[test]
fn svgs() {
    replay("svg", targets::svg);
}

#[test]
fn fields() {
    replay("field", targets::field);
}

#[test]
fn rasters() {
    replay("pipeline", targets::pipeline);
}

#[test]
fn graphs() {
    replay("graph", targets::graph);
}
