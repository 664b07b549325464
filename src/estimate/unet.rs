//! The field from the trained network.

use super::FieldEstimator;
use crate::cancel::Cancel;
use crate::clean::LineImage;
use crate::error::Result;
use crate::field::{Pixel, PolyVectorField, is_defined};
use crate::raster::{Mask, Raster, runs};
use crate::unet::engine::{Engine, Scratch, TileCells};
use crate::unet::{Backend, Extractor, Output, Shown, UNetConfig, Weights};
#[cfg(feature = "train")]
use crate::unet::{Features, Within, features};
#[cfg(feature = "train")]
use burn::tensor::{Device, Tensor, TensorData};
use num_complex::Complex32;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Largest side of the part of a tile that is kept, in pixels: the larger, the less is computed twice.
const CORE: usize = 512;

/// Pixels around a tile's core that the network also sees.
const HALO: usize = 32;

/// Ink is computed together with this many pixels around it; what is further away counts as blank paper.
const CONTEXT: usize = 8;

/// Pixels off the mask that get a field too, so that it can be interpolated at the edge of the ink.
const MARGIN: usize = 2;

/// Standard deviation in line widths of the smoothing along the ink that takes the noise of single pixels out of the
/// network's field: [`PolyVectorField::smoothed`].
const SMOOTHING: f64 = 2.25;

/// Standard deviation of the distance of coefficients in it: noise makes like coefficients differ more.
const ALIKE: f32 = 0.2;
const SURE_ALIKE: f32 = 0.14;

/// The field from the U-Net, Taktasheva et al. 2019: the mean of what the network sees in the drawing and in its mirror image.
#[derive(Debug)]
pub struct UNet {
    config: UNetConfig,
    runner: Runner,
}

#[derive(Debug)]
enum Runner {
    /// The crate's own inference on the CPU, only where there is ink: the network and its mirror image.
    Engine(Box<[Engine; 2]>),
    /// The same by the tensor library on some device, tile by tile.
    #[cfg(feature = "train")]
    Library(Box<[Within; 2]>, Device),
}

impl UNet {
    /// The network that the program carries, run by the crate's own engine.
    ///
    /// # Errors
    /// [`crate::Error::Weights`] never, unless the program was built around a broken file.
    pub fn built_in() -> Result<Self> {
        Self::new(&Weights::built_in()?, Backend::Engine)
    }

    /// The network of some weights.
    ///
    /// # Errors
    /// [`crate::Error::Weights`] when the weights are not all there, or those of a network that sees something else.
    pub fn new(weights: &Weights, backend: Backend) -> Result<Self> {
        let config = weights.config();
        if config.output != Output::Field {
            return Err(weights.failed("holds no field network"));
        }
        let runner = match backend {
            Backend::Engine => Runner::Engine(Box::new([Engine::new(weights)?, Engine::new(&weights.mirrored()?)?])),
            #[cfg(feature = "train")]
            Backend::Library(device) => {
                let within = |weights: &Weights| Ok(Within::new(weights.model(&device)?, &config, &device));
                Runner::Library(Box::new([within(weights)?, within(&weights.mirrored()?)?]), device)
            }
        };
        Ok(Self { config, runner })
    }
}

impl FieldEstimator for UNet {
    fn name(&self) -> &str {
        "unet"
    }

    fn estimate(&self, image: &LineImage) -> Result<PolyVectorField> {
        self.estimate_until(image, &Cancel::default())
    }

