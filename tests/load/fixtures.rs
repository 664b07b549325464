//! Image files made by hand, and the comparison of what is read from them.

use fieldtrace::load::{Input, LoadOptions, load_bytes};
use flate2::{Compression, Crc, write::ZlibEncoder};
use image::{DynamicImage, GrayImage, ImageFormat, Luma};
use std::io::{Cursor, Write};

/// Reads bytes with default options.
pub fn load(bytes: &[u8]) -> Input {
    load_bytes("test", bytes, &LoadOptions::default()).unwrap()
}

/// The lightness of all pixels, row by row.
pub fn gray(bytes: &[u8]) -> Vec<f32> {
    load(bytes).scan.gray.data().to_vec()
}

/// Asserts that two rows of samples agree within a tolerance.
#[track_caller]
pub fn assert_close(got: &[f32], expected: &[f32], tolerance: f32) {
    assert_eq!(got.len(), expected.len());
    for (i, (g, e)) in got.iter().zip(expected).enumerate() {
        assert!((g - e).abs() <= tolerance, "sample {i} is {g} and not {e}");
    }
}

/// An image without symmetry, in blocks that survive JPEG.
pub fn blocks() -> GrayImage {
    let levels = [[0u8, 80, 255], [200, 40, 120]];
    GrayImage::from_fn(24, 16, |x, y| Luma([levels[y as usize / 8][x as usize / 8]]))
}

/// The samples of a grey image as fractions.
pub fn fractions(image: &GrayImage) -> Vec<f32> {
    image.as_raw().iter().map(|&v| f32::from(v) / 255.0).collect()
}

/// An image in a format of the `image` crate.
pub fn encode(image: impl Into<DynamicImage>, format: ImageFormat) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    image.into().write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

/// A PNG from its header fields, extra chunks before the data, and filtered scanlines.
pub struct Png<'a> {
    pub width: u32,
    pub height: u32,
    pub depth: u8,
    pub color: u8,
    pub interlaced: bool,
    pub chunks: &'a [(&'a [u8; 4], Vec<u8>)],
    /// Scanlines, each after its filter byte.
    pub data: Vec<u8>,
}

impl Png<'_> {
    pub fn bytes(&self) -> Vec<u8> {
        let mut header = [self.width.to_be_bytes(), self.height.to_be_bytes()].concat();
        header.extend([self.depth, self.color, 0, 0, u8::from(self.interlaced)]);
        let mut out = b"\x89PNG\r\n\x1a\n".to_vec();
        push_chunk(&mut out, b"IHDR", &header);
        self.chunks.iter().for_each(|(kind, data)| push_chunk(&mut out, kind, data));
        let mut zlib = ZlibEncoder::new(Vec::new(), Compression::default());
        zlib.write_all(&self.data).unwrap();
        push_chunk(&mut out, b"IDAT", &zlib.finish().unwrap());
        push_chunk(&mut out, b"IEND", &[]);
        out
    }
}

fn push_chunk(out: &mut Vec<u8>, kind: &[u8; 4], data: &[u8]) {
    let mut crc = Crc::new();
    crc.update(kind);
    crc.update(data);
    out.extend((data.len() as u32).to_be_bytes());
    out.extend(kind);
    out.extend(data);
    out.extend(crc.sum().to_be_bytes());
}

/// A value of a TIFF directory.
#[derive(Clone)]
pub enum Field {
    Short(Vec<u16>),
    Long(Vec<u32>),
    Rational(u32, u32),
}

/// One shorthand for the most common field.
pub fn short(value: u16) -> Field {
    Field::Short(vec![value])
}

