//! `brdf render`: pictures of BRDFs, with their errors.

mod follow;
mod interrupt;
mod studio;

use std::path::{Path, PathBuf};

use brdf_sdk::table::suggestion;
use brdf_sdk::{Kind, Problem, Result};

use super::machine::Machine;
use super::{apply, apply_preset, print};
use crate::environment::{Filter, Weighting};
use crate::layout::{Layout, Reading};
use crate::link::Sampler;
use crate::picture;
use crate::registry::Registry;
use crate::render::{MAX_REPLICATES, MAX_SAMPLES, Wish};
use crate::session::{Background, Chosen, Session, parse_resolution};
use studio::Studio;

#[derive(Debug, clap::Args)]
pub(in crate::cli) struct Arguments {
    /// BRDFs by name or folder, a picture each [default: ggx]
    brdfs: Vec<String>,
    /// Start from a scene.toml, or from the header of a picture that this program wrote
    #[arg(long, value_name = "FILE")]
    session: Option<PathBuf>,
    /// The integrator, by name or folder [default: brdf-is]
    #[arg(long, value_name = "INTEGRATOR")]
    rendering: Option<String>,
    /// The environment: a recipe's name, or an .hdr, .exr or .ptx file; six files with a % [default: studio]
    #[arg(long, value_name = "MAP")]
    ibl: Option<String>,
    /// Width of a recipe's map in texels, or of a cube's that becomes a lat-long map
    #[arg(long, value_name = "N")]
    ibl_width: Option<u32>,
    /// How radiance is read between texel centres [default: nearest]
    #[arg(long, value_enum)]
    filter: Option<Filter>,
    /// What the probability of drawing a texel follows [default: luminance]
    #[arg(long, value_enum)]
    weighting: Option<Weighting>,
    /// Light with the map as a lat-long map or as a cube [default: as in its file]
    #[arg(long, value_enum, value_name = "LAYOUT")]
    ibl_layout: Option<Layout>,
    /// The side of a cube's faces in texels [default: as in its file, or a quarter of the width]
    #[arg(long, value_name = "N")]
    ibl_face: Option<u32>,
    /// How the map's file is to be read: auto, lat-long, cross-h, cross-v, strip-row, strip-col,
    /// openexr-lat-long, openexr-cube [default: by its content and shape]
    #[arg(long, value_name = "LAYOUT")]
    env_layout: Option<Reading>,
    /// Replace NaN and negative texels by 0, infinite ones by the map's largest value
    #[arg(long)]
    replace_bad_texels: bool,
    /// Turn the environment about +y first [degrees]
    #[arg(long, value_name = "DEG", allow_negative_numbers = true)]
    phi: Option<f64>,
    /// Turn the environment about +x second [degrees]
    #[arg(long, value_name = "DEG", allow_negative_numbers = true)]
    theta: Option<f64>,
    /// sphere, torus, plane, or an .obj, .gltf or .glb file [default: sphere]
    #[arg(long, value_name = "SHAPE")]
    shape: Option<String>,
    /// yaw, pitch, fov in degrees and distance, as in yaw=30,pitch=20,distance=4.5,fov=30
    #[arg(long, value_name = "KEY=VALUE,...", allow_hyphen_values = true)]
    camera: Option<String>,
    /// Size of the picture [default: 512]
    #[arg(long, value_name = "N|WxH", allow_hyphen_values = true)]
    resolution: Option<String>,
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
    /// Where the samples' points come from [default: owen-sobol]
    #[arg(long, value_enum)]
    sampler: Option<Sampler>,
    /// Seed of the samples [default: 0]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    seed: Option<u32>,
    /// Start from a preset of the BRDF (see `brdf list`); --set changes it further
    #[arg(long, value_name = "NAME")]
    preset: Option<String>,
    /// Set a parameter of the BRDF
    #[arg(long, value_name = "KEY=VALUE", allow_hyphen_values = true)]
    set: Vec<String>,
    /// Set a parameter of the integrator
    #[arg(long, value_name = "KEY=VALUE", allow_hyphen_values = true)]
    iset: Vec<String>,
    /// What is seen past the object [default: env]
    #[arg(long, value_enum)]
    background: Option<Background>,
    /// Exposure of the PNG in stops; up to 0.5 linear, above 1 - 1/(4x), then sRGB [default: 0]
    #[arg(long, value_name = "STOPS", allow_negative_numbers = true)]
    exposure: Option<f64>,
    /// Path of the pictures without their ending; several BRDFs add their names [default: the BRDF's name]
    #[arg(long, value_name = "PATH")]
    export: Option<PathBuf>,
    #[command(flatten)]
    machine: Machine,
    /// Print one JSON object a picture
    #[arg(long)]
    json: bool,
    /// Render again whenever a file of the plugins changes
    #[arg(long)]
    watch: bool,
}

