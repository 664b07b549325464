//! From a header to what is made of the decoded image: its size is checked before anything is decoded.

use super::{Dpi, LoadOptions, Scan, bitmap, square, undecodable};
use crate::error::Result;
use image::DynamicImage;
use image::metadata::Orientation;

/// Resolutions that differ by less than this factor are one: its pixels are as good as square.
const SQUARE: f64 = 1.01;

/// Pixels longer than this times their width are a slip of the writer.
const LONGEST: f64 = 10.0;

/// How densely pixels lie across and down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Density {
    /// Pixels in a unit of length.
    per: Dpi,
    /// Whether the unit is an inch; else the two give but the shape of a pixel.
    inch: bool,
}

impl Density {
    /// In dots per inch. Where one of the two is missing or makes no sense, the other holds for both.
    pub(super) fn inch(x: Option<f64>, y: Option<f64>) -> Option<Self> {
        let plausible = |v: Option<f64>| v.filter(|&v| super::resolution::plausible(v));
        let (x, y) = (plausible(x), plausible(y));
        let per = Dpi { x: x.or(y)?, y: y.or(x)? };
        Some(Self { per: if sensible(per) { per } else { per.x.into() }, inch: true })
    }

    /// The shape of a pixel, without a size.
    pub(super) fn shape(x: f64, y: f64) -> Option<Self> {
        let per = Dpi { x, y };
        sensible(per).then_some(Self { per, inch: false })
    }

    /// Whether a size is known.
    pub(super) fn is_size(&self) -> bool {
        self.inch
    }

    /// Dots per inch across, where a size is known.
    #[cfg(test)]
    pub(super) fn dpi(&self) -> Option<f64> {
        self.inch.then_some(self.per.x)
    }
}

fn sensible(per: Dpi) -> bool {
    per.x > 0.0 && per.y > 0.0 && per.x <= LONGEST * per.y && per.y <= LONGEST * per.x
}

/// What a header tells of an image as it is stored.
pub(super) struct Header {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// What turns it upright.
    pub orientation: Orientation,
    /// Density across and down the stored image, where the file says.
    pub density: Option<Density>,
}

/// What is made of an image.
#[derive(Debug)]
pub(super) struct Plan {
    orientation: Orientation,
    crop: Option<[u32; 4]>,
    /// Width and height of the scan.
    size: (usize, usize),
    dpi: Option<f64>,
}

impl Header {
    /// What is to be done with the image once it is decoded.
    ///
    /// # Errors
    /// [`crate::Error::TooLarge`] where it, or what becomes of it, has too many pixels, and [`crate::Error::Decode`]
    /// where it has none or the part to read is not within it.
    pub(super) fn plan(&self, name: &str, options: &LoadOptions) -> Result<Plan> {
        use Orientation::{Rotate90, Rotate90FlipH, Rotate270, Rotate270FlipH};
        let turned = matches!(self.orientation, Rotate90 | Rotate90FlipH | Rotate270 | Rotate270FlipH);
        let (width, height) = if turned { (self.height, self.width) } else { (self.width, self.height) };
        let density = self.density.map(|density| {
            let Dpi { x, y } = density.per;
            Density { per: if turned { Dpi { x: y, y: x } } else { density.per }, ..density }
        });
        let asked = options.dpi.map(|per| Density { per, inch: true });
        plan(name, (width, height), asked.or(density), options)
            .map(|plan| Plan { orientation: self.orientation, ..plan })
    }
}

impl Plan {
    /// For a rendering, whose pixels are square.
    ///
    /// # Errors
    /// Those of [`Header::plan`].
    #[cfg(any(feature = "formats", feature = "svg-input"))]
    pub(super) fn rendered(name: &str, size: (u32, u32), dpi: f64, options: &LoadOptions) -> Result<Self> {
        plan(name, size, Some(Density { per: dpi.into(), inch: true }), options)
    }

    /// Pixels that the part lies to the right and below; `None` for the whole.
    #[cfg(feature = "svg-input")]
    pub(super) fn corner(&self) -> Option<(u32, u32)> {
        self.crop.map(|[x, y, ..]| (x, y))
    }

