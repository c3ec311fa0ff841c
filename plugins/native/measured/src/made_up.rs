//! Materials that are made up, for where no file is named: a coat over a coloured base.
//!
//! A formula in f64 that the formats tabulate; it is no plugin, and nobody's measurement.

use std::f64::consts::PI;

use brdf_sdk::native::directions::{Vec3, dot};

/// A lacquer: Lambert below a GGX lobe whose Fresnel factor is Schlick's.
#[derive(Debug, Clone, Copy)]
pub struct Lacquer {
    /// Widths of the lobe along tangent and bitangent.
    pub alpha: [f64; 2],
    /// Colour of the base, linear Rec. 709.
    pub base: [f64; 3],
    /// Reflectance of the coat at normal incidence, linear Rec. 709.
    pub coat: [f64; 3],
}

impl Lacquer {
    /// f_r [1/sr] of two directions above the horizon; it is symmetric in them.
    ///
    /// GGX with uncorrelated Smith masking: Walter et al. 2007, equations 20, 33, 34.
    pub fn f(&self, wo: Vec3, wi: Vec3) -> [f64; 3] {
        if wo[2] <= 0.0 || wi[2] <= 0.0 {
            return [0.0; 3];
        }
        let sum = [0, 1, 2].map(|i| wo[i] + wi[i]);
        let length = dot(sum, sum).sqrt();
        let h = sum.map(|c| c / length);
        let [ax, ay] = self.alpha;
        let q = (h[0] / ax).powi(2) + (h[1] / ay).powi(2) + h[2] * h[2];
        let d = 1.0 / (PI * ax * ay * q * q);
        let g1 = |w: Vec3| {
            let slope = ((ax * w[0]).powi(2) + (ay * w[1]).powi(2)) / (w[2] * w[2]);
            2.0 / (1.0 + (1.0 + slope).sqrt())
        };
        let lobe = d * g1(wo) * g1(wi) / (4.0 * wo[2] * wi[2]);
        let grazing = (1.0 - dot(wo, h)).clamp(0.0, 1.0).powi(5);
        // What the coat lets through, both ways: the base never gives more than it is given.
        let through =
            |w: Vec3, c: usize| (1.0 - self.coat[c]) * (1.0 - (1.0 - w[2]).clamp(0.0, 1.0).powi(5));
        [0, 1, 2].map(|c| {
            let fresnel = self.coat[c] + (1.0 - self.coat[c]) * grazing;
            fresnel * lobe + self.base[c] / PI * through(wo, c) * through(wi, c)
        })
    }
}
