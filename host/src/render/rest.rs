//! What an unfinished sum over texels leaves out, estimated: the rest of the map on a coarse grid.
//!
//! The texels not added yet are averaged to at most 32 columns, and that map is rendered by samples of
//! the BRDF, whose weights are bounded: a narrow lobe neither misses it nor overshoots. With it a
//! preview has the brightness of the whole; the last texel takes it to zero.

use std::sync::Arc;

use brdf_sdk::{Manifest, Result};

use super::{Effort, Ended, Film, HEADLESS_BUDGET, Pace, Prepared, Stage, Wish};
use crate::environment::{Environment, Layout, order, texel_radiance};
use crate::exec::Executor;
use crate::link::{Program, Sampler, View, link};
use crate::plugin::{Configured, Plugin};

/// Columns of the coarse map, and of a coarse cube's face.
const COLUMNS: [u32; 2] = [32, 8];

/// Samples of the BRDF at every pixel.
const SAMPLES: u32 = 64;

/// Completes the film of a sum that was ended early; every other film stays as it is.
pub fn complete(
    executor: &mut dyn Executor,
    stage: &Stage,
    program: &Program,
    brdf: &Configured,
    ended: Ended,
    film: &mut Film,
) -> Result<()> {
    match (ended, program.sum) {
        (Ended::Early, Some(sum)) => add_rest(executor, stage, brdf, sum.by_luminance, film),
        _ => Ok(()),
    }
}

/// Adds to `film`, an unfinished sum of `brdf`, what the texels from its last one on would add.
fn add_rest(
    executor: &mut dyn Executor,
    stage: &Stage,
    brdf: &Configured,
    by_luminance: bool,
    film: &mut Film,
) -> Result<()> {
    let Some([done, _]) = film.quadrature().map(|quadrature| quadrature.terms) else {
        return Ok(());
    };
    let map = stage.environment();
    let filter = stage.lighting().filter;
    let order = order(map, filter, by_luminance);
    let left = order.get(done as usize..).unwrap_or_default();
    let mut stage = stage.under(coarse(map, left, &texel_radiance(map, filter)));
    let integrator = integrator()?;
    let form = stage.form(Sampler::OwenSobol);
    let view = View::Film { brdf: brdf.clone(), integrator: integrator.clone(), form };
    let program = Arc::new(link(&view)?);
    let effort = Effort { replicates: 1, ..Effort::new(SAMPLES, 1) };
    let plugins = [brdf, &integrator];
    let pace = Pace::new(HEADLESS_BUDGET);
    let mut prepared = Prepared::new(executor, &mut stage, &program, &plugins, effort, pace)?;
    let mut rest = Film::new(0, 1, 1.0);
    let ended = prepared.run(executor, &stage, &mut rest, &mut |_| Wish::GoOn);
    prepared.free(executor);
    stage.unload(executor);
    ended?;
    film.add(|row| rest.mean(row));
    Ok(())
}

/// The map of the texels `left` alone, averaged over areas.
fn coarse(map: &Environment, left: &[u32], radiance: &[[f64; 3]]) -> Environment {
    let across = match map.layout {
        Layout::LatLong => COLUMNS[0],
        Layout::Cube => COLUMNS[1],
    };
    let width = across.min(map.width);
    let height = (u64::from(width) * u64::from(map.height) / u64::from(map.width)).max(1) as u32;
    let mut coarse = Environment { width, height, ..map.clone() };
    let mut energy = vec![[0.0; 3]; (width * height) as usize];
    for index in left {
        let (column, row) = (index % map.width, index / map.width);
        let to =
            |at: u32, of: u32, into: u32| (u64::from(at) * u64::from(into) / u64::from(of)) as u32;
        let cell = to(row, map.height, height) * width + to(column, map.width, width);
        let area = map.solid_angle(column, row);
        let radiance = radiance[*index as usize];
        for (sum, channel) in energy[cell as usize].iter_mut().zip(radiance) {
            *sum += channel * area;
        }
    }
    let texels = energy.iter().enumerate().map(|(index, energy)| {
        let (column, row) = (index as u32 % width, index as u32 / width);
        let [r, g, b] = energy.map(|sum| (sum / coarse.solid_angle(column, row)) as f32);
        [r, g, b, 0.0]
    });
    coarse.texels = Arc::new(texels.collect());
    coarse
}

/// The host's own integrator for this: the BRDF's samples.
fn integrator() -> Result<Configured> {
    let manifest = "kind = \"integrator\"\nname = \"Rest\"\nabout = \"What a sum leaves out.\"\n";
    let source = "fn estimate(q: Settings, hit: Hit, s: ptr<function, Sampler>) -> vec3f {\n    \
                  let drawn = brdf_sample(hit.wo, next_3d(s));\n    \
                  if all(drawn.weight == vec3f(0.0)) {\n        return vec3f(0.0);\n    }\n    \
                  return drawn.weight * env_radiance(to_world(hit, drawn.wi));\n}\n";
    Ok(Configured::new(Arc::new(Plugin {
        id: "rest".to_owned(),
        manifest: Manifest::parse("the host's rest", manifest, "rest")?,
        wgsl_file: "the host's rest".to_owned(),
        source: source.into(),
        tables: Default::default(),
        native: None,
    })))
}
