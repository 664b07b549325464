//! Where a result goes.

use super::failure::Failure;
use crate::write::format_named;
use std::path::{Path, PathBuf};

/// Kinds of files that are not what their content would be.
const OTHER_KINDS: [&str; 22] = [
    "png", "jpg", "jpeg", "tif", "tiff", "webp", "bmp", "gif", "pnm", "pbm", "pgm", "ppm", "tga", "qoi", "avif", "jxl",
    "npz", "npy", "eps", "ps", "ai", "dwg",
];

/// The path as it is shown in messages.
pub(crate) fn name(path: &Path) -> String {
    let text = path.display().to_string();
    text.chars().map(|c| if c.is_control() { '?' } else { c }).collect()
}

/// Whether a path stands for standard input or output.
pub(crate) fn is_stream(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// The extension in lower case.
pub(crate) fn extension(path: &Path) -> String {
    path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default()
}

/// Whether a path has the extension of a file of some kind.
pub(crate) fn is_file_name(path: &Path) -> bool {
    let extension = extension(path);
    format_named(&extension).is_some() || is_other_kind(&extension)
}

/// Whether a path stands for one file: it has the extension of one, and is no folder.
pub(crate) fn names_file(path: &Path) -> bool {
    is_file_name(path) && !path.is_dir()
}

/// Whether an extension is that of files of a kind that is not written.
pub(crate) fn is_other_kind(extension: &str) -> bool {
    OTHER_KINDS.contains(&extension)
}

/// What a trace writes: the file that was named, or the input's name with the extension of the format.
pub(crate) fn output_path(input: &Path, named: Option<&Path>, extension: &str) -> Result<PathBuf, Failure> {
    let output = match named {
        Some(path) => path.to_owned(),
        None if is_stream(input) => PathBuf::from("-"),
        None => input.with_extension(extension),
    };
    keep_input(input, &output)?;
    Ok(output)
}

/// Where the graph goes beside the output, which may be neither the input nor the output itself.
pub(crate) fn graph_path<'a>(
    input: &Path,
    output: &Path,
    named: Option<&'a Path>,
) -> Result<Option<&'a Path>, Failure> {
    let Some(graph) = named else { return Ok(None) };
    keep_input(input, graph)?;
    if graph == output {
        return Err(Failure::Usage(format!("{}: the graph and the output are one file", name(graph))));
    }
    Ok(named)
}

/// Refuses to write over the input.
pub(crate) fn keep_input(input: &Path, output: &Path) -> Result<(), Failure> {
    let same = !is_stream(input)
        && !is_stream(output)
        && match (input.canonicalize(), output.canonicalize()) {
            (Ok(input), Ok(output)) => input == output && input.is_file(),
            _ => false,
        };
    if same {
        return Err(Failure::Usage(format!(
            "{}: the output would overwrite the input; name another with -o",
            name(output)
        )));
    }
    Ok(())
}

/// Refuses to write over a file of a kind that does not tell who wrote it. An empty one is what a power cut leaves.
pub(crate) fn keep_file(output: &Path, force: bool) -> Result<(), Failure> {
    let is_file = output.metadata().is_ok_and(|file| file.is_file() && file.len() > 0);
    if is_file && !force && !is_stream(output) {
        return Err(Failure::File(format!("{}: exists already; --force overwrites it", name(output))));
    }
    Ok(())
}
