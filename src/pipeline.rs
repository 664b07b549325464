//! The whole way from a scan to a drawing.

use crate::cancel::Cancel;
use crate::clean::{self, LineImage};
use crate::drawing::Drawing;
use crate::error::{Error, Result};
use crate::estimate::FieldEstimator;
use crate::field::{FrameField, PolyVectorField};
use crate::graph::{Passes, StrokeGraph, Work};
use crate::hooks::{Observer, Stage};
use crate::ink::{InkEstimator, LearnedInk};
use crate::load::Scan;
use crate::options::{Ink, Options};
use crate::raster::Raster;
use crate::{fit, graph, ink, streamline};

/// Traces an image; the whole library in one call.
///
/// ```
/// let image = image::open("samples/kettle.png")?;
/// let drawing = fieldtrace::trace(&image, &fieldtrace::Options::default())?;
/// assert!(drawing.strokes.len() > 5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// To trace many, make one [`Vectorizer`], which reads the network's weights once.
///
/// # Errors
/// [`Error::Option`] when an option is out of its range.
pub fn trace(image: impl Into<Scan>, options: &Options) -> Result<Drawing> {
    Vectorizer::new(options.clone())?.trace(&image.into())
}

/// Traces scans under one set of options and one estimator.
pub struct Vectorizer {
    options: Options,
    ink: Box<dyn InkEstimator>,
    estimator: Box<dyn FieldEstimator>,
    passes: Passes,
    cancel: Cancel,
    report: Option<Box<Report>>,
}

/// Told of each stage as it begins.
type Report = dyn Fn(Stage) + Send + Sync;

impl Vectorizer {
    /// A vectorizer with the default estimator.
    ///
    /// # Errors
    /// [`Error::Option`] when an option is out of its range.
    pub fn new(options: Options) -> Result<Self> {
        Self::with(options, default_estimator()?)
    }

    /// A vectorizer with some source of fields.
    ///
    /// # Errors
    /// [`Error::Option`] when an option is out of its range.
    pub fn with(options: Options, estimator: Box<dyn FieldEstimator>) -> Result<Self> {
        options.validate()?;
        let (ink, passes) = (Box::new(LearnedInk::default()), Passes::default());
        Ok(Self { options, ink, estimator, passes, cancel: Cancel::default(), report: None })
    }

    /// The same with a source of ink, which is asked for that of every page: [`Options::ink`] becomes [`Ink::Learned`].
    #[must_use]
    pub fn with_ink_estimator(self, ink: impl InkEstimator + 'static) -> Self {
        Self { ink: Box::new(ink), options: Options { ink: Ink::Learned, ..self.options }, ..self }
    }

    /// The same with another source of fields.
    #[must_use]
    pub fn with_estimator(self, estimator: impl FieldEstimator + 'static) -> Self {
        Self { estimator: Box::new(estimator), ..self }
    }

    /// The same, but everything it does stops when a token says so.
    #[must_use]
    pub fn cancelled_by(self, cancel: Cancel) -> Self {
        Self { cancel, ..self }
    }

    /// The same, but a function is told of each stage as it begins.
    #[must_use]
    pub fn reporting(self, report: impl Fn(Stage) + Send + Sync + 'static) -> Self {
        Self { report: Some(Box::new(report)), ..self }
    }

    /// The same without one of the passes between streamlines and graph, to see what it is worth.
    ///
    /// # Errors
    /// [`Error::Option`] when no pass of [`graph::passes()`] has the name.
    pub fn without(self, pass: &str) -> Result<Self> {
        Ok(Self { passes: self.passes.without(pass)?, ..self })
    }

    /// The name of the source of fields.
    pub fn estimator_name(&self) -> &str {
        self.estimator.name()
    }

    /// The options.
    pub fn options(&self) -> &Options {
        &self.options
    }

    /// Traces a scan.
    ///
    /// # Errors
    /// Whatever the estimator says.
    pub fn trace(&self, scan: &Scan) -> Result<Drawing> {
        self.trace_observed(scan, &mut ())
    }

    /// Traces a scan; the observer sees every stage's result and may change or refuse it.
    ///
    /// # Errors
    /// Whatever the estimator or the observer says.
    pub fn trace_observed(&self, scan: &Scan, observer: &mut dyn Observer) -> Result<Drawing> {
        let graph = self.graph(scan, observer)?;
        self.draw(&graph, observer)
    }

