//! `brdf render`: pictures of BRDFs, with their errors.

mod follow;

use std::path::PathBuf;

use brdf_sdk::{Kind, Problem, Result};

use super::scene::{SceneOptions, positive};
use super::studio::{self, Studio};
use super::{apply, interrupt};
use crate::registry::Registry;
use crate::render::{MAX_REPLICATES, MAX_SAMPLES, Wish};
use crate::session::{Chosen, Session};

#[derive(Debug, clap::Args)]
pub(in crate::cli) struct Arguments {
    /// BRDFs by name or folder, a picture each [default: ggx]
    brdfs: Vec<String>,
    /// The integrator, by name or folder [default: brdf-is]
    #[arg(long, value_name = "INTEGRATOR")]
    rendering: Option<String>,
    /// Set a parameter of the integrator
    #[arg(long, value_name = "KEY=VALUE", allow_hyphen_values = true)]
    iset: Vec<String>,
    #[command(flatten)]
    scene: SceneOptions,
    /// Samples a pixel in each pass [default: 64]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_SAMPLES)))]
    samples: Option<u32>,
    /// Passes [default: 16; without end where --time or --error is given]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(1..))]
    passes: Option<u32>,
    /// Stop after this time of rendering [s]
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    time: Option<f64>,
    /// Stop at this estimated relMSE of the picture; looked at where the samples have doubled, after 64
    #[arg(long, value_name = "RELMSE", allow_negative_numbers = true)]
    error: Option<f64>,
    /// Independent scrambles that share the samples; their spread estimates the error [default: 16]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_REPLICATES)))]
    replicates: Option<u32>,
    /// Path of the pictures without their ending; several BRDFs add their names [default: the BRDF's name]
    #[arg(long, value_name = "PATH")]
    export: Option<PathBuf>,
    #[command(flatten)]
    studio: studio::Options,
    /// Render again whenever a file of the plugins changes
    #[arg(long)]
    watch: bool,
}

pub(in crate::cli) fn run(registry: &Registry, arguments: &Arguments) -> Result<()> {
    let mut session = session(registry, arguments)?;
    if !arguments.watch {
        interrupt::listen()?;
    }
    let brdfs = arguments.scene.brdfs(registry, &arguments.brdfs, &session)?;
    if arguments.watch && brdfs.len() > 1 {
        return Err(Problem::new(
            "--watch",
            "it follows one BRDF, and several are named",
            "name one",
        ));
    }
    let watch = if arguments.watch {
        session.brdf = brdfs[0].clone();
        Some(follow::start(&session)?)
    } else {
        None
    };

    let exports = exports(arguments, &brdfs, &session)?;
    let mut studio = Studio::open(registry, &arguments.studio, &session)?;
    for (brdf, export) in brdfs.iter().zip(&exports) {
        session.brdf = brdf.clone();
        match studio.picture(&session, export, &mut |_| Wish::GoOn) {
            Ok(_) => {}
            Err(problem) if watch.is_some() => eprintln!("error: {problem}"),
            Err(problem) => return Err(problem),
        }
    }
    match watch {
        Some(watch) => follow::follow(registry, session, &exports[0], studio, watch),
        None => Ok(()),
    }
}

/// The scene with its integrator and how long it is rendered.
fn session(registry: &Registry, arguments: &Arguments) -> Result<Session> {
    let mut session = arguments.scene.session(registry)?;
    if let Some(name) = &arguments.rendering {
        session.integrator = Chosen::find(registry, Kind::Integrator, name)?;
    }
    apply(&mut session.integrator.configured, &arguments.iset)?;
    let effort = &mut session.effort;
    effort.samples = arguments.samples.unwrap_or(effort.samples);
    effort.replicates = arguments.replicates.unwrap_or(effort.replicates);
    let stop = &mut session.stop;
    stop.time = positive("--time", arguments.time)?.or(stop.time);
    stop.error = positive("--error", arguments.error)?.or(stop.error);
    if arguments.time.or(arguments.error).is_some() {
        effort.passes = None;
    }
    effort.passes = arguments.passes.or(effort.passes);
    Ok(session)
}

/// Where each picture goes; two of one name, or a folder that is not there, are refused before any work.
fn exports(arguments: &Arguments, brdfs: &[Chosen], session: &Session) -> Result<Vec<PathBuf>> {
    let mut exports: Vec<PathBuf> = Vec::new();
    for brdf in brdfs {
        let export = export_path(arguments, brdf, brdfs.len() > 1);
        if exports.contains(&export) {
            return Err(Problem::new(
                export.display().to_string(),
                "two of the BRDFs would write their pictures here",
                "render them one by one, each with its own --export",
            ));
        }
        arguments.scene.check_export(&export, brdf, session)?;
        exports.push(export);
    }
    Ok(exports)
}

fn export_path(arguments: &Arguments, brdf: &Chosen, several: bool) -> PathBuf {
    let name = brdf.name();
    match &arguments.export {
        None => PathBuf::from(name),
        Some(path) if several => PathBuf::from(format!("{}-{name}", path.display())),
        Some(path) => path.clone(),
    }
}
