//! What each expression has to do with a wrong result.
//!
//! An expression answers for a case by the smallest of three errors. Its local error: how wrong it is
//! when its operands are off by no more than one rounding (Sanchez-Stern, Panchekha, Lerner, Tatlock
//! 2018, "Finding Root Causes of Floating Point Error", section 4); so rounding that becomes large
//! blames the one who makes it large, and nobody who hands it on. Its contribution: how wrong the
//! result is when this expression is off by its local error and everything else is exact; so an error
//! that never reaches the result blames nobody. And the error of the result itself.

use brdf_sdk::Result;
use naga::Span;
use wgsl_cpu::Site;

use super::cases::Case;
use super::outcome::{Outcome, Verdict, error};
use super::run::Runner;
use crate::link::{Function, Origin};
use crate::plugin::Configured;

/// Errors below this are what rounding leaves after a few operations: 4 x 2^-22.
pub const ROUNDING: f64 = 4.0 / (1u32 << 22) as f64;

/// A case whose result is wrong by more than rounding.
pub struct Wrong {
    /// Its index among all cases.
    index: usize,
    case: Case,
    exact: [f64; 3],
    /// Infinite where the result is not finite.
    pub error: f64,
}

/// An expression in which errors arise that reach results.
pub struct Suspect {
    /// Where it stands.
    pub origin: Origin,
    /// For each wrong case what it answers for.
    pub errors: Vec<f64>,
    /// For each wrong case the leading bits that cancelled there.
    pub cancelled: Vec<f32>,
}

/// The cases that somebody is to be blamed for.
pub fn wrong_cases(cases: &[Case], outcomes: &[Outcome], verdicts: &[Verdict]) -> Vec<Wrong> {
    let of = |index: usize| {
        let error = match verdicts[index] {
            Verdict::Error(error) => error,
            Verdict::NotFinite => f64::INFINITY,
            Verdict::NotFiniteInF64 | Verdict::BeyondF32 => 0.0,
        };
        Wrong { index, case: cases[index], exact: outcomes[index].high, error }
    };
    (0..cases.len()).map(of).filter(|wrong| wrong.error >= ROUNDING).collect()
}

/// The expressions that may have made them wrong.
pub fn suspects(
    runner: &Runner,
    function: Function,
    brdf: &Configured,
    sites: &[Site],
    wrong: &[Wrong],
) -> Result<Vec<Suspect>> {
    let mut suspects = Vec::new();
    let cases: Vec<Case> = wrong.iter().map(|wrong| wrong.case).collect();
    for (span, sites) in by_span(sites) {
        let Some(origin) = runner.program.origin(span) else { continue };
        // Components of a vector are instructions of their own: the worst one speaks for all.
        let worst = |wrong: &Wrong| {
            let each =
                sites.iter().map(|site| (site.errors[wrong.index], site.cancelled[wrong.index]));
            each.fold((0.0f32, 0.0f32), |worst, one| if one.0 > worst.0 { one } else { worst })
        };
        let (mut errors, cancelled): (Vec<f64>, Vec<f32>) =
            wrong.iter().map(worst).map(|(local, bits)| (f64::from(local), bits)).unzip();
        if errors.iter().all(|local| *local < ROUNDING) {
            continue;
        }
        let results = runner.with_errors_of(span, brdf, &cases)?;
        for ((answer, wrong), result) in errors.iter_mut().zip(wrong).zip(results) {
            let contribution = error(function, result, wrong.exact);
            *answer = answer.min(contribution).min(wrong.error);
        }
        suspects.push(Suspect { origin, errors, cancelled });
    }
    Ok(suspects)
}

fn by_span(sites: &[Site]) -> Vec<(Span, Vec<&Site>)> {
    let mut spans: Vec<(Span, Vec<&Site>)> = Vec::new();
    for site in sites {
        match spans.iter_mut().find(|(span, _)| *span == site.span) {
            Some((_, same)) => same.push(site),
            None => spans.push((site.span, vec![site])),
        }
    }
    spans
}
