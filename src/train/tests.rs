//! Training of a very small network.

use super::*;
use crate::unet::{Input, UNet, UNetConfig, Weights};
use burn::store::{BurnpackStore, ModuleSnapshot};
use burn::tensor::{Device, Tensor};
use std::path::Path;
use std::sync::Arc;

fn tiny() -> TrainConfig {
    TrainConfig {
        steps: 6,
        batch: 4,
        crop: 16,
        sheet: 32,
        crops_a_sheet: 2,
        warmup: 2,
        validate_every: 3,
        validation_sheets: 2,
        network: UNetConfig { width: 4, levels: 1, patch: 2, input: Input::Tensor, ..UNetConfig::default() },
        ..TrainConfig::default()
    }
}

/// Trains from start to end.
fn train(config: TrainConfig, dir: &Path, progress: impl FnMut(&Progress) -> bool) -> UNet {
    let mut trainer = Trainer::new(config, dir, &Device::flex(), &Start::Fresh).unwrap();
    trainer.run(progress).unwrap();
    trainer.model()
}

/// The weights by name, as bytes.
fn numbers(model: &UNet) -> Vec<(String, Vec<u8>)> {
    let mut store = BurnpackStore::from_bytes(None);
    model.save_into(&mut store).unwrap();
    let reader = burn::store::burn_pack::Reader::from_bytes(store.get_bytes().unwrap()).unwrap();
    let parts = reader.into_tensors().unwrap().into_iter().map(|t| t.into_parts().unwrap());
    let mut all: Vec<_> = parts.map(|(name, _, _, _, bytes)| (name, bytes.to_vec())).collect();
    all.sort();
    all
}

/// Names of the weights that differ.
fn differing(a: &UNet, b: &UNet) -> Vec<String> {
    let pairs = numbers(a).into_iter().zip(numbers(b));
    pairs.filter(|(a, b)| a != b).map(|(a, _)| a.0).collect()
}

#[test]
fn a_resumed_run_ends_where_an_unbroken_one_does() {
    let [whole, broken, again] = [0, 1, 2].map(|_| tempfile::tempdir().unwrap());
    let device = Device::flex();
    let mut seen = 0;
    let unbroken = train(tiny(), whole.path(), |_| {
        seen += 1;
        true
    });
    assert_eq!(seen, 6);
    let mut first = Trainer::new(tiny(), broken.path(), &device, &Start::Fresh).unwrap();
    first.run(|p| p.step < 4).unwrap();
    assert_eq!(first.step(), 4);
    let mut second = Trainer::new(tiny(), broken.path(), &device, &Start::Resume).unwrap();
    assert_eq!(second.step(), 4);
    second.run(|_| true).unwrap();
    let again = train(tiny(), again.path(), |_| true);
    assert_eq!(differing(&again, &unbroken), [""; 0], "a run does not repeat");
    assert_eq!(differing(&second.model(), &unbroken), [""; 0]);
    let csv = |dir: &tempfile::TempDir| std::fs::read_to_string(dir.path().join("metrics.csv")).unwrap();
    let without_seconds = |text: String| -> Vec<String> {
        text.lines().map(|l| l.split(',').enumerate().filter(|(i, _)| *i != 1).map(|(_, v)| v).collect()).collect()
    };
    assert_eq!(without_seconds(csv(&whole)), without_seconds(csv(&broken)));
    let curves = std::fs::read_to_string(whole.path().join("curves.svg")).unwrap();
    assert!(curves.contains("<polyline") && curves.contains("scan"));
    assert!(whole.path().join("best.safetensors").is_file() && whole.path().join("last.safetensors").is_file());
}

#[test]
fn a_killed_run_tells_no_step_twice() {
    let [dir, aside] = [0, 1].map(|_| tempfile::tempdir().unwrap());
    let resume = || Trainer::new(tiny(), dir.path(), &Device::flex(), &Start::Resume).unwrap();
    train(tiny(), dir.path(), |p| p.step < 4);
    let (checkpoint, older) = (dir.path().join("checkpoint"), aside.path().join("checkpoint"));
    std::fs::rename(&checkpoint, &older).unwrap();
    std::fs::create_dir(&checkpoint).unwrap();
    for file in std::fs::read_dir(&older).unwrap() {
        let file = file.unwrap();
        std::fs::copy(file.path(), checkpoint.join(file.file_name())).unwrap();
    }
    let metrics = || {
        let text = std::fs::read_to_string(dir.path().join("metrics.csv")).unwrap();
        text.lines().map(|l| l.split(',').next().unwrap().to_owned()).collect::<Vec<_>>()
    };
    resume().run(|_| true).unwrap();
    assert_eq!(metrics(), ["step", "3", "6"]);
    // As if it had been killed on its way, after the metrics but before the checkpoint.
    std::fs::remove_dir_all(&checkpoint).unwrap();
    std::fs::rename(&older, &checkpoint).unwrap();
    resume().run(|_| true).unwrap();
    assert_eq!(metrics(), ["step", "3", "6"]);
}

