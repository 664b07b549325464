//! How long does it take to write the SVG?

use crate::page::{SIDE, graph, image};
use divan::Bencher;
use divan::counter::ItemsCount;
use fieldtrace::cancel::Cancel;
use fieldtrace::fit::fit;
use fieldtrace::options::Options;
use fieldtrace::write::{WriteOptions, to_svg};

#[divan::bench]
fn write(bencher: Bencher) {
    let drawing = fit(&graph(&image()), &Options::default(), &Cancel::default()).expect("nobody cancels");
    let bencher = bencher.counter(ItemsCount::new(SIDE * SIDE));
    bencher.bench(|| to_svg(&drawing, &WriteOptions::default()));
}
