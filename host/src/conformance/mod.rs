//! The laws that every BRDF is held to, and what they say: numbers in, verdict out.
//!
//! [`conform`] judges one BRDF on one device. Expected values come from the CPU executor in f64, what is
//! judged from the device in f32; so a verdict holds for that device. It prints nothing and writes nothing.

pub mod albedo;
mod cell;
mod chi_square;
mod contract;
mod draws;
mod energy;
mod furnace;
mod integrals;
mod light;
mod raster;
mod references;
mod sampling;
mod settings;
mod stability;
mod survey;
mod tree;
mod values;
mod verdict;

use std::time::Instant;

use brdf_sdk::Result;
use serde::Serialize;

pub use cell::Cell;
pub use draws::Drawer;
pub use energy::Curve;
pub use light::{Draws as LightDraws, light};
pub use raster::{Raster, Window};
pub use references::{References, subject};
pub use sampling::Spread;
pub use verdict::{Law, Outcome, Verdict};

use crate::exec::Executor;
use crate::link::{self, Sampling};
use crate::plugin::Configured;
use settings::{Reach, Setting, settings};
use survey::{Survey, Surveyor};

/// What is wanted of a proof.
#[derive(Debug, Clone, Default)]
pub struct Wanted {
    /// The laws; all where it is empty.
    pub laws: Vec<Law>,
    /// More settings and more views.
    pub deep: bool,
    /// The integrators that the furnace is shown through.
    pub integrators: Vec<Configured>,
    /// Values to compare with.
    pub references: Vec<References>,
}

/// What was found of a BRDF.
#[derive(Debug, Clone, Serialize)]
pub struct Report {
    /// Its id.
    pub brdf: String,
    /// Its name for people.
    pub name: String,
    /// The device that was judged.
    pub device: String,
    /// One for each law that was wanted.
    pub verdicts: Vec<Verdict>,
    /// For plots.
    #[serde(skip)]
    pub plots: Plots,
}

/// Numbers for plots.
#[derive(Debug, Clone, Default)]
pub struct Plots {
    /// Densities at some views of the defaults, after that at which the law of sampling fails.
    pub densities: Vec<Densities>,
    /// Albedo of the white preset against the angle [degrees], at azimuth 0.
    pub albedo: Curve,
    /// How much weights vary at the views of the defaults.
    pub spreads: Vec<Spread>,
}

/// A density as it was drawn and as it is expected.
#[derive(Debug, Clone)]
pub struct Densities {
    /// Angles of `wo` from the normal and the tangent [degrees].
    pub view: [f64; 2],
    /// The view and the parameters in words.
    pub at: String,
    /// Whether the law of sampling fails here.
    pub failed: bool,
    /// How many draws there were, those below the horizon too.
    pub draws: u64,
    /// For each cell the density drawn and the one expected [1/sr].
    pub cells: Vec<(Cell, [f64; 2])>,
}

impl Report {
    /// Whether no law failed.
    pub fn holds(&self) -> bool {
        self.verdicts.iter().all(|verdict| verdict.outcome != Outcome::Failed)
    }
}

