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
            for (y, row) in part.chunks_exact(tile.across.kept).enumerate() {
                let start = (tile.down.core + y) * width + tile.across.core;
                out.data_mut()[start..start + row.len()].copy_from_slice(row);
            }
        }
        Ok(out)
    }

    /// The log-odds in a tile's core, row by row.
    fn run(&self, scratch: &mut Scratch, tile: &Tile, page: &Scan) -> Vec<f32> {
        let Tile { across, down } = tile;
        let (columns, rows) = (across.size / self.config.multiple(), down.size / self.config.multiple());
        let cells = TileCells::new(columns, rows, vec![true; columns * rows]);
        let (width, height) = (across.kept, down.kept);
        let mut core = vec![0.0; width * height];
        self.engine.run(scratch, &tile.input(page), &cells, |x, y, [logit]| {
            // Pixels before the core become numbers beyond any size.
            let (x, y) = ((across.start + x).wrapping_sub(across.core), (down.start + y).wrapping_sub(down.core));
            if x < width && y < height {
                core[y * width + x] = logit;
            }
        });
        core
    }
}

/// A part of a page with what lies around it.
struct Tile {
    across: Span,
    down: Span,
}

impl Tile {
    /// The tiles of a page of a size.
    fn all((width, height): (usize, usize), multiple: usize) -> impl Iterator<Item = Self> {
        let columns: Vec<Span> = Span::all(width, multiple).collect();
        Span::all(height, multiple)
            .flat_map(move |down| columns.clone().into_iter().map(move |across| Self { across, down }))
    }

    /// What the network is shown, `[3, height, width]`.
    fn input(&self, page: &Scan) -> Vec<f32> {
        let (width, height) = page.gray.size();
        let xs: Vec<usize> = self.across.places(width).collect();
        let ys: Vec<usize> = self.down.places(height).collect();
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

/// A tile along one side of a page. At the page's edges it ends, as the pages do that training shows.
#[derive(Clone, Copy, Debug)]
struct Span {
    /// The first pixel of what the network is shown, and their number: a multiple of what it asks for.
    start: usize,
    size: usize,
    /// The first pixel that is kept, and their number.
    core: usize,
    kept: usize,
}

impl Span {
    /// The spans of a side of `n` pixels.
    fn all(n: usize, multiple: usize) -> impl Iterator<Item = Self> {
        let step = n.div_ceil(n.div_ceil(CORE).max(1)).max(1);
        (0..n).step_by(step).map(move |core| {
            let kept = step.min(n - core);
            let (start, end) = (core.saturating_sub(HALO), (core + kept + HALO).min(n));
            let size = (end - start).next_multiple_of(multiple);
            Self { start: start.min(n.saturating_sub(size)), size, core, kept }
        })
    }

    /// The pixels of a side of `n`; where they do not fill the span, the last are shown again, mirrored.
    fn places(self, n: usize) -> impl Iterator<Item = usize> {
        (self.start..self.start + self.size).map(move |place| {
            let around = place % (2 * n);
            if around < n { around } else { 2 * n - 1 - around }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_that_does_not_fill_its_tile_is_mirrored() {
        let span = Span { start: 0, size: 11, core: 0, kept: 4 };
        assert_eq!(span.places(4).collect::<Vec<_>>(), [0, 1, 2, 3, 3, 2, 1, 0, 0, 1, 2]);
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
    fn tiles_cover_each_pixel_once_and_see_what_is_around_it() {
        for n in [1, 40, 544, 545, 700, 1090, 1200] {
            let mut count = vec![0; n];
            for span in Span::all(n, 32) {
                assert!(span.size.is_multiple_of(32) && (span.start == 0 || span.start + span.size <= n));
                assert!(span.start <= span.core.saturating_sub(HALO));
                assert!(span.start + span.size >= (span.core + span.kept + HALO).min(n));
                (span.core..span.core + span.kept).for_each(|x| count[x] += 1);
            }
            assert!(count.iter().all(|n| *n == 1), "{n}");
        }
    }
}
