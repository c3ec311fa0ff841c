//! `brdf plot`: a BRDF's values as a drawing or as rows of numbers.

mod options;

use std::path::{Path, PathBuf};

use brdf_sdk::{Kind, ParamType, Problem, Result};

use super::machine::Machine;
use super::parameters::{Parameters, has, key_of};
use super::refuse_own_data;
use crate::conformance::albedo::doubt;
use crate::exec::{Executor, Opened};
use crate::figure;
use crate::picture::{check_writable, write_text};
use crate::plot::{Named, View, rows, shown, told_apart};
use crate::plugin::Configured;
use crate::registry::Registry;
use crate::render::Effort;
use crate::render::albedo::directional_albedo;
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
    #[command(flatten)]
    parameters: Parameters,
    /// Plot each BRDF that has the parameter once for each value, colours with `;` between them; several
    /// of them go side by side, first value with first value
    #[arg(long, value_name = "KEY=VALUE,...", allow_hyphen_values = true)]
    vary: Vec<String>,
    #[command(flatten)]
    options: Options,
    #[command(flatten)]
    machine: Machine,
}

pub(super) fn run(registry: &Registry, arguments: &Arguments) -> Result<()> {
    let as_rows = is_rows(&arguments.output)?;
    arguments.options.check(arguments.view)?;
    let subjects = subjects(registry, arguments)?;
    let configured = || subjects.iter().map(|subject| &subject.chosen.configured);
    configured().try_for_each(|brdf| refuse_own_data(&arguments.output, brdf))?;
    check_writable(&arguments.output)?;
    let Opened { mut executor, note } = arguments.machine.open()?;
    note.iter().for_each(|note| eprintln!("note: {note}"));
    let by_samples = Chosen::by_samples(registry)?.configured;
    let settings = arguments.options.settings();
    // Who names one twice shall tell them apart.
    let names: Vec<String> = subjects.iter().map(|subject| subject.name.clone()).collect();
    let named: Vec<Named> = std::iter::zip(told_apart(&names), subjects)
        .map(|(name, subject)| Named { name, brdf: subject.chosen.configured })
        .collect();
    let shown = shown(executor.as_mut(), &by_samples, arguments.view, &settings, &named)?;
    executor.take_notes().iter().for_each(|note| eprintln!("note: {note}"));
    if arguments.view == View::Albedo {
        tell_doubts(executor.as_mut(), &by_samples, settings.phi_v, &named)?;
    }
    if !as_rows {
        figure::notes(&shown, &settings).iter().for_each(|note| eprintln!("note: {note}"));
    }
    let text = match as_rows {
        true => rows(&shown),
        false => figure::svg(&shown, &settings, &[])?,
    };
    write_text(&arguments.output, &text)?;
    super::print(&format!("wrote {}\n", arguments.output.display()))
}

/// Looks at a few angles of each BRDF whether its own sampling can be believed.
fn tell_doubts(
    executor: &mut dyn Executor,
    by_samples: &Configured,
    azimuth: f64,
    named: &[Named],
) -> Result<()> {
    const ANGLES: [f64; 3] = [0.0, 45.0, 80.0];
    for Named { brdf, .. } in named {
        let effort = Effort::new(4096, 4);
        let table = directional_albedo(executor, brdf, by_samples, &ANGLES, azimuth, effort)?;
        if let Some(doubt) = doubt(executor, brdf, azimuth, &table.rows)? {
            eprintln!("WARNING: {doubt}");
        }
    }
    Ok(())
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
    /// By its name and what was set.
    name: String,
    chosen: Chosen,
}