    fn estimate_until(&self, image: &LineImage, cancel: &Cancel) -> Result<PolyVectorField> {
        let (width, height) = image.ink.size();
        let ink = Shown::of(image);
        let grid = Grid::new(&image.mask, self.config.multiple());
        let tiles: Vec<(usize, usize)> = grid.tiles().collect();
        let tile = |at| Tile::new(&grid, at, &image.mask).filter(|_| cancel.check().is_ok());
        let parts: Vec<Vec<Pixel>> = match &self.runner {
            Runner::Engine(engines) => {
                let spare = Mutex::new(Vec::<Room>::new());
                let run = |&at: &(usize, usize)| {
                    let Some(tile) = tile(at) else { return Vec::new() };
                    let mut room = lock(&spare).pop().unwrap_or_default();
                    let pixels = tile.by_engine(engines, &mut room, &ink, self.config);
                    lock(&spare).push(room);
                    pixels
                };
                tiles.par_iter().map(run).collect()
            }
            #[cfg(feature = "train")]
            Runner::Library(networks, device) => {
                let run = |&at: &(usize, usize)| {
                    tile(at).map_or_else(Vec::new, |t| t.by_library(networks, device, &ink, self.config))
                };
                tiles.iter().map(run).collect()
            }
        };
        cancel.check()?;
        let field = PolyVectorField::from_parts(width, height, parts);
        let alike = image.noise.mean().between(SURE_ALIKE.into(), ALIKE.into()) as f32;
        Ok(field.smoothed(&image.mask, (SMOOTHING * image.line_width).clamp(2.0, 10.0), alike))
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What a tile is worked out in; to be reused from tile to tile.
#[derive(Default)]
struct Room {
    features: Extractor,
    scratch: Scratch,
    /// What the first of two networks gives.
    values: Vec<[f32; 4]>,
}

/// How the part of an image that has ink is cut into tiles of one size. Tiles begin where the ink does, so that a drawing
/// gets the same field wherever it lies on the page.
struct Grid {
    image: (usize, usize),
    /// First columns and rows that have ink, and those after the last.
    inked: [Range<usize>; 2],
    core: (usize, usize),
    multiple: usize,
}

impl Grid {
    fn new(mask: &Mask, multiple: usize) -> Self {
        let inked = inked(mask);
        let core =
            |inked: &Range<usize>| inked.len().div_ceil(inked.len().div_ceil(CORE).max(1)).next_multiple_of(multiple);
        let core = (core(&inked[0]), core(&inked[1]));
        Self { image: mask.size(), inked, core, multiple }
    }

    fn halo(&self) -> usize {
        HALO.next_multiple_of(self.multiple)
    }

    /// Top left corners of the cores.
    fn tiles(&self) -> impl Iterator<Item = (usize, usize)> {
        let ([columns, rows], (w, h)) = (self.inked.clone(), self.core);
        rows.step_by(h.max(1)).flat_map(move |y| columns.clone().step_by(w.max(1)).map(move |x| (x, y)))
    }
}

/// A core with its halo.
struct Tile<'a> {
    grid: &'a Grid,
    /// Top left corner of the core.
    at: (usize, usize),
    /// Width and height with the halo.
    size: (usize, usize),
    cells: TileCells,
    /// The pixels of the core that get a field.
    wanted: Mask,
    mask: &'a Mask,
}

impl<'a> Tile<'a> {
    /// `None` where the core has no ink.
    fn new(grid: &'a Grid, at: (usize, usize), mask: &'a Mask) -> Option<Self> {
        let (core, halo, m) = (grid.core, grid.halo(), grid.multiple);
        let size = (core.0 + 2 * halo, core.1 + 2 * halo);
        let (columns, rows) = (size.0 / m, size.1 / m);
        let mut active = vec![false; columns * rows];
        // Ink beyond the core counts as far as the core's ink is influenced by it most.
        for (run, y) in runs_around(mask, at, core, halo / 2) {
            let cells = |from: usize, to: usize, at: usize| {
                (from + halo - at - CONTEXT) / m..(to - 1 + halo - at + CONTEXT) / m + 1
            };
            for v in cells(y, y + 1, at.1) {
                let cells = cells(run.start, run.end, at.0);
                active[v * columns + cells.start..v * columns + cells.end].fill(true);
            }
        }
        let mut wanted = Mask::filled(core.0, core.1, false);
        for (run, y) in runs_around(mask, at, core, MARGIN) {
            // The run with its margin, from the core's corner on.
            let near = |from: usize, to: usize, at: usize, n: usize| {
                from.saturating_sub(at + MARGIN)..(to + MARGIN).saturating_sub(at).min(n)
            };
            let (x, rows) = (near(run.start, run.end, at.0, core.0), near(y, y + 1, at.1, core.1));
            rows.for_each(|v| wanted.data_mut()[v * core.0 + x.start..v * core.0 + x.end].fill(true));
        }
        let any = runs_around(mask, at, core, 0).next().is_some();
        any.then(|| Self { grid, at, size, cells: TileCells::new(columns, rows, active), wanted, mask })
    }

