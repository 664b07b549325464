//! What an output says of its own making, and how a program tells its own outputs from other files.
//!
//! Outputs hold, where their format has a place for it, a JSON object on one line: the program and its version, the hash of
//! the input, the options, and a checksum over the whole file with the checksum's own digits as zeros. A file whose
//! checksum is right was written by this program and not changed since.

use super::csv::HEADER;
#[cfg(feature = "files")]
use super::document::PROGRAM;
use crc32fast::hash;
use flate2::read::GzDecoder;
use std::borrow::Cow;
use std::io::Read;
use std::ops::Range;

/// What comes before the checksum's digits.
const CHECK: &[u8] = b"\"check\":\"";
/// The digits of an output whose checksum is not known yet.
const UNKNOWN: &[u8; 8] = b"00000000";
/// Most bytes that a compressed output is unpacked to.
const LARGEST: u64 = 256 << 20;

/// What an output is made from, and how.
#[cfg(feature = "files")]
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Origin {
    /// Name and version of the program.
    pub program: String,
    /// The hash of the input's bytes, `sha256:` and its digits.
    pub input: String,
    /// The page of an input of several, counted from 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub page: Option<usize>,
    /// The options that the drawing depends on.
    pub options: serde_json::Value,
}

#[cfg(feature = "files")]
impl Origin {
    /// The origin of a drawing that was traced from the bytes of an input.
    pub fn new(input: &[u8], page: Option<usize>, options: serde_json::Value) -> Self {
        use sha2::Digest;
        let digest = sha2::Sha256::digest(input);
        let digits: String = digest.iter().map(|byte| format!("{byte:02x}")).collect();
        Self { program: PROGRAM.into(), input: format!("sha256:{digits}"), page, options }
    }

    /// Whether an output says that it was made by this version of the program under the same options.
    pub fn is_of(&self, output: &[u8]) -> bool {
        let output = unpacked(output);
        let says = |text: &str| output.windows(text.len()).any(|window| window == text.as_bytes());
        says(&format!("\"program\":\"{}\"", self.program)) && says(&format!("\"options\":{}", self.options))
    }

    /// The text that the member `origin` of [`super::WriteOptions`] takes.
    pub fn to_text(&self) -> String {
        serde_json::to_string(self).expect("plain data is always JSON")
    }
}

/// A text of an origin with room for the checksum.
pub(super) fn with_check(origin: &str) -> String {
    let digits = String::from_utf8_lossy(UNKNOWN);
    let body = origin.trim_end().strip_suffix('}').unwrap_or(origin);
    format!("{body},\"check\":\"{digits}\"}}")
}

/// The bytes with their checksum in its place, where they have one.
pub(super) fn stamped(mut bytes: Vec<u8>) -> Vec<u8> {
    let place = check_place(&bytes).filter(|place| bytes[place.clone()] == *UNKNOWN);
    if let Some(place) = place {
        let digits = format!("{:08x}", hash(&bytes));
        bytes[place].copy_from_slice(digits.as_bytes());
    }
    bytes
}

/// Where the checksum's digits are.
fn check_place(bytes: &[u8]) -> Option<Range<usize>> {
    let start = bytes.windows(CHECK.len()).position(|window| window == CHECK)? + CHECK.len();
    let end = start + UNKNOWN.len();
    (bytes.len() > end && bytes[end] == b'"').then_some(start..end)
}

/// Whether a file was written by this program and not changed since. A CSV, which has no place for a checksum, is told by its
/// first line.
pub fn is_untouched_output(bytes: &[u8]) -> bool {
    let bytes = unpacked(bytes);
    let Some(place) = check_place(&bytes) else {
        return bytes.strip_prefix(HEADER.as_bytes()).is_some_and(|rest| rest.starts_with(b"\n"));
    };
    let mut blank = bytes.to_vec();
    blank[place.clone()].copy_from_slice(UNKNOWN);
    format!("{:08x}", hash(&blank)).as_bytes() == &bytes[place]
}

fn unpacked(bytes: &[u8]) -> Cow<'_, [u8]> {
    let mut text = Vec::new();
    match GzDecoder::new(bytes).take(LARGEST).read_to_end(&mut text) {
        Ok(_) if bytes.starts_with(&[0x1F, 0x8B]) => Cow::Owned(text),
        _ => Cow::Borrowed(bytes),
    }
}
