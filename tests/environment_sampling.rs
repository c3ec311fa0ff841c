//! Drawing from the environment, on every device: the densities are those of the draws, on awkward maps too.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    reason = "a test says what it expects by unwrapping"
)]

mod common;

use std::f64::consts::PI;
use std::sync::Arc;

use brdf_host::conformance::{Outcome, light};
use brdf_host::environment::orientation::world_from_map;
use brdf_host::environment::{Environment, Form, Layout, Options, load};
use brdf_host::render::{Film, Filter, Lighting, estimate};
use brdf_host::scene::flat_points;
use common::shot::{Shot, map};
use common::{brdf, devices, integrator};

/// 2^18 samples of a fixture integrator at one point.
fn shot(environment: &Arc<Environment>, filter: Filter) -> Shot {
    let mut shot = Shot::new(flat_points(&[[0.0, 0.0, 1.0]]), environment.clone(), 1 << 14, 16);
    shot.lighting = Lighting { filter, ..Lighting::default() };
    shot
}

fn mean(film: &Film) -> [f64; 3] {
    assert_eq!(film.nonfinite(), 0);
    film.mean(0)
}

/// A cube whose texels are given by face, column and row.
fn cube(side: u32, texel: impl Fn(u32, u32, u32) -> [f32; 3]) -> Arc<Environment> {
    let cube = map(side, 6 * side, |x, y| texel(y / side, x, y % side));
    Arc::new(Environment { layout: Layout::Cube, ..(*cube).clone() })
}

/// E[g / p] over the draws is the integral of g: with g = 1, 1 - |y| and x^2 on the sphere it is 4 pi, 2 pi
/// and 4 pi / 3, whatever the map's radiance, as long as it is positive everywhere.
#[test]
fn draws_follow_their_density() {
    let structure = |x: u32, y: u32| [0.2 + ((x * 7 + y * 5) % 13) as f32, 1.0, (x % 3) as f32];
    let maps = [
        map(64, 32, structure),
        map(2, 1, |x, _| [1.0 + x as f32; 3]),
        map(6, 3, structure),
        cube(8, |face, x, y| structure(x + face, y)),
        cube(1, |face, _, _| [1.0 + face as f32; 3]),
        cube(4, |face, x, y| structure(x * face, y)),
    ];
    for mut device in devices() {
        for map in &maps {
            for filter in [Filter::Nearest, Filter::Linear] {
                let shot = shot(map, filter);
                let fixture = integrator("env-moments", &[]);
                let film = shot.take(device.as_mut(), &brdf("lambert", &[]), &fixture).unwrap();
                let found = mean(&film);
                let error = estimate(&film).mean_std_error.unwrap();
                for (channel, expected) in
                    [4.0 * PI, 2.0 * PI, 4.0 * PI / 3.0].into_iter().enumerate()
                {
                    // Five errors of sixteen replicates, and the roundings of f32.
                    let allowed = 5.0 * error[channel] + 1e-5 * expected;
                    assert!(
                        (found[channel] - expected).abs() < allowed,
                        "{:?} {}x{} {filter:?}: {found:?} +- {error:?}",
                        map.layout,
                        map.width,
                        map.height
                    );
                }
            }
        }
    }
}

/// Only the first row of a map of 4096 rows sends light: the cap of angle t = pi / 4096 about the pole.
/// Its solid angle is 4 pi sin^2(t/2), and the integral of 1 - cos over it pi (1 - cos t)^2.
#[test]
fn the_polar_row_of_a_high_map_is_exact() {
    let map = map(16, 4096, |_, y| [if y == 0 { 1.0 } else { 0.0 }; 3]);
    let one_minus_cos = 2.0 * (PI / 8192.0).sin().powi(2);
    for mut device in devices() {
        let fixture = integrator("env-moments", &[]);
        let film =
            shot(&map, Filter::Nearest).take(device.as_mut(), &brdf("lambert", &[]), &fixture);
        let [area, height, _] = mean(&film.unwrap());
        let relative = |found: f64, expected: f64| (found / expected - 1.0).abs();
        assert!(relative(area, 2.0 * PI * one_minus_cos) < 1e-5, "{area}");
        assert!(relative(height, PI * one_minus_cos.powi(2)) < 1e-4, "{height}");
    }
}

/// Black maps, single texels, rows without light, one texel of 1e6: draws find light and nothing else.
#[test]
fn awkward_maps_are_drawn_from_without_nan() {
    let single =
        |at: (u32, u32)| map(32, 16, move |x, y| [if (x, y) == at { 1e6 } else { 0.0 }; 3]);
    let black = map(32, 16, |_, _| [0.0; 3]);
    let sun = map(32, 16, |x, y| [if (x, y) == (9, 3) { 1e6 } else { 1e-6 }; 3]);
    let rows = map(32, 16, |_, y| [if y % 3 == 1 { 2.0 } else { 0.0 }; 3]);
    for mut device in devices() {
        let mut area = |map: &Arc<Environment>| {
            let fixture = integrator("env-moments", &[]);
            let film =
                shot(map, Filter::Nearest).take(device.as_mut(), &brdf("lambert", &[]), &fixture);
            mean(&film.unwrap())[0]
        };
        assert_eq!(area(&black), 0.0);
        for at in [(0, 0), (31, 15), (9, 3), (31, 0)] {
            let map = single(at);
            let expected = map.solid_angle(at.0, at.1);
            assert!((area(&map) / expected - 1.0).abs() < 1e-5, "{at:?}");
        }
        let lit: f64 = (0..16).filter(|y| y % 3 == 1).map(|y| 32.0 * rows.solid_angle(0, y)).sum();
        assert!((area(&rows) / lit - 1.0).abs() < 1e-3);
        // The dim texels around the sun are drawn too: all of the sphere is reached, once in a while.
        assert!(area(&sun) > 0.0);
    }
}