    /// Does it.
    pub(super) fn scan(&self, mut image: DynamicImage) -> Scan {
        image.apply_orientation(self.orientation);
        if let Some([x, y, width, height]) = self.crop {
            image = image.crop_imm(x, y, width, height);
        }
        square::resized(bitmap::scan(&image, self.dpi), self.size)
    }
}

/// For an upright image of a size and density.
fn plan(name: &str, (width, height): (u32, u32), density: Option<Density>, options: &LoadOptions) -> Result<Plan> {
    options.check_size(name, width.into(), height.into())?;
    let [_, _, w, h] = options.crop.unwrap_or([0, 0, width, height]);
    if let Some([x, y, ..]) = options.crop {
        let within = |from: u32, length: u32, whole: u32| from.checked_add(length).is_some_and(|end| end <= whole);
        if !within(x, w, width) || !within(y, h, height) {
            let part = format!("the part {x},{y},{w},{h} is not within the image");
            return Err(undecodable(name, format!("{part}, which has {width} x {height} pixels")));
        }
    }
    let (dpi, size) = match density {
        None => (None, (w.into(), h.into())),
        Some(Density { per, inch }) => {
            let finer = per.finer();
            let skewed = finer > SQUARE * per.x.min(per.y);
            let side = |pixels: u32, own: f64| (f64::from(pixels) * finer / own).round() as u64;
            let size = if skewed { (side(w, per.x), side(h, per.y)) } else { (w.into(), h.into()) };
            (inch.then_some(if skewed { finer } else { per.x }), size)
        }
    };
    options.check_size(name, size.0, size.1)?;
    let size = (size.0 as usize, size.1 as usize);
    Ok(Plan { orientation: Orientation::NoTransforms, crop: options.crop, size, dpi })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header(density: Option<Density>, orientation: Orientation) -> Header {
        Header { width: 200, height: 100, orientation, density }
    }

    #[test]
    fn pixels_are_made_square_at_the_finer_resolution() {
        let options = LoadOptions::default();
        let planned = |x, y, orientation| {
            let plan = header(Density::inch(Some(x), Some(y)), orientation).plan("a", &options).unwrap();
            (plan.size, plan.dpi)
        };
        assert_eq!(planned(204.0, 98.0, Orientation::NoTransforms), ((200, 208), Some(204.0)));
        assert_eq!(planned(100.0, 200.0, Orientation::NoTransforms), ((400, 100), Some(200.0)));
        assert_eq!(planned(200.0, 100.0, Orientation::Rotate90), ((200, 200), Some(200.0)));
        assert_eq!(planned(300.0, 301.0, Orientation::NoTransforms), ((200, 100), Some(300.0)));
        let shape = header(Density::shape(2.0, 1.0), Orientation::NoTransforms).plan("a", &options).unwrap();
        assert_eq!((shape.size, shape.dpi), ((200, 200), None));
    }

    #[test]
    fn nonsense_gives_no_long_pixels() {
        assert_eq!(Density::inch(Some(300.0), None), Density::inch(Some(300.0), Some(300.0)));
        assert_eq!(Density::inch(Some(300.0), Some(2.0)), Density::inch(Some(300.0), Some(300.0)));
        assert_eq!(Density::inch(None, Some(f64::NAN)), None);
        assert_eq!(Density::shape(1.0, 0.0), None);
        assert_eq!(Density::shape(f64::NAN, 1.0), None);
    }

    #[test]
    fn what_becomes_of_an_image_keeps_to_the_limit_too() {
        let options =
            LoadOptions { max_pixels: 30_000, dpi: Some(Dpi { x: 300.0, y: 100.0 }), ..LoadOptions::default() };
        let error = header(None, Orientation::NoTransforms).plan("a", &options).unwrap_err();
        assert!(matches!(error, crate::Error::TooLarge { width: 200, height: 300, .. }), "{error:?}");
        let part = LoadOptions { crop: Some([0, 0, 100, 100]), ..options };
        assert_eq!(header(None, Orientation::NoTransforms).plan("a", &part).unwrap().size, (100, 300));
    }
}
