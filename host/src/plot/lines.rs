//! Values along a line of directions.

use brdf_sdk::Result;
use brdf_sdk::native::directions::HalfDifference;

use super::trace::trace;
use super::{Angles, Quantity, Subject};
use crate::render::evaluate::Pair;

/// A line of direction pairs, by one angle that moves [degrees].
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Line {
    /// `wo` from horizon to horizon in a plane through the normal, against a fixed `wi`. Positive angles lie at the
    /// azimuth `phi`.
    Viewer {
        /// The fixed direction.
        wi: Angles,
        /// The plane's azimuth [degrees].
        phi: f64,
    },
    /// The half vector from the normal to the horizon, towards the tangent, at a fixed difference.
    Half {
        /// From the half vector to either direction [degrees].
        theta_d: f64,
        /// Azimuth of `wi` about the half vector [degrees].
        phi_d: f64,
    },
    /// The difference from 0 to a quarter of the turn, at a fixed half vector towards the tangent.
    Difference {
        /// From the normal to the half vector [degrees].
        theta_h: f64,
        /// Azimuth of `wi` about the half vector [degrees].
        phi_d: f64,
    },
}

/// The angles that are looked at first lie so far apart [degrees].
const STEP: f64 = 0.25;

/// What lies closer to the horizon is left out: some models have no limit there [degrees].
const MARGIN: f64 = 0.1;

impl Line {
    /// The range of the angle that moves [degrees].
    pub fn range(&self) -> [f64; 2] {
        match self {
            Self::Viewer { .. } => [-90.0, 90.0],
            Self::Half { .. } | Self::Difference { .. } => [0.0, 90.0],
        }
    }

    /// The directions at an angle; either may lie below the horizon.
    pub fn pair(&self, angle: f64) -> Pair {
        let by_half = |theta_h: f64, theta_d: f64, phi_d: f64| {
            let [theta_h, theta_d, phi_d] = [theta_h, theta_d, phi_d].map(f64::to_radians);
            let (wo, wi) = HalfDifference { theta_h, phi_h: 0.0, theta_d, phi_d }.directions();
            Pair::new(wo, wi)
        };
        match *self {
            Self::Viewer { wi, phi } => {
                Pair::new(Angles { theta: angle, phi }.direction(), wi.direction())
            }
            Self::Half { theta_d, phi_d } => by_half(angle, theta_d, phi_d),
            Self::Difference { theta_h, phi_d } => by_half(theta_h, angle, phi_d),
        }
    }

    /// Angles at equal steps, and those at which models are sharp.
    fn first_angles(&self) -> Vec<f64> {
        let [low, high] = self.range();
        let low = if low < 0.0 { low + MARGIN } else { low };
        let high = high - MARGIN;
        let count = ((high - low) / STEP).round() as usize;
        let at = |i: usize| low + (high - low) * i as f64 / count as f64;
        let mut angles: Vec<f64> = (0..=count).map(at).collect();
        if let Self::Viewer { wi, .. } = self {
            angles.extend(
                [-wi.theta, 0.0, wi.theta].into_iter().filter(|a| (low..=high).contains(a)),
            );
        }
        angles.sort_by(f64::total_cmp);
        angles.dedup();
        angles
    }
}

/// The angle [degrees] and the quantity there, closely enough for any drawing in which a value's height is
/// `height(value, largest)`, in parts of the drawing. NaN where nothing is seen.
///
/// # Errors
/// What the plugin does that ends a program.
pub fn curve(
    subject: &mut Subject<'_>,
    line: Line,
    quantity: Quantity,
    height: &dyn Fn(f64, f64) -> f64,
) -> Result<Vec<[f64; 2]>> {
    let [low, high] = line.range();
    let drawn =
        |angle: f64, value: f64, peak: f64| [(angle - low) / (high - low), height(value, peak)];
    trace(line.first_angles(), &drawn, &mut |angles| {
        let pairs: Vec<Pair> = angles.iter().map(|angle| line.pair(*angle)).collect();
        subject.values(quantity, &pairs)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
        (0..3).map(|i| a[i] * b[i]).sum()
    }

    /// At the mirror angle `wo` is `wi` turned about the normal, and angles between directions are those asked for.
    #[test]
    fn directions_lie_where_the_angles_say() {
        let wi = Angles { theta: 40.0, phi: 30.0 };
        let mirror = Line::Viewer { wi, phi: 210.0 }.pair(40.0);
        assert!((mirror.wo[0] + mirror.wi[0]).abs() < 1e-6);
        assert!((mirror.wo[1] + mirror.wi[1]).abs() < 1e-6);
        assert!((mirror.wo[2] - mirror.wi[2]).abs() < 1e-6);
        for line in [
            Line::Half { theta_d: 25.0, phi_d: 90.0 },
            Line::Difference { theta_h: 25.0, phi_d: 90.0 },
        ] {
            let pair = line.pair(25.0);
            let across = 2.0 * 25f32.to_radians();
            assert!((dot(pair.wo, pair.wi) - across.cos()).abs() < 1e-6);
            let half = [0, 1, 2].map(|i| pair.wo[i] + pair.wi[i]);
            let cosine = half[2] / dot(half, half).sqrt();
            assert!((cosine - 25f32.to_radians().cos()).abs() < 1e-6);
            assert!(half[0] > 0.0 && half[1].abs() < 1e-6);
        }
    }

    #[test]
    fn the_first_angles_hold_the_mirror_and_keep_off_the_horizon() {
        let wi = Angles { theta: 33.33, phi: 0.0 };
        let angles = Line::Viewer { wi, phi: 180.0 }.first_angles();
        assert!(angles.contains(&33.33) && angles.contains(&-33.33));
        assert!(angles.iter().all(|angle| angle.abs() < 90.0));
    }
}
