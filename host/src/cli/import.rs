//! `brdf import`: a file of BRDF Explorer as a plugin folder to carry on from.

use std::path::PathBuf;

use brdf_sdk::manifest::MANIFEST_FILE;
use brdf_sdk::{Manifest, Problem, Result};

use super::machine::Machine;
use super::{conform, print};
use crate::registry::Registry;
use crate::registry::explorer::{self, Values};
use crate::template::{self, Texts};

#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// A model (.brdf), or values for one (.bparam), which become a preset of the plugin
    file: PathBuf,
    /// The folder to make; its last part names the plugin [default: the file's name without its ending]
    #[arg(short, long, value_name = "FOLDER")]
    output: Option<PathBuf>,
    /// Write no report of the laws beside it
    #[arg(long)]
    no_report: bool,
    #[command(flatten)]
    machine: Machine,
}

/// The page on the laws, beside the manifest.
const REPORT: &str = "conformance.html";

pub(super) fn run(registry: &Registry, arguments: &Arguments) -> Result<()> {
    if !explorer::is_file(&arguments.file) {
        let there = arguments.file.is_file();
        return Err(Problem::new(
            arguments.file.display().to_string(),
            if there { "it is no file of BRDF Explorer" } else { "there is no such file" },
            "name a .brdf or a .bparam file",
        ));
    }
    let translated = explorer::read(&arguments.file, Values::Preset)?.translated;
    let usual = || PathBuf::from(arguments.file.file_stem().unwrap_or_default());
    let folder = &arguments.output.clone().unwrap_or_else(usual);
    // What would not open is not written.
    let id = template::id_of(folder);
    Manifest::parse(&arguments.file.display().to_string(), &translated.manifest, id)?;
    let texts = Texts { manifest: translated.manifest, wgsl: explorer::tidied(&translated.wgsl) };
    template::make(&texts, folder)?;
    print(&format!("made {0}/{MANIFEST_FILE} and {0}/{id}.wgsl\n", folder.display()))?;
    translated.notes.iter().for_each(|note| eprintln!("note: {note}"));
    if arguments.no_report {
        return Ok(());
    }
    // Most models of this format break a law or two: the report says which, and by how much.
    let page = folder.join(REPORT);
    let plugin = template::path_of(folder);
    conform::run(registry, &conform::Arguments::page_of(plugin, page, &arguments.machine)).map(drop)
}
