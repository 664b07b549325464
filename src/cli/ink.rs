//! `trace ink IN -o OUT`: what of a page is ink, alone.

use crate::Error;
use crate::cli::args::InkArgs;
use crate::cli::failure::Failure;
use crate::cli::target;
use crate::cli::watch::Stages;
use crate::ink::{InkEstimator, LearnedInk};
use crate::inspect::coverage_picture;
use crate::load::load;
use crate::write::write_png;

/// Reads one page and writes its ink.
pub(crate) fn run(args: &InkArgs) -> Result<(), Failure> {
    let name = target::name(&args.input);
    let failed = |e: Error| Failure::of(&name, &e);
    if !target::is_stream(&args.output) && target::extension(&args.output) != "png" {
        return Err(Failure::Usage(format!("{}: ink is written as .png", target::name(&args.output))));
    }
    target::keep_input(&args.input, &args.output)?;
    target::keep_file(&args.output, args.force)?;
    let mut stages = Stages::start(args.talk.verbose);
    let scan = load(&args.input, &args.load.options()).map_err(failed)?.scan;
    stages.done("load", || format!("{} x {} pixels", scan.gray.width(), scan.gray.height()));
    let coverage = LearnedInk::default().estimate(&scan).map_err(failed)?;
    let covered = coverage.data().iter().filter(|&&c| c > 0.5).count();
    stages.done("ink", || format!("{covered} pixels"));
    write_png(&args.output, &coverage_picture(&coverage)).map_err(failed)?;
    stages.done("write", || format!("a picture to {}", target::name(&args.output)));
    if covered == 0 && !args.talk.quiet {
        eprintln!("trace: {name}: warning: no ink was found");
    }
    Ok(())
}
