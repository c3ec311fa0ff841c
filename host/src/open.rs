//! Opens scenes and what they name: the environment's map, the shape, the shading points, and a stage of them. Nothing is
//! rendered here, and nothing is known of devices but how much memory there is.

use std::path::Path;
use std::sync::Arc;

use brdf_sdk::table::suggestion;
use brdf_sdk::{Problem, Result};
use glam::DMat3;

use crate::environment::{self, Environment, Options, orientation};
use crate::exec::memory;
use crate::file;
use crate::picture;
use crate::registry::Registry;
use crate::render::{Lighting, Stage};
use crate::scene::{Coverage, Mesh, Shape, cast};
use crate::session::{Light, Session};

/// Bytes of host memory that one pixel takes at the most: hit row, film, picture, and their copies.
const BYTES_PER_PIXEL: u64 = 320;

/// The scene of a scene.toml, or in the header of a picture that this program wrote.
pub fn session(registry: &Registry, path: &Path) -> Result<Session> {
    let shown = path.display().to_string();
    let folder = path.parent().unwrap_or(Path::new(""));
    let ends_in = |ending| path.extension().is_some_and(|own| own.eq_ignore_ascii_case(ending));
    if ends_in("png") {
        let cure =
            format!("name the picture's {}, which does", path.with_extension("exr").display());
        return Err(Problem::new(shown, "a PNG holds no scene", cure));
    }
    if ends_in("exr") {
        let scene = picture::read_scene(path)?;
        return Session::parse(registry, &format!("{shown} (header)"), &scene, folder);
    }
    let source = file::read_text(path, "name a scene.toml or a picture of this program")?;
    Session::parse(registry, &shown, &source, folder)
}

/// What every rendering of a scene sees, whatever its plugins are.
pub struct Scene {
    /// The map.
    pub environment: Arc<Environment>,
    /// The object.
    pub shape: Shape,
    /// Where the object is seen.
    pub coverage: Coverage,
    /// How the map is turned.
    pub world_from_map: DMat3,
    lighting: Lighting,
}

impl Scene {
    /// Opens what a scene names.
    ///
    /// # Errors
    /// Where a file cannot be read, or the picture would not fit the memory.
    pub fn open(registry: &Registry, session: &Session) -> Result<Self> {
        let light = &session.environment;
        let environment = Arc::new(environment(registry, light)?);
        let shape = shape(&session.shape)?;
        let coverage = shading_points(session, &shape)?;
        let world_from_map = orientation::world_from_map(light.phi, light.theta);
        Ok(Self { environment, shape, coverage, world_from_map, lighting: light.lighting })
    }

    /// A stage of it, with nothing on a device yet.
    pub fn stage(&self) -> Stage {
        let (points, map) = (self.coverage.points.clone(), Arc::clone(&self.environment));
        Stage::new(points, map, self.world_from_map).lit(self.lighting)
    }
}

/// Loads a map from a file, or makes a recipe's.
pub fn environment(registry: &Registry, light: &Light) -> Result<Environment> {
    let options = Options {
        width: light.width,
        replace_bad: light.replace_bad_texels,
        arrangement: light.arrangement,
        layout: light.layout,
        face: light.face,
    };
    let path = Path::new(&light.map);
    if !path.exists() {
        if let Some(recipe) = registry.recipe(&light.map) {
            let (file, source) = recipe?;
            return environment::from_recipe(&light.map, &file, &source, &options);
        }
        if path.extension().is_none() {
            let recipes = registry.recipes();
            return Err(Problem::new(
                &light.map,
                "there is no file and no recipe of this name",
                suggestion(&light.map, recipes.iter().map(|(id, _)| id.as_str())),
            ));
        }
    }
    environment::load(path, &options)
}

/// The shape of that name, or the mesh in that file.
pub fn shape(name: &str) -> Result<Shape> {
    if let Some(shape) = Shape::named(name)? {
        return Ok(shape);
    }
    if Path::new(name).extension().is_none() && !Path::new(name).exists() {
        return Err(Problem::new(
            name,
            "there is no such shape",
            format!("name {}, or an .obj, .gltf or .glb file", Shape::NAMES.join(", ")),
        ));
    }
    Ok(Shape::Mesh(Arc::new(Mesh::load(name)?)))
}

/// What is worth telling of a shape.
pub fn shape_note(name: &str, shape: &Shape) -> Option<String> {
    let Shape::Mesh(mesh) = shape else { return None };
    let dropped = match mesh.degenerate() {
        0 => String::new(),
        n => format!("; {n} more have no area and were dropped"),
    };
    Some(format!("{name} has {} triangles{dropped}", mesh.triangles()))
}

/// Casts a ray through the centre of every pixel; refuses pictures that would not fit the memory.
pub fn shading_points(session: &Session, shape: &Shape) -> Result<Coverage> {
    let [width, height] = session.film.resolution;
    let pixels = u64::from(width) * u64::from(height);
    let needed = pixels.saturating_mul(BYTES_PER_PIXEL);
    if pixels > u64::from(u32::MAX) || needed > memory::budget() {
        return Err(Problem::new(
            format!("--resolution {width}x{height}"),
            format!(
                "this needs about {} and {} may be used",
                memory::shown(needed),
                memory::shown(memory::budget())
            ),
            "lower the resolution",
        ));
    }
    Ok(cast(&session.camera, shape, session.film.resolution))
}
