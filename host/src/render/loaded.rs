//! A program that renders, ready on a device: its kernel, its numbers, and sums for bands of rows.

use std::sync::Arc;
use std::time::Duration;

use brdf_sdk::{Kind, Problem, Result};

use super::rows::bring;
use super::{CHUNK_ROWS, Stage};
use crate::data::Brought;
use crate::exec::{Executor, KernelId, Readout, ResourceId, memory};
use crate::link::{BindingKind, Program, Sampling, StructLayout};
use crate::plugin::Configured;

/// Bytes of sums in one buffer: below every device's binding limit, and read in pieces that stay in reused memory. A
/// device that is not busy with so few rows gets more of them.
const BAND_BYTES: usize = 16 << 20;

/// Bytes of sums in one buffer on a device with many lanes: the least binding limit that WebGPU guarantees.
const WIDE_BAND_BYTES: usize = 128 << 20;

/// Rows whose sums lie in one buffer.
pub(super) struct Band {
    /// The chunk of the hit list that they stand in.
    chunk: usize,
    /// The first row in the chunk, and in the whole list.
    pub first_row: u32,
    pub first_point: usize,
    /// How many.
    pub rows: u32,
    sums: ResourceId,
    states: Option<ResourceId>,
}

/// A program on a device, compiled, with its buffers.
pub(super) struct Loaded {
    kernel: KernelId,
    owned: Vec<(String, ResourceId)>,
    /// What the BRDF brings along.
    brought: Vec<(Brought, ResourceId)>,
    work: ResourceId,
    work_layout: StructLayout,
    /// The layout of one sum.
    pub sum: StructLayout,
    /// Sums of each row.
    width: usize,
    pub bands: Vec<Band>,
    state_bytes: usize,
    /// The plugins' names, for messages.
    pub names: String,
}

impl Loaded {
    /// Compiles the program, the driver's own compiler included, and uploads what it reaches; `width`
    /// sums are held for each row.
    pub fn new(
        executor: &mut dyn Executor,
        stage: &mut Stage,
        program: &Arc<Program>,
        plugins: &[&Configured],
        width: usize,
    ) -> Result<Self> {
        let sum = program.required_layout("sums");
        let work_layout = program.required_layout("work");
        let state_bytes = program.layout("states").map_or(0, |layout| layout.stride);
        check_room(executor, stage, width * (sum.stride + state_bytes))?;
        stage.provide(executor, program)?;
        let kernel = executor.compile(Arc::clone(program))?;
        let names: Vec<_> = plugins.iter().map(|p| p.plugin.id.as_str()).collect();
        let mut loaded = Self {
            kernel,
            owned: Vec::new(),
            brought: Vec::new(),
            work: ResourceId(0),
            work_layout,
            sum,
            width,
            bands: Vec::new(),
            state_bytes,
            names: names.join(" with "),
        };
        let done = loaded
            .upload(executor, program, plugins)
            .and_then(|()| loaded.make_bands(executor, stage.points().len()))
            // An empty dispatch: the driver's own compiler runs now, and not in the first measured one.
            .and_then(|()| match loaded.bands.first() {
                Some(band) => {
                    loaded.dispatch(executor, stage, band, &[("row_count", 0)], 0).map(|_| ())
                }
                None => Ok(()),
            });
        if let Err(problem) = done {
            loaded.free(executor);
            return Err(problem);
        }
        Ok(loaded)
    }

    fn upload(
        &mut self,
        executor: &mut dyn Executor,
        program: &Program,
        plugins: &[&Configured],
    ) -> Result<()> {
        self.work = executor.buffer(BindingKind::Uniform, self.work_layout.stride)?;
        self.owned.push(("work".to_owned(), self.work));
        for configured in plugins {
            if let Some((name, bytes)) = program.parameter_bytes(configured) {
                let buffer = executor.buffer(BindingKind::Uniform, bytes.len())?;
                self.owned.push((name, buffer));
                executor.write(buffer, bytes)?;
            }
            if configured.plugin.manifest.kind == Kind::Brdf {
                bring(executor, program, configured, &mut self.brought)?;
            }
        }
        Ok(())
    }

    fn make_bands(&mut self, executor: &mut dyn Executor, points: usize) -> Result<()> {
        let limits = executor.limits();
        let bytes = if limits.parallel > 1 { WIDE_BAND_BYTES } else { BAND_BYTES };
        let most = bytes.min(limits.buffer_bytes as usize)
            / (self.width * self.sum.stride.max(self.state_bytes));
        let most = most.max(1);
        let mut first_point = 0;
        while first_point < points {
            let (chunk, first_row) = (first_point / CHUNK_ROWS, first_point % CHUNK_ROWS);
            let rows = most.min(CHUNK_ROWS - first_row).min(points - first_point);
            let sums =
                executor.buffer(BindingKind::ReadWrite, self.width * rows * self.sum.stride)?;
            self.bands.push(Band {
                chunk,
                first_row: first_row as u32,
                first_point,
                rows: rows as u32,
                sums,
                states: None,
            });
            if self.state_bytes > 0 {
                let bytes = self.width * rows * self.state_bytes;
                let states = executor.buffer(BindingKind::ReadWrite, bytes)?;
                if let Some(band) = self.bands.last_mut() {
                    band.states = Some(states);
                }
            }
            first_point += rows;
        }
        Ok(())
    }

