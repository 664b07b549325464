//! The field as a NumPy archive.

use super::PolyVectorField;
use std::io::{self, Seek, Write};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

/// Writes `c0` and `c2` (complex64) and `mask` (uint8, 1 where the field is defined), each
/// `[height, width]`, as an uncompressed `.npz`.
///
/// # Errors
/// Whatever the writer says.
pub fn write_npz(field: &PolyVectorField, out: impl Write + Seek) -> io::Result<()> {
    let mut archive = ZipWriter::new(out);
    for (name, coefficient) in [("c0", field.c0()), ("c2", field.c2())] {
        let values =
            coefficient.data().iter().flat_map(|z| [z.re, z.im]).flat_map(f32::to_le_bytes).collect::<Vec<_>>();
        array(&mut archive, name, "<c8", field.size(), &values)?;
    }
    let mask = field.confidence().data().iter().map(|&c| u8::from(c > 0.0)).collect::<Vec<_>>();
    array(&mut archive, "mask", "|u1", field.size(), &mask)?;
    archive.finish()?;
    Ok(())
}

/// One array in NumPy's format 1.0: magic, version, the length of the header, the header as a Python literal, the values by
/// rows.
fn array<W: Write + Seek>(
    archive: &mut ZipWriter<W>,
    name: &str,
    dtype: &str,
    (width, height): (usize, usize),
    values: &[u8],
) -> io::Result<()> {
    // Readers map the values, which start at a multiple of 64 bytes; ten bytes stand before the header.
    let header = format!("{{'descr': '{dtype}', 'fortran_order': False, 'shape': ({height}, {width}), }}");
    let length = (header.len() + 11).next_multiple_of(64) - 10;
    archive.start_file(format!("{name}.npy"), stored())?;
    archive.write_all(b"\x93NUMPY\x01\x00")?;
    archive.write_all(&(length as u16).to_le_bytes())?;
    archive.write_all(format!("{header:<0$}\n", length - 1).as_bytes())?;
    archive.write_all(values)
}

/// Coefficients hardly compress, and readers map stored arrays. Without the time of day, so that the same field gives the
/// same bytes.
fn stored() -> SimpleFileOptions {
    SimpleFileOptions::default().compression_method(CompressionMethod::Stored).last_modified_time(DateTime::default())
}
