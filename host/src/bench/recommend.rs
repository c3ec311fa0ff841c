//! A short trial that says which integrator to use for a scene, by what pictures estimate of themselves.

use brdf_sdk::{Problem, Result};

use super::case::Opened;
use super::measured::{Aim, measure};
use super::{Case, Limits};
use crate::exec::Executor;
use crate::registry::Registry;
use crate::render::estimate;
use crate::session::Chosen;

/// One integrator's trial.
#[derive(Debug, Clone)]
pub struct Trial {
    /// The integrator.
    pub integrator: Chosen,
    /// What is wrong with it for this scene.
    pub problem: Option<String>,
    /// Samples of a pixel; texels of a sum.
    pub done: u64,
    /// Time of rendering [s].
    pub seconds: f64,
    /// relMSE that it estimates of itself.
    pub relmse: Option<f64>,
    /// Mean radiance of the picture over all channels, and its standard error.
    pub mean: Option<[f64; 2]>,
    /// Whose mean it is far from, of most of the others, and by how many standard errors of both.
    pub disagrees: Option<(String, f64)>,
    /// Whether most of that estimate rests on one replicate: a rare bright sample, and others not met yet.
    pub doubtful: bool,
    /// Samples that were Inf or NaN.
    pub nonfinite: u64,
}

impl Trial {
    /// Estimated time to a relMSE [s], as long as it falls with the samples.
    pub fn seconds_to(&self, target: f64) -> Option<f64> {
        let relmse = self.relmse?;
        Some(self.seconds * relmse / target).filter(|seconds| seconds.is_finite())
    }
}

/// Tries integrators on a scene, each for `limits.time`; the one to use comes first.
///
/// # Errors
/// Where the scene cannot be opened, none of them draws samples, or `tell` says no.
pub fn recommend(
    registry: &Registry,
    case: &Case,
    integrators: &[Chosen],
    executor: &mut dyn Executor,
    limits: &Limits,
    tell: &mut dyn FnMut(&str) -> bool,
) -> Result<Vec<Trial>> {
    let opened = Opened::new(registry, case)?;
    let mut trials = Vec::new();
    for integrator in integrators {
        if !tell(integrator.name()) {
            return Err(Problem::new("brdf recommend", "it was interrupted", "let it finish"));
        }
        let mut trial = Trial {
            integrator: integrator.clone(),
            problem: None,
            done: 0,
            seconds: limits.time,
            relmse: None,
            mean: None,
            disagrees: None,
            doubtful: false,
            nonfinite: 0,
        };
        match measure(executor, &opened, integrator, limits, Aim::Picture) {
            Err(problem) => trial.problem = Some(problem.line()),
            Ok(measured) => {
                let film = measured.film.as_ref();
                let found = film.map(estimate);
                trial.relmse = found.and_then(|found| found.relmse);
                trial.mean = found.and_then(|found| {
                    Some([found.mean.iter().sum::<f64>() / 3.0, found.grey_std_error?])
                });
                trial.doubtful = found.is_some_and(|found| found.is_doubtful());
                trial.nonfinite = film.map_or(0, |film| film.nonfinite());
                trial.done = match measured.texels {
                    Some([done, _]) => done.into(),
                    None => film.map_or(0, |film| film.samples()),
                };
                trial.seconds = measured.seconds;
                if let Some([done, of]) = measured.texels
                    && done < of
                {
                    let whole = measured.seconds * f64::from(of) / f64::from(done.max(1));
                    trial.problem = Some(format!("the whole sum takes about {whole:.1} s"));
                }
            }
        }
        trials.push(trial);
    }
    compare_means(&mut trials);
    // Those that are trusted first; by error times time, which stays as samples are added.
    let rank = |trial: &Trial| {
        let product = trial.relmse.map(|relmse| relmse * trial.seconds);
        (
            trial.problem.is_some() || trial.relmse.is_none() || trial.nonfinite > 0,
            trial.doubtful || trial.disagrees.is_some(),
            product.unwrap_or(f64::INFINITY),
        )
    };
    trials.sort_by(|a, b| {
        let (a, b) = (rank(a), rank(b));
        (a.0, a.1).cmp(&(b.0, b.1)).then(a.2.total_cmp(&b.2))
    });
    Ok(trials)
}

/// Finds those whose means are farther from most of the others' than chance would have it: they are wrong, or have not
/// met what the others have.
fn compare_means(trials: &mut [Trial]) {
    const MOST: f64 = 6.0;
    const FLOOR: f64 = 1e-3;
    let known: Vec<(String, [f64; 2])> = trials
        .iter()
        .filter(|trial| trial.problem.is_none())
        .filter_map(|trial| Some((trial.integrator.name().to_owned(), trial.mean?)))
        .collect();
    for trial in trials {
        let Some([mean, error]) = trial.mean.filter(|_| trial.problem.is_none()) else { continue };
        let others = known.iter().filter(|(name, _)| name != trial.integrator.name());
        let far = others.clone().filter_map(|(name, [other, other_error])| {
            let apart = (mean - other).abs();
            let error = error.hypot(*other_error).max(f64::MIN_POSITIVE);
            (apart > MOST * error + FLOOR * other.abs()).then(|| (name.clone(), apart / error))
        });
        let far: Vec<(String, f64)> = far.collect();
        if 2 * far.len() > others.count() {
            trial.disagrees = far.into_iter().min_by(|a, b| a.1.total_cmp(&b.1));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mean_of_its_own_is_told() {
        let registry = Registry::new(&[]);
        let trial = |name: &str, mean: f64, error: f64| Trial {
            integrator: Chosen::find(&registry, brdf_sdk::Kind::Integrator, name).unwrap(),
            problem: None,
            done: 16,
            seconds: 1.0,
            relmse: Some(1e-3),
            mean: Some([mean, error]),
            disagrees: None,
            doubtful: false,
            nonfinite: 0,
        };
        let mut trials = [
            trial("brdf-is", 0.80, 1e-3),
            trial("mis-balance", 0.801, 1e-3),
            trial("env-is", 0.83, 2e-2),
            trial("uniform", 0.5, 1e-9),
        ];
        compare_means(&mut trials);
        let told: Vec<bool> = trials.iter().map(|trial| trial.disagrees.is_some()).collect();
        assert_eq!(told, [false, false, false, true]);
        let (of, by) = trials[3].disagrees.clone().unwrap();
        assert!(of == "env-is" && (by - 16.5).abs() < 1e-6, "{of} {by}");
    }
}
