//! What is measured, and how long.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use brdf_sdk::{Kind, Problem, Result};
use glam::DMat3;
use serde::{Deserialize, Serialize};

use super::Case;
use crate::environment::Environment;
use crate::link::{View, link};
use crate::open;
use crate::registry::Registry;
use crate::render::Stage;
use crate::session::{Chosen, Session};

/// How far each cell is taken.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Limits {
    /// Time of rendering of a cell [s]: samples double as long as twice the time would be within it.
    pub time: f64,
    /// Samples of a pixel at the most.
    pub samples: u64,
    /// How often each cell is timed.
    pub repeats: u32,
    /// The relMSE whose time is told.
    pub target: f64,
    /// Seed of all samples.
    pub seed: u32,
}

impl Default for Limits {
    fn default() -> Self {
        Self { time: 1.0, samples: 1 << 20, repeats: 3, target: 1e-3, seed: 0 }
    }
}

/// Cases, integrators and limits.
#[derive(Debug, Clone)]
pub struct Plan {
    /// The scenes.
    pub cases: Vec<Case>,
    /// The integrators, each for every scene.
    pub integrators: Vec<Chosen>,
    /// How far each cell is taken.
    pub limits: Limits,
}

/// Plans with a name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Preset {
    /// Two BRDFs under two maps, small: what CI has time for
    Quick,
}

/// A preset as its file says it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Told {
    /// Time of a cell [s].
    time: f64,
    resolution: [u32; 2],
    /// Width of the maps in texels.
    width: u32,
    maps: Vec<String>,
    integrators: Vec<String>,
    brdf: Vec<ToldBrdf>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct ToldBrdf {
    name: String,
    plugin: String,
    #[serde(default)]
    set: Vec<String>,
}

impl Preset {
    fn text(self) -> &'static str {
        match self {
            Self::Quick => include_str!("presets/quick.toml"),
        }
    }

    /// The plan.
    ///
    /// # Errors
    /// Where a plugin that it names is not there, or a user's own of that name has other parameters.
    pub fn plan(self, registry: &Registry) -> Result<Plan> {
        let told: Told = toml::from_str(self.text()).map_err(|error| {
            Problem::new("the preset", error.to_string().replace('\n', " "), "report this")
        })?;
        let mut cases = Vec::new();
        for brdf in &told.brdf {
            for map in &told.maps {
                let mut scene = Session::new(registry)?;
                scene.brdf = configured(registry, &brdf.plugin, &brdf.set)?;
                scene.environment.set_map(map.clone());
                scene.environment.width = Some(told.width);
                scene.film.resolution = told.resolution;
                let name = format!("{} under {map}", brdf.name);
                cases.push(Case { name, about: String::new(), scene });
            }
        }
        let find = |id: &String| Chosen::find(registry, Kind::Integrator, id);
        let integrators = told.integrators.iter().map(find).collect::<Result<_>>()?;
        let limits = Limits { time: told.time, ..Limits::default() };
        Ok(Plan { cases, integrators, limits })
    }
}

/// A BRDF with some parameters set.
fn configured(registry: &Registry, id: &str, set: &[String]) -> Result<Chosen> {
    let mut chosen = Chosen::find(registry, Kind::Brdf, id)?;
    let configured = &mut chosen.configured;
    for assignment in set {
        configured.values.set_text(&configured.plugin.manifest, assignment)?;
    }
    Ok(chosen)
}

/// Integrators that draw samples of the map for this scene: not those that look at no map, and not those that add up
/// texels, which take another kind of time.
pub fn samplers(registry: &Registry, scene: &Session) -> Vec<Chosen> {
    let nothing = Arc::new(Environment::constant(1.0));
    let form = Stage::new(Vec::new(), nothing, DMat3::IDENTITY).form(scene.sampler);
    let draws = |chosen: &Chosen| {
        let program = link(&View::Film {
            brdf: scene.brdf.configured.clone(),
            integrator: chosen.configured.clone(),
            form,
        });
        program.is_ok_and(|program| program.sum.is_none() && program.binds("env_map"))
    };
    let all = registry.all(Kind::Integrator).into_iter();
    let found = all.filter_map(|found| Chosen::find(registry, Kind::Integrator, &found.id).ok());
    found.filter(draws).collect()
}

