//! What is seen past the object: the environment along the rays that miss it.

use std::sync::Arc;

use brdf_sdk::Result;

use super::Stage;
use crate::exec::{Executor, KernelId};
use crate::link::{self, BindingKind, Program, View};

/// Radiance of the environment along world directions, looked up by the same shader as the estimators'.
pub fn background(
    executor: &mut dyn Executor,
    stage: &mut Stage,
    directions: &[[f32; 3]],
) -> Result<Vec<[f32; 3]>> {
    let backdrop = Backdrop::new(executor, stage)?;
    let radiances = backdrop.radiance(executor, stage, directions);
    backdrop.free(executor);
    radiances
}

/// The program that looks the environment up, compiled.
pub struct Backdrop {
    program: Arc<Program>,
    kernel: KernelId,
}

impl Backdrop {
    /// Links and compiles it for the layout and the filter of a stage's map.
    pub fn new(executor: &mut dyn Executor, stage: &Stage) -> Result<Self> {
        let form = stage.form(link::Sampler::OwenSobol);
        let program = Arc::new(link::link(&View::Background { form })?);
        let kernel = executor.compile(Arc::clone(&program))?;
        Ok(Self { program, kernel })
    }

    /// Radiance along world directions.
    pub fn radiance(
        &self,
        executor: &mut dyn Executor,
        stage: &mut Stage,
        directions: &[[f32; 3]],
    ) -> Result<Vec<[f32; 3]>> {
        let (program, kernel) = (&self.program, self.kernel);
        stage.provide(executor, program)?;
        let layout = program.required_layout("rays");
        let radiance = layout.at("radiance");
        let most = (executor.limits().buffer_bytes as usize / layout.stride).min(super::CHUNK_ROWS);
        let mut radiances = Vec::with_capacity(directions.len());
        for chunk in directions.chunks(most) {
            let mut bytes = vec![0; layout.stride * chunk.len()];
            for (index, direction) in chunk.iter().enumerate() {
                layout.write(&mut bytes, index * layout.stride, "direction", direction);
            }
            let size = bytes.len();
            let rays = executor.buffer(BindingKind::ReadWrite, size)?;
            let read = executor.write(rays, bytes).and_then(|()| {
                let mut bound = stage.bound(0);
                bound.push(("rays", rays));
                executor.dispatch(kernel, &bound, chunk.len() as u32)?;
                executor.read(rays, size)
            });
            executor.free(rays);
            let read = read?;
            let rows = (0..chunk.len()).map(|row| row * layout.stride + radiance);
            radiances
                .extend(rows.map(|at| [0, 4, 8].map(|channel| read.float(at + channel) as f32)));
        }
        Ok(radiances)
    }

    /// Frees the kernel.
    pub fn free(self, executor: &mut dyn Executor) {
        executor.forget(self.kernel);
    }
}
