//! The network without a tensor library, for inference on the CPU: channels last, norms folded into the convolutions,
//! and nothing computed far from ink.
//!
//! Pixels that are not computed hold what the network gives on blank paper, so that at the edge of what is computed
//! the convolutions read what they would have read.

mod conv;
mod plane;
mod squares;

use super::model::{Block, UNet, UNetConfig};
use burn::module::Param;
use burn::nn::BatchNorm;
use burn::nn::conv::Conv2d;
use burn::tensor::Tensor;
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
    blank: Option<Vec<Vec<f32>>>,
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
    pub fn new(config: UNetConfig, model: &UNet) -> Self {
        let cells = config.patch * config.patch;
        let stored = |n: usize| (0..n.next_multiple_of(BLOCK)).map(|i| (i < n).then_some(i)).collect::<Vec<_>>();
        let width = |level: usize| config.width << level;
        let input: Vec<_> = (0..config.input.channels() * cells).map(Some).collect();
        let mut down = vec![block(&model.down[0], &input)];
        down.extend((1..=config.levels).map(|l| block(&model.down[l], &stored(width(l - 1)))));
        let up = model.up.iter().zip((0..config.levels).rev()).map(|(b, l)| {
            let (low, skip) = (width(l + 1), width(l));
            let mut source = stored(low);
            source.extend(stored(skip).into_iter().map(|i| i.map(|i| low + i)));
            block(b, &source)
        });
        let bias = model.head.bias.as_ref().map_or_else(|| vec![0.0; 4 * cells], numbers);
        let up = up.collect();
        let head = Conv::new(1, &numbers(&model.head.weight), &bias, &stored(config.width), false);
        let mut engine = Self { config, arch: Arch::new(), down, up, head, blank: None };
        engine.blank = Some(engine.blank_values());
        engine
    }

    /// Computes the active cells of a tile.
    ///
    /// `input` is `[channels, height, width]` and `cells` has one cell for [`UNetConfig::multiple`] pixels each way.
    /// Calls `put(x, y, [Re c0, Im c0, Re c2, Im c2])` with the output at every pixel of an active cell.
    pub fn run(
        &self,
        scratch: &mut Scratch,
        input: &[f32],
        cells: &TileCells,
        mut put: impl FnMut(usize, usize, [f32; 4]),
    ) {
        self.prepare(scratch, cells);
        self.unshuffle(&mut scratch.planes[0], input, cells);
        self.forward(&mut scratch.planes, cells, |_| ());
        let p = self.config.patch;
        let last = scratch.planes.last().expect("the head's output");
        cells.runs(1 << self.config.levels, |x, y, n| {
            for (i, values) in last.pixels(x, y, n).chunks_exact(last.channels).enumerate() {
                for (dy, dx) in (0..p).flat_map(|dy| (0..p).map(move |dx| (dy, dx))) {
                    let at = |k: usize| values[k * p * p + dy * p + dx];
                    put((x + i) * p + dx, y * p + dy, [at(0), at(1), at(2), at(3)]);
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
        let Some(blank) = &self.blank else { return };
        for (plane, values) in scratch.planes.iter_mut().zip(blank) {
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

fn block(block: &Block, source: &[Option<usize>]) -> [Conv; 2] {
    let first = folded(&block.conv1, &block.norm1, source);
    let n = block.norm1.gamma.dims()[0];
    let middle: Vec<_> = (0..first.output).map(|i| (i < n).then_some(i)).collect();
    [first, folded(&block.conv2, &block.norm2, &middle)]
}

/// `gamma (W x - mean) / sqrt(var + epsilon) + beta` as one convolution.
fn folded(conv: &Conv2d, norm: &BatchNorm, source: &[Option<usize>]) -> Conv {
    let mut weights = numbers(&conv.weight);
    let [gamma, beta] = [&norm.gamma, &norm.beta].map(numbers);
    let [mean, var] = [&norm.running_mean, &norm.running_var].map(|s| data(s.value()));
    let scale: Vec<f32> = gamma.iter().zip(&var).map(|(g, v)| g / (v + norm.epsilon as f32).sqrt()).collect();
    let bias: Vec<f32> = beta.iter().zip(&mean).zip(&scale).map(|((b, m), s)| b - m * s).collect();
    let filter = weights.len() / scale.len();
    weights.chunks_exact_mut(filter).zip(&scale).for_each(|(w, s)| w.iter_mut().for_each(|w| *w *= s));
    Conv::new(3, &weights, &bias, source, true)
}

fn numbers<const D: usize>(param: &Param<Tensor<D>>) -> Vec<f32> {
    data(param.val())
}

fn data<const D: usize>(tensor: Tensor<D>) -> Vec<f32> {
    tensor.into_data().try_into_vec().expect("weights are f32")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::unet::Input;
    use burn::tensor::{Device, Distribution, TensorData};

    /// A network whose norms are not the identity.
    fn network(config: &UNetConfig) -> UNet {
        let device = Device::flex();
        device.seed(3);
        let mut model = config.init(&device.clone().autodiff(), 3);
        for _ in 0..3 {
            let side = 2 * config.multiple();
            let x = Tensor::<4>::random([2, config.input.channels(), side, side], Distribution::Default, &device);
            let x = Tensor::from_data(x.into_data(), &device.clone().autodiff());
            let _ = model.forward(x);
        }
        model = burn::module::Module::valid(&model);
        model
    }

    fn compare(config: UNetConfig) -> f32 {
        let device = Device::flex();
        let model = network(&config);
        let (columns, rows, m) = (3, 2, config.multiple());
        let (width, height) = (columns * m, rows * m);
        let shape = [1, config.input.channels(), height, width];
        let x = Tensor::<4>::random(shape, Distribution::Default, &device).into_data();
        let input = x.clone().try_into_vec::<f32>().unwrap();
        let truth = model.forward(Tensor::from_data(TensorData::new(input.clone(), shape), &device));
        let truth = truth.into_data().try_into_vec::<f32>().unwrap();
        let cells = TileCells::new(columns, rows, vec![true; columns * rows]);
        let mut worst = 0.0f32;
        let n = width * height;
        let mut seen = 0;
        Engine::new(config, &model).run(&mut Scratch::default(), &input, &cells, |x, y, values| {
            seen += 1;
            for (k, v) in values.into_iter().enumerate() {
                worst = worst.max((v - truth[k * n + y * width + x]).abs());
            }
        });
        assert_eq!(seen, n);
        worst
    }

    #[test]
    fn the_engine_agrees_with_the_tensor_library() {
        for (width, levels, patch, input) in [(16, 2, 2, Input::Tensor), (8, 2, 1, Input::Ink), (12, 1, 2, Input::Ink)]
        {
            let worst = compare(UNetConfig { width, levels, patch, input, ..UNetConfig::default() });
            assert!(worst < 1e-4, "w{width} d{levels} p{patch}: {worst}");
        }
    }

    #[test]
    fn what_is_not_computed_counts_as_blank() {
        let config = UNetConfig { width: 16, levels: 2, patch: 2, input: Input::Ink, ..UNetConfig::default() };
        let engine = Engine::new(config, &network(&config));
        let (n, m) = (17, config.multiple());
        let side = n * m;
        // A dot in the middle cell; cells near it are computed in one run, all cells in the other.
        let mut input = vec![0.0f32; side * side];
        input[(side / 2) * side + side / 2] = 1.0;
        let field = |active: Vec<bool>| {
            let mut out = vec![[0.0f32; 4]; side * side];
            let cells = TileCells::new(n, n, active);
            engine.run(&mut Scratch::default(), &input, &cells, |x, y, v| out[y * side + x] = v);
            out[(side / 2) * side + side / 2]
        };
        let near = |i: usize| (i % n).abs_diff(n / 2) <= 5 && (i / n).abs_diff(n / 2) <= 5;
        let (all, some) = (field(vec![true; n * n]), field((0..n * n).map(near).collect()));
        assert!(all.iter().zip(&some).all(|(a, b)| (a - b).abs() < 1e-4), "{all:?} {some:?}");
    }
}
