//! `brdf eval`: a BRDF's values for scripts and notebooks.

use std::fmt::Write as _;
use std::io::Read;
use std::path::PathBuf;
use std::sync::Arc;

use brdf_sdk::{Kind, Problem, Result};
use serde_json::json;

use super::machine::Machine;
use super::parameters::Parameters;
use super::print;
use crate::conformance::albedo::doubt;
use crate::exec::{Executor, Opened, Precision};
use crate::file;
use crate::link::{View, link};
use crate::numerics::unit;
use crate::plugin::Configured;
use crate::registry::Registry;
use crate::render::Effort;
use crate::render::albedo::{self, Albedo};
use crate::render::evaluate::{Pair, Scattered, evaluate};
use crate::session::Chosen;

#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// A BRDF's name or folder
    brdf: String,
    /// Rows wo_x wo_y wo_z wi_x wi_y wi_z, separated by commas or spaces, local frame; directions are
    /// normalised. Standard input without
    file: Option<PathBuf>,
    #[command(flatten)]
    parameters: Parameters,
    /// Write the directional albedo against the angle of wo instead
    #[arg(long, conflicts_with = "file")]
    albedo: bool,
    /// Angles of wo in the table of albedos [degrees]
    #[arg(
        long,
        value_name = "DEG,...",
        value_delimiter = ',',
        requires = "albedo",
        allow_hyphen_values = true
    )]
    angles: Vec<f64>,
    /// Azimuth of wo in the table of albedos, from the tangent [degrees]
    #[arg(
        long,
        value_name = "DEG",
        default_value_t = 0.0,
        requires = "albedo",
        allow_hyphen_values = true
    )]
    azimuth: f64,
    /// Print JSON instead of CSV
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    machine: Machine,
}

pub(super) fn run(registry: &Registry, arguments: &Arguments) -> Result<()> {
    let mut brdf = Chosen::find(registry, Kind::Brdf, &arguments.brdf)?.configured;
    arguments.parameters.apply(&mut brdf)?;
    if arguments.albedo {
        return albedo_table(registry, arguments, &brdf);
    }
    let pairs = read_pairs(arguments)?;
    let program = Arc::new(link(&View::Eval { brdf: brdf.clone() })?);
    program.notes.iter().for_each(|note| eprintln!("note: {note}"));
    let mut executor = open(&arguments.machine)?;
    let rows = evaluate(executor.as_mut(), &program, &brdf, &pairs)?;
    executor.take_notes().iter().for_each(|note| eprintln!("note: {note}"));
    let finite = |row: &&Scattered| {
        row.f.iter().chain(&row.weight).chain([&row.pdf]).all(|value| value.is_finite())
    };
    let nonfinite = rows.len() - rows.iter().filter(finite).count();
    if nonfinite > 0 {
        eprintln!("note: {nonfinite} rows hold Inf or NaN");
    }
    let digits = Digits(arguments.machine.precision);
    if arguments.json {
        let rows: Vec<_> =
            pairs.iter().zip(&rows).map(|(pair, row)| as_json(digits, pair, row)).collect();
        return print(&format!("{}\n", serde_json::Value::Array(rows)));
    }
    let mut text = String::from("f_r,f_g,f_b,pdf,weight_r,weight_g,weight_b\n");
    for Scattered { f, pdf, weight } in rows {
        let row = [f[0], f[1], f[2], pdf, weight[0], weight[1], weight[2]];
        let row = row.map(|value| digits.of(value));
        let _ = writeln!(text, "{}", row.join(","));
    }
    print(&text)
}

/// Opens the executor, and says so where it was not asked for.
fn open(machine: &Machine) -> Result<Box<dyn Executor>> {
    let Opened { executor, note } = machine.open()?;
    note.iter().for_each(|note| eprintln!("note: {note}"));
    Ok(executor)
}

/// Writes as many digits as were computed.
#[derive(Clone, Copy)]
struct Digits(Precision);

impl Digits {
    fn of(self, value: f64) -> String {
        match self.0 {
            Precision::F32 => (value as f32).to_string(),
            Precision::F64 => value.to_string(),
        }
    }

    fn json(self, values: &[f64]) -> Vec<serde_json::Value> {
        let json = |value: &f64| match self.0 {
            Precision::F32 => (*value as f32).into(),
            Precision::F64 => (*value).into(),
        };
        values.iter().map(json).collect()
    }
}

/// JSON has no Inf and no NaN: they become null.
fn as_json(digits: Digits, pair: &Pair, row: &Scattered) -> serde_json::Value {
    json!({
        "wo": pair.wo, "wi": pair.wi, "f": digits.json(&row.f),
        "pdf": digits.json(&[row.pdf])[0], "weight": digits.json(&row.weight)
    })
}

