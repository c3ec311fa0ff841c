//! Which line of a BRDF loses its digits: its functions in f32 beside f64, over a grid of hard cases.
//!
//! [`measure`] links each function of the author alone, runs it on the CPU executor's shadow mode,
//! and says how large the errors of the results are and in which lines they arise. It works on wgsl-cpu itself
//! and knows nothing of devices and pictures; it judges nothing and prints nothing.

mod blame;
mod cases;
mod outcome;
mod parameters;
mod ranking;
mod run;
mod statistics;

use brdf_sdk::{ParamValues, Result};
use serde::Serialize;

pub use blame::ROUNDING;
pub use cases::{Case, cases_of, exact_sin_cos, unit};
pub use outcome::error;
pub use parameters::mixed;
pub use ranking::{Line, Unblamed};
pub use statistics::{Errors, Worst};

use crate::link::{Function, functions};
use crate::plugin::Configured;
use ranking::Ranking;
use run::Runner;
use statistics::Statistics;

/// Settings of the parameters that a function is run at, over all variants of its switches.
const SETTINGS: usize = 160;
/// And at least so many for each variant.
const SETTINGS_OF_VARIANT: usize = 24;

/// What was found about a BRDF.
#[derive(Debug, Clone, Serialize)]
pub struct Report {
    /// Its id.
    pub brdf: String,
    /// Each of the author's functions.
    pub functions: Vec<FunctionReport>,
    /// What is worth telling once.
    pub notes: Vec<String>,
}

/// What was found about one function.
#[derive(Debug, Clone, Serialize)]
pub struct FunctionReport {
    /// Which.
    pub function: Function,
    /// Settings of the parameters that it was run at.
    pub settings: usize,
    /// The errors of its results.
    #[serde(flatten)]
    pub errors: Errors,
    /// The lines in which they arise, worst first; empty where rounding is all there is.
    pub lines: Vec<Line>,
    /// Results that no line answers for, though they are wrong by more than rounding.
    pub unblamed: Unblamed,
}

/// Measures the functions of a BRDF. Parameters named in `fixed` keep their value; the others go
/// through their ranges.
///
/// # Errors
/// What linking refuses, constructs that the CPU executor does not run, and loops without an end.
pub fn measure(brdf: &Configured, fixed: &[String]) -> Result<Report> {
    let (functions, notes) = functions(brdf)?;
    let found = functions.into_iter().map(|function| measure_function(brdf, fixed, function));
    Ok(Report { brdf: brdf.plugin.id.clone(), functions: found.collect::<Result<_>>()?, notes })
}

fn measure_function(
    brdf: &Configured,
    fixed: &[String],
    function: Function,
) -> Result<FunctionReport> {
    let cases = cases_of(function);
    let variants = parameters::variants(brdf, fixed);
    let limit = (SETTINGS / variants.len()).max(SETTINGS_OF_VARIANT);
    let mut ranking = Ranking::default();
    let mut statistics = Statistics::default();
    let mut settings_run = 0;
    for mut variant in variants {
        let settings: Vec<ParamValues> = parameters::settings(&variant, fixed, limit);
        settings_run += settings.len();
        let runner = Runner::new(&variant, function)?;
        for values in settings {
            variant.values = values;
            let (outcomes, sites) = runner.run(&variant, &cases)?;
            let verdicts: Vec<_> = outcomes.iter().map(|o| o.verdict(function)).collect();
            statistics.add(&variant, &cases, &outcomes, &verdicts);
            let wrong = blame::wrong_cases(&cases, &outcomes, &verdicts);
            let suspects = blame::suspects(&runner, function, &variant, &sites, &wrong)?;
            ranking.add(&suspects, &wrong);
        }
    }
    Ok(FunctionReport {
        function,
        settings: settings_run,
        errors: statistics.finish(),
        unblamed: ranking.unblamed.clone(),
        lines: ranking.into_lines(),
    })
}
