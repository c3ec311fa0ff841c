//! A satin that is made up, in the tables of such a file.
//!
//! Tables as `parse` gives them, not bytes: reading a file is not tried by it.

use std::f64::consts::{FRAC_PI_2, PI};

use brdf_sdk::native::directions::{direction, dot, mirrored};

use super::warp::Warps;
use super::{Material, Table};
use crate::LUMINANCE;
use crate::made_up::Lacquer;

const THETAS: usize = 8;
const NORMALS: usize = 64;
const LIGHT: usize = 32;
const ALPHA: f64 = 0.3;

/// GGX's distribution of normals.
fn ndf(cosine: f64) -> f64 {
    let q = (1.0 - cosine * cosine) / (ALPHA * ALPHA) + cosine * cosine;
    1.0 / (PI * ALPHA * ALPHA * q * q)
}

/// The normal at u: theta goes with the square, phi once around.
fn normal(u: [f64; 2]) -> [f64; 3] {
    direction(u[0] * u[0] * FRAC_PI_2, (2.0 * u[1] - 1.0) * PI)
}

/// An isotropic champagne satin.
pub fn satin() -> Material {
    let lacquer = Lacquer { alpha: [ALPHA; 2], base: [0.3, 0.2, 0.1], coat: [0.5, 0.42, 0.3] };
    let part = |i: usize, count: usize| i as f64 / (count - 1) as f64;
    let theta: Vec<f64> = (0..THETAS).map(|i| part(i, THETAS) * FRAC_PI_2).collect();
    // At the horizon itself nothing is seen.
    let viewer = |theta: f64| direction(theta.min(89.5f64.to_radians()), 0.0);
    let square = |count: usize| {
        (0..count * count).map(move |i| [part(i % count, count), part(i / count, count)])
    };

    let visible = theta.iter().flat_map(|theta| {
        let wo = viewer(*theta);
        square(NORMALS).map(move |u| {
            let m = normal(u);
            let across = m[0].hypot(m[1]);
            (ndf(m[2]) * dot(wo, m).max(0.0) * u[0] * across) as f32
        })
    });
    let normals = Warps::new([NORMALS; 2], &visible.collect::<Vec<_>>());

    let mut colours = Vec::new();
    let mut light = Vec::new();
    for (slice, theta) in theta.iter().enumerate() {
        let wo = viewer(*theta);
        for s in square(LIGHT) {
            let m = normal(normals.draw(slice, s));
            let wi = mirrored(wo, m);
            // f cos = rgb ndf / (4 sigma), with sigma = 1.
            let rgb = lacquer.f(wo, wi).map(|f| f * wi[2].max(0.0) * 4.0 / ndf(m[2]));
            colours.extend(rgb.map(|c| c as f32));
            light.push((0..3).map(|c| LUMINANCE[c] * rgb[c]).sum::<f64>() as f32);
        }
    }
    let distribution = (0..2 * NORMALS).map(|i| {
        let u = part(i % NORMALS, NORMALS);
        ndf((u * u * FRAC_PI_2).cos()) as f32
    });
    Material {
        theta: theta.iter().map(|theta| *theta as f32).collect(),
        phi: vec![0.0],
        normals,
        light: Warps::new([LIGHT; 2], &light),
        colours: Table { size: [LIGHT; 2], values: colours },
        ndf: Table { size: [2, NORMALS], values: distribution.collect() },
        sigma: Table { size: [2, 2], values: vec![1.0; 4] },
        jacobian: true,
        reduction: 1,
    }
}
