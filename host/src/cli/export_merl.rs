//! `brdf export-merl`: any BRDF as a MERL file.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::PathBuf;

use brdf_sdk::{Kind, Result};

use super::machine::Machine;
use super::parameters::Parameters;
use super::{print, refuse_own_data};
use crate::exec::Opened;
use crate::picture::{check_writable, stage};
use crate::registry::Registry;
use crate::session::Chosen;
use crate::tabulation::{self, Tabulated};

#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// A BRDF's name or folder, or a data file
    brdf: String,
    #[command(flatten)]
    parameters: Parameters,
    /// The file to write; the BRDF's name with .binary without
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    #[command(flatten)]
    machine: Machine,
}

pub(super) fn run(registry: &Registry, arguments: &Arguments) -> Result<()> {
    let chosen = Chosen::find(registry, Kind::Brdf, &arguments.brdf)?;
    let id = chosen.name().to_owned();
    let mut brdf = chosen.configured;
    arguments.parameters.apply(&mut brdf)?;
    let output = arguments.output.clone().unwrap_or_else(|| PathBuf::from(format!("{id}.binary")));
    let shown = output.display().to_string();
    refuse_own_data(&output, &brdf)?;
    check_writable(&output)?;
    let Opened { mut executor, note } = arguments.machine.open()?;
    note.iter().for_each(|note| eprintln!("note: {note}"));
    let tabulated = tabulation::tabulate(executor.as_mut(), &brdf)?;
    let write = |file: &mut BufWriter<&mut File>| {
        file.write_all(&tabulated.bytes).map_err(|error| error.to_string())
    };
    stage(&output, write)?.keep()?;
    let merl = Chosen::find(registry, Kind::Brdf, &shown)?.configured;
    let Tabulated { unseen, anisotropy, .. } = tabulated;
    let mut text = format!("{shown}: {id} in 90 x 90 x 180 bins, {unseen} of them never seen\n");
    for (interpolation, off) in tabulation::distance(executor.as_mut(), &brdf, &merl)? {
        let [median, most, worst] = [off.median, off.most, off.worst].map(|part| 100.0 * part);
        text.push_str(&format!(
            "  {interpolation}: half of the pairs are off by less than {median:.2} %, 95 in 100 by less than \
             {most:.2} %, the worst by {worst:.1} %\n"
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
