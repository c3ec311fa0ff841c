//! `brdf render`: pictures of BRDFs, with their errors.

use std::io::IsTerminal;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant, SystemTime};

use brdf_sdk::{Kind, ParamValues, Problem, Result};
use indicatif::{ProgressBar, ProgressStyle};

use super::report::{Report, Seconds, sampling_word};
use super::{apply, print};
use crate::environment::orientation;
use crate::exec::Executor;
use crate::exec::gpu::Gpu;
use crate::link::{Program, View, link};
use crate::measure;
use crate::open;
use crate::picture::{self, Picture};
use crate::registry::Registry;
use crate::registry::watch::{Change, Watch};
use crate::render::{HEADLESS_BUDGET, Progress, Rendered, Stage, background, render};
use crate::scene::Coverage;
use crate::session::{Background, Chosen, Session, parse_resolution};

#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// BRDFs by name or folder, a picture each [default: ggx]
    brdfs: Vec<String>,
    /// Start from a scene.toml, or from the header of a picture that this program wrote
    #[arg(long, value_name = "FILE")]
    session: Option<PathBuf>,
    /// The integrator, by name or folder [default: brdf-is]
    #[arg(long, value_name = "INTEGRATOR")]
    rendering: Option<String>,
    /// The environment: a recipe's name, or a lat-long .hdr or .exr file [default: studio]
    #[arg(long, value_name = "MAP")]
    ibl: Option<String>,
    /// Width of a recipe's map in texels
    #[arg(long, value_name = "N")]
    ibl_width: Option<u32>,
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
    #[arg(long, value_name = "N|WxH")]
    resolution: Option<String>,
    /// Samples a pixel in each pass [default: 64]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    samples: Option<u32>,
    /// Passes; their spread estimates the error [default: 16]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    passes: Option<u32>,
    /// Seed of the samples [default: 0]
    #[arg(long, value_name = "N")]
    seed: Option<u32>,
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
    /// The device, by its index or a part of its name (see `brdf devices`)
    #[arg(long, value_name = "DEVICE")]
    device: Option<String>,
    /// Print one JSON object a picture
    #[arg(long)]
    json: bool,
    /// Render again whenever a file of the plugins changes
    #[arg(long)]
    watch: bool,
}

pub(super) fn run(registry: &Registry, arguments: &Arguments) -> Result<()> {
    let mut session = session(registry, arguments)?;
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
        Some(start_watching(&session)?)
    } else {
        None
    };

    let mut studio = Studio::open(registry, arguments, &session)?;
    for brdf in &brdfs {
        session.brdf = brdf.clone();
        let export = export_path(arguments, brdf, brdfs.len() > 1);
        match studio.picture(&session, &export, &mut |_| ControlFlow::Continue(())) {
            Ok(_) => {}
            Err(problem) if watch.is_some() => eprintln!("error: {problem}"),
            Err(problem) => return Err(problem),
        }
    }
    match watch {
        Some(watch) => follow(registry, arguments, session, studio, watch),
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
    light.replace_bad_texels |= arguments.replace_bad_texels;
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
    effort.passes = arguments.passes.unwrap_or(effort.passes);
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
        Problem::new(
            &shown,
            format!("the scene cannot be read ({error})"),
            "name a scene.toml or a picture of this program",
        )
    })?;
    Session::parse(registry, &shown, &source, folder)
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

fn export_path(arguments: &Arguments, brdf: &Chosen, several: bool) -> PathBuf {
    let id = &brdf.configured.plugin.id;
    match &arguments.export {
        None => PathBuf::from(id),
        Some(path) if several => PathBuf::from(format!("{}-{id}", path.display())),
        Some(path) => path.clone(),
    }
}

/// The device and the scene on it: made once, used for every picture.
struct Studio {
    executor: Gpu,
    coverage: Coverage,
    stage: Stage,
    background: Vec<[f32; 3]>,
    notes: Vec<String>,
    setup: Duration,
    json: bool,
}

/// A picture that was made, and how.
struct Made {
    link: Duration,
    rendered: Rendered,
}

