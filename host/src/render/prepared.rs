//! A film program made ready on a device, and the loop that runs it.
//!
//! It asks the schedule for a cut, dispatches it, reads block sums back and adds them to the film.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::time::Duration;

use brdf_sdk::{Problem, Result};

use super::schedule::{BLOCK, Cut, Schedule};
use super::{CHUNK_ROWS, Effort, Film, Progress, Stage, endless_loop, trial};
use crate::exec::{Executor, KernelId, Readout, ResourceId};
use crate::link::{BindingKind, Program, StructLayout};
use crate::plugin::Configured;

/// Bytes of block sums that are held on the device at once.
const SUM_BYTES: usize = 32 << 20;

/// A film program on a device, compiled, with its buffers and what it knows of its own speed.
pub struct Prepared {
    kernel: KernelId,
    owned: Vec<(String, ResourceId)>,
    work: ResourceId,
    sums: ResourceId,
    work_layout: StructLayout,
    sum: SumLayout,
    /// Blocks whose sums fit the device's buffer side by side.
    slots: u32,
    effort: Effort,
    schedule: Schedule,
    names: String,
}

/// Makes the buffers of a film program: `work`, `sums`, and the plugins' numbers.
fn upload(
    executor: &mut dyn Executor,
    program: &Program,
    plugins: &[&Configured],
    [work_bytes, sum_bytes]: [usize; 2],
    owned: &mut Vec<(String, ResourceId)>,
) -> Result<()> {
    owned.push(("work".to_owned(), executor.buffer(BindingKind::Uniform, work_bytes)?));
    owned.push(("sums".to_owned(), executor.buffer(BindingKind::ReadWrite, sum_bytes)?));
    for configured in plugins {
        if let Some((name, bytes)) = program.parameter_bytes(configured) {
            let buffer = executor.buffer(BindingKind::Uniform, bytes.len())?;
            owned.push((name, buffer));
            executor.write(buffer, bytes)?;
        }
    }
    Ok(())
}

/// One stretch of a chunk of rows.
struct Stretch {
    chunk: usize,
    rows: u32,
    first_block: u32,
    cut: Cut,
}

/// Where the members of a block's sum lie, looked up once.
struct SumLayout {
    stride: usize,
    rgb: [usize; 3],
    samples: usize,
    nonfinite: usize,
    exhausted: usize,
}

impl SumLayout {
    fn new(layout: &StructLayout) -> Self {
        Self {
            stride: layout.stride,
            rgb: ["r", "g", "b"].map(|channel| layout.at(channel)),
            samples: layout.at("samples"),
            nonfinite: layout.at("nonfinite"),
            exhausted: layout.at("exhausted"),
        }
    }
}

impl Prepared {
    /// Compiles the program, the driver's own compiler included, and uploads what it reaches.
    pub fn new(
        executor: &mut dyn Executor,
        stage: &mut Stage,
        program: &Arc<Program>,
        plugins: &[&Configured],
        effort: Effort,
        budget: Duration,
    ) -> Result<Self> {
        if effort.samples.div_ceil(BLOCK).checked_mul(effort.passes).is_none() {
            return Err(Problem::new(
                format!("{} x {} samples", effort.samples, effort.passes),
                "this is more than the program can count",
                "lower --samples or --passes",
            ));
        }
        let sum = SumLayout::new(&program.required_layout("sums"));
        let work_layout = program.required_layout("work");
        let rows = stage.points().len().clamp(1, CHUNK_ROWS);
        let most = (SUM_BYTES as u64).min(executor.limits().buffer_bytes) as usize;
        let blocks = effort.samples.div_ceil(BLOCK) * effort.passes;
        let slots = (most / (rows * sum.stride)).clamp(1, 4096).min(blocks as usize);
        trial::try_film(executor, stage, program, plugins, effort.seed)?;
        stage.provide(executor, program)?;
        let kernel = executor.compile(Arc::clone(program))?;
        let sizes = [work_layout.stride, slots * rows * sum.stride];
        let mut owned = Vec::new();
        if let Err(problem) = upload(executor, program, plugins, sizes, &mut owned) {
            owned.iter().for_each(|(_, id)| executor.free(*id));
            executor.forget(kernel);
            return Err(problem);
        }
        let (work, sums) = (owned[0].1, owned[1].1);
        let names: Vec<_> =
            plugins.iter().map(|configured| configured.plugin.id.as_str()).collect();
        let names = names.join(" with ");
        let film = Self {
            kernel,
            owned,
            work,
            sums,
            work_layout,
            sum,
            slots: slots as u32,
            effort,
            schedule: Schedule::new(budget),
            names,
        };
        // An empty dispatch: the driver's own compiler runs now, and not in the first measured one.
        let nothing =
            Stretch { chunk: 0, rows: 0, first_block: 0, cut: Cut { blocks: 0, rows: 0 } };
        if let Err(problem) = film.dispatch(executor, stage, &nothing, 0, [0, 0]) {
            film.free(executor);
            return Err(problem);
        }
        Ok(film)
    }

