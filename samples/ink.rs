//! The ink that the network sees on a page: `cargo run --release --example ink -- PAGE OUT.png [WEIGHTS]`.

use fieldtrace::cancel::Cancel;
use fieldtrace::load::{LoadOptions, load};
use fieldtrace::unet::{InkNet, Weights};
use std::path::Path;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [page, out, rest @ ..] = words.as_slice() else { return Err("usage: ink PAGE OUT.png [WEIGHTS]".into()) };
    let network = match rest.first() {
        Some(weights) => InkNet::new(&Weights::read(Path::new(weights))?)?,
        None => InkNet::built_in()?,
    };
    let page = load(Path::new(page), &LoadOptions::default())?.scan;
    let ink = network.coverage(&page, &Cancel::default())?;
    ink.map(|i| ((1.0 - i) * 255.0).round() as u8).into_image().save(out)?;
    Ok(())
}
