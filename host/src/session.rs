//! One scene: what the command line, sessions, references, benchmarks and the EXR header share.
//!
//! Read from `scene.toml`, written back the same way; the header of every picture holds it, so that a
//! picture can be made again from itself. It names things; nothing is opened or rendered here, except
//! that plugins are looked up, since their manifests say what their parameters mean.

use std::fmt::Write as _;
use std::path::Path;

use brdf_sdk::manifest::check_format;
use brdf_sdk::table::{Document, Table, suggestion};
use brdf_sdk::{Kind, ParamValue, Problem, Result};

use crate::layout::{Arrangement, Layout, word};
use crate::registry::Registry;
use crate::render::{Effort, Lighting, MAX_REPLICATES, MAX_SAMPLES, Sampler, Stop};
use crate::scene::Camera;
use crate::tone::Tone;
use read::{count, one_of, positive, set};

mod chosen;
mod command;
mod read;

pub use chosen::Chosen;
pub use command::{quoted as shell_quoted, render_command};

/// A scene with all its choices made.
#[derive(Debug, Clone, PartialEq)]
pub struct Session {
    /// The BRDF with its parameters.
    pub brdf: Chosen,
    /// BRDFs that plots show beside it; a picture has no use for them.
    pub beside: Vec<Chosen>,
    /// The integrator with its settings.
    pub integrator: Chosen,
    /// The light.
    pub environment: Light,
    /// `sphere`, `torus`, `plane`, or the path of a mesh.
    pub shape: String,
    /// From where it is seen.
    pub camera: Camera,
    /// The picture.
    pub film: Output,
    /// How much is sampled.
    pub effort: Effort,
    /// What ends it earlier.
    pub stop: Stop,
    /// Where the samples' points come from.
    pub sampler: Sampler,
}

/// An environment and how it is turned.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Light {
    /// A recipe's name, or the path of a map's file; one with a `%` names six files.
    pub map: String,
    /// Turn about +y, applied first [degrees].
    pub phi: f64,
    /// Turn about +x, applied second [degrees].
    pub theta: f64,
    /// Width of a recipe's map in texels, or of a cube's that becomes a lat-long map; its own default without.
    pub width: Option<u32>,
    /// Whether NaN, Inf and negative texels are replaced.
    pub replace_bad_texels: bool,
    /// How it is read and its importance weighed.
    pub lighting: Lighting,
    /// How the map's picture is to be read; by its content and shape without.
    pub arrangement: Option<Arrangement>,
    /// The layout that lights the object; that of the file without.
    pub layout: Option<Layout>,
    /// The side of a cube's faces in texels; that of the file, or a quarter of the width, without.
    pub face: Option<u32>,
}

impl Light {
    /// Another map, read as it is by itself; how it is turned and filtered stays.
    pub fn set_map(&mut self, map: String) {
        let Self { phi, theta, replace_bad_texels, lighting, .. } = *self;
        *self = Self { map, phi, theta, replace_bad_texels, lighting, ..Self::default() };
    }
}

/// The picture's size and looks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Output {
    /// Width and height in pixels.
    pub resolution: [u32; 2],
    /// How the PNG and screens show it; the EXR stays as it is.
    pub tone: Tone,
    /// What is seen past the object.
    pub background: Background,
}

/// What is seen past the object.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Background {
    /// The environment.
    Env,
    /// Nothing.
    Black,
}

impl Background {
    fn word(self) -> &'static str {
        match self {
            Background::Env => "env",
            Background::Black => "black",
        }
    }
}

impl Session {
    /// The scene without what no rendering of it depends on: how a screen shows it, and the BRDFs beside.
    pub fn bare(mut self) -> Self {
        (self.film.tone, self.beside) = (Tone::default(), Vec::new());
        self
    }

    /// The scene that `brdf render` alone renders.
    pub fn new(registry: &Registry) -> Result<Self> {
        Ok(Self {
            brdf: Chosen::find(registry, Kind::Brdf, "ggx")?,
            beside: Vec::new(),
            integrator: Chosen::by_samples(registry)?,
            environment: Light { map: "studio".to_owned(), ..Light::default() },
            shape: "sphere".to_owned(),
            camera: Camera::default(),
            film: Output {
                resolution: [512, 512],
                tone: Tone::default(),
                background: Background::Env,
            },
            effort: Effort::new(64, 16),
            stop: Stop::default(),
            sampler: Sampler::default(),
        })
    }

