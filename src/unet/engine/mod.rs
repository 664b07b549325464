//! The network without a tensor library, for inference on the CPU: channels last, norms folded into the convolutions,
//! and nothing computed far from ink.
//!
//! Pixels that are not computed hold what the network gives on blank paper, so that at the edge of what is computed
//! the convolutions read what they would have read.

mod conv;
mod plane;
mod squares;

use super::config::{EPSILON, UNetConfig};
use super::weights::{Numbers, Weights};
use crate::error::Result;
use conv::Conv;
pub(crate) use plane::Cells as TileCells;
use plane::{BLOCK, Plane};
use pulp::Arch;

/// A network ready to run.
#[derive(Clone, Debug)]
pub(crate) struct Engine {
    config: UNetConfig,
    arch: Arch,
    down: Vec<[Conv; 2]>,
    up: Vec<[Conv; 2]>,
    head: Conv,
    /// What each plane holds on blank paper, in the order of [`Scratch`].
    blank: Vec<Vec<f32>>,
}

/// The feature maps of one tile; to be reused from tile to tile.
#[derive(Clone, Debug, Default)]
pub(crate) struct Scratch {
    size: (usize, usize),
    /// Input, then per level: what the block reads (from the second level on), its middle and its end; then per
    /// level upwards what the block reads, its middle and its end; then the head's output.
    planes: Vec<Plane>,
}

impl Engine {
    /// Folds and packs the weights of a network.
    ///
    /// # Errors
    /// [`crate::Error::Weights`] when some are missing or of another shape than the network's.
    pub fn new(weights: &Weights) -> Result<Self> {
        let (config, numbers) = (weights.config(), weights.numbers()?);
        let stored = |n: usize| (0..n.next_multiple_of(BLOCK)).map(|i| (i < n).then_some(i)).collect::<Vec<_>>();
        let mut down = Vec::new();
        for (i, [input, output]) in config.down().into_iter().enumerate() {
            let source = if i == 0 { (0..input).map(Some).collect() } else { stored(input) };
            down.push(block(&numbers, &format!("down.{i}"), &source, output)?);
        }
        let mut up = Vec::new();
        for (i, [low, skip, output]) in config.up().into_iter().enumerate() {
            let mut source = stored(low);
            source.extend(stored(skip).into_iter().map(|i| i.map(|i| low + i)));
            up.push(block(&numbers, &format!("up.{i}"), &source, output)?);
        }
        let outputs = config.outputs();
        let bias = numbers.get("head.bias", &[outputs])?;
        let head = numbers.get("head.weight", &[outputs, config.channels(0), 1, 1])?;
        let head = Conv::new(1, &head, &bias, &stored(config.channels(0)), false);
        let mut engine = Self { config, arch: Arch::new(), down, up, head, blank: Vec::new() };
        engine.blank = engine.blank_values();
        Ok(engine)
    }

    /// Computes the active cells of a tile.
    ///
    /// `input` is `[channels, height, width]` and `cells` has one cell for [`UNetConfig::multiple`] pixels each way.
    /// Calls `put(x, y, values)` with the output at every pixel of an active cell: `[Re c0, Im c0, Re c2, Im c2]`, or the
    /// log-odds of ink. `N` is the number of [`Output::channels`](super::Output::channels).
    pub fn run<const N: usize>(
        &self,
        scratch: &mut Scratch,
        input: &[f32],
        cells: &TileCells,
        mut put: impl FnMut(usize, usize, [f32; N]),
    ) {
        debug_assert_eq!(N, self.config.output.channels());
        self.prepare(scratch, cells);
        self.unshuffle(&mut scratch.planes[0], input, cells);
        self.forward(&mut scratch.planes, cells, |_| ());
        let p = self.config.patch;
        let last = scratch.planes.last().expect("the head's output");
        cells.runs(1 << self.config.levels, |x, y, n| {
            for (i, values) in last.pixels(x, y, n).chunks_exact(last.channels).enumerate() {
                for (dy, dx) in (0..p).flat_map(|dy| (0..p).map(move |dx| (dy, dx))) {
                    let values = std::array::from_fn(|k| values[k * p * p + dy * p + dx]);
                    put((x + i) * p + dx, y * p + dy, values);
                }
            }
        });
    }