    /// Makes room for other shading points, and another number of sums for each; all sums begin empty.
    pub fn fit(
        &mut self,
        executor: &mut dyn Executor,
        stage: &mut Stage,
        program: &Program,
        width: usize,
    ) -> Result<()> {
        check_room(executor, stage, width * (self.sum.stride + self.state_bytes))?;
        self.free_bands(executor);
        self.width = width;
        stage.provide(executor, program)?;
        self.make_bands(executor, stage.points().len())
    }

    /// Writes the plugins' numbers anew, for the same program, and what is fitted to them.
    pub fn set_values(
        &mut self,
        executor: &mut dyn Executor,
        program: &Program,
        plugins: &[&Configured],
    ) -> Result<()> {
        for (name, bytes) in plugins.iter().filter_map(|c| program.parameter_bytes(c)) {
            let held = self.owned.iter().find(|(owned, _)| *owned == name);
            if let Some((_, buffer)) = held {
                executor.write(*buffer, bytes)?;
            }
        }
        let is_brdf = |configured: &&&Configured| configured.plugin.manifest.kind == Kind::Brdf;
        match plugins.iter().find(is_brdf) {
            Some(brdf) if program.sampling == Sampling::Fitted => {
                bring(executor, program, brdf, &mut self.brought)
            }
            _ => Ok(()),
        }
    }

    /// Whether the program keeps a state from sample to sample.
    pub fn keeps_state(&self) -> bool {
        self.state_bytes > 0
    }

    /// Runs the kernel over `rows` rows of a band, with these words in `work`.
    pub fn dispatch(
        &self,
        executor: &mut dyn Executor,
        stage: &Stage,
        band: &Band,
        words: &[(&str, u32)],
        rows: u32,
    ) -> Result<Duration> {
        let mut bytes = vec![0; self.work_layout.stride];
        for (member, word) in words {
            self.work_layout.write(&mut bytes, 0, member, &[*word]);
        }
        executor.write(self.work, bytes)?;
        let mut bound = stage.bound(band.chunk);
        bound.extend(self.owned.iter().map(|(name, id)| (name.as_str(), *id)));
        bound.extend(self.brought.iter().map(|(brought, id)| (brought.name.as_str(), *id)));
        bound.push(("sums", band.sums));
        bound.extend(band.states.map(|states| ("states", states)));
        executor.dispatch(self.kernel, &bound, rows)
    }

    /// The sums of a band.
    pub fn read(&self, executor: &mut dyn Executor, band: &Band) -> Result<Readout> {
        executor.read(band.sums, self.width * band.rows as usize * self.sum.stride)
    }

    /// Empties the sums, for kernels that go on from what they find in them.
    pub fn clear_sums(&self, executor: &mut dyn Executor) -> Result<()> {
        self.bands.iter().try_for_each(|band| {
            let slots = self.width * band.rows as usize;
            executor.write(band.sums, vec![0; slots * self.sum.stride])
        })
    }

    /// Lets plugins forget what they learned.
    pub fn clear_states(&self, executor: &mut dyn Executor) -> Result<()> {
        self.bands.iter().try_for_each(|band| match band.states {
            None => Ok(()),
            Some(states) => {
                let slots = self.width * band.rows as usize;
                executor.write(states, vec![0; slots * self.state_bytes])
            }
        })
    }

    fn free_bands(&mut self, executor: &mut dyn Executor) {
        for band in self.bands.drain(..) {
            executor.free(band.sums);
            band.states.into_iter().for_each(|states| executor.free(states));
        }
    }

    /// Frees the kernel and its buffers.
    pub fn free(mut self, executor: &mut dyn Executor) {
        self.free_bands(executor);
        self.owned.into_iter().for_each(|(_, id)| executor.free(id));
        self.brought.into_iter().for_each(|(_, id)| executor.free(id));
        executor.forget(self.kernel);
    }
}

/// Refuses more sums than the device may hold.
fn check_room(executor: &dyn Executor, stage: &Stage, row_bytes: usize) -> Result<()> {
    let needed = row_bytes as u64 * stage.points().len() as u64;
    let total = executor.limits().total_bytes;
    if needed <= total {
        return Ok(());
    }
    Err(Problem::new(
        "the sums of all pixels",
        format!("they take {} and {} may be used", memory::shown(needed), memory::shown(total)),
        "lower --resolution or --replicates",
    ))
}
