//! The estimator of `brdf-is` with GGX, written by hand: one sample at a time, libm, all threads.
//!
//! What the CPU executor is held against. It shares the scene's points and the map with the host, and no code of an
//! estimator.

use brdf_host::environment::Environment;
use brdf_host::render::Effort;
use brdf_host::scene::ShadingPoint;
use rayon::prelude::*;

type Vector = [f32; 3];

fn dot(a: Vector, b: Vector) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn normalize(a: Vector) -> Vector {
    let length = dot(a, a).sqrt();
    a.map(|c| c / length)
}

fn hash(x: u32) -> u32 {
    let state = x.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
    (word >> 22) ^ word
}

fn combine(a: u32, b: u32) -> u32 {
    hash(a ^ hash(b))
}

fn laine_karras(x: u32, seed: u32) -> u32 {
    let mut y = x ^ x.wrapping_mul(0x3d20_adea);
    y = y.wrapping_add(seed);
    y = y.wrapping_mul((seed >> 16) | 1);
    y ^= y.wrapping_mul(0x0552_6c56);
    y ^ y.wrapping_mul(0x53a2_2864)
}

fn sobol_second_reversed(index: u32) -> u32 {
    let mut x = index;
    x ^= (x >> 16) & 0x0000_ffff;
    x ^= (x >> 8) & 0x00ff_00ff;
    x ^= (x >> 4) & 0x0f0f_0f0f;
    x ^= (x >> 2) & 0x3333_3333;
    x ^ ((x >> 1) & 0x5555_5555)
}

fn unit(x: u32) -> f32 {
    (x >> 8) as f32 / (1 << 24) as f32
}

/// The mean radiance of every point.
pub fn render(
    points: &[ShadingPoint],
    environment: &Environment,
    alpha: f32,
    f0: Vector,
    effort: Effort,
) -> Vec<Vector> {
    let count = effort.spp() as f32;
    let pixel = |point: &ShadingPoint| {
        let mut sum = [0.0; 3];
        for pass in 0..effort.passes.unwrap_or(1) {
            let seed = combine(combine(effort.seed, point.pixel), pass);
            for sample in 0..effort.samples {
                let radiance = estimate(point, environment, alpha, f0, seed, sample);
                if radiance.iter().all(|channel| channel.is_finite()) {
                    sum.iter_mut().zip(radiance).for_each(|(sum, channel)| *sum += channel);
                }
            }
        }
        sum.map(|channel| channel / count)
    };
    points.par_iter().map(pixel).collect()
}

fn estimate(
    point: &ShadingPoint,
    environment: &Environment,
    alpha: f32,
    f0: Vector,
    seed: u32,
    sample: u32,
) -> Vector {
    let wo = point.wo;
    let set = combine(seed, 0);
    let index = laine_karras(sample.reverse_bits(), set).reverse_bits();
    let u = unit(laine_karras(index, combine(set, 1)).reverse_bits());
    let second = sobol_second_reversed(index);
    let v = unit(laine_karras(second, combine(set, 2)).reverse_bits());

    let stretched = normalize([alpha * wo[0], alpha * wo[1], wo[2]]);
    let below = v * (1.0 + stretched[2]);
    let (sin, cos) = (std::f32::consts::TAU * u).sin_cos();
    let r = (below * (2.0 - below)).max(0.0).sqrt();
    let half = [r * cos + stretched[0], r * sin + stretched[1], 1.0 - below + stretched[2]];
    let h = normalize([alpha * half[0], alpha * half[1], half[2]]);
    let twice = 2.0 * dot(wo, h);
    let wi: Vector = std::array::from_fn(|c| twice * h[c] - wo[c]);
    if wo[2] <= 0.0 || wi[2] <= 0.0 {
        return [0.0; 3];
    }
    let length = |w: Vector| {
        let w = [alpha * w[0], alpha * w[1], w[2]];
        dot(w, w).sqrt()
    };
    let (out, into) = (length(wo), length(wi));
    let visibility = 0.5 / (wi[2] * out + wo[2] * into);
    let ratio = 2.0 * visibility * wi[2] * (wo[2] + out);
    let m = [wo[0] + wi[0], wo[1] + wi[1], wo[2] + wi[2]];
    let x = 1.0 - (0.5 * dot(m, m).sqrt()).min(1.0);
    let x5 = x * x * x * x * x;

    let (tangent, normal) = (point.tangent, point.normal);
    let bitangent = cross(normal, tangent);
    let dir: Vector =
        std::array::from_fn(|c| tangent[c] * wi[0] + bitangent[c] * wi[1] + normal[c] * wi[2]);
    let phi = dir[0].atan2(if dir[0] == 0.0 && dir[2] == 0.0 { 1.0 } else { dir[2] });
    let theta = dir[0].hypot(dir[2]).atan2(dir[1]);
    let at = 0.5 - phi / std::f32::consts::TAU;
    let (width, height) = (environment.width, environment.height);
    let column = (((at - at.floor()) * width as f32) as u32).min(width - 1);
    let row = ((theta / std::f32::consts::PI * height as f32) as u32).min(height - 1);
    let texel = environment.texels[(row * width + column) as usize];
    std::array::from_fn(|c| (f0[c] + (1.0 - f0[c]) * x5) * ratio * texel[c])
}
