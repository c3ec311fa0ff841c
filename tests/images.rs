//! Pictures against known answers, on the device of this machine: two independent ways to a number.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    reason = "a test says what it expects by unwrapping"
)]

mod common;

use std::f64::consts::{LN_2, PI};
use std::sync::Arc;

use brdf_host::environment::{Environment, orientation};
use brdf_host::exec::Executor;
use brdf_host::render::albedo::directional_albedo;
use brdf_host::render::{Effort, Film, estimate};
use brdf_host::scene::{Camera, ShadingPoint, Shape, cast, flat_points};
use common::shot::{Shot, map, sphere};
use common::{brdf, devices, integrator};

/// Root mean square over pixels and channels of (a - b) / sqrt(var a + var b), and the z-scores of
/// the two pictures' means.
fn z_scores(a: &Film, b: &Film) -> (f64, [f64; 3]) {
    let (mut sum, mut count) = (0.0, 0.0);
    for row in 0..a.rows() {
        let (va, vb) = (a.variance_of_mean(row).unwrap(), b.variance_of_mean(row).unwrap());
        for channel in 0..3 {
            let variance = va[channel] + vb[channel];
            if variance > 0.0 {
                let d = a.mean(row)[channel] - b.mean(row)[channel];
                sum += d * d / variance;
                count += 1.0;
            }
        }
    }
    let (ea, eb) = (estimate(a), estimate(b));
    let (sa, sb) = (ea.mean_std_error.unwrap(), eb.mean_std_error.unwrap());
    let z = std::array::from_fn(|c| (ea.mean[c] - eb.mean[c]) / sa[c].hypot(sb[c]));
    ((sum / count).sqrt(), z)
}

/// Directional albedo of GGX at F0 = 1. At normal incidence G1(wo) = 1 and the integral over
/// visible normals has closed forms at alpha 1 (1 - ln 2); the other figures are Mitsuba's and our
/// own f64 quadrature's, to four digits.
#[test]
fn ggx_has_the_albedo_of_the_literature() {
    for mut device in devices() {
        let device = device.as_mut();
        let mut albedo = |alpha: f64, masking: &str, theta: f64| {
            let set = [
                &format!("alpha_x={alpha}"),
                &format!("alpha_y={alpha}"),
                "f0=1",
                &format!("masking={masking}"),
            ]
            .map(|s: &str| s.to_owned());
            let set: Vec<&str> = set.iter().map(String::as_str).collect();
            let effort = Effort { seed: 3, ..Effort::new(1024, 64) };
            let (b, i) = (brdf("ggx", &set), integrator("brdf-is", &[]));
            let table = directional_albedo(device, &b, &i, &[theta], 0.0, effort).unwrap();
            assert!(table.rows[0].std_error[0] < 5e-5, "{:?}", table.rows);
            table.rows[0].albedo[0]
        };
        let (correlated, separable) = ("height-correlated", "separable");
        for (alpha, masking, theta, expected, digits) in [
            (0.1, correlated, 0.0, 0.988, 5e-4),
            (0.25, correlated, 0.0, 0.916, 5e-4),
            (0.5, correlated, 0.0, 0.688, 5e-4),
            (1.0, correlated, 0.0, 1.0 - LN_2, 2e-4),
            (0.5, correlated, 60.0, 0.6982, 1e-4),
            (0.5, separable, 60.0, 0.6860, 1e-4),
            (0.5, correlated, 80.0, 0.8053, 1e-4),
            (0.5, separable, 80.0, 0.7469, 1e-4),
        ] {
            let found = albedo(alpha, masking, theta);
            assert!((found - expected).abs() < digits, "alpha {alpha} {masking} {theta}: {found}");
        }
    }
}

