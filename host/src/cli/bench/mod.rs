//! `brdf bench`: speed against error of integrators on scenes.

mod html;
mod markdown;
mod table;

use std::path::{Path, PathBuf};

use brdf_sdk::{Kind, Problem, Result};
use clap::ValueEnum;

use super::parameters::has;
use super::scene::{SceneOptions, positive};
use super::studio::progress_bar;
use super::{Verdict, interrupt, print};
use crate::bench::{
    self, Case, Limits, Plan, Preset, Ran, Report, Row, Wanted, changes, samplers, scenes,
    times_are_compared,
};
use crate::exec::{Executor, Opened, Precision, open};
use crate::file;
use crate::layout::word;
use crate::picture;
use crate::registry::Registry;
use crate::session::{Chosen, Session};

#[derive(Debug, clap::Args)]
#[command(mut_arg("preset", |preset| preset.help(
    "A matrix with a name: quick, seed or hard; or a preset of the BRDFs (see `brdf list`)"
)))]
pub(super) struct Arguments {
    /// BRDFs, each under every map on every shape [default: the scene's]
    brdfs: Vec<String>,
    /// Scenes instead: files, or a folder in whose folders there is a `scene.toml` each, separated by commas
    #[arg(long, value_name = "PATHS", value_delimiter = ',')]
    scenes: Vec<PathBuf>,
    /// Maps, separated by commas [default: the scene's]
    #[arg(long, value_name = "MAPS", value_delimiter = ',')]
    maps: Vec<String>,
    /// Shapes, separated by commas [default: the scene's]
    #[arg(long, value_name = "SHAPES", value_delimiter = ',')]
    shapes: Vec<String>,
    /// Integrators, separated by commas [default: all that can render the scene but sums over texels]
    #[arg(long, value_name = "INTEGRATORS", value_delimiter = ',')]
    integrators: Vec<String>,
    /// Set a parameter of every integrator that has it
    #[arg(long, value_name = "KEY=VALUE", allow_hyphen_values = true)]
    iset: Vec<String>,
    /// Time of rendering of each cell [s] [default: 1, or the preset's]
    #[arg(long, value_name = "S", allow_hyphen_values = true)]
    time: Option<f64>,
    /// Samples of a pixel at the most
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(16..=1 << 28))]
    samples: Option<u64>,
    /// Runs of each cell, whose times are told by median and ends [default: 3]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=99))]
    repeats: Option<u32>,
    /// Independent scrambles that share the samples; their spread is the estimated error. Fewer are more accurate, and
    /// know less of it [default: 16]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=256))]
    replicates: Option<u32>,
    /// The relMSE whose time is told [default: 1e-3]
    #[arg(long, value_name = "RELMSE", allow_hyphen_values = true)]
    target: Option<f64>,
    /// Devices, by index or a part of the name (see `brdf devices`), separated by commas
    #[arg(long, value_name = "DEVICES", value_delimiter = ',')]
    device: Vec<String>,
    /// Where references are kept [default: the platform's folder for caches]
    #[arg(long, value_name = "FOLDER")]
    references: Option<PathBuf>,
    /// Write all figures as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write a row for each step of each cell
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Write which integrator to use and what is wrong with whom, scene by scene, as Markdown
    #[arg(long, value_name = "FILE")]
    md: Option<PathBuf>,
    /// Write a page with curves, winners and pictures after equal times
    #[arg(long, value_name = "FILE")]
    html: Option<PathBuf>,
    /// Tell what became slower or less accurate since this report, beyond noise; exit code 1 where anything did
    #[arg(long, value_name = "JSON")]
    compare: Option<PathBuf>,
    #[command(flatten)]
    scene: SceneOptions,
}

