//! Trains the field network: `train_unet CONFIG.toml DIR [--bench N | --look DIR]`.

use fieldtrace::train::{Batch, TrainConfig, Trainer, batch, observed, without_network};
use fieldtrace::{ground_truth, synth};
use rand::SeedableRng;
use std::path::Path;
use std::time::Instant;

#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let args: Vec<String> = std::env::args().collect();
    let config = TrainConfig::read(Path::new(&args[1]))?;
    let dir = Path::new(&args[2]);
    let device = burn::tensor::Device::flex();
    if args.get(3).is_some_and(|a| a == "--look") {
        return look(dir);
    }
    if args.get(3).is_some_and(|a| a == "--field") {
        return field(dir, Path::new(&args[4]), Path::new(&args[5]));
    }
    let t = Instant::now();
    let b = batch(&config, 0);
    eprintln!("batch in {:?}", t.elapsed());
    drop(Batch::new(b, config.batch, config.crop, &device));
    eprintln!("without network: {:?}", without_network(&config));
    let limit: usize = args.get(4).map_or(usize::MAX, |n| n.parse().unwrap());
    let from = std::env::var_os("FROM");
    let mut trainer = Trainer::new(config, dir, &device, true, from.as_deref().map(Path::new))?;
    let (mut t, mut n) = (Instant::now(), 0);
    trainer.run(|p| {
        n += 1;
        if n % 20 == 0 {
            let l = p.loss;
            println!(
                "{} {:.0} ms a step: loss {:.4} align {:.4} angle {:.2} smooth {:.3}",
                p.step,
                t.elapsed().as_secs_f64() * 50.0,
                l[0],
                l[1],
                l[2].to_degrees(),
                l[3]
            );
            t = Instant::now();
        }
        if let Some(v) = p.validation {
            println!(
                "VAL {} {:.0}s clean {:.3}/{:.2} mse {:.4} scan {:.3}/{:.2} mse {:.4}",
                p.step, p.seconds, v.clean.ink, v.clean.junction, v.clean.mse, v.scan.ink, v.scan.junction, v.scan.mse
            );
            t = Instant::now();
        }
        n < limit
    })?;
    Ok(())
}

/// The field of an image: WEIGHTS (or `built-in`, or `tensor`) IMAGE OUT.npz.
fn field(weights: &Path, input: &Path, out: &Path) -> Result<(), Box<dyn std::error::Error>> {
    use fieldtrace::estimate::{FieldEstimator, StructureTensor, UNet};
    use fieldtrace::options::Options;
    let scan = fieldtrace::load::load(input, &Default::default())?.scan;
    let (w, h) = scan.gray.size();
    let t = Instant::now();
    let image = fieldtrace::clean::clean(&scan, &Options::default());
    let cleaned = t.elapsed();
    let net: Box<dyn FieldEstimator> = match weights.to_str() {
        Some("built-in") => Box::new(UNet::built_in()?),
        Some("tensor") => Box::new(StructureTensor::default()),
        _ if std::env::var_os("BURN").is_some() => {
            let device = burn::tensor::Device::flex();
            Box::new(UNet::on_device(fieldtrace::unet::load(weights, &device)?, device))
        }
        _ => Box::new(UNet::from_file(weights)?),
    };
    let t = Instant::now();
    let field = net.estimate(&image)?;
    let ms = t.elapsed().as_secs_f64() * 1e3;
    eprintln!(
        "clean {cleaned:?}, field {ms:.1} ms, {:.1} ms a megapixel, scale {}",
        ms * 1e6 / (w * h) as f64,
        image.scale
    );
    fieldtrace::field::write_npz(&field.resized(w, h), std::fs::File::create(out)?)?;
    Ok(())
}

/// Pictures of synthetic data: render, scan, ink.
fn look(dir: &Path) -> Result<(), Box<dyn std::error::Error>> {
    std::fs::create_dir_all(dir)?;
    for seed in 0..12u64 {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
        let drawing = synth::drawing(&mut rng, 144);
        let ink = fieldtrace::render::render(&drawing);
        let style = synth::ScanStyle::draw(&mut rng);
        let gray = synth::scan(&mut rng, &ink, &style);
        let back = synth::ink_of_scan(&gray);
        let truth = ground_truth::field(&drawing);
        let mut out = image::GrayImage::new(144 * 4, 144);
        for y in 0..144 {
            for x in 0..144 {
                let near = if truth.near_junction[(x, y)] && truth.ink[(x, y)] {
                    0.0
                } else if truth.ink[(x, y)] {
                    0.6
                } else {
                    1.0
                };
                for (k, v) in [1.0 - ink[(x, y)], gray[(x, y)], 1.0 - back[(x, y)], near].into_iter().enumerate() {
                    out.put_pixel((x + k * 144) as u32, y as u32, image::Luma([(v * 255.0) as u8]));
                }
            }
        }
        out.save(dir.join(format!("{seed}.png")))?;
    }
    let _ = observed(
        &mut rand_chacha::ChaCha8Rng::seed_from_u64(0),
        &synth::drawing(&mut rand_chacha::ChaCha8Rng::seed_from_u64(0), 64),
        true,
    );
    Ok(())
}