#[test]
fn a_loss_that_is_not_a_number_stops_the_run() {
    let dir = tempfile::tempdir().unwrap();
    let config = TrainConfig { rate: 1e30, warmup: 1, ..tiny() };
    let mut trainer = Trainer::new(config, dir.path(), &Device::flex(), &Start::Fresh).unwrap();
    let error = trainer.run(|_| true).unwrap_err().to_string();
    assert!(error.contains("not a number") && error.contains("lower rate"), "{error}");
}

#[test]
fn runs_that_cannot_start_say_why() {
    let dir = tempfile::tempdir().unwrap();
    let device = Device::flex();
    let refused = |config: TrainConfig, dir: &Path, start: Start, reason: &str| {
        let error = Trainer::new(config, dir, &device, &start).err().expect("is refused").to_string();
        assert!(error.contains(reason), "{error}");
    };
    refused(tiny(), dir.path(), Start::Resume, "no run");
    train(TrainConfig { steps: 1, ..tiny() }, dir.path(), |_| true);
    refused(tiny(), dir.path(), Start::Resume, "another configuration");
    refused(tiny(), dir.path(), Start::Fresh, "already");
    let other = tempfile::tempdir().unwrap();
    refused(tiny(), other.path(), Start::BuiltIn, "another shape");
    refused(tiny(), other.path(), Start::From("missing.safetensors".into()), "missing.safetensors");
    refused(TrainConfig { svgs: Some("missing".into()), ..tiny() }, other.path(), Start::Fresh, "missing");
}

#[test]
fn svgs_without_strokes_are_named_and_left_out() {
    let dir = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(dir.path().join(name), text).unwrap();
    let svg = |body: &str| format!("<svg xmlns='http://www.w3.org/2000/svg' width='24' height='24'>{body}</svg>");
    write("filled.svg", &svg("<path d='M2 2h9v9z'/>"));
    write("broken.svg", "<svg");
    write("notes.txt", "no drawing");
    assert!(Source::with_svgs(dir.path()).unwrap_err().to_string().contains("no SVG with strokes"));
    write("stroked.svg", &svg("<path d='M2 2h9v9' fill='none' stroke='black'/>"));
    let (source, skipped) = Source::with_svgs(dir.path()).unwrap();
    let names: Vec<_> = skipped.iter().map(|(p, _)| p.file_name().unwrap().to_str().unwrap()).collect();
    assert_eq!((source.len(), names), (1, vec!["broken.svg", "filled.svg"]));
    let config = TrainConfig { svg_share: 1.0, ..tiny() };
    let sample = batch(&config, &source, 0);
    assert!(sample.weights.iter().any(|w| *w > 0.0));
    assert_ne!(sample.input, batch(&config, &Source::synthetic(), 0).input);
}

/// The first batch that shows ink: sheets and crops may be blank.
fn inked(config: &TrainConfig) -> Sample {
    let mut batches = (0..).map(|step| batch(config, &Source::synthetic(), step));
    batches.find(|sample| sample.weights.iter().any(|w| *w > 0.0)).unwrap()
}

#[test]
fn training_on_one_batch_makes_the_loss_small() {
    let config = TrainConfig { angle: 0.0, gamma: 0.0, ..tiny() };
    let device = Device::flex().autodiff();
    let batch = Batch::new(inked(&config), config.batch, config.crop, &device);
    let mut model = config.network.init(&device, 1);
    let mut optimizer = burn::optim::AdamConfig::new().with_epsilon(1e-8).init();
    let mut losses = Vec::new();
    for _ in 0..60 {
        let total = Loss::new(model.forward(batch.input.clone()), &batch).total(&config);
        losses.push(total.clone().into_scalar::<f32>());
        let gradients = burn::optim::GradientsParams::from_grads(total.backward(), &model);
        model = optimizer.step(1e-2, model, gradients);
    }
    assert!(losses[59] < 0.5 * losses[0], "{} {}", losses[0], losses[59]);
}

#[test]
fn one_image_is_learned_by_heart() {
    let config = TrainConfig::read(Path::new("samples/paper/one.toml")).unwrap();
    let mut last = None;
    let model = by_heart(&config, &Device::flex(), |iteration| last = Some(iteration)).unwrap();
    let last = last.unwrap();
    assert_eq!(last.number, 50);
    assert!(last.on_all <= 1e-5, "{last:?}");
    let error = Validator::new(&config, &Source::synthetic()).run(&model, &Device::flex()).clean;
    assert!(error.ink < 1.0 && error.mse < 1e-3, "{error:?}");
}

