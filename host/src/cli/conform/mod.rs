//! `brdf conform`: holds BRDFs to the laws, and says for each what decided.

mod html;
mod plots;
mod table;

pub(super) use table::mark;

use std::path::{Path, PathBuf};

use brdf_sdk::{Kind, Problem, Result};

use super::bench::found;
use super::machine::Machine;
use super::parameters::Parameters;
use super::{Verdict as Exit, print};
use crate::conformance::{Law, References, Report, Wanted, conform, subject};
use crate::plugin::Configured;
use crate::registry::Registry;
use crate::session::Chosen;

#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// Names or folders of BRDFs; without any, all that `brdf list` shows
    brdfs: Vec<String>,
    /// Judge this law; may be given several times. Without any, all of them
    #[arg(long = "law", value_enum, value_name = "LAW")]
    laws: Vec<Law>,
    /// Integrators for the law of the furnace, by names or folders, separated by commas [default: all that `brdf list`
    /// shows]
    #[arg(long, value_name = "INTEGRATORS", value_delimiter = ',')]
    integrators: Vec<String>,
    #[command(flatten)]
    parameters: Parameters,
    /// More settings of the parameters and more views: minutes instead of seconds
    #[arg(long)]
    deep: bool,
    /// Fit a sampler to the values of BRDFs that have no `sample` and `pdf`, and judge it, instead of the cosine
    #[arg(long)]
    fit_sampler: bool,
    /// A file of values from elsewhere, or a folder of such files, for the law of references; those
    /// that are about another BRDF are passed over
    #[arg(long, value_name = "PATH")]
    references: Vec<PathBuf>,
    /// Write a page with the verdicts and plots here (.html): densities drawn and expected, albedo, variance
    #[arg(long, value_name = "FILE")]
    html: Option<PathBuf>,
    /// Print JSON
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    machine: Machine,
}

impl Arguments {
    /// All laws for one BRDF, with a page of them.
    pub(super) fn page_of(brdf: String, page: PathBuf, machine: &Machine) -> Self {
        Self {
            brdfs: vec![brdf],
            laws: Vec::new(),
            integrators: Vec::new(),
            parameters: Parameters::default(),
            deep: false,
            fit_sampler: false,
            references: Vec::new(),
            html: Some(page),
            json: false,
            machine: machine.clone(),
        }
    }
}

pub(super) fn run(registry: &Registry, arguments: &Arguments) -> Result<Exit> {
    arguments.html.as_deref().map_or(Ok(()), html::check)?;
    let mut brdfs = chosen(registry, &arguments.brdfs)?;
    let mut all: Vec<&mut Configured> = brdfs.iter_mut().map(|(_, brdf)| brdf).collect();
    arguments.parameters.apply_each(&mut all)?;
    brdfs.iter_mut().for_each(|(_, brdf)| brdf.fit_sampler = arguments.fit_sampler);
    let references = references(registry, &brdfs, &arguments.references)?;
    let named = match arguments.integrators.as_slice() {
        [] => registry.all(Kind::Integrator).into_iter().map(|found| found.id).collect(),
        named => named.to_vec(),
    };
    let integrators: Vec<Configured> =
        found(registry, &named)?.into_iter().map(|integrator| integrator.configured).collect();
    let opened = arguments.machine.open()?;
    opened.note.iter().for_each(|note| eprintln!("note: {note}"));
    let mut executor = opened.executor;
    let mut reports: Vec<Report> = Vec::new();
    for ((reference, brdf), references) in brdfs.iter().zip(references) {
        let wanted = Wanted {
            laws: arguments.laws.clone(),
            deep: arguments.deep,
            integrators: integrators.clone(),
            references,
        };
        let report = conform(executor.as_mut(), brdf, &wanted)?;
        executor.take_notes().iter().for_each(|note| eprintln!("note: {note}"));
        if !arguments.json {
            print(&table::table(reference, &report))?;
        }
        reports.push(report);
    }
    if arguments.json {
        // Numbers and texts only; if it could not be written, the fault shows here.
        let text = serde_json::to_string(&reports)
            .unwrap_or_else(|error| format!("{{\"error\": \"{error}\"}}"));
        print(&format!("{text}\n"))?;
    } else {
        print(&table::closing(&reports.iter().collect::<Vec<_>>()))?;
    }
    if let Some(path) = &arguments.html {
        let names = brdfs.iter().map(|(reference, _)| reference.as_str());
        let named: Vec<(&str, &Report)> = names.zip(&reports).collect();
        html::write(path, &named, arguments.deep)?;
    }
    let holds = reports.iter().all(Report::holds);
    Ok(if holds { Exit::Passed } else { Exit::Failed })
}

/// What is named, by the words that named it.
fn chosen(registry: &Registry, names: &[String]) -> Result<Vec<(String, Configured)>> {
    let all: Vec<String> = match names {
        [] => registry.all(Kind::Brdf).into_iter().map(|found| found.id).collect(),
        names => names.to_vec(),
    };
    let find = |name: String| {
        let configured = Chosen::find(registry, Kind::Brdf, &name)?.configured;
        Ok((name, configured))
    };
    all.into_iter().map(find).collect()
}

/// What the files say of each BRDF, all read before anything is judged.
fn references(
    registry: &Registry,
    brdfs: &[(String, Configured)],
    paths: &[PathBuf],
) -> Result<Vec<Vec<References>>> {
    let files = reference_files(paths)?;
    let known: Vec<String> = registry.all(Kind::Brdf).into_iter().map(|found| found.id).collect();
    for (file, id) in &files {
        let judged = brdfs.iter().any(|(_, brdf)| brdf.plugin.id == *id);
        if !judged && !known.contains(id) {
            eprintln!("note: {} is about `{id}`, which is not judged here", file.display());
        }
    }
    let of = |brdf: &Configured| {
        let about = files.iter().filter(|(_, id)| *id == brdf.plugin.id);
        about.map(|(file, _)| References::load(file, &brdf.plugin)).collect()
    };
    brdfs.iter().map(|(_, brdf)| of(brdf)).collect()
}

/// The files, with the BRDF that each is about.
fn reference_files(paths: &[PathBuf]) -> Result<Vec<(PathBuf, String)>> {
    let mut files = Vec::new();
    for path in paths {
        let unreadable = |error: std::io::Error| {
            Problem::new(
                format!("--references {}", path.display()),
                error.to_string(),
                "name a .toml file of references or a folder of them",
            )
        };
        if path.is_dir() {
            let mut inside: Vec<PathBuf> = std::fs::read_dir(path)
                .and_then(|entries| entries.map(|entry| Ok(entry?.path())).collect())
                .map_err(unreadable)?;
            inside.retain(|file: &PathBuf| file.extension().is_some_and(|end| end == "toml"));
            inside.sort();
            if inside.is_empty() {
                return Err(unreadable(std::io::Error::other("there is no .toml file in it")));
            }
            files.extend(inside);
        } else {
            std::fs::metadata(path).map_err(unreadable)?;
            files.push(path.clone());
        }
    }
    let of = |file: PathBuf| subject(Path::new(&file)).map(|id| (file, id));
    files.into_iter().map(of).collect()
}
