//! Inputs of several pages, each decoded only when it is asked for.

use super::format::{Format, detect};
use super::{Input, LoadOptions, bitmap, tiff, undecodable};
#[cfg(feature = "formats")]
use super::{animation::Player, pdf};
use crate::error::{Error, Result};
use image::ImageFormat;
use std::borrow::Cow;
use std::ops::RangeInclusive;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// The pages of an input: those of a TIFF or a PDF, the frames of an animated GIF, WebP or JPEG XL, or the one image of
/// any other file. What is kept is the file as it is; a page is decoded when it is asked for, on any thread.
pub struct Pages<'a> {
    name: String,
    bytes: Cow<'a, [u8]>,
    options: LoadOptions,
    kind: Kind,
}

/// What the pages are.
enum Kind {
    /// One image.
    Single(Format),
    /// The directories of a TIFF, by their offsets.
    Tiff(Vec<u64>),
    /// The frames of an animation, by their number.
    #[cfg(feature = "formats")]
    Frames(ImageFormat, usize),
    /// The frames of a JPEG XL, by their number.
    #[cfg(feature = "formats")]
    JpegXl(usize),
    /// The pages of a PDF, which holds the file.
    #[cfg(feature = "formats")]
    Pdf(pdf::Document),
}

impl std::fmt::Debug for Pages<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Pages").field("name", &self.name).field("count", &self.count()).finish_non_exhaustive()
    }
}

impl<'a> Pages<'a> {
    /// Looks at a file, and at the options.
    pub(super) fn open(name: &str, bytes: Cow<'a, [u8]>, options: &LoadOptions) -> Result<Self> {
        options.validate()?;
        if bytes.is_empty() {
            return Err(undecodable(name, "the file is empty"));
        }
        let pages = guarded(name, || {
            let (kind, bytes) = kind(name, bytes, options)?;
            Ok(Self { name: name.into(), bytes, options: options.clone(), kind })
        })?;
        match options.page {
            Some(page) if page > pages.count() => {
                Err(Error::NoSuchPage { input: name.into(), page, pages: pages.count() })
            }
            _ => Ok(pages),
        }
    }

    /// How many pages the input has.
    pub fn count(&self) -> usize {
        match &self.kind {
            Kind::Single(_) => 1,
            Kind::Tiff(directories) => directories.len(),
            #[cfg(feature = "formats")]
            Kind::Frames(_, count) | Kind::JpegXl(count) => *count,
            #[cfg(feature = "formats")]
            Kind::Pdf(document) => document.count(),
        }
    }

    /// The numbers of the pages to read: that of [`LoadOptions::page`], or from 1 to the last.
    pub fn numbers(&self) -> RangeInclusive<usize> {
        self.options.page.map_or(1..=self.count(), |page| page..=page)
    }

    /// Decodes a page, counted from 1.
    ///
    /// # Errors
    /// [`Error::NoSuchPage`], and those of [`load_bytes`](super::load_bytes). Where there are several pages, the input
    /// that an error names is `NAME, page N`.
    pub fn page(&self, number: usize) -> Result<Input> {
        if number == 0 || number > self.count() {
            return Err(Error::NoSuchPage { input: self.name.clone(), page: number, pages: self.count() });
        }
        #[cfg(feature = "formats")]
        if let Kind::Frames(format, _) = self.kind {
            return self.frame(&mut Player::new(&self.bytes, format), number);
        }
        let name = self.page_name(number);
        guarded(&name, || self.decode(&name, number))
    }