impl Studio {
    fn open(registry: &Registry, arguments: &Arguments, session: &Session) -> Result<Self> {
        let start = Instant::now();
        let environment = Arc::new(open::environment(registry, &session.environment)?);
        let mut notes = environment.notes.clone();
        notes.push(format!(
            "{} is {}x{} texels, ready in {:.3} s",
            environment.name, environment.width, environment.height, environment.seconds
        ));
        let coverage = open::shading_points(session)?;
        if coverage.points.is_empty() {
            notes.push("the object covers no pixel: look at --camera and --shape".to_owned());
        }
        let light = &session.environment;
        let world_from_map = orientation::world_from_map(light.phi, light.theta);
        let mut executor = Gpu::open(arguments.device.as_deref())?;
        let mut stage = Stage::new(coverage.points.clone(), environment, world_from_map);
        let background = match session.film.background {
            Background::Black => Vec::new(),
            Background::Env => background::background(
                &mut executor,
                &mut stage,
                &rays_past_the_object(session, &coverage),
            )?,
        };
        let setup = start.elapsed();
        Ok(Self { executor, coverage, stage, background, notes, setup, json: arguments.json })
    }

    /// Links, renders, writes and reports one picture.
    fn picture(
        &mut self,
        session: &Session,
        export: &Path,
        observe: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<Made> {
        let start = Instant::now();
        let brdf = &session.brdf.configured;
        let integrator = &session.integrator.configured;
        let program =
            Arc::new(link(&View::Film { brdf: brdf.clone(), integrator: integrator.clone() })?);
        let link = start.elapsed();
        let bar = progress_bar(u64::from(session.effort.passes));
        let rendered = render(
            &mut self.executor,
            &mut self.stage,
            &program,
            &[brdf, integrator],
            session.effort,
            HEADLESS_BUDGET,
            |progress| {
                bar.set_length(progress.of);
                bar.set_position(progress.blocks);
                observe(progress)
            },
        );
        bar.finish_and_clear();
        let rendered = rendered?;
        if rendered.complete {
            self.write(session, export, &program, &rendered, self.setup + link)?;
        }
        Ok(Made { link, rendered })
    }

    fn write(
        &self,
        session: &Session,
        export: &Path,
        program: &Program,
        rendered: &Rendered,
        setup: Duration,
    ) -> Result<()> {
        let exr = picture::with_ending(export, "exr");
        let png = picture::with_ending(export, "png");
        let spp = u64::from(session.effort.samples) * rendered.film.passes();
        let samples = spp as f64 * self.coverage.points.len() as f64;
        let notes: Vec<String> = self.notes.iter().chain(&program.notes).cloned().collect();
        let mut report = Report {
            brdf: session.brdf.configured.plugin.id.clone(),
            brdf_params: as_json(&session.brdf.configured.values),
            integrator: session.integrator.configured.plugin.id.clone(),
            integrator_params: as_json(&session.integrator.configured.values),
            sampling: sampling_word(program.sampling),
            environment: session.environment.map.clone(),
            shape: session.shape.clone(),
            device: self.executor.name().to_owned(),
            resolution: session.film.resolution,
            covered_pixels: self.coverage.points.len(),
            bent_normals: self.coverage.bent,
            samples: session.effort.samples,
            passes: rendered.film.passes(),
            spp,
            seed: session.effort.seed,
            seconds: Seconds {
                setup: setup.as_secs_f64(),
                compile: rendered.compile.as_secs_f64(),
                render: rendered.render.as_secs_f64(),
            },
            msamples_per_s: samples / rendered.render.as_secs_f64().max(1e-9) / 1e6,
            mean: [0.0; 3],
            mean_std_error: None,
            std_error: None,
            relmse_estimate: None,
            nonfinite: rendered.film.nonfinite(),
            nonfinite_pixels: rendered.film.nonfinite_pixels(),
            notes,
            exr: exr.display().to_string(),
            png: png.display().to_string(),
        };
        report.estimate(measure::estimate(&rendered.film));
        let resolution = session.film.resolution;
        let picture =
            Picture::compose(resolution, &self.coverage.points, &rendered.film, &self.background);
        picture::write_exr(&exr, &picture, &session.to_toml(), &report.facts())?;
        picture::write_png(&png, &picture, session.film.exposure)?;
        if self.json {
            return print(&format!("{}\n", report.json()));
        }
        for note in &report.notes {
            eprintln!("note: {note}");
        }
        print(&report.text())
    }
}

/// Directions through the centres of the pixels that the object leaves free, in their order.
fn rays_past_the_object(session: &Session, coverage: &Coverage) -> Vec<[f32; 3]> {
    let [width, height] = session.film.resolution;
    let mut covered = coverage.points.iter().map(|point| point.pixel).peekable();
    (0..width * height)
        .filter(|pixel| covered.next_if_eq(pixel).is_none())
        .map(|pixel| {
            let ray = session.camera.ray([width, height], pixel % width, pixel / width);
            ray.dir.as_vec3().to_array()
        })
        .collect()
}

fn as_json(values: &ParamValues) -> serde_json::Map<String, serde_json::Value> {
    use brdf_sdk::ParamValue;
    let json = |value: &ParamValue| match value {
        ParamValue::Float(number) => (*number).into(),
        ParamValue::Int(number) => (*number).into(),
        ParamValue::Bool(value) => (*value).into(),
        ParamValue::Color(rgb) => rgb.to_vec().into(),
        ParamValue::Choice(text) | ParamValue::File(text) => text.clone().into(),
    };
    values.iter().map(|(key, value)| (key.to_owned(), json(value))).collect()
}

/// A bar on a terminal, nothing on a pipe.
fn progress_bar(length: u64) -> ProgressBar {
    if !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let style =
        ProgressStyle::with_template("{bar:40} {percent:>3} %  {elapsed} of about {duration}");
    ProgressBar::new(length).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}

fn start_watching(session: &Session) -> Result<Watch> {
    let folders: Vec<PathBuf> =
        [&session.brdf, &session.integrator].into_iter().filter_map(|c| c.folder.clone()).collect();
    if folders.is_empty() {
        return Err(Problem::new(
            "--watch",
            "both plugins are embedded in the program, where no file changes",
            "name the folder of a plugin; `brdf new brdf NAME` makes one",
        ));
    }
    Watch::new(folders)
}

/// Renders again after every change, until the program is stopped. A broken plugin is told of once,
/// and the last good picture stays.
fn follow(
    registry: &Registry,
    arguments: &Arguments,
    mut session: Session,
    mut studio: Studio,
    mut watch: Watch,
) -> Result<()> {
    eprintln!("watching; stop with Ctrl-C");
    let export = export_path(arguments, &session.brdf, false);
    let mut pending: Option<Change> = None;
    let mut told: Option<String> = None;
    loop {
        let change = match pending.take() {
            Some(change) => change,
            None => match watch.wait(Duration::from_secs(3600)) {
                Some(change) => change,
                None => continue,
            },
        };
        let mut first_pixel = None;
        let made = reloaded(registry, &session).and_then(|fresh| {
            let made = studio.picture(&fresh, &export, &mut |_| {
                first_pixel.get_or_insert_with(|| since(change.saved));
                pending = watch.wait(Duration::ZERO);
                if pending.is_some() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            })?;
            session = fresh;
            Ok(made)
        });
        match made {
            Ok(made) => {
                told = None;
                eprintln!(
                    "reloaded: first pixel {:.0} ms after the save (link {:.0} ms, compile {:.0} ms)",
                    first_pixel.unwrap_or_default().as_secs_f64() * 1e3,
                    made.link.as_secs_f64() * 1e3,
                    made.rendered.compile.as_secs_f64() * 1e3,
                );
            }
            Err(problem) => {
                // Half a file may have been read; the rest comes within moments.
                pending = watch.wait(Duration::from_millis(150));
                if pending.is_some() {
                    continue;
                }
                let message = problem.to_string();
                if told.as_ref() != Some(&message) {
                    eprintln!("error: {message}\nthe last good picture stays");
                }
                told = Some(message);
            }
        }
    }
}

/// Both plugins read again, parameters kept by name.
fn reloaded(registry: &Registry, session: &Session) -> Result<Session> {
    Ok(Session {
        brdf: session.brdf.reload(registry)?,
        integrator: session.integrator.reload(registry)?,
        ..session.clone()
    })
}

fn since(saved: SystemTime) -> Duration {
    SystemTime::now().duration_since(saved).unwrap_or_default()
}
