//! A film program made ready on a device, and what it knows of its own speed.

use std::sync::Arc;

use brdf_sdk::Result;

use super::loaded::Loaded;
use super::samples::Samples;
use super::schedule::{Pace, Schedule};
use super::terms::Terms;
use super::{Effort, Ended, Film, Observe, Stage, trial};
use crate::exec::Executor;
use crate::link::Program;
use crate::plugin::Configured;

/// Iterations of the searches that a step may start, in a row and in a column of the environment's
/// tables: at most 16 each, for two draws.
const SEARCH_ITERATIONS: u32 = 64;

/// A film program on a device, compiled, with its buffers and what it knows of its own speed.
pub struct Prepared {
    loaded: Loaded,
    program: Arc<Program>,
    effort: Effort,
    schedule: Schedule,
    scale: f32,
    /// Where the program adds up terms: how many there are, and how many make a pass.
    terms: Option<[u32; 2]>,
    has_loops: bool,
    /// Whether it has run before, so that its buffers are no longer zero.
    used: bool,
}

impl Prepared {
    /// Compiles the program, the driver's own compiler included, and uploads what it reaches.
    pub fn new(
        executor: &mut dyn Executor,
        stage: &mut Stage,
        program: &Arc<Program>,
        plugins: &[&Configured],
        effort: Effort,
        pace: Arc<Pace>,
    ) -> Result<Self> {
        effort.check()?;
        trial::try_film(executor, stage, program, plugins, effort.seed)?;
        let width = if program.sum.is_some() { 1 } else { effort.replicates as usize };
        let loaded = Loaded::new(executor, stage, program, plugins, width)?;
        let scale = if program.binds("env_map") { stage.scale() } else { 1.0 };
        let terms = program.sum.map(|sum| [stage.terms(), sum.per_pass]);
        // Inner loops count too: drivers end all loops of an invocation together.
        let iterations = if program.binds("env_guides") { SEARCH_ITERATIONS } else { 1 };
        let schedule = Schedule::new(pace, iterations, executor.limits().parallel);
        let has_loops = program.has_loops;
        let program = Arc::clone(program);
        Ok(Self { loaded, program, effort, schedule, scale, terms, has_loops, used: false })
    }

    /// The program.
    pub fn program(&self) -> &Arc<Program> {
        &self.program
    }

    /// Goes on with other shading points of the stage and another effort, and nothing compiled again.
    pub fn fit(
        &mut self,
        executor: &mut dyn Executor,
        stage: &mut Stage,
        effort: Effort,
    ) -> Result<()> {
        effort.check()?;
        let width = if self.terms.is_some() { 1 } else { effort.replicates as usize };
        self.loaded.fit(executor, stage, &self.program, width)?;
        self.terms = self.program.sum.map(|sum| [stage.terms(), sum.per_pass]);
        (self.effort, self.used) = (effort, false);
        Ok(())
    }

    /// Takes other numbers for the plugins' parameters; none of them may be a constant of the program.
    pub fn set_values(
        &mut self,
        executor: &mut dyn Executor,
        plugins: &[&Configured],
    ) -> Result<()> {
        self.loaded.set_values(executor, &self.program, plugins)
    }

    /// Renders into the film, whatever it held before.
    pub fn run(
        &mut self,
        executor: &mut dyn Executor,
        stage: &Stage,
        film: &mut Film,
        observe: &mut Observe<'_>,
    ) -> Result<Ended> {
        if std::mem::replace(&mut self.used, true) {
            match self.terms {
                None => self.loaded.clear_states(executor)?,
                Some(_) => self.loaded.clear_sums(executor)?,
            }
        }
        let (loaded, scale) = (&self.loaded, self.scale);
        match self.terms {
            None => {
                Samples { loaded, stage, effort: self.effort, scale, has_loops: self.has_loops }
                    .run(executor, &mut self.schedule, film, observe)
            }
            Some([terms, per_pass]) => Terms { loaded, stage, scale, terms, per_pass }.run(
                executor,
                &mut self.schedule,
                film,
                observe,
            ),
        }
    }

    /// Frees the kernel and its buffers.
    pub fn free(self, executor: &mut dyn Executor) {
        self.loaded.free(executor);
    }
}
