//! Draws of an environment on a device, and their density on the cores in f64.

use std::sync::Arc;

use brdf_sdk::Result;
use glam::DMat3;

use crate::environment::{Environment, Purpose};
use crate::exec::cpu::Cpu;
use crate::exec::{Executor, KernelId, Precision, Readout};
use crate::link::{BindingKind, Program, Sampler, View, link};
use crate::render::{Lighting, Stage};

/// Rows of one dispatch.
pub const CHUNK: usize = 1 << 18;

/// Draws.
pub struct Draws(Kernel);

impl Draws {
    /// Links and compiles the program.
    pub fn new(
        executor: &mut dyn Executor,
        map: &Arc<Environment>,
        world_from_map: DMat3,
        purpose: Purpose,
    ) -> Result<Self> {
        let stage = stage(map, world_from_map, purpose);
        let form = stage.form(Sampler::Independent);
        let view = View::LightDraws { form, compensated: purpose.compensated };
        Ok(Self(Kernel::new(executor, stage, &view)?))
    }

    /// Direction (world frame) and density of draws `first` and following.
    pub fn draw(
        &mut self,
        executor: &mut dyn Executor,
        seed: u32,
        first: usize,
        count: usize,
    ) -> Result<Vec<([f64; 3], f64)>> {
        let Self(kernel) = self;
        let batch = kernel.program.required_layout("batch");
        let mut bytes = vec![0; batch.stride];
        batch.write(&mut bytes, 0, "seed", &[seed]);
        batch.write(&mut bytes, 0, "first", &[first as u32]);
        let layout = kernel.program.required_layout("draws");
        let (dir, pdf) = (layout.at("dir"), layout.at("pdf"));
        let rows = vec![0; layout.stride * count];
        let inputs = [("batch", BindingKind::Uniform, bytes)];
        let read = kernel.run(executor, &inputs, ("draws", rows), count)?;
        let row = |row: usize| {
            let at = row * layout.stride;
            let three = [0, 4, 8].map(|offset| read.float(at + dir + offset));
            (three, read.float(at + pdf))
        };
        Ok((0..count).map(row).collect())
    }

    /// Frees what it holds on the device.
    pub fn free(self, executor: &mut dyn Executor) {
        self.0.free(executor);
    }
}

/// Their density.
pub struct Densities {
    cpu: Cpu,
    kernel: Kernel,
    world_from_map: DMat3,
}

impl Densities {
    /// Links and compiles the program.
    pub fn new(map: &Arc<Environment>, world_from_map: DMat3, purpose: Purpose) -> Result<Self> {
        let mut cpu = Cpu::new(Precision::F64);
        let stage = stage(map, world_from_map, purpose);
        let form = stage.form(Sampler::Independent);
        let view = View::LightDensities { form, compensated: purpose.compensated };
        let kernel = Kernel::new(&mut cpu, stage, &view)?;
        Ok(Self { cpu, kernel, world_from_map })
    }

    /// The density [1/sr] at places in texels of the map.
    pub fn at(&mut self, map: &Environment, places: &[((u32, u32), [f64; 2])]) -> Result<Vec<f64>> {
        let layout = self.kernel.program.required_layout("densities");
        let pdf = layout.at("pdf");
        let mut found = Vec::with_capacity(places.len());
        for part in places.chunks(CHUNK) {
            let mut bytes = vec![0; layout.stride * part.len()];
            for (row, (texel, at)) in part.iter().enumerate() {
                let dir = self.world_from_map * map.direction_at(*texel, *at).normalize();
                let dir = dir.as_vec3().to_array();
                layout.write(&mut bytes, row * layout.stride, "dir", &dir);
            }
            let rows = ("densities", bytes);
            let read = self.kernel.run(&mut self.cpu, &[], rows, part.len())?;
            found.extend((0..part.len()).map(|row| read.float(row * layout.stride + pdf)));
        }
        Ok(found)
    }
}

fn stage(map: &Arc<Environment>, world_from_map: DMat3, purpose: Purpose) -> Stage {
    let lighting = Lighting { filter: purpose.filter, weighting: purpose.weighting };
    Stage::new(Vec::new(), Arc::clone(map), world_from_map).lit(lighting)
}

/// A program on a device, and the map there.
struct Kernel {
    program: Arc<Program>,
    kernel: KernelId,
    stage: Stage,
}

impl Kernel {
    fn new(executor: &mut dyn Executor, mut stage: Stage, view: &View) -> Result<Self> {
        let program = Arc::new(link(view)?);
        stage.provide(executor, &program)?;
        let kernel = executor.compile(Arc::clone(&program))?;
        Ok(Self { program, kernel, stage })
    }

    /// Runs over the rows of a variable and reads them back.
    fn run(
        &self,
        executor: &mut dyn Executor,
        inputs: &[(&'static str, BindingKind, Vec<u8>)],
        (name, rows): (&'static str, Vec<u8>),
        count: usize,
    ) -> Result<Readout> {
        let size = rows.len();
        let results = executor.buffer(BindingKind::ReadWrite, size)?;
        let mut owned = vec![(name, results)];
        let run = || {
            executor.write(results, rows)?;
            for (name, kind, bytes) in inputs {
                let buffer = executor.buffer(*kind, bytes.len())?;
                owned.push((name, buffer));
                executor.write(buffer, bytes.clone())?;
            }
            let bound = [self.stage.bound(0), owned.clone()].concat();
            executor.dispatch(self.kernel, &bound, count as u32)?;
            executor.read(results, size)
        };
        let read = run();
        for (_, id) in owned {
            executor.free(id);
        }
        read
    }

    fn free(mut self, executor: &mut dyn Executor) {
        self.stage.unload(executor);
        executor.forget(self.kernel);
    }
}
