use super::*;

#[test]
fn what_is_not_computed_counts_as_blank() {
    let weights = Weights::built_in().unwrap();
    let engine = Engine::new(&weights).unwrap();
    let config = weights.config();
    let (n, m) = (17, config.multiple());
    let side = n * m;
    // A dot in the middle cell; cells near it are computed in one run, all cells in the other.
    let mut input = vec![0.0f32; config.input.channels() * side * side];
    input[(side / 2) * side + side / 2] = 1.0;
    let field = |active: Vec<bool>| {
        let mut out = vec![[0.0f32; 4]; side * side];
        let cells = TileCells::new(n, n, active);
        engine.run(&mut Scratch::default(), &input, &cells, |x, y, v| out[y * side + x] = v);
        out[(side / 2) * side + side / 2]
    };
    let near = |i: usize| (i % n).abs_diff(n / 2) <= 6 && (i / n).abs_diff(n / 2) <= 6;
    let (all, some) = (field(vec![true; n * n]), field((0..n * n).map(near).collect()));
    assert!(all.iter().any(|v| v.abs() > 1e-3));
    assert!(all.iter().zip(&some).all(|(a, b)| (a - b).abs() < 1e-4), "{all:?} {some:?}");
}

#[cfg(feature = "train")]
mod against_the_tensor_library {
    use super::*;
    use crate::unet::{Input, Within, save};
    use burn::tensor::{Device, Distribution, Tensor, TensorData};

    /// Weights whose norms are not the identity.
    fn weights(config: &UNetConfig) -> Weights {
        let device = Device::flex();
        device.seed(3);
        let training = device.clone().autodiff();
        let model = config.init(&training, 3);
        for _ in 0..3 {
            let side = 2 * config.multiple();
            let x = Tensor::<4>::random([2, config.input.channels(), side, side], Distribution::Default, &device);
            let _ = model.forward(Tensor::from_data(x.into_data(), &training));
        }
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("random.safetensors");
        save(&path, config, &burn::module::Module::valid(&model)).unwrap();
        Weights::read(&path).unwrap()
    }

    /// The largest difference on computed cells of a random image; the network says `N` numbers of a pixel.
    fn difference<const N: usize>(config: UNetConfig, active: impl Fn(usize) -> bool) -> f32 {
        let (device, weights) = (Device::flex(), weights(&config));
        let (columns, rows, m) = (5, 4, config.multiple());
        let (width, height) = (columns * m, rows * m);
        let shape = [1, config.input.channels(), height, width];
        let x = Tensor::<4>::random(shape, Distribution::Default, &device).into_data();
        let input = x.clone().try_into_vec::<f32>().unwrap();
        let active: Vec<bool> = (0..columns * rows).map(active).collect();
        let seen: Vec<f32> = active.iter().map(|a| f32::from(u8::from(*a))).collect();
        let seen = Tensor::from_data(TensorData::new(seen, [1, 1, rows, columns]), &device);
        let network = Within::new(weights.model(&device).unwrap(), &config, &device);
        let truth = network.forward(Tensor::from_data(x, &device), &seen).into_data().try_into_vec::<f32>().unwrap();
        let count = active.iter().filter(|a| **a).count();
        let cells = TileCells::new(columns, rows, active);
        let (mut worst, mut n) = (0.0f32, 0);
        Engine::new(&weights).unwrap().run(&mut Scratch::default(), &input, &cells, |x, y, values: [f32; N]| {
            n += 1;
            for (k, v) in values.into_iter().enumerate() {
                worst = worst.max((v - truth[(k * height + y) * width + x]).abs());
            }
        });
        assert_eq!(n, count * m * m);
        worst
    }

    #[test]
    fn the_engine_computes_the_same() {
        for (width, levels, patch, input) in
            [(16, 2, 2, Input::Tensor), (16, 3, 2, Input::Tensor), (8, 2, 1, Input::Ink), (12, 1, 2, Input::Ink)]
        {
            let config = UNetConfig { width, levels, patch, input, ..UNetConfig::default() };
            for (what, active) in [("all", (|_| true) as fn(usize) -> bool), ("some", |i| i % 5 < 3 && i != 6)] {
                let worst = difference::<4>(config, active);
                assert!(worst < 1e-4, "w{width} d{levels} p{patch}, {what} cells: {worst}");
            }
        }
    }

    #[test]
    fn the_engine_sees_the_same_ink() {
        for patch in [1, 2] {
            let config = UNetConfig { width: 6, widest: Some(20), levels: 3, patch, ..UNetConfig::ink() };
            let worst = difference::<1>(config, |_| true);
            assert!(worst < 1e-4, "p{patch}: {worst}");
        }
    }
}
