//! Every model over a structured map, integrated once more in coordinates in which its lobe is flat:
//! half vectors drawn from D cos for GGX, powers of the cosine around the mirror direction for Phong,
//! the cosine around the normal for what is diffuse. Bright texels in a lobe's far tail count too and
//! are rarely drawn there, so the tail's uniform number is taken as q^4, with the density 4 q^3.
//! Nothing of the oracle's cells, horizon, cubature or models is used; radiance comes from the
//! definition, direction by direction.

use std::f64::consts::TAU;

use glam::{DMat3, DVec3};
use rayon::prelude::*;

use crate::oracle::{Filter, Layout, Map, Model, Oracle, Point};
use crate::random::Random;
use crate::{KINDS, point, structured};

/// A direction for a place of the unit square, and f cos / density there.
type Term<'a> = &'a dyn Fn(f64, f64) -> (DVec3, [f64; 3]);

/// The mean of `term` over the unit square, and its standard error: a jittered grid, 16 times.
fn flat(random: &mut Random, term: impl Fn(f64, f64) -> [f64; 3]) -> ([f64; 3], [f64; 3]) {
    const SIDE: usize = 160;
    const TIMES: usize = 16;
    let mut means = [[0.0; 3]; TIMES];
    for sum in &mut means {
        for cell in 0..SIDE * SIDE {
            let mut place = |i: usize| (i as f64 + random.unit()) / SIDE as f64;
            let value = term(place(cell % SIDE), place(cell / SIDE));
            (0..3).for_each(|c| sum[c] += value[c] / (SIDE * SIDE) as f64);
        }
    }
    let times = TIMES as f64;
    let mean = [0, 1, 2].map(|c| means.iter().map(|m| m[c]).sum::<f64>() / times);
    let error = [0, 1, 2].map(|c| {
        let squares: f64 = means.iter().map(|m| (m[c] - mean[c]).powi(2)).sum();
        (squares / (times - 1.0) / times).sqrt()
    });
    (mean, error)
}

fn around(r: f64, z: f64, phi: f64) -> DVec3 {
    DVec3::new(r * phi.cos(), r * phi.sin(), z)
}

/// One layout, filter and angle of view, model by model.
struct Comparison {
    map: Map,
    filter: Filter,
    oracle: Oracle,
    random: Random,
    /// The other integral's standard errors, relative.
    errors: Vec<f64>,
}

impl Comparison {
    fn new(layout: Layout, filter: Filter, seed: u64) -> Self {
        let map = structured(layout);
        let oracle = Oracle::new(&map, filter, DMat3::IDENTITY);
        Self { map, filter, oracle, random: Random::new(seed), errors: Vec::new() }
    }

    fn compare(&mut self, point: &Point, model: Model, term: Term<'_>) {
        let (map, filter) = (&self.map, self.filter);
        let light = |u: f64, v: f64| {
            let (wi, weight) = term(u, v);
            let radiance = map.radiance(point.world_from_local * wi, filter);
            [0, 1, 2].map(|c| if wi.z > 0.0 { weight[c] * radiance[c] } else { 0.0 })
        };
        let (expected, error) = flat(&mut self.random, light);
        let found = self.oracle.radiance(point, &model, 1e-6);
        for c in 0..3 {
            self.errors.push(error[c] / expected[c]);
            // Student's t with 15 degrees of freedom exceeds 6.5 with probability 1e-5.
            assert!(
                (found.radiance[c] - expected[c]).abs() < 6.5 * error[c] + 1e-6 * expected[c],
                "{:?} {filter:?} {model:?} {point:?}: {found:?} is not {expected:?} +- {error:?}",
                map.layout
            );
        }
    }

    /// Walter 2007 eq. 35 and 36: f cos / density = F G2 (wo.h) / (wo.z h.z).
    fn ggx(&mut self, theta: f64, alpha: [f64; 2], separable: bool) {
        let f0 = [1.0, 0.6, 0.04];
        let point = point(&mut self.random, theta);
        let wo = point.wo;
        let root = |w: DVec3| {
            let slope = [w.x * alpha[0] / w.z, w.y * alpha[1] / w.z];
            (1.0 + slope[0].powi(2) + slope[1].powi(2)).sqrt()
        };
        self.compare(&point, Model::Ggx { alpha, f0, separable }, &|q, v| {
            let rest = q.powi(4);
            let slope = around(((1.0 - rest) / rest).sqrt(), 1.0, TAU * v);
            let h = (slope * DVec3::new(alpha[0], alpha[1], 1.0)).normalize();
            let wi = 2.0 * wo.dot(h) * h - wo;
            let g2 = match separable {
                true => 4.0 / ((1.0 + root(wo)) * (1.0 + root(wi))),
                false => 2.0 / (root(wo) + root(wi)),
            };
            let scale = 4.0 * q.powi(3) * g2 * wo.dot(h).max(0.0) / (wo.z * h.z);
            (wi, f0.map(|f0| scale * (f0 + (1.0 - f0) * (1.0 - wo.dot(h).abs()).powi(5))))
        });
    }

    /// The lobe alone: with density (n + 1) / (2 pi) cos^n around the mirror direction.
    fn phong_lobe(&mut self, theta: f64, n: f64) {
        let point = point(&mut self.random, theta);
        let mirror = DVec3::new(-point.wo.x, -point.wo.y, point.wo.z);
        let x = mirror.any_orthonormal_vector();
        let frame = DMat3::from_cols(x, mirror.cross(x), mirror);
        let model = Model::ModifiedPhong { kd: [0.0; 3], ks: [0.5; 3], n };
        self.compare(&point, model, &|q, v| {
            let z = q.powf(4.0 / (n + 1.0));
            let wi = frame * around((1.0 - z * z).sqrt(), z, TAU * v);
            (wi, [4.0 * q.powi(3) * 0.5 * (n + 2.0) / (n + 1.0) * wi.z; 3])
        });
    }

    fn diffuse(&mut self, model: Model) {
        let point = point(&mut self.random, 30.0);
        let term = |u: f64, v: f64| (around(u.sqrt(), (1.0 - u).sqrt(), TAU * v), [0.25; 3]);
        self.compare(&point, model, &term);
    }
}

#[test]
fn every_model_agrees_with_an_integral_around_its_lobe() {
    let cases: Vec<_> =
        KINDS.iter().flat_map(|kind| [10.0, 60.0, 85.0].map(|t| (*kind, t))).collect();
    let mut errors: Vec<f64> = cases
        .into_par_iter()
        .enumerate()
        .flat_map_iter(|(seed, ((layout, filter), theta))| {
            let mut comparison = Comparison::new(layout, filter, seed as u64);
            for alpha in [[0.5, 0.5], [0.3, 0.1], [0.01, 0.01], [0.001, 0.001]] {
                comparison.ggx(theta, alpha, alpha[0] == 0.01);
            }
            for n in [3.0, 40.0, 5000.0] {
                comparison.phong_lobe(theta, n);
            }
            comparison.diffuse(Model::Lambert { albedo: [0.25; 3] });
            comparison.diffuse(Model::ModifiedPhong { kd: [0.25; 3], ks: [0.0; 3], n: 40.0 });
            comparison.errors
        })
        .collect();
    errors.sort_by(f64::total_cmp);
    let (middle, most) = (errors[errors.len() / 2], errors[errors.len() - 1]);
    eprintln!(
        "the other integral's own error: {middle:.1e} of a pixel in the middle, {most:.1e} at most"
    );
    assert!(middle < 1e-4 && most < 5e-3, "{middle} {most}");
}