/// A TIFF whose strips lie at offset 8; unless the fields tell of several, there is one.
pub fn tiff(big_endian: bool, fields: &[(u16, Field)], strip: &[u8]) -> Vec<u8> {
    let u16b = |v: u16| if big_endian { v.to_be_bytes() } else { v.to_le_bytes() };
    let u32b = |v: u32| if big_endian { v.to_be_bytes() } else { v.to_le_bytes() };
    let mut fields = fields.to_vec();
    if fields.iter().all(|f| f.0 != 273 && f.0 != 324) {
        fields.push((273, Field::Long(vec![8])));
        fields.push((279, Field::Long(vec![strip.len() as u32])));
    }
    fields.sort_by_key(|f| f.0);
    let padded = strip.len().next_multiple_of(2);
    let directory = 8 + padded;
    let mut spare = directory + 2 + 12 * fields.len() + 4;
    let (mut entries, mut beyond) = (Vec::new(), Vec::new());
    for (tag, field) in &fields {
        let (kind, count, mut data): (u16, usize, Vec<u8>) = match field {
            Field::Short(v) => (3, v.len(), v.iter().flat_map(|&v| u16b(v)).collect()),
            Field::Long(v) => (4, v.len(), v.iter().flat_map(|&v| u32b(v)).collect()),
            Field::Rational(n, d) => (5, 1, [u32b(*n), u32b(*d)].concat()),
        };
        entries.extend([u16b(*tag), u16b(kind)].concat());
        entries.extend(u32b(count as u32));
        if data.len() > 4 {
            entries.extend(u32b(spare as u32));
            spare += data.len();
            beyond.extend(data);
        } else {
            data.resize(4, 0);
            entries.extend(data);
        }
    }
    let mut out = if big_endian { b"MM\0*".to_vec() } else { b"II*\0".to_vec() };
    out.extend(u32b(directory as u32));
    out.extend(strip);
    out.resize(directory, 0);
    out.extend(u16b(fields.len() as u16));
    out.extend(entries);
    out.extend([0; 4]);
    out.extend(beyond);
    out
}

/// The fields that every TIFF has: size, bits of each sample, compression, photometric interpretation.
pub fn page(width: u32, height: u32, bits: &[u16], compression: u16, photometric: u16) -> Vec<(u16, Field)> {
    vec![
        (256, Field::Long(vec![width])),
        (257, Field::Long(vec![height])),
        (258, Field::Short(bits.to_vec())),
        (259, short(compression)),
        (262, short(photometric)),
        (277, short(bits.len() as u16)),
        (278, Field::Long(vec![height])),
    ]
}

/// Exif metadata with an orientation and a resolution in dots per inch.
pub fn exif(orientation: u16, dpi: u32) -> Vec<u8> {
    tiff(true, &[(0x112, short(orientation)), (0x11A, Field::Rational(dpi, 1)), (0x128, short(2))], &[])
}

/// CCITT group 4 data of a bilevel image; true is ink.
pub fn group4(width: usize, height: usize, ink: impl Fn(usize, usize) -> bool) -> Vec<u8> {
    let mut encoder = fax::encoder::Encoder::new(fax::VecWriter::new());
    for y in 0..height {
        let row = (0..width).map(|x| if ink(x, y) { fax::Color::Black } else { fax::Color::White });
        encoder.encode_line(row, width as u16).unwrap();
    }
    encoder.finish().unwrap().finish()
}

/// A PDF of pages: what is drawn on each, its width and height in points, and further entries of its dictionary.
pub fn pdf(pages: &[(&str, u32, u32, &str)]) -> Vec<u8> {
    let kids: String = (0..pages.len()).map(|i| format!("{} 0 R ", 3 + 2 * i)).collect();
    let mut objects =
        vec!["<</Type/Catalog/Pages 2 0 R>>".to_owned(), format!("<</Type/Pages/Count {}/Kids[{kids}]>>", pages.len())];
    for (i, (content, width, height, more)) in pages.iter().enumerate() {
        let page = "/Type/Page/Parent 2 0 R/Resources<<>>";
        objects.push(format!("<<{page}/MediaBox[0 0 {width} {height}]/Contents {} 0 R {more}>>", 4 + 2 * i));
        objects.push(format!("<</Length {}>>stream\n{content}\nendstream", content.len()));
    }
    let mut out = "%PDF-1.4\n".to_owned();
    let mut table = String::from("0000000000 65535 f \n");
    for (i, object) in objects.iter().enumerate() {
        table += &format!("{:010} 00000 n \n", out.len());
        out += &format!("{} 0 obj\n{object}\nendobj\n", i + 1);
    }
    let (start, count) = (out.len(), objects.len() + 1);
    out += &format!("xref\n0 {count}\n{table}trailer<</Size {count}/Root 1 0 R>>\nstartxref\n{start}\n%%EOF\n");
    out.into_bytes()
}
