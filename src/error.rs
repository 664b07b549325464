//! The one error type of the library.

use std::path::PathBuf;
use std::time::Duration;

/// Why an input could not be traced, one variant per failing stage.
///
/// Messages do not repeat their cause: print the chain through [`std::error::Error::source`].
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The input could not be read from disk or from standard input.
    #[error("{input}: cannot be read")]
    Read {
        /// The path as given, or `-`.
        input: String,
        /// What the operating system said.
        #[source]
        cause: std::io::Error,
    },
    /// The input was read and is not an image that can be decoded.
    #[error("{input}: {reason}")]
    Decode {
        /// The path as given, or `-`.
        input: String,
        /// What is wrong with the bytes, in one line.
        reason: String,
    },
    /// The image claims more pixels than the limit allows.
    #[error("{input}: {width} x {height} pixels are over the limit of {limit}")]
    TooLarge {
        /// The path as given, or `-`.
        input: String,
        /// Claimed width in pixels.
        width: u64,
        /// Claimed height in pixels.
        height: u64,
        /// The limit in pixels.
        limit: u64,
    },
    /// The input has several pages where one was to be read.
    #[error("{input}: it has {pages} pages (name one with --page)")]
    ManyPages {
        /// The path as given, or `-`.
        input: String,
        /// How many there are.
        pages: usize,
    },
    /// The input has fewer pages than the one to be read.
    #[error("{input}: there is no page {page}: it has {pages} {}", if *pages == 1 { "page" } else { "pages" })]
    NoSuchPage {
        /// The path as given, or `-`.
        input: String,
        /// The page that was asked for, from 1.
        page: usize,
        /// How many there are.
        pages: usize,
    },
    /// An SVG input has no visible shape.
    #[error("{input}: the SVG has nothing visible")]
    NothingVisible {
        /// The path as given, or `-`.
        input: String,
    },
    /// A stroke graph in JSON cannot be drawn.
    #[error("{input}: {place}: {reason}")]
    Graph {
        /// The path as given, or `-`.
        input: String,
        /// Where in the file: a line and column, or the item by its list and number.
        place: String,
        /// What is wrong there, in one line.
        reason: String,
    },
    /// A field does not fit the image that it is meant for.
    #[error("the field is {} x {} and the image {} x {} pixels", field.0, field.1, image.0, image.1)]
    FieldSize {
        /// Width and height of the field.
        field: (usize, usize),
        /// Width and height of the image.
        image: (usize, usize),
    },
    /// A map of ink does not fit the page that it is meant for.
    #[error("the ink is {} x {} and the page {} x {} pixels", ink.0, ink.1, page.0, page.1)]
    InkSize {
        /// Width and height of the map.
        ink: (usize, usize),
        /// Width and height of the page.
        page: (usize, usize),
    },
    /// An observer left a stage's result so that the next stage cannot use it.
    #[error("an observer broke the result of the {stage} stage: {reason}")]
    Broken {
        /// The stage whose result it was.
        stage: &'static str,
        /// What is wrong with it.
        reason: String,
    },
    /// A field estimator failed.
    #[error("the estimator {estimator} failed: {reason}")]
    Estimate {
        /// Name of the estimator.
        estimator: String,
        /// Its own words.
        reason: String,
    },
    /// Weights of the field network could not be read or written.
    #[error("{input}: {reason}")]
    Weights {
        /// The file, or what stands for it.
        input: String,
        /// What is wrong, in one line.
        reason: String,
    },
    /// Training cannot go on.
    #[error("training stopped: {reason}")]
    Train {
        /// Why, in one line.
        reason: String,
    },
    /// An observer refused a stage's result.
    #[error("vetoed after the {stage} stage: {reason}")]
    Vetoed {
        /// The stage whose result was refused.
        stage: &'static str,
        /// The observer's reason.
        reason: String,
    },
    /// A part of the caller's own, such as an observer or an estimator, failed.
    #[error("{part} failed")]
    Caller {
        /// What failed.
        part: String,
        /// Its own error.
        #[source]
        cause: Box<dyn std::error::Error + Send + Sync>,
    },
    /// An option is out of its range.
    #[error("{option}: {reason}")]
    Option {
        /// Name of the option as on the command line, without dashes.
        option: &'static str,
        /// The range that it must keep to.
        reason: String,
    },
    /// The inputs and the folder of a batch do not make a plan.
    #[error("{reason}")]
    Plan {
        /// What is wrong, in one line.
        reason: String,
    },
    /// A folder of a batch could not be listed.
    #[error("{}: cannot be listed", path.display())]
    List {
        /// The folder, or what in it could not be reached.
        path: PathBuf,
        /// What the operating system said.
        #[source]
        cause: std::io::Error,
    },
    /// The work was stopped from outside.
    #[error("interrupted")]
    Cancelled,
    /// The work took longer than it was allowed to.
    #[error("given up after {} seconds", limit.as_secs_f64())]
    TimedOut {
        /// The time that it was allowed.
        limit: Duration,
    },
    /// The work ended in a fault of the program or of the caller's own part in it.
    #[error("a fault in the program: {reason}")]
    Panicked {
        /// What the fault said of itself, in one line.
        reason: String,
    },
    /// There is a file where a result was to be written, and it is no result of this program, or was changed since.
    #[error("{}: exists and is not, or no longer, what this program wrote", path.display())]
    Exists {
        /// The file.
        path: PathBuf,
    },
    /// A result could not be written.
    #[error("{}: cannot be written", path.display())]
    Write {
        /// The file that was to be written.
        path: PathBuf,
        /// What the operating system said.
        #[source]
        cause: std::io::Error,
    },
}

impl Error {
    /// The error of a part of the caller's own, which keeps its cause.
    ///
    /// ```
    /// use fieldtrace::Error;
    /// use std::error::Error as _;
    ///
    /// let refused = std::fs::read("no such file").map_err(|cause| Error::caller("my estimator", cause)).unwrap_err();
    /// assert_eq!(refused.to_string(), "my estimator failed");
    /// assert!(refused.source().is_some_and(|cause| cause.is::<std::io::Error>()));
    /// ```
    pub fn caller(part: impl Into<String>, cause: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> Self {
        Self::Caller { part: part.into(), cause: cause.into() }
    }
}

/// Result of the library's fallible functions.
pub type Result<T> = std::result::Result<T, Error>;