/// Each BRDF as it is set, once for each value that varies.
fn subjects(registry: &Registry, arguments: &Arguments) -> Result<Vec<Subject>> {
    let mut chosen = Vec::new();
    for reference in &arguments.brdfs {
        chosen.push(Chosen::find(registry, Kind::Brdf, reference)?);
    }
    let mut all: Vec<&mut Configured> =
        chosen.iter_mut().map(|chosen| &mut chosen.configured).collect();
    arguments.parameters.apply_each(&mut all)?;
    let nobodys =
        |assignment: &&String| !chosen.iter().any(|chosen| has(&chosen.configured, assignment));
    if let Some(assignment) = arguments.vary.iter().find(nobodys) {
        // Said with the names that there are.
        chosen[0].configured.clone().assign(std::slice::from_ref(assignment))?;
    }
    let vary: Vec<Varied> =
        arguments.vary.iter().map(|text| Varied::read(text)).collect::<Result<_>>()?;
    if let Some(repeated) = vary.iter().enumerate().find_map(|(index, varied)| {
        let set = |text: &String| key_of(text) == varied.key;
        let before = vary[..index].iter().any(|other| other.key == varied.key);
        (before || arguments.parameters.set.iter().any(set)).then_some(&varied.text)
    }) {
        return Err(Problem::new(
            format!("--vary {repeated}"),
            "this parameter is set or varied by another option too",
            "say its values once",
        ));
    }
    let mut subjects: Vec<Subject> = Vec::new();
    for chosen in chosen {
        let set = arguments.parameters.of(&chosen.configured);
        let own: Vec<&Varied> =
            vary.iter().filter(|varied| has(&chosen.configured, &varied.text)).collect();
        for turn in turns(&chosen, &own)? {
            let mut chosen = chosen.clone();
            chosen.configured.assign(&turn)?;
            let words = [chosen.name().to_owned()].into_iter().chain(set.clone()).chain(turn);
            let name = words.collect::<Vec<_>>().join(" ");
            subjects.push(Subject { name, chosen });
        }
    }
    Ok(subjects)
}

/// A parameter that varies.
struct Varied {
    /// As it was given.
    text: String,
    key: String,
    values: Vec<String>,
}

/// Between colours, whose numbers have commas.
const BETWEEN_COLOURS: char = ';';

impl Varied {
    fn read(text: &str) -> Result<Self> {
        let Some((key, values)) = text.split_once('=') else {
            return Err(Problem::new(
                format!("--vary {text}"),
                "there is no `=` in it",
                "write KEY=VALUE,VALUE,...",
            ));
        };
        let between = if values.contains(BETWEEN_COLOURS) { BETWEEN_COLOURS } else { ',' };
        let values = values.split(between).map(|value| value.trim().to_owned()).collect();
        Ok(Self { text: text.to_owned(), key: key.trim().to_owned(), values })
    }
}

/// What is assigned in each turn of what a BRDF has; one turn without anything where nothing varies.
fn turns(chosen: &Chosen, own: &[&Varied]) -> Result<Vec<Vec<String>>> {
    let Some(first) = own.first() else { return Ok(vec![Vec::new()]) };
    for varied in own {
        let problem = |reason: String, cure: &str| {
            Err(Problem::new(format!("--vary {}", varied.text), reason, cure))
        };
        let param = chosen.configured.plugin.manifest.param(&varied.key);
        let colour = param.is_some_and(|param| matches!(param.ty, ParamType::Color { .. }));
        if colour && !varied.text.contains(BETWEEN_COLOURS) {
            return problem(
                "colours have commas of their own".to_owned(),
                "put `;` between them, in quotes: 'KEY=1,0,0;0,1,0'",
            );
        }
        if varied.values.len() != first.values.len() {
            return problem(
                format!(
                    "it has {} values, and `{}` has {}",
                    varied.values.len(),
                    first.key,
                    first.values.len()
                ),
                "give each the same number of values: they are taken in turn",
            );
        }
    }
    let assigned = |turn: usize| {
        own.iter().map(|varied| format!("{}={}", varied.key, varied.values[turn])).collect()
    };
    Ok((0..first.values.len()).map(assigned).collect())
}
