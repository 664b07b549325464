//! From a drawing to bytes on disk.
//!
//! [`formats`] are the kinds of files that a [`Document`] can be written as, one file here for each; [`encode`] gives its bytes
//! and [`to_svg`] SVG text. [`pen_order`] is the order of strokes in all of them. [`graph_json`] also reads the stroke graph
//! back. [`write_file`] puts bytes in place whole or not at all, and [`remove_abandoned`] clears away what a killed run left
//! of that.

mod csv;
mod curves;
mod document;
mod dxf;
#[cfg(feature = "files")]
mod file;
#[cfg(feature = "geojson")]
mod geo_json;
pub mod graph_json;
mod layers;
mod number;
mod order;
mod origin;
mod path_data;
#[cfg(feature = "pdf")]
mod pdf;
mod svg;

pub use document::{Curves, Document, Shapes, Units, WriteOptions};
#[cfg(feature = "files")]
pub use file::{remove_abandoned, write_file, write_png};
pub use order::{pen_order, pen_up_length};
#[cfg(feature = "files")]
pub use origin::Origin;
pub use origin::is_untouched_output;
pub use svg::to_svg;

pub(crate) use number::Rounding;

use crate::error::{Error, Result};

/// A kind of file that drawings are written as.
pub trait Format: Sync {
    /// Its name, which is the extension of its files.
    fn name(&self) -> &'static str;

    /// The bytes of a drawing; the same drawing gives the same.
    ///
    /// # Errors
    /// [`Error::Option`] where the format cannot do what is asked for.
    fn encode(&self, document: &Document, options: &WriteOptions) -> Result<Vec<u8>>;

    /// Other extensions that its files have.
    fn other_extensions(&self) -> &'static [&'static str] {
        &[]
    }

    /// Whether widths along a stroke ([`crate::Stroke::profile`]) are kept; elsewhere filled outlines stand for them.
    fn has_profiles(&self) -> bool {
        false
    }

    /// Whether coordinates are those of the world where a scan knows its place.
    fn is_on_earth(&self) -> bool {
        false
    }

    /// The last thing that is done to the bytes.
    fn pack(&self, bytes: Vec<u8>) -> Vec<u8> {
        bytes
    }
}

/// All formats.
pub fn formats() -> &'static [&'static dyn Format] {
    &[
        &svg::Svg,
        &svg::Svgz,
        &dxf::Dxf,
        #[cfg(feature = "pdf")]
        &pdf::PdfPage,
        #[cfg(feature = "geojson")]
        &geo_json::GeoJson,
        &csv::Csv,
        &graph_json::GraphJson,
    ]
}

/// The format of a name or an extension, in any case.
pub fn format_named(name: &str) -> Option<&'static dyn Format> {
    let name = name.to_lowercase();
    formats().iter().copied().find(|f| f.name() == name || f.other_extensions().contains(&&*name))
}

/// The bytes of a document in a format.
///
/// # Errors
/// [`Error::Option`] where an option is out of its range or the format cannot do what is asked for.
pub fn encode(format: &dyn Format, document: &Document, options: &WriteOptions) -> Result<Vec<u8>> {
    options.validate()?;
    Ok(format.pack(origin::stamped(format.encode(document, options)?)))
}

/// The error of a document that lacks what a format is about.
fn lacking(format: &'static str, what: &str) -> Error {
    Error::Option { option: "format", reason: format!("{format} needs {what}") }
}
