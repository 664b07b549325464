//! Pages of one's own, with what is ink on them.

use super::super::data::Sample;
use super::super::source::{Skipped, files};
use crate::error::{Error, Result};
use crate::load::{LoadOptions, load};
use crate::raster::Raster;
use crate::render::render;
use image::{GrayImage, RgbImage};
use rand::Rng;
use rayon::prelude::*;
use std::path::Path;

/// A page as it is kept, 4 bytes a pixel.
#[derive(Clone, Debug)]
pub(in super::super) struct Stored {
    color: RgbImage,
    /// Coverage, 255 being all of a pixel.
    ink: GrayImage,
}

impl Stored {
    /// Reads the pages of a folder and of the folders in it: `NAME.png`, its ink being black on white in `NAME.ink.png` or
    /// the strokes and solids of `NAME.svg`. Pages smaller than a side, and those that cannot be read, are left out and named.
    ///
    /// # Errors
    /// [`Error::Read`] when the folder cannot be listed; [`Error::Train`] when there is no page in it.
    pub fn read(folder: &Path, side: usize) -> Result<(Vec<Self>, Vec<Skipped>)> {
        let is_page = |path: &Path| path.with_extension("").extension().is_none_or(|e| e != "ink");
        let paths: Vec<_> = files(folder, "png")?.into_iter().filter(|path| is_page(path)).collect();
        let read = paths.into_par_iter().map(|path| (Self::of(&path, side), path)).collect::<Vec<_>>();
        let (mut pages, mut skipped) = (Vec::new(), Vec::new());
        for (result, path) in read {
            match result {
                Ok(page) => pages.push(page),
                Err(reason) => skipped.push((path, reason)),
            }
        }
        if pages.is_empty() {
            return Err(Error::Train { reason: format!("{}: holds no page with its ink", folder.display()) });
        }
        Ok((pages, skipped))
    }

    fn of(path: &Path, side: usize) -> std::result::Result<Self, String> {
        let read = |path: &Path, options: &LoadOptions| load(path, options).map_err(|e| e.to_string());
        let page = read(path, &LoadOptions::default())?.scan;
        let (width, height) = page.gray.size();
        if width.min(height) < side {
            return Err(format!("is smaller than {side} pixels"));
        }
        let (beside, drawing) = (path.with_extension("ink.png"), path.with_extension("svg"));
        let ink = if beside.is_file() {
            read(&beside, &LoadOptions::default())?.scan.gray.map(|g| 1.0 - g)
        } else {
            let options = LoadOptions { size: Some(width.max(height) as u32), ..LoadOptions::default() };
            render(&read(&drawing, &options)?.drawing.ok_or("its ink is no drawing")?)
        };
        if ink.size() != (width, height) {
            return Err("is not of the size of its ink".into());
        }
        let gray = page.gray.map(byte).into_image();
        let color = page.rgb.unwrap_or_else(|| image::DynamicImage::ImageLuma8(gray).into_rgb8());
        Ok(Self { color, ink: ink.map(byte).into_image() })
    }

    /// A square of a side somewhere on the page.
    pub fn crop(&self, rng: &mut impl Rng, side: usize) -> Sample {
        let spot = |rng: &mut _, n: u32| Rng::random_range(rng, 0..=n - side as u32);
        let (left, top) = (spot(rng, self.ink.width()), spot(rng, self.ink.height()));
        let plane = |of: &dyn Fn(u32, u32) -> u8| {
            Raster::from_fn(side, side, |x, y| f32::from(of(left + x as u32, top + y as u32)) / 255.0)
        };
        let color = [0, 1, 2].map(|c: usize| plane(&|x, y| self.color.get_pixel(x, y).0[c]));
        Sample::of_page(&color, &plane(&|x, y| self.ink.get_pixel(x, y).0[0]))
    }
}

fn byte(v: f32) -> u8 {
    (v.clamp(0.0, 1.0) * 255.0).round() as u8
}
