//! `brdf plot`: a BRDF's values as a drawing or as rows of numbers.

mod drawn;
mod options;
mod rows;
mod shown;

use std::io::Write as _;
use std::path::{Path, PathBuf};

use brdf_sdk::{Kind, Problem, Result};
use clap::ValueEnum;

use super::machine::Machine;
use crate::exec::Opened;
use crate::picture::{chart, check_writable, stage};
use crate::registry::Registry;
use crate::session::Chosen;
use options::Options;

#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// BRDFs' names, folders or data files
    #[arg(required = true)]
    brdfs: Vec<String>,
    /// What to plot
    #[arg(long, value_enum)]
    view: View,
    /// The file to write: .svg a drawing, .csv its numbers
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Set a parameter of every BRDF that has it
    #[arg(long, value_name = "KEY=VALUE", allow_hyphen_values = true)]
    set: Vec<String>,
    /// Plot each BRDF that has the parameter once for each value; several of them take their values in turn
    #[arg(long, value_name = "KEY=VALUE,...", allow_hyphen_values = true)]
    vary: Vec<String>,
    #[command(flatten)]
    options: Options,
    #[command(flatten)]
    machine: Machine,
}

/// What is plotted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum View {
    /// f against wo in the plane of wi, around the normal
    Polar,
    /// f against wo's angle in any plane
    ThetaV,
    /// f against the half vector's angle, at a fixed difference
    ThetaH,
    /// f against the difference angle, at a fixed half vector
    ThetaD,
    /// The directional albedo against wo's angle, with a band of two standard errors
    Albedo,
    /// f as colours over theta_h and theta_d
    Slice,
    /// f over all directions of wo, as a surface
    Lobe,
}

pub(super) fn run(registry: &Registry, arguments: &Arguments) -> Result<()> {
    let as_rows = is_rows(&arguments.output)?;
    arguments.options.check(arguments.view)?;
    let subjects = subjects(registry, arguments)?;
    refuse_inputs(&arguments.output, &subjects)?;
    check_writable(&arguments.output)?;
    let Opened { mut executor, note } = arguments.machine.open()?;
    note.iter().for_each(|note| eprintln!("note: {note}"));
    let shown =
        shown::of(registry, executor.as_mut(), arguments.view, &arguments.options, &subjects)?;
    executor.take_notes().iter().for_each(|note| eprintln!("note: {note}"));
    if !as_rows && shown.curves() > chart::COLOURS {
        eprintln!(
            "note: there are {} curves and {} colours, which repeat",
            shown.curves(),
            chart::COLOURS
        );
    }
    let text = match as_rows {
        true => rows::text(&shown),
        false => drawn::svg(&shown, &arguments.options)?,
    };
    stage(&arguments.output, |file| {
        file.write_all(text.as_bytes()).map_err(|error| error.to_string())
    })?
    .keep()?;
    super::print(&format!("wrote {}\n", arguments.output.display()))
}

/// Whether the file shall have numbers and not a drawing.
fn is_rows(output: &Path) -> Result<bool> {
    let extension = output.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    match extension.to_ascii_lowercase().as_str() {
        "svg" => Ok(false),
        "csv" => Ok(true),
        _ => Err(Problem::new(
            output.display().to_string(),
            "a plot is a drawing or rows of numbers",
            "end the name in .svg or in .csv",
        )),
    }
}

/// A BRDF with its parameters, and what it is called.
struct Subject {
    name: String,
    chosen: Chosen,
}

/// No plot takes the place of the data that it shows.
fn refuse_inputs(output: &Path, subjects: &[Subject]) -> Result<()> {
    let full = |path: &Path| path.canonicalize().ok();
    let read = subjects.iter().filter_map(|subject| subject.chosen.configured.data_file());
    match read.into_iter().any(|file| full(file).is_some() && full(file) == full(output)) {
        true => Err(Problem::new(
            output.display().to_string(),
            "a BRDF is read from this file",
            "name another with -o",
        )),
        false => Ok(()),
    }
}

/// Each BRDF as it is set, once for each value that varies.
fn subjects(registry: &Registry, arguments: &Arguments) -> Result<Vec<Subject>> {
    let mut chosen = Vec::new();
    for reference in &arguments.brdfs {
        chosen.push(Chosen::find(registry, Kind::Brdf, reference)?);
    }
    let has = |chosen: &Chosen, assignment: &str| {
        let key = assignment.split('=').next().unwrap_or_default().trim();
        chosen.configured.plugin.manifest.param(key).is_some()
    };
    let nobodys = |assignment: &&String| !chosen.iter().any(|chosen| has(chosen, assignment));
    if let Some(assignment) = arguments.set.iter().chain(&arguments.vary).find(nobodys) {
        // Said with the names that there are.
        super::apply(&mut chosen[0].configured.clone(), std::slice::from_ref(assignment))?;
    }
    let vary = varied(&arguments.vary)?;
    let mut subjects = Vec::new();
    for mut chosen in chosen {
        let own = |list: &[String]| -> Vec<String> {
            list.iter().filter(|assignment| has(&chosen, assignment)).cloned().collect()
        };
        let set = own(&arguments.set);
        let turns: Vec<Vec<String>> =
            vary.iter().map(|turn| own(turn)).filter(|turn| !turn.is_empty()).collect();
        super::apply(&mut chosen.configured, &set)?;
        if turns.is_empty() {
            subjects.push(Subject { name: chosen.name().to_owned(), chosen });
            continue;
        }
        for turn in turns {
            let mut chosen = chosen.clone();
            super::apply(&mut chosen.configured, &turn)?;
            let name = format!("{} {}", chosen.name(), turn.join(" "));
            subjects.push(Subject { name, chosen });
        }
    }
    Ok(subjects)
}

/// The assignments of each turn.
fn varied(vary: &[String]) -> Result<Vec<Vec<String>>> {
    let mut turns: Vec<Vec<String>> = Vec::new();
    for (index, assignment) in vary.iter().enumerate() {
        let Some((key, values)) = assignment.split_once('=') else {
            return Err(Problem::new(
                format!("--vary {assignment}"),
                "there is no `=` in it",
                "write KEY=VALUE,VALUE,...",
            ));
        };
        let values: Vec<&str> = values.split(',').map(str::trim).collect();
        if index > 0 && values.len() != turns.len() {
            return Err(Problem::new(
                format!("--vary {assignment}"),
                format!("it has {} values, and the one before has {}", values.len(), turns.len()),
                "give each the same number of values: they are taken in turn",
            ));
        }
        turns.resize(values.len(), Vec::new());
        for (turn, value) in turns.iter_mut().zip(values) {
            turn.push(format!("{}={value}", key.trim()));
        }
    }
    Ok(turns)
}
