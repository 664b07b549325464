//! How long does cleaning take?

use crate::page::{SIDE, page};
use divan::Bencher;
use divan::counter::ItemsCount;
use fieldtrace::clean;
use fieldtrace::options::Options;

#[divan::bench]
fn clean(bencher: Bencher) {
    let scan = page();
    let bencher = bencher.counter(ItemsCount::new(SIDE * SIDE));
    bencher.bench(|| clean::clean(&scan, &Options::default()));
}
