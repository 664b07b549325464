//! How long does it take to build the stroke graph?

use crate::page::{SIDE, image, streamlines};
use divan::Bencher;
use divan::counter::ItemsCount;
use fieldtrace::cancel::Cancel;
use fieldtrace::graph::build;
use fieldtrace::options::Options;

#[divan::bench]
fn graph(bencher: Bencher) {
    let image = image();
    let streamlines = streamlines(&image);
    let bencher = bencher.counter(ItemsCount::new(SIDE * SIDE));
    bencher.bench(|| build(&image, &streamlines, &Options::default(), &Cancel::default()));
}
