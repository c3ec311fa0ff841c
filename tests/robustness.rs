//! What must not happen: hanging, panicking, hiding bad values, results that depend on the cut of the work.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    reason = "a test says what it expects by unwrapping"
)]

mod common;

use std::sync::Arc;
use std::time::{Duration, Instant};

use brdf_host::environment::Environment;
use brdf_host::exec::Executor;
use brdf_host::exec::gpu::Gpu;
use brdf_host::link::BindingKind;
use brdf_host::scene::flat_points;
use common::shot::{Shot, map, sphere};
use common::{brdf, devices, gpu, integrator};

/// The same seed gives the same bits, however the work was cut; another seed gives others.
#[test]
fn pixels_do_not_depend_on_how_the_work_was_cut() {
    for mut device in devices() {
        let device = device.as_mut();
        let environment = map(96, 48, |x, y| [x as f32, y as f32, 1.0]);
        let b = brdf("ggx", &[]);
        // Samples, samples that teach, and terms: more than one block of each.
        for (name, resolution) in [("brdf-is", 64), ("mis-adaptive", 16), ("convolution", 10)] {
            let i = integrator(name, &[]);
            // 2,250 samples of each replicate: two blocks of 1,024 and one of 202.
            let mut shot = Shot::new(sphere(resolution), environment.clone(), 1500, 3);
            shot.effort.replicates = 2;
            let mut films = Vec::new();
            for budget in
                [Duration::from_micros(300), Duration::from_millis(20), Duration::from_secs(10)]
            {
                shot.budget = budget;
                films.push(shot.take(device, &b, &i).unwrap());
            }
            assert!(films[0] == films[1] && films[1] == films[2], "{name}");
            shot.effort.seed = 2;
            let other = shot.take(device, &b, &i).unwrap();
            assert_eq!(films[0] == other, name == "convolution", "{name}");
        }
    }
}

/// Radiance from 1e-20 to 1e20: a map times a power of two gives the picture times it, bit for bit.
#[test]
fn radiance_of_any_size_gives_the_same_picture() {
    let scaled = |factor: f32| {
        map(32, 16, move |x, y| [x as f32, y as f32, 1.0].map(|channel| channel * factor))
    };
    for mut device in devices() {
        for name in ["uniform", "mis-power", "mis-adaptive", "product", "convolution"] {
            let mut take = |factor: f32| {
                let shot = Shot::new(sphere(16), scaled(factor), 32, 4);
                shot.take(device.as_mut(), &brdf("ggx", &[]), &integrator(name, &[])).unwrap()
            };
            let plain = take(1.0);
            for factor in [2f32.powi(-66), 2f32.powi(66)] {
                let film = take(factor);
                assert_eq!(film.nonfinite(), 0);
                for (a, b) in plain.means().flatten().zip(film.means().flatten()) {
                    assert_eq!(a, b / f64::from(factor), "{name} times {factor:e}");
                }
            }
        }
    }
}

#[test]
fn an_endless_loop_is_an_error_with_a_cure_and_the_device_lives_on() {
    for mut device in devices() {
        let device = device.as_mut();
        let shot = Shot::new(sphere(64), Arc::new(Environment::constant(1.0)), 64, 2);
        let uniform = integrator("uniform", &[]);
        let problem = shot.take(device, &brdf("endless", &[]), &uniform).unwrap_err();
        assert_eq!(
            problem.to_string(),
            "endless with uniform: a loop took more than 16,383 iterations for one sample; \
             look for an endless loop, or give the loop a smaller bound"
        );
        shot.take(device, &brdf("lambert", &[]), &uniform).unwrap();
    }
}

