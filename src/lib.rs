//! Turns raster line drawings into few, smooth, editable centreline strokes with their true widths.
//!
//! ```
//! let image = image::open("samples/kettle.png")?;
//! let drawing = fieldtrace::trace(&image, &fieldtrace::Options::default())?;
//! println!("{}", fieldtrace::write::to_svg(&drawing, &Default::default()));
//! # assert!(drawing.strokes.iter().all(|stroke| stroke.width > 2.0));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A [`Vectorizer`] traces many images under one set of [`Options`], can be stopped from outside and tells how far it is.
//! [`load`] reads files as the command `trace` does, and [`mod@write`] writes them; [`batch`] traces many inputs in one go. A
//! [`hooks::Observer`] sees the result of each stage and may change or refuse it; an [`ink::InkEstimator`] and a
//! [`estimate::FieldEstimator`] stand in for the networks.
//!
//! The same input, options and version give the same result on any number of threads.
//!
//! # The guide
//!
//! - [Options](guide::options): every option of the command
//! - [Formats](guide::formats): what each format of an output holds
//! - [Batch](guide::batch): many drawings in one go
//! - [Library](guide::library): observers, estimators of ink and field, stopping, progress, Cargo features
//! - [Quality](guide::quality): how good traces are, and where they fail
//! - [Speed](guide::speed): how long a trace takes, and how much memory
//! - [Training](guide::training): the networks, and how they are trained again
//! - [How it works](guide::how_it_works): the field, the stages and what holds after each, the order of the modules

#[cfg(feature = "files")]
pub mod batch;
pub mod cancel;
pub mod clean;
#[cfg(feature = "cli")]
pub mod cli;
pub mod drawing;
pub mod error;
pub mod estimate;
pub mod field;
pub mod fit;
pub mod graph;
#[cfg(feature = "train")]
pub mod ground_truth;
#[cfg(any(doc, doctest))]
pub mod guide;
pub mod hooks;
pub mod ink;
pub mod inspect;
pub mod load;
#[cfg(feature = "svg-input")]
pub mod metrics;
mod moments;
pub mod options;
pub mod pipeline;
pub mod place;
mod profile;
pub mod raster;
#[cfg(feature = "svg-input")]
pub mod render;
pub mod streamline;
#[cfg(feature = "train")]
pub mod synth;
#[cfg(feature = "train")]
pub mod train;
pub mod unet;
pub mod write;

pub use drawing::{Centreline, Color, Drawing, Fill, Segment, Stroke};
pub use error::{Error, Result};
pub use load::Scan;
pub use options::Options;
pub use pipeline::{Vectorizer, trace};

// The crates whose types are in signatures.
pub use {image, kurbo, num_complex, petgraph};

/// The code of the README is compiled and run.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
