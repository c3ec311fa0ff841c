//! `brdf recommend`: which integrator for this scene, by a short trial of each.

use std::fmt::Write as _;

use brdf_sdk::Result;

use super::bench::{case_of, found};
use super::machine::Machine;
use super::scene::{SceneOptions, positive};
use super::studio::progress_bar;
use super::{Verdict, interrupt, print};
use crate::bench::{Limits, Trial, recommend, samplers};
use crate::registry::Registry;
use crate::session::{Chosen, render_command, shell_quoted};

#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// The BRDF, by name or folder [default: the scene's]
    brdf: Option<String>,
    /// Integrators to try, separated by commas [default: all that draw samples of the map]
    #[arg(long, value_name = "INTEGRATORS", value_delimiter = ',')]
    integrators: Vec<String>,
    /// Time of each trial [s]
    #[arg(long, value_name = "S", default_value_t = 0.5, allow_hyphen_values = true)]
    time: f64,
    /// The relMSE whose time is told
    #[arg(long, value_name = "RELMSE", default_value_t = 1e-3, allow_hyphen_values = true)]
    target: f64,
    #[command(flatten)]
    scene: SceneOptions,
    #[command(flatten)]
    machine: Machine,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

pub(super) fn run(registry: &Registry, arguments: &Arguments) -> Result<Verdict> {
    let time = positive("--time", Some(arguments.time))?.unwrap_or(arguments.time);
    let target = positive("--target", Some(arguments.target))?.unwrap_or(arguments.target);
    let mut scene = arguments.scene.session(registry)?;
    let names: Vec<String> = arguments.brdf.iter().cloned().collect();
    if let [brdf] = arguments.scene.brdfs(registry, &names, &scene)?.as_slice() {
        scene.brdf = brdf.clone();
    }
    let integrators = match arguments.integrators.is_empty() {
        true => samplers(registry, &scene),
        false => found(registry, &arguments.integrators)?,
    };
    interrupt::listen()?;
    let mut executor = arguments.machine.open()?.executor;
    let limits = Limits { time, target, seed: scene.effort.seed, ..Limits::default() };
    let bar = progress_bar(integrators.len() as u64);
    let case = case_of(scene.clone());
    let trials = recommend(registry, &case, &integrators, executor.as_mut(), &limits, &mut |_| {
        bar.inc(1);
        !interrupt::asked()
    });
    bar.finish_and_clear();
    let trials = trials?;
    if arguments.json {
        print(&json(&trials, target))?;
        return Ok(verdict(&trials));
    }
    let mut text = format!(
        "{} under {}, {time} s each on {}\n",
        scene.brdf.name(),
        scene.environment.map,
        executor.name()
    );
    let _ = writeln!(
        text,
        "  {:<16} {:>9} {:>10} {:>12}",
        "integrator",
        "spp",
        "relMSE",
        format!("s to {target:.0e}")
    );
    for trial in &trials {
        text += &row(trial, target);
    }
    let best = best(&trials);
    text += &match best {
        Some(best) => {
            scene.integrator = best.integrator.clone();
            let mut words = render_command(&scene);
            words.extend(arguments.machine.words());
            let words: Vec<String> = words.iter().map(|word| shell_quoted(word)).collect();
            format!("use {}:\n  brdf {}\n", id(best), words.join(" "))
        }
        None => "none of them can be recommended\n".to_owned(),
    };
    print(&text)?;
    Ok(verdict(&trials))
}

fn best(trials: &[Trial]) -> Option<&Trial> {
    trials.first().filter(|trial| is_usable(trial))
}

fn verdict(trials: &[Trial]) -> Verdict {
    if best(trials).is_some() { Verdict::Passed } else { Verdict::Failed }
}

fn id(trial: &Trial) -> &str {
    &trial.integrator.configured.plugin.id
}

fn is_usable(trial: &Trial) -> bool {
    trial.problem.is_none() && trial.relmse.is_some() && trial.disagrees.is_none()
}

fn row(trial: &Trial, target: f64) -> String {
    let mut why = Vec::new();
    why.extend(trial.problem.clone());
    if trial.doubtful {
        why.push(
            "one replicate holds most of that error: it has not met all bright directions"
                .to_owned(),
        );
    }
    if let Some((other, apart)) = &trial.disagrees {
        why.push(format!("its mean is {apart:.0} standard errors from that of {other}"));
    }
    if trial.nonfinite > 0 {
        why.push(format!("{} samples were Inf or NaN", trial.nonfinite));
    }
    let number = |value: Option<String>| value.unwrap_or_else(|| "-".to_owned());
    let line = format!(
        "  {:<16} {:>9} {:>10} {:>12}  {}",
        id(trial),
        trial.done,
        number(trial.relmse.map(|relmse| format!("{relmse:.2e}"))),
        number(trial.seconds_to(target).map(|seconds| format!("{seconds:.2}"))),
        why.join("; ")
    );
    line.trim_end().to_owned() + "\n"
}

fn json(trials: &[Trial], target: f64) -> String {
    let integrator = |chosen: &Chosen| chosen.configured.plugin.id.clone();
    let rows: Vec<serde_json::Value> = trials
        .iter()
        .map(|trial| {
            serde_json::json!({
                "integrator": integrator(&trial.integrator),
                "problem": trial.problem,
                "done": trial.done,
                "seconds": trial.seconds,
                "relmse_estimate": trial.relmse,
                "mean": trial.mean.map(|[mean, _]| mean),
                "mean_std_error": trial.mean.map(|[_, error]| error),
                "disagrees_with": trial.disagrees.as_ref().map(|(other, _)| other),
                "seconds_to_target": trial.seconds_to(target),
                "doubtful": trial.doubtful,
                "nonfinite": trial.nonfinite,
            })
        })
        .collect();
    format!("{}\n", serde_json::Value::Array(rows))
}
