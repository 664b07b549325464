//! Where a result goes.

use crate::failure::Failure;
use std::path::{Path, PathBuf};

/// Kinds of files that are not what their content would be.
const OTHER_FORMATS: [&str; 19] = [
    "png", "jpg", "jpeg", "tif", "tiff", "webp", "bmp", "gif", "pnm", "pbm", "pgm", "ppm", "npz", "npy", "pdf", "eps",
    "dxf", "ps", "ai",
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
    ["svg", "json"].contains(&&*extension) || OTHER_FORMATS.contains(&&*extension)
}

/// What a trace writes: the file that was named, or the input's name with `.svg`.
pub(crate) fn output_path(input: &Path, named: Option<&Path>) -> Result<PathBuf, Failure> {
    let output = match named {
        Some(path) => path.to_owned(),
        None if is_stream(input) => PathBuf::from("-"),
        None => input.with_extension("svg"),
    };
    let extension = extension(&output);
    if OTHER_FORMATS.contains(&&*extension) {
        return Err(Failure::Usage(format!(
            "{}: the output is SVG, not {extension} (the graph is .json)",
            name(&output)
        )));
    }
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
