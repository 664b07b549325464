//! `trace IN... -o DIR`: many drawings to SVG.

use super::args::TraceArgs;
use super::failure::Failure;
use super::interrupt;
use super::report::Report;
use super::source;
use super::target;
use crate::Error;
use crate::batch::{Batch, Destination, FileTracer, Job, Plan, is_pattern};
use crate::write::remove_abandoned;
use std::collections::BTreeSet;
use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};

/// Whether the arguments of `trace` ask for a batch.
pub(crate) fn is_meant(args: &TraceArgs) -> bool {
    let names_folder = |output: &Path| {
        output.as_os_str().as_encoded_bytes().ends_with(b"/") || (output.is_dir() && !target::is_file_name(output))
    };
    match args.inputs.as_slice() {
        _ if args.batch.names_several() || args.batch.is_about_running() => true,
        [input] => input.is_dir() || is_pattern(input) || args.output.as_deref().is_some_and(names_folder),
        _ => true,
    }
}

/// Traces everything that the arguments name, and tells what became of each.
pub(crate) fn run(args: &TraceArgs) -> Result<(), Failure> {
    let failed = |e: Error| Failure::of("batch", &e);
    refuse_for_several(args)?;
    let named = args.output.as_deref().filter(|output| target::names_file(output));
    let format = args.out.format(named)?;
    let plan = plan(args, format.name())?;
    let vectorizer = source::vectorizer(&args.source, &args.clean, Some((&args.fit, format))).map_err(failed)?;
    let (load, write) = (args.load.options(), args.out.options());
    let tracer = FileTracer { load, format, write, force: args.out.force, ..FileTracer::new(vectorizer) };

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

/// What cannot be done for several drawings.
fn refuse_for_several(args: &TraceArgs) -> Result<(), Failure> {
    let usage = |text: &str| Err(Failure::Usage(text.into()));
    if args.out.graph.is_some() {
        return usage("--graph names one file, not one for each drawing of a batch");
    }
    if args.out.debug_dir.is_some() {
        return usage("--debug-dir shows one drawing, not a batch");
    }
    if args.inputs.iter().any(|input| target::is_stream(input)) {
        return usage("-: standard input is one drawing, not a part of a batch");
    }
    match args.output.as_deref() {
        Some(output) if target::is_stream(output) => usage("-: a batch is written to files, not to standard output"),
        _ => Ok(()),
    }
}

/// The jobs that the inputs, the manifest and the shard ask for.
fn plan(args: &TraceArgs, extension: &str) -> Result<Plan, Failure> {
    let failed = |e: Error| Failure::of("batch", &e);
    let mut inputs = args.inputs.clone();
    if let Some(manifest) = &args.batch.manifest {
        let read = listed(manifest);
        inputs.extend(read.map_err(|cause| failed(Error::Read { input: target::name(manifest), cause }))?);
    }
    let plan = match (&inputs[..], &args.output) {
        ([input], Some(output)) if target::names_file(output) && is_one(args, input) => {
            target::keep_input(input, output)?;
            Plan { jobs: vec![Job { input: input.clone(), output: output.clone() }], ..Plan::default() }
        }
        (_, Some(output)) if target::names_file(output) => {
            let name = target::name(output);
            return Err(Failure::Usage(format!("{name}: a batch is written to a folder, not to a file")));
        }
        (_, folder) => {
            let to = Destination { folder: folder.clone(), extension: extension.into() };
            Plan::new(&inputs, &to, args.batch.recursive).map_err(failed)?
        }
    };
    if plan.jobs.is_empty() && plan.unreadable.is_empty() {
        return Err(Failure::Usage("there is nothing to trace: no image was found".into()));
    }
    Ok(match args.batch.shard {
        Some(share) => plan.share(share),
        None => plan,
    })
}

/// Whether an input is one file that was named as such.
fn is_one(args: &TraceArgs, input: &Path) -> bool {
    !args.batch.names_several() && !input.is_dir() && !is_pattern(input)
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
