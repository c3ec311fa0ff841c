//! The options that choose an executor, the same for every verb that runs programs.

use brdf_sdk::Result;

use crate::exec::{Opened, Precision, open};
use crate::layout::word;

#[derive(Debug, Clone, clap::Args)]
pub(super) struct Machine {
    /// The device, by its index or a part of its name (see `brdf devices`); `cpu` for this machine's cores
    #[arg(long, value_name = "DEVICE")]
    device: Option<String>,
    /// What the program's floats are; f64 runs on the cores
    #[arg(long, value_enum, value_name = "PRECISION", default_value_t)]
    pub(super) precision: Precision,
}

impl Machine {
    pub(super) fn open(&self) -> Result<Opened> {
        open(self.device.as_deref(), self.precision)
    }

    /// The options that choose it again.
    pub(super) fn words(&self) -> Vec<String> {
        let device = self.device.iter().flat_map(|device| ["--device".to_owned(), device.clone()]);
        let precision = (self.precision != Precision::default())
            .then(|| ["--precision".to_owned(), word(&self.precision)]);
        device.chain(precision.into_iter().flatten()).collect()
    }
}
