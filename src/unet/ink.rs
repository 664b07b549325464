//! The ink of a page, by the network that was trained to see it.

use super::config::{Output, UNetConfig};
use super::engine::{Engine, Scratch, TileCells};
use super::weights::Weights;
use crate::cancel::Cancel;
use crate::error::Result;
use crate::load::Scan;
use crate::raster::Raster;
use rayon::prelude::*;

/// Largest side of the part of a tile that is kept, in pixels: the larger, the less is computed twice.
const CORE: usize = 544;

/// Pixels around a tile's core that the network also sees. Training shows it crops of little more than twice as much.
const HALO: usize = 48;

/// A colour is taken less this, so that the network's input is centred.
pub(crate) const MIDDLE: f32 = 0.5;

/// A network that sees ink on raw pages, whatever their paper, light and noise.
#[derive(Clone, Debug)]
pub struct InkNet {
    config: UNetConfig,
    engine: Engine,
}

impl InkNet {
    /// The network that the program carries.
    ///
    /// # Errors
    /// [`crate::Error::Weights`] never, unless the program was built around a broken file.
    pub fn built_in() -> Result<Self> {
        Self::new(&Weights::built_in_ink()?)
    }

    /// The network of some weights.
    ///
    /// # Errors
    /// [`crate::Error::Weights`] when they are not all there or those of a network that sees something else.
    pub fn new(weights: &Weights) -> Result<Self> {
        let config = weights.config();
        if config.output != Output::Ink {
            return Err(weights.failed("holds no network that sees ink"));
        }
        Ok(Self { config, engine: Engine::new(weights)? })
    }

    /// How much of each pixel is ink, 0 to 1; of the page's size.
    ///
    /// # Errors
    /// [`crate::Error::Cancelled`] as soon as `cancel` says so.
    pub fn coverage(&self, page: &Scan, cancel: &Cancel) -> Result<Raster<f32>> {
        let logits = self.logits(page, cancel)?;
        Ok(logits.mapped(0.0, |l| 1.0 / (1.0 + (-l).exp())))
    }

    /// The log-odds of ink of each pixel; of the page's size.
    ///
    /// # Errors
    /// [`crate::Error::Cancelled`] as soon as `cancel` says so.
    pub fn logits(&self, page: &Scan, cancel: &Cancel) -> Result<Raster<f32>> {
        let (width, height) = page.gray.size();
        let mut out = Raster::filled(width, height, 0.0);
        let tiles: Vec<Tile> = Tile::all((width, height), self.config.multiple()).collect();
        let run = |scratch: &mut Scratch, tile: &Tile| {
            cancel.check()?;
            Ok(self.run(scratch, tile, page))
        };
        let parts: Vec<Vec<f32>> = tiles.par_iter().map_init(Scratch::default, run).collect::<Result<_>>()?;
        for (tile, part) in tiles.iter().zip(parts) {
            for (y, row) in part.chunks_exact(tile.core.0).enumerate() {
                let start = (tile.at.1 + y) * width + tile.at.0;
                out.data_mut()[start..start + row.len()].copy_from_slice(row);
            }
        }
        Ok(out)
    }

    /// The log-odds in a tile's core, row by row.
    fn run(&self, scratch: &mut Scratch, tile: &Tile, page: &Scan) -> Vec<f32> {
        let (columns, rows) = (tile.size.0 / self.config.multiple(), tile.size.1 / self.config.multiple());
        let cells = TileCells::new(columns, rows, vec![true; columns * rows]);
        let (width, height) = tile.core;
        let mut core = vec![0.0; width * height];
        self.engine.run(scratch, &tile.input(page), &cells, |x, y, [logit]| {
            // Pixels before the core become numbers beyond any size.
            let (x, y) = (x.wrapping_sub(HALO), y.wrapping_sub(HALO));
            if x < width && y < height {
                core[y * width + x] = logit;
            }
        });
        core
    }
}