/// A drawn direction, looked up again, has the density, the radiance and the numbers that drew it, but for
/// those that rounding takes over a texel's edge.
#[test]
fn lookups_agree_with_draws() {
    let texel = |x: u32, y: u32| {
        [1.0 + ((x * 5 + y * 3) % 7) as f32, 1.0 + (x % 4) as f32, 1.0 + (y % 5) as f32]
    };
    let maps = [map(128, 64, texel), cube(16, |face, x, y| texel(x + 3 * face, y))];
    for mut device in devices() {
        for map in &maps {
            for filter in [Filter::Nearest, Filter::Linear] {
                let fixture = integrator("env-again", &[]);
                let film = shot(map, filter).take(device.as_mut(), &brdf("lambert", &[]), &fixture);
                let [pdf, radiance, u] = mean(&film.unwrap());
                // Texels of 1/128 of the width, places good to 1e-6 of it: some 1e-4 lie so near an edge.
                assert!(
                    pdf < 5e-4 && radiance < 5e-4 && u < 5e-4,
                    "{:?} {filter:?}: {pdf} {radiance} {u}",
                    map.layout
                );
            }
        }
    }
}

/// The law of sampling: a million draws against the integral of the density, cell by cell; for both filters,
/// plain and compensated.
fn is_sampled_well(name: &str, map: &Arc<Environment>) {
    for mut device in devices() {
        let verdicts = light(device.as_mut(), map, world_from_map(33.0, 17.0)).unwrap();
        for (purpose, verdict) in verdicts {
            let held = verdict.outcome == Outcome::Passed;
            assert!(held, "{name} on {}, {purpose:?}: {verdict:?}", device.name());
        }
    }
}

#[test]
fn the_law_of_sampling_holds_for_lat_long_maps() {
    let structure = |x: u32, y: u32| [0.2 + ((x * 7 + y * 5) % 13) as f32, 1.0, (x % 3) as f32];
    let only = |at: (u32, u32)| move |x, y| [if (x, y) == at { 1e6 } else { 0.0 }; 3];
    is_sampled_well("two texels", &map(2, 1, |x, _| [1.0 + x as f32; 3]));
    is_sampled_well("structure", &map(64, 32, structure));
    is_sampled_well("few texels", &map(6, 3, structure));
    is_sampled_well("a single texel", &map(32, 16, only((9, 3))));
    is_sampled_well("a texel at the pole", &map(32, 16, only((31, 15))));
    let sun = |x: u32, y: u32| [if (x, y) == (40, 11) { 1e6 } else { 0.5 + (x % 5) as f32 }; 3];
    is_sampled_well("the sun", &map(128, 64, sun));
    is_sampled_well("a polar row", &map(16, 4096, |_, y| [if y == 0 { 1.0 } else { 0.0 }; 3]));
    is_sampled_well("a constant", &Arc::new(Environment::constant(1.0)));
}

#[test]
fn the_law_of_sampling_holds_for_cubes() {
    let structure = |face: u32, x: u32, y: u32| {
        [0.2 + ((x * 7 + y * 5 + face) % 13) as f32, 1.0 + face as f32, (x % 3) as f32]
    };
    is_sampled_well("six texels", &cube(1, |face, _, _| [1.0 + face as f32; 3]));
    is_sampled_well("structure", &cube(32, structure));
    let only =
        |at: (u32, u32, u32)| move |face, x, y| [if (face, x, y) == at { 1e6 } else { 0.0 }; 3];
    is_sampled_well("a single texel", &cube(8, only((3, 7, 0))));
    let sun =
        |face, x: u32, y| [if (face, x, y) == (2, 20, 3) { 1e6 } else { 0.5 + (x % 5) as f32 }; 3];
    is_sampled_well("the sun", &cube(32, sun));
}

#[test]
fn the_law_of_sampling_holds_for_real_maps() {
    let Some(folder) = std::env::var_os("BRDF_TEST_DATA") else {
        println!("skipped: BRDF_TEST_DATA is not set");
        return;
    };
    for name in ["studio_small_03", "kloppenheim_05", "st_peters_square_night"] {
        let file = std::path::Path::new(&folder).join(format!("hdri/{name}_1k.hdr"));
        let map = load(&file, &Options::default()).unwrap();
        let cube = Form { layout: Some(Layout::Cube), face: Some(128), width: None };
        let cube = map.clone().in_form(cube).unwrap();
        is_sampled_well(name, &Arc::new(map));
        is_sampled_well(name, &Arc::new(cube));
    }
}