    /// The pages to read ([`Pages::numbers`]), each with its number, decoded one after the other.
    ///
    /// Frames build on those before them: a loop over them all takes far less time here than with [`Pages::page`].
    pub fn iter(&self) -> Box<dyn Iterator<Item = (usize, Result<Input>)> + '_> {
        #[cfg(feature = "formats")]
        if let Kind::Frames(format, _) = self.kind {
            let mut player = Player::new(&self.bytes, format);
            return Box::new(self.numbers().map(move |number| (number, self.frame(&mut player, number))));
        }
        Box::new(self.numbers().map(|number| (number, self.page(number))))
    }

    /// The one page to read.
    ///
    /// # Errors
    /// [`Error::ManyPages`] where there are several and none was chosen, and those of [`Pages::page`].
    pub(super) fn only(&self) -> Result<Input> {
        let numbers = self.numbers();
        if numbers.start() == numbers.end() {
            self.page(*numbers.start())
        } else {
            Err(Error::ManyPages { input: self.name.clone(), pages: self.count() })
        }
    }

    /// What errors call a page.
    fn page_name(&self, number: usize) -> String {
        if self.count() == 1 { self.name.clone() } else { format!("{}, page {number}", self.name) }
    }

    fn decode(&self, name: &str, number: usize) -> Result<Input> {
        let (bytes, options) = (&self.bytes, &self.options);
        let decoded = match &self.kind {
            #[cfg(feature = "svg-input")]
            Kind::Single(Format::Svg) => return super::svg::load(name, bytes, options),
            #[cfg(feature = "avif")]
            Kind::Single(Format::Avif) => super::avif::decode(name, bytes, options)?,
            Kind::Single(format) => bitmap::decode(name, bytes, *format, options)?,
            Kind::Tiff(directories) => tiff::decode(name, bytes, directories[number - 1], options)?,
            #[cfg(feature = "formats")]
            Kind::Frames(format, _) => Player::new(bytes, *format).frame(name, number, options)?,
            #[cfg(feature = "formats")]
            Kind::JpegXl(_) => super::jxl::decode(name, bytes, number, options)?,
            #[cfg(feature = "formats")]
            Kind::Pdf(document) => document.page(name, number, options)?,
        };
        Ok(Input { scan: decoded.plan.scan(decoded.image), drawing: None, frame: None })
    }

    #[cfg(feature = "formats")]
    fn frame(&self, player: &mut Player, number: usize) -> Result<Input> {
        let name = self.page_name(number);
        guarded(&name, || {
            let decoded = player.frame(&name, number, &self.options)?;
            Ok(Input { scan: decoded.plan.scan(decoded.image), drawing: None, frame: None })
        })
    }
}

/// What kind of pages a file has; bytes that it does not hold itself are given back.
#[cfg_attr(not(feature = "formats"), allow(unused_variables))]
fn kind<'a>(name: &str, bytes: Cow<'a, [u8]>, options: &LoadOptions) -> Result<(Kind, Cow<'a, [u8]>)> {
    let format = detect(name, &bytes)?;
    let kind = match format {
        Format::Raster(ImageFormat::Tiff) => Kind::Tiff(tiff::pages(&bytes)),
        #[cfg(feature = "formats")]
        Format::Raster(format) => match super::animation::frames(format, &bytes) {
            count @ 2.. => Kind::Frames(format, count),
            _ => Kind::Single(Format::Raster(format)),
        },
        #[cfg(feature = "formats")]
        Format::JpegXl => Kind::JpegXl(super::jxl::frames(&bytes, options)),
        #[cfg(feature = "formats")]
        Format::Pdf => return Ok((Kind::Pdf(pdf::Document::open(name, bytes.into_owned())?), Cow::default())),
        format => Kind::Single(format),
    };
    Ok((kind, bytes))
}

/// Runs a decoder. They are other people's code and read hostile bytes: what they trip over is an error like any other.
fn guarded<T>(name: &str, decode: impl FnOnce() -> Result<T>) -> Result<T> {
    catch_unwind(AssertUnwindSafe(decode))
        .unwrap_or_else(|_| Err(undecodable(name, "the decoder gave up on the image: it is damaged")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pages_go_to_any_thread() {
        fn all<T: Send + Sync>() {}
        all::<Pages<'static>>();
    }
}
