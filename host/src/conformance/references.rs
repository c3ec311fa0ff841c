//! The law of references: values of the literature or of another program, with their source.
//!
//! A file holds values of one BRDF:
//!
//! ```toml
//! brdf = "lambert"
//! source = "Lambert 1760, Photometria"
//! tolerance = 1e-6                       # relative; of each value, where it has none of its own
//!
//! [[values]]
//! set = { albedo = [0.5, 0.5, 0.5] }     # parameters that are not at their defaults
//! wo = [0.0, 0.0, 1.0]
//! wi = [0.6, 0.0, 0.8]
//! f = 0.159154943                        # or `f_cos`, `pdf`; one number or one for each channel
//!
//! [[values]]
//! theta = 60.0                           # angles of `wo` [degrees]; `phi` may be left out
//! albedo = [0.5, 0.5, 0.5]
//! ```

use std::path::Path;
use std::sync::Arc;

use brdf_sdk::table::{Document, Table, Value};
use brdf_sdk::{ParamValues, Result};

use super::settings::{direction, options};
use super::survey::Surveyor;
use super::values::{apart, command, largest};
use super::verdict::{Law, Outcome, Verdict, outcome};
use crate::exec::cpu::Cpu;
use crate::exec::{Executor, Precision};
use crate::file;
use crate::link::{View, link};
use crate::numerics::unit;
use crate::plugin::{Configured, Plugin};
use crate::render::evaluate::{Pair, evaluate};

/// A file of values.
#[derive(Debug, Clone, PartialEq)]
pub struct References {
    /// The BRDF's id.
    pub brdf: String,
    /// Where they come from.
    pub source: String,
    /// The values.
    pub values: Vec<Reference>,
}

/// One value.
#[derive(Debug, Clone, PartialEq)]
pub struct Reference {
    values: ParamValues,
    what: What,
    expected: [f64; 3],
    tolerance: f64,
    line: usize,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum What {
    F(Pair),
    FCos(Pair),
    Pdf(Pair),
    Albedo([f64; 2]),
}

/// The id of the BRDF that a file is about.
pub fn subject(file: &Path) -> Result<String> {
    let source = read(file)?;
    let named = file.display().to_string();
    let document = Document { file: &named, source: &source };
    let mut brdf = String::new();
    // The other keys are read when the BRDF is known.
    document.read(|table| {
        brdf = table.require("brdf", "`brdf = \"...\"`")?.string()?;
        for key in ["source", "tolerance", "values"] {
            table.get(key);
        }
        Ok(())
    })?;
    Ok(brdf)
}

fn read(file: &Path) -> Result<String> {
    file::read_text(file, "name a file of references")
}

impl References {
    /// Reads a file about a BRDF.
    ///
    /// # Errors
    /// What is no reference, at its place.
    pub fn load(file: &Path, plugin: &Arc<Plugin>) -> Result<Self> {
        let source = read(file)?;
        let named = file.display().to_string();
        Document { file: &named, source: &source }.read(|table| {
            let tolerance = tolerance(table)?.unwrap_or(1e-6);
            let brdf = table.require("brdf", "`brdf = \"...\"`")?.string()?;
            let cited =
                table.require("source", "`source = \"author, year, equation\"`")?.string()?;
            let list = table.require("values", "`[[values]]`, at least one")?;
            let mut values = Vec::new();
            for value in list.items()? {
                let line = source[..value.span().start].matches('\n').count() + 1;
                values.push(Reference::read(&value.table()?, plugin, tolerance, line)?);
            }
            if values.is_empty() {
                return Err(list.problem("there are no values", "add a [[values]]"));
            }
            Ok(Self { brdf, source: cited, values })
        })
    }
}

impl Reference {
    fn read(table: &Table<'_>, plugin: &Arc<Plugin>, tolerance: f64, line: usize) -> Result<Self> {
        let mut values = ParamValues::defaults(&plugin.manifest);
        if let Some(set) = table.get("set") {
            values.set_table(&plugin.manifest, &set.table()?)?;
        }
        let channels = |value: &Value<'_>| match value.items() {
            Ok(_) => value.numbers(),
            Err(_) => value.number().map(|grey| [grey; 3]),
        };
        let direction_of = |key: &str| {
            let value = table.require(key, &format!("`{key} = [x, y, z]`"))?;
            unit(value.numbers()?)
                .filter(|w| w[2] > 0.0)
                .ok_or_else(|| value.problem("it is not above the horizon", "give z > 0"))
        };
        let (what, expected) = if let Some(value) = table.get("albedo") {
            let given = table.require("theta", "`theta = 60.0` [degrees]")?;
            let theta = given.number()?;
            if !(0.0..90.0).contains(&theta) {
                return Err(given.problem("it is not above the horizon", "give 0 <= theta < 90"));
            }
            let phi = table.get("phi").map(|phi| phi.number()).transpose()?.unwrap_or(0.0);
            (What::Albedo([theta, phi]), channels(&value)?)
        } else {
            let pair = Pair { wo: direction_of("wo")?, wi: direction_of("wi")? };
            let of = [("f", What::F(pair)), ("f_cos", What::FCos(pair)), ("pdf", What::Pdf(pair))];
            let found = of.into_iter().find_map(|(key, what)| Some((what, table.get(key)?)));
            let Some((what, value)) = found else {
                let span = 0..0;
                return Err(table.problem(
                    span,
                    "a value says nothing",
                    "give `f`, `f_cos`, `pdf` or `albedo`",
                ));
            };
            (what, channels(&value)?)
        };
        let tolerance = self::tolerance(table)?.unwrap_or(tolerance);
        table.finish()?;
        Ok(Self { values, what, expected, tolerance, line })
    }
}