fn read_pairs(arguments: &Arguments) -> Result<Vec<Pair>> {
    let (name, text) = match &arguments.file {
        Some(path) => (path.display().to_string(), std::fs::read_to_string(path)),
        None => {
            let mut text = String::new();
            ("standard input".to_owned(), std::io::stdin().read_to_string(&mut text).map(|_| text))
        }
    };
    let text = text.map_err(|error| {
        Problem::new(
            &name,
            format!("the rows cannot be read: {}", file::why(&error)),
            "name a text file of rows",
        )
    })?;
    let mut pairs = Vec::new();
    let mut at = 0;
    let mut header_may_come = true;
    for line in text.split_inclusive('\n') {
        let span = at..at + line.trim_end().len();
        at += line.len();
        // Some programs begin their tables with a byte order mark.
        let line = line.trim_start_matches('\u{feff}').trim();
        let fields: Vec<&str> = line
            .split([',', ' ', '\t', ';'])
            .map(str::trim)
            .filter(|field| !field.is_empty())
            .collect();
        if fields.is_empty() || line.starts_with('#') {
            continue;
        }
        // A header is the first row, and no number is in it.
        let header = header_may_come && fields.iter().all(|field| field.parse::<f64>().is_err());
        header_may_come = false;
        if header {
            continue;
        }
        let bad = |reason: &str| {
            Problem::at(
                &name,
                &text,
                span.clone(),
                reason,
                "write wo_x wo_y wo_z wi_x wi_y wi_z, six finite numbers",
            )
        };
        let numbers: Option<Vec<f64>> =
            fields.iter().map(|field| field.parse().ok().filter(|n: &f64| n.is_finite())).collect();
        let numbers =
            numbers.ok_or_else(|| bad("this row holds something that is no finite number"))?;
        let [ox, oy, oz, ix, iy, iz] = numbers[..] else {
            return Err(bad(&format!("this row has {} entries", numbers.len())));
        };
        match (unit([ox, oy, oz]), unit([ix, iy, iz])) {
            (Some(wo), Some(wi)) => pairs.push(Pair { wo, wi }),
            _ => return Err(bad("this row holds a direction of length 0")),
        }
    }
    if pairs.is_empty() {
        return Err(Problem::new(
            name,
            "it holds no rows",
            "write wo_x wo_y wo_z wi_x wi_y wi_z, one pair a row",
        ));
    }
    Ok(pairs)
}

fn albedo_table(registry: &Registry, arguments: &Arguments, brdf: &Configured) -> Result<()> {
    let angles = if arguments.angles.is_empty() {
        albedo::ANGLES.to_vec()
    } else {
        arguments.angles.clone()
    };
    if let Some(angle) = angles.iter().find(|angle| !(0.0..90.0).contains(*angle)) {
        return Err(Problem::new(
            format!("--angles {angle}"),
            "wo must lie above the horizon",
            "give angles of at least 0 and below 90 degrees",
        ));
    }
    if !arguments.azimuth.is_finite() {
        return Err(Problem::new(
            format!("--azimuth {}", arguments.azimuth),
            "this is no finite number",
            "write a finite number of degrees",
        ));
    }
    let integrator = Chosen::by_samples(registry)?.configured;
    let mut executor = open(&arguments.machine)?;
    let effort = Effort::new(4096, 64);
    let table = albedo::directional_albedo(
        executor.as_mut(),
        brdf,
        &integrator,
        &angles,
        arguments.azimuth,
        effort,
    )?;
    table.notes.iter().for_each(|note| eprintln!("note: {note}"));
    if let Some(doubt) = doubt(executor.as_mut(), brdf, arguments.azimuth, &table.rows)? {
        eprintln!("WARNING: {doubt}");
    }
    if arguments.json {
        let rows: Vec<_> = table
            .rows
            .iter()
            .map(|row| json!({ "theta": row.theta, "albedo": row.albedo, "std_error": row.std_error }))
            .collect();
        return print(&format!("{}\n", serde_json::Value::Array(rows)));
    }
    let mut text = String::from("theta,albedo_r,albedo_g,albedo_b,error_r,error_g,error_b\n");
    for Albedo { theta, albedo: [r, g, b], std_error: [er, eg, eb] } in table.rows {
        let _ = writeln!(text, "{theta},{r:.7},{g:.7},{b:.7},{er:.1e},{eg:.1e},{eb:.1e}");
    }
    print(&text)
}
