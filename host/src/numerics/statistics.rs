//! The errors of many results in a few numbers, with the inputs that show them.

use brdf_sdk::ParamValues;
use serde::Serialize;

use super::cases::Case;
use super::outcome::{Outcome, Verdict};
use crate::plugin::Configured;

/// The errors of a function's results.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Errors {
    /// Results looked at.
    pub cases: usize,
    /// Inf or NaN in f32 where f64 gives a value that f32 can hold.
    pub nonfinite: usize,
    /// Inf or NaN in f64 too: the formula, and not the precision.
    pub nonfinite_in_f64: usize,
    /// Values that are finite in f64 and larger than any f32.
    pub beyond_f32: usize,
    /// Median of the errors of finite results; relative, for `sample` an angle [radians].
    pub median: Option<f64>,
    /// Their 99th percentile.
    pub percentile_99: Option<f64>,
    /// The largest.
    pub largest: Option<f64>,
    /// The input of the largest.
    pub worst: Option<Worst>,
    /// The first input whose result is not finite.
    pub first_nonfinite: Option<Worst>,
    /// The first input whose result is not finite in f64 either.
    pub first_nonfinite_in_f64: Option<Worst>,
}

/// An input and what came of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Worst {
    /// To the viewer.
    pub wo: [f32; 3],
    /// To the light; not read by `sample`.
    pub wi: [f32; 3],
    /// Read by `sample` alone.
    pub u: [f32; 3],
    /// Every parameter as `--set` takes it.
    pub parameters: Vec<(String, String)>,
    /// The result in f32.
    pub f32: [f32; 3],
    /// The result in f64.
    pub f64: [f64; 3],
}

#[derive(Default)]
pub(super) struct Statistics {
    errors: Vec<f64>,
    found: Errors,
}

impl Statistics {
    pub(super) fn add(
        &mut self,
        brdf: &Configured,
        cases: &[Case],
        outcomes: &[Outcome],
        verdicts: &[Verdict],
    ) {
        let found = &mut self.found;
        found.cases += cases.len();
        for ((case, outcome), verdict) in cases.iter().zip(outcomes).zip(verdicts) {
            let this = || Some(worst(&brdf.values, case, outcome));
            match *verdict {
                Verdict::Error(error) => {
                    self.errors.push(error);
                    if found.largest.is_none_or(|largest| error > largest) {
                        found.largest = Some(error);
                        found.worst = this();
                    }
                }
                Verdict::NotFinite => {
                    found.nonfinite += 1;
                    found.first_nonfinite = found.first_nonfinite.take().or_else(this);
                }
                Verdict::NotFiniteInF64 => {
                    found.nonfinite_in_f64 += 1;
                    found.first_nonfinite_in_f64 =
                        found.first_nonfinite_in_f64.take().or_else(this);
                }
                Verdict::BeyondF32 => found.beyond_f32 += 1,
            }
        }
    }

    pub(super) fn finish(mut self) -> Errors {
        self.errors.sort_by(f64::total_cmp);
        let at = |part: f64| {
            let last = self.errors.len().checked_sub(1)?;
            self.errors.get((part * last as f64).round() as usize).copied()
        };
        let (median, percentile_99) = (at(0.5), at(0.99));
        Errors { median, percentile_99, ..self.found }
    }
}

fn worst(values: &ParamValues, case: &Case, outcome: &Outcome) -> Worst {
    Worst {
        wo: case.wo,
        wi: case.wi,
        u: case.u,
        parameters: values.iter().map(|(key, value)| (key.to_owned(), value.to_string())).collect(),
        f32: outcome.low,
        f64: outcome.high,
    }
}
