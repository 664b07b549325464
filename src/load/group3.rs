//! CCITT group 3 coding (ITU-T T.4, one-dimensional), as fax machines and old scanners write it into TIFF.

use fax::Color;
use fax::decoder::{decode_g3, pels};
use image::{GrayImage, Luma};

/// Six ends of line, which end a page. Writers of TIFF leave them out, and the decoder needs one after the last row.
const END_OF_PAGE: [u8; 9] = [0x00, 0x10, 0x01, 0x00, 0x10, 0x01, 0x00, 0x10, 0x01];

/// The coded page.
pub(super) struct Strips<'a> {
    /// The data of each strip, most significant bit first.
    pub data: Vec<&'a [u8]>,
    /// Rows of each strip but the last, which may have fewer.
    pub rows: u32,
    /// Whether rows refer to the ones above them.
    pub two_dimensional: bool,
    /// Whether white runs are paper; otherwise the image is seen as its negative.
    pub white_is_zero: bool,
}

/// Decodes a page of `width x height` pixels.
///
/// # Errors
/// The reason in words where rows are missing or the coding is two-dimensional.
pub(super) fn decode(strips: &Strips, width: u32, height: u32) -> Result<GrayImage, String> {
    if strips.two_dimensional {
        return Err("two-dimensional CCITT group 3 compression is not supported".into());
    }
    let line = u16::try_from(width).map_err(|_| "a CCITT group 3 row is too long")?;
    let (paper, ink) = if strips.white_is_zero { (255, 0) } else { (0, 255) };
    let mut image = GrayImage::from_pixel(width, height, Luma([paper]));
    let mut next = 0u32;
    for data in &strips.data {
        let end = next.saturating_add(strips.rows).min(height);
        let bytes = data.iter().copied().chain(END_OF_PAGE);
        decode_g3(bytes, |row| {
            if next < end && !row.is_empty() {
                for (x, _) in pels(row, line).enumerate().filter(|(_, color)| *color == Color::Black) {
                    image.put_pixel(x as u32, next, Luma([ink]));
                }
                next += 1;
            }
        });
        if next < end {
            return Err(format!("the CCITT group 3 data has {next} of {height} rows"));
        }
    }
    if next < height { Err(format!("the CCITT group 3 data has {next} of {height} rows")) } else { Ok(image) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_that_are_missing_are_an_error() {
        let strips = Strips { data: vec![&[]], rows: 4, two_dimensional: false, white_is_zero: true };
        assert_eq!(decode(&strips, 8, 4).unwrap_err(), "the CCITT group 3 data has 0 of 4 rows");
    }
}
