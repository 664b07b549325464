//! Where drawings to train on come from, and how the network gets to see them.

use super::config::TrainConfig;
use super::ink::Stored;
use crate::drawing::Drawing;
use crate::error::{Error, Result};
use crate::estimate::StructureTensor;
use crate::ground_truth::{self, FieldTruth};
use crate::load::{LoadOptions, Scan, load};
use crate::options::Options;
use crate::pipeline::Vectorizer;
use crate::raster::Raster;
use crate::render::render;
use crate::synth::{self, Kind, ScanStyle};
use crate::unet::shown;
use image::{DynamicImage, Rgb, RgbImage};
use rand::Rng;
use rayon::prelude::*;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;
use walkdir::WalkDir;

/// Longer side in pixels that SVG drawings are read at; they are scaled from there.
const READ_SIDE: u32 = 512;

/// Drawings of others beside the synthetic ones, and pages with their ink.
#[derive(Clone, Debug, Default)]
pub struct Source {
    drawings: Vec<Drawing>,
    pages: Vec<Stored>,
}

/// A file that cannot be trained on, and why.
pub type Skipped = (PathBuf, String);

impl Source {
    /// Synthetic drawings alone.
    pub fn synthetic() -> Self {
        Self::default()
    }

    /// Synthetic drawings mixed with the strokes of the SVGs in a folder and the folders in it. Files that cannot be read
    /// or hold no strokes are left out and named.
    ///
    /// # Errors
    /// [`Error::Read`] when the folder cannot be listed; [`Error::Train`] when nothing in it has strokes.
    pub fn with_svgs(folder: &Path) -> Result<(Self, Vec<Skipped>)> {
        let read: Vec<_> = files(folder, "svg")?.into_par_iter().map(|path| (strokes_of(&path), path)).collect();
        let (mut drawings, mut skipped) = (Vec::new(), Vec::new());
        for (result, path) in read {
            match result {
                Ok(drawing) => drawings.push(drawing),
                Err(reason) => skipped.push((path, reason)),
            }
        }
        if drawings.is_empty() {
            return Err(Error::Train { reason: format!("{}: holds no SVG with strokes", folder.display()) });
        }
        Ok((Self { drawings, pages: Vec::new() }, skipped))
    }

    /// Adds the pages in a folder and the folders in it: `NAME.png`, its ink being black on white in `NAME.ink.png` or the
    /// strokes and solids of `NAME.svg`. Gives those that cannot be read, or are smaller than a side, which are left out.
    ///
    /// # Errors
    /// [`Error::Read`] when the folder cannot be listed; [`Error::Train`] when there is no page in it.
    pub fn add_pages(&mut self, folder: &Path, side: usize) -> Result<Vec<Skipped>> {
        let (pages, skipped) = Stored::read(folder, side)?;
        self.pages.extend(pages);
        Ok(skipped)
    }

    /// One of the pages, if there are any.
    pub(super) fn page(&self, rng: &mut impl Rng) -> Option<&Stored> {
        (!self.pages.is_empty()).then(|| &self.pages[rng.random_range(0..self.pages.len())])
    }

    /// Number of drawings by others.
    pub fn len(&self) -> usize {
        self.drawings.len()
    }

    /// Whether there are only synthetic drawings.
    pub fn is_empty(&self) -> bool {
        self.drawings.is_empty()
    }

    /// A sheet of some drawing.
    pub(super) fn drawing(&self, rng: &mut impl Rng, config: &TrainConfig) -> Drawing {
        if config.primitives > 0 {
            return synth::primitives(rng, config.sheet, config.primitives);
        }
        if !self.drawings.is_empty() && rng.random_bool(config.svg_share) {
            let drawing = &self.drawings[rng.random_range(0..self.drawings.len())];
            if let Some(sheet) = synth::placed(rng, drawing, config.sheet) {
                return sheet;
            }
        }
        synth::drawing(rng, config.sheet)
    }
}

/// What a drawing is seen on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum View {
    /// A render without noise.
    Clean,
    /// A gentle scan.
    Scan,
    /// A page of any kind, whose ink the network that is built in tells.
    Paper,
}

