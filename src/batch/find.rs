//! Names, folders and patterns to files.

use crate::error::{Error, Result};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use walkdir::{DirEntry, WalkDir};

/// What the raster images and documents of a folder are told by.
const READ: [&str; 25] = [
    "png", "jpg", "jpeg", "jpe", "jfif", "tif", "tiff", "webp", "bmp", "dib", "gif", "pnm", "pbm", "pgm", "ppm", "pam",
    "tga", "qoi", "avif", "jxl", "jp2", "j2k", "jpf", "jpx", "pdf",
];

/// What an input stands for.
#[derive(Debug)]
pub(super) enum Found {
    /// A file to trace.
    File {
        /// As it can be opened.
        path: PathBuf,
        /// Where it lies in the folder or under the pattern that it was found by; of a file that was named, its name.
        place: PathBuf,
    },
    /// A file of a folder that is of no kind that is read.
    Other,
}

/// The files that an input stands for, and what could not be listed.
///
/// # Errors
/// [`Error::Plan`] when a pattern is none or finds nothing.
pub(super) fn find(input: &Path, recursive: bool) -> Result<Vec<Result<Found>>> {
    if input.is_dir() {
        return Ok(in_folder(input, recursive));
    }
    if is_pattern(input) {
        return by_pattern(&input.to_string_lossy());
    }
    let place = input.file_name().map_or_else(|| input.to_owned(), PathBuf::from);
    Ok(vec![Ok(Found::File { path: input.to_owned(), place })])
}

/// Whether an input is a pattern: what exists is itself, whatever signs its name has.
pub fn is_pattern(input: &Path) -> bool {
    has_signs(input.as_os_str()) && input.symlink_metadata().is_err()
}

fn has_signs(text: &OsStr) -> bool {
    text.to_string_lossy().contains(['*', '?', '['])
}

/// The raster images and documents of a folder; what is hidden is left alone.
fn in_folder(folder: &Path, recursive: bool) -> Vec<Result<Found>> {
    let shown = |entry: &DirEntry| entry.depth() == 0 || !entry.file_name().as_encoded_bytes().starts_with(b".");
    let depth = if recursive { usize::MAX } else { 1 };
    let mut found = Vec::new();
    for entry in WalkDir::new(folder).min_depth(1).max_depth(depth).into_iter().filter_entry(shown) {
        match entry {
            // Links to files are followed, links to folders are not: they may lead round in a circle.
            Ok(entry) if is_read(entry.path()) && entry.path().is_file() => {
                let place = entry.path().strip_prefix(folder).unwrap_or(entry.path()).to_owned();
                found.push(Ok(Found::File { path: entry.into_path(), place }));
            }
            Ok(entry) if entry.path().is_file() => found.push(Ok(Found::Other)),
            Ok(_) => {}
            Err(e) => {
                let path = e.path().unwrap_or(folder).to_owned();
                let cause = e.into_io_error().unwrap_or_else(|| std::io::Error::other("it contains itself"));
                found.push(Err(Error::List { path, cause }));
            }
        }
    }
    found
}

fn is_read(path: &Path) -> bool {
    path.extension().is_some_and(|e| READ.contains(&&*e.to_string_lossy().to_lowercase()))
}

/// The files that match a pattern, placed under the folders that the pattern names outright.
fn by_pattern(pattern: &str) -> Result<Vec<Result<Found>>> {
    let wrong = |reason: String| Error::Plan { reason: format!("{pattern}: {reason}") };
    let base: PathBuf = Path::new(pattern).iter().take_while(|part| !has_signs(part)).collect();
    let matches = glob::glob(pattern).map_err(|e| wrong(format!("no such file, and no pattern: {e}")))?;
    let mut found = Vec::new();
    for path in matches {
        match path {
            Ok(path) if path.is_dir() => {}
            Ok(path) => {
                let place = path.strip_prefix(&base).unwrap_or(&path).to_owned();
                found.push(Ok(Found::File { path, place }));
            }
            Err(e) => found.push(Err(Error::List { path: e.path().to_owned(), cause: e.into() })),
        }
    }
    if found.is_empty() {
        return Err(wrong("no such file, and no file matches it as a pattern".into()));
    }
    Ok(found)
}
