//! What a program looks at, on the device: shading points and environment, uploaded once and only
//! if the program reaches them.

use std::sync::Arc;

use brdf_sdk::Result;
use glam::DMat3;

use crate::environment::{Environment, Filter, Importance, Layout, Purpose, Weighting};
use crate::environment::{importance, order, scale, texture};
use crate::exec::{Bound, Executor, ResourceId};
use crate::link::{BindingKind, Form, Program, Sampler};
use crate::scene::ShadingPoint;

/// Rows of one hit buffer: 48 MiB, below every device's binding limit.
pub const CHUNK_ROWS: usize = 1 << 20;

/// How the environment's radiance is read and its importance weighed.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Lighting {
    /// How radiance is read between texel centres.
    pub filter: Filter,
    /// What the probability of a texel follows.
    pub weighting: Weighting,
}

/// The scene as programs see it.
pub struct Stage {
    points: Vec<ShadingPoint>,
    environment: Arc<Environment>,
    world_from_map: DMat3,
    lighting: Lighting,
    /// A power of two that brings the map's mean radiance near 1.
    scale: f32,
    uploaded: Uploaded,
}

#[derive(Default)]
struct Uploaded {
    environment: Option<ResourceId>,
    env_map: Option<ResourceId>,
    /// The tables whose densities `env_map` holds, and their two lists.
    tables: Option<(Purpose, [ResourceId; 2])>,
    guide_bits: [u32; 2],
    /// The order of the texels: whether by luminance, and how many.
    order: Option<(bool, ResourceId)>,
    terms: u32,
    hits: Vec<ResourceId>,
}

impl Stage {
    /// A stage with nothing uploaded yet. `world_from_map` turns the environment.
    pub fn new(
        points: Vec<ShadingPoint>,
        environment: Arc<Environment>,
        world_from_map: DMat3,
    ) -> Self {
        Self {
            points,
            scale: scale(&environment),
            environment,
            world_from_map,
            lighting: Lighting::default(),
            uploaded: Uploaded::default(),
        }
    }

    /// The same stage under other lighting, nothing uploaded.
    pub fn lit(self, lighting: Lighting) -> Self {
        Self { lighting, uploaded: Uploaded::default(), ..self }
    }

    /// Other shading points, under the same light.
    pub fn set_points(&mut self, executor: &mut dyn Executor, points: Vec<ShadingPoint>) {
        self.uploaded.hits.drain(..).for_each(|id| executor.free(id));
        self.points = points;
    }

    /// Turns the environment.
    pub fn turn(&mut self, executor: &mut dyn Executor, world_from_map: DMat3) {
        if self.world_from_map != world_from_map {
            self.drop_uniform(executor);
            self.world_from_map = world_from_map;
        }
    }

    /// What programs for this stage are linked for.
    pub fn form(&self, sampler: Sampler) -> Form {
        Form {
            cube: self.environment.layout == Layout::Cube,
            linear: self.lighting.filter == Filter::Linear,
            sampler,
        }
    }

    /// The shading points, the rows of the hit list.
    pub fn points(&self) -> &[ShadingPoint] {
        &self.points
    }

    /// A power of two that brings the map's mean radiance near 1.
    pub fn scale(&self) -> f32 {
        self.scale
    }

    /// Texels that a sum over the map visits; known once such a program was provided for.
    pub fn terms(&self) -> u32 {
        self.uploaded.terms
    }

    /// The same scene with at most `count` of the points, spread over all of them; nothing uploaded.
    pub(super) fn thinned(&self, count: usize) -> Self {
        let step = self.points.len().div_ceil(count).max(1);
        let points = self.points.iter().step_by(step).copied().collect();
        self.with(points, Arc::clone(&self.environment))
    }

    /// The same points under another map, turned alike.
    pub(super) fn under(&self, environment: Environment) -> Self {
        self.with(self.points.clone(), Arc::new(environment))
    }

    fn with(&self, points: Vec<ShadingPoint>, environment: Arc<Environment>) -> Self {
        Self::new(points, environment, self.world_from_map).lit(self.lighting)
    }

    /// The map.
    pub(super) fn environment(&self) -> &Environment {
        &self.environment
    }

    /// How the map is read.
    pub fn lighting(&self) -> Lighting {
        self.lighting
    }

    /// Uploads what `program` reaches and is not on the device yet.
    pub fn provide(&mut self, executor: &mut dyn Executor, program: &Program) -> Result<()> {
        self.provide_map(executor, program)?;
        if let Some(sum) = program.sum
            && self.uploaded.order.is_none_or(|(by_luminance, _)| by_luminance != sum.by_luminance)
        {
            if let Some((_, old)) = self.uploaded.order.take() {
                executor.free(old);
            }
            let order = order(&self.environment, self.lighting.filter, sum.by_luminance);
            self.uploaded.terms = order.len() as u32;
            // WGSL has no empty arrays.
            let words = if order.is_empty() { vec![0] } else { order };
            let buffer = upload(executor, &words)?;
            self.uploaded.order = Some((sum.by_luminance, buffer));
            self.drop_uniform(executor);
        }
        if program.binds("environment") && self.uploaded.environment.is_none() {
            self.provide_uniform(executor, program)?;
        }
        if program.binds("hits") && self.uploaded.hits.is_empty() {
            self.provide_hits(executor, program)?;
        }
        Ok(())
    }

