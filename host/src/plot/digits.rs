//! How many digits f keeps, over the angles of both directions.

use brdf_sdk::Result;

use super::{Angles, Subject};
use crate::exec::Precision;
use crate::exec::cpu::Cpu;
use crate::link::Function;
use crate::numerics::error;
use crate::plugin::Configured;
use crate::render::evaluate::Pair;

/// The middle of a cell along an axis of [`digits`], of `angles` cells [degrees].
pub fn angle(index: usize, angles: usize) -> f64 {
    90.0 * (index as f64 + 0.5) / angles as f64
}

/// The largest error of f in f32 against f64, relative, over `azimuths` azimuths: for each theta_i, from 0 up, a row
/// of `angles` values of theta_o. Both run on the cores.
///
/// # Errors
/// What is wrong with the plugin.
pub fn digits(brdf: &Configured, angles: usize, azimuths: usize) -> Result<Vec<f64>> {
    let mut pairs: Vec<Pair> = Vec::with_capacity(angles * angles * azimuths);
    for (row, column) in (0..angles).flat_map(|row| (0..angles).map(move |column| (row, column))) {
        let wo = Angles { theta: angle(column, angles), phi: 0.0 }.direction();
        pairs.extend((0..azimuths).map(|step| {
            let phi = 360.0 * step as f64 / azimuths as f64;
            Pair::new(wo, Angles { theta: angle(row, angles), phi }.direction())
        }));
    }
    let run = |precision| {
        let mut executor = Cpu::new(precision);
        Subject::new(&mut executor, brdf)?.scattered(&pairs)
    };
    let (low, high) = (run(Precision::F32)?, run(Precision::F64)?);
    let errors: Vec<f64> =
        low.iter().zip(&high).map(|(low, high)| error(Function::Eval, low.f, high.f)).collect();
    let largest = |errors: &[f64]| errors.iter().copied().fold(0.0, f64::max);
    Ok(errors.chunks(azimuths).map(largest).collect())
}