    /// The ink under the tile, the image's edge pixels repeated outside.
    fn cut(&self, ink: &Shown) -> Raster<f32> {
        let halo = self.grid.halo();
        let (w, h) = self.grid.image;
        let clamp = |p: usize, n: usize| p.saturating_sub(halo).min(n - 1);
        Raster::from_fn(self.size.0, self.size.1, |x, y| ink.at(clamp(self.at.0 + x, w), clamp(self.at.1 + y, h)))
    }

    /// The number in the image of a pixel of the tile, if it is in the core and near ink.
    fn number(&self, x: usize, y: usize) -> Option<usize> {
        let halo = self.grid.halo() as i64;
        self.wanted.get(x as i64 - halo, y as i64 - halo).filter(|wanted| *wanted)?;
        let (x, y) = (self.at.0 + x - halo as usize, self.at.1 + y - halo as usize);
        let (width, height) = self.grid.image;
        (x < width && y < height).then_some(y * width + x)
    }

    /// A pixel's field. Confidence is the modulus of the stronger root, at most 1, and less off the mask.
    fn pixel(&self, index: usize, values: [f32; 4], base: [f32; 4]) -> Pixel {
        let [a, b, c, d] = [0, 1, 2, 3].map(|k| values[k] + base[k]);
        let (c0, c2) = (Complex32::new(a, b), Complex32::new(c, d));
        let strong = strong_root(c0, c2);
        let confidence = match strong.clamp(0.05, 1.0) {
            _ if !is_defined(c0, strong) => 0.0,
            strong if self.mask.data()[index] => strong,
            strong => 0.25 * strong,
        };
        Pixel { index, c0, c2, confidence }
    }

    fn by_engine(&self, engines: &[Engine; 2], room: &mut Room, ink: &Shown, config: UNetConfig) -> Vec<Pixel> {
        let mut wanted = vec![Vec::new(); self.size.1];
        self.cells.runs(self.grid.multiple, |x, y, n| wanted[y].push(x..x + n));
        let Room { features, scratch, values } = room;
        features.extract(&self.cut(ink), config.input, &wanted);
        let input = &features.channels;
        values.clear();
        engines[0].run(scratch, input, &self.cells, |_, _, first| values.push(first));
        let (mut pixels, mut first) = (Vec::new(), values.iter());
        engines[1].run(scratch, input, &self.cells, |x, y, second: [f32; 4]| {
            let first = first.next().expect("the same pixels in the same order");
            if let Some(index) = self.number(x, y) {
                let base = features.base(y * self.size.0 + x).unwrap_or_default();
                let mean = std::array::from_fn(|k| 0.5 * (first[k] + second[k]));
                pixels.push(self.pixel(index, mean, base));
            }
        });
        pixels
    }

