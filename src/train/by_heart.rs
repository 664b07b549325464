//! One batch, learned by heart: whether a network of a shape can hold a field at all.
//!
//! Taktasheva et al. 2019 fit a single image in 50 iterations. With so few of them the optimiser has to use curvature,
//! so this is L-BFGS with a line search in place of the Adam of long runs.

use super::config::TrainConfig;
use super::data::batch;
use super::loss::{Batch, Loss};
use super::source::Source;
use crate::error::{Error, Result};
use crate::unet::{Output, UNet};
use burn::module::{Module, ModuleVisitor, Param};
use burn::optim::{GradientsParams, LBFGSConfig, LineSearchFn};
use burn::tensor::{Device, Tensor};

/// Updates that one iteration may make.
const UPDATES: usize = 8;

/// How well the batch is known after an iteration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Iteration {
    /// Iterations done.
    pub number: usize,
    /// Mean over the ink pixels of `|c0 - c0*|^2 + |c2 - c2*|^2`.
    pub on_ink: f64,
    /// The same over all pixels, the field masked off the ink.
    pub on_all: f64,
    /// Times that network and gradient were computed so far.
    pub evaluations: usize,
}

/// Fits the first batch of a configuration in `config.steps` iterations; the network's norms take their statistics from
/// that batch.
///
/// # Errors
/// [`Error::Train`] when the configuration is not sound or the loss is no longer a number.
pub fn by_heart(config: &TrainConfig, device: &Device, mut told: impl FnMut(Iteration)) -> Result<UNet> {
    config.validate()?;
    if config.network.output != Output::Field {
        return Err(Error::Train { reason: "only fields are learned by heart".into() });
    }
    let device = device.clone().autodiff();
    let sample = batch(config, &Source::synthetic(), 0);
    let plane = config.crop * config.crop;
    let ink: f32 = sample.weights.chunks_exact(3 * plane).flat_map(|weights| &weights[..plane]).sum();
    let share = f64::from(ink) / (config.batch * plane) as f64;
    let batch = Batch::new(sample, config.batch, config.crop, &device);
    let mut model = config.network.init(&device, config.seed);
    let mut optimizer = LBFGSConfig::new()
        .with_max_iter(UPDATES)
        .with_line_search_fn(LineSearchFn::StrongWolfe)
        .with_tolerance_change(1e-14)
        .with_tolerance_grad(1e-12)
        .init();
    let mut evaluations = 0;
    for number in 1..=config.steps {
        (model, _) = optimizer.step(config.rate, model, |model: UNet| {
            evaluations += 1;
            let loss = Loss::new(model.forward(batch.input.clone()), &batch).total(config);
            let value = loss.clone().into_scalar::<f64>();
            let mut gradients = GradientsParams::from_grads(loss.backward(), &model);
            model.visit(&mut Complete(&mut gradients));
            (value, gradients)
        });
        let on_ink = Loss::new(model.forward(batch.input.clone()), &batch).alignment.into_scalar::<f64>();
        if !on_ink.is_finite() {
            return Err(Error::Train { reason: format!("the loss at iteration {number} is not a number") });
        }
        told(Iteration { number, on_ink, on_all: on_ink * share, evaluations });
    }
    Ok(model.valid())
}

/// Statistics of norms have no gradient, and the optimiser wants one for every number of a module.
struct Complete<'a>(&'a mut GradientsParams);

impl ModuleVisitor for Complete<'_> {
    fn visit_float<const D: usize>(&mut self, param: &Param<Tensor<D>>) {
        if self.0.get::<D>(param.id).is_none() {
            let value = param.val().inner();
            self.0.register(param.id, Tensor::<D>::zeros(value.shape(), &value.device()));
        }
    }
}
