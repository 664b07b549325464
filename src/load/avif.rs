//! AVIF: the container is read by `avif-parse`, the picture in it decoded by `re_rav1d`.

use super::bitmap::Decoded;
use super::plan::Header;
use super::{LoadOptions, undecodable};
use crate::error::Result;
use image::metadata::Orientation;
use image::{DynamicImage, ImageBuffer, Rgba};
use re_rav1d::dav1d::pixel::{MatrixCoefficients as Matrix, YUVRange};
use re_rav1d::dav1d::{self, Decoder, Picture, PixelLayout, PlanarImageComponent as Component, Settings};
use std::io::Cursor;

/// Bytes of a file in which the properties of its image are looked for.
const HEAD: usize = 1 << 16;

/// Decodes the main image.
///
/// # Errors
/// [`crate::Error::Decode`] and [`crate::Error::TooLarge`].
pub(super) fn decode(name: &str, bytes: &[u8], options: &LoadOptions) -> Result<Decoded> {
    let damaged = |e: avif_parse::Error| undecodable(name, e);
    let file = avif_parse::read_avif(&mut Cursor::new(bytes)).map_err(damaged)?;
    let claim = file.primary_item_metadata().map_err(damaged)?;
    let (width, height) = (claim.max_frame_width.get(), claim.max_frame_height.get());
    let plan = Header { width, height, orientation: orientation(bytes), density: None }.plan(name, options)?;
    let picture = |data: &[u8]| {
        let picture = picture(data, width.saturating_mul(height)).map_err(|e| undecodable(name, e))?;
        let fits = (picture.width(), picture.height()) == (width, height);
        if fits { Ok(picture) } else { Err(undecodable(name, "the picture has another size than its header tells")) }
    };
    let color = Samples::of(picture(&file.primary_item)?);
    let alpha = file.alpha_item.as_deref().map(|data| picture(data).map(Samples::of)).transpose()?;
    let pixel = |x: u32, y: u32| {
        let rgb = color.rgb(x, y);
        let alpha = alpha.as_ref().map_or(1.0, |alpha| alpha.light(x, y));
        let full = if file.premultiplied_alpha && alpha > 0.0 { alpha } else { 1.0 };
        let [r, g, b] = rgb.map(|v| (v / full).clamp(0.0, 1.0));
        [r, g, b, alpha]
    };
    let image: DynamicImage = if color.bits == 8 {
        let byte = |v: f32| (v * 255.0).round() as u8;
        ImageBuffer::from_fn(width, height, |x, y| Rgba(pixel(x, y).map(byte))).into()
    } else {
        let word = |v: f32| (v * 65535.0).round() as u16;
        ImageBuffer::from_fn(width, height, |x, y| Rgba(pixel(x, y).map(word))).into()
    };
    Ok(Decoded { image, plan })
}

/// The first picture of an AV1 stream of at most some pixels.
fn picture(data: &[u8], pixels: u32) -> std::result::Result<Picture, dav1d::Error> {
    let mut settings = Settings::new();
    settings.set_n_threads(1);
    settings.set_max_frame_delay(1);
    settings.set_frame_size_limit(pixels);
    let mut decoder = Decoder::with_settings(&settings)?;
    match decoder.send_data(data.to_vec(), None, None, None) {
        Err(error) if !error.is_again() => return Err(error),
        _ => {}
    }
    decoder.get_picture()
}

/// What the properties `irot` (quarter turns to the left) and `imir` (0 up and down, 1 left and right) ask for.
fn orientation(bytes: &[u8]) -> Orientation {
    use Orientation::{FlipHorizontal, FlipVertical, NoTransforms};
    use Orientation::{Rotate90, Rotate90FlipH, Rotate180, Rotate270, Rotate270FlipH};
    let head = &bytes[..bytes.len().min(HEAD)];
    let property = |kind: &[u8; 4]| {
        let whole = [b"\0\0\0\x09", &kind[..]].concat();
        let at = head.windows(8).position(|w| w == whole)?;
        head.get(at + 8).map(|&value| usize::from(value))
    };
    let right = (4 - property(b"irot").unwrap_or(0) % 4) % 4;
    match property(b"imir") {
        None => [NoTransforms, Rotate90, Rotate180, Rotate270][right],
        // Up and down is a half turn, then left and right.
        Some(axis) => {
            let half = if axis & 1 == 0 { 2 } else { 0 };
            [FlipHorizontal, Rotate90FlipH, FlipVertical, Rotate270FlipH][(right + half) % 4]
        }
    }
}

