//! How long does it take to follow the lines?

use crate::page::{SIDE, frames, image};
use divan::Bencher;
use divan::counter::ItemsCount;
use fieldtrace::cancel::Cancel;
use fieldtrace::streamline::trace;

#[divan::bench]
fn streamlines(bencher: Bencher) {
    let image = image();
    let frames = frames(&image);
    let bencher = bencher.counter(ItemsCount::new(SIDE * SIDE));
    bencher.bench(|| trace(&image, &frames, &Cancel::default()));
}