#[test]
fn a_set_of_images_is_seen_once_an_epoch() {
    let config = TrainConfig { images: 6, primitives: 2, crops_a_sheet: 1, batch: 3, sheet: 16, scans: 0.0, ..tiny() };
    let source = Arc::new(Source::synthetic());
    let received: Vec<Sample> = batches(&config, &source, 0..4).iter().collect();
    assert!(received.iter().enumerate().all(|(step, s)| s.input == batch(&config, &source, step).input));
    let images = |steps: &[Sample]| {
        let n = received[0].input.len() / 3;
        let mut all: Vec<Vec<u32>> =
            steps.iter().flat_map(|s| s.input.chunks(n)).map(|i| i.iter().map(|v| v.to_bits()).collect()).collect();
        all.sort();
        all.dedup();
        all
    };
    let (first, second) = (images(&received[..2]), images(&received[2..]));
    assert_eq!((first.len(), &first), (6, &second));
    assert_ne!(received[0].input, received[2].input);
}

#[test]
fn images_that_are_turned_are_so_anew_each_time_and_repeat() {
    let set = TrainConfig { images: 4, crops_a_sheet: 1, batch: 4, sheet: 16, scans: 0.0, ..tiny() };
    let config = TrainConfig { turns: true, ..set.clone() };
    let source = Arc::new(Source::synthetic());
    let received: Vec<Sample> = batches(&config, &source, 3..6).iter().collect();
    assert!(received.iter().zip(3..).all(|(s, step)| s.input == batch(&config, &source, step).input));
    let values = |sample: &Sample| {
        let mut ink: Vec<u32> = sample.weights.iter().map(|v| v.to_bits()).collect();
        ink.sort_unstable();
        ink
    };
    let unturned = batch(&set, &source, 3);
    assert_ne!(received[0].input, unturned.input);
    assert!(received.iter().all(|s| values(s) == values(&unturned)));
    assert_ne!(received[0].input, received[1].input);
}

#[test]
fn the_loss_of_the_truth_is_nothing() {
    let config = TrainConfig { network: UNetConfig { input: Input::Ink, ..tiny().network }, ..tiny() };
    let device = Device::flex();
    let sample = inked(&config);
    let shape = [config.batch, 4, config.crop, config.crop];
    let field = Tensor::from_data(burn::tensor::TensorData::new(sample.target.clone(), shape), &device);
    let batch = Batch::new(sample, config.batch, config.crop, &device);
    let loss = Loss::new(field.clone(), &batch);
    assert!(loss.alignment.into_scalar::<f32>() < 1e-9);
    // The angle is to the field before smoothing.
    assert!(loss.angle.into_scalar::<f32>() < 0.1);
    assert!(Loss::new(field + 0.1, &batch).alignment.into_scalar::<f32>() > 0.03);
}

#[test]
fn batches_come_in_order_and_repeat() {
    let config = tiny();
    let received: Vec<Sample> = batches(&config, &Arc::new(Source::synthetic()), 2..5).iter().collect();
    assert_eq!(received.len(), 3);
    assert_eq!(received[1].input, batch(&config, &Source::synthetic(), 3).input);
    assert_ne!(received[0].target, received[1].target);
}

#[test]
fn configurations_that_cannot_work_are_named() {
    let refused = |config: TrainConfig, word: &str| {
        let error = config.validate().unwrap_err().to_string();
        assert!(error.contains(word), "{error}");
    };
    refused(TrainConfig { crop: 30, ..tiny() }, "crop");
    refused(TrainConfig { batch: 5, ..tiny() }, "batch");
    refused(TrainConfig { rate: 0.0, ..tiny() }, "rate");
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("run.toml");
    std::fs::write(&path, "stepz = 4").unwrap();
    let error = TrainConfig::read(&path).unwrap_err().to_string();
    assert!(error.contains("run.toml") && error.contains("stepz"), "{error}");
    std::fs::write(&path, "steps = 4\n[network]\nwidth = 8").unwrap();
    let config = TrainConfig::read(&path).unwrap();
    assert_eq!((config.steps, config.network.width, config.batch), (4, 8, TrainConfig::default().batch));
}

#[test]
fn saved_weights_give_the_same_field_in_half_precision() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("w.safetensors");
    let config = tiny().network;
    let device = Device::flex();
    let model = config.init(&device, 5);
    crate::unet::save(&path, &config, &model).unwrap();
    let loaded = Weights::read(&path).unwrap();
    assert_eq!(loaded.config(), config);
    let x = Tensor::random([1, config.input.channels(), 8, 8], burn::tensor::Distribution::Default, &device);
    let difference =
        (model.forward(x.clone()) - loaded.model(&device).unwrap().forward(x)).abs().max().into_scalar::<f32>();
    assert!(difference < 1e-2, "{difference}");
    std::fs::write(&path, "nothing").unwrap();
    let error = Weights::read(&path).unwrap_err().to_string();
    assert!(error.contains("w.safetensors"), "{error}");
}
