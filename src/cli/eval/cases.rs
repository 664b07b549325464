//! What is to be traced, and where its truth is.

use crate::cli::failure::Failure;
use crate::cli::target;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// The kind of a rendering of the truth itself.
pub(super) const RENDER: &str = "render";

/// Extensions of rasters.
const RASTERS: [&str; 13] =
    ["png", "jpg", "jpeg", "tif", "tiff", "webp", "bmp", "gif", "pnm", "pbm", "pgm", "ppm", "jfif"];

/// A drawing to trace with its truth.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Case {
    /// `KIND` of a raster NAME.KIND.EXT, [`RENDER`] where the truth is rendered, else empty.
    pub kind: String,
    /// `NAME`.
    pub name: String,
    /// The SVG with the true strokes.
    pub truth: PathBuf,
    /// What is traced; the rendering of the truth where there is none.
    pub raster: Option<PathBuf>,
}

impl Case {
    /// The name up to its first dash.
    pub fn family(&self) -> &str {
        self.name.split('-').next().unwrap_or(&self.name)
    }

    /// The file that is traced.
    pub fn input(&self) -> &Path {
        self.raster.as_ref().unwrap_or(&self.truth)
    }
}

/// All cases of some folders and files, of some kinds where any are given.
pub(super) fn find(inputs: &[PathBuf], kinds: &[String]) -> Result<Vec<Case>, Failure> {
    let mut cases = BTreeSet::new();
    for input in inputs {
        let found = of_input(input, kinds)?;
        if found.is_empty() {
            let what = if kinds.is_empty() { String::new() } else { format!(" of kind {}", kinds.join(" or ")) };
            let name = target::name(input);
            return Err(Failure::File(format!("{name}: no SVG, and no raster beside its SVG, to compare with{what}")));
        }
        cases.extend(found);
    }
    Ok(cases.into_iter().collect())
}

fn of_input(input: &Path, kinds: &[String]) -> Result<Vec<Case>, Failure> {
    if input.is_dir() {
        let files = files(input)?;
        return Ok(truths(&files).iter().flat_map(|truth| of_truth(truth, &files, kinds)).collect());
    }
    if let Err(cause) = fs::metadata(input) {
        return Err(Failure::File(format!("{}: cannot be read: {cause}", target::name(input))));
    }
    let folder = input.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let files = files(folder)?;
    if target::extension(input) == "svg" {
        return Ok(of_truth(input, &files, kinds));
    }
    let cases = truths(&files).into_iter().flat_map(|truth| of_truth(&truth, &files, kinds));
    let same = |case: &Case| case.raster.as_ref().is_some_and(|r| r.file_name() == input.file_name());
    Ok(cases.filter(same).collect())
}

/// The files of a folder, sorted.
fn files(folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    let failed = |cause| Failure::File(format!("{}: cannot be read: {cause}", target::name(folder)));
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).map_err(failed)? {
        files.push(entry.map_err(failed)?.path());
    }
    files.sort();
    Ok(files)
}

/// The SVGs with true strokes: those named NAME.gt.svg where there are any, for others may be traces.
fn truths(files: &[PathBuf]) -> Vec<PathBuf> {
    let svgs = || files.iter().filter(|f| target::extension(f) == "svg");
    let marked: Vec<PathBuf> = svgs().filter(|f| stem(f).ends_with(".gt")).cloned().collect();
    if marked.is_empty() { svgs().cloned().collect() } else { marked }
}

/// The cases of one truth.
fn of_truth(truth: &Path, files: &[PathBuf], kinds: &[String]) -> Vec<Case> {
    let stem_of_truth = stem(truth);
    let name = stem_of_truth.strip_suffix(".gt").unwrap_or(&stem_of_truth);
    let case = |kind: &str, raster: Option<&PathBuf>| Case {
        kind: kind.into(),
        name: name.into(),
        truth: truth.to_owned(),
        raster: raster.cloned(),
    };
    let wanted = |kind: &str| kinds.is_empty() || kinds.iter().any(|k| k == kind);
    let raster = |file: &PathBuf| {
        let stem = stem(file);
        let rest = stem.strip_prefix(name)?;
        let kind = if rest.is_empty() { "" } else { rest.strip_prefix('.').filter(|k| !k.contains('.'))? };
        (RASTERS.contains(&&*target::extension(file)) && wanted(kind)).then(|| case(kind, Some(file)))
    };
    let mut cases: Vec<Case> = files.iter().filter_map(raster).collect();
    if (cases.is_empty() && kinds.is_empty()) || kinds.iter().any(|k| k == RENDER) {
        cases.push(case(RENDER, None));
    }
    cases
}

/// The file's name without its extension.
fn stem(file: &Path) -> String {
    file.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default()
}
