//! The law of the contract: what an author may have overlooked, in the author's words.

use brdf_sdk::Result;

use super::draws::{Draw, LENGTH};
use super::settings::{Setting, direction, options};
use super::survey::Surveyor;
use super::values::row;
use super::verdict::{Law, Outcome, Verdict};
use crate::exec::Executor;
use crate::link::{Function, functions, sampling, unused_parameters};

/// Draws that are looked at for each view.
const DRAWS: usize = 4096;

/// Judges it, at all settings and before anything expensive.
pub fn judge(executor: &mut dyn Executor, settings: &[Setting]) -> Result<Verdict> {
    let own = &settings[0].brdf;
    let plugin = &own.plugin;
    let failed = |said: String| Verdict::new(Law::Contract, Outcome::Failed, said);
    if let [first, rest @ ..] = unused_parameters(plugin)?.as_slice() {
        let more = match rest.len() {
            0 => String::new(),
            n => format!(" (and {n} more)"),
        };
        return Ok(failed(format!(
            "the parameter `{first}` is never used{more}: read `{}`, or remove [params.{first}]",
            plugin.manifest.param(first).map_or(first.clone(), |param| param.wgsl_use())
        )));
    }
    let (declared, notes) = functions(own)?;
    let own = declared.contains(&Function::Sample);
    let [mut draws, mut above, mut with_pdf] = [0, 0, 0];
    let mut wrong = None;
    let mut surveyor = None;
    for setting in settings {
        let at = Surveyor::at(executor, &mut surveyor, &setting.brdf)?;
        // All views of the first setting, one of the others.
        let views = if draws == 0 { setting.views.as_slice() } else { &setting.views[..1] };
        for view in views {
            let (found, dirac) = at.look(executor, &setting.brdf, *view, DRAWS)?;
            draws += found.len();
            above += found.iter().filter(|draw| draw.counts()).count();
            with_pdf += found.iter().filter(|draw| draw.counts() && draw.pdf > 0.0).count();
            let shown = |draw: &Draw| shown(setting, *view, draw);
            // Below the horizon there is no sample, whatever its length.
            let wrong_length = |draw: &&Draw| draw.counts() && draw.off_length() > LENGTH;
            let infinite = |draw: &&Draw| !draw.off_length().is_finite();
            let unnormalised =
                found.iter().find(infinite).or_else(|| found.iter().find(wrong_length));
            let (said, draw) = match (unnormalised, dirac) {
                (Some(draw), _) => (unnormalised_said(draw), shown(draw)),
                (None, Some(draw)) => (DIRAC.to_owned(), shown(&draw)),
                (None, None) => continue,
            };
            wrong.get_or_insert(failed(said).shown_by(draw));
        }
    }
    if let Some(surveyor) = surveyor {
        surveyor.free(executor);
    }
    if let Some(verdict) = wrong {
        return Ok(verdict);
    }
    if own && above > 0 && with_pdf == 0 {
        return Ok(failed(format!(
            "`pdf` is 0 for each of {above} draws of `sample`: return the density of `sample` per solid \
             angle, or remove both, and the host draws from the cosine"
        )));
    }
    if own && above == 0 {
        return Ok(failed(
            "`sample` never returns a direction above the horizon (z > 0)".to_owned(),
        ));
    }
    let said = match sampling(&settings[0].brdf)?.by_host() {
        None => "eval, sample and pdf are as they shall be".to_owned(),
        Some(by) => format!("eval alone: draws are of {by}"),
    };
    let verdict = Verdict::new(Law::Contract, Outcome::Passed, said);
    Ok(Verdict { notes, cases: draws, ..verdict })
}

const DIRAC: &str = "`sample` returns one and the same direction again and again: a perfectly specular \
    (Dirac) lobe has no density and is outside the contract; give it a width";

fn unnormalised_said(draw: &Draw) -> String {
    if !draw.off_length().is_finite() {
        return "`sample` returns Inf or NaN: return a direction with z <= 0 where there is no sample".to_owned();
    }
    let length = draw.wi.iter().map(|c| f64::from(*c).powi(2)).sum::<f64>().sqrt();
    format!("`sample` returns a direction of length {length:.4}: normalize it before you return it")
}

/// The input of a draw.
fn shown(setting: &Setting, view: [f64; 2], draw: &Draw) -> String {
    format!("wo {}, u {}{}", row(direction(view)), row(draw.u), options(&setting.brdf))
}
