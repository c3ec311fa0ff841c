//! The error that a picture claims is the error that it has: z-scores of every pixel against the oracle.

use brdf_host::render::Sampler;
use glam::DMat3;

use crate::common::shot;
use crate::oracle::{Filter, Layout, Oracle};
use crate::places::{RESOLUTION, Spread};
use crate::{TOLERANCE, effort, film_of, integrators, linked, lit, maps, materials, seen};

/// Root mean square over pixels and channels of (mean - truth) / standard error, for independent
/// samples. With 32 replicates that is Student's t with 31 degrees of freedom, whose root mean square is
/// sqrt(31 / 29) = 1.034; over 1,300 pixels, whose channels go together, it spreads by
/// sqrt((3 * 29 / 27 - 1) / 1300) / 2 = 0.02.
#[test]
fn every_pixel_is_as_wrong_as_it_says() {
    let map = maps::map("structured", None).unwrap();
    // Without the sun and the lamps: means of rare events are not normal.
    let map = map.with(|x, y| map.at((x, y)).map(|value| value.min(2.0) as f32));
    let points = shot::sphere(48);
    let oracle = Oracle::new(&map, Filter::Linear, DMat3::IDENTITY);
    let mut stage = lit(&points, &map, Filter::Linear);
    for material in materials().iter().filter(|m| ["lambert", "ggx-0.5"].contains(&m.name)) {
        let expected = oracle.picture(&seen(&points), &material.model, TOLERANCE);
        for integrator in integrators() {
            let id = &integrator.plugin.id;
            let plugins = [&material.brdf, &integrator];
            let program = linked(plugins, stage.form(Sampler::Independent));
            let film = film_of(&mut stage, &program, plugins, effort(64));
            if film.replicates() == 1 {
                continue;
            }
            let mut squares = Vec::new();
            for (row, expected) in expected.iter().enumerate() {
                let (mean, variance) = (film.mean(row), film.variance_of_mean(row).unwrap());
                for c in 0..3 {
                    if variance[c] > 1e-12 * mean[c] * mean[c] {
                        squares.push((mean[c] - expected[c]).powi(2) / variance[c]);
                    }
                }
            }
            let rms = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
            eprintln!("{id} x {}: {rms:.3} of {}", material.name, squares.len());
            assert!((0.9..1.1).contains(&rms), "{id} x {}: {rms}", material.name);
            assert!(map.layout == Layout::LatLong && squares.len() > 3000);
        }
    }
}

/// One lit texel, read with the linear filter, lights its neighbours too: whoever draws directions
/// from the map must draw those as well. The picture's mean, within the spread of its replicates.
#[test]
fn what_only_the_filter_lights_is_drawn() {
    let texel = maps::map("single-texel", None).unwrap();
    let points = shot::sphere(*RESOLUTION);
    let count = points.len() as f64;
    let lambert = &materials()[0];
    for map in [&texel, &maps::single_texel_cube(&texel)] {
        let oracle = Oracle::new(map, Filter::Linear, DMat3::IDENTITY);
        let expected = oracle.picture(&seen(&points), &lambert.model, TOLERANCE);
        let expected = expected.iter().map(|radiance| radiance[0]).sum::<f64>() / count;
        let mut stage = lit(&points, map, Filter::Linear);
        for integrator in integrators() {
            let plugins = [&lambert.brdf, &integrator];
            let program = linked(plugins, stage.form(Sampler::default()));
            let film = film_of(&mut stage, &program, plugins, effort(128));
            if film.replicates() == 1 {
                continue;
            }
            let means: Vec<f64> = (0..film.replicates())
                .map(|r| {
                    (0..film.rows()).map(|row| film.replicate_mean(row, r)[0]).sum::<f64>() / count
                })
                .collect();
            let spread = Spread::of(&means);
            // Student's t with 31 degrees of freedom exceeds 5.2 with a probability of 1e-5.
            let off = (spread.mean - expected).abs();
            let id = &integrator.plugin.id;
            assert!(
                off < (5.2 * spread.std_error).max(2e-4 * expected),
                "{id}: {spread:?}, {expected}"
            );
            assert!(spread.std_error < 0.02 * expected, "{id}: {spread:?}");
        }
    }
}
