//! The render loop: the one that the command line uses, and every other view with it.
//!
//! It asks the schedule for a cut, dispatches it, reads block sums back and adds them to the film.
//! The picture depends on the settings and the seed alone, never on how the work was cut.

pub mod albedo;
pub mod background;
mod estimate;
pub mod evaluate;
mod film;
mod loaded;
mod prepared;
pub mod rest;
pub mod rows;
mod samples;
mod schedule;
mod stage;
mod stop;
mod terms;
mod trial;

use std::sync::Arc;
use std::time::{Duration, Instant};

use brdf_sdk::{Problem, Result};

pub use estimate::{Estimate, estimate};
pub use film::{Film, Quadrature};
pub use prepared::Prepared;
pub use schedule::{HEADLESS_BUDGET, Pace, TERM_BLOCK};
pub use stage::{CHUNK_ROWS, Lighting, Stage};
pub use stop::{Reason, Stop, Stopping};

pub use crate::environment::{Filter, Weighting};
pub use crate::link::Sampler;
pub use crate::measure::student::DOUBTFUL_SHARE;

use crate::exec::Executor;
use crate::link::Program;
use crate::plugin::Configured;

/// Samples a pixel in one pass at the most, and of one replicate in all: the sampler's points have 24 bits.
pub const MAX_SAMPLES: u32 = 1 << 24;

/// Replicates at the most.
pub const MAX_REPLICATES: u32 = 256;

/// How much is sampled, and from which seed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Effort {
    /// Samples a pixel in each pass.
    pub samples: u32,
    /// Passes; without a number it goes on until it is stopped.
    pub passes: Option<u32>,
    /// Independent scrambles that share the samples in turn; their spread tells the error.
    pub replicates: u32,
    /// Seed of all scrambles.
    pub seed: u32,
    /// Whether all replicates pause where their samples have doubled, for a look at the error.
    pub doublings: bool,
}

impl Effort {
    /// An effort with a number of passes and everything else as usual.
    pub fn new(samples: u32, passes: u32) -> Self {
        Self { samples, passes: Some(passes), replicates: 16, seed: 0, doublings: false }
    }

    /// Refuses more samples than the points of all replicates.
    fn check(self) -> Result<()> {
        let most = u64::from(self.replicates) * u64::from(MAX_SAMPLES);
        let wanted = u64::from(self.samples) * u64::from(self.passes.unwrap_or(1));
        if wanted <= most {
            return Ok(());
        }
        Err(Problem::new(
            format!("{wanted} samples a pixel"),
            format!("{} replicates have {most} points", self.replicates),
            "lower --samples or --passes",
        ))
    }

    /// Samples a pixel in all.
    pub fn spp(self) -> u64 {
        let most = u64::from(self.replicates) * u64::from(MAX_SAMPLES);
        let wanted = self.passes.map(|passes| u64::from(self.samples) * u64::from(passes));
        wanted.map_or(most, |wanted| wanted.min(most))
    }

    /// Samples of one replicate: sample n of a pixel goes to replicate n modulo their number.
    pub(crate) fn samples_of(self, replicate: u32) -> u32 {
        let each = (self.spp() / u64::from(self.replicates)) as u32;
        each + u32::from(replicate < self.longer_replicates())
    }

    /// Replicates with one sample more than the others.
    fn longer_replicates(self) -> u32 {
        (self.spp() % u64::from(self.replicates)) as u32
    }
}

/// What came out.
#[derive(Debug, Clone)]
pub struct Rendered {
    /// The sums of every pixel.
    pub film: Film,
    /// Preparing the program, the driver's compiler included.
    pub compile: Duration,
    /// Dispatches and reading back.
    pub render: Duration,
    /// How it ended.
    pub ended: Ended,
    /// What is worth telling of the program's run, each thing once.
    pub notes: Vec<String>,
}

/// How a rendering ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ended {
    /// All samples or terms were done.
    Complete,
    /// The observer ended it; the film holds what was done.
    Early,
    /// The observer has no more use for it.
    Abandoned,
}

/// How far the rendering is.
#[derive(Debug, Clone, Copy)]
pub struct Progress<'a> {
    /// Samples of a pixel, or terms, that are done.
    pub done: u64,
    /// Samples of a pixel, or terms, in all.
    pub of: u64,
    /// Whether the samples of each replicate, or the terms, have just reached a power of two.
    pub doubling: bool,
    /// The film, where it was just read.
    pub film: Option<&'a Film>,
    /// Seconds of all dispatches so far by the device's own clock, where it has one and the film was just read at a
    /// doubling that the effort asks for.
    pub device_seconds: Option<f64>,
}

/// What the observer of a rendering wants next.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wish {
    /// More samples.
    GoOn,
    /// To see the film.
    Look,
    /// The film as it is, and no more samples.
    Finish,
    /// Nothing more of this.
    Abandon,
}

/// Called after every stretch of work, and again with the film where it was read.
pub type Observe<'a> = dyn FnMut(Progress<'_>) -> Wish + 'a;

/// Renders a linked film program in dispatches of about `budget`: [`Prepared::new`] and one
/// [`Prepared::run`].
pub fn render(
    executor: &mut dyn Executor,
    stage: &mut Stage,
    program: &Arc<Program>,
    plugins: &[&Configured],
    effort: Effort,
    budget: Duration,
    observe: &mut Observe<'_>,
) -> Result<Rendered> {
    if stage.points().is_empty() {
        // Nothing is covered: a picture all the same, and no work for the device.
        let (compile, render) = Default::default();
        let film = Film::new(0, effort.replicates as usize, 1.0);
        return Ok(Rendered { film, compile, render, ended: Ended::Complete, notes: Vec::new() });
    }
    let start = Instant::now();
    let pace = Pace::new(budget);
    let mut prepared = Prepared::new(executor, stage, program, plugins, effort, pace)?;
    let compile = start.elapsed();

    let start = Instant::now();
    let mut film = Film::new(0, effort.replicates as usize, 1.0);
    let result = prepared.run(executor, stage, &mut film, observe);
    let render = start.elapsed();
    prepared.free(executor);
    let notes = executor.take_notes();
    let ended = result?;
    if let [brdf, ..] = plugins {
        rest::complete(executor, stage, program, brdf, ended, &mut film)?;
    }
    Ok(Rendered { film, compile, render, ended, notes })
}