    /// The stroke graph of a scan: the trace up to the fit, as the observer left it.
    ///
    /// # Errors
    /// Whatever the estimator or the observer says.
    pub fn graph(&self, scan: &Scan, observer: &mut dyn Observer) -> Result<StrokeGraph> {
        let cancel = self.token(observer);
        let image = self.line_image(scan, None, observer)?;
        self.follow(scan, &image, &|image| self.estimate(image, &cancel), observer)
    }

    /// Traces a scan of which the caller knows the ink: the share of each pixel that is covered, 0 to 1, at the scan's size.
    ///
    /// # Errors
    /// [`Error::InkSize`] when the map's size is not the scan's; whatever the estimator or the observer says.
    pub fn trace_with_ink(&self, scan: &Scan, coverage: &Raster<f32>, observer: &mut dyn Observer) -> Result<Drawing> {
        let cancel = self.token(observer);
        let image = self.line_image(scan, Some(coverage), observer)?;
        let graph = self.follow(scan, &image, &|image| self.estimate(image, &cancel), observer)?;
        self.draw(&graph, observer)
    }

    /// The ink of a scan, told by the estimator: the share of each pixel that is covered, 0 to 1, at the scan's size.
    ///
    /// # Errors
    /// Whatever the estimator of ink says.
    pub fn ink(&self, scan: &Scan) -> Result<Raster<f32>> {
        self.ink.estimate_until(scan, &self.cancel)
    }

    /// What stops the work: the vectorizer's own token and the observer's.
    fn token(&self, observer: &dyn Observer) -> Cancel {
        self.cancel.or(&observer.cancel())
    }

    /// Tells that a stage begins.
    fn begin(&self, stage: Stage) {
        self.report.iter().for_each(|report| report(stage));
    }

    /// The lines of a scan, as the observer left them; the caller may know its ink.
    pub(crate) fn line_image(
        &self,
        scan: &Scan,
        coverage: Option<&Raster<f32>>,
        observer: &mut dyn Observer,
    ) -> Result<LineImage> {
        self.begin(Stage::Clean);
        let options = &self.options.in_pixels(scan.dpi)?;
        let mut image = match coverage {
            Some(coverage) => {
                let mut coverage = coverage.clone();
                observer.on_ink(scan, &mut coverage)?;
                self.told(scan, coverage, options, &self.token(observer))?
            }
            None => match self.block(scan) {
                1 => self.cleaned(scan, options, observer)?,
                block => {
                    let options = options.reduced(block);
                    self.cleaned(&clean::reduced(scan, block), &options, observer)?.of_finer(block)
                }
            },
        };
        observer.on_line_image(&mut image)?;
        image.validate()?;
        Ok(image)
    }

    /// Side of the blocks of pixels to which a scan can be reduced before anything else is done with it.
    fn block(&self, scan: &Scan) -> usize {
        if clean::is_large(scan) && !ink::is_plain(scan) { clean::block(scan, &self.options) } else { 1 }
    }

    /// The lines of a scan whose ink is told as the options say.
    fn cleaned(&self, scan: &Scan, options: &Options, observer: &mut dyn Observer) -> Result<LineImage> {
        let cancel = self.token(observer);
        let by_threshold = match self.options.ink {
            Ink::Learned => None,
            Ink::Auto | Ink::Threshold => Some(clean::clean_until(scan, options, &cancel)?),
        };
        let is_render = |image: &LineImage| image.noise.is_sure() && ink::is_plain(scan);
        let by_threshold = match by_threshold {
            Some(image) if self.options.ink == Ink::Threshold || is_render(&image) => return Ok(image),
            other => other,
        };
        let mut coverage = self.ink.estimate_until(scan, &cancel)?;
        let darkness = by_threshold.as_ref().map(|image| ink::Darkness::of(image, scan.gray.size()));
        darkness.iter().for_each(|darkness| darkness.complete(&mut coverage));
        observer.on_ink(scan, &mut coverage)?;
        if let Some((image, darkness)) = by_threshold.zip(darkness)
            && image.decisions.hues == 0
            && darkness.agrees(&coverage)
        {
            return Ok(image);
        }
        self.told(scan, coverage, options, &cancel)
    }

    /// The lines of a scan whose ink is known.
    fn told(&self, scan: &Scan, coverage: Raster<f32>, options: &Options, cancel: &Cancel) -> Result<LineImage> {
        let drawn = ink::drawn(scan, &coverage)?;
        drop(coverage);
        clean::clean_drawn(drawn, scan, options, cancel)
    }

