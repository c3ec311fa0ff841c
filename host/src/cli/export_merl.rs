//! `brdf export-merl`: any BRDF as a MERL file.

use std::path::PathBuf;

use brdf_sdk::{Kind, Problem, Result};

use super::machine::Machine;
use super::{apply, print};
use crate::exec::Opened;
use crate::registry::Registry;
use crate::session::Chosen;
use crate::tabulation::{self, Tabulated};

#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// A BRDF's name or folder, or a data file
    brdf: String,
    /// Set a parameter of the BRDF
    #[arg(long, value_name = "KEY=VALUE", allow_hyphen_values = true)]
    set: Vec<String>,
    /// The file to write; the BRDF's name with .binary without
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    #[command(flatten)]
    machine: Machine,
}

pub(super) fn run(registry: &Registry, arguments: &Arguments) -> Result<()> {
    let mut brdf = Chosen::find(registry, Kind::Brdf, &arguments.brdf)?.configured;
    apply(&mut brdf, &arguments.set)?;
    let id = &brdf.plugin.id;
    let output = arguments.output.clone().unwrap_or_else(|| PathBuf::from(format!("{id}.binary")));
    let shown = output.display().to_string();
    let Opened { mut executor, note } = arguments.machine.open()?;
    note.iter().for_each(|note| eprintln!("note: {note}"));
    let tabulated = tabulation::tabulate(executor.as_mut(), &brdf)?;
    std::fs::write(&output, &tabulated.bytes).map_err(|error| {
        Problem::new(&shown, error.to_string(), "name a place that can be written to with -o")
    })?;
    let merl = Chosen::find(registry, Kind::Brdf, &shown)?.configured;
    let Tabulated { unseen, anisotropy, .. } = tabulated;
    let mut text = format!("{shown}: {id} in 90 x 90 x 180 bins, {unseen} of them never seen\n");
    for (interpolation, off) in tabulation::distance(executor.as_mut(), &brdf, &merl)? {
        let [median, most, worst] = [off.median, off.most, off.worst].map(|part| 100.0 * part);
        text.push_str(&format!(
            "  {interpolation}: off by {median:.2} % in the middle, {most:.2} % for 95 in 100 pairs, \
             {worst:.1} % at worst\n"
        ));
    }
    executor.take_notes().iter().for_each(|note| eprintln!("note: {note}"));
    if anisotropy > tabulation::ROUNDING {
        eprintln!(
            "note: {id} is anisotropic: turning both directions changes it by up to {:.1} %, and a MERL file \
             holds one turn of it",
            100.0 * anisotropy
        );
    }
    print(&text)
}