pub(super) fn run(registry: &Registry, arguments: &Arguments) -> Result<Verdict> {
    let plan = arguments.plan(registry)?;
    plan.check()?;
    let old = arguments.compare.as_deref().map(read).transpose()?;
    for (path, ending) in arguments.outputs() {
        if let Some(path) = path {
            check_output(path, ending)?;
        }
    }
    interrupt::listen()?;
    let mut devices = devices(&arguments.device)?;
    let bar = progress_bar(1000);
    let wanted = Wanted {
        store: arguments.references.as_deref(),
        pictures: arguments.html.is_some() || arguments.md.is_some(),
    };
    let ran = bench::run(registry, &plan, &mut devices, wanted, &mut |_, part| {
        bar.set_position((part * 1000.0) as u64);
        !interrupt::asked()
    });
    bar.finish_and_clear();
    let Ran { report, pictures } = ran?;
    if let Some(path) = &arguments.json {
        picture::write_text(path, &report.to_json())?;
    }
    if let Some(path) = &arguments.csv {
        picture::write_text(path, &report.to_csv())?;
    }
    if let Some(path) = &arguments.html {
        picture::write_text(path, &html::page(&report, &pictures)?)?;
    }
    if let Some(path) = &arguments.md {
        picture::write_text(path, &markdown::page(&report, path)?)?;
        markdown::write_pictures(&report, &pictures, path)?;
    }
    print(&table::text(&report))?;
    for path in arguments.outputs().into_iter().filter_map(|(path, _)| path.as_ref()) {
        print(&format!("wrote {}\n", path.display()))?;
    }
    let Some(old) = old else { return Ok(Verdict::Passed) };
    if !times_are_compared(&old, &report) {
        eprintln!("note: a machine was disturbed: times are not compared");
    }
    let found = changes(&old, &report);
    print(&table::changes(&found))?;
    Ok(if found.iter().any(|change| change.worse) { Verdict::Failed } else { Verdict::Passed })
}

