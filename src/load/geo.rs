//! Where on earth a scan lies: GeoTIFF tags (OGC 19-008r4), or a world file beside the image (Esri).

use crate::place::Georeference;
#[cfg(feature = "files")]
use image::ImageReader;
use kurbo::{Affine, Vec2};
use std::io::Cursor;
use std::path::Path;
use tiff::decoder::Decoder;
use tiff::tags::Tag;

/// Keys of the GeoTIFF directory.
const RASTER_TYPE: u16 = 1025;
const GEOGRAPHIC: u16 = 2048;
const PROJECTED: u16 = 3072;
/// Positions are those of pixels' centres.
const PIXEL_IS_POINT: u16 = 2;
/// Codes from here on are the file's own systems.
const OWN_SYSTEM: u16 = 32767;

/// Where an image file's pixels lie, as they are stored; `None` where neither the file nor one beside it says.
pub fn georeference(path: &Path, bytes: &[u8]) -> Option<Georeference> {
    of_tiff(bytes).or_else(|| Some(Georeference { to_world: beside(path)?, epsg: None }))
}

/// The same for the scan that became of the file: a part of it, its pixels perhaps made square.
#[cfg(feature = "files")]
pub(crate) fn for_scan(
    whole: Georeference,
    bytes: &[u8],
    crop: Option<[u32; 4]>,
    scan: (usize, usize),
) -> Option<Georeference> {
    let (width, height) = ImageReader::new(Cursor::new(bytes)).with_guessed_format().ok()?.into_dimensions().ok()?;
    let [x, y, w, h] = crop.unwrap_or([0, 0, width, height]).map(f64::from);
    let to_stored = Affine::translate(Vec2::new(x, y))
        * Affine::scale_non_uniform(w / scan.0.max(1) as f64, h / scan.1.max(1) as f64);
    Some(Georeference { to_world: whole.to_world * to_stored, ..whole })
}

/// From the tags of a GeoTIFF.
fn of_tiff(bytes: &[u8]) -> Option<Georeference> {
    let mut reader = Decoder::new(Cursor::new(bytes)).ok()?;
    let mut numbers = |tag: Tag| reader.find_tag(tag).ok().flatten()?.into_f64_vec().ok();
    let scale = numbers(Tag::ModelPixelScaleTag);
    let tie = numbers(Tag::ModelTiepointTag);
    let matrix = numbers(Tag::ModelTransformationTag);
    let keys = reader.find_tag(Tag::GeoKeyDirectoryTag).ok().flatten().and_then(|v| v.into_u16_vec().ok());
    let keys = keys.unwrap_or_default();
    let key = |wanted: u16| {
        let entry = keys.chunks_exact(4).skip(1).find(|entry| entry[0] == wanted && entry[1] == 0)?;
        Some(entry[3])
    };
    let to_world = match (matrix, scale, tie) {
        (Some(m), ..) if m.len() >= 8 => Affine::new([m[0], m[4], m[1], m[5], m[3], m[7]]),
        (_, Some(s), Some(t)) if s.len() >= 2 && t.len() >= 6 => {
            Affine::translate(Vec2::new(t[3], t[4]))
                * Affine::scale_non_uniform(s[0], -s[1])
                * Affine::translate(Vec2::new(-t[0], -t[1]))
        }
        _ => return None,
    };
    let centred = key(RASTER_TYPE) == Some(PIXEL_IS_POINT);
    let to_world = if centred { of_centres(to_world) } else { to_world };
    let epsg = key(PROJECTED).or_else(|| key(GEOGRAPHIC)).filter(|code| (1..OWN_SYSTEM).contains(code));
    usable(to_world).then_some(Georeference { to_world, epsg: epsg.map(u32::from) })
}

/// The map of pixels' corners where that of their centres is given.
fn of_centres(map: Affine) -> Affine {
    map * Affine::translate(Vec2::new(-0.5, -0.5))
}

fn usable(map: Affine) -> bool {
    map.is_finite() && map.determinant() != 0.0
}

/// From the six numbers of a world file, which tell where the first pixel's centre is.
fn beside(path: &Path) -> Option<Affine> {
    let end = path.extension()?.to_string_lossy().into_owned();
    let short: String = end.chars().take(1).chain(end.chars().last()).chain(['w']).collect();
    let names = [short, format!("{end}w"), "wld".into()];
    let ways = names.iter().flat_map(|end| [end.to_lowercase(), end.to_uppercase()]);
    let text = ways.filter_map(|end| std::fs::read_to_string(path.with_extension(end)).ok()).next()?;
    let numbers: Vec<f64> = text.split_whitespace().map_while(|word| word.parse().ok()).collect();
    let [a, d, b, e, c, f] = numbers[..] else { return None };
    let map = of_centres(Affine::new([a, d, b, e, c, f]));
    usable(map).then_some(map)
}

#[cfg(test)]
mod tests {
    use super::*;
    use kurbo::Point;

    #[test]
    fn a_world_file_tells_where_the_first_pixel_is() {
        let folder = tempfile::tempdir().unwrap();
        let image = folder.path().join("map.png");
        assert_eq!(beside(&image), None);
        std::fs::write(folder.path().join("map.pgw"), "2.0\n0.0\n0.0\n-2.0\n1001.0\n4999.0\n").unwrap();
        let map = beside(&image).unwrap();
        assert_eq!(map * Point::ZERO, Point::new(1000.0, 5000.0));
        assert_eq!(map * Point::new(10.0, 20.0), Point::new(1020.0, 4960.0));
        std::fs::write(folder.path().join("map.pgw"), "2.0 none").unwrap();
        assert_eq!(beside(&image), None);
    }

    #[test]
    fn a_part_with_pixels_made_square_lies_where_it_did() {
        let png = {
            let mut bytes = Cursor::new(Vec::new());
            image::GrayImage::new(100, 50).write_to(&mut bytes, image::ImageFormat::Png).unwrap();
            bytes.into_inner()
        };
        let whole = Georeference { to_world: Affine::new([2.0, 0.0, 0.0, -4.0, 1000.0, 5000.0]), epsg: Some(25832) };
        let part = for_scan(whole.clone(), &png, Some([10, 20, 40, 30]), (40, 60)).unwrap();
        assert_eq!(part.place(Point::ZERO), Point::new(1020.0, 4920.0));
        assert_eq!(part.place(Point::new(40.0, 60.0)), whole.place(Point::new(50.0, 50.0)));
        assert_eq!(part.epsg, Some(25832));
    }
}