    /// The drawing of a stroke graph, be it traced, read or corrected; of the colours that the options take.
    ///
    /// # Errors
    /// Whatever the observer says of the drawing; it sees no other stage.
    pub fn draw(&self, graph: &StrokeGraph, observer: &mut dyn Observer) -> Result<Drawing> {
        self.begin(Stage::Fit);
        let mut drawing = fit::fit(graph, &self.options, &self.token(observer))?;
        drawing.strokes.retain(|stroke| self.options.takes(stroke.color));
        drawing.fills.retain(|fill| self.options.takes(fill.color));
        observer.on_drawing(&mut drawing)?;
        Ok(drawing)
    }

    /// Traces a scan under the caller's own field, given at the scan's size.
    ///
    /// # Errors
    /// [`Error::FieldSize`] when the field's size is not the scan's; whatever the observer says.
    pub fn trace_with_field(
        &self,
        scan: &Scan,
        field: &PolyVectorField,
        observer: &mut dyn Observer,
    ) -> Result<Drawing> {
        same_size(field, &scan.gray)?;
        let image = self.line_image(scan, None, observer)?;
        let resized = |image: &LineImage| Ok(field.resized(image.ink.width(), image.ink.height()));
        let graph = self.follow(scan, &image, &resized, observer)?;
        self.draw(&graph, observer)
    }

    /// The field of a scan, at the scan's own size.
    ///
    /// # Errors
    /// Whatever the estimator says.
    pub fn field(&self, scan: &Scan) -> Result<PolyVectorField> {
        let image = self.line_image(scan, None, &mut ())?;
        let (width, height) = scan.gray.size();
        let cancel = self.token(&());
        let mut field = self.estimate(&image, &cancel)?.resized(width, height);
        if let Some(broad) = &image.broad {
            field.fill_from(&self.estimate(broad, &cancel)?.resized(width, height));
        }
        Ok(field)
    }

    fn estimate(&self, image: &LineImage, cancel: &Cancel) -> Result<PolyVectorField> {
        self.begin(Stage::Estimate);
        let field = self.estimator.estimate_until(image, cancel)?;
        same_size(&field, &image.ink)?;
        Ok(field)
    }

    /// From the ink to the graph, by a source of fields.
    fn follow(
        &self,
        scan: &Scan,
        image: &LineImage,
        field: &dyn Fn(&LineImage) -> Result<PolyVectorField>,
        observer: &mut dyn Observer,
    ) -> Result<StrokeGraph> {
        let broad = image.broad.as_ref().map(|broad| self.layer(broad, field(broad)?, observer)).transpose()?;
        let mut graph = self.layer(image, field(image)?, observer)?;
        if let Some(broad) = broad {
            graph = graph::join_layers(graph, broad);
        }
        (graph.page.width, graph.page.height) = (scan.gray.width() as f64, scan.gray.height() as f64);
        graph.page.dpi = scan.dpi;
        observer.on_graph(image, &mut graph)?;
        Ok(graph)
    }

    /// The graph of the lines of one image.
    fn layer(&self, image: &LineImage, mut field: PolyVectorField, observer: &mut dyn Observer) -> Result<StrokeGraph> {
        observer.on_field(image, &mut field)?;
        same_size(&field, &image.ink)?;
        self.begin(Stage::Trace);
        let cancel = self.token(observer);
        let frames = FrameField::new(field);
        let mut streamlines = Vec::new();
        for mut streamline in streamline::trace(image, &frames, &cancel)? {
            if observer.on_streamline(image, &mut streamline)? {
                streamline.validate()?;
                streamlines.push(streamline);
            }
        }
        self.passes.build(image, &streamlines, &self.options, &cancel, &mut |ran, work| match work {
            Work::Lines(lines) => observer.on_lines(image, ran, lines),
            Work::Graph(graph) => observer.on_finish(image, ran, graph),
        })
    }
}

fn same_size(field: &PolyVectorField, image: &Raster<f32>) -> Result<()> {
    let (field, image) = (field.size(), image.size());
    if field == image { Ok(()) } else { Err(Error::FieldSize { field, image }) }
}

/// The U-Net.
fn default_estimator() -> Result<Box<dyn FieldEstimator>> {
    Ok(Box::new(crate::estimate::UNet::built_in()?))
}
