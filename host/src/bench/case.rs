//! A scene without its integrator, opened: what every integrator of a row of cells sees.

use brdf_sdk::{Problem, Result};

use crate::environment::Environment;
use crate::open::Scene;
use crate::registry::Registry;
use crate::render::{Film, Stage};
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
        let brdf = &self.scene.brdf.configured;
        let changed: Vec<String> =
            brdf.changed().map(|(key, value)| format!("{key} {}", value.to_toml())).collect();
        match changed.is_empty() {
            true => brdf.plugin.id.clone(),
            false => format!("{} ({})", brdf.plugin.id, changed.join(", ")),
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

/// Mean radiance of a film's rows, as pictures hold it.
pub(super) fn radiance(film: &Film) -> Vec<[f32; 3]> {
    film.means().map(|rgb| rgb.map(|channel| channel as f32)).collect()
}

/// A case, opened.
pub(super) struct Opened {
    pub(super) case: Case,
    scene: Scene,
    /// What is worth telling of it.
    pub(super) notes: Vec<String>,
}

impl Opened {
    /// Opens what the scene names.
    ///
    /// # Errors
    /// Where a file cannot be read, or nothing is covered.
    pub(super) fn new(registry: &Registry, case: &Case) -> Result<Self> {
        let scene = Scene::open(registry, &case.scene)?;
        if scene.coverage.points.is_empty() {
            return Err(Problem::new(
                &case.name,
                "its object covers no pixel",
                "look at the scene's camera and shape",
            ));
        }
        Ok(Self { case: case.clone(), notes: scene.environment.notes.clone(), scene })
    }

    /// What its object covers.
    pub(super) fn points(&self) -> &[ShadingPoint] {
        &self.scene.coverage.points
    }

    /// A stage of it, with nothing on a device yet.
    pub(super) fn stage(&self) -> Stage {
        self.scene.stage()
    }

    /// Texels of its map times its pixels: what a sum over the map visits.
    pub(super) fn texels(&self) -> u64 {
        let Environment { width, height, .. } = *self.scene.environment.as_ref();
        u64::from(width) * u64::from(height) * self.points().len() as u64
    }

    /// Values of its points where they lie in the picture, row by row from the top; `nothing` elsewhere.
    pub(super) fn in_picture<T: Copy>(
        &self,
        values: impl IntoIterator<Item = T>,
        nothing: T,
    ) -> Vec<T> {
        let [width, height] = self.case.scene.film.resolution;
        let mut picture = vec![nothing; width as usize * height as usize];
        for (point, value) in std::iter::zip(self.points(), values) {
            picture[point.pixel as usize] = value;
        }
        picture
    }

    /// All that a picture of it depends on beside its program and its numbers, in pieces.
    pub(super) fn feed(&self, mut take: impl FnMut(&[u8])) {
        let Environment { width, height, layout, texels, .. } = self.scene.environment.as_ref();
        let (turned, lighting) = (self.scene.world_from_map, self.case.scene.environment.lighting);
        take(format!("{width} {height} {layout:?} {turned:?} {lighting:?}").as_bytes());
        take(bytemuck::cast_slice(texels.as_slice()));
        // The order in which pixels are worked on is no part of it.
        let mut points: Vec<&ShadingPoint> = self.points().iter().collect();
        points.sort_unstable_by_key(|point| point.pixel);
        for ShadingPoint { pixel, wo, tangent, normal } in points {
            take(&pixel.to_le_bytes());
            take(bytemuck::cast_slice(&[*wo, *tangent, *normal]));
        }
    }
}