    /// Renders all passes into an empty film; false where `observe` ended it early.
    pub fn run(
        &mut self,
        executor: &mut dyn Executor,
        stage: &Stage,
        film: &mut Film,
        observe: &mut impl FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<bool> {
        let per_pass = self.effort.samples.div_ceil(BLOCK);
        let blocks = self.effort.passes * per_pass;
        let mut done = 0;
        while done < blocks {
            // All chunks of the hit list do the same blocks, so that passes end together. Blocks are
            // grouped only where they are alike: a pass of one block each.
            let widest = stage.points().len().min(CHUNK_ROWS) as u32;
            let alike = if per_pass == 1 { (blocks - done).min(self.slots) } else { 1 };
            let group = self.schedule.next(alike, self.block_samples(done), widest).blocks;
            let Some(sums) = self.group_sums(executor, stage, done, group)? else { continue };
            for slot in 0..group {
                self.add(film, &sums, slot, done + slot)?;
                if (done + slot) % per_pass == per_pass - 1 {
                    film.end_pass(self.effort.samples);
                }
            }
            done += group;
            if observe(Progress { blocks: done.into(), of: blocks.into() }).is_break() {
                break;
            }
        }
        Ok(done == blocks)
    }

    /// Samples of a block: the last one of a pass may be short.
    fn block_samples(&self, block: u32) -> u32 {
        let per_pass = self.effort.samples.div_ceil(BLOCK);
        (self.effort.samples - (block % per_pass) * BLOCK).min(BLOCK)
    }

    /// The sums of `group` blocks, a list of bytes for each chunk of rows; `None` where a plugin's
    /// loops used up their budget and the schedule will now cut shorter.
    fn group_sums(
        &mut self,
        executor: &mut dyn Executor,
        stage: &Stage,
        first_block: u32,
        group: u32,
    ) -> Result<Option<Vec<Readout>>> {
        let block_samples = self.block_samples(first_block);
        let mut sums = Vec::new();
        for (chunk, points) in stage.points().chunks(CHUNK_ROWS).enumerate() {
            let rows = points.len() as u32;
            let mut most = 0;
            let mut first_row = 0;
            while first_row < rows {
                // Several blocks are only ever done whole and over all rows.
                let mut cut = Cut { blocks: group, rows };
                if group == 1 {
                    cut.rows =
                        self.schedule.next(1, block_samples, rows).rows.min(rows - first_row);
                }
                let stretch = Stretch { chunk, rows, first_block, cut };
                let mut first_sample = 0;
                while first_sample < block_samples {
                    let left = block_samples - first_sample;
                    let samples =
                        if group > 1 { left } else { self.schedule.samples(cut.rows, left) };
                    let time = self.dispatch(
                        executor,
                        stage,
                        &stretch,
                        first_row,
                        [first_sample, samples],
                    )?;
                    let each = u64::from(samples) * u64::from(group);
                    self.schedule.learn(each * u64::from(cut.rows), time);
                    most = most.max(samples * group);
                    first_sample += samples;
                }
                first_row += cut.rows;
            }
            let slots = group as usize * rows as usize;
            let read = executor.read(self.sums, slots * self.sum.stride)?;
            let exhausted =
                |slot: usize| read.word(slot * self.sum.stride + self.sum.exhausted) != 0;
            if (0..slots).any(exhausted) {
                return if self.schedule.shorten(most) {
                    Ok(None)
                } else {
                    Err(endless_loop(&self.names, "sample"))
                };
            }
            sums.push(read);
        }
        Ok(Some(sums))
    }

    fn dispatch(
        &self,
        executor: &mut dyn Executor,
        stage: &Stage,
        stretch: &Stretch,
        first_row: u32,
        [first_sample, samples]: [u32; 2],
    ) -> Result<Duration> {
        let words = [
            ("first_row", first_row),
            ("row_count", stretch.cut.rows),
            ("rows", stretch.rows),
            ("first_block", stretch.first_block),
            ("block_count", stretch.cut.blocks),
            ("block_size", BLOCK),
            ("pass_size", self.effort.samples),
            ("first_sample", first_sample),
            ("sample_count", samples),
            ("seed", self.effort.seed),
        ];
        let mut bytes = vec![0; self.work_layout.stride];
        for (member, word) in words {
            self.work_layout.write(&mut bytes, 0, member, &[word]);
        }
        executor.write(self.work, bytes)?;
        let mut bound = stage.bound(stretch.chunk);
        bound.extend(self.owned.iter().map(|(name, id)| (name.as_str(), *id)));
        executor.dispatch(self.kernel, &bound, stretch.cut.rows)
    }

    /// Adds one slot of every chunk to the pass under way, and checks the kernel's own count.
    fn add(&self, film: &mut Film, sums: &[Readout], slot: u32, block: u32) -> Result<()> {
        let expected = self.block_samples(block);
        let mut row = 0;
        for sums in sums {
            let rows = (film.pixels().len() - row).min(CHUNK_ROWS);
            let first = slot as usize * rows;
            for at in (first..first + rows).map(|sum| sum * self.sum.stride) {
                let done = sums.word(at + self.sum.samples);
                if done != expected {
                    return Err(Problem::new(
                        &self.names,
                        format!(
                            "a pixel did {done} samples of {expected}: the driver ended its loop early"
                        ),
                        "use a newer driver or another `--device`, or fewer --samples",
                    ));
                }
                let rgb = self.sum.rgb.map(|channel| sums.float(at + channel));
                film.add_block(row, rgb, sums.word(at + self.sum.nonfinite));
                row += 1;
            }
        }
        Ok(())
    }

    /// Frees the kernel and its buffers.
    pub fn free(&self, executor: &mut dyn Executor) {
        for (_, id) in &self.owned {
            executor.free(*id);
        }
        executor.forget(self.kernel);
    }
}
