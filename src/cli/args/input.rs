//! How inputs are read.

use super::parse_number;
use crate::load::{Dpi, LoadOptions};
use clap::Args;

/// How the input is read.
#[derive(Debug, Args)]
#[command(next_help_heading = "Input")]
pub(crate) struct LoadArgs {
    /// Read page N alone, counted from 1, of a TIFF, PDF, or animated GIF or WebP
    #[arg(long, value_name = "N", value_parser = parse_page)]
    page: Option<usize>,
    /// Read a part alone: W x H pixels from X, Y on of the upright image, as a viewer shows it
    #[arg(long, value_name = "X,Y,W,H", value_parser = parse_crop, allow_hyphen_values = true)]
    crop: Option<[u32; 4]>,
    /// Dots per inch, or those across and those down the page, in place of what the input says; sizes the
    /// output in millimetres, and the rendering of an SVG or a PDF in pixels [default for a PDF: 300]
    #[arg(long, value_name = "DPI|X,Y", value_parser = parse_dpi, allow_hyphen_values = true)]
    dpi: Option<Dpi>,
    /// Pixels along the longer side of the rendering of an SVG or a PDF
    #[arg(long, value_name = "PX", value_parser = clap::value_parser!(u32).range(1..=65535))]
    size: Option<u32>,
    /// Refuse inputs of more pixels than this
    #[arg(long, value_name = "N", default_value_t = LoadOptions::default().max_pixels,
          value_parser = clap::value_parser!(u64).range(1..))]
    max_pixels: u64,
}

impl LoadArgs {
    /// The library's form.
    pub(crate) fn options(&self) -> LoadOptions {
        let &Self { page, crop, dpi, size, max_pixels } = self;
        LoadOptions { max_pixels, dpi, size, page, crop }
    }
}

fn parse_dpi(text: &str) -> Result<Dpi, String> {
    let one = |text: &str| {
        let dpi = parse_number(text.trim())?;
        if (1.0..=100_000.0).contains(&dpi) { Ok(dpi) } else { Err("not between 1 and 100000".to_owned()) }
    };
    match text.split_once(',') {
        None => one(text).map(Dpi::from),
        Some((x, y)) => Ok(Dpi { x: one(x)?, y: one(y)? }),
    }
}

fn parse_page(text: &str) -> Result<usize, String> {
    text.parse().ok().filter(|&page| page > 0).ok_or_else(|| "not a whole number from 1 on".into())
}

fn parse_crop(text: &str) -> Result<[u32; 4], String> {
    let numbers: Option<Vec<u32>> = text.split(',').map(|number| number.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some([_, _, 0, _] | [_, _, _, 0]) => Err("the part has no pixels".into()),
        Some(&[x, y, w, h]) => Ok([x, y, w, h]),
        _ => Err("not four whole numbers, such as 100,50,640,480".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_number_or_two_are_a_resolution() {
        assert_eq!(parse_dpi("300"), Ok(Dpi { x: 300.0, y: 300.0 }));
        assert_eq!(parse_dpi("204,98.5"), Ok(Dpi { x: 204.0, y: 98.5 }));
        assert_eq!(parse_dpi("300,0"), Err("not between 1 and 100000".into()));
        assert_eq!(parse_dpi("1,2,3"), Err("not a number".into()));
        assert_eq!(parse_dpi("-5"), Err("not between 1 and 100000".into()));
    }

    #[test]
    fn four_numbers_are_a_part() {
        assert_eq!(parse_crop("1,2,3,4"), Ok([1, 2, 3, 4]));
        assert_eq!(parse_crop("1, 2, 3, 4"), Ok([1, 2, 3, 4]));
        assert!(parse_crop("1,2,0,4").unwrap_err().contains("no pixels"));
        assert!(parse_crop("1,2,3").unwrap_err().contains("four"));
        assert!(parse_page("0").is_err() && parse_page("7") == Ok(7));
    }
}
