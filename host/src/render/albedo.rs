//! Directional albedo: the share of light from everywhere that leaves towards one direction.
//!
//! It is what a flat surface shows in a furnace of radiance 1, so it is rendered as just that, by the
//! one render loop: a shading point for each angle, and importance sampling of the BRDF.

use std::sync::Arc;

use brdf_sdk::Result;
use brdf_sdk::native::directions::direction;
use glam::DMat3;

use super::{Effort, HEADLESS_BUDGET, Progress, Stage, Wish, render};
use crate::environment::Environment;
use crate::exec::Executor;
use crate::link::{Sampler, View, link};
use crate::plugin::Configured;
use crate::scene::flat_points;

/// Angles of a table where nobody names others [degrees].
pub const ANGLES: [f64; 20] = [
    0.0, 10.0, 20.0, 30.0, 40.0, 45.0, 50.0, 55.0, 60.0, 65.0, 70.0, 75.0, 80.0, 82.5, 85.0, 87.0,
    88.0, 89.0, 89.5, 89.9,
];

/// The directional albedo at one angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Albedo {
    /// Angle between `wo` and the normal [degrees].
    pub theta: f64,
    /// Share of the light reflected, per channel.
    pub albedo: [f64; 3],
    /// Its standard error, per channel.
    pub std_error: [f64; 3],
}

/// A table of directional albedos.
#[derive(Debug, Clone, PartialEq)]
pub struct AlbedoTable {
    /// One row an angle.
    pub rows: Vec<Albedo>,
    /// What is worth telling the user once.
    pub notes: Vec<String>,
}

/// Estimates the directional albedo at each angle [degrees, below 90] with `wo` at `azimuth`
/// [degrees] from the tangent.
pub fn directional_albedo(
    executor: &mut dyn Executor,
    brdf: &Configured,
    integrator: &Configured,
    angles: &[f64],
    azimuth: f64,
    effort: Effort,
) -> Result<AlbedoTable> {
    let azimuth = azimuth.to_radians();
    let views: Vec<[f64; 3]> =
        angles.iter().map(|angle| direction(angle.to_radians(), azimuth)).collect();
    let furnace = Arc::new(Environment::constant(1.0));
    let mut stage = Stage::new(flat_points(&views), furnace, DMat3::IDENTITY);
    let form = stage.form(Sampler::OwenSobol);
    let view = View::Film { brdf: brdf.clone(), integrator: integrator.clone(), form };
    let program = Arc::new(link(&view)?);
    let plugins = [brdf, integrator];
    let mut go_on = |_: Progress<'_>| Wish::GoOn;
    let rendered =
        render(executor, &mut stage, &program, &plugins, effort, HEADLESS_BUDGET, &mut go_on)?;
    stage.unload(executor);
    let rows = angles
        .iter()
        .enumerate()
        .map(|(row, theta)| Albedo {
            theta: *theta,
            albedo: rendered.film.mean(row),
            std_error: rendered.film.variance_of_mean(row).unwrap_or_default().map(f64::sqrt),
        })
        .collect();
    let mut notes = program.notes.clone();
    notes.extend(rendered.notes);
    if rendered.film.nonfinite() > 0 {
        notes.push(format!(
            "{} non-finite samples, counted as zero: the table is too dark",
            rendered.film.nonfinite()
        ));
    }
    Ok(AlbedoTable { rows, notes })
}
