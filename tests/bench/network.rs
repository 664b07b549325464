//! How long does the network take, and the structure tensor?

use crate::page::{SIDE, image};
use divan::Bencher;
use divan::counter::ItemsCount;
use fieldtrace::estimate::{FieldEstimator, StructureTensor};

fn estimate(bencher: Bencher, estimator: &dyn FieldEstimator) {
    let image = image();
    bencher.counter(ItemsCount::new(SIDE * SIDE)).bench(|| estimator.estimate(&image));
}

#[divan::bench]
fn network(bencher: Bencher) {
    estimate(bencher, &fieldtrace::estimate::UNet::built_in().expect("the built-in weights can be read"));
}

#[divan::bench]
fn tensor(bencher: Bencher) {
    estimate(bencher, &StructureTensor::default());
}
