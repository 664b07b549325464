//! Batches, made while the network trains on the ones before.

use super::config::TrainConfig;
use super::ink;
use super::source::{Sight, Source, View, sight};
use super::turn::Turn;
use crate::ground_truth::{FieldTruth, Place};
use crate::raster::Raster;
use crate::unet::{Features, Input, Output, features};
use num_complex::Complex32;
use rand::seq::SliceRandom;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, sync_channel};
use std::thread;

/// Added to the squared distance of two roots before it divides: near double roots have no better angle.
const DOUBLE: f32 = 0.1;

/// How much both directions count where two curves share a pixel.
const SHARED: f32 = 6.0;

/// How much the second direction counts where nothing shows it.
const UNSEEN: f32 = 0.2;

/// An image with its truth, or a crop of one. Where ink is trained, `target` is its coverage, `[1, height, width]`, and
/// what follows the input is otherwise empty.
#[derive(Clone, Debug, Default)]
pub struct Sample {
    /// Network input, `[channels, height, width]`.
    pub input: Vec<f32>,
    /// The field that the network corrects, `[4, height, width]`.
    pub base: Vec<f32>,
    /// True `Re c0`, `Im c0`, `Re c2`, `Im c2`, `[4, height, width]`.
    pub target: Vec<f32>,
    /// Squared true directions `Re u^2`, `Im u^2`, `Re v^2`, `Im v^2`, `[4, height, width]`.
    pub roots: Vec<f32>,
    /// Ink 0 or 1, then the weights of `u` and of `v` in the angle, `[3, height, width]`.
    pub weights: Vec<f32>,
}

impl Sample {
    pub(super) fn planes(&self) -> [&Vec<f32>; 5] {
        [&self.input, &self.base, &self.target, &self.roots, &self.weights]
    }

    pub(super) fn planes_mut(&mut self) -> [&mut Vec<f32>; 5] {
        [&mut self.input, &mut self.base, &mut self.target, &mut self.roots, &mut self.weights]
    }

    /// An image of ink with the truth of its drawing.
    pub fn new(ink: &Raster<f32>, truth: &FieldTruth, input: Input) -> Self {
        let n = ink.data().len();
        let Features { channels, mut base } = features(ink, input);
        base.resize(4 * n, 0.0);
        let mut target = vec![0.0; 4 * n];
        let mut roots = vec![0.0; 4 * n];
        let mut weights = vec![0.0; 3 * n];
        for i in 0..n {
            let place = truth.place.data()[i];
            if place == Place::Paper {
                continue;
            }
            let (u, v) = (truth.tangent.data()[i], unit(truth.other.data()[i]));
            let planes = |a: Complex32, b: Complex32| [a.re, a.im, b.re, b.im];
            let coefficients = planes(truth.field.c0().data()[i], truth.field.c2().data()[i]);
            for (k, (c, r)) in coefficients.into_iter().zip(planes(u, v)).enumerate() {
                target[k * n + i] = c;
                roots[k * n + i] = r;
            }
            let angle = 1.0 / ((u - v).norm_sqr() + DOUBLE).sqrt();
            weights[i] = 1.0;
            let (first, second) = if place == Place::Shared { (SHARED, SHARED) } else { (1.0, UNSEEN) };
            weights[n + i] = first * angle;
            weights[2 * n + i] = second * angle;
        }
        Self { input: channels, base, target, roots, weights }
    }

    /// The square `[x, x + crop) x [y, y + crop)` of a sample of a size.
    pub(super) fn cropped(&self, (width, height): (usize, usize), x: usize, y: usize, crop: usize) -> Self {
        let mut out = Self::default();
        for (from, to) in self.planes().into_iter().zip(out.planes_mut()) {
            for plane in from.chunks_exact(width * height) {
                for row in plane.chunks_exact(width).skip(y).take(crop) {
                    to.extend_from_slice(&row[x..x + crop]);
                }
            }
        }
        out
    }

    /// Many samples one after the other, as one tensor each.
    pub fn stacked(samples: impl IntoIterator<Item = Self>) -> Self {
        let mut out = Self::default();
        for mut sample in samples {
            for (from, to) in sample.planes_mut().into_iter().zip(out.planes_mut()) {
                to.append(from);
            }
        }
        out
    }
}

