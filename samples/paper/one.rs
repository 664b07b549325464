//! One image of two primitives, learned by heart: `cargo run --release --features train --example paper-one -- DIR`.
//!
//! Writes the alignment error of each iteration to `DIR/metrics.csv` and pictures to `DIR/examples.png`.

use burn::tensor::Device;
use fieldtrace::train::{Source, TrainConfig, Validator, by_heart};
use std::fmt::Write;
use std::path::Path;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let dir = std::env::args().nth(1).unwrap_or_else(|| "runs/one".into());
    let config = TrainConfig::read(Path::new("samples/paper/one.toml"))?;
    let device = Device::flex();
    let mut csv = String::from("iteration,on_ink,on_all,evaluations\n");
    let model = by_heart(&config, &device, |i| {
        let line = format!("{},{:.3e},{:.3e},{}", i.number, i.on_ink, i.on_all, i.evaluations);
        println!("{line}");
        let _ = writeln!(csv, "{line}");
    })?;
    std::fs::create_dir_all(&dir)?;
    std::fs::write(Path::new(&dir).join("metrics.csv"), csv)?;
    let validator = Validator::new(&config, &Source::synthetic());
    println!("{:?}", validator.run(&model, &device).clean);
    validator.draw_examples(&model, &device, &Path::new(&dir).join("examples.png"))?;
    Ok(())
}