#[test]
fn long_loops_are_cut_into_more_dispatches_and_change_nothing() {
    for mut device in devices() {
        let device = device.as_mut();
        let shot = Shot::new(sphere(24), Arc::new(Environment::constant(1.0)), 64, 2);
        let uniform = integrator("uniform", &[]);
        let patient = shot.take(device, &brdf("patient", &[]), &uniform).unwrap();
        let plain = shot.take(device, &brdf("patient", &["iterations=0"]), &uniform).unwrap();
        assert_eq!(patient, plain);
        let problem =
            shot.take(device, &brdf("patient", &["iterations=20000"]), &uniform).unwrap_err();
        assert!(problem.reason.contains("more than 16,383 iterations"));
    }
}

/// A `sample` that returns NaN is seen, and not taken for a direction below the horizon.
#[test]
fn nonfinite_directions_are_counted() {
    for mut device in devices() {
        let device = device.as_mut();
        let shot =
            Shot::new(flat_points(&[[0.0, 0.0, 1.0]]), Arc::new(Environment::constant(1.0)), 64, 2);
        let film =
            shot.take(device, &brdf("nan-sample", &[]), &integrator("brdf-is", &[])).unwrap();
        assert_eq!((film.nonfinite(), film.mean(0)), (128, [0.0; 3]));
    }
}

/// sqrt of a negative number is NaN: half of the directions. They count as zero, stay in the
/// denominator, and are reported.
#[test]
fn nonfinite_samples_count_as_zero_and_are_counted() {
    for mut device in devices() {
        let device = device.as_mut();
        let points = flat_points(&[[0.0, 0.0, 1.0], [0.6, 0.0, 0.8]]);
        let shot = Shot::new(points, Arc::new(Environment::constant(1.0)), 1024, 16);
        let film = shot.take(device, &brdf("nan-below", &[]), &integrator("uniform", &[])).unwrap();
        let share = film.nonfinite() as f64 / (2.0 * 1024.0 * 16.0);
        assert!((share - 0.5).abs() < 0.01, "{share}");
        assert_eq!(film.nonfinite_pixels(), 2);
        for row in 0..2 {
            // Half of Lambert's furnace: 1/2.
            assert!((film.mean(row)[0] - 0.5).abs() < 0.01);
        }
    }
}

#[test]
fn a_lost_device_and_too_large_buffers_are_problems_and_no_panics() {
    let Some(mut device) = gpu() else { return };
    let limits = device.limits();
    let too_large = usize::try_from(limits.buffer_bytes + 4).unwrap();
    let problem = device.buffer(BindingKind::ReadWrite, too_large).unwrap_err();
    assert!(problem.reason.contains("exceeds its limit") && problem.cure.contains("--resolution"));
    // Buffers that each fit, but not together.
    if limits.total_bytes < 1 << 40 {
        let one = usize::try_from(limits.buffer_bytes.min(1 << 30)).unwrap();
        let mut held = Vec::new();
        let problem = loop {
            match device.buffer(BindingKind::ReadWrite, one) {
                Ok(id) => held.push(id),
                Err(problem) => break problem,
            }
            assert!(held.len() as u64 <= limits.total_bytes / one as u64);
        };
        assert!(problem.reason.contains("may be used"), "{problem}");
        held.into_iter().for_each(|id| device.free(id));
    }
    let shot = Shot::new(sphere(16), Arc::new(Environment::constant(1.0)), 4, 2);
    let (b, i) = (brdf("lambert", &[]), integrator("uniform", &[]));
    shot.take(&mut device, &b, &i).unwrap();
    device.lose().unwrap();
    let problem = shot.take(&mut device, &b, &i).unwrap_err();
    assert!(problem.reason.contains("lost"), "{problem}");
    // It says so itself, soon, and a fresh one works.
    let patience = Instant::now();
    while !device.is_gone() && patience.elapsed() < Duration::from_secs(10) {
        std::thread::sleep(Duration::from_millis(5));
    }
    assert!(device.is_gone());
    let mut fresh = Gpu::open(None).unwrap();
    shot.take(&mut fresh, &b, &i).unwrap();
}
