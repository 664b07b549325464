//! Pages to train on.

use super::super::config::TrainConfig;
use super::super::data::Sample;
use super::super::source::Source;
use crate::raster::Raster;
use crate::render::render;
use crate::synth::{self, Kind, Page};
use crate::unet::MIDDLE;
use rand::Rng;
use rand_chacha::ChaCha8Rng;

/// Share of a sheet that is some ink.
const INKED: f32 = 0.02;

/// A page of a kind.
pub(super) fn page(rng: &mut ChaCha8Rng, source: &Source, config: &TrainConfig, kind: Kind) -> Page {
    // Of a few drawings the first with some ink on it.
    let mut drawing = source.drawing(rng, config);
    for _ in 0..3 {
        if render(&drawing).data().iter().sum::<f32>() > INKED * (config.sheet * config.sheet) as f32 {
            break;
        }
        drawing = source.drawing(rng, config);
    }
    let other = source.drawing(rng, config);
    synth::page(rng, kind, drawing, &other)
}

/// The crops of one page, drawn or of one's own.
pub(in super::super) fn crops(rng: &mut ChaCha8Rng, source: &Source, config: &TrainConfig) -> Vec<Sample> {
    if rng.random_bool(config.page_share)
        && let Some(page) = source.page(rng)
    {
        return (0..config.crops_a_sheet).map(|_| page.crop(rng, config.crop)).collect();
    }
    let kind = Kind::draw(rng, &config.held_out);
    let page = page(rng, source, config, kind);
    let whole = Sample::of_page(&page.color, &page.ink);
    let (width, height) = page.ink.size();
    (0..config.crops_a_sheet)
        .map(|_| {
            let x = rng.random_range(0..=width - config.crop);
            let y = rng.random_range(0..=height - config.crop);
            whole.cropped((width, height), x, y, config.crop)
        })
        .collect()
}

impl Sample {
    /// The red, green and blue of a page with its ink.
    pub fn of_page(color: &[Raster<f32>; 3], ink: &Raster<f32>) -> Self {
        // Images have 256 steps.
        let stored = |v: &f32| (v * 255.0).round() / 255.0 - MIDDLE;
        let input = color.iter().flat_map(|plane| plane.data().iter().map(stored)).collect();
        Self { input, target: ink.data().to_vec(), ..Self::default() }
    }
}
