//! A kernel that is the same everywhere: figures of speed beside its own let machines compare, and its spread tells of a
//! machine that does other things.

use std::sync::Arc;
use std::time::{Duration, Instant};

use brdf_sdk::{Kind, Result};
use glam::DMat3;

use crate::environment::Environment;
use crate::exec::Executor;
use crate::link::{View, link};
use crate::registry::Registry;
use crate::render::{Effort, Film, HEADLESS_BUDGET, Pace, Prepared, Sampler, Stage, Wish};
use crate::scene::{Camera, Shape, cast};
use crate::session::Chosen;

/// A sphere of this many pixels a side, and samples of each of them at the first time.
const SIDE: u32 = 128;
const SAMPLES: u32 = 256;

/// The least time of a run that counts, and how many times as much work the next one does after a shorter one.
const LEAST: Duration = Duration::from_millis(50);
const MORE: u32 = 4;

/// How long a device with clocks of its own is kept busy before it is measured: an H200 that was idle goes at a sixth of its
/// speed at first.
const WARMING: Duration = Duration::from_millis(300);

/// The BRDF and the integrator that need least.
const BRDF: &str = "lambert";
const INTEGRATOR: &str = "uniform";

/// The kernel on one device.
pub(super) struct Calibration {
    prepared: Prepared,
    stage: Stage,
    film: Film,
    effort: Effort,
}

impl Calibration {
    pub(super) fn new(registry: &Registry, executor: &mut dyn Executor) -> Result<Self> {
        let brdf = Chosen::find(registry, Kind::Brdf, BRDF)?.configured;
        let integrator = Chosen::find(registry, Kind::Integrator, INTEGRATOR)?.configured;
        let points = cast(&Camera::default(), &Shape::Sphere, [SIDE; 2]).points;
        let nothing = Arc::new(Environment::constant(1.0));
        let mut stage = Stage::new(points, nothing, DMat3::IDENTITY);
        let program = Arc::new(link(&View::Film {
            brdf: brdf.clone(),
            integrator: integrator.clone(),
            form: stage.form(Sampler::default()),
        })?);
        let effort = Effort::new(SAMPLES, 1);
        let pace = Pace::new(HEADLESS_BUDGET);
        let plugins = [&brdf, &integrator];
        let prepared = Prepared::new(executor, &mut stage, &program, &plugins, effort, pace)?;
        let mut new = Self { prepared, stage, film: Film::new(0, 1, 1.0), effort };
        while new.run(executor)? < LEAST {
            new.effort.samples *= MORE;
            new.prepared.fit(executor, &mut new.stage, new.effort)?;
        }
        Ok(new)
    }

    /// Million samples a second of the kernel.
    pub(super) fn rate(&mut self, executor: &mut dyn Executor) -> Result<f64> {
        self.warm(executor)?;
        let seconds = self.run(executor)?.as_secs_f64();
        let samples = f64::from(self.effort.samples) * self.stage.points().len() as f64;
        Ok(samples / seconds.max(1e-9) / 1e6)
    }

    /// Lets a device that lowers its clocks while it waits raise them again.
    pub(super) fn warm(&mut self, executor: &mut dyn Executor) -> Result<()> {
        let start = Instant::now();
        while executor.limits().parallel > 1 && start.elapsed() < WARMING {
            self.run(executor)?;
        }
        Ok(())
    }

    fn run(&mut self, executor: &mut dyn Executor) -> Result<Duration> {
        let Self { prepared, stage, film, .. } = self;
        let start = Instant::now();
        prepared.run(executor, stage, film, &mut |_| Wish::GoOn)?;
        Ok(start.elapsed())
    }

    /// Frees what it holds on the device.
    pub(super) fn free(mut self, executor: &mut dyn Executor) {
        self.prepared.free(executor);
        self.stage.unload(executor);
    }
}
