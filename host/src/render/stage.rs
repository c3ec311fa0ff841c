//! What a program looks at, on the device: shading points and environment, uploaded once and only
//! if the program reaches them.

use std::sync::Arc;

use brdf_sdk::Result;
use glam::DMat3;

use crate::environment::Environment;
use crate::exec::{Bound, Executor, ResourceId};
use crate::link::{BindingKind, Program};
use crate::scene::ShadingPoint;

/// Rows of one hit buffer: 48 MiB, below every device's binding limit.
pub const CHUNK_ROWS: usize = 1 << 20;

/// The scene as programs see it.
pub struct Stage {
    points: Vec<ShadingPoint>,
    environment: Arc<Environment>,
    world_from_map: DMat3,
    uploaded: Uploaded,
}

#[derive(Default)]
struct Uploaded {
    environment: Option<ResourceId>,
    env_map: Option<ResourceId>,
    hits: Vec<ResourceId>,
}

impl Stage {
    /// A stage with nothing uploaded yet. `world_from_map` turns the environment.
    pub fn new(
        points: Vec<ShadingPoint>,
        environment: Arc<Environment>,
        world_from_map: DMat3,
    ) -> Self {
        Self { points, environment, world_from_map, uploaded: Uploaded::default() }
    }

    /// The shading points, the rows of the hit list.
    pub fn points(&self) -> &[ShadingPoint] {
        &self.points
    }

    /// The same scene with at most `count` of the points, spread over all of them; nothing uploaded.
    pub(super) fn thinned(&self, count: usize) -> Self {
        let step = self.points.len().div_ceil(count).max(1);
        let points = self.points.iter().step_by(step).copied().collect();
        Self::new(points, Arc::clone(&self.environment), self.world_from_map)
    }

    /// Uploads what `program` reaches and is not on the device yet.
    pub fn provide(&mut self, executor: &mut dyn Executor, program: &Program) -> Result<()> {
        if program.binds("environment") && self.uploaded.environment.is_none() {
            let layout = program.required_layout("environment");
            let mut bytes = vec![0; layout.stride];
            // A matrix is three columns of three, each padded to four words.
            let map_from_world = self.world_from_map.transpose();
            let columns: Vec<f32> = (0..3)
                .flat_map(|i| map_from_world.col(i).extend(0.0).to_array().map(|c| c as f32))
                .collect();
            layout.write(&mut bytes, 0, "map_from_world", &columns);
            layout.write(&mut bytes, 0, "size", &[self.environment.width, self.environment.height]);
            let buffer = executor.buffer(BindingKind::Uniform, bytes.len())?;
            executor.write(buffer, bytes)?;
            self.uploaded.environment = Some(buffer);
        }
        if program.binds("env_map") && self.uploaded.env_map.is_none() {
            let size = [self.environment.width, self.environment.height];
            self.uploaded.env_map =
                Some(executor.texture(size, Arc::clone(&self.environment.texels))?);
        }
        if program.binds("hits") && self.uploaded.hits.is_empty() {
            let layout = program.required_layout("hits");
            let mut hits = Vec::new();
            let done = self.points.chunks(CHUNK_ROWS).try_for_each(|chunk| {
                let mut bytes = vec![0; layout.stride * chunk.len()];
                for (row, point) in chunk.iter().enumerate() {
                    let base = row * layout.stride;
                    layout.write(&mut bytes, base, "pixel", &[point.pixel]);
                    layout.write(&mut bytes, base, "wo", &point.wo);
                    layout.write(&mut bytes, base, "tangent", &point.tangent);
                    layout.write(&mut bytes, base, "normal", &point.normal);
                }
                let buffer = executor.buffer(BindingKind::Read, bytes.len())?;
                hits.push(buffer);
                executor.write(buffer, bytes)
            });
            if let Err(problem) = done {
                // All chunks or none: a part would be taken for the whole the next time.
                hits.into_iter().for_each(|id| executor.free(id));
                return Err(problem);
            }
            self.uploaded.hits = hits;
        }
        Ok(())
    }

    /// What is bound for one chunk of the hit list.
    pub fn bound(&self, chunk: usize) -> Vec<Bound<'static>> {
        let uploaded = &self.uploaded;
        let named = [
            ("environment", uploaded.environment),
            ("env_map", uploaded.env_map),
            ("hits", uploaded.hits.get(chunk).copied()),
        ];
        named.into_iter().filter_map(|(name, id)| Some((name, id?))).collect()
    }

    /// Takes note that the device is gone, and with it all that was uploaded.
    pub fn forget(&mut self) {
        self.uploaded = Uploaded::default();
    }

    /// Frees what was uploaded.
    pub fn unload(&mut self, executor: &mut dyn Executor) {
        let uploaded = std::mem::take(&mut self.uploaded);
        for id in uploaded.environment.into_iter().chain(uploaded.env_map).chain(uploaded.hits) {
            executor.free(id);
        }
    }
}
