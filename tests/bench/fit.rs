//! How long does it take to fit the strokes?

use crate::page::{SIDE, graph, image};
use divan::Bencher;
use divan::counter::ItemsCount;
use fieldtrace::cancel::Cancel;
use fieldtrace::fit;
use fieldtrace::options::Options;

#[divan::bench]
fn fit(bencher: Bencher) {
    let graph = graph(&image());
    let bencher = bencher.counter(ItemsCount::new(SIDE * SIDE));
    bencher.bench(|| fit::fit(&graph, &Options::default(), &Cancel::default()));
}