    /// All planes of the right size, blank around what will be computed.
    fn prepare(&self, scratch: &mut Scratch, cells: &TileCells) {
        let size = (cells.columns, cells.rows);
        if scratch.size != size || scratch.planes.is_empty() {
            scratch.planes = self.planes(cells.columns, cells.rows);
            scratch.size = size;
        }
        for (plane, values) in scratch.planes.iter_mut().zip(&self.blank) {
            let side = plane.width / cells.columns;
            cells.rim_runs(side, |x, y, n| {
                plane.pixels_mut(x, y, n).chunks_exact_mut(values.len()).for_each(|p| p.copy_from_slice(values));
            });
        }
    }

    fn planes(&self, columns: usize, rows: usize) -> Vec<Plane> {
        let levels = self.config.levels;
        let plane =
            |level: usize, channels: usize| Plane::new(columns << (levels - level), rows << (levels - level), channels);
        let mut planes = vec![plane(0, self.config.input.channels() * self.config.patch * self.config.patch)];
        for (level, [first, second]) in self.down.iter().enumerate() {
            if level > 0 {
                planes.push(plane(level, self.down[level - 1][1].output));
            }
            planes.push(plane(level, first.output));
            planes.push(plane(level, second.output));
        }
        for ([first, second], level) in self.up.iter().zip((0..levels).rev()) {
            let low =
                if level + 1 == levels { self.down[levels][1].output } else { self.up[levels - level - 2][1].output };
            planes.push(plane(level, low + self.down[level][1].output));
            planes.push(plane(level, first.output));
            planes.push(plane(level, second.output));
        }
        planes.push(plane(0, self.head.output));
        planes
    }

    /// Copies `[channels, height, width]` so that the pixels of a patch become channels.
    fn unshuffle(&self, to: &mut Plane, input: &[f32], cells: &TileCells) {
        let p = self.config.patch;
        let (width, height) = (to.width * p, to.height * p);
        let channels = to.channels;
        cells.runs(1 << self.config.levels, |x, y, n| {
            let target = to.pixels_mut(x, y, n);
            for (c, plane) in input.chunks_exact(width * height).enumerate() {
                for dy in 0..p {
                    let row = &plane[(y * p + dy) * width + x * p..][..n * p];
                    for (i, patch) in row.chunks_exact(p).enumerate() {
                        let at = i * channels + c * p * p + dy * p;
                        target[at..at + p].copy_from_slice(patch);
                    }
                }
            }
        });
    }

    /// Fills all planes but the first; `done` gets each as soon as it is computed.
    fn forward(&self, planes: &mut [Plane], cells: &TileCells, done: impl Fn(&mut Plane)) {
        let levels = self.config.levels;
        let side = |level: usize| 1 << (levels - level);
        let (mut at, mut ends) = (0, Vec::new());
        for (level, convs) in self.down.iter().enumerate() {
            if level > 0 {
                let (from, to) = planes.split_at_mut(at + 1);
                pool(&from[at], &mut to[0], cells, side(level));
                done(&mut to[0]);
                at += 1;
            }
            at = self.block(planes, convs, at, cells, side(level), &done);
            ends.push(at);
        }
        for (convs, level) in self.up.iter().zip((0..levels).rev()) {
            let (from, to) = planes.split_at_mut(at + 1);
            join(&from[at], &from[ends[level]], &mut to[0], cells, side(level));
            done(&mut to[0]);
            at = self.block(planes, convs, at + 1, cells, side(level), &done);
        }
        let (from, to) = planes.split_at_mut(at + 1);
        self.head.run(self.arch, &from[at], &mut to[0], cells, side(0));
        done(&mut to[0]);
    }