/// Uniform sampling and BRDF importance sampling agree on the mean and at every pixel.
///
/// Means of 32 passes each: a z-score is nearly Student's t with 62 degrees of freedom, whose root mean
/// square is sqrt(62 / 60) = 1.016; over some 580 pixels it spreads by about 0.03. Passes must be long
/// enough that each sees the lamps: where most miss them, their spread says too little (1.5 was found
/// at 1,024 samples a pass on the real map).
fn agree(environment: &Arc<Environment>, samples: [u32; 2]) {
    for mut device in devices() {
        let device = device.as_mut();
        let b = brdf("ggx", &["alpha_x=0.2", "alpha_y=0.2"]);
        let shot = |samples| Shot::new(sphere(32), environment.clone(), samples, 32);
        let uniform = shot(samples[0]).take(device, &b, &integrator("uniform", &[])).unwrap();
        let is = shot(samples[1]).take(device, &b, &integrator("brdf-is", &[])).unwrap();
        let (rms, means) = z_scores(&uniform, &is);
        eprintln!("RMS of z-scores {rms:.3}, of the means {means:.2?}");
        assert!((0.9..1.1).contains(&rms), "{rms}");
        // Three channels, two-sided, 0.001 in all: |z| < 3.6.
        assert!(means.iter().all(|z| z.abs() < 3.6), "{means:?}");
    }
}

#[test]
fn uniform_and_brdf_is_agree_in_the_furnace() {
    agree(&Arc::new(Environment::constant(1.0)), [512, 32]);
}

#[test]
fn uniform_and_brdf_is_agree_on_a_real_map() {
    let Some(data) = common::data() else { return };
    let path = data.join("hdri/studio_small_03_1k.hdr");
    let map = brdf_host::environment::load(&path, &Default::default()).unwrap();
    agree(&Arc::new(map), [8192, 8192]);
}

#[test]
fn uniform_on_the_sphere_agrees_with_uniform_on_the_hemisphere() {
    for mut device in devices() {
        let device = device.as_mut();
        let map = map(16, 8, |x, y| [1.0 + x as f32, 1.0 + y as f32, 1.0]);
        let b = brdf("lambert", &[]);
        let shot = Shot::new(sphere(48), map, 256, 32);
        let half = shot.take(device, &b, &integrator("uniform", &[])).unwrap();
        let seed = Effort { seed: 2, ..shot.effort };
        let shot = Shot { effort: seed, ..shot };
        let whole = shot.take(device, &b, &integrator("uniform", &["domain=sphere"])).unwrap();
        let (rms, means) = z_scores(&half, &whole);
        assert!((0.9..1.1).contains(&rms), "{rms}");
        assert!(means.iter().all(|z| z.abs() < 3.6), "{means:?}");
    }
}

/// Every texel of a map is found at its centre and just inside its corners, whatever the rotation.
///
/// Directions are made here from the definition: polar angle from +y, u = 0.25 at +x, 0.5 at +z.
#[test]
fn each_texel_lies_where_the_orientation_says() {
    for mut device in devices() {
        let device = device.as_mut();
        let (width, height) = (8u32, 4u32);
        let index = |x: u32, y: u32| (y * width + x) as f32;
        let environment = map(width, height, |x, y| [index(x, y), 0.0, 0.0]);
        for (phi, theta) in [(0.0, 0.0), (30.0, 0.0), (0.0, 50.0), (-100.0, 20.0), (200.0, 130.0)] {
            let (sp, cp) = f64::to_radians(phi).sin_cos();
            let (st, ct) = f64::to_radians(theta).sin_cos();
            let mut points = Vec::new();
            let mut expected = Vec::new();
            for y in 0..height {
                for x in 0..width {
                    for (dx, dy) in
                        [(0.5, 0.5), (0.001, 0.001), (0.999, 0.001), (0.001, 0.999), (0.999, 0.999)]
                    {
                        let u = (f64::from(x) + dx) / f64::from(width);
                        let t = PI * (f64::from(y) + dy) / f64::from(height);
                        let a = 2.0 * PI * (0.5 - u);
                        let map_dir = [t.sin() * a.sin(), t.cos(), t.sin() * a.cos()];
                        // The side that makes maps agrees with the shader that reads them.
                        let v = (f64::from(y) + dy) / f64::from(height);
                        let made = orientation::direction_of(u, v);
                        assert!((made - glam::DVec3::from(map_dir)).length() < 1e-12);
                        // About +y by phi: z turns towards x. Then about +x by theta: y turns towards z.
                        let [mx, my, mz] = map_dir;
                        let [yx, yy, yz] = [cp * mx + sp * mz, my, cp * mz - sp * mx];
                        let world = [yx, ct * yy - st * yz, st * yy + ct * yz];
                        let normal = world.map(|c| c as f32);
                        let tangent = glam::Vec3::from(normal).any_orthonormal_vector().to_array();
                        let pixel = points.len() as u32;
                        points.push(ShadingPoint { pixel, wo: [0.0, 0.0, 1.0], tangent, normal });
                        expected.push(f64::from(index(x, y)));
                    }
                }
            }
            let mut shot = Shot::new(points, environment.clone(), 1, 1);
            shot.rotation = orientation::world_from_map(phi, theta);
            let looked = integrator("normal-radiance", &[]);
            let film = shot.take(device, &brdf("lambert", &[]), &looked).unwrap();
            for (row, expected) in expected.iter().enumerate() {
                let found = film.mean(row)[0];
                assert_eq!(found, *expected, "phi {phi} theta {theta}, texel {}", row / 5);
            }
        }
    }
}

