//! The marker structure of a JPEG file (ITU-T T.81, annex B), as far as the decoder does not tell it.

use super::plan::Density;

/// What the markers say.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Markers {
    /// What the JFIF header says of the density.
    pub density: Option<Density>,
    /// Whether the end marker was reached: a decoder pads a file that is cut short with grey.
    pub complete: bool,
}

/// Walks the markers from the start of the file to the end of the image.
pub(super) fn markers(bytes: &[u8]) -> Markers {
    const END_OF_IMAGE: u8 = 0xD9;
    const APP0: u8 = 0xE0;
    let mut found = Markers::default();
    let mut rest = bytes.get(2..).unwrap_or_default();
    while let Some((marker, after)) = next_marker(rest) {
        match marker {
            END_OF_IMAGE => {
                found.complete = true;
                break;
            }
            0x01 | 0xD0..=0xD8 => rest = after,
            _ => {
                let Some((payload, after)) = segment(after) else { break };
                if marker == APP0 {
                    found.density = found.density.or_else(|| jfif_density(payload));
                }
                rest = after;
            }
        }
    }
    found
}

/// The next marker's code and what follows it; stuffed zeros and fill bytes are passed over, as is entropy-coded data.
fn next_marker(bytes: &[u8]) -> Option<(u8, &[u8])> {
    let mut at = 0;
    loop {
        at += bytes.get(at..)?.iter().position(|&b| b == 0xFF)?;
        match *bytes.get(at + 1)? {
            0x00 => at += 2,
            0xFF => at += 1,
            marker => return Some((marker, &bytes[at + 2..])),
        }
    }
}

/// A segment's payload, by the length that stands before it, and what follows.
fn segment(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let length = usize::from(u16::from_be_bytes([*bytes.first()?, *bytes.get(1)?]));
    (length >= 2 && length <= bytes.len()).then(|| (&bytes[2..length], &bytes[length..]))
}

/// Density of a JFIF `APP0` payload: identifier, version (2 bytes), unit, then X and Y density.
fn jfif_density(payload: &[u8]) -> Option<Density> {
    let fields = payload.strip_prefix(b"JFIF\0")?;
    let density = |at: usize| Some(f64::from(u16::from_be_bytes([*fields.get(at)?, *fields.get(at + 1)?])));
    let (x, y) = (density(3)?, density(5)?);
    match fields.get(2)? {
        0 => Density::shape(x, y),
        1 => Density::inch(Some(x), Some(y)),
        2 => Density::inch(Some(x * 2.54), Some(y * 2.54)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn jfif(unit: u8, density: u16) -> Vec<u8> {
        let mut bytes = vec![0xFF, 0xD8, 0xFF, 0xE0, 0, 16];
        bytes.extend(b"JFIF\0\x01\x02");
        bytes.push(unit);
        bytes.extend([density, 2 * density].map(u16::to_be_bytes).concat());
        bytes.extend([0, 0]);
        bytes
    }

    #[test]
    fn the_density_is_read_in_its_unit() {
        assert_eq!(markers(&jfif(1, 300)).density, Density::inch(Some(300.0), Some(600.0)));
        assert_eq!(markers(&jfif(2, 100)).density, Density::inch(Some(254.0), Some(508.0)));
        assert_eq!(markers(&jfif(0, 1)).density, Density::shape(1.0, 2.0));
        assert_eq!(markers(&jfif(7, 1)).density, None);
    }

    #[test]
    fn only_an_end_marker_outside_segments_completes() {
        let mut bytes = jfif(1, 72);
        assert!(!markers(&bytes).complete);
        bytes.extend([0xFF, 0xE1, 0, 4, 0xFF, 0xD9]);
        assert!(!markers(&bytes).complete, "an end marker inside a segment belongs to a thumbnail");
        bytes.extend([0xFF, 0xDA, 0, 2, 1, 0xFF, 0x00, 0xD9, 0xFF, 0xD3, 7]);
        assert!(!markers(&bytes).complete);
        bytes.extend([0xFF, 0xFF, 0xD9]);
        assert!(markers(&bytes).complete);
    }

    #[test]
    fn any_prefix_is_walked_to_its_end() {
        let bytes = jfif(1, 72);
        for end in 0..bytes.len() {
            assert!(!markers(&bytes[..end]).complete);
        }
    }
}
