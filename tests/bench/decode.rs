//! How long does it take to read the directions at every pixel?

use crate::page::{SIDE, frames, image};
use divan::Bencher;
use divan::counter::ItemsCount;

#[divan::bench]
fn decode(bencher: Bencher) {
    let frames = frames(&image());
    let bencher = bencher.counter(ItemsCount::new(SIDE * SIDE));
    let pixels = || (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x, y)));
    bencher.bench(|| pixels().filter_map(|(x, y)| frames.at_pixel(x, y)).map(|frame| frame.u.x).sum::<f64>());
}