/// The planes of a picture.
struct Samples {
    planes: Vec<(dav1d::Plane, usize)>,
    bits: usize,
    /// By how many bits columns and rows of the chroma planes are fewer.
    shift: (u32, u32),
    full_range: bool,
    matrix: Matrix,
}

impl Samples {
    fn of(picture: Picture) -> Self {
        let (components, shift): (&[Component], _) = match picture.pixel_layout() {
            PixelLayout::I400 => (&[Component::Y], (0, 0)),
            PixelLayout::I420 => (&[Component::Y, Component::U, Component::V], (1, 1)),
            PixelLayout::I422 => (&[Component::Y, Component::U, Component::V], (1, 0)),
            PixelLayout::I444 => (&[Component::Y, Component::U, Component::V], (0, 0)),
        };
        let planes = components.iter().map(|&c| (picture.plane(c), picture.stride(c) as usize)).collect();
        let full_range = matches!(picture.color_range(), YUVRange::Full);
        Self { planes, bits: picture.bit_depth(), shift, full_range, matrix: picture.matrix_coefficients() }
    }

    /// A stored sample.
    fn sample(&self, plane: usize, x: u32, y: u32) -> f32 {
        let (data, stride) = &self.planes[plane];
        let row = y as usize * stride;
        if self.bits == 8 {
            f32::from(data[row + x as usize])
        } else {
            let at = row + 2 * x as usize;
            f32::from(u16::from_ne_bytes([data[at], data[at + 1]]))
        }
    }

    /// A sample of the first plane as a fraction of its range.
    fn light(&self, x: u32, y: u32) -> f32 {
        self.fraction(self.sample(0, x, y))
    }

    fn fraction(&self, value: f32) -> f32 {
        let unit = (1u32 << (self.bits - 8)) as f32;
        let whole = 256.0 * unit - 1.0;
        let fraction = if self.full_range { value / whole } else { (value / unit - 16.0) / 219.0 };
        fraction.clamp(0.0, 1.0)
    }

    /// Red, green and blue of a pixel.
    fn rgb(&self, x: u32, y: u32) -> [f32; 3] {
        let light = self.light(x, y);
        if self.planes.len() == 1 {
            return [light; 3];
        }
        let (cx, cy) = (x >> self.shift.0, y >> self.shift.1);
        let [b, r] = [1, 2].map(|plane| self.sample(plane, cx, cy));
        let (red, blue) = match self.matrix {
            Matrix::Identity => return [self.fraction(r), light, self.fraction(b)],
            Matrix::BT709 => (0.2126, 0.0722),
            Matrix::BT2020NonConstantLuminance | Matrix::BT2020ConstantLuminance => (0.2627, 0.0593),
            Matrix::ST240M => (0.212, 0.087),
            _ => (0.299, 0.114),
        };
        let unit = (1u32 << (self.bits - 8)) as f32;
        let range = if self.full_range { 256.0 * unit - 1.0 } else { 224.0 * unit };
        let [b, r] = [b, r].map(|v| (v - 128.0 * unit) / range);
        let (r, b) = (light + 2.0 * (1.0 - red) * r, light + 2.0 * (1.0 - blue) * b);
        let g = (light - red * r - blue * b) / (1.0 - red - blue);
        [r, g, b].map(|v: f32| v.clamp(0.0, 1.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_and_mirrors_are_read_from_the_properties() {
        let of = |boxes: &[&[u8]]| orientation(&boxes.concat());
        assert_eq!(of(&[b"\0\0\0\x09av1C\0"]), Orientation::NoTransforms);
        assert_eq!(of(&[b"\0\0\0\x09irot\x01"]), Orientation::Rotate270);
        assert_eq!(of(&[b"\0\0\0\x09imir\x01"]), Orientation::FlipHorizontal);
        assert_eq!(of(&[b"\0\0\0\x09imir\0"]), Orientation::FlipVertical);
        assert_eq!(of(&[b"\0\0\0\x09irot\x03", b"\0\0\0\x09imir\x01"]), Orientation::Rotate90FlipH);
        assert_eq!(of(&[b"\0\0\0\x09irot"]), Orientation::NoTransforms);
    }
}
