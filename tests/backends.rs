//! The same weights give the same field, whatever runs the network.
#![cfg(feature = "train")]

use fieldtrace::clean::{LineImage, clean};
use fieldtrace::estimate::{FieldEstimator, UNet};
use fieldtrace::load::{LoadOptions, Scan, load};
use fieldtrace::options::Options;
use fieldtrace::raster::Raster;
use fieldtrace::unet::{Backend, Weights};

/// How far the coefficients of two backends may be apart.
const TOLERANCE: f32 = 1e-3;

/// A part of a sample, cleaned as it is for a trace.
fn part(name: &str, (left, top): (usize, usize), (width, height): (usize, usize)) -> LineImage {
    let path = format!("{}/samples/{name}", env!("CARGO_MANIFEST_DIR"));
    let gray = load(path.as_ref(), &LoadOptions::default()).unwrap().scan.gray;
    let (width, height) = (width.min(gray.width() - left), height.min(gray.height() - top));
    let gray = Raster::from_fn(width, height, |x, y| gray[(left + x, top + y)]);
    clean(&Scan { gray, rgb: None, dpi: None }, &Options::default())
}

/// The largest difference of the coefficients on the ink between a backend and the engine.
fn difference(image: &LineImage, weights: &Weights, backend: &str) -> f32 {
    let field = |name| UNet::new(weights, Backend::named(name).unwrap()).unwrap().estimate(image).unwrap();
    let (a, b) = (field("cpu"), field(backend));
    assert!(image.mask.count() > 100 && a.c0().data().iter().any(|c| c.norm() > 0.5));
    let planes = [(a.c0(), b.c0()), (a.c2(), b.c2())];
    let inked = planes.iter().flat_map(|(a, b)| a.data().iter().zip(b.data()).zip(image.mask.data()));
    inked.filter(|(_, ink)| **ink).map(|((a, b), _)| (a - b).norm()).fold(0.0, f32::max)
}

/// Over clean drawings and scans, smaller than a tile and larger.
fn agrees_with_the_engine(backend: &str) {
    let weights = Weights::built_in().unwrap();
    for (name, corner, size) in
        [("kettle.png", (100, 60), (150, 90)), ("plan.png", (0, 0), (300, 290)), ("leaf.jpg", (120, 120), (270, 280))]
    {
        let worst = difference(&part(name, corner, size), &weights, backend);
        assert!(worst < TOLERANCE, "{backend}, {name}: {worst}");
    }
}

#[test]
fn the_tensor_library_agrees_with_the_engine() {
    agrees_with_the_engine("flex");
}

#[test]
#[cfg(feature = "ndarray")]
fn ndarray_agrees_with_the_engine() {
    agrees_with_the_engine("ndarray");
}

/// Needs a GPU, or a software driver that stands for one.
#[test]
#[cfg(feature = "gpu")]
fn the_gpu_agrees_with_the_engine() {
    agrees_with_the_engine("gpu");
}
