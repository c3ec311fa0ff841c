//! The law of the furnace: under light of radiance 1 from everywhere, every integrator shows the directional
//! albedo, at each pixel that of its own `wo`.

use std::sync::Arc;

use brdf_sdk::{Problem, Result};
use glam::DMat3;
use rayon::prelude::*;

use super::settings::options;
use super::survey::Surveyor;
use super::verdict::{Law, Outcome, Verdict};
use crate::environment::Environment;
use crate::exec::Executor;
use crate::link::{Sampler, View, link};
use crate::measure::student;
use crate::plugin::Configured;
use crate::render::{Effort, Film, HEADLESS_BUDGET, Progress, Stage, Wish, render};
use crate::scene::{Camera, Shape, cast};

/// Pixels along a side of the picture.
const SIDE: u32 = 12;
/// Texels of the furnace: in one that fills half of the sphere a sum over texels looks for narrow lobes long.
const MAP: [u32; 2] = [32, 16];
/// Samples a pixel.
const SAMPLES: u32 = 1024;
/// Relative error of the quadrature.
const EXACT: f64 = 1e-4;
/// What f32, quadrature and `convolution`'s own tolerance may put between the two.
const FLOOR: f64 = 1e-3;
/// The probability that integrators that are right are taken for wrong, over all pixels and channels.
const LEVEL: f64 = 0.01;

/// Judges it for all integrators.
pub fn judge(
    executor: &mut dyn Executor,
    brdf: &Configured,
    integrators: &[Configured],
) -> Result<Verdict> {
    let points = cast(&Camera::default(), &Shape::Sphere, [SIDE, SIDE]).points;
    let views: Vec<[f32; 3]> = points.iter().map(|point| point.wo).collect();
    let mut surveyor = Surveyor::new(executor, brdf)?;
    let found = surveyor.albedos(executor, brdf, &views, EXACT)?;
    surveyor.free(executor);
    if let Some(row) = found.iter().position(|integrals| integrals.broken.is_some()) {
        let said = "f is Inf or NaN where it is integrated";
        let at = format!("wo {}{}", row_of(views[row]), options(brdf));
        return Ok(Verdict::new(Law::Furnace, Outcome::Failed, said).shown_by(at));
    }
    let albedos: Vec<[f64; 3]> = found.iter().map(|integrals| integrals.total().light).collect();
    let tests = (points.len() * 3 * integrators.len().max(1)) as f64;
    let mut worst: Option<(f64, String, Option<String>)> = None;
    let mut told = Vec::new();
    let mut shown = 0;
    for integrator in integrators {
        let Some(film) = picture(executor, brdf, integrator, points.clone())? else {
            told.push(format!("{} looks at no environment", integrator.plugin.id));
            continue;
        };
        shown += 1;
        let seeds = (film.replicates() > 1).then(|| film.replicates() as u32 - 1);
        let quantile = seeds.map_or(0.0, |n| student::quantile(student::sidak(LEVEL, tests), n));
        let apart =
            (0..points.len()).into_par_iter().map(|row| excess(&film, row, albedos[row], quantile));
        let (row, (excess, channel)) =
            apart.enumerate().reduce(|| (0, (0.0, 0)), |a, b| if b.1.0 > a.1.0 { b } else { a });
        let id = &integrator.plugin.id;
        let seen = film.mean(row)[channel];
        let is = albedos[row][channel];
        let said = format!("{id} shows {seen:.5} where the albedo is {is:.5}");
        let reproduce = (excess > 1.0)
            .then(|| format!("wo {}{} under {id}", row_of(views[row]), options(brdf)));
        if worst.as_ref().is_none_or(|(most, ..)| excess > *most) {
            worst = Some((excess, said, reproduce));
        }
    }
    let Some((excess, said, reproduce)) = worst else {
        return Ok(Verdict::new(Law::Furnace, Outcome::Skipped, "there is no integrator"));
    };
    let outcome = super::verdict::outcome(excess <= 1.0);
    let said = match outcome {
        Outcome::Passed => {
            format!("{shown} integrators show the albedo at {} pixels", points.len())
        }
        _ => said,
    };
    let cases = points.len() * 3 * shown;
    let verdict = Verdict::new(Law::Furnace, outcome, said).with(excess, 1.0, cases);
    Ok(Verdict { reproduce, notes: told, ..verdict })
}

fn row_of(w: [f32; 3]) -> String {
    w.map(|c| c.to_string()).join(" ")
}

/// How far a pixel is from its albedo in units of what is allowed, and the channel.
fn excess(film: &Film, row: usize, albedo: [f64; 3], quantile: f64) -> (f64, usize) {
    let mean = film.mean(row);
    let errors = film.variance_of_mean(row).unwrap_or_default().map(f64::sqrt);
    let each = (0..3).map(|channel| {
        let allowed = (quantile * errors[channel]).max(FLOOR * albedo[channel].max(1e-6));
        let off = (mean[channel] - albedo[channel]).abs();
        (if off.is_finite() { off / allowed } else { f64::INFINITY }, channel)
    });
    each.fold((0.0, 0), |worst, one| if one.0 > worst.0 { one } else { worst })
}

/// The sphere in the furnace; `None` where the integrator does not look at the environment.
fn picture(
    executor: &mut dyn Executor,
    brdf: &Configured,
    integrator: &Configured,
    points: Vec<crate::scene::ShadingPoint>,
) -> Result<Option<Film>> {
    let [width, height] = MAP;
    let texels = Arc::new(vec![[1.0, 1.0, 1.0, 0.0]; (width * height) as usize]);
    let furnace = Arc::new(Environment { width, height, texels, ..Environment::constant(1.0) });
    let mut stage = Stage::new(points, furnace, DMat3::IDENTITY);
    let form = stage.form(Sampler::OwenSobol);
    let view = View::Film { brdf: brdf.clone(), integrator: integrator.clone(), form };
    let program = Arc::new(link(&view)?);
    if !program.binds("env_map") {
        return Ok(None);
    }
    let plugins = [brdf, integrator];
    let effort = Effort::new(SAMPLES, 1);
    let mut go_on = |_: Progress<'_>| Wish::GoOn;
    let rendered =
        render(executor, &mut stage, &program, &plugins, effort, HEADLESS_BUDGET, &mut go_on)?;
    stage.unload(executor);
    if rendered.film.nonfinite() > 0 {
        return Err(Problem::new(
            &brdf.plugin.id,
            format!(
                "{} samples of {} are Inf or NaN",
                rendered.film.nonfinite(),
                integrator.plugin.id
            ),
            "look at the law `finite`",
        ));
    }
    Ok(Some(rendered.film))
}
