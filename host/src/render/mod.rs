//! The render loop: the one that the command line uses, and every other view with it.
//!
//! It asks the schedule for a cut, dispatches it, reads block sums back and adds them to the film.
//! The picture depends on the settings and the seed alone, never on how the work was cut.

pub mod albedo;
pub mod background;
pub mod evaluate;
mod film;
mod prepared;
mod schedule;
mod stage;
mod trial;

use std::ops::ControlFlow;
use std::sync::Arc;
use std::time::{Duration, Instant};

use brdf_sdk::{Problem, Result};

pub use film::{Film, Pixel};
pub use prepared::Prepared;
pub use schedule::{BLOCK, HEADLESS_BUDGET};
pub use stage::{CHUNK_ROWS, Stage};

use crate::exec::Executor;
use crate::link::Program;
use crate::plugin::Configured;

/// Samples a pixel in one pass at the most: the sampler's points have 24 bits.
pub const MAX_SAMPLES: u32 = 1 << 24;

/// How much is sampled, and from which seed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Effort {
    /// Samples a pixel in each pass.
    pub samples: u32,
    /// Passes; each is an independent scramble of the sequence.
    pub passes: u32,
    /// Seed of all scrambles.
    pub seed: u32,
}

/// What came out.
#[derive(Debug, Clone)]
pub struct Rendered {
    /// Mean and variance of every pixel.
    pub film: Film,
    /// Preparing the program, the driver's compiler included.
    pub compile: Duration,
    /// Dispatches and reading back.
    pub render: Duration,
    /// Whether all passes were done.
    pub complete: bool,
    /// What is worth telling of the program's run, each thing once.
    pub notes: Vec<String>,
}

/// How far the rendering is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Progress {
    /// Blocks done, over all passes.
    pub blocks: u64,
    /// Blocks in all.
    pub of: u64,
}

/// Renders a linked film program in dispatches of about `budget`: [`Prepared::new`] and one
/// [`Prepared::run`]. `observe` is called after every stretch of work and may end it.
pub fn render(
    executor: &mut dyn Executor,
    stage: &mut Stage,
    program: &Arc<Program>,
    plugins: &[&Configured],
    effort: Effort,
    budget: Duration,
    mut observe: impl FnMut(Progress) -> ControlFlow<()>,
) -> Result<Rendered> {
    if stage.points().is_empty() {
        // Nothing is covered: a picture all the same, and no work for the device.
        let (compile, render) = Default::default();
        let notes = Vec::new();
        return Ok(Rendered { film: Film::new(0), compile, render, complete: true, notes });
    }
    let start = Instant::now();
    let mut prepared = Prepared::new(executor, stage, program, plugins, effort, budget)?;
    let compile = start.elapsed();

    let start = Instant::now();
    let mut film = Film::new(stage.points().len());
    let result = prepared.run(executor, stage, &mut film, &mut observe);
    let render = start.elapsed();
    prepared.free(executor);
    let notes = executor.take_notes();
    Ok(Rendered { film, compile, render, complete: result?, notes })
}

/// Where `each` of something used up the loop budget of shaders/loops.wgsl on its own.
fn endless_loop(plugins: &str, each: &str) -> Problem {
    Problem::new(
        plugins,
        format!("a loop took more than 16,383 iterations for one {each}"),
        "look for an endless loop, or give the loop a smaller bound",
    )
}
