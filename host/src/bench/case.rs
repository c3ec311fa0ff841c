//! A scene without its integrator, opened: what every integrator of a row of cells sees.

use std::sync::Arc;

use brdf_sdk::{ParamValues, Problem, Result};
use glam::DMat3;

use crate::environment::{Environment, orientation};
use crate::open;
use crate::plugin::Configured;
use crate::registry::Registry;
use crate::render::Stage;
use crate::scene::ShadingPoint;
use crate::session::Session;

/// A scene that is measured, under a name; whatever integrator it has is passed over.
#[derive(Debug, Clone)]
pub struct Case {
    /// What it is called in reports; no other case of a plan is called so.
    pub name: String,
    /// What it is about; nothing where nobody says.
    pub about: String,
    /// The scene.
    pub scene: Session,
}

impl Case {
    /// The BRDF in words: its name, with what differs from its defaults.
    pub(super) fn brdf_words(&self) -> String {
        let Configured { plugin, values } = &self.scene.brdf.configured;
        let usual = ParamValues::defaults(&plugin.manifest);
        let changed = values.iter().filter(|(key, value)| usual.get(key) != Some(value));
        let changed: Vec<String> =
            changed.map(|(key, value)| format!("{key} {}", value.to_toml())).collect();
        match changed.is_empty() {
            true => plugin.id.clone(),
            false => format!("{} ({})", plugin.id, changed.join(", ")),
        }
    }

    /// The map's name, and the shape's where it is no sphere.
    pub(super) fn map_words(&self) -> String {
        let name = |path: &str| {
            let name = std::path::Path::new(path).file_name();
            name.map_or(path.to_owned(), |name| name.to_string_lossy().into_owned())
        };
        let map = name(&self.scene.environment.map);
        match self.scene.shape.as_str() {
            "sphere" => map,
            shape => format!("{map}, {}", name(shape)),
        }
    }
}

/// A case with its map and its shading points.
pub(super) struct Opened {
    pub(super) case: Case,
    pub(super) points: Vec<ShadingPoint>,
    environment: Arc<Environment>,
    world_from_map: DMat3,
    /// What is worth telling of it.
    pub(super) notes: Vec<String>,
}

impl Opened {
    /// Opens what the scene names.
    ///
    /// # Errors
    /// Where a file cannot be read, or nothing is covered.
    pub(super) fn new(registry: &Registry, case: &Case) -> Result<Self> {
        let light = &case.scene.environment;
        let environment = Arc::new(open::environment(registry, light)?);
        let shape = open::shape(&case.scene.shape)?;
        let points = open::shading_points(&case.scene, &shape)?.points;
        if points.is_empty() {
            return Err(Problem::new(
                &case.name,
                "its object covers no pixel",
                "look at the scene's camera and shape",
            ));
        }
        Ok(Self {
            case: case.clone(),
            points,
            notes: environment.notes.clone(),
            world_from_map: orientation::world_from_map(light.phi, light.theta),
            environment,
        })
    }

    /// A stage of it, with nothing on a device yet.
    pub(super) fn stage(&self) -> Stage {
        let lighting = self.case.scene.environment.lighting;
        Stage::new(self.points.clone(), Arc::clone(&self.environment), self.world_from_map)
            .lit(lighting)
    }

    /// Texels of its map times its pixels: what a sum over the map visits.
    pub(super) fn texels(&self) -> u64 {
        let Environment { width, height, .. } = *self.environment.as_ref();
        u64::from(width) * u64::from(height) * self.points.len() as u64
    }

    /// Bytes of all that a picture of it depends on beside its program and its numbers.
    pub(super) fn feed(&self, mut take: impl FnMut(&[u8])) {
        let Environment { width, height, layout, texels, .. } = self.environment.as_ref();
        take(format!("{width} {height} {layout:?}").as_bytes());
        texels.iter().for_each(|texel| texel.iter().for_each(|c| take(&c.to_le_bytes())));
        take(
            format!("{:?} {:?}", self.world_from_map, self.case.scene.environment.lighting)
                .as_bytes(),
        );
        for point in &self.points {
            take(&point.pixel.to_le_bytes());
            let numbers = point.wo.iter().chain(&point.tangent).chain(&point.normal);
            numbers.for_each(|number| take(&number.to_le_bytes()));
        }
    }
}
