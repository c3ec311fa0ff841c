//! A kernel that is the same everywhere: figures of speed beside its own let machines compare, and its spread tells of a
//! machine that does other things.

use std::sync::Arc;
use std::time::Instant;

use brdf_sdk::{Kind, Result};
use glam::DMat3;

use crate::environment::Environment;
use crate::exec::Executor;
use crate::link::{View, link};
use crate::registry::Registry;
use crate::render::{Effort, Film, HEADLESS_BUDGET, Pace, Prepared, Sampler, Stage, Wish};
use crate::scene::{Camera, Shape, cast};
use crate::session::Chosen;

/// A sphere of this many pixels a side, and samples of each of them.
const SIDE: u32 = 128;
const SAMPLES: u32 = 256;

/// The BRDF and the integrator that need least.
const BRDF: &str = "lambert";
const INTEGRATOR: &str = "uniform";

/// Million samples a second of the kernel.
pub(super) fn rate(registry: &Registry, executor: &mut dyn Executor) -> Result<f64> {
    let brdf = Chosen::find(registry, Kind::Brdf, BRDF)?.configured;
    let integrator = Chosen::find(registry, Kind::Integrator, INTEGRATOR)?.configured;
    let points = cast(&Camera::default(), &Shape::Sphere, [SIDE; 2]).points;
    let count = points.len();
    let mut stage = Stage::new(points, Arc::new(Environment::constant(1.0)), DMat3::IDENTITY);
    let program = Arc::new(link(&View::Film {
        brdf: brdf.clone(),
        integrator: integrator.clone(),
        form: stage.form(Sampler::default()),
    })?);
    let effort = Effort::new(SAMPLES, 1);
    let pace = Pace::new(HEADLESS_BUDGET);
    let mut prepared =
        Prepared::new(executor, &mut stage, &program, &[&brdf, &integrator], effort, pace)?;
    let mut film = Film::new(0, 1, 1.0);
    // The first run warms it up.
    let mut seconds = 0.0;
    let mut ran = Ok(());
    for _ in 0..2 {
        let start = Instant::now();
        let ended = prepared.run(executor, &stage, &mut film, &mut |_| Wish::GoOn);
        seconds = start.elapsed().as_secs_f64();
        ran = ran.and(ended.map(|_| ()));
    }
    prepared.free(executor);
    stage.unload(executor);
    ran?;
    Ok(f64::from(SAMPLES) * count as f64 / seconds.max(1e-9) / 1e6)
}
