//! `brdf import`: a file of BRDF Explorer as a plugin folder to carry on from.

use std::path::{Path, PathBuf};

use brdf_sdk::manifest::MANIFEST_FILE;
use brdf_sdk::{Manifest, Problem, Result};
use glsl_brdf::Preset;

use super::machine::Machine;
use super::{conform, print};
use crate::registry::Registry;
use crate::registry::explorer::{self, Read, Values};
use crate::template::{self, Texts};

#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// A model (.brdf), or values for one (.bparam), which become a preset of the plugin
    file: PathBuf,
    /// The folder to make; its last part names the plugin
    #[arg(short, long, value_name = "FOLDER")]
    output: PathBuf,
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
    let Read { translated, preset, .. } = explorer::read(&arguments.file, Values::Preset)?;
    let mut manifest = translated.manifest;
    if let Some(preset) = preset {
        manifest += &preset_text(&arguments.file, &preset, &translated.keys);
    }
    let folder = &arguments.output;
    // What would not open is not written.
    let id = template::id_of(folder);
    Manifest::parse(&arguments.file.display().to_string(), &manifest, id)?;
    let texts = Texts { manifest, wgsl: explorer::tidied(&translated.wgsl) };
    template::make(&texts, folder)?;
    print(&format!("made {0}/{MANIFEST_FILE} and {0}/{id}.wgsl\n", folder.display()))?;
    translated.notes.iter().for_each(|note| eprintln!("note: {note}"));
    if arguments.no_report {
        return Ok(());
    }
    // Most models of this format break a law or two: the report says which, and by how much.
    let page = folder.join(REPORT);
    let reference = template::path_of(folder);
    print(&conform::judge(registry, &arguments.machine, &reference, &page)?)?;
    print(&format!("wrote {}\n", page.display()))
}

/// The values of a file as a preset that is called as the file is.
fn preset_text(file: &Path, preset: &Preset, keys: &[(String, String)]) -> String {
    let mut name: String = explorer::id_of(file)
        .chars()
        .map(|c| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '_' })
        .collect();
    if !name.starts_with(|c: char| c.is_ascii_lowercase()) || name == "as_in_the_file" {
        name.insert_str(0, "preset_");
    }
    let value = |numbers: &[f64], is_switch: bool| match numbers {
        [number] if is_switch => (*number != 0.0).to_string(),
        [number] => format!("{number:?}"),
        numbers => format!("{numbers:?}"),
    };
    let set: Vec<String> = preset
        .values
        .iter()
        .filter_map(|(own, numbers)| {
            let (key, _) = keys.iter().find(|(_, known)| known == own)?;
            Some(format!("{key} = {}", value(numbers, preset.switches.contains(own))))
        })
        .collect();
    let about = format!("From the file {}.", file.display()).replace(['"', '\\'], "_");
    format!("\n[presets.{name}]\nabout = \"{about}\"\nset = {{ {} }}\n", set.join(", "))
}