#[test]
fn the_axes_and_both_poles_see_their_texels() {
    for mut device in devices() {
        let device = device.as_mut();
        let environment = map(8, 4, |x, y| [x as f32, y as f32, 0.0]);
        let axes = [
            ([1.0, 0.0, 0.0], Some(2.0), 2.0),
            ([0.0, 0.0, 1.0], Some(4.0), 2.0),
            ([-1.0, 0.0, 0.0], Some(6.0), 2.0),
            ([0.0, 1.0, 0.0], None, 0.0),
            ([0.0, -1.0, 0.0], None, 3.0),
            // On the seam, from both sides: the last column and the first.
            ([-1e-6, 0.0, -1.0], Some(7.0), 2.0),
            ([1e-6, 0.0, -1.0], Some(0.0), 2.0),
        ];
        let points: Vec<ShadingPoint> = axes
            .iter()
            .enumerate()
            .map(|(i, (normal, _, _))| ShadingPoint {
                pixel: i as u32,
                wo: [0.0, 0.0, 1.0],
                tangent: glam::Vec3::from(*normal).any_orthonormal_vector().to_array(),
                normal: *normal,
            })
            .collect();
        let shot = Shot::new(points, environment, 1, 1);
        let film =
            shot.take(device, &brdf("lambert", &[]), &integrator("normal-radiance", &[])).unwrap();
        for (row, (normal, column, line)) in axes.iter().enumerate() {
            let [x, y, _] = film.mean(row);
            assert_eq!(y, *line, "{normal:?}");
            assert!(column.is_none_or(|column| x == column), "{normal:?}: column {x}");
            assert!((0.0..8.0).contains(&x));
        }
    }
}

/// Lambert under a map of one lit texel: radiance = albedo / pi times the texel's irradiance, which
/// a midpoint rule over the texel gives to 1e-4 at each of the sphere's normals.
#[test]
fn lambert_under_a_single_texel_has_its_irradiance() {
    for mut device in devices() {
        let device = device.as_mut();
        let (tx, ty) = (6u32, 1u32);
        let environment =
            map(16, 8, |x, y| if (x, y) == (tx, ty) { [20.0, 0.0, 0.0] } else { [0.0; 3] });
        let points = sphere(40);
        let shot = Shot::new(points.clone(), environment, 4096, 16);
        let film = shot
            .take(device, &brdf("lambert", &["albedo=1"]), &integrator("uniform", &[]))
            .unwrap();
        let irradiance = |n: [f64; 3]| -> f64 {
            let steps = 64;
            let mut sum = 0.0;
            for j in 0..steps {
                for i in 0..steps {
                    let u = (f64::from(tx) + (f64::from(i) + 0.5) / f64::from(steps)) / 16.0;
                    let t = PI * (f64::from(ty) + (f64::from(j) + 0.5) / f64::from(steps)) / 8.0;
                    let a = 2.0 * PI * (0.5 - u);
                    let d = [t.sin() * a.sin(), t.cos(), t.sin() * a.cos()];
                    let cos = d[0] * n[0] + d[1] * n[1] + d[2] * n[2];
                    sum += cos.max(0.0) * t.sin();
                }
            }
            sum * (2.0 * PI / 16.0) * (PI / 8.0) / f64::from(steps * steps)
        };
        let (mut squares, mut worst) = (0.0, 0.0f64);
        let mut lit = 0.0;
        for (row, point) in points.iter().enumerate() {
            let expected = 20.0 / PI * irradiance(point.normal.map(f64::from));
            let found = film.mean(row)[0];
            let error = film.variance_of_mean(row).unwrap()[0].sqrt();
            if error == 0.0 {
                assert!(
                    found == 0.0 && expected < 1e-3,
                    "pixel {}: {found}, {expected}",
                    point.pixel
                );
                continue;
            }
            let z = (found - expected) / error;
            squares += z * z;
            worst = worst.max(z.abs());
            lit += 1.0;
        }
        // Student's t with 15 degrees of freedom has a root mean square of sqrt(15 / 13) = 1.074; over
        // about 700 pixels it spreads by 0.04. P(|t| > 7) = 4e-6 a pixel.
        let rms = f64::sqrt(squares / lit);
        assert!(lit > 500.0 && (0.94..1.22).contains(&rms) && worst < 7.0, "{lit} {rms} {worst}");
    }
}

