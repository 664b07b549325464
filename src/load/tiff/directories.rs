//! The directories of a TIFF, one for each image in it, and a view of the file that begins with any of them.

use std::collections::HashSet;
use std::io::{Read, Result, Seek, SeekFrom};

/// Tag of the kind of image that a directory describes.
const NEW_SUBFILE_TYPE: u64 = 254;

/// Bits of that kind: an image of reduced size, and a mask of another image.
const REDUCED_OR_MASK: u64 = 1 | 4;

/// Most directories that are looked at.
const MOST: usize = 1 << 16;

/// The byte order of a file and whether its offsets have 64 bits.
#[derive(Clone, Copy)]
struct Layout {
    little: bool,
    big_offsets: bool,
}

impl Layout {
    fn of(bytes: &[u8]) -> Option<Self> {
        let little = bytes.starts_with(b"II");
        let layout = Self { little, big_offsets: false };
        Some(Self { big_offsets: layout.number(bytes, 2, 2)? == 43, ..layout })
    }

    /// The unsigned number in some bytes at a place.
    fn number(self, bytes: &[u8], at: u64, length: usize) -> Option<u64> {
        let at = usize::try_from(at).ok()?;
        let digits = bytes.get(at..at.checked_add(length)?)?.iter();
        let join = |number: u64, &digit: &u8| number << 8 | u64::from(digit);
        Some(if self.little { digits.rev().fold(0, join) } else { digits.fold(0, join) })
    }

    /// Where the offset of the first directory is, and its length.
    fn first(self) -> (u64, usize) {
        if self.big_offsets { (8, 8) } else { (4, 4) }
    }

    /// The kind of the image of a directory, and the offset of the next directory or 0.
    fn directory(self, bytes: &[u8], at: u64) -> Option<(u64, u64)> {
        let (head, entry, value, offset) = if self.big_offsets { (8, 20, 12, 8) } else { (2, 12, 8, 4) };
        let count = self.number(bytes, at, head)?;
        let entries = at.checked_add(head as u64)?;
        let end = entries.checked_add(count.checked_mul(entry)?)?;
        // Entries are sorted, and hardly a tag is smaller; a few are looked at where they are not.
        let mut places = (0..count.min(32)).map(|i| entries + i * entry);
        let kind = places.find(|&place| self.number(bytes, place, 2) == Some(NEW_SUBFILE_TYPE));
        let kind = kind.and_then(|place| self.number(bytes, place + value, 4)).unwrap_or(0);
        Some((kind, self.number(bytes, end, offset).unwrap_or(0)))
    }
}

/// The offsets of the directories of all pages: images that are neither smaller copies nor masks of others. Where all
/// are, all count as pages. There is always one, if only for the decoder to say what is wrong with it.
pub(in crate::load) fn pages(bytes: &[u8]) -> Vec<u64> {
    let Some(layout) = Layout::of(bytes) else { return vec![0] };
    let (at, length) = layout.first();
    let first = layout.number(bytes, at, length).unwrap_or(0);
    let (mut next, mut seen, mut found) = (first, HashSet::new(), Vec::new());
    while next != 0 && found.len() < MOST && seen.insert(next) {
        let Some((kind, after)) = layout.directory(bytes, next) else { break };
        found.push((next, kind));
        next = after;
    }
    let whole = |&(_, kind): &(u64, u64)| kind & REDUCED_OR_MASK == 0;
    let any = found.iter().any(whole);
    let pages: Vec<u64> = found.iter().filter(|page| !any || whole(page)).map(|page| page.0).collect();
    if pages.is_empty() { vec![first] } else { pages }
}

/// A file whose header is made to point at one of its directories.
pub(super) struct At<'a> {
    bytes: &'a [u8],
    header: Vec<u8>,
    place: u64,
}

impl<'a> At<'a> {
    pub(super) fn new(bytes: &'a [u8], directory: u64) -> Self {
        let mut header = bytes[..bytes.len().min(16)].to_vec();
        if let Some(layout) = Layout::of(bytes) {
            let (at, length) = layout.first();
            let digits = directory.to_be_bytes();
            let mut digits = digits[8 - length..].to_vec();
            if layout.little {
                digits.reverse();
            }
            let at = at as usize;
            if let Some(place) = header.get_mut(at..at + length) {
                place.copy_from_slice(&digits);
            }
        }
        Self { bytes, header, place: 0 }
    }
}

impl Read for At<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize> {
        let start = usize::try_from(self.place).unwrap_or(usize::MAX).min(self.bytes.len());
        let rest = if start < self.header.len() { &self.header[start..] } else { &self.bytes[start..] };
        let count = rest.len().min(buffer.len());
        buffer[..count].copy_from_slice(&rest[..count]);
        self.place += count as u64;
        Ok(count)
    }
}

impl Seek for At<'_> {
    fn seek(&mut self, to: SeekFrom) -> Result<u64> {
        let place = match to {
            SeekFrom::Start(at) => Some(at),
            SeekFrom::End(by) => (self.bytes.len() as u64).checked_add_signed(by),
            SeekFrom::Current(by) => self.place.checked_add_signed(by),
        };
        self.place = place.ok_or(std::io::ErrorKind::InvalidInput)?;
        Ok(self.place)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A TIFF of directories of one entry each: their kinds, each followed by the next, the last by the given one.
    fn chain(kinds: &[u32], last: u32) -> Vec<u8> {
        let mut bytes = b"II*\0\x08\0\0\0".to_vec();
        for (i, kind) in kinds.iter().enumerate() {
            let next = if i + 1 < kinds.len() { 8 + 18 * (i as u32 + 1) } else { last };
            bytes.extend([1, 0, 254, 0, 4, 0, 1, 0, 0, 0]);
            bytes.extend([*kind, next].map(u32::to_le_bytes).concat());
        }
        bytes
    }

    #[test]
    fn smaller_copies_and_masks_are_no_pages() {
        assert_eq!(pages(&chain(&[0, 1, 2, 4, 0], 0)), [8, 44, 80]);
        assert_eq!(pages(&chain(&[1, 1], 0)), [8, 26], "unless there is nothing else");
    }

    #[test]
    fn chains_that_run_in_a_circle_or_out_of_the_file_end() {
        assert_eq!(pages(&chain(&[0, 0], 8)), [8, 26]);
        assert_eq!(pages(&chain(&[0, 0], 1 << 30)), [8, 26]);
        assert_eq!(pages(b"MM\0*"), [0]);
        let bytes = chain(&[0, 0, 0], 0);
        for end in 0..bytes.len() {
            assert!(!pages(&bytes[..end]).is_empty());
        }
    }

    #[test]
    fn the_view_differs_in_its_header_alone() {
        let bytes = chain(&[0, 0, 0], 0);
        let mut seen = Vec::new();
        At::new(&bytes, 26).read_to_end(&mut seen).unwrap();
        assert_eq!((&seen[..4], &seen[4..8], &seen[8..]), (&bytes[..4], &[26, 0, 0, 0][..], &bytes[8..]));
        let mut two = [0; 2];
        let mut view = At::new(&bytes, 26);
        view.seek(SeekFrom::End(-18)).unwrap();
        view.read_exact(&mut two).unwrap();
        assert_eq!(two, [1, 0]);
    }
}
