//! `trace IN... -o DIR`: many drawings to SVG.

use crate::args::TraceArgs;
use crate::failure::Failure;
use crate::interrupt;
use crate::report::Report;
use crate::source;
use crate::target;
use fieldtrace::Error;
use fieldtrace::batch::{Batch, FileTracer, Plan, is_pattern};
use fieldtrace::write::remove_abandoned;
use std::collections::BTreeSet;
use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};

/// Whether the arguments of `trace` ask for a batch.
pub(crate) fn is_meant(args: &TraceArgs) -> bool {
    let names_folder = |output: &Path| {
        output.as_os_str().as_encoded_bytes().ends_with(b"/") || (output.is_dir() && target::extension(output) != "svg")
    };
    match args.inputs.as_slice() {
        _ if args.batch.any() => true,
        [input] => input.is_dir() || is_pattern(input) || args.output.as_deref().is_some_and(names_folder),
        _ => true,
    }
}

/// Traces everything that the arguments name, and tells what became of each.
pub(crate) fn run(args: &TraceArgs) -> Result<(), Failure> {
    let failed = |e: Error| Failure::of("batch", &e);
    let folder = folder(args)?;
    let vectorizer = source::vectorizer(&args.source, &args.clean, Some(&args.fit)).map_err(failed)?;
    let tracer = FileTracer {
        load: args.load.options(),
        precision: args.precision,
        force: args.batch.force,
        ..FileTracer::new(vectorizer)
    };
    let plan = plan(args, folder)?;
    fs::create_dir_all(folder).map_err(|cause| failed(Error::Write { path: folder.to_owned(), cause }))?;

    let folders: BTreeSet<&Path> = plan.jobs.iter().filter_map(|job| job.output.parent()).collect();
    folders.into_iter().for_each(remove_abandoned);

    let batch = Batch {
        jobs: args.batch.jobs.map_or(0, usize::from),
        timeout: args.batch.timeout,
        cancel: interrupt::token()
            .map_err(|e| Failure::File(format!("interrupts from the keyboard cannot be received: {e}")))?,
    };
    let report = Report::new(&plan, &args.talk, args.batch.json);
    let outcomes =
        batch.run(&plan.jobs, |job, cancel| tracer.trace(job, cancel), |event| report.tell(event)).map_err(failed)?;
    report.end(&plan, &outcomes)
}

/// The folder that the outputs go to.
fn folder(args: &TraceArgs) -> Result<&Path, Failure> {
    let usage = |text: &str| Err(Failure::Usage(text.into()));
    if args.graph.is_some() {
        return usage("--graph names one file, not one for each drawing of a batch");
    }
    if args.debug_dir.is_some() {
        return usage("--debug-dir shows one drawing, not a batch");
    }
    if args.inputs.iter().any(|input| target::is_stream(input)) {
        return usage("-: standard input is one drawing, not a part of a batch");
    }
    match args.output.as_deref() {
        None => usage("a batch is written to a folder: name it with -o DIR"),
        Some(output) if target::is_stream(output) => usage("-: a batch is written to a folder, not to standard output"),
        Some(output) if target::is_file_name(output) && !output.is_dir() => {
            Err(Failure::Usage(format!("{}: a batch is written to a folder, not to a file", target::name(output))))
        }
        Some(output) => Ok(output),
    }
}

/// The jobs that the inputs, the manifest and the shard ask for.
fn plan(args: &TraceArgs, folder: &Path) -> Result<Plan, Failure> {
    let failed = |e: Error| Failure::of("batch", &e);
    let mut inputs = args.inputs.clone();
    if let Some(manifest) = &args.batch.manifest {
        let read = listed(manifest);
        inputs.extend(read.map_err(|cause| failed(Error::Read { input: target::name(manifest), cause }))?);
    }
    let plan = Plan::new(&inputs, folder, args.batch.recursive).map_err(failed)?;
    if plan.jobs.is_empty() && plan.unreadable.is_empty() {
        return Err(Failure::Usage("there is nothing to trace: no raster image was found".into()));
    }
    Ok(match args.batch.shard {
        Some(share) => plan.share(share),
        None => plan,
    })
}

/// The lines of a manifest, as inputs.
fn listed(manifest: &Path) -> std::io::Result<Vec<PathBuf>> {
    let mut text = String::new();
    if target::is_stream(manifest) {
        std::io::stdin().lock().read_to_string(&mut text)?;
    } else {
        text = fs::read_to_string(manifest)?;
    }
    Ok(text.lines().filter(|line| !line.is_empty()).map(PathBuf::from).collect())
}
