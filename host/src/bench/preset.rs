//! Plans with a name, made of what the program itself ships.

use std::path::{Path, PathBuf};

use brdf_sdk::{Kind, Problem, Result};
use serde::Deserialize;

use super::{Case, Limits, Plan, Row, cache, samplers, scenes};
use crate::layout::Layout;
use crate::picture;
use crate::registry::{Registry, embedded_below};
use crate::session::{Chosen, Session};

/// Plans with a name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Preset {
    /// Two BRDFs under two maps, small: what CI has time for
    Quick,
    /// Phong, Ward and GGX by 15 x 5 and 100 x 300 samples, and by sums over cubes of 128, 256 and 512
    Seed,
    /// Scenes that are hard for one integrator or another
    Hard,
}

/// A preset as its file says it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Told {
    /// Time of a cell [s].
    time: f64,
    resolution: [u32; 2],
    /// The BRDFs of every block.
    brdf: Vec<ToldBrdf>,
    block: Vec<ToldBlock>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct ToldBrdf {
    name: String,
    plugin: String,
    #[serde(default)]
    set: Vec<String>,
}

/// A part of the matrix: each BRDF under each map by these integrators.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct ToldBlock {
    /// What its cases are called beside BRDF and map.
    #[serde(default)]
    words: String,
    /// What they are about.
    #[serde(default)]
    about: String,
    maps: Vec<String>,
    /// Width of the maps in texels.
    width: Option<u32>,
    /// Side of a cube's faces in texels, where the maps become cubes.
    face: Option<u32>,
    integrators: Vec<String>,
    /// Parameters of all of them.
    #[serde(default)]
    iset: Vec<String>,
    /// Samples of a pixel.
    samples: Option<u64>,
}

impl Preset {
    /// The plan.
    ///
    /// # Errors
    /// Where a plugin that it names is not there, a user's own of that name has other parameters, or the folder for
    /// caches cannot be written.
    pub fn plan(self, registry: &Registry) -> Result<Plan> {
        match self {
            Self::Quick => told(registry, include_str!("presets/quick.toml")),
            Self::Seed => told(registry, include_str!("presets/seed.toml")),
            Self::Hard => hard(registry),
        }
    }
}

fn told(registry: &Registry, text: &str) -> Result<Plan> {
    let told: Told = toml::from_str(text).map_err(|error| {
        Problem::new("the preset", error.to_string().replace('\n', " "), "report this")
    })?;
    let mut rows = Vec::new();
    for block in &told.block {
        let find = |id: &String| configured(registry, Kind::Integrator, id, &block.iset);
        let integrators = block.integrators.iter().map(find).collect::<Result<Vec<_>>>()?;
        for brdf in &told.brdf {
            for map in &block.maps {
                let mut scene = Session::new(registry)?;
                scene.brdf = configured(registry, Kind::Brdf, &brdf.plugin, &brdf.set)?;
                let light = &mut scene.environment;
                light.set_map(map.clone());
                light.width = block.width;
                (light.face, light.layout) = (block.face, block.face.map(|_| Layout::Cube));
                scene.film.resolution = told.resolution;
                let words = match block.words.is_empty() {
                    true => String::new(),
                    false => format!(", {}", block.words),
                };
                let name = format!("{} under {map}{words}", brdf.name);
                let case = Case { name, about: block.about.clone(), scene };
                let samples = block.samples;
                rows.push(Row { samples, ..Row::new(case, integrators.clone()) });
            }
        }
    }
    let limits = Limits { time: told.time, ..Limits::default() };
    Ok(Plan { rows, limits })
}

/// A plugin with some parameters set.
fn configured(registry: &Registry, kind: Kind, id: &str, set: &[String]) -> Result<Chosen> {
    let mut chosen = Chosen::find(registry, kind, id)?;
    let configured = &mut chosen.configured;
    for assignment in set {
        configured.values.set_text(&configured.plugin.manifest, assignment)?;
    }
    Ok(chosen)
}

/// The scenes that the program ships, written where whoever wants may look at them: they name files beside them.
fn hard(registry: &Registry) -> Result<Plan> {
    let folder = cache().unwrap_or_else(std::env::temp_dir).join("scenes").join("hard");
    let mut folders: Vec<PathBuf> = Vec::new();
    for (name, text) in embedded_below("examples/hard") {
        let path = folder.join(name);
        let within = path.parent().unwrap_or(Path::new("."));
        if std::fs::read(&path).ok().as_deref() != Some(text.as_bytes()) {
            const CURE: &str =
                "make the folder for caches writable, or name another one in XDG_CACHE_HOME";
            picture::make_folder(within, CURE)?;
            picture::write_text(&path, text)?;
        }
        folders.push(within.to_owned());
    }
    folders.dedup();
    let cases = scenes(registry, &folders)?;
    let integrators = cases.first().map(|case| samplers(registry, &case.scene));
    let integrators = integrators.unwrap_or_default();
    let rows = cases.into_iter().map(|case| Row::new(case, integrators.clone())).collect();
    Ok(Plan { rows, limits: Limits { time: 0.5, ..Limits::default() } })
}
