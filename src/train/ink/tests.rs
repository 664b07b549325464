use super::super::{Progress, Source, Start, TrainConfig, Trainer, Verdict, batch};
use super::*;
use crate::cancel::Cancel;
use crate::load::Scan;
use crate::raster::Raster;
use crate::unet::{InkNet, UNetConfig, Weights};
use burn::tensor::{Device, Tensor, TensorData};

fn tiny() -> TrainConfig {
    TrainConfig {
        steps: 4,
        batch: 4,
        crop: 32,
        sheet: 64,
        crops_a_sheet: 2,
        warmup: 2,
        validate_every: 2,
        validation_sheets: 1,
        network: UNetConfig { width: 4, widest: Some(8), levels: 2, ..UNetConfig::ink() },
        ..TrainConfig::default()
    }
}

#[test]
fn a_run_leaves_weights_that_see_ink() {
    let dir = tempfile::tempdir().unwrap();
    let mut trainer = Trainer::new(tiny(), dir.path(), &Device::flex(), &Start::Fresh).unwrap();
    let mut verdicts = 0;
    trainer
        .run(|p: &Progress| {
            verdicts += usize::from(matches!(p.validation, Some(Verdict::Ink(_))));
            true
        })
        .unwrap();
    assert_eq!(verdicts, 2);
    let csv = std::fs::read_to_string(dir.path().join("metrics.csv")).unwrap();
    assert!(csv.starts_with("step,seconds,loss,entropy,dice,seen,clean_precision"), "{csv}");
    assert!(dir.path().join("examples.png").is_file() && dir.path().join("curves.svg").is_file());
    let net = InkNet::new(&Weights::read(&dir.path().join("last.safetensors")).unwrap()).unwrap();
    let page = Scan { gray: Raster::filled(70, 45, 0.8), rgb: None, dpi: None };
    let ink = net.coverage(&page, &Cancel::default()).unwrap();
    assert_eq!(ink.size(), (70, 45));
    assert!(ink.data().iter().all(|i| (0.0..=1.0).contains(i)));
}

#[test]
fn batches_repeat_and_hold_ink() {
    let config = tiny();
    let [a, b] = [0, 0].map(|step| batch(&config, &Source::synthetic(), step));
    assert_eq!((a.input.len(), a.target.len()), (4 * 3 * 32 * 32, 4 * 32 * 32));
    assert_eq!((&a.input, &a.target), (&b.input, &b.target));
    assert!(a.input.iter().all(|v| v.abs() <= 0.5) && a.target.iter().all(|v| (0.0..=1.0).contains(v)));
    assert_ne!(a.input, batch(&config, &Source::synthetic(), 1).input);
}

#[test]
fn the_loss_is_least_for_the_truth() {
    let device = Device::flex();
    let ink: Vec<f32> = (0..2 * 256).map(|i| [0.0, 0.0, 0.3, 1.0, 0.7][i % 5]).collect();
    let tensor = |data: Vec<f32>| Tensor::<4>::from_data(TensorData::new(data, [2, 1, 16, 16]), &device);
    let logit = |p: f32| (p.clamp(1e-4, 1.0 - 1e-4) / (1.0 - p.clamp(1e-4, 1.0 - 1e-4))).ln();
    let loss = |change: f32| {
        let logits = ink.iter().map(|&p| logit(p) + change).collect();
        let loss = InkLoss::new(tensor(logits), tensor(ink.clone()));
        [loss.entropy, loss.dice, loss.seen].map(|t| t.into_scalar::<f32>())
    };
    let ([entropy, dice, seen], more, less) = (loss(0.0), loss(0.5), loss(-0.5));
    assert!(dice < 1e-3 && (seen - 1.0).abs() < 1e-3, "{dice} {seen}");
    assert!(entropy < more[0] && entropy < less[0] && dice < more[1] && dice < less[1]);
    assert!(more[2] > 1.0 && less[2] < 1.0);
}

#[test]
fn pages_of_ones_own_are_mixed_in() {
    let dir = tempfile::tempdir().unwrap();
    let write = |name: &str, side: u32, level: u8| {
        image::GrayImage::from_pixel(side, side, image::Luma([level])).save(dir.path().join(name)).unwrap();
    };
    write("page.png", 40, 51);
    write("page.ink.png", 40, 153);
    write("alone.png", 40, 51);
    write("small.png", 20, 51);
    let config = TrainConfig { pages: Some(dir.path().into()), page_share: 1.0, ..tiny() };
    let (source, skipped) = config.source().unwrap();
    let names: Vec<_> = skipped.iter().map(|(p, _)| p.file_name().unwrap().to_str().unwrap()).collect();
    assert_eq!(names, ["alone.png", "small.png"]);
    let sample = batch(&config, &source, 0);
    assert!(
        sample.input.iter().all(|v| (v + 0.3).abs() < 1e-3) && sample.target.iter().all(|v| (v - 0.4).abs() < 1e-3)
    );
    let turned = TrainConfig { turns: true, ..config };
    assert_eq!(batch(&turned, &source, 0).target, sample.target);
}

#[test]
fn kinds_can_be_held_out() {
    use crate::synth::Kind;
    use rand::SeedableRng;
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(1);
    let held_out = [Kind::Blueprint, Kind::Screen];
    assert!((0..500).all(|_| !held_out.contains(&Kind::draw(&mut rng, &held_out))));
    assert!((0..500).any(|_| Kind::draw(&mut rng, &[]) == Kind::Screen));
}
