//! The field as a NumPy archive.

use super::PolyVectorField;
use npyz::WriterBuilder;
use npyz::npz::NpzWriter;
use npyz::zip::write::FileOptions;
use npyz::zip::{CompressionMethod, DateTime};
use std::io::{self, Seek, Write};

/// Writes `c0` and `c2` (complex64) and `mask` (uint8, 1 where the field is defined), each
/// `[height, width]`, as an uncompressed `.npz`.
///
/// # Errors
/// Whatever the writer says.
pub fn write_npz(field: &PolyVectorField, out: impl Write + Seek) -> io::Result<()> {
    let (width, height) = field.size();
    let shape = [height as u64, width as u64];
    let mut archive = NpzWriter::new(out);
    for (name, coefficient) in [("c0", field.c0()), ("c2", field.c2())] {
        let mut array = archive.array(name, uncompressed())?.default_dtype().shape(&shape).begin_nd()?;
        array.extend(coefficient.data())?;
        array.finish()?;
    }
    let mut array = archive.array("mask", uncompressed())?.default_dtype().shape(&shape).begin_nd()?;
    array.extend(field.confidence().data().iter().map(|&c| u8::from(c > 0.0)))?;
    array.finish()
}

/// Coefficients hardly compress, and readers map stored arrays. Without the time of day, so that the same field gives the
/// same bytes.
fn uncompressed() -> FileOptions {
    let epoch = DateTime::default();
    FileOptions::default().compression_method(CompressionMethod::Stored).last_modified_time(epoch)
}
