//! Training of the field network (Taktasheva et al. 2019, section 4) and of the network that sees ink, on drawings and
//! pages made as it goes.

mod by_heart;
mod checkpoint;
mod config;
mod curves;
mod data;
mod ink;
mod loss;
mod pictures;
mod run;
mod source;
mod subject;
#[cfg(test)]
mod tests;
mod turn;
mod validate;

pub use by_heart::{Iteration, by_heart};
pub use config::TrainConfig;
pub use data::{Sample, batch, batches};
pub use ink::{InkError, InkValidation, InkValidator};
pub use loss::{Batch, Loss};
pub use run::{Progress, Start, Trainer};
pub use source::{Skipped, Source};
pub use subject::Verdict;
pub use turn::Turn;
pub use validate::{FieldError, Validation, Validator};