/// The scenes of files, and of all folders below a folder that hold a `scene.toml`; each is called as its folder is, or
/// as its file.
///
/// # Errors
/// Where there is none, or one of them cannot be read.
pub fn scenes(registry: &Registry, paths: &[PathBuf]) -> Result<Vec<Case>> {
    const SCENE: &str = "scene.toml";
    let mut cases = Vec::new();
    let name = |path: &Path| {
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned());
        name.unwrap_or_else(|| path.display().to_string())
    };
    for path in paths {
        if !path.is_dir() {
            let stem = path.with_extension("");
            cases.push(case(registry, name(&stem), path)?);
            continue;
        }
        let shown = path.display().to_string();
        let entries = std::fs::read_dir(path).map_err(|error| {
            Problem::new(&shown, format!("it cannot be read ({})", error.kind()), "check the path")
        })?;
        let mut folders: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
        folders.push(path.clone());
        folders.retain(|folder| folder.join(SCENE).is_file());
        folders.sort();
        if folders.is_empty() {
            return Err(Problem::new(
                shown,
                "neither it nor a folder in it holds a scene.toml",
                "name a scene, or a folder of such",
            ));
        }
        for folder in folders {
            cases.push(case(registry, name(&folder), &folder.join(SCENE))?);
        }
    }
    Ok(cases)
}

/// A scene's file; what it is about stands in the comment that it begins with.
fn case(registry: &Registry, name: String, path: &Path) -> Result<Case> {
    let scene = open::session(registry, path)?;
    let text = std::fs::read_to_string(path).unwrap_or_default();
    let about = text.lines().map_while(|line| line.strip_prefix('#')).map(str::trim);
    Ok(Case { name, about: about.collect::<Vec<_>>().join(" "), scene })
}

impl Plan {
    /// Every BRDF under every map on every shape, each otherwise as `scene`.
    pub fn matrix(
        scene: &Session,
        brdfs: &[Chosen],
        maps: &[String],
        shapes: &[String],
        integrators: Vec<Chosen>,
        limits: Limits,
    ) -> Self {
        let mut cases: Vec<Case> = Vec::new();
        for brdf in brdfs {
            for map in maps {
                for shape in shapes {
                    let mut scene = Session { brdf: brdf.clone(), ..scene.clone() };
                    if scene.environment.map != *map {
                        scene.environment.set_map(map.clone());
                        scene.environment.width = None;
                    }
                    scene.shape.clone_from(shape);
                    let on = if shapes.len() > 1 { format!(" on {shape}") } else { String::new() };
                    let name = format!("{} under {map}{on}", brdf.name());
                    cases.push(Case { name, about: String::new(), scene });
                }
            }
        }
        Self { cases, integrators, limits }
    }

    /// Refuses a plan that measures nothing, or whose cells could not be told apart.
    pub fn check(&self) -> Result<()> {
        if self.cases.is_empty() || self.integrators.is_empty() {
            return Err(Problem::new(
                "the plan",
                "it has no cells",
                "name a BRDF and an integrator",
            ));
        }
        for (index, case) in self.cases.iter().enumerate() {
            if self.cases.iter().take(index).any(|other| other.name == case.name) {
                return Err(Problem::new(
                    &case.name,
                    "two cases are called so",
                    "name each BRDF, map and shape once",
                ));
            }
        }
        let id = |chosen: &Chosen| chosen.configured.plugin.id.clone();
        for (index, integrator) in self.integrators.iter().enumerate() {
            if self.integrators.iter().take(index).any(|other| id(other) == id(integrator)) {
                return Err(Problem::new(
                    id(integrator),
                    "this integrator is named twice",
                    "name each once",
                ));
            }
        }
        Ok(())
    }
}
