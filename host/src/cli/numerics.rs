//! `brdf numerics`: how many digits a BRDF's functions keep, and which lines lose them.

use std::fmt::Write as _;

use brdf_sdk::{Kind, Manifest, ParamValue, Result};

use super::parameters::Parameters;
use super::print;
use crate::link::Function;
use crate::numerics::{FunctionReport, Line, ROUNDING, Unblamed, Worst, measure};
use crate::registry::Registry;
use crate::session::Chosen;

/// Lines shown for a function; `--json` has them all.
const SHOWN: usize = 5;
/// Widest line of the report.
const WIDTH: usize = 100;

#[derive(Debug, clap::Args)]
#[command(
    mut_arg("preset", |preset| preset.help("Start from a preset of the BRDF (see `brdf list`); its parameters are not varied")),
    mut_arg("set", |set| set.help("Set a parameter of the BRDF; it is not varied"))
)]
pub(super) struct Arguments {
    /// A BRDF's name or folder
    brdf: String,
    #[command(flatten)]
    parameters: Parameters,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

pub(super) fn run(registry: &Registry, arguments: &Arguments) -> Result<()> {
    let mut brdf = Chosen::find(registry, Kind::Brdf, &arguments.brdf)?.configured;
    arguments.parameters.apply(&mut brdf)?;
    let fixed = arguments.parameters.keys(&brdf);
    let report = measure(&brdf, &fixed)?;
    report.notes.iter().for_each(|note| eprintln!("note: {note}"));
    if arguments.json {
        // Numbers and texts only; if it could not be written, the fault shows here.
        let text = serde_json::to_string(&report)
            .unwrap_or_else(|error| format!("{{\"error\": \"{error}\"}}"));
        return print(&format!("{text}\n"));
    }
    let manifest = &brdf.plugin.manifest;
    let mut text = format!("{}: f32 beside f64 over hard cases", arguments.brdf);
    if !fixed.is_empty() {
        let _ = write!(text, ", with {} fixed", fixed.join(", "));
    }
    text.push('\n');
    for function in &report.functions {
        text.push('\n');
        describe(&mut text, &arguments.brdf, manifest, function);
    }
    print(&text)
}

fn describe(text: &mut String, brdf: &str, manifest: &Manifest, found: &FunctionReport) {
    let FunctionReport { function, settings, errors, lines, unblamed } = found;
    let number = |error: Option<f64>| error.map_or("-".to_owned(), |error| format!("{error:.1e}"));
    let measure = if *function == Function::Sample { "angle [rad]" } else { "relative error" };
    let _ = writeln!(
        text,
        "{}: {} cases, at {settings} settings of the parameters\n  \
         {measure:<16}median {}, 99th percentile {}, largest {}\n  {:<16}{}",
        function.name(),
        errors.cases,
        number(errors.median),
        number(errors.percentile_99),
        number(errors.largest),
        "not finite",
        errors.nonfinite
    );
    for (count, what) in [
        (errors.nonfinite_in_f64, "are not finite in f64 either: the formula, not the precision"),
        (errors.beyond_f32, "are larger than any f32: the value, not the precision"),
    ] {
        if count > 0 {
            let _ = writeln!(text, "  {count} {what}");
        }
    }
    // A worst case of mere rounding teaches nothing.
    let worst = errors.worst.as_ref().filter(|_| errors.largest > Some(ROUNDING));
    for (what, input) in [
        ("worst", worst),
        ("not finite", errors.first_nonfinite.as_ref()),
        ("not finite in f64", errors.first_nonfinite_in_f64.as_ref()),
    ] {
        if let Some(input) = input {
            show_input(text, what, brdf, manifest, *function, input);
        }
    }
    if lines.is_empty() {
        text.push_str("  no line stands out: rounding only\n");
    } else {
        text.push_str(
            "  where it arises; error, bits cancelled, cases in which it is the worst line:\n",
        );
    }
    for line in lines.iter().take(SHOWN) {
        show_line(text, line);
    }
    if lines.len() > SHOWN {
        let _ = writeln!(text, "  and {} lines with less (--json)", lines.len() - SHOWN);
    }
    if unblamed.cases > 0 {
        let Unblamed { cases, error } = unblamed;
        let _ = writeln!(text, "  in {cases} more cases roundings add up, to {error:.1e} at most");
    }
}

fn show_input(
    text: &mut String,
    what: &str,
    brdf: &str,
    manifest: &Manifest,
    function: Function,
    input: &Worst,
) {
    // A density stands in all three channels.
    let channels = if function == Function::Pdf { 1 } else { 3 };
    let results = |values: [f64; 3]| {
        values[..channels].iter().map(|value| format!("{value:.6e}")).collect::<Vec<_>>().join(" ")
    };
    let _ = writeln!(text, "  {what}: {}", results(input.f32.map(f64::from)));
    let _ = writeln!(text, "  {:>1$} {2}", "in f64:", what.len() + 1, results(input.f64));
    let row = |v: &[f32; 3]| v.map(|c| c.to_string()).join(" ");
    let set = changed(manifest, input);
    let _ = match function {
        Function::Sample => {
            writeln!(
                text,
                "    wo {}  u {}{}",
                row(&input.wo),
                row(&input.u),
                if set.is_empty() { set } else { format!("\n     {set}") }
            )
        }
        _ => writeln!(
            text,
            "    echo {} {} |\n      brdf eval {brdf}{set}",
            row(&input.wo),
            row(&input.wi)
        ),
    };
}

/// `--set` options for the parameters that are not at their defaults.
fn changed(manifest: &Manifest, input: &Worst) -> String {
    let differs = |key: &str, value: &str| {
        manifest.param(key).is_none_or(|param| ParamValue::default_of(param).to_string() != value)
    };
    let set = input.parameters.iter().filter(|(key, value)| differs(key, value));
    set.map(|(key, value)| format!(" --set {key}={value}")).collect()
}

fn show_line(text: &mut String, line: &Line) {
    let Line { file, line: number, error, cancelled_bits, cases, .. } = line;
    let _ = writeln!(text, "    {error:>7.1e} {cancelled_bits:>3.0} {cases:>7}  {file}:{number}");
    // Of a long line the part around the mark, and tabs as one space, as problems are shown.
    const INDENT: usize = 8;
    let end = line.column - 1 + line.length;
    let first = end.saturating_sub(WIDTH - INDENT).min(line.column - 1);
    let shown: String = line.excerpt.chars().skip(first).take(WIDTH - INDENT).collect();
    let before = line.column - 1 - first;
    let mark = "^".repeat(line.length.min(WIDTH - INDENT - before));
    let shown = shown.replace(char::is_control, " ");
    let _ = writeln!(text, "      | {shown}\n      | {}{mark}", " ".repeat(before));
}
