//! What is said of the command itself.

use super::args::Cli;
use super::failure::Failure;
use super::target;
use clap::CommandFactory;
use clap_complete::Shell;
use std::io::Write;
use std::path::PathBuf;

/// At least so like is a word to the subcommand that was meant, 0 to 1.
const LIKE: f64 = 0.75;

/// Writes what a shell needs to complete the command.
pub(crate) fn completions(shell: Shell) -> Result<(), Failure> {
    let mut text = Vec::new();
    clap_complete::generate(shell, &mut Cli::command(), "trace", &mut text);
    say(&text)
}

/// Writes the manual page.
pub(crate) fn man() -> Result<(), Failure> {
    let mut text = Vec::new();
    let page = clap_mangen::Man::new(Cli::command());
    page.render(&mut text).map_err(|e| Failure::File(format!("the manual cannot be written: {e}")))?;
    say(&text)
}

fn say(text: &[u8]) -> Result<(), Failure> {
    match std::io::stdout().lock().write_all(text) {
        Err(e) if e.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(Failure::File(format!("-: cannot be written: {e}")))
        }
        _ => Ok(()),
    }
}

/// Refuses a first word that is no file and nearly a subcommand.
pub(crate) fn refuse_misspelt(inputs: &[PathBuf]) -> Result<(), Failure> {
    let Some(first) = inputs.first().filter(|path| !path.exists() && !target::is_stream(path)) else { return Ok(()) };
    let word = target::name(first);
    if word.contains(['.', '/', '\\', '*']) {
        return Ok(());
    }
    let command = Cli::command();
    let names = command.get_subcommands().filter(|c| !c.is_hide_set()).map(clap::Command::get_name);
    let likeness = |name: &&str| strsim::jaro_winkler(name, &word);
    match names.max_by(|a, b| likeness(a).total_cmp(&likeness(b))).filter(|name| likeness(name) >= LIKE) {
        Some(name) => Err(Failure::Usage(format!("{word}: no such file; the subcommand is called {name}"))),
        None => Ok(()),
    }
}
