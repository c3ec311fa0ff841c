//! Values over all directions of `wo`, against a fixed `wi`: what a three-dimensional plot shows.

use std::f64::consts::{PI, TAU};

use brdf_sdk::Result;

use super::{Angles, Quantity, Subject};
use crate::render::evaluate::Pair;

/// Directions of `wo` in rings about the mirror direction of `wi`, where most BRDFs are sharpest: rings lie closer
/// there.
#[derive(Debug, Clone, PartialEq)]
pub struct Hemisphere {
    /// Rings, the mirror direction's own point first.
    pub rings: usize,
    /// Directions of a ring.
    pub around: usize,
    /// Unit directions, ring by ring; those below the horizon lie on it.
    pub directions: Vec<[f64; 3]>,
    /// The quantity there; 0 where it cannot be drawn.
    pub values: Vec<f64>,
}

/// Just above the horizon.
const LOWEST: f64 = 1e-3;

impl Hemisphere {
    /// Asks for the values.
    ///
    /// # Errors
    /// What the plugin does that ends a program.
    pub fn new(
        subject: &mut Subject<'_>,
        wi: Angles,
        quantity: Quantity,
        [rings, around]: [usize; 2],
    ) -> Result<Self> {
        let pole = Angles { theta: wi.theta, phi: wi.phi + 180.0 }.direction();
        let directions = directions(pole, rings, around);
        let wi = wi.direction();
        let pairs: Vec<Pair> = directions.iter().map(|wo| Pair::new(*wo, wi)).collect();
        let mut values = subject.values(quantity, &pairs)?;
        values.iter_mut().filter(|value| !value.is_finite()).for_each(|value| *value = 0.0);
        Ok(Self { rings, around, directions, values })
    }
}

/// The density of `sample` at the same directions, of the viewer's direction `wo`: points whose distance from the
/// origin is the density over its largest value. None where it is 0 everywhere.
///
/// # Errors
/// What the plugin does that ends a program.
pub fn density(
    subject: &mut Subject<'_>,
    wo: Angles,
    [rings, around]: [usize; 2],
) -> Result<Vec<[f64; 3]>> {
    let pole = Angles { theta: wo.theta, phi: wo.phi + 180.0 }.direction();
    let directions = directions(pole, rings, around);
    let wo = wo.direction();
    let pairs: Vec<Pair> = directions.iter().map(|wi| Pair::new(wo, *wi)).collect();
    let found = subject.scattered(&pairs)?;
    let densities = found.iter().map(|found| found.pdf);
    let largest = densities.clone().filter(|pdf| pdf.is_finite()).fold(0.0, f64::max);
    let placed = std::iter::zip(&directions, densities)
        .filter(|(_, pdf)| pdf.is_finite() && *pdf > 0.0)
        .map(|(to, pdf)| to.map(|c| c * pdf / largest));
    Ok(placed.collect())
}

/// Rings about `pole` out to half a turn from it. What falls below the horizon is moved along its circle of longitude
/// up to the horizon, so that the surface ends there.
fn directions(pole: [f64; 3], rings: usize, around: usize) -> Vec<[f64; 3]> {
    let across = pole[0].hypot(pole[1]);
    let [ax, ay] = if across > 1e-9 { [pole[0] / across, pole[1] / across] } else { [1.0, 0.0] };
    // Two axes at right angles to the pole.
    let (x, y) = ([ax * pole[2], ay * pole[2], -across], [-ay, ax, 0.0]);
    let mut directions = Vec::with_capacity(rings * around);
    for ring in 0..rings {
        let part = ring as f64 / (rings - 1) as f64;
        // Dense at the pole: a quarter of the rings lies within 6 degrees of it. The antipode has no longitude to be
        // moved along, so the last ring stays a little before it.
        let theta = (PI - 1e-6) * (0.7 * part * part * part + 0.3 * part * part);
        for step in 0..around {
            let (sine, cosine) = (step as f64 * TAU / around as f64).sin_cos();
            let [s, c] = [theta.sin(), theta.cos()];
            let w = [0, 1, 2].map(|i| c * pole[i] + s * (cosine * x[i] + sine * y[i]));
            directions.push(raised(w));
        }
    }
    directions
}

/// A direction, or the nearest one just above the horizon.
fn raised(w: [f64; 3]) -> [f64; 3] {
    if w[2] >= LOWEST {
        return w;
    }
    let across = w[0].hypot(w[1]).max(1e-12);
    let scale = (1.0 - LOWEST * LOWEST).sqrt() / across;
    [w[0] * scale, w[1] * scale, LOWEST]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_are_units_above_the_horizon_and_begin_at_the_mirror() {
        for theta in [0.0, 45.0, 89.0] {
            let pole = Angles { theta, phi: 200.0 }.direction();
            let found = directions(pole, 9, 12);
            assert!((0..3).all(|i| (found[0][i] - raised(pole)[i]).abs() < 1e-12));
            for w in found {
                let length = w.iter().map(|c| c * c).sum::<f64>();
                assert!((length - 1.0).abs() < 1e-9 && w[2] >= LOWEST - 1e-12, "{w:?}");
            }
        }
    }
}
