//! PDF inputs: pages rasterised by `hayro` over white.

use super::bitmap::Decoded;
use super::plan::Plan;
use super::{Dpi, LoadOptions, undecodable};
use crate::error::Result;
use hayro::hayro_interpret::{InterpreterSettings, util::TransformExt};
use hayro::hayro_syntax::page::Page;
use hayro::hayro_syntax::{DecryptionError, LoadPdfError, Pdf};
use hayro::kurbo::Affine;
use hayro::vello_cpu::color::palette::css::WHITE;
use hayro::vello_cpu::{Pixmap, RasterizerSettings, RenderContext, Resources, TargetInit};
use hayro::{RenderCache, RenderSettings, render_into};
use image::RgbaImage;

/// Dots per inch of a rendering where none was asked for: what scanners are set to.
const DEFAULT_DPI: f64 = 300.0;

/// Points in an inch.
const POINTS: f64 = 72.0;

/// A parsed file.
pub(super) struct Document(Pdf);

impl Document {
    /// Reads the list of pages.
    ///
    /// # Errors
    /// [`crate::Error::Decode`] where the file is encrypted or damaged, or has no page.
    pub(super) fn open(name: &str, bytes: Vec<u8>) -> Result<Self> {
        let pdf = Pdf::new(bytes).map_err(|error| {
            let reason = match error {
                LoadPdfError::Decryption(DecryptionError::PasswordProtected) => {
                    "the PDF needs a password: save it without one"
                }
                LoadPdfError::Decryption(_) => "the PDF is encrypted in a way that is not supported",
                LoadPdfError::Invalid => "the PDF is damaged: no pages are found in it",
            };
            undecodable(name, reason)
        })?;
        if pdf.pages().is_empty() { Err(undecodable(name, "the PDF has no pages")) } else { Ok(Self(pdf)) }
    }

    /// How many pages there are.
    pub(super) fn count(&self) -> usize {
        self.0.pages().len()
    }

    /// Renders a page, counted from 1.
    ///
    /// # Errors
    /// [`crate::Error::Decode`] and [`crate::Error::TooLarge`].
    pub(super) fn page(&self, name: &str, number: usize, options: &LoadOptions) -> Result<Decoded> {
        let page = &self.0.pages()[number - 1];
        let (width, height) = page.render_dimensions();
        let points = [f64::from(width), f64::from(height)];
        let asked = options.dpi.map_or(DEFAULT_DPI, Dpi::finer) / POINTS;
        let scale = options.size.map_or(asked, |size| f64::from(size) / points[0].max(points[1]));
        // Sizes are single precision: what is over a whole number by less than that is no pixel of its own.
        let [width, height] = points.map(|side| ((side * scale * (1.0 - 1e-6)).ceil() as u64).max(1));
        options.check_size(name, width, height)?;
        let (Ok(w), Ok(h)) = (u16::try_from(width), u16::try_from(height)) else {
            return Err(undecodable(name, format!("a rendering of {width} x {height} pixels is too large")));
        };
        let dpi = options.dpi.map_or(scale * POINTS, Dpi::finer);
        let plan = Plan::rendered(name, (w.into(), h.into()), dpi, options)?;
        let image = RgbaImage::from_raw(w.into(), h.into(), render(page, scale, (w, h)));
        let image = image.ok_or_else(|| undecodable(name, "the rendering has no pixels"))?;
        Ok(Decoded { image: image.into(), plan })
    }
}

/// Red, green, blue and alpha, which is full, of a page over white, at a scale of pixels for a point.
fn render(page: &Page, scale: f64, (width, height): (u16, u16)) -> Vec<u8> {
    let mut context = RenderContext::new(width, height);
    let transform = Affine::scale(scale) * page.initial_transform(true).to_kurbo();
    let (interpreter, settings) = (InterpreterSettings::default(), RenderSettings::default());
    render_into(page, &RenderCache::new(), &interpreter, &settings, &mut context, transform);
    context.flush();
    let mut pixmap = Pixmap::new(width, height);
    let over_white = RasterizerSettings { target_init: TargetInit::Clear(WHITE), ..Default::default() };
    context.render_with(&mut pixmap, &mut Resources::default(), over_white);
    pixmap.data_as_u8_slice().to_vec()
}
