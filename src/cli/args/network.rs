//! Where the field of directions comes from.

use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// Where the network runs.
#[derive(Debug, Args)]
#[command(next_help_heading = "Network")]
pub(crate) struct DeviceArgs {
    /// What runs the network: `cpu` is the program's own engine, the fastest on the CPU; `flex`, `ndarray` and `gpu`
    /// are backends of the tensor library, which have to be built in
    #[arg(long, value_name = "DEVICE", default_value = "auto",
          value_parser = ["auto", "cpu", "flex", "ndarray", "gpu"])]
    pub(crate) device: String,
}

/// Where the field comes from.
#[derive(Debug, Args)]
#[command(next_help_heading = "Network")]
pub(crate) struct FieldSourceArgs {
    /// What gives the directions: the trained network, or the structure tensor of the ink
    #[arg(long, value_name = "KIND", default_value = DEFAULT_ESTIMATOR)]
    pub(crate) estimator: Estimator,
    #[command(flatten)]
    pub(crate) network: NetworkArgs,
}

/// Which network, and where it runs.
#[derive(Debug, Args)]
#[command(next_help_heading = "Network")]
pub(crate) struct NetworkArgs {
    /// Weights of the network, in place of those that the program carries
    #[arg(long, value_name = "FILE")]
    pub(crate) weights: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) device: DeviceArgs,
}

pub(crate) const DEFAULT_ESTIMATOR: &str = "unet";

/// A source of fields.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Estimator {
    /// The trained network
    Unet,
    /// The fourth-order structure tensor
    Tensor,
}
