//! What is to be traced to where.

use super::find::{Found, find};
use crate::error::{Error, Result};
use std::collections::{BTreeMap, HashSet};
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// At most this many clashes are named.
const NAMED: usize = 5;

/// One file and what is written for it.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Job {
    /// The drawing.
    pub input: PathBuf,
    /// What is written.
    pub output: PathBuf,
}

/// Where outputs go, and what their names end in.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Destination {
    /// The folder; `None` is that of each input.
    pub folder: Option<PathBuf>,
    /// The extension of outputs, without its point.
    pub extension: String,
}

impl Destination {
    /// SVGs in a folder.
    pub fn folder(folder: impl Into<PathBuf>) -> Self {
        Self { folder: Some(folder.into()), extension: "svg".into() }
    }

    /// The output for an input that was found at a place in a folder or under a pattern.
    fn output(&self, input: &Path, place: &Path) -> PathBuf {
        let named = self.folder.as_ref().map_or_else(|| input.to_owned(), |folder| folder.join(place));
        named.with_extension(&self.extension)
    }
}

/// The jobs of a batch.
#[derive(Debug, Default)]
pub struct Plan {
    /// The jobs, sorted by input; every output is another.
    pub jobs: Vec<Job>,
    /// What could not be listed on the way.
    pub unreadable: Vec<Error>,
    /// How many files of folders are left out because they are of no kind that is read.
    pub others: usize,
}

impl Plan {
    /// Plans to trace files, the raster images and documents of folders and what matches patterns (`*`, `?`, `[..]`, and
    /// `**` for folders at any depth).
    ///
    /// A name that exists is never taken for a pattern. The folders that lie in a folder are entered where
    /// `recursive` says so; their tree, like that under the first folder that a pattern leaves open, is kept in the
    /// output. An input that is named twice is traced once. Inputs whose names differ in their extensions alone keep these
    /// in the names of their outputs, as `a.tif.svg`.
    ///
    /// # Errors
    /// [`Error::Plan`] when two inputs have the same output, an input would be overwritten, or a pattern finds
    /// nothing. Nothing has been written by then.
    pub fn new(inputs: &[PathBuf], to: &Destination, recursive: bool) -> Result<Self> {
        let mut plan = Self::default();
        for input in inputs {
            for found in find(input, recursive)? {
                match found {
                    Ok(Found::File { path, place }) => {
                        let output = to.output(&path, &place);
                        plan.jobs.push(Job { input: path, output });
                    }
                    Ok(Found::Other) => plan.others += 1,
                    Err(e) => plan.unreadable.push(e),
                }
            }
        }
        plan.jobs.sort();
        plan.jobs.dedup();
        plan.join_aliases();
        plan.tell_apart();
        plan.refuse_clashes()?;
        Ok(plan)
    }

    /// The part of the jobs that is one share of several: the same for the same list, whatever has been done of it.
    #[must_use]
    pub fn share(mut self, share: Share) -> Self {
        self.jobs = self.jobs.into_iter().skip(share.number - 1).step_by(share.count).collect();
        self
    }

    /// Drops a job whose input is another name for that of a job with the same output.
    fn join_aliases(&mut self) {
        let mut first: BTreeMap<PathBuf, PathBuf> = BTreeMap::new();
        self.jobs.retain(|job| match first.get(&job.output) {
            Some(input) => !is_same_file(input, &job.input),
            None => first.insert(job.output.clone(), job.input.clone()).is_none(),
        });
    }

    /// Gives inputs of one name and several extensions outputs of their own.
    fn tell_apart(&mut self) {
        let mut names: BTreeMap<PathBuf, Vec<OsString>> = BTreeMap::new();
        for job in &self.jobs {
            names.entry(job.output.clone()).or_default().extend(job.input.file_name().map(OsString::from));
        }
        let differ = |output: &Path| {
            let names = &names[output];
            names.len() > 1 && names.iter().collect::<HashSet<_>>().len() == names.len()
        };
        for job in self.jobs.iter_mut().filter(|job| differ(&job.output)) {
            let (name, end) = (job.input.file_name(), job.output.extension());
            if let (Some(name), Some(end)) = (name, end) {
                let whole = format!("{}.{}", name.to_string_lossy(), end.to_string_lossy());
                job.output.set_file_name(whole);
            }
        }
    }

    fn refuse_clashes(&self) -> Result<()> {
        let mut by_output: BTreeMap<&Path, Vec<&Path>> = BTreeMap::new();
        for job in &self.jobs {
            by_output.entry(&job.output).or_default().push(&job.input);
        }
        // Only a file with an output's extension can be what is written.
        let ends: HashSet<String> = self.jobs.iter().filter_map(|job| extension(&job.output)).collect();
        let alike = self.jobs.iter().filter(|job| extension(&job.input).is_some_and(|end| ends.contains(&end)));
        let drawings: HashSet<PathBuf> = alike.filter_map(|job| job.input.canonicalize().ok()).collect();
        let overwritten = |output: &Path| {
            !drawings.is_empty() && output.canonicalize().is_ok_and(|output| drawings.contains(&output))
        };
        let clash = |(output, inputs): (&Path, Vec<&Path>)| match inputs.as_slice() {
            [_, _, ..] => {
                let names: Vec<String> = inputs.iter().map(|input| input.display().to_string()).collect();
                Some(format!("{} would all be written to {}", names.join(", "), output.display()))
            }
            _ => overwritten(output).then(|| format!("{}: an input would be overwritten", output.display())),
        };
        let clashes: Vec<String> = by_output.into_iter().filter_map(clash).collect();
        if clashes.is_empty() {
            return Ok(());
        }
        let more = clashes.len().saturating_sub(NAMED);
        let more = if more > 0 { format!("; and {more} more") } else { String::new() };
        Err(Error::Plan { reason: format!("{}{more}", clashes[..clashes.len().min(NAMED)].join("; ")) })
    }
}

fn extension(path: &Path) -> Option<String> {
    Some(path.extension()?.to_string_lossy().to_lowercase())
}

fn is_same_file(a: &Path, b: &Path) -> bool {
    matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b)
}

/// One of several equal parts of a list, written `NUMBER/COUNT`, counted from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Share {
    number: usize,
    count: usize,
}

impl FromStr for Share {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let parts = text.split_once('/').and_then(|(number, count)| Some((number.parse().ok()?, count.parse().ok()?)));
        match parts {
            Some((number, count)) if number >= 1 && number <= count => Ok(Self { number, count }),
            _ => Err("not I/N with I from 1 to N".into()),
        }
    }
}
