//! The boxes of a JPEG 2000 file (ISO/IEC 15444-1, annex I), as far as the decoder does not tell them.

use super::plan::Density;

/// Metres in an inch.
const INCH: f64 = 0.0254;

/// Most components that an image can have: colours of four inks and how far they cover.
const MOST_COMPONENTS: u16 = 5;

/// What stands in a codestream before its components.
const COMPONENTS_AT: usize = 40;

/// What the boxes say.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Boxes {
    /// The resolution that the image was captured at, or else that it is to be shown at.
    pub density: Option<Density>,
    /// What is wrong with the codestream, in words.
    pub fault: Option<&'static str>,
}

/// Reads the boxes of a file, which may be a bare codestream.
pub(super) fn boxes(bytes: &[u8]) -> Boxes {
    if bytes.starts_with(&[0xFF, 0x4F]) {
        return Boxes { density: None, fault: fault(bytes) };
    }
    let mut found = Boxes { density: None, fault: Some("the JPEG 2000 has no image") };
    for (kind, content) in walk(bytes) {
        match kind {
            b"jp2c" => found.fault = fault(content),
            b"jp2h" => {
                let resolutions =
                    walk(content).filter(|(kind, _)| *kind == b"res ").flat_map(|(_, content)| walk(content));
                let mut resolutions: Vec<_> = resolutions.collect();
                resolutions.sort_by_key(|(kind, _)| *kind != b"resc");
                found.density = resolutions.into_iter().find_map(|(_, content)| density(content));
            }
            _ => {}
        }
    }
    found
}

/// The boxes in some bytes, each as its kind and content; the last may be cut short.
fn walk(mut bytes: &[u8]) -> impl Iterator<Item = (&[u8; 4], &[u8])> {
    std::iter::from_fn(move || {
        let (length, rest) = bytes.split_first_chunk::<4>()?;
        let (kind, mut rest) = rest.split_first_chunk::<4>()?;
        let length = match u32::from_be_bytes(*length) {
            0 => rest.len(),
            1 => {
                let (long, after) = rest.split_first_chunk::<8>()?;
                rest = after;
                usize::try_from(u64::from_be_bytes(*long)).ok()?.checked_sub(16)?
            }
            length => (length as usize).checked_sub(8)?,
        };
        let (content, after) = rest.split_at(length.min(rest.len()));
        bytes = after;
        Some((kind, content))
    })
}

/// What is wrong with a codestream. A decoder gives grey for what is missing, and room to any number of components.
fn fault(codestream: &[u8]) -> Option<&'static str> {
    let count = codestream.get(COMPONENTS_AT..COMPONENTS_AT + 2).map(|b| u16::from_be_bytes([b[0], b[1]]));
    let end = &codestream[codestream.len().saturating_sub(16)..];
    match count {
        Some(count) if count > MOST_COMPONENTS => Some("the JPEG 2000 has more components than colours"),
        Some(_) if end.windows(2).any(|w| w == b"\xFF\xD9") => None,
        _ => Some("the JPEG 2000 is cut short: it has no end marker"),
    }
}

/// A resolution in pixels for a metre, down and across, each as numerator, denominator and power of ten.
fn density(content: &[u8]) -> Option<Density> {
    let number = |at: usize| Some(f64::from(u16::from_be_bytes([*content.get(at)?, *content.get(at + 1)?])));
    let power = |at: usize| Some(f64::from(content.get(at)?.cast_signed()));
    let dpi = |at: usize, exponent: usize| {
        let value = number(at)? / number(at + 2)? * 10f64.powf(power(exponent)?) * INCH;
        Some((value * 1e3).round() / 1e3)
    };
    Density::inch(dpi(4, 9), dpi(0, 8))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn boxed(kind: &[u8; 4], content: &[u8]) -> Vec<u8> {
        [&(content.len() as u32 + 8).to_be_bytes()[..], kind, content].concat()
    }

    fn codestream(components: u16) -> Vec<u8> {
        let mut bytes = vec![0xFF, 0x4F, 0xFF, 0x51];
        bytes.resize(COMPONENTS_AT, 0);
        bytes.extend(components.to_be_bytes());
        bytes.extend([0, 0, 0xFF, 0xD9]);
        bytes
    }

    #[test]
    fn the_capture_resolution_comes_before_the_one_for_showing() {
        // 300 and 150 dots per inch are 11811 and 5906 pixels for a metre.
        let shown = boxed(b"resd", &[0, 72, 0, 1, 0, 72, 0, 1, 2, 2]);
        let caught = boxed(b"resc", &[0x17, 0x12, 0, 1, 0x2E, 0x23, 0, 1, 0, 0]);
        let head = boxed(b"jp2h", &boxed(b"res ", &[shown, caught].concat()));
        let file = [boxed(b"jP  ", b"\r\n\x87\n"), head, boxed(b"jp2c", &codestream(3))].concat();
        let found = boxes(&file);
        assert_eq!(found.fault, None);
        assert_eq!(found.density, Density::inch(Some(299.999), Some(150.012)));
        for end in 0..file.len() {
            assert!(boxes(&file[..end]).fault.is_some());
        }
    }

    #[test]
    fn only_images_of_colours_that_are_whole_pass() {
        assert_eq!(boxes(&codestream(4)).fault, None);
        assert!(boxes(&codestream(16384)).fault.unwrap().contains("components"));
        assert!(boxes(&codestream(3)[..44]).fault.unwrap().contains("cut short"));
    }
}
