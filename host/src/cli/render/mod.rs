//! `brdf render`: pictures of BRDFs, with their errors.

mod follow;

use std::path::{MAIN_SEPARATOR, PathBuf};

use brdf_sdk::{Kind, Problem, Result};

use super::scene::{SceneOptions, positive};
use super::studio::{self, Studio};
use super::{interrupt, readable};
use crate::registry::Registry;
use crate::render::{MAX_REPLICATES, MAX_SAMPLES, Wish};
use crate::session::{Chosen, Session};

#[derive(Debug, clap::Args)]
pub(in crate::cli) struct Arguments {
    /// BRDFs by name, by folder or by a file (.brdf, .bparam, measured data), a picture each [default: ggx]
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
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_SAMPLES)))]
    samples: Option<u32>,
    /// Passes [default: 16; without end where --time or --error is given]
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = clap::value_parser!(u32).range(1..))]
    passes: Option<u32>,
    /// Stop after this time of rendering [s]
    #[arg(long, value_name = "S", allow_hyphen_values = true)]
    time: Option<f64>,
    /// Stop at this estimated relMSE of the picture; looked at where the samples have doubled, after 64
    #[arg(long, value_name = "RELMSE", allow_hyphen_values = true)]
    error: Option<f64>,
    /// Independent scrambles that share the samples; their spread estimates the error [default: 16]
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_REPLICATES)))]
    replicates: Option<u32>,
    /// Path of the pictures without their ending; several BRDFs add their names; a folder where it ends in `/`
    /// [default: the BRDF's name]
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
    let mut left_out = 0;
    let brdfs = match arguments.brdfs.as_slice() {
        [] => arguments.scene.brdfs(registry, &[], &session)?,
        names => {
            let (found, problems) =
                readable(names, |name| Chosen::find(registry, Kind::Brdf, name))?;
            left_out = problems.len();
            arguments.scene.configured(found)?
        }
    };
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
            // The others are no worse for it.
            Err(problem) if brdfs.len() > 1 => {
                eprintln!("error: {problem}");
                left_out += 1;
            }
            Err(problem) => return Err(problem),
        }
    }
    if left_out > 0 {
        return Err(Problem::new(
            format!("{left_out} of {} BRDFs", arguments.brdfs.len()),
            "there is no picture of them",
            "mend what is told above",
        ));
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
    session.integrator.configured.assign(&arguments.iset)?;
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

/// Where each picture goes, with a number behind a name that was taken before; a folder that is not there is refused before
/// any work.
fn exports(arguments: &Arguments, brdfs: &[Chosen], session: &Session) -> Result<Vec<PathBuf>> {
    let mut exports: Vec<PathBuf> = Vec::new();
    for brdf in brdfs {
        let plain = export_path(arguments, brdf, brdfs.len() > 1);
        let numbered = |number| PathBuf::from(format!("{}-{number}", plain.display()));
        let mut free = std::iter::once(plain.clone()).chain((2..).map(numbered));
        let export = free.find(|path| !exports.contains(path)).unwrap_or_default();
        arguments.scene.check_export(&export, brdf, session)?;
        exports.push(export);
    }
    Ok(exports)
}

fn export_path(arguments: &Arguments, brdf: &Chosen, several: bool) -> PathBuf {
    let name = brdf.name();
    match &arguments.export {
        None => PathBuf::from(name),
        // A folder: without a name in it a picture would be hidden.
        Some(path) if path.as_os_str().to_string_lossy().ends_with(['/', MAIN_SEPARATOR]) => {
            path.join(name)
        }
        Some(path) if several => PathBuf::from(format!("{}-{name}", path.display())),
        Some(path) => path.clone(),
    }
}

#[cfg(test)]
mod tests {
    use clap::{CommandFactory, Parser};

    use super::*;
    use crate::cli::{Cli, Verb};
    use crate::session::render_command;

    /// The command that a scene is written as makes this very scene.
    fn back(registry: &Registry, scene: &Session) -> Session {
        scene_of(registry, render_command(scene))
    }

    fn scene_of(registry: &Registry, words: impl IntoIterator<Item = String>) -> Session {
        let cli = Cli::try_parse_from(std::iter::once("brdf".to_owned()).chain(words)).unwrap();
        let Some(Verb::Render(arguments)) = cli.verb else { panic!("another verb") };
        let mut read = session(registry, &arguments).unwrap();
        read.brdf = arguments.scene.brdfs(registry, &arguments.brdfs, &read).unwrap().remove(0);
        read
    }

    /// Who writes what the help calls the default gets the scene that is made without.
    #[test]
    fn defaults_are_what_the_help_says() {
        let registry = Registry::new(&[]);
        let usual = Session::new(&registry).unwrap();
        let command = Cli::command();
        let mut told = 0;
        for argument in command.find_subcommand("render").unwrap().get_arguments() {
            let help = argument.get_help().map(ToString::to_string).unwrap_or_default();
            let Some((_, default)) = help.split_once("[default: ") else { continue };
            let default = default.split([']', ';']).next().unwrap();
            // What follows from a file is told in several words.
            if default.contains(' ') {
                continue;
            }
            let option = argument.get_long().map(|long| format!("--{long}"));
            let words = std::iter::once("render".to_owned()).chain(option);
            let scene = scene_of(&registry, words.chain([default.to_owned()]));
            assert_eq!(scene, usual, "{}: {default}", argument.get_id());
            told += 1;
        }
        assert!(told >= 13, "{told} defaults");
    }

    #[test]
    fn a_command_makes_the_scene_that_it_was_written_of() {
        let registry = Registry::new(&[]);
        let usual = Session::new(&registry).unwrap();
        assert_eq!(back(&registry, &usual), usual);
        let text = r#"
            format = 1
            [brdf]
            plugin = "disney"
            [brdf.params]
            roughness = 0.25
            base_color = [0.1, 0.2, 0.3]
            [integrator]
            plugin = "mis-power"
            [environment]
            map = "sunset with 'quotes'.hdr"
            phi = -30.0
            theta = 12.5
            width = 256
            filter = "linear"
            weighting = "largest"
            read_as = "cross-h"
            layout = "cube"
            face = 64
            replace_bad_texels = true
            [shape]
            kind = "torus"
            [camera]
            yaw = 10.0
            shift = [0.5, -0.25]
            [film]
            resolution = [320, 240]
            exposure = -1.5
            curve = "linear"
            background = "black"
            [stopping]
            samples = 32
            passes = 7
            replicates = 8
            seed = 5
            time = 3.5
            error = 1e-4
            sampler = "independent"
        "#;
        let scene =
            Session::parse(&registry, "scene.toml", text, std::path::Path::new("")).unwrap();
        assert_eq!(back(&registry, &scene), scene);
    }
}
