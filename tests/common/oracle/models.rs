//! The BRDFs in f64, in the textbook form of their papers; parameters as the plugins name them.

use std::f64::consts::PI;

use glam::DVec3;

/// A BRDF with its parameters; directions are local, z the normal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Model {
    /// Lambert 1760.
    Lambert { albedo: [f64; 3] },
    /// Walter et al. 2007 with the joint masking-shadowing of Heitz 2014 and the Fresnel term of Schlick 1994.
    Ggx { alpha: [f64; 2], f0: [f64; 3], separable: bool },
    /// Lafortune and Willems 1994.
    ModifiedPhong { kd: [f64; 3], ks: [f64; 3], n: f64 },
}

impl Model {
    /// GGX of one width, height-correlated.
    pub fn ggx(alpha: f64, f0: [f64; 3]) -> Self {
        Self::Ggx { alpha: [alpha; 2], f0, separable: false }
    }

    /// f_r times the cosine of `wi` [1/sr]; zero at and below the horizon.
    pub fn cosine_weighted(&self, wo: DVec3, wi: DVec3) -> [f64; 3] {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return [0.0; 3];
        }
        match *self {
            Self::Lambert { albedo } => albedo.map(|a| a / PI * wi.z),
            Self::Ggx { alpha, f0, separable } => {
                let h = (wo + wi).normalize();
                let shadowing = if separable {
                    1.0 / ((1.0 + lambda(wo, alpha)) * (1.0 + lambda(wi, alpha)))
                } else {
                    1.0 / (1.0 + lambda(wo, alpha) + lambda(wi, alpha))
                };
                let scalar = distribution(h, alpha) * shadowing / (4.0 * wo.z * wi.z) * wi.z;
                let falloff = (1.0 - wi.dot(h)).powi(5);
                f0.map(|f0| (f0 + (1.0 - f0) * falloff) * scalar)
            }
            Self::ModifiedPhong { kd, ks, n } => {
                let mirror = DVec3::new(-wo.x, -wo.y, wo.z);
                let lobe = (n + 2.0) / (2.0 * PI) * mirror.dot(wi).max(0.0).powf(n);
                std::array::from_fn(|c| (kd[c] / PI + ks[c] * lobe) * wi.z)
            }
        }
    }

    /// How far from the mirror direction of `wo` the BRDF changes by its own order [radians], at
    /// its narrowest; nothing where it has no lobe there.
    pub fn lobe_width(&self, wo: DVec3) -> Option<f64> {
        match *self {
            Self::Lambert { .. } => None,
            // A half vector that turns by alpha turns the reflected direction by 2 alpha in the
            // plane of incidence and by 2 alpha cos(wo) across it.
            Self::Ggx { alpha: [x, y], .. } => Some(2.0 * x.min(y) * wo.z.max(x.min(y))),
            Self::ModifiedPhong { n, .. } => Some(1.0 / n.sqrt()),
        }
    }
}

/// D of an anisotropic GGX surface, Heitz 2014 eq. 85 [1/sr].
pub fn distribution(h: DVec3, [alpha_x, alpha_y]: [f64; 2]) -> f64 {
    let (cos2, tan_x, tan_y) = (h.z * h.z, h.x / h.z, h.y / h.z);
    let slope = (tan_x / alpha_x).powi(2) + (tan_y / alpha_y).powi(2);
    1.0 / (PI * alpha_x * alpha_y * cos2 * cos2 * (1.0 + slope).powi(2))
}

/// Lambda of Smith's masking function, Heitz 2014 eq. 72 and 86: a = 1 / (alpha_o tan(theta)).
pub fn lambda(w: DVec3, [alpha_x, alpha_y]: [f64; 2]) -> f64 {
    let inverse_a2 = ((w.x * alpha_x).powi(2) + (w.y * alpha_y).powi(2)) / (w.z * w.z);
    0.5 * ((1.0 + inverse_a2).sqrt() - 1.0)
}