impl Arguments {
    fn outputs(&self) -> [(&Option<PathBuf>, &'static str); 4] {
        [(&self.json, "json"), (&self.csv, "csv"), (&self.html, "html"), (&self.md, "md")]
    }

    fn plan(&self, registry: &Registry) -> Result<Plan> {
        let preset = self.scene.preset().and_then(|name| Preset::from_str(name, false).ok());
        let mut plan = match preset {
            Some(preset) => self.of_preset(registry, preset)?,
            None if !self.scenes.is_empty() => self.of_scenes(registry)?,
            None => self.matrix(registry)?,
        };
        let limits = &mut plan.limits;
        limits.seed = self.scene.seed().unwrap_or(limits.seed);
        limits.time = positive("--time", self.time)?.unwrap_or(limits.time);
        limits.samples = self.samples.unwrap_or(limits.samples);
        limits.repeats = self.repeats.unwrap_or(limits.repeats);
        limits.replicates = self.replicates.unwrap_or(limits.replicates);
        limits.target = positive("--target", self.target)?.unwrap_or(limits.target);
        Ok(plan)
    }

    /// A preset's plan; what it is made of is its own.
    fn of_preset(&self, registry: &Registry, preset: Preset) -> Result<Plan> {
        let lists = [&self.integrators, &self.iset];
        if self.names_parts() || lists.iter().any(|l| !l.is_empty()) || !self.scenes.is_empty() {
            return Err(Problem::new(
                format!("--preset {}", word(&preset)),
                "it has scenes and integrators of its own",
                "leave it out, or BRDFs, maps, shapes, parameters, scenes and integrators",
            ));
        }
        let mut plan = preset.plan(registry)?;
        self.change(&mut plan.rows)?;
        Ok(plan)
    }

    /// Whether parts of scenes are named one by one.
    fn names_parts(&self) -> bool {
        let lists = [&self.brdfs, &self.maps, &self.shapes];
        self.scene.names_parts() || lists.iter().any(|list| !list.is_empty())
    }

    /// What is said here of resolution, camera, light and samples holds for every scene.
    fn change(&self, rows: &mut [Row]) -> Result<()> {
        rows.iter_mut().try_for_each(|row| self.scene.change(&mut row.case.scene))
    }

    fn of_scenes(&self, registry: &Registry) -> Result<Plan> {
        if self.names_parts() || self.scene.preset().is_some() {
            return Err(Problem::new(
                "--scenes",
                "scenes have a BRDF, a map and a shape of their own",
                "leave BRDFs, parameters, maps, shapes and --session out",
            ));
        }
        let cases = scenes(registry, &self.scenes)?;
        let integrators = match (self.integrators.is_empty(), cases.first()) {
            (true, Some(case)) => samplers(registry, &case.scene),
            _ => found(registry, &self.integrators)?,
        };
        let integrators = set(integrators, &self.iset)?;
        let rows = cases.into_iter().map(|case| Row::new(case, integrators.clone()));
        let mut rows: Vec<Row> = rows.collect();
        self.change(&mut rows)?;
        Ok(Plan { rows, limits: Limits::default() })
    }

    fn matrix(&self, registry: &Registry) -> Result<Plan> {
        let mut scene = self.scene.session(registry)?;
        if self.scene.has_no_size() {
            scene.film.resolution = [128, 128];
        }
        let brdfs = self.scene.brdfs(registry, &self.brdfs, &scene).map_err(|problem| {
            // The presets of BRDFs and those of benchmarks share the option.
            match self
                .scene
                .preset()
                .is_some_and(|name| problem.thing == format!("--preset {name}"))
            {
                true => {
                    let own: Vec<_> = Preset::value_variants().iter().map(word).collect();
                    let cure = format!(
                        "for a benchmark: {}; for the BRDF: {}",
                        own.join(", "),
                        problem.cure
                    );
                    Problem { cure, ..problem }
                }
                false => problem,
            }
        })?;
        let or = |given: &[String], own: &str| match given.is_empty() {
            true => vec![own.to_owned()],
            false => given.to_vec(),
        };
        let maps = or(&self.maps, &scene.environment.map);
        let shapes = or(&self.shapes, &scene.shape);
        let integrators = match self.integrators.is_empty() {
            true => samplers(registry, &scene),
            false => found(registry, &self.integrators)?,
        };
        let integrators = set(integrators, &self.iset)?;
        let limits = Limits { seed: scene.effort.seed, ..Limits::default() };
        let mut plan = Plan::matrix(&scene, &brdfs, &maps, &shapes, &integrators, limits);
        plan.rows.iter_mut().for_each(|row| self.scene.resample(&mut row.case.scene.environment));
        Ok(plan)
    }
}

/// The integrators of these names.
pub(super) fn found(registry: &Registry, names: &[String]) -> Result<Vec<Chosen>> {
    names.iter().map(|name| Chosen::find(registry, Kind::Integrator, name)).collect()
}

/// Sets parameters of all integrators that have them.
fn set(mut found: Vec<Chosen>, assignments: &[String]) -> Result<Vec<Chosen>> {
    for assignment in assignments {
        let known = |chosen: &Chosen| has(&chosen.configured, assignment);
        if !found.iter().any(known) {
            return Err(Problem::new(
                format!("--iset {assignment}"),
                "none of the integrators has this parameter",
                "see `brdf list`",
            ));
        }
        for chosen in found.iter_mut().filter(|chosen| known(chosen)) {
            chosen.configured.assign(std::slice::from_ref(assignment))?;
        }
    }
    Ok(found)
}

fn devices(names: &[String]) -> Result<Vec<Box<dyn Executor>>> {
    let choices: Vec<Option<&str>> = match names.is_empty() {
        true => vec![None],
        false => names.iter().map(|name| Some(name.as_str())).collect(),
    };
    let mut devices: Vec<Box<dyn Executor>> = Vec::new();
    for choice in choices {
        let Opened { executor, note } = open(choice, Precision::F32)?;
        if let Some(note) = note {
            eprintln!("note: {note}");
        }
        if devices.iter().any(|known| known.name() == executor.name()) {
            return Err(Problem::new(
                executor.name(),
                "this device is named twice",
                "name each once",
            ));
        }
        devices.push(executor);
    }
    Ok(devices)
}

fn read(path: &Path) -> Result<Report> {
    let name = path.display().to_string();
    let text = file::read_text(path, "name a report that --json wrote")?;
    Report::from_json(&name, &text)
}

fn check_output(path: &Path, ending: &str) -> Result<()> {
    if !path.extension().is_some_and(|own| own.eq_ignore_ascii_case(ending)) {
        return Err(Problem::new(
            format!("--{ending} {}", path.display()),
            match ending {
                "md" => "this option writes Markdown".to_owned(),
                _ => format!("this option writes {}", ending.to_uppercase()),
            },
            format!("give a name that ends in .{ending}"),
        ));
    }
    picture::check_writable(path)
}

/// One scene as it is, for whoever tries integrators on it.
pub(super) fn case_of(scene: Session) -> Case {
    let name = scene.brdf.name().to_owned();
    Case { name, about: String::new(), scene }
}
