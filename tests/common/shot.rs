//! A picture for a test: points, a map, an effort; taken on a device.

use std::sync::Arc;
use std::time::Duration;

use brdf_host::environment::Environment;
use brdf_host::exec::Executor;
use brdf_host::link::{Sampler, View, link};
use brdf_host::plugin::Configured;
use brdf_host::render::{Effort, Film, HEADLESS_BUDGET, Lighting, Progress, Stage, Wish, render};
use brdf_host::scene::{Camera, ShadingPoint, Shape, cast};
use brdf_sdk::Problem;
use glam::DMat3;

/// A map of these texels.
pub fn map(width: u32, height: u32, texel: impl Fn(u32, u32) -> [f32; 3]) -> Arc<Environment> {
    let mut environment = Environment::constant(0.0);
    let rows = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    environment.texels = Arc::new(
        rows.map(|(x, y)| {
            let [r, g, b] = texel(x, y);
            [r, g, b, 0.0]
        })
        .collect(),
    );
    (environment.width, environment.height) = (width, height);
    Arc::new(environment)
}

/// The default sphere in a square picture.
pub fn sphere(resolution: u32) -> Vec<ShadingPoint> {
    cast(&Camera::default(), &Shape::Sphere, [resolution; 2]).points
}

/// What is rendered, and how much.
pub struct Shot {
    pub points: Vec<ShadingPoint>,
    pub environment: Arc<Environment>,
    pub rotation: DMat3,
    pub lighting: Lighting,
    pub sampler: Sampler,
    pub effort: Effort,
    pub budget: Duration,
}

impl Shot {
    pub fn new(
        points: Vec<ShadingPoint>,
        environment: Arc<Environment>,
        samples: u32,
        passes: u32,
    ) -> Self {
        Self {
            points,
            environment,
            rotation: DMat3::IDENTITY,
            lighting: Lighting::default(),
            sampler: Sampler::default(),
            effort: Effort { seed: 1, ..Effort::new(samples, passes) },
            budget: HEADLESS_BUDGET,
        }
    }

    pub fn take(
        &self,
        executor: &mut dyn Executor,
        brdf: &Configured,
        integrator: &Configured,
    ) -> Result<Film, Problem> {
        let stage = Stage::new(self.points.clone(), self.environment.clone(), self.rotation);
        let mut stage = stage.lit(self.lighting);
        let form = stage.form(self.sampler);
        let view = View::Film { brdf: brdf.clone(), integrator: integrator.clone(), form };
        let program = Arc::new(link(&view)?);
        let plugins = [brdf, integrator];
        let mut go_on = |_: Progress<'_>| Wish::GoOn;
        let budget = self.budget;
        let rendered =
            render(executor, &mut stage, &program, &plugins, self.effort, budget, &mut go_on)?;
        Ok(rendered.film)
    }
}
