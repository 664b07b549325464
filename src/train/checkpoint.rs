//! A run on disk: enough to go on as if it had never stopped.

use super::config::TrainConfig;
use crate::error::{Error, Result};
use crate::unet::UNet;
use burn::module::Module;
use burn::optim::{ModuleOptimizer, OptimizerRecord};
use burn::store::{BurnpackStore, ModuleSnapshot};
use serde::{Deserialize, Serialize};
use std::fs;
use std::path::{Path, PathBuf};

/// What a run remembers beside weights and moments.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Steps that are done.
    pub step: usize,
    /// Best validation score so far.
    pub best: Option<f64>,
    /// Validations since the best.
    pub stale: usize,
    /// Seconds of training so far.
    pub seconds: f64,
    /// Sums of the loss and its three parts since the last line of metrics, and how many steps they are of.
    pub sums: ([f64; 4], usize),
}

/// Writes a checkpoint beside the last and then puts it in its place, so that a kill leaves one of the two.
pub fn save(dir: &Path, config: &TrainConfig, state: &State, model: &UNet, optimizer: &ModuleOptimizer) -> Result<()> {
    let (fresh, current, old) = (dir.join("checkpoint.new"), dir.join("checkpoint"), dir.join("checkpoint.old"));
    let _ = fs::remove_dir_all(&fresh);
    fs::create_dir_all(&fresh).map_err(|cause| Error::Write { path: fresh.clone(), cause })?;
    // Running statistics are updated lazily; this brings those of `model` up to date.
    drop(model.valid());
    let mut store = BurnpackStore::from_file(fresh.join("model.bpk")).overwrite(true);
    model.save_into(&mut store).map_err(failed)?;
    optimizer.to_record().save(fresh.join("optimizer.bpk")).map_err(failed)?;
    let json = serde_json::to_string_pretty(&(config, state)).map_err(failed)?;
    let path = fresh.join("state.json");
    fs::write(&path, json).map_err(|cause| Error::Write { path, cause })?;
    let _ = fs::remove_dir_all(&old);
    let _ = fs::rename(&current, &old);
    fs::rename(&fresh, &current).map_err(|cause| Error::Write { path: current, cause })?;
    let _ = fs::remove_dir_all(&old);
    Ok(())
}

/// The folder of the newest whole checkpoint in a run's directory.
fn folder(dir: &Path) -> Option<PathBuf> {
    ["checkpoint", "checkpoint.old"].map(|name| dir.join(name)).into_iter().find(|d| d.join("state.json").is_file())
}

/// Whether a directory holds a checkpoint.
pub fn exists(dir: &Path) -> bool {
    folder(dir).is_some()
}

/// The configuration and the state of a checkpoint; `None` where the directory holds none.
pub fn state(dir: &Path) -> Result<Option<(TrainConfig, State)>> {
    let Some(from) = folder(dir) else { return Ok(None) };
    let path = from.join("state.json");
    let input = path.display().to_string();
    let json = fs::read_to_string(&path).map_err(|cause| Error::Read { input, cause })?;
    serde_json::from_str(&json).map_err(failed).map(Some)
}

/// Reads a checkpoint; `None` where the directory holds none.
pub fn load(
    dir: &Path,
    mut model: UNet,
    optimizer: ModuleOptimizer,
) -> Result<Option<(TrainConfig, State, UNet, ModuleOptimizer)>> {
    let (Some(from), Some((config, state))) = (folder(dir), state(dir)?) else { return Ok(None) };
    model.load_from(&mut BurnpackStore::from_file(from.join("model.bpk"))).map_err(failed)?;
    let record = OptimizerRecord::load(from.join("optimizer.bpk")).map_err(failed)?;
    let optimizer = optimizer.load_record(record);
    Ok(Some((config, state, model, optimizer)))
}

fn failed(cause: impl std::fmt::Display) -> Error {
    Error::Train { reason: format!("checkpoint: {cause}") }
}
