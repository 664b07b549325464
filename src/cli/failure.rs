//! Why the program ends without a result.

use crate::Error;
use std::fmt;

/// An end without a result, with its one-line message.
#[derive(Debug)]
pub(crate) enum Failure {
    /// The command line asks for something that cannot be done: exit code 2.
    Usage(String),
    /// A file could not be read, traced or written: exit code 1.
    File(String),
    /// A batch was interrupted: exit code 130, as shells have it.
    Interrupted(String),
}

impl Failure {
    /// The program's exit code.
    pub(crate) fn code(&self) -> u8 {
        match self {
            Self::Usage(_) => 2,
            Self::File(_) => 1,
            Self::Interrupted(_) => 130,
        }
    }

    /// What went wrong with an input, as `FILE: reason: cause`.
    pub(crate) fn of(input: &str, error: &Error) -> Self {
        match error {
            Error::Option { .. } => return Self::Usage(format!("--{}", one_line(error))),
            Error::Plan { .. } => return Self::Usage(one_line(error)),
            _ => {}
        }
        let names_its_file = matches!(
            error,
            Error::Read { .. }
                | Error::Decode { .. }
                | Error::TooLarge { .. }
                | Error::ManyPages { .. }
                | Error::NoSuchPage { .. }
                | Error::NothingVisible { .. }
                | Error::Weights { .. }
                | Error::List { .. }
                | Error::Graph { .. }
                | Error::Write { .. }
                | Error::Exists { .. }
        );
        let text = match error {
            Error::TooLarge { .. } => format!("{error} (raise it with --max-pixels)"),
            Error::Exists { .. } => format!("{error} (--force overwrites it)"),
            _ => one_line(error),
        };
        Self::File(if names_its_file { text } else { format!("{input}: {text}") })
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (Self::Usage(text) | Self::File(text) | Self::Interrupted(text)) = self;
        f.write_str(text)
    }
}

/// An error and its causes in one line.
pub(crate) fn one_line(error: &dyn std::error::Error) -> String {
    let mut text = error.to_string();
    let mut source = error.source();
    while let Some(cause) = source {
        text = format!("{text}: {cause}");
        source = cause.source();
    }
    text.lines().map(str::trim).filter(|line| !line.is_empty()).collect::<Vec<_>>().join(" ")
}