fn unit(z: Complex32) -> Complex32 {
    if z.norm() > 1e-6 { z / z.norm() } else { z }
}

/// The random numbers of a seed's sheet, step or epoch.
pub(super) fn stream(seed: u64, number: u64) -> ChaCha8Rng {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(number);
    rng
}

/// The sheet that random numbers draw for training.
pub(super) fn sheet(rng: &mut ChaCha8Rng, source: &Source, config: &TrainConfig) -> Sight {
    sight(rng, source, config, |rng| {
        let mut left = rng.random::<f64>();
        let drawn = config.views().rev().find(|(_, share)| {
            left -= share;
            left < 0.0
        });
        drawn.map_or(View::Clean, |(view, _)| view)
    })
}

/// The crops of one drawing. The same seed and number give the same crops.
fn crops(config: &TrainConfig, source: &Source, number: u64) -> Vec<Sample> {
    let mut rng = stream(config.seed, number);
    if config.network.output == Output::Ink {
        return ink::crops(&mut rng, source, config);
    }
    let Sight { ink, truth } = sheet(&mut rng, source, config);
    let whole = Sample::new(&ink, &truth, config.network.input);
    let (width, height) = ink.size();
    let mut spots = || (rng.random_range(0..=width - config.crop), rng.random_range(0..=height - config.crop));
    let inked = |x: usize, y: usize| {
        let rows = y..y + config.crop;
        rows.map(|y| truth.ink.row(y)[x..x + config.crop].iter().filter(|i| **i).count()).sum::<usize>()
    };
    (0..config.crops_a_sheet)
        .map(|_| {
            // Of a few spots the first with some ink on it.
            let tries: Vec<_> = (0..6).map(|_| spots()).collect();
            let (x, y) = *tries.iter().find(|(x, y)| inked(*x, *y) > 60).unwrap_or(&tries[0]);
            whole.cropped((width, height), x, y, config.crop)
        })
        .collect()
}

/// The numbers of the sheets of a step.
fn sheets(config: &TrainConfig, step: usize) -> Vec<u64> {
    let count = config.batch / config.crops_a_sheet;
    let numbers = step * count..(step + 1) * count;
    if config.images == 0 {
        return numbers.map(|n| n as u64).collect();
    }
    let mut epoch = (usize::MAX, Vec::new());
    let number = |n: usize| {
        let (pass, place) = (n / config.images, n % config.images);
        if epoch.0 != pass {
            let mut order: Vec<u64> = (0..config.images as u64).collect();
            order.shuffle(&mut stream(config.seed ^ 0x0bde_2ed0, pass as u64));
            epoch = (pass, order);
        }
        epoch.1[place]
    };
    numbers.map(number).collect()
}

/// The crops of a step's sheets as one sample, each laid down at random where the configuration says so.
fn joined(config: &TrainConfig, step: usize, crops: impl Iterator<Item = Sample>) -> Sample {
    let mut rng = stream(config.seed ^ 0x7042_0a11, step as u64);
    Sample::stacked(crops.map(|c| if config.turns { c.turned(Turn::draw(&mut rng), config.crop) } else { c }))
}

/// The batch of a step.
pub fn batch(config: &TrainConfig, source: &Source, step: usize) -> Sample {
    let sheets = sheets(config, step).into_par_iter();
    let parts: Vec<Vec<Sample>> = sheets.map(|n| crops(config, source, n)).collect();
    joined(config, step, parts.into_iter().flatten())
}

/// Batches of a range of steps, in order, a few ahead of the reader.
pub fn batches(config: &TrainConfig, source: &Arc<Source>, steps: Range<usize>) -> Receiver<Sample> {
    let (sender, receiver) = sync_channel(4);
    let (config, source) = (config.clone(), source.clone());
    thread::spawn(move || {
        let set: Vec<Vec<Sample>> =
            (0..config.images as u64).into_par_iter().map(|n| crops(&config, &source, n)).collect();
        for step in steps {
            let sample = if set.is_empty() {
                batch(&config, &source, step)
            } else {
                joined(&config, step, sheets(&config, step).into_iter().flat_map(|n| set[n as usize].clone()))
            };
            if sender.send(sample).is_err() {
                return;
            }
        }
    });
    receiver
}