    /// Two convolutions from plane `at`; the index of the plane with the result.
    fn block(
        &self,
        planes: &mut [Plane],
        convs: &[Conv; 2],
        at: usize,
        cells: &TileCells,
        side: usize,
        done: &impl Fn(&mut Plane),
    ) -> usize {
        for (i, conv) in convs.iter().enumerate() {
            let (from, to) = planes.split_at_mut(at + i + 1);
            conv.run(self.arch, &from[at + i], &mut to[0], cells, side);
            done(&mut to[0]);
        }
        at + 2
    }

    /// What each plane holds on blank paper: one cell is computed, and each plane goes on as it is there.
    fn blank_values(&self) -> Vec<Vec<f32>> {
        let mut planes = self.planes(1, 1);
        self.forward(&mut planes, &TileCells::new(1, 1, vec![true]), Plane::spread);
        planes.iter().map(|p| p.pixels(0, 0, 1).to_vec()).collect()
    }
}

/// 2x2 maximum of the active pixels; `side` is that of the lower level's cells.
fn pool(from: &Plane, to: &mut Plane, cells: &TileCells, side: usize) {
    let c = from.channels;
    cells.runs(side, |x, y, n| {
        let rows = [0, 1].map(|dy| from.pixels(2 * x, 2 * y + dy, 2 * n));
        for (i, out) in to.pixels_mut(x, y, n).chunks_exact_mut(c).enumerate() {
            let [a, b] = rows.map(|r| &r[2 * i * c..2 * (i + 1) * c]);
            for k in 0..c {
                out[k] = a[k].max(a[c + k]).max(b[k]).max(b[c + k]);
            }
        }
    });
}

/// The lower level, each pixel repeated, beside the skip.
fn join(low: &Plane, skip: &Plane, to: &mut Plane, cells: &TileCells, side: usize) {
    cells.runs(side, |x, y, n| {
        let (l, s) = (low.pixels(x / 2, y / 2, n.div_ceil(2)), skip.pixels(x, y, n));
        for (i, out) in to.pixels_mut(x, y, n).chunks_exact_mut(low.channels + skip.channels).enumerate() {
            let (a, b) = out.split_at_mut(low.channels);
            a.copy_from_slice(&l[(i / 2) * low.channels..][..low.channels]);
            b.copy_from_slice(&s[i * skip.channels..][..skip.channels]);
        }
    });
}

/// The convolutions of a block by its name, from the stored channels that `source` names.
fn block(numbers: &Numbers, name: &str, source: &[Option<usize>], output: usize) -> Result<[Conv; 2]> {
    let first = folded(numbers, name, 1, source, output)?;
    let middle: Vec<_> = (0..first.output).map(|i| (i < output).then_some(i)).collect();
    Ok([first, folded(numbers, name, 2, &middle, output)?])
}

/// `gamma (W x - mean) / sqrt(var + epsilon) + beta` as one convolution.
fn folded(numbers: &Numbers, block: &str, number: usize, source: &[Option<usize>], output: usize) -> Result<Conv> {
    let inputs = source.iter().flatten().count();
    let mut weights = numbers.get(&format!("{block}.conv{number}.weight"), &[output, inputs, 3, 3])?;
    let norm = |what: &str| numbers.get(&format!("{block}.norm{number}.{what}"), &[output]);
    let (gamma, beta, mean, var) = (norm("gamma")?, norm("beta")?, norm("running_mean")?, norm("running_var")?);
    let scale: Vec<f32> = gamma.iter().zip(&var).map(|(g, v)| g / (v + EPSILON as f32).sqrt()).collect();
    let bias: Vec<f32> = beta.iter().zip(&mean).zip(&scale).map(|((b, m), s)| b - m * s).collect();
    weights.chunks_exact_mut(9 * inputs).zip(&scale).for_each(|(w, s)| w.iter_mut().for_each(|w| *w *= s));
    Ok(Conv::new(3, &weights, &bias, source, true))
}

#[cfg(test)]
mod tests;