    /// Reads `scene.toml`; paths in it are relative to `folder`, keys that it leaves out keep their default.
    pub fn parse(registry: &Registry, file: &str, source: &str, folder: &Path) -> Result<Self> {
        Document { file, source }.read(|table| {
            check_format(table)?;
            let mut session = Self::new(registry)?;
            section(table, "brdf", |section| {
                read_plugin(registry, Kind::Brdf, section, folder, &mut session.brdf)
            })?;
            section(table, "integrator", |section| {
                read_plugin(registry, Kind::Integrator, section, folder, &mut session.integrator)
            })?;
            if let Some(value) = table.get("beside") {
                for item in value.items()? {
                    let section = item.table()?;
                    section.require("plugin", "the name or the folder of a BRDF")?;
                    let mut chosen = session.brdf.clone();
                    read_plugin(registry, Kind::Brdf, &section, folder, &mut chosen)?;
                    section.finish()?;
                    session.beside.push(chosen);
                }
            }
            section(table, "environment", |s| read_light(s, folder, &mut session.environment))?;
            section(table, "shape", |s| {
                let value = s.require(
                    "kind",
                    "`kind = \"sphere\"`, torus, plane, teapot, or a mesh's path",
                )?;
                session.shape = from_folder(folder, value.string()?);
                Ok(())
            })?;
            section(table, "camera", |s| read_camera(s, &mut session.camera))?;
            section(table, "film", |s| read_output(s, &mut session.film))?;
            section(table, "stopping", |s| read_stopping(s, &mut session))?;
            Ok(session)
        })
    }

    /// The scene as `scene.toml`, with absolute paths.
    pub fn to_toml(&self) -> String {
        let mut text = String::from("format = 1\n");
        for chosen in [&self.brdf, &self.integrator] {
            let kind = chosen.configured.plugin.manifest.kind.word();
            let plugin = quoted(&chosen.reference);
            let _ = writeln!(text, "\n[{kind}]\nplugin = {plugin}");
            write_fit(&mut text, chosen);
            if chosen.configured.values.iter().next().is_some() {
                let _ = writeln!(text, "\n[{kind}.params]");
            }
            write_values(&mut text, chosen);
        }
        for chosen in &self.beside {
            let plugin = quoted(&chosen.reference);
            let _ = writeln!(text, "\n[[beside]]\nplugin = {plugin}");
            write_fit(&mut text, chosen);
            text.push_str("\n[beside.params]\n");
            write_values(&mut text, chosen);
        }
        let light = &self.environment;
        let _ = writeln!(text, "\n[environment]\nmap = {}", quoted(&absolute(&light.map)));
        let _ = writeln!(text, "phi = {:?}\ntheta = {:?}", light.phi, light.theta);
        if let Some(width) = light.width {
            let _ = writeln!(text, "width = {width}");
        }
        if light.replace_bad_texels {
            text.push_str("replace_bad_texels = true\n");
        }
        let Lighting { filter, weighting } = light.lighting;
        let _ = writeln!(text, "filter = {:?}\nweighting = {:?}", word(&filter), word(&weighting));
        if let Some(arrangement) = light.arrangement {
            let _ = writeln!(text, "read_as = {:?}", word(&arrangement));
        }
        if let Some(layout) = light.layout {
            let _ = writeln!(text, "layout = {:?}", word(&layout));
        }
        if let Some(face) = light.face {
            let _ = writeln!(text, "face = {face}");
        }
        let _ = writeln!(text, "\n[shape]\nkind = {}", quoted(&absolute(&self.shape)));
        let Camera { yaw, pitch, distance, fov, shift } = self.camera;
        let _ = writeln!(
            text,
            "\n[camera]\nyaw = {yaw:?}\npitch = {pitch:?}\ndistance = {distance:?}\nfov = {fov:?}"
        );
        if shift != [0.0; 2] {
            let _ = writeln!(text, "shift = {shift:?}");
        }
        let Output { resolution: [width, height], tone, background } = self.film;
        let _ = writeln!(
            text,
            "\n[film]\nresolution = [{width}, {height}]\nexposure = {:?}\ncurve = {:?}\nbackground = {:?}",
            tone.exposure,
            word(&tone.curve),
            background.word()
        );
        let Effort { samples, passes, replicates, seed, .. } = self.effort;
        let _ = writeln!(text, "\n[stopping]\nsamples = {samples}");
        if let Some(passes) = passes {
            let _ = writeln!(text, "passes = {passes}");
        }
        for (key, value) in [("time", self.stop.time), ("error", self.stop.error)] {
            if let Some(value) = value {
                let _ = writeln!(text, "{key} = {value:?}");
            }
        }
        let sampler = word(&self.sampler);
        let _ = writeln!(text, "replicates = {replicates}\nseed = {seed}\nsampler = {sampler:?}");
        text
    }
}