/// What the network sees of a drawing, and what is true there; both of one size.
#[derive(Clone, Debug)]
pub struct Sight {
    /// The ink, as cleaning gives it.
    pub ink: Raster<f32>,
    /// The field that it should see in it.
    pub truth: FieldTruth,
}

/// Draws until there is a sheet on which cleaning leaves something, no smaller than a crop; the view is drawn anew for each.
pub fn sight<R: Rng>(rng: &mut R, source: &Source, config: &TrainConfig, view: impl Fn(&mut R) -> View) -> Sight {
    loop {
        let drawing = source.drawing(rng, config);
        let seen = match view(rng) {
            View::Clean => clean_sheet(rng, drawing),
            View::Scan => scanned(rng, drawing),
            View::Paper => {
                let other = source.drawing(rng, config);
                on_paper(rng, drawing, &other, config)
            }
        };
        if let Some(sight) = seen.filter(|s| s.ink.width().min(s.ink.height()) >= config.crop) {
            return sight;
        }
    }
}

fn clean_sheet(rng: &mut impl Rng, drawing: Drawing) -> Option<Sight> {
    let gray = synth::clean_ink(rng, &render(&drawing)).map(|i| 1.0 - i);
    seen(&Scan { gray, rgb: None, dpi: None }, drawing)
}

fn scanned(rng: &mut impl Rng, drawing: Drawing) -> Option<Sight> {
    let style = ScanStyle::draw(rng);
    let gray = synth::scan(rng, &render(&drawing), &style);
    seen(&Scan { gray, rgb: None, dpi: None }, drawing)
}

fn on_paper(rng: &mut impl Rng, drawing: Drawing, other: &Drawing, config: &TrainConfig) -> Option<Sight> {
    let kind = Kind::draw(rng, &config.held_out);
    let page = synth::page(rng, kind, drawing, other);
    let byte = |v: f32| (255.0 * v).round() as u8;
    let (width, height) = page.ink.size();
    let color = |x: u32, y: u32| Rgb([0, 1, 2].map(|c: usize| byte(page.color[c][(x as usize, y as usize)])));
    let image = RgbImage::from_fn(width as u32, height as u32, color);
    seen(&Scan::from(&DynamicImage::ImageRgb8(image)), page.drawing)
}

/// What the network sees of a drawing on some paper; `None` where cleaning finds no line.
fn seen(scan: &Scan, drawing: Drawing) -> Option<Sight> {
    static STAGES: LazyLock<Option<Vectorizer>> =
        LazyLock::new(|| Vectorizer::with(Options::default(), Box::new(StructureTensor::default())).ok());
    let image = STAGES.as_ref()?.line_image(scan, None, &mut ()).ok()?;
    if image.mask.count() == 0 {
        return None;
    }
    let (width, height) = image.ink.size();
    let mut drawing = drawing.scaled(image.scale);
    (drawing.width, drawing.height) = (width as f64, height as f64);
    Some(Sight { ink: shown(&image), truth: ground_truth::field(&drawing) })
}

fn strokes_of(path: &Path) -> std::result::Result<Drawing, String> {
    let options = LoadOptions { size: Some(READ_SIDE), ..LoadOptions::default() };
    let input = load(path, &options).map_err(|e| e.to_string())?;
    let drawing = input.drawing.ok_or("is not an SVG")?;
    if drawing.strokes.is_empty() { Err("has no strokes".into()) } else { Ok(drawing) }
}

/// The files with an ending in a folder and the folders in it.
pub(super) fn files(folder: &Path, ending: &str) -> Result<Vec<PathBuf>> {
    let mut paths = Vec::new();
    for entry in WalkDir::new(folder).follow_links(true) {
        let entry = entry.map_err(|e| Error::Read { input: folder.display().to_string(), cause: e.into() })?;
        let matches = entry.path().extension().is_some_and(|e| e.eq_ignore_ascii_case(ending));
        if matches && !entry.file_type().is_dir() {
            paths.push(entry.into_path());
        }
    }
    // The order of whole paths, in which runs number them.
    paths.sort();
    Ok(paths)
}