    /// The map, with the densities of its texels where the program looks at them, and the tables.
    fn provide_map(&mut self, executor: &mut dyn Executor, program: &Program) -> Result<()> {
        if !program.binds("env_map") {
            return Ok(());
        }
        let purpose = program.reads_densities().then_some(Purpose {
            filter: self.lighting.filter,
            weighting: self.lighting.weighting,
            compensated: program.compensated,
        });
        let held = self.uploaded.tables.map(|(purpose, _)| purpose);
        if self.uploaded.env_map.is_some() && (purpose.is_none() || purpose == held) {
            return Ok(());
        }
        self.drop_map(executor);
        let tables = purpose.map(|purpose| (purpose, importance(&self.environment, purpose)));
        let densities = tables.as_ref().map(|(_, tables)| tables.densities.as_slice());
        let (size, texels) = texture(&self.environment, self.lighting.filter, densities);
        self.uploaded.env_map = Some(executor.texture(size, texels)?);
        if let Some((purpose, Importance { ends, guides, guide_bits, .. })) = tables {
            // A map of one texel has no ends; WGSL has no empty arrays.
            let ends = upload(executor, if ends.is_empty() { &[0] } else { &ends })?;
            let guides = upload(executor, &guides).inspect_err(|_| executor.free(ends))?;
            self.uploaded.tables = Some((purpose, [ends, guides]));
            self.uploaded.guide_bits = guide_bits;
        }
        Ok(())
    }

    fn provide_uniform(&mut self, executor: &mut dyn Executor, program: &Program) -> Result<()> {
        let layout = program.required_layout("environment");
        let mut bytes = vec![0; layout.stride];
        // A matrix is three columns of three, each padded to four words.
        let map_from_world = self.world_from_map.transpose();
        let columns: Vec<f32> = (0..3)
            .flat_map(|i| map_from_world.col(i).extend(0.0).to_array().map(|c| c as f32))
            .collect();
        layout.write(&mut bytes, 0, "map_from_world", &columns);
        layout.write(&mut bytes, 0, "size", &[self.environment.width, self.environment.height]);
        layout.write(&mut bytes, 0, "guide_bits", &self.uploaded.guide_bits);
        layout.write(&mut bytes, 0, "scale", &[self.scale]);
        layout.write(&mut bytes, 0, "terms", &[self.uploaded.terms]);
        let buffer = executor.buffer(BindingKind::Uniform, bytes.len())?;
        executor.write(buffer, bytes)?;
        self.uploaded.environment = Some(buffer);
        Ok(())
    }

    fn provide_hits(&mut self, executor: &mut dyn Executor, program: &Program) -> Result<()> {
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
        Ok(())
    }

    /// What is bound for one chunk of the hit list.
    pub fn bound(&self, chunk: usize) -> Vec<Bound<'static>> {
        let uploaded = &self.uploaded;
        let tables = uploaded.tables.map(|(_, tables)| tables);
        let named = [
            ("environment", uploaded.environment),
            ("env_map", uploaded.env_map),
            ("env_ends", tables.map(|[ends, _]| ends)),
            ("env_guides", tables.map(|[_, guides]| guides)),
            ("env_order", uploaded.order.map(|(_, order)| order)),
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
        self.drop_map(executor);
        let uploaded = std::mem::take(&mut self.uploaded);
        let order = uploaded.order.map(|(_, order)| order);
        for id in uploaded.hits.into_iter().chain(order) {
            executor.free(id);
        }
    }

    fn drop_uniform(&mut self, executor: &mut dyn Executor) {
        if let Some(id) = self.uploaded.environment.take() {
            executor.free(id);
        }
    }

    fn drop_map(&mut self, executor: &mut dyn Executor) {
        self.drop_uniform(executor);
        let tables = self.uploaded.tables.take().map(|(_, tables)| tables);
        for id in self.uploaded.env_map.take().into_iter().chain(tables.into_iter().flatten()) {
            executor.free(id);
        }
    }
}

/// A buffer of words that programs only read.
fn upload(executor: &mut dyn Executor, words: &[u32]) -> Result<ResourceId> {
    let buffer = executor.buffer(BindingKind::Read, words.len() * 4)?;
    match executor.write(buffer, bytemuck::cast_slice(words).to_vec()) {
        Ok(()) => Ok(buffer),
        Err(problem) => {
            executor.free(buffer);
            Err(problem)
        }
    }
}
