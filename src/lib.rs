//! Turns raster line drawings into few, smooth, editable centreline strokes.
//!
//! ```
//! use fieldtrace::load::{LoadOptions, load};
//! use fieldtrace::options::Options;
//! use fieldtrace::pipeline::Vectorizer;
//!
//! let scan = load("samples/kettle.png".as_ref(), &LoadOptions::default())?.scan;
//! let drawing = Vectorizer::new(Options::default())?.trace(&scan)?;
//! assert!(drawing.strokes.iter().all(|stroke| stroke.width > 2.0));
//! # Ok::<(), fieldtrace::Error>(())
//! ```
//!
//! # The field
//!
//! At every ink pixel a *2-PolyVector field* holds two directions `u`, `v` without order or sign, by the coefficients
//! of `f(z) = (z^2 - u^2)(z^2 - v^2) = z^4 + c2 z^2 + c0`. On a line they are its tangent and its normal; where two
//! lines share a pixel they are both tangents. That is what lets a line be followed straight through a crossing, where
//! the ink alone says nothing.
//!
//! - Taktasheva, Matveev, Artemov, Burnaev: *Learning to Approximate Directional Fields Defined over 2D Planes*, 2019.
//! - Bessmeltsev, Solomon: *Vectorization of Line Drawings via PolyVector Fields*, 2019.
//!
//! # The stages, and what holds after each
//!
//! | stage | result | what holds |
//! |---|---|---|
//! | [`load`] | [`load::Scan`] | upright, alpha over white, at least one pixel and at most the limit, resolution kept |
//! | [`ink`] | [`load::Scan`] | blank where there is no ink of the drawing, or as it was where ink needs no telling |
//! | [`clean`] | [`clean::LineImage`] | dark on light, evenly lit, no specks; anti-aliased edges kept; the line width is known and no region much wider than it is left in the mask, and long even ones are an image of broad lines; on a page in colour, every ink is measured against its own strength |
//! | [`estimate`] | [`field::PolyVectorField`] | defined on the mask; values that are not finite count as undefined |
//! | decode | [`field::FrameField`] | unit directions; which root is `u` means nothing from one pixel to the next |
//! | [`streamline`] | [`streamline::Streamline`]s | points half a pixel apart in the middle of the ink; no ink is covered twice in one direction |
//! | [`graph`] | [`graph::StrokeGraph`] | every end is free, at a gap, a corner, a tee or a branch, and every edge belongs to one stroke of one colour; it holds all that fitting takes, and can be written and read as JSON |
//! | [`fit`] | [`drawing::Drawing`] | pieces join exactly, smoothly except at corners; lines, arcs and circles where they serve |
//! | [`mod@write`] | SVG text | rounded, ordered for a short way between strokes, without a date |
//!
//! Positions of the stages from `clean` to `graph` are in pixels of the [`clean::LineImage`], which may be of another
//! size than the scan; the drawing that comes out of [`pipeline::Vectorizer`] is in pixels of the scan. Pixels have x
//! to the right and y down, and the centre of the first is (0.5, 0.5).
//!
//! The same input, options and version give the same result on any number of threads.
//!
//! [`batch`] traces many inputs in one go, and a [`cancel::Cancel`] stops a trace between and inside its stages.
//!
//! # Hooks
//!
//! A [`hooks::Observer`] sees the result of each stage and may change or refuse it. An [`ink::InkEstimator`] tells ink from
//! everything else on a page, and [`pipeline::Vectorizer::trace_with_ink`] takes a finished map of it. A
//! [`estimate::FieldEstimator`] is a source of fields of the caller's own, and [`pipeline::Vectorizer::trace_with_field`]
//! takes a finished field:
//!
//! ```
//! use fieldtrace::field::PolyVectorField;
//! use fieldtrace::load::Scan;
//! use fieldtrace::options::Options;
//! use fieldtrace::pipeline::Vectorizer;
//! use fieldtrace::raster::Raster;
//! use kurbo::Vec2;
//!
//! // A horizontal bar, four pixels wide, and a field that knows its direction.
//! let ink = |x: usize, y: usize| (8..56).contains(&x) && (14..18).contains(&y);
//! let gray = Raster::from_fn(64, 32, |x, y| if ink(x, y) { 0.0 } else { 1.0 });
//! let field = PolyVectorField::from_directions(64, 32, |x, y| {
//!     ink(x, y).then_some((Vec2::new(1.0, 0.0), Vec2::new(0.0, 1.0)))
//! });
//! let scan = Scan { gray, rgb: None, dpi: None };
//! let drawing = Vectorizer::new(Options::default())?.trace_with_field(&scan, &field, &mut ())?;
//! assert_eq!(drawing.strokes.len(), 1);
//! let centreline = &drawing.strokes[0].centreline;
//! assert!((centreline.start().y - 16.0).abs() < 0.1 && (centreline.end().y - 16.0).abs() < 0.1);
//! # Ok::<(), fieldtrace::Error>(())
//! ```

pub mod batch;
pub mod cancel;
pub mod clean;
pub mod drawing;
pub mod error;
pub mod estimate;
pub mod field;
pub mod fit;
pub mod graph;
#[cfg(feature = "train")]
pub mod ground_truth;
pub mod hooks;
pub mod ink;
pub mod inspect;
pub mod load;
pub mod metrics;
mod moments;
pub mod options;
pub mod pipeline;
mod profile;
pub mod raster;
pub mod render;
pub mod streamline;
#[cfg(feature = "train")]
pub mod synth;
#[cfg(feature = "train")]
pub mod train;
pub mod unet;
pub mod write;

pub use error::{Error, Result};

/// The code of the README is compiled and run.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