pub(in crate::cli) fn run(registry: &Registry, arguments: &Arguments) -> Result<()> {
    let mut session = session(registry, arguments)?;
    if !arguments.watch {
        interrupt::listen()?;
    }
    let brdfs = brdfs(registry, arguments, &session)?;
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

    let exports = exports(arguments, &brdfs)?;
    let mut studio = Studio::open(registry, arguments, &session)?;
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

/// The scene: from a file or the defaults, changed by the options.
fn session(registry: &Registry, arguments: &Arguments) -> Result<Session> {
    let mut session = match &arguments.session {
        None => Session::new(registry)?,
        Some(path) => read_session(registry, path)?,
    };
    if let Some(name) = &arguments.rendering {
        session.integrator = Chosen::find(registry, Kind::Integrator, name)?;
    }
    apply(&mut session.integrator.configured, &arguments.iset)?;
    let light = &mut session.environment;
    if let Some(map) = &arguments.ibl {
        light.map.clone_from(map);
    }
    light.width = arguments.ibl_width.or(light.width);
    light.layout = arguments.ibl_layout.or(light.layout);
    light.face = arguments.ibl_face.or(light.face);
    if let Some(Reading(arrangement)) = arguments.env_layout {
        light.arrangement = arrangement;
    }
    light.replace_bad_texels |= arguments.replace_bad_texels;
    light.lighting.filter = arguments.filter.unwrap_or(light.lighting.filter);
    light.lighting.weighting = arguments.weighting.unwrap_or(light.lighting.weighting);
    light.phi = finite("--phi", arguments.phi)?.unwrap_or(light.phi);
    light.theta = finite("--theta", arguments.theta)?.unwrap_or(light.theta);
    if let Some(shape) = &arguments.shape {
        session.shape.clone_from(shape);
    }
    if let Some(camera) = &arguments.camera {
        session.camera = crate::scene::Camera::parse(camera)?;
    }
    let film = &mut session.film;
    if let Some(resolution) = &arguments.resolution {
        film.resolution = parse_resolution(resolution)?;
    }
    film.exposure = finite("--exposure", arguments.exposure)?.unwrap_or(film.exposure);
    film.background = arguments.background.unwrap_or(film.background);
    let effort = &mut session.effort;
    effort.samples = arguments.samples.unwrap_or(effort.samples);
    effort.replicates = arguments.replicates.unwrap_or(effort.replicates);
    session.sampler = arguments.sampler.unwrap_or(session.sampler);
    let stop = &mut session.stop;
    stop.time = positive("--time", arguments.time)?.or(stop.time);
    stop.error = positive("--error", arguments.error)?.or(stop.error);
    if arguments.time.or(arguments.error).is_some() {
        effort.passes = None;
    }
    effort.passes = arguments.passes.or(effort.passes);
    effort.seed = arguments.seed.unwrap_or(effort.seed);
    Ok(session)
}

fn read_session(registry: &Registry, path: &Path) -> Result<Session> {
    let shown = path.display().to_string();
    let folder = path.parent().unwrap_or(Path::new(""));
    if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("exr")) {
        let scene = picture::read_scene(path)?;
        return Session::parse(registry, &format!("{shown} (header)"), &scene, folder);
    }
    let source = std::fs::read_to_string(path).map_err(|error| {
        let why = match error.kind() {
            std::io::ErrorKind::InvalidData => "it is no text".to_owned(),
            _ => error.to_string(),
        };
        Problem::new(
            &shown,
            format!("the scene cannot be read ({why})"),
            "name a scene.toml or a picture of this program",
        )
    })?;
    Session::parse(registry, &shown, &source, folder)
}