/// A tolerance, where one is given.
fn tolerance(table: &Table<'_>) -> Result<Option<f64>> {
    let Some(value) = table.get("tolerance") else { return Ok(None) };
    match value.number()? {
        number if number > 0.0 => Ok(Some(number)),
        _ => Err(value.problem("nothing is as near as that", "give a tolerance above 0")),
    }
}

/// Judges the values of all files.
pub fn judge(
    executor: &mut dyn Executor,
    brdf: &Configured,
    all: &[References],
) -> Result<Verdict> {
    let mut worst = (0.0, String::new(), String::new());
    let mut cases = 0;
    let mut failed = 0;
    let mut cpu = Cpu::new(Precision::F64);
    for file in all {
        for reference in &file.values {
            cases += 1;
            let at = Configured { values: reference.values.clone(), ..brdf.clone() };
            let found = found(executor, &mut cpu, &at, reference.what)?;
            let scale = largest(&reference.expected);
            let off = apart(&found, &reference.expected);
            let excess = match scale > 0.0 {
                true => off / scale / reference.tolerance,
                false => off / reference.tolerance,
            };
            failed += usize::from(excess > 1.0);
            if excess > worst.0 {
                let said = format!(
                    "{:?} where {} (value at line {}) says {:?}",
                    found, file.source, reference.line, reference.expected
                );
                let shown = match reference.what {
                    What::Albedo([theta, phi]) => format!(
                        "brdf eval BRDF --albedo --angles {theta} --azimuth {phi}{}",
                        options(&at)
                    ),
                    What::F(pair) | What::FCos(pair) | What::Pdf(pair) => {
                        command("BRDF", &options(&at), &pair)
                    }
                };
                worst = (excess, said, shown);
            }
        }
    }
    if cases == 0 {
        let said = "there are no references for it";
        return Ok(Verdict::new(Law::References, Outcome::Skipped, said));
    }
    let (excess, said, shown) = worst;
    let sources: Vec<&str> = all.iter().map(|file| file.source.as_str()).collect();
    let said = match failed {
        0 => format!("{cases} values as in {}", sources.join("; ")),
        n => format!("{n} of {cases} values differ, worst {said}"),
    };
    let verdict = Verdict::new(Law::References, outcome(failed == 0), said);
    let verdict = verdict.with(excess, 1.0, cases);
    Ok(if failed > 0 { verdict.shown_by(shown) } else { verdict })
}

fn found(
    executor: &mut dyn Executor,
    cpu: &mut Cpu,
    brdf: &Configured,
    what: What,
) -> Result<[f64; 3]> {
    let (F(pair) | FCos(pair) | Pdf(pair)) = what else {
        let What::Albedo(view) = what else { return Ok([f64::NAN; 3]) };
        let mut surveyor = Surveyor::new(executor, brdf)?;
        let found = surveyor.albedos(executor, brdf, &[direction(view)], 1e-6)?;
        surveyor.free(executor);
        // What is not finite somewhere has no albedo.
        return Ok(match found[0].broken {
            None => found[0].total().light,
            Some(_) => [f64::NAN; 3],
        });
    };
    use What::{F, FCos, Pdf};
    let program = Arc::new(link(&View::Eval { brdf: brdf.clone() })?);
    let at = evaluate(cpu, &program, brdf, &[pair])?[0];
    Ok(match what {
        Pdf(_) => [at.pdf; 3],
        FCos(_) => at.f.map(|f| f * f64::from(pair.wi[2])),
        _ => at.f,
    })
}
