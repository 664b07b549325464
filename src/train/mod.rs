//! Training of the field network: Taktasheva et al. 2019, section 4, on drawings made as it goes.

mod checkpoint;
mod config;
mod data;
mod loss;
mod run;
#[cfg(test)]
mod tests;
mod validate;

pub use config::TrainConfig;
pub use data::{Sample, batch, batches, observed};
pub use loss::{Batch, Loss};
pub use run::{Progress, Trainer, train};
pub use validate::{AngularError, Validation, Validator, without_network};
