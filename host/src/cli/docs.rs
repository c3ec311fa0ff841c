//! `brdf docs`: the catalogue of BRDFs as a page with pictures.

use std::path::PathBuf;
use std::sync::Arc;

use brdf_sdk::{Kind, Result};

use super::studio::progress_bar;
use super::{Verdict, print};
use crate::catalogue::{Catalogue, Entry, INTEGRATOR, RECIPE, Workshop};
use crate::open;
use crate::registry::Registry;
use crate::session::{Chosen, Light};

#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// The folder that has, or gets, catalogue.md and the pictures in catalogue/
    #[arg(value_name = "DIR", default_value = "docs")]
    folder: PathBuf,
    /// Write nothing; print a line for each file that is not what would be written
    #[arg(long)]
    check: bool,
}

pub(super) fn run(registry: &Registry, arguments: &Arguments) -> Result<Verdict> {
    let folder = &arguments.folder;
    Catalogue::check_folder(folder)?;
    let catalogue = Catalogue::new(&entries(registry)?);
    let shown = folder.display();
    let pictures = catalogue.pictures();
    if arguments.check {
        let stale = catalogue.stale(folder)?;
        if stale.is_empty() {
            print(&format!("the catalogue in {shown} with {pictures} pictures is up to date\n"))?;
            return Ok(Verdict::Passed);
        }
        print(&stale.iter().map(|line| format!("{line}\n")).collect::<String>())?;
        return Ok(Verdict::Failed);
    }
    catalogue.write(folder)?;
    catalogue.strays(folder).iter().for_each(|line| eprintln!("note: {line}"));
    print(&format!("wrote the catalogue in {shown} with {pictures} pictures\n"))?;
    Ok(Verdict::Passed)
}

/// All BRDFs that there are, each with its pictures.
fn entries(registry: &Registry) -> Result<Vec<Entry>> {
    let found = registry.all(Kind::Brdf);
    let plugins = found.into_iter().map(|found| found.plugin).collect::<Result<Vec<_>>>()?;
    let light = Light { map: RECIPE.to_owned(), ..Light::default() };
    let environment = Arc::new(open::environment(registry, &light)?);
    let integrator = Chosen::find(registry, Kind::Integrator, INTEGRATOR)?.configured;
    let mut workshop = Workshop::new(environment, integrator)?;
    let bar = progress_bar(plugins.len() as u64);
    let mut entries = Vec::new();
    for plugin in &plugins {
        let entry = workshop.entry(plugin)?;
        bar.suspend(|| {
            entry.notes.iter().for_each(|note| eprintln!("note: {}: {note}", plugin.id));
        });
        entries.push(entry);
        bar.inc(1);
    }
    bar.finish_and_clear();
    Ok(entries)
}
