//! f over the half and the difference angle, as BRDF Explorer's image slice shows it.

use brdf_sdk::Result;
use brdf_sdk::native::directions::HalfDifference;

use super::Subject;
use crate::render::evaluate::Pair;

/// Which slice.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slice {
    /// Azimuth of `wi` about the half vector [degrees].
    pub phi_d: f64,
    /// Whether columns are even in the square root of theta_h, which widens what lies about the mirror direction.
    pub square: bool,
    /// Pixels along both angles.
    pub size: usize,
}

impl Slice {
    /// theta_h and theta_d in the middle of a pixel [degrees]; rows go up.
    pub fn angles(&self, column: usize, row: usize) -> [f64; 2] {
        let part = |i: usize| (i as f64 + 0.5) / self.size as f64;
        let x = part(column);
        [90.0 * if self.square { x * x } else { x }, 90.0 * part(row)]
    }

    /// f [1/sr] of every pixel, row by row from theta_d = 0 up; NaN where nothing is seen.
    ///
    /// # Errors
    /// What the plugin does that ends a program.
    pub fn values(&self, subject: &mut Subject<'_>) -> Result<Vec<[f64; 3]>> {
        let pixels = (0..self.size).flat_map(|row| (0..self.size).map(move |column| [column, row]));
        let pairs: Vec<Pair> = pixels
            .map(|[column, row]| {
                let [theta_h, theta_d] = self.angles(column, row).map(f64::to_radians);
                let phi_d = self.phi_d.to_radians();
                let (wo, wi) = HalfDifference { theta_h, phi_h: 0.0, theta_d, phi_d }.directions();
                Pair::new(wo, wi)
            })
            .collect();
        let found = subject.scattered(&pairs)?;
        let value =
            |(pair, f): (&Pair, [f64; 3])| if pair.is_above_horizon() { f } else { [f64::NAN; 3] };
        Ok(pairs.iter().zip(found.iter().map(|found| found.f)).map(value).collect())
    }
}

/// A colour over its largest channel: what is left of it without its brightness.
pub fn chroma(rgb: [f64; 3]) -> [f64; 3] {
    let largest = rgb.iter().copied().fold(0.0, f64::max);
    if largest > 0.0 { rgb.map(|c| c / largest) } else { rgb }
}