fn write_fit(text: &mut String, chosen: &Chosen) {
    if chosen.configured.fit_sampler {
        text.push_str("fit_sampler = true\n");
    }
}

/// A line for each parameter.
fn write_values(text: &mut String, chosen: &Chosen) {
    for (key, value) in chosen.configured.values.iter() {
        let value = match value {
            ParamValue::File(path) => ParamValue::File(absolute(path)),
            other => other.clone(),
        };
        let _ = writeln!(text, "{key} = {}", value.to_toml());
    }
}

/// Reads one section, if it is there, and refuses what it does not know.
fn section(
    table: &Table<'_>,
    key: &str,
    read: impl FnOnce(&Table<'_>) -> Result<()>,
) -> Result<()> {
    let Some(value) = table.get(key) else { return Ok(()) };
    let section = value.table()?;
    read(&section)?;
    section.finish()
}

fn read_plugin(
    registry: &Registry,
    kind: Kind,
    section: &Table<'_>,
    folder: &Path,
    chosen: &mut Chosen,
) -> Result<()> {
    if let Some(value) = section.get("plugin") {
        let name = value.string()?;
        let reference = from_folder(folder, name);
        *chosen =
            Chosen::find(registry, kind, &reference).map_err(|problem| match problem.place {
                Some(_) => problem,
                None => {
                    value.problem(format!("{}: {}", problem.thing, problem.reason), problem.cure)
                }
            })?;
    }
    if kind == Kind::Brdf {
        set(&mut chosen.configured.fit_sampler, section.get("fit_sampler"), |v| v.boolean())?;
    }
    if let Some(value) = section.get("params") {
        let params = value.table()?;
        let manifest = chosen.configured.plugin.manifest.clone();
        let values = &mut chosen.configured.values;
        values.set_table(&manifest, &params)?;
        for entry in params.entries() {
            if let Some(ParamValue::File(path)) = values.get(&entry.key)
                && !path.is_empty()
            {
                let path = folder.join(path).display().to_string();
                values.set(&entry.key, ParamValue::File(path));
            }
        }
        params.finish()?;
    }
    Ok(())
}

fn read_light(s: &Table<'_>, folder: &Path, light: &mut Light) -> Result<()> {
    if let Some(value) = s.get("map") {
        light.map = from_folder(folder, value.string()?);
    }
    set(&mut light.phi, s.get("phi"), |v| v.number())?;
    set(&mut light.theta, s.get("theta"), |v| v.number())?;
    set(&mut light.replace_bad_texels, s.get("replace_bad_texels"), |v| v.boolean())?;
    set(&mut light.lighting.filter, s.get("filter"), one_of)?;
    set(&mut light.lighting.weighting, s.get("weighting"), one_of)?;
    set(&mut light.arrangement, s.get("read_as"), |v| one_of(v).map(Some))?;
    set(&mut light.layout, s.get("layout"), |v| one_of(v).map(Some))?;
    set(&mut light.face, s.get("face"), |v| Ok(Some(count(v, 1)?)))?;
    set(&mut light.width, s.get("width"), |v| Ok(Some(count(v, 1)?)))
}

fn read_camera(s: &Table<'_>, camera: &mut Camera) -> Result<()> {
    set(&mut camera.yaw, s.get("yaw"), |v| v.number())?;
    set(&mut camera.pitch, s.get("pitch"), |v| v.number())?;
    set(&mut camera.distance, s.get("distance"), |v| v.number())?;
    set(&mut camera.fov, s.get("fov"), |v| v.number())?;
    set(&mut camera.shift, s.get("shift"), |v| v.numbers())?;
    camera.check().map_err(|problem| s.problem(s.span(), problem.reason, problem.cure))
}

fn read_output(s: &Table<'_>, film: &mut Output) -> Result<()> {
    set(&mut film.resolution, s.get("resolution"), |v| {
        let items = v.items()?;
        match items.as_slice() {
            [width, height] => Ok([count(width, 1)?, count(height, 1)?]),
            _ => Err(v.problem("a resolution has two entries", "write [width, height]")),
        }
    })?;
    set(&mut film.tone.exposure, s.get("exposure"), |v| v.number())?;
    set(&mut film.tone.curve, s.get("curve"), one_of)?;
    set(&mut film.background, s.get("background"), |v| match v.string()?.as_str() {
        "env" => Ok(Background::Env),
        "black" => Ok(Background::Black),
        other => Err(v.problem(
            format!("there is no background `{other}`"),
            suggestion(other, ["env", "black"].into_iter()),
        )),
    })
}

fn read_stopping(s: &Table<'_>, session: &mut Session) -> Result<()> {
    let Session { effort, stop, sampler, .. } = session;
    set(&mut effort.samples, s.get("samples"), |v| {
        let samples = count(v, 1)?;
        match samples <= MAX_SAMPLES {
            true => Ok(samples),
            false => Err(v.problem(
                format!("{samples} samples a pass exceed {MAX_SAMPLES}"),
                "take more passes instead",
            )),
        }
    })?;
    set(&mut effort.replicates, s.get("replicates"), |v| {
        let replicates = count(v, 1)?;
        match replicates <= MAX_REPLICATES {
            true => Ok(replicates),
            false => Err(
                v.problem(format!("{replicates} replicates exceed {MAX_REPLICATES}"), "take fewer")
            ),
        }
    })?;
    set(&mut stop.time, s.get("time"), |v| Ok(Some(positive(v)?)))?;
    set(&mut stop.error, s.get("error"), |v| Ok(Some(positive(v)?)))?;
    if stop.time.is_some() || stop.error.is_some() {
        effort.passes = None;
    }
    set(&mut effort.passes, s.get("passes"), |v| Ok(Some(count(v, 1)?)))?;
    set(sampler, s.get("sampler"), one_of)?;
    set(&mut effort.seed, s.get("seed"), |v| count(v, 0))
}

/// A path as seen from the scene's folder; plain names, such as `ggx` or `studio`, stay as they are.
fn from_folder(folder: &Path, name: String) -> String {
    match is_path(&name) {
        true => folder.join(&name).display().to_string(),
        false => name,
    }
}

fn is_path(name: &str) -> bool {
    name.contains(['/', '\\', '.'])
}

fn full_path(path: &Path) -> String {
    path.canonicalize().unwrap_or_else(|_| path.to_owned()).display().to_string()
}

/// An existing path in full, so that it is found from any folder, and six files by their folder; names stay as
/// they are.
fn absolute(name: &str) -> String {
    let path = Path::new(name);
    if let (Some(folder), Some(file)) = (path.parent(), path.file_name())
        && file.to_string_lossy().contains('%')
        && !path.exists()
    {
        let here = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        return here.canonicalize().map_or(name.to_owned(), |f| f.join(file).display().to_string());
    }
    match path.canonicalize() {
        Ok(path) if is_path(name) => path.display().to_string(),
        _ => name.to_owned(),
    }
}

fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

/// Reads a resolution as the command line writes it: `512` or `640x480`.
pub fn parse_resolution(text: &str) -> Result<[u32; 2]> {
    let side = |text: &str| text.trim().parse::<u32>().ok().filter(|side| *side > 0);
    let parsed = match text.split_once(['x', 'X']) {
        Some((width, height)) => side(width).zip(side(height)).map(|(w, h)| [w, h]),
        None => side(text).map(|n| [n, n]),
    };
    parsed.ok_or_else(|| {
        Problem::new(
            format!("--resolution {text}"),
            "this is no picture size",
            "write N or WxH with whole numbers of at least 1, such as 512 or 640x480",
        )
    })
}