fn positive(option: &str, value: Option<f64>) -> Result<Option<f64>> {
    match value {
        Some(number) if !(number > 0.0 && number.is_finite()) => Err(Problem::new(
            format!("{option} {number}"),
            "this is no positive number",
            "write a number above 0",
        )),
        other => Ok(other),
    }
}

fn finite(option: &str, value: Option<f64>) -> Result<Option<f64>> {
    match value {
        Some(number) if !number.is_finite() => Err(Problem::new(
            format!("{option} {number}"),
            "this is no finite number",
            "write a finite number",
        )),
        other => Ok(other),
    }
}

/// The BRDFs to render, with `--set` applied to each that has such a parameter.
fn brdfs(registry: &Registry, arguments: &Arguments, session: &Session) -> Result<Vec<Chosen>> {
    let mut brdfs = if arguments.brdfs.is_empty() {
        vec![session.brdf.clone()]
    } else {
        let find = |name: &String| Chosen::find(registry, Kind::Brdf, name);
        arguments.brdfs.iter().map(find).collect::<Result<Vec<_>>>()?
    };
    if let Some(name) = &arguments.preset {
        // Each BRDF that has it takes it; all are asked before one is missed.
        let taken = brdfs
            .iter_mut()
            .filter_map(|b| apply_preset(&mut b.configured, name).then_some(()))
            .count();
        if taken == 0 {
            let presets = brdfs.iter().flat_map(|brdf| &brdf.configured.plugin.manifest.presets);
            let cure = suggestion(name, presets.map(|preset| preset.name.as_str()));
            return Err(Problem::new(format!("--preset {name}"), "there is no such preset", cure));
        }
    }
    for assignment in &arguments.set {
        let key = assignment.split('=').next().unwrap_or_default().trim();
        let alone = brdfs.len() == 1;
        let known = |brdf: &Chosen| brdf.configured.plugin.manifest.param(key).is_some();
        let anyone = brdfs.iter().any(known);
        for brdf in &mut brdfs {
            if alone || !anyone || known(brdf) {
                apply(&mut brdf.configured, std::slice::from_ref(assignment))?;
            }
        }
    }
    Ok(brdfs)
}

/// Where each picture goes; two of one name, or a folder that is not there, are refused before any work.
fn exports(arguments: &Arguments, brdfs: &[Chosen]) -> Result<Vec<PathBuf>> {
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
        let picture_of = |path: &PathBuf| path.canonicalize().ok();
        let source = arguments.session.as_ref().and_then(picture_of);
        if source.is_some() && source == picture_of(&picture::with_ending(&export, "exr")) {
            return Err(Problem::new(
                export.display().to_string(),
                "the new picture would replace the one that --session names",
                "give it another name with --export",
            ));
        }
        for ending in ["exr", "png"] {
            picture::check_writable(&picture::with_ending(&export, ending))?;
        }
        exports.push(export);
    }
    Ok(exports)
}

fn export_path(arguments: &Arguments, brdf: &Chosen, several: bool) -> PathBuf {
    let id = &brdf.configured.plugin.id;
    match &arguments.export {
        None => PathBuf::from(id),
        Some(path) if several => PathBuf::from(format!("{}-{id}", path.display())),
        Some(path) => path.clone(),
    }
}
