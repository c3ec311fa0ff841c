//! Samples per second of the integrators, on the device of this machine.
//!
//! `cargo bench -p brdf-host`: a 512x512 sphere, GGX of alpha 0.1, the `studio` recipe at 1024x512.
//! Each run renders whole passes through the render loop, reading back and film included, compiling
//! excluded; divan's "items" are samples of covered pixels. Alternatives run in one process, one after
//! the other: repeat the whole, since shared machines drift.

use std::ops::ControlFlow;
use std::sync::Arc;

use brdf_host::exec::gpu::{Gpu, list};
use brdf_host::link::{View, link};
use brdf_host::open;
use brdf_host::registry::Registry;
use brdf_host::render::{Effort, Film, HEADLESS_BUDGET, Prepared, Stage};
use brdf_host::scene::Shape;
use brdf_host::session::{Chosen, Session};
use brdf_sdk::{Kind, Result};
use divan::counter::ItemsCount;
use glam::DMat3;

fn main() {
    match list().first() {
        Some(adapter) => eprintln!("on {} ({})", adapter.name, adapter.driver),
        None => return eprintln!("no adapter: nothing to measure"),
    }
    divan::main();
}

#[divan::bench(args = ["brdf-is", "uniform"], sample_count = 15, sample_size = 1)]
fn passes_of_15_samples(bencher: divan::Bencher, integrator: &str) {
    measure(bencher, integrator, Effort { samples: 15, passes: 5, seed: 0 });
}

#[divan::bench(args = ["brdf-is", "uniform"], sample_count = 9, sample_size = 1)]
fn passes_of_64_samples(bencher: divan::Bencher, integrator: &str) {
    measure(bencher, integrator, Effort { samples: 64, passes: 4, seed: 0 });
}

fn measure(bencher: divan::Bencher, integrator: &str, effort: Effort) {
    if let Err(problem) = try_measure(bencher, integrator, effort) {
        eprintln!("{integrator}: {problem}");
    }
}

fn try_measure(bencher: divan::Bencher, integrator: &str, effort: Effort) -> Result<()> {
    let registry = Registry::new(&[]);
    let mut session = Session::new(&registry)?;
    session.integrator = Chosen::find(&registry, Kind::Integrator, integrator)?;
    let manifest = session.brdf.configured.plugin.manifest.clone();
    for set in ["alpha_x=0.1", "alpha_y=0.1"] {
        session.brdf.configured.values.set_text(&manifest, set)?;
    }
    let points = open::shading_points(&session, &Shape::Sphere)?.points;
    let environment = Arc::new(open::environment(&registry, &session.environment)?);
    let (brdf, integrator) = (session.brdf.configured, session.integrator.configured);
    let program =
        Arc::new(link(&View::Film { brdf: brdf.clone(), integrator: integrator.clone() })?);
    let samples = points.len() as u64 * u64::from(effort.samples) * u64::from(effort.passes);
    let mut gpu = Gpu::open(None)?;
    let mut stage = Stage::new(points, environment, DMat3::IDENTITY);
    let plugins = [&brdf, &integrator];
    let mut prepared =
        Prepared::new(&mut gpu, &mut stage, &program, &plugins, effort, HEADLESS_BUDGET)?;
    bencher.counter(ItemsCount::new(samples)).bench_local(|| {
        let mut film = Film::new(stage.points().len());
        prepared.run(&mut gpu, &stage, &mut film, &mut |_| ControlFlow::Continue(()))
    });
    Ok(())
}
