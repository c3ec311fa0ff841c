//! Whether albedos that a BRDF's own sampling gives are those that a sum over directions finds: where `pdf` does not fit
//! `sample`, a picture is wrong by a factor, and no error that samples estimate of themselves shows it.
//!
//! It tells where an albedo is looked at anyway; the laws of sampling and of means prove it.

use brdf_sdk::Result;
use brdf_sdk::native::directions::direction;

use super::survey::Surveyor;
use crate::exec::Executor;
use crate::link::{Sampling, sampling};
use crate::plugin::Configured;
use crate::render::albedo::Albedo;

/// Relative error of the sum.
const EXACT: f64 = 1e-4;
/// What samples may be off by: so many of their standard errors, and a part of the albedo for f32 and the sum.
const MOST: f64 = 6.0;
const FLOOR: f64 = 2e-3;

/// One sentence on the angle at which the two are farthest apart, where they are.
///
/// # Errors
/// What linking and running report.
pub fn doubt(
    executor: &mut dyn Executor,
    brdf: &Configured,
    azimuth: f64,
    rows: &[Albedo],
) -> Result<Option<String>> {
    if sampling(brdf)? != Sampling::Own {
        return Ok(None);
    }
    let wo = |row: &Albedo| direction(row.theta.to_radians(), azimuth.to_radians());
    let views: Vec<[f32; 3]> = rows.iter().map(|row| wo(row).map(|part| part as f32)).collect();
    let mut surveyor = Surveyor::new(executor, brdf)?;
    let sums = surveyor.albedos(executor, brdf, &views, EXACT);
    surveyor.free(executor);
    let mut worst: Option<(f64, String)> = None;
    for (row, sum) in rows.iter().zip(sums?).filter(|(_, sum)| sum.broken.is_none()) {
        for (channel, exact) in sum.total().light.into_iter().enumerate() {
            let (drawn, error) = (row.albedo[channel], row.std_error[channel]);
            let excess = (drawn - exact).abs() / (MOST * error + FLOOR * exact + 1e-6);
            if excess > 1.0 && worst.as_ref().is_none_or(|(most, _)| excess > *most) {
                let said = format!(
                    "{}: at {} degrees its own sampling gives {drawn:.4}, and a sum over directions {exact:.4}: \
                     `pdf` does not fit `sample`, `brdf conform` tells more",
                    brdf.plugin.id, row.theta
                );
                worst = Some((excess, said));
            }
        }
    }
    Ok(worst.map(|(_, said)| said))
}
