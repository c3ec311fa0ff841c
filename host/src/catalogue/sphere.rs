//! The sphere of an entry: the default scene, small and smooth.

use std::sync::Arc;

use brdf_sdk::Result;
use glam::DMat3;

use crate::environment::Environment;
use crate::exec::Precision;
use crate::exec::cpu::Cpu;
use crate::link::{Sampler, View, link};
use crate::picture::{Picture, Raster};
use crate::plugin::Configured;
use crate::render::{Effort, HEADLESS_BUDGET, Stage, Wish, background, render};
use crate::scene::{Camera, Coverage, Shape, cast};
use crate::tone::Tone;

/// The side of the picture [pixels].
pub const SIDE: u32 = 192;
/// Pixels that are rendered for one of the picture, each way.
const FINER: u32 = 2;
/// Samples of each of those. Beside 4,096 of them 99 % of a picture's bytes are off by 4 at the most, and none by
/// more than 13, for GGX, Ward's, Disney's and a modified Phong model.
const SAMPLES: u32 = 128;
/// Exposure [stops]: white paper stays below the shoulder's end.
pub const STOPS: f64 = -0.5;

/// Samples of a pixel of the picture.
pub const SPP: u32 = SAMPLES * FINER * FINER;

/// The executor with the scene on it.
pub struct Booth {
    executor: Cpu,
    stage: Stage,
    coverage: Coverage,
    background: Vec<[f32; 3]>,
    integrator: Configured,
}

impl Booth {
    pub fn new(environment: Arc<Environment>, integrator: Configured) -> Result<Self> {
        let mut executor = Cpu::new(Precision::F32);
        let (camera, resolution) = (Camera::default(), [SIDE * FINER; 2]);
        let coverage = cast(&camera, &Shape::Sphere, resolution);
        let mut stage = Stage::new(coverage.points.clone(), environment, DMat3::IDENTITY);
        let rays = coverage.rays_past(&camera, resolution);
        let background = background::background(&mut executor, &mut stage, &rays)?;
        Ok(Self { executor, stage, coverage, background, integrator })
    }

    /// Renders the BRDF; and what is worth telling of that.
    pub fn picture(&mut self, brdf: &Configured) -> Result<(Raster, Vec<String>)> {
        let form = self.stage.form(Sampler::OwenSobol);
        let view = View::Film { brdf: brdf.clone(), integrator: self.integrator.clone(), form };
        let program = Arc::new(link(&view)?);
        // One sequence for all samples: its points are spread best, and nobody asks for the error.
        let effort = Effort { replicates: 1, ..Effort::new(SAMPLES, 1) };
        let rendered = render(
            &mut self.executor,
            &mut self.stage,
            &program,
            &[brdf, &self.integrator],
            effort,
            HEADLESS_BUDGET,
            &mut |_| Wish::GoOn,
        )?;
        let mut notes = rendered.notes;
        match rendered.film.nonfinite() {
            0 => {}
            n => notes
                .push(format!("{n} non-finite samples, counted as zero: the sphere is too dark")),
        }
        let resolution = [SIDE * FINER; 2];
        let points = &self.coverage.points;
        let picture = Picture::compose(resolution, points, &rendered.film, &self.background);
        Ok((Raster::reduced(&picture, Tone::exposed(STOPS), FINER), notes))
    }
}
