//! `trace field IN -o OUT`: the field of directions alone.

use crate::Error;
use crate::cli::args::FieldArgs;
use crate::cli::failure::Failure;
use crate::cli::source;
use crate::cli::target;
use crate::cli::watch::Stages;
use crate::field::{PolyVectorField, write_npz};
use crate::inspect::{field_overlay, to_png};
use crate::load::{Scan, load};
use crate::write::write_file;
use std::io::Cursor;
use std::path::Path;

/// What the field is written as.
#[derive(Clone, Copy)]
enum Format {
    Npz,
    Png,
    Svg,
}

/// Reads one drawing and writes its field.
pub(crate) fn run(args: &FieldArgs) -> Result<(), Failure> {
    let name = target::name(&args.input);
    let failed = |e: Error| Failure::of(&name, &e);
    let format = format_of(&args.output)?;
    target::keep_input(&args.input, &args.output)?;
    target::keep_file(&args.output, args.force)?;
    let vectorizer = source::vectorizer(&args.source, &args.clean, None).map_err(failed)?;

    let mut stages = Stages::start(args.talk.verbose);
    let scan = load(&args.input, &args.load.options()).map_err(failed)?.scan;
    stages.done("load", || format!("{} x {} pixels", scan.gray.width(), scan.gray.height()));
    let field = vectorizer.field(&scan).map_err(failed)?;
    let defined = field.confidence().data().iter().filter(|&&c| c > 0.0).count();
    stages.done("estimate", || format!("{defined} pixels with directions"));
    let bytes = encode(&scan, &field, format, &args.output).map_err(failed)?;
    write_file(&args.output, &bytes).map_err(failed)?;
    stages.done("write", || format!("{} bytes to {}", bytes.len(), target::name(&args.output)));
    if defined == 0 && !args.talk.quiet {
        eprintln!("trace: {name}: warning: no ink was found, the field is empty");
    }
    Ok(())
}

/// The format that the output's extension asks for; standard output gets the archive.
fn format_of(output: &Path) -> Result<Format, Failure> {
    match &*target::extension(output) {
        "npz" => Ok(Format::Npz),
        "png" => Ok(Format::Png),
        "svg" => Ok(Format::Svg),
        _ if target::is_stream(output) => Ok(Format::Npz),
        _ => Err(Failure::Usage(format!("{}: a field is written as .npz, .png or .svg", target::name(output)))),
    }
}

fn encode(scan: &Scan, field: &PolyVectorField, format: Format, output: &Path) -> crate::Result<Vec<u8>> {
    match format {
        Format::Npz => {
            let mut bytes = Cursor::new(Vec::new());
            write_npz(field, &mut bytes).map_err(|cause| Error::Write { path: output.to_owned(), cause })?;
            Ok(bytes.into_inner())
        }
        Format::Png => to_png(&field_overlay(scan, field)),
        Format::Svg => Ok(field_overlay(scan, field).into_bytes()),
    }
}
