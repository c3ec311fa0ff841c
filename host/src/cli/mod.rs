//! The command line: one file per verb. A verb reads its arguments, calls the library and prints.
//!
//! Exit codes: 0 ok, 1 a check failed, 2 usage or unreadable input. Problems go to standard error,
//! one line each (with an excerpt where a text file is at fault); results go to standard output.

mod bench;
mod compare;
mod conform;
mod devices;
mod docs;
mod env;
mod eval;
mod expand;
mod export_merl;
mod import;
mod interrupt;
mod list;
mod machine;
mod man;
mod new;
mod numerics;
mod parameters;
mod plot;
mod recommend;
mod reference;
mod render;
mod report;
mod scene;
mod studio;
mod trust;
mod version;
mod view;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use brdf_sdk::{Problem, Result};
use clap::{CommandFactory, Parser, Subcommand};

use crate::plugin::Configured;
use crate::registry::Registry;

/// Loads BRDFs and integrators as plugins and renders them under an HDR environment.
#[derive(Debug, Parser)]
#[command(name = "brdf", version = version::SHORT, long_version = version::LONG.as_str())]
pub struct Cli {
    /// A folder of plugins, looked into before ./plugins, the user's data folder and the embedded ones
    #[arg(long, global = true, value_name = "DIR")]
    plugins: Vec<PathBuf>,
    /// Run the native libraries of plugins on disk, also those that `brdf trust` was not asked for
    #[arg(long, global = true)]
    allow_native: bool,

    #[command(subcommand)]
    verb: Option<Verb>,
}

#[derive(Debug, Subcommand)]
enum Verb {
    /// Open the viewer; without any verb, too
    View(view::Arguments),
    /// Render one or several BRDFs: a picture each, with its error
    Render(Box<render::Arguments>),
    /// Make a reference by deterministic quadrature, written only where samples agree with it
    Reference(Box<reference::Arguments>),
    /// Measure speed against error: integrators on scenes, each against a reference
    Bench(Box<bench::Arguments>),
    /// Try integrators on a scene for a moment, and say which one to use
    Recommend(Box<recommend::Arguments>),
    /// Evaluate a BRDF: f, pdf and weight for rows of directions, or its directional albedo
    Eval(eval::Arguments),
    /// Plot BRDFs: polar, along angles, albedo, image slice, lobe; as SVG or as CSV
    Plot(Box<plot::Arguments>),
    /// Compare two pictures: how far A is from the reference B, with a map of where
    Compare(compare::Arguments),
    /// Prove BRDFs: reciprocity, energy, sampling, furnace, stability and more, each with its number
    Conform(conform::Arguments),
    /// Find the lines of a BRDF that lose digits: f32 beside f64 over hard cases
    Numerics(numerics::Arguments),
    /// Tell facts about an environment map, and convert it between layouts and formats
    Env(env::Arguments),
    /// List BRDFs, integrators and environments with their parameters
    List(list::Arguments),
    /// Write the catalogue of BRDFs: a page with pictures, made from the plugin folders
    Docs(docs::Arguments),
    /// Make a plugin folder that works as it stands
    New(new::Arguments),
    /// Make a plugin folder of a file of BRDF Explorer (.brdf, .bparam), with a report of the laws it keeps
    Import(import::Arguments),
    /// Print the linked WGSL program, and what was left out of it
    Expand(expand::Arguments),
    /// Trust the native library of a plugin folder: it runs from now on, as long as it does not change
    Trust(trust::Arguments),
    /// Tabulate a BRDF as a MERL file, and say how far the table is from it
    ExportMerl(export_merl::Arguments),
    /// List the devices that can render
    Devices(devices::Arguments),
    /// Write the manual: man pages, or one page of Markdown
    Man(man::Arguments),
    /// Print a completion script for a shell
    Completions {
        /// The shell
        shell: clap_complete::Shell,
    },
}

/// What a verb that checks something found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Verdict {
    Passed,
    Failed,
}

