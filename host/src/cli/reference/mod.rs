//! `brdf reference`: a picture by deterministic quadrature, written only where samples agree with it.

mod check;

use std::path::PathBuf;
use std::time::Instant;

use brdf_sdk::{Kind, Problem, Result};

use super::scene::{SceneOptions, positive};
use super::studio::{self, Studio};
use super::{Verdict, interrupt, print};
use crate::measure::agreement::{self, Agreement, Finding, Place};
use crate::registry::Registry;
use crate::render::{Effort, Film, Progress, Stop, Wish};
use crate::session::{Chosen, Session};
pub(super) use check::Check;

#[derive(Debug, clap::Args)]
pub(in crate::cli) struct Arguments {
    /// The BRDF, by name or folder [default: ggx]
    brdf: Option<String>,
    /// The integrator that makes the reference: one that adds up terms
    #[arg(long, value_name = "INTEGRATOR", default_value = "convolution")]
    by: String,
    /// Set a parameter of that integrator; its `tolerance` is 1e-5 otherwise
    #[arg(long, value_name = "KEY=VALUE", allow_hyphen_values = true)]
    iset: Vec<String>,
    /// The integrator that checks it: one that draws samples, with its defaults
    #[arg(long, value_name = "INTEGRATOR", default_value = "mis-balance")]
    against: String,
    /// Time after which the check decides by what there is [s]
    #[arg(long, value_name = "S", default_value_t = 60.0, allow_hyphen_values = true)]
    check_time: f64,
    /// Samples a pixel after which the check decides by what there is
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = clap::value_parser!(u32).range(i64::from(REPLICATES)..=1 << 28))]
    check_samples: Option<u32>,
    /// Write the picture too where the check could not decide; its header says `unchecked`
    #[arg(long)]
    undecided: bool,
    #[command(flatten)]
    scene: SceneOptions,
    /// Path of the pictures without their ending [default: the BRDF's name and `-reference`]
    #[arg(long, value_name = "PATH")]
    export: Option<PathBuf>,
    #[command(flatten)]
    studio: studio::Options,
}

/// The tolerance of the quadrature, where the integrator has such a setting.
const TOLERANCE: &str = "tolerance=1e-5";

/// Scrambles whose spread is the error of the check, whatever the scene says of its own. Of 32 normal
/// numbers one holds half of the variance once in 10,000 times, of 16 once in 50.
const REPLICATES: u32 = 32;

/// Samples a pixel before which nothing is taken for sharp.
const LEAST_SAMPLES: u64 = 512;

pub(in crate::cli) fn run(registry: &Registry, arguments: &Arguments) -> Result<Verdict> {
    let [made, against] = sessions(registry, arguments)?;
    let id = &made.brdf.configured.plugin.id;
    let export =
        arguments.export.clone().unwrap_or_else(|| PathBuf::from(format!("{id}-reference")));
    arguments.scene.check_export(&export, &made.brdf, &made)?;
    interrupt::listen()?;
    let mut studio = Studio::open(registry, &arguments.studio, &made)?;
    check_kinds(&studio, arguments, [&made, &against])?;
    let places = agreement::places(studio.pixels(), made.film.resolution);
    if places.len() < 2 {
        return Err(nothing_covered());
    }

    let reference = studio.make(&made, &mut |_| Wish::GoOn)?;
    if reference.unfinished() {
        return Err(Problem::new(
            "the reference",
            "it was interrupted before its last texel",
            "let it finish",
        ));
    }
    let films = Films { places, reference: &reference.rendered.film };
    let samples = films.sampled(&mut studio, &against)?;
    let agreement = films.beside(&samples).ok_or_else(nothing_covered)?;
    let check = Check::new([&made, &against], [films.reference, &samples], agreement);
    let kept = match check.agreement.finding {
        Finding::Agrees => true,
        Finding::Disagrees => false,
        Finding::Undecided => arguments.undecided,
    };
    if kept {
        studio.write(&made, &export, &reference, Some(check))?;
        return Ok(Verdict::Passed);
    }
    print(&if arguments.studio.json { check.json() } else { check.refusal() })?;
    Ok(Verdict::Failed)
}