/// Points of one Sobol sequence with an Owen scramble; sample i at pixel i.
fn points(device: &mut dyn Executor, set: &[&str], count: usize) -> Vec<[f64; 3]> {
    let points = flat_points(&vec![[0.0, 0.0, 1.0]; count]);
    let shot = Shot::new(points, Arc::new(Environment::constant(1.0)), 1, 1);
    let film = shot.take(device, &brdf("lambert", &[]), &integrator("points", set)).unwrap();
    let points: Vec<[f64; 3]> = film.means().collect();
    assert!(points.iter().flatten().all(|c| (0.0..1.0).contains(c)));
    points
}

/// Counts points by elementary intervals: each dimension cut into 2^cuts.
fn counts(points: &[[f64; 3]], cuts: [u32; 3]) -> Vec<usize> {
    let mut counts = vec![0; 1 << cuts.iter().sum::<u32>()];
    for point in points {
        let place = |i: usize| (point[i] * f64::from(1u32 << cuts[i])) as usize;
        counts[((place(2) << cuts[1] | place(1)) << cuts[0]) | place(0)] += 1;
    }
    counts
}

/// The first two dimensions are a (0, m, 2)-net: of 2^m points, each of the 2^m elementary intervals of every
/// shape holds exactly one. With the third, whose polynomial has degree 2, they are a (1, m, 3)-net
/// (Niederreiter 1988): each of 2^(m-1) intervals holds two. Alone it is stratified like the others.
#[test]
fn the_samplers_points_are_a_net() {
    for mut device in devices() {
        for m in [4, 9, 10] {
            let points = points(device.as_mut(), &[], 1 << m);
            for x in 0..=m {
                let found = counts(&points, [x, m - x, 0]);
                assert!(found.iter().all(|count| *count == 1), "{x} of {m}");
                for y in 0..m - x {
                    let cuts = [x, y, m - 1 - x - y];
                    assert!(counts(&points, cuts).iter().all(|count| *count == 2), "{cuts:?}");
                }
            }
            assert!(counts(&points, [0, 0, m]).iter().all(|count| *count == 1));
        }
        // Padded sets are shuffled independently: no correlation beyond 4 / sqrt(n) = 0.125.
        let points = points(device.as_mut(), &["padded=true"], 1 << 10);
        for other in 0..2 {
            let covariance: f64 = points.iter().map(|p| (p[other] - 0.5) * (p[2] - 0.5)).sum();
            assert!((12.0 * covariance / 1024.0).abs() < 0.125);
        }
    }
}

#[test]
fn local_frames_are_orthonormal_on_the_device() {
    for mut device in devices() {
        let device = device.as_mut();
        for shape in [Shape::Sphere, Shape::Torus, Shape::Plane] {
            let points = cast(&Camera::default(), &shape, [64, 64]).points;
            let shot = Shot::new(points, Arc::new(Environment::constant(1.0)), 1, 1);
            let film =
                shot.take(device, &brdf("lambert", &[]), &integrator("frames", &[])).unwrap();
            let worst = film.means().flatten().fold(0.0, f64::max);
            assert!(worst < 1e-6, "{shape:?}: {worst}");
            // Right-handed: the bitangent is normal x tangent.
            let film =
                shot.take(device, &brdf("lambert", &[]), &integrator("bitangent", &[])).unwrap();
            for (point, pixel) in shot.points.iter().zip(film.means()) {
                let [n, t] =
                    [point.normal, point.tangent].map(|v| glam::DVec3::from(v.map(f64::from)));
                assert!((n.cross(t) - glam::DVec3::from(pixel)).length() < 1e-6, "{shape:?}");
            }
        }
    }
}