    #[cfg(feature = "train")]
    fn by_library(&self, networks: &[Within; 2], device: &Device, ink: &Shown, config: UNetConfig) -> Vec<Pixel> {
        let Features { channels, base } = features(&self.cut(ink), config.input);
        let (width, height) = self.size;
        let n = width * height;
        let data = TensorData::new(channels, [1, config.input.channels(), height, width]);
        let active = TensorData::new(self.cells.shares(), [1, 1, self.cells.rows, self.cells.columns]);
        let (input, active) = (Tensor::from_data(data, device), Tensor::from_data(active, device));
        let sum = networks[0].forward(input.clone(), &active) + networks[1].forward(input, &active);
        let output = sum.mul_scalar(0.5).into_data().try_into_vec::<f32>().expect("the network computes in f32");
        let of_pixel = |i: usize| {
            let base = if base.is_empty() { [0.0; 4] } else { [0, 1, 2, 3].map(|k| base[k * n + i]) };
            let index = self.number(i % width, i / width)?;
            Some(self.pixel(index, [0, 1, 2, 3].map(|k| output[k * n + i]), base))
        };
        (0..n).filter_map(of_pixel).collect()
    }
}

/// The columns and rows from the first to the last that has ink.
fn inked(mask: &Mask) -> [Range<usize>; 2] {
    let mut bounds: Option<[Range<usize>; 2]> = None;
    for y in 0..mask.height() {
        for run in runs(mask.row(y)) {
            let [columns, rows] = bounds.unwrap_or([run.clone(), y..y]);
            bounds = Some([columns.start.min(run.start)..columns.end.max(run.end), rows.start..y + 1]);
        }
    }
    bounds.unwrap_or_default()
}

/// The runs of ink in a core and so many pixels around it, each with its row.
fn runs_around(
    mask: &Mask,
    at: (usize, usize),
    core: (usize, usize),
    margin: usize,
) -> impl Iterator<Item = (Range<usize>, usize)> {
    let span = |at: usize, core: usize, n: usize| at.saturating_sub(margin)..(at + core + margin).min(n);
    let (columns, rows) = (span(at.0, core.0, mask.width()), span(at.1, core.1, mask.height()));
    rows.flat_map(move |y| {
        let left = columns.start;
        runs(&mask.row(y)[columns.clone()]).map(move |run| (run.start + left..run.end + left, y))
    })
}

/// Modulus of the larger root of `w^2 + c2 w + c0`.
fn strong_root(c0: Complex32, c2: Complex32) -> f32 {
    let root = (c2 * c2 - 4.0 * c0).sqrt();
    0.5 * (root - c2).norm().max((root + c2).norm())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clean::clean;
    use crate::load::Scan;
    use crate::options::Options;

    fn inked(ink: Raster<f32>) -> LineImage {
        let mask = ink.map(|i| i > 0.5);
        let depth = mask.map(|m| if m { 1.0 } else { 0.0 });
        let paper = Scan { gray: Raster::filled(1, 1, 1.0), rgb: None, dpi: None };
        LineImage { ink, mask, depth, line_width: 3.0, scale: 1.0, ..clean(&paper, &Options::default()) }
    }

    /// Rings about a point, some of them cut off.
    fn rings(width: usize, height: usize) -> LineImage {
        inked(Raster::from_fn(width, height, |x, y| {
            let r = (x as f32 - 60.0).hypot(y as f32 - 50.0);
            (2.0 - (r.rem_euclid(40.0) - 20.0).abs()).clamp(0.0, 1.0)
        }))
    }

    #[test]
    fn every_size_of_image_gets_a_field_on_its_ink() {
        let net = UNet::built_in().unwrap();
        for (width, height) in [(1, 1), (7, 300), (64, 64), (301, 290)] {
            let image = rings(width, height);
            let field = net.estimate(&image).unwrap();
            assert_eq!(field.size(), (width, height));
            assert!(image.mask.data().iter().zip(field.confidence().data()).all(|(m, c)| !m || *c > 0.0));
        }
    }

    #[test]
    fn blank_paper_has_no_field() {
        let blank = inked(Raster::filled(50, 40, 0.0));
        let field = UNet::built_in().unwrap().estimate(&blank).unwrap();
        assert!(field.confidence().data().iter().all(|c| *c == 0.0));
    }
}