/// The scene as the reference is made, and as it is checked.
fn sessions(registry: &Registry, arguments: &Arguments) -> Result<[Session; 2]> {
    let mut made = arguments.scene.session(registry)?;
    let names: Vec<String> = arguments.brdf.iter().cloned().collect();
    if let [brdf] = arguments.scene.brdfs(registry, &names, &made)?.as_slice() {
        made.brdf = brdf.clone();
    }
    // How long the scene is sampled says nothing of a sum, which ends with its last texel.
    let seed = made.effort.seed;
    made.stop = Stop::default();
    let mut against = made.clone();

    made.integrator = Chosen::find(registry, Kind::Integrator, &arguments.by)?;
    let by = &mut made.integrator.configured;
    if by.plugin.manifest.param("tolerance").is_some() {
        by.assign(&[TOLERANCE.to_owned()])?;
    }
    by.assign(&arguments.iset)?;

    against.integrator = Chosen::find(registry, Kind::Integrator, &arguments.against)?;
    let all = Effort { samples: 1, passes: None, replicates: REPLICATES, seed, doublings: false };
    against.effort = match arguments.check_samples {
        Some(samples) => Effort { samples, passes: Some(1), ..all },
        None => all,
    };
    against.stop.time = positive("--check-time", Some(arguments.check_time))?;
    Ok([made, against])
}

/// Refuses a reference that is sampled, and a check that is not: neither would be independent of the other
/// way to the number.
fn check_kinds(
    studio: &Studio,
    arguments: &Arguments,
    [made, against]: [&Session; 2],
) -> Result<()> {
    if studio.link(made)?.sum.is_none() {
        return Err(Problem::new(
            format!("--by {}", arguments.by),
            "it draws samples, and a reference has no noise",
            "name an integrator that adds up terms, such as convolution",
        ));
    }
    if studio.link(against)?.sum.is_some() {
        return Err(Problem::new(
            format!("--against {}", arguments.against),
            "it adds up terms, and tells nothing of its own error",
            "name an integrator that draws samples, such as mis-balance",
        ));
    }
    Ok(())
}

fn nothing_covered() -> Problem {
    Problem::new(
        "the scene",
        "the object covers no pixel, so that there is nothing to check",
        "look at --camera and --shape",
    )
}

/// A reference, and where it is compared.
struct Films<'a> {
    places: Vec<Place>,
    reference: &'a Film,
}

impl Films<'_> {
    /// Samples the scene, sharply enough to decide by unless time or samples are over before.
    ///
    /// A first film tells how many samples that takes, and is not used any more where it got there: its
    /// spread is small also because it was stopped at a small one. The film that decides has twice as many
    /// samples, all of its own.
    fn sampled(&self, studio: &mut Studio, against: &Session) -> Result<Film> {
        let mut first = against.clone();
        first.effort.seed = !against.effort.seed;
        first.stop.time = against.stop.time.map(|time| time / 2.0);
        let mut settled = false;
        let mut watch = |progress: &Progress<'_>| {
            if !progress.doubling || progress.done < LEAST_SAMPLES {
                return Wish::GoOn;
            }
            let Some(film) = progress.film else { return Wish::Look };
            settled = self.beside(film).is_some_and(|found| found.sharp());
            if settled { Wish::Finish } else { Wish::GoOn }
        };
        let start = Instant::now();
        let tried = studio.make(&first, &mut watch)?.rendered.film;
        if !settled {
            return Ok(tried);
        }
        let mut second = against.clone();
        let most = against.effort.spp();
        let samples = (2 * tried.samples()).min(most);
        second.effort.samples = u32::try_from(samples).unwrap_or(u32::MAX);
        second.effort.passes = Some(1);
        second.stop.time =
            against.stop.time.map(|time| (time - start.elapsed().as_secs_f64()).max(time / 2.0));
        Ok(studio.make(&second, &mut |_| Wish::GoOn)?.rendered.film)
    }

    /// The reference beside a film of samples; `None` where nothing is covered.
    fn beside(&self, samples: &Film) -> Option<Agreement> {
        let (reference, estimate) =
            (|row| self.reference.mean(row), |row, r| samples.replicate_mean(row, r));
        Agreement::new(&self.places, reference, estimate, samples.sampled_replicates())
    }
}