/// Judges a BRDF on a device.
///
/// # Errors
/// What linking refuses, endless loops, and what the device says.
pub fn conform(executor: &mut dyn Executor, brdf: &Configured, wanted: &Wanted) -> Result<Report> {
    let settings = settings(brdf, Reach::Slider, wanted.deep);
    let wants = |law: Law| wanted.laws.is_empty() || wanted.laws.contains(&law);
    let mut verdicts = Vec::new();
    let mut plots = Plots::default();
    let (verdict, broken) = {
        let start = Instant::now();
        let verdict = contract::judge(executor, &settings)?;
        let broken = verdict.outcome == Outcome::Failed;
        (Verdict { seconds: start.elapsed().as_secs_f64(), ..verdict }, broken)
    };
    if wants(Law::Contract) || broken {
        verdicts.push(verdict);
    }
    if wants(Law::Finite) || wants(Law::Reciprocity) || wants(Law::Weight) {
        let start = Instant::now();
        let settings = self::settings(brdf, Reach::Range, wanted.deep);
        let found = values::judge(executor, &settings)?;
        let seconds = start.elapsed().as_secs_f64() / 3.0;
        verdicts.extend(found.map(|verdict| Verdict { seconds, ..verdict }));
    }
    if wants(Law::Energy) {
        let start = Instant::now();
        let (verdict, curve) = energy::judge(executor, brdf)?;
        plots.albedo = curve;
        verdicts.push(Verdict { seconds: start.elapsed().as_secs_f64(), ..verdict });
    }
    if wants(Law::Sampling) || wants(Law::Mean) || wants(Law::Variance) {
        // Where the mean alone is asked for, a plain failure settles it.
        let mean_ends = wants(Law::Mean) && !wants(Law::Sampling);
        let found = of_draws(executor, brdf, &settings, mean_ends, &mut plots)?;
        verdicts.extend(found);
    }
    if wants(Law::Furnace) {
        let start = Instant::now();
        let verdict = furnace::judge(executor, brdf, &wanted.integrators)?;
        verdicts.push(Verdict { seconds: start.elapsed().as_secs_f64(), ..verdict });
    }
    if wants(Law::References) {
        let start = Instant::now();
        let verdict = references::judge(executor, brdf, &wanted.references)?;
        verdicts.push(Verdict { seconds: start.elapsed().as_secs_f64(), ..verdict });
    }
    if wants(Law::Stability) {
        let start = Instant::now();
        let settings = self::settings(brdf, Reach::Range, wanted.deep);
        let verdict = stability::judge(executor, &settings)?;
        verdicts.push(Verdict { seconds: start.elapsed().as_secs_f64(), ..verdict });
    }
    // What the others build on is told whatever was asked for, where it fails.
    let is_base = |verdict: &Verdict| {
        verdict.outcome == Outcome::Failed && matches!(verdict.law, Law::Contract | Law::Sampling)
    };
    verdicts.retain(|verdict| wants(verdict.law) || is_base(verdict));
    verdicts.sort_by_key(|verdict| verdict.law);
    Ok(Report {
        brdf: brdf.plugin.id.clone(),
        name: brdf.plugin.manifest.name.clone(),
        device: executor.name().to_owned(),
        verdicts,
        plots,
    })
}

/// The laws that look at draws.
fn of_draws(
    executor: &mut dyn Executor,
    brdf: &Configured,
    settings: &[Setting],
    mean_ends: bool,
    plots: &mut Plots,
) -> Result<[Verdict; 3]> {
    let mut surveyor: Option<Surveyor> = None;
    let mut start = Instant::now();
    let mut lap = || {
        let seconds = start.elapsed().as_secs_f64();
        start = Instant::now();
        seconds
    };
    let (surveys, complete) = sampling::surveys(executor, &mut surveyor, settings, mean_ends)?;
    let drawn = link::sampling(brdf)?;
    // Who did not look at all settings knows of failures alone.
    let whole = |verdict: Verdict| match verdict.outcome {
        Outcome::Failed => verdict,
        _ if !complete => {
            let said = "not looked at everywhere, since the laws of draws fail plainly";
            Verdict {
                seconds: verdict.seconds,
                ..Verdict::new(verdict.law, Outcome::Skipped, said)
            }
        }
        Outcome::Passed => match drawn.by_host() {
            Some(by) => Verdict { said: format!("of {by}: {}", verdict.said), ..verdict },
            None => verdict,
        },
        _ => verdict,
    };
    let (verdict, failed) = sampling::sampling(executor, &mut surveyor, settings, &surveys)?;
    let sampling = whole(Verdict { seconds: lap(), ..verdict });
    let verdict = sampling::mean(executor, &mut surveyor, settings, &surveys)?;
    let mean = whole(Verdict { seconds: lap(), ..verdict });
    let (verdict, spreads) = sampling::variance(settings, &surveys, drawn != Sampling::Cosine);
    let variance = whole(Verdict { seconds: lap(), ..verdict });
    plots.spreads = spreads;
    let of_defaults = surveys.iter().enumerate().filter(|(index, survey)| {
        survey.setting == 0 && survey.view[1] == 37.0 && Some(*index) != failed
    });
    let shown = failed.into_iter().chain(of_defaults.map(|(index, _)| index));
    let plot = |index: usize| densities(settings, &surveys[index], Some(index) == failed);
    plots.densities = shown.map(plot).collect();
    if let Some(surveyor) = surveyor {
        surveyor.free(executor);
    }
    Ok([sampling, mean, variance])
}

fn densities(settings: &[Setting], survey: &Survey, failed: bool) -> Densities {
    let draws = survey.tally.draws;
    let cells = survey.tree.leaves.iter().zip(&survey.integrals.cells).zip(&survey.tally.counts);
    let cells = cells.map(|((cell, integral), count)| {
        let area = cell.solid_angle();
        (*cell, [*count as f64 / draws as f64 / area, integral.pdf / area])
    });
    let at = sampling::shown_view(settings, survey);
    Densities { view: survey.view, at, failed, draws, cells: cells.collect() }
}
