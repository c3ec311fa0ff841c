//! How far a film is from a reference, in all the ways that are told.

use serde::{Deserialize, Serialize};

use super::case::{Opened, radiance};
use crate::measure::compare::flip::{PIXELS_PER_DEGREE, flip};
use crate::measure::compare::{finite, mean, relative, relative_eps, squared};
use crate::render::{Estimate, Film, estimate};

/// Errors of one film.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Errors {
    /// Mean over covered pixels and channels of the squared difference.
    #[serde(with = "number")]
    pub mse: f64,
    /// The same relative to the reference: (x - r)^2 / (r^2 + eps).
    #[serde(with = "number")]
    pub relmse: f64,
    /// How far the mean of the picture lies above that of the reference.
    #[serde(with = "number")]
    pub bias: f64,
    /// Standard error of that mean, from the spread of the replicates; a sum over texels has none.
    pub bias_std_error: Option<f64>,
    /// Mean of FLIP over the picture as the scene's exposure and curve show it, its background black.
    #[serde(with = "number")]
    pub flip: f64,
    /// The relMSE that the film estimates of itself.
    pub estimate: Option<f64>,
    /// Samples that were Inf or NaN.
    pub nonfinite: u64,
}

/// What a film shows at one moment: enough to tell its errors from later, while the device goes on. A device that
/// waits lowers its clocks.
pub(super) struct Look {
    rows: Vec<[f32; 3]>,
    own: Estimate,
    nonfinite: u64,
}

impl Look {
    pub(super) fn new(film: &Film) -> Self {
        Self { rows: radiance(film), own: estimate(film), nonfinite: film.nonfinite() }
    }
}

impl Errors {
    /// Of what a film of a case showed; `reference` has the same rows.
    pub(super) fn new(look: &Look, reference: &[[f32; 3]], opened: &Opened) -> Self {
        let Look { rows, own, nonfinite } = look;
        let counted = finite(rows, reference);
        let bright = |rgb: &[f32; 3]| rgb.iter().map(|c| f64::from(*c)).sum::<f64>() / 3.0;
        let average =
            |rows: &[[f32; 3]]| rows.iter().map(bright).sum::<f64>() / rows.len().max(1) as f64;
        Self {
            mse: mean(&squared(rows, reference), &counted),
            relmse: mean(&relative(rows, reference, relative_eps(reference, &counted)), &counted),
            bias: average(rows) - average(reference),
            bias_std_error: own.grey_std_error,
            flip: flip_of(rows, reference, opened),
            estimate: own.relmse,
            nonfinite: *nonfinite,
        }
    }
}

fn flip_of(rows: &[[f32; 3]], reference: &[[f32; 3]], opened: &Opened) -> f64 {
    let tone = opened.case.scene.film.tone;
    let light = |rgb: &[f32; 3]| rgb.map(|c| tone.light(c));
    let [shown, wanted] =
        [rows, reference].map(|rows| opened.in_picture(rows.iter().map(light), [0.0; 3]));
    let width = opened.case.scene.film.resolution[0] as usize;
    let errors = flip(&shown, &wanted, width, PIXELS_PER_DEGREE);
    errors.iter().sum::<f64>() / errors.len().max(1) as f64
}

/// A number that JSON has no word for is null there, and comes back as NaN.
mod number {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    #[allow(clippy::trivially_copy_pass_by_ref, reason = "serde calls it so")]
    pub(super) fn serialize<S: Serializer>(value: &f64, to: S) -> Result<S::Ok, S::Error> {
        value.is_finite().then_some(*value).serialize(to)
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
        Ok(Option::deserialize(from)?.unwrap_or(f64::NAN))
    }
}