/// A part of a page with what lies around it.
struct Tile {
    /// Top left corner of the part that is kept.
    at: (usize, usize),
    /// Its width and height.
    core: (usize, usize),
    /// Width and height with the halo, multiples of what the network asks for.
    size: (usize, usize),
}

impl Tile {
    /// The tiles of a page of a size.
    fn all((width, height): (usize, usize), multiple: usize) -> impl Iterator<Item = Self> {
        let step = |n: usize| n.div_ceil(n.div_ceil(CORE).max(1)).max(1);
        let (w, h) = (step(width), step(height));
        let side = move |n: usize| (n + 2 * HALO).next_multiple_of(multiple);
        let tile = move |x: usize, y: usize| {
            let core = (w.min(width - x), h.min(height - y));
            Self { at: (x, y), core, size: (side(w), side(h)) }
        };
        (0..height).step_by(h).flat_map(move |y| (0..width).step_by(w).map(move |x| tile(x, y)))
    }

    /// What the network is shown, `[3, height, width]`; beyond its edges the page is mirrored.
    fn input(&self, page: &Scan) -> Vec<f32> {
        let (width, height) = page.gray.size();
        let xs: Vec<usize> = (0..self.size.0).map(|x| mirrored(self.at.0 + x, width)).collect();
        let ys: Vec<usize> = (0..self.size.1).map(|y| mirrored(self.at.1 + y, height)).collect();
        let mut input = Vec::with_capacity(3 * xs.len() * ys.len());
        for channel in 0..3 {
            for &y in &ys {
                input.extend(xs.iter().map(|&x| {
                    let value = page.rgb.as_ref().map(|rgb| rgb.get_pixel(x as u32, y as u32).0[channel]);
                    value.map_or(page.gray[(x, y)], |v| f32::from(v) / 255.0) - MIDDLE
                }));
            }
        }
        input
    }
}

/// The place in `0..n` that shows at a place which is counted from [`HALO`] before the first.
fn mirrored(place: usize, n: usize) -> usize {
    let place = if place < HALO { HALO - 1 - place } else { place - HALO };
    let around = place % (2 * n);
    if around < n { around } else { 2 * n - 1 - around }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_is_mirrored_at_its_edges() {
        let seen: Vec<usize> = (HALO - 3..HALO + 8).map(|p| mirrored(p, 4)).collect();
        assert_eq!(seen, [2, 1, 0, 0, 1, 2, 3, 3, 2, 1, 0]);
    }

    #[test]
    fn the_built_in_network_sees_a_line_on_grey_paper() {
        let line = |y: usize| if (30..34).contains(&y) { 0.2 } else { 0.8 };
        let page = Scan { gray: Raster::from_fn(120, 64, |_, y| line(y)), rgb: None, dpi: None };
        let ink = InkNet::built_in().unwrap().coverage(&page, &Cancel::default()).unwrap();
        assert!(ink[(60, 31)] > 0.5 && ink[(60, 32)] > 0.5, "{} {}", ink[(60, 31)], ink[(60, 32)]);
        assert!(ink[(60, 10)] < 0.3 && ink[(60, 54)] < 0.3, "{} {}", ink[(60, 10)], ink[(60, 54)]);
    }

    #[test]
    fn tiles_cover_each_pixel_once() {
        for size in [(1, 1), (700, 40), (1200, 1090)] {
            let mut count = Raster::filled(size.0, size.1, 0);
            for tile in Tile::all(size, 32) {
                assert!(tile.size.0.is_multiple_of(32) && tile.core.0 + 2 * HALO <= tile.size.0);
                for y in tile.at.1..tile.at.1 + tile.core.1 {
                    (tile.at.0..tile.at.0 + tile.core.0).for_each(|x| count[(x, y)] += 1);
                }
            }
            assert!(count.data().iter().all(|n| *n == 1));
        }
    }
}
