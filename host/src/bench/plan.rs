//! What is measured, and how long.

use std::sync::Arc;

use brdf_sdk::{Kind, Problem, Result};
use glam::DMat3;
use serde::{Deserialize, Serialize};

use super::Case;
use crate::environment::Environment;
use crate::link::{View, link};
use crate::registry::Registry;
use crate::render::{Effort, Stage};
use crate::session::{Chosen, Session};

/// How far each cell is taken.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default)]
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
    /// Independent scrambles whose spread is the film's own estimate of its error; at least 2.
    pub replicates: u32,
}

impl Default for Limits {
    fn default() -> Self {
        // As every rendering has them.
        let Effort { seed, replicates, .. } = Effort::new(1, 1);
        Self { time: 1.0, samples: 1 << 20, repeats: 3, target: 1e-3, seed, replicates }
    }
}

impl Limits {
    /// The same for a row that has a bound of its own.
    pub(super) fn of_row(&self, row: &Row) -> Self {
        Self { samples: row.samples.unwrap_or(self.samples).min(self.samples), ..*self }
    }
}

/// Rows of cells, and limits.
#[derive(Debug, Clone)]
pub struct Plan {
    /// The rows.
    pub rows: Vec<Row>,
    /// How far each cell is taken.
    pub limits: Limits,
}

/// A scene, and who renders it: a cell for each integrator.
#[derive(Debug, Clone)]
pub struct Row {
    /// The scene.
    pub case: Case,
    /// The integrators.
    pub integrators: Vec<Chosen>,
    /// Samples of a pixel at the most, where it has a bound of its own.
    pub samples: Option<u64>,
}

impl Row {
    /// A row without a bound of its own.
    pub fn new(case: Case, integrators: Vec<Chosen>) -> Self {
        Self { case, integrators, samples: None }
    }
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

impl Plan {
    /// Every BRDF under every map on every shape, each otherwise as `scene`.
    pub fn matrix(
        scene: &Session,
        brdfs: &[Chosen],
        maps: &[String],
        shapes: &[String],
        integrators: &[Chosen],
        limits: Limits,
    ) -> Self {
        let mut rows = Vec::new();
        for brdf in brdfs {
            for map in maps {
                for shape in shapes {
                    let mut scene = Session { brdf: brdf.clone(), ..scene.clone() };
                    if scene.environment.map != *map {
                        scene.environment.set_map(map.clone());
                    }
                    scene.shape.clone_from(shape);
                    let on = if shapes.len() > 1 { format!(" on {shape}") } else { String::new() };
                    let name = format!("{} under {map}{on}", brdf.name());
                    let case = Case { name, about: String::new(), scene };
                    rows.push(Row::new(case, integrators.to_vec()));
                }
            }
        }
        Self { rows, limits }
    }

    /// Refuses a plan that measures nothing, or whose cells could not be told apart.
    pub fn check(&self) -> Result<()> {
        if self.rows.is_empty() || self.rows.iter().any(|row| row.integrators.is_empty()) {
            return Err(Problem::new(
                "the plan",
                "it has no cells",
                "name a BRDF and an integrator",
            ));
        }
        for (index, Row { case, integrators, .. }) in self.rows.iter().enumerate() {
            if self.rows.iter().take(index).any(|other| other.case.name == case.name) {
                return Err(Problem::new(
                    &case.name,
                    "two cases are called so",
                    "name each BRDF, map and shape once",
                ));
            }
            let id = |chosen: &Chosen| chosen.configured.plugin.id.clone();
            for (index, integrator) in integrators.iter().enumerate() {
                if integrators.iter().take(index).any(|other| id(other) == id(integrator)) {
                    return Err(Problem::new(
                        id(integrator),
                        "this integrator is named twice",
                        "name each once",
                    ));
                }
            }
        }
        Ok(())
    }
}
