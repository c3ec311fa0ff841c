//! Directions in f64, and half and difference angles (Rusinkiewicz 1998).
//!
//! For libraries that bring data into the host's local frame, z the normal. No general vector algebra: what two
//! formats need of it, and nothing of the standard library's beyond.

use std::f64::consts::{PI, TAU};

/// A vector; directions are unit vectors in the local frame, z the normal.
pub type Vec3 = [f64; 3];

/// The dot product.
pub fn dot(a: Vec3, b: Vec3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The direction at an angle from the normal and an azimuth [radians].
pub fn direction(theta: f64, phi: f64) -> Vec3 {
    let (sine, cosine) = theta.sin_cos();
    [sine * phi.cos(), sine * phi.sin(), cosine]
}

/// `wo` mirrored about `h`.
pub fn mirrored(wo: Vec3, h: Vec3) -> Vec3 {
    let twice = 2.0 * dot(wo, h);
    [0, 1, 2].map(|i| twice * h[i] - wo[i])
}

/// Half and difference angles [radians].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HalfDifference {
    /// From the normal to the half vector.
    pub theta_h: f64,
    /// Azimuth of the half vector, which isotropic materials do not depend on.
    pub phi_h: f64,
    /// From the half vector to either direction.
    pub theta_d: f64,
    /// Azimuth of `wi` about the half vector, from where theta_h grows, in [0, 2 pi); exchanging the directions
    /// adds half a turn.
    pub phi_d: f64,
}

impl HalfDifference {
    /// The angles of two directions.
    pub fn of(wo: Vec3, wi: Vec3) -> Self {
        let h = [0, 1, 2].map(|i| wo[i] + wi[i]);
        let d = [0, 1, 2].map(|i| wi[i] - wo[i]);
        let across = h[0].hypot(h[1]);
        let theta_h = across.atan2(h[2]);
        let phi_h = if across > 0.0 { h[1].atan2(h[0]) } else { 0.0 };
        let (sine_h, cosine_h) = theta_h.sin_cos();
        let (sine_p, cosine_p) = phi_h.sin_cos();
        let x = dot(d, [cosine_h * cosine_p, cosine_h * sine_p, -sine_h]);
        let y = dot(d, [-sine_p, cosine_p, 0.0]);
        let phi = y.atan2(x);
        Self {
            theta_h,
            phi_h,
            theta_d: dot(d, d).sqrt().atan2(dot(h, h).sqrt()),
            phi_d: if phi < 0.0 { phi + TAU } else { phi },
        }
    }

    /// The two directions, `wo` and `wi`; either may lie below the horizon.
    pub fn directions(&self) -> (Vec3, Vec3) {
        let turned = |phi_d: f64| {
            let [x, y, z] = direction(self.theta_d, phi_d);
            let (sine_h, cosine_h) = self.theta_h.sin_cos();
            let (sine_p, cosine_p) = self.phi_h.sin_cos();
            let along = x * cosine_h + z * sine_h;
            [
                along * cosine_p - y * sine_p,
                along * sine_p + y * cosine_p,
                z * cosine_h - x * sine_h,
            ]
        };
        (turned(self.phi_d + PI), turned(self.phi_d))
    }
}