/// Runs the program and says how it ended.
pub fn run() -> ExitCode {
    match run_verb(&Cli::parse()) {
        Ok(Verdict::Passed) => ExitCode::SUCCESS,
        Ok(Verdict::Failed) => ExitCode::from(1),
        Err(problem) => {
            eprintln!("error: {problem}");
            ExitCode::from(2)
        }
    }
}

fn run_verb(cli: &Cli) -> Result<Verdict> {
    missing_folders(&cli.plugins)?;
    let registry = Registry::new(&cli.plugins).allowing_native(cli.allow_native);
    let Some(verb) = &cli.verb else { return view::run(registry, &view::Arguments::default()) };
    match verb {
        Verb::View(arguments) => return view::run(registry, arguments),
        Verb::Render(arguments) => render::run(&registry, arguments)?,
        Verb::Reference(arguments) => return reference::run(&registry, arguments),
        Verb::Bench(arguments) => return bench::run(&registry, arguments),
        Verb::Recommend(arguments) => return recommend::run(&registry, arguments),
        Verb::Eval(arguments) => eval::run(&registry, arguments)?,
        Verb::Plot(arguments) => plot::run(&registry, arguments)?,
        Verb::Compare(arguments) => return compare::run(arguments),
        Verb::Conform(arguments) => return conform::run(&registry, arguments),
        Verb::Numerics(arguments) => numerics::run(&registry, arguments)?,
        Verb::Env(arguments) => return env::run(&registry, arguments),
        Verb::List(arguments) => list::run(&registry, arguments)?,
        Verb::Docs(arguments) => return docs::run(&registry, arguments),
        Verb::New(arguments) => new::run(arguments)?,
        Verb::Import(arguments) => import::run(&registry, arguments)?,
        Verb::Expand(arguments) => expand::run(&registry, arguments)?,
        Verb::Trust(arguments) => trust::run(arguments)?,
        Verb::ExportMerl(arguments) => export_merl::run(&registry, arguments)?,
        Verb::Devices(arguments) => devices::run(arguments)?,
        Verb::Man(arguments) => man::run(Cli::command(), arguments)?,
        Verb::Completions { shell } => {
            let mut script = Vec::new();
            clap_complete::generate(*shell, &mut Cli::command(), "brdf", &mut script);
            print(&String::from_utf8_lossy(&script))?;
        }
    }
    Ok(Verdict::Passed)
}

fn missing_folders(folders: &[PathBuf]) -> Result<()> {
    match folders.iter().find(|folder| !folder.is_dir()) {
        Some(folder) => Err(Problem::new(
            format!("--plugins {}", folder.display()),
            "there is no such folder",
            "name a folder with brdf/ and integrator/ in it",
        )),
        None => Ok(()),
    }
}

/// Prints a result; a reader that has closed its end is no error.
fn print(text: &str) -> Result<()> {
    use std::io::{ErrorKind, Write};
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Problem::new("standard output", error.to_string(), "write to another file"))
        }
        _ => Ok(()),
    }
}

/// What can be opened of several things that are named, and what is wrong with the others, which is told, too.
///
/// # Errors
/// Where none can be opened.
fn readable<T>(
    names: &[String],
    mut open: impl FnMut(&str) -> Result<T>,
) -> Result<(Vec<T>, Vec<Problem>)> {
    let (mut opened, mut problems) = (Vec::new(), Vec::new());
    for name in names {
        match open(name) {
            Ok(thing) => opened.push(thing),
            Err(problem) => problems.push(problem),
        }
    }
    let last = if opened.is_empty() { problems.pop() } else { None };
    problems.iter().for_each(|problem| eprintln!("error: {problem}"));
    match last {
        Some(problem) => Err(problem),
        None => Ok((opened, problems)),
    }
}

/// Refuses to write over the data file that a BRDF is read from.
fn refuse_own_data(output: &Path, brdf: &Configured) -> Result<()> {
    let full = |path: &Path| path.canonicalize().ok();
    match brdf.data_file().and_then(full).is_some_and(|file| full(output) == Some(file)) {
        true => Err(Problem::new(
            output.display().to_string(),
            "the BRDF is read from this file",
            "name another with -o",
        )),
        false => Ok(()),
    }
}
