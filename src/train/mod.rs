//! Training of the field network: Taktasheva et al. 2019, section 4, on drawings made as it goes.

mod by_heart;
mod checkpoint;
mod config;
mod curves;
mod data;
mod loss;
mod pictures;
mod run;
mod source;
#[cfg(test)]
mod tests;
mod turn;
mod validate;

pub use by_heart::{Iteration, by_heart};
pub use config::TrainConfig;
pub use data::{Sample, batch, batches};
pub use loss::{Batch, Loss};
pub use run::{Progress, Start, Trainer};
pub use source::{Skipped, Source};
pub use turn::Turn;
pub use validate::{FieldError, Validation, Validator};
