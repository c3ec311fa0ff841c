//! Samples per second of the integrators, on every executor of this machine, beside a hand-written
//! scalar estimator in Rust.
//!
//! `cargo bench -p brdf-host`: a 512x512 sphere, GGX of alpha 0.1; the map named by `BRDF_BENCH_MAP`
//! or the `studio` recipe at 1024x512. Each run renders whole passes through the render loop, reading
//! back and film included, compiling excluded; divan's "items" are samples of covered pixels. The
//! alternatives run in one process, one after the other: repeat the whole, since shared machines drift.

mod scalar;

use std::sync::Arc;

use brdf_host::environment::Environment;
use brdf_host::exec::{self, Precision, gpu};
use brdf_host::link::{Form, View, link};
use brdf_host::open;
use brdf_host::plugin::Configured;
use brdf_host::registry::Registry;
use brdf_host::render::{Effort, Film, HEADLESS_BUDGET, Pace, Prepared, Stage, Wish};
use brdf_host::scene::{ShadingPoint, Shape};
use brdf_host::session::{Chosen, Session};
use brdf_measured::merl;
use brdf_sdk::{Kind, Result};
use divan::counter::ItemsCount;
use glam::DMat3;

const EXECUTORS: [&str; 4] = ["adapter", "cores f32", "cores f64", "scalar Rust"];

const DEVICES: [&str; 2] = ["adapter", "cores f32"];

fn main() {
    match gpu::list().first() {
        Some(adapter) => eprintln!("adapter: {} ({})", adapter.name, adapter.driver),
        None => eprintln!("no adapter: the cores alone"),
    }
    eprintln!("cores: {}", exec::cpu::describe());
    divan::main();
}

#[divan::bench(args = EXECUTORS, sample_count = 9, sample_size = 1)]
fn brdf_is_4_passes_of_64(bencher: divan::Bencher, executor: &str) {
    measure(bencher, executor, "brdf-is", Effort::new(64, 4));
}

#[divan::bench(args = EXECUTORS, sample_count = 9, sample_size = 1)]
fn brdf_is_5_passes_of_15(bencher: divan::Bencher, executor: &str) {
    measure(bencher, executor, "brdf-is", Effort::new(15, 5));
}

#[divan::bench(args = ["adapter", "cores f32", "cores f64"], sample_count = 9, sample_size = 1)]
fn uniform_4_passes_of_64(bencher: divan::Bencher, executor: &str) {
    measure(bencher, executor, "uniform", Effort::new(64, 4));
}

#[divan::bench(args = DEVICES, sample_count = 9, sample_size = 1)]
fn env_is_5_passes_of_15(bencher: divan::Bencher, executor: &str) {
    measure(bencher, executor, "env-is", Effort::new(15, 5));
}

#[divan::bench(args = DEVICES, sample_count = 9, sample_size = 1)]
fn env_is_4_passes_of_64(bencher: divan::Bencher, executor: &str) {
    measure(bencher, executor, "env-is", Effort::new(64, 4));
}

/// A draw is one sample of each technique.
#[divan::bench(args = DEVICES, sample_count = 9, sample_size = 1)]
fn mis_balance_5_passes_of_15(bencher: divan::Bencher, executor: &str) {
    measure(bencher, executor, "mis-balance", Effort::new(15, 5));
}

#[divan::bench(args = DEVICES, sample_count = 9, sample_size = 1)]
fn mis_balance_4_passes_of_64(bencher: divan::Bencher, executor: &str) {
    measure(bencher, executor, "mis-balance", Effort::new(64, 4));
}

/// The measured materials that the program makes up, beside GGX: a device and a BRDF.
#[divan::bench(
    args = [
        "adapter, ggx", "adapter, merl", "adapter, csail", "adapter, rgl",
        "cores f32, ggx", "cores f32, merl", "cores f32, csail", "cores f32, rgl",
    ],
    sample_count = 9,
    sample_size = 1
)]
fn mis_balance_of_measured_2_passes_of_64(bencher: divan::Bencher, both: &str) {
    if let Some((executor, brdf)) = both.split_once(", ") {
        measure_brdf(bencher, executor, brdf, "mis-balance", Effort::new(64, 2));
    }
}

/// A MERL file from disk to arrays and tables to sample by.
#[divan::bench(sample_count = 9, sample_size = 1)]
fn load_merl(bencher: divan::Bencher) {
    let count = merl::BINS.iter().product();
    let value = |bin: usize| Some([1.0 / (1 + bin / 16_200) as f64; 3]);
    let bytes = merl::bytes(&(0..count).map(value).collect::<Vec<_>>());
    let file = tempfile::NamedTempFile::new().and_then(|file| {
        std::fs::write(file.path(), bytes)?;
        Ok(file)
    });
    match file {
        Ok(file) => {
            let path = file.path().display().to_string();
            bencher.bench_local(|| merl::load(Some(&path)).map(|loaded| loaded.arrays.len()));
        }
        Err(error) => eprintln!("load_merl: {error}"),
    }
}

/// Linking and lowering, as they come before the first dispatch on the cores.
#[divan::bench]
fn link_and_lower(bencher: divan::Bencher) {
    let prepared = Scene::new("ggx", "brdf-is").and_then(|scene| {
        let view =
            View::Film { brdf: scene.brdf, integrator: scene.integrator, form: Form::default() };
        Ok((view, open_executor("cores f32")?))
    });
    match prepared {
        Ok((view, mut cores)) => bencher.bench_local(|| {
            let kernel = cores.compile(Arc::new(link(&view)?))?;
            cores.forget(kernel);
            Ok::<_, brdf_sdk::Problem>(())
        }),
        Err(problem) => eprintln!("link_and_lower: {problem}"),
    }
}

struct Scene {
    points: Vec<ShadingPoint>,
    environment: Arc<Environment>,
    brdf: Configured,
    integrator: Configured,
}

impl Scene {
    fn new(brdf: &str, integrator: &str) -> Result<Self> {
        let registry = Registry::new(&[]);
        let mut session = Session::new(&registry)?;
        session.brdf = Chosen::find(&registry, Kind::Brdf, brdf)?;
        session.integrator = Chosen::find(&registry, Kind::Integrator, integrator)?;
        let manifest = session.brdf.configured.plugin.manifest.clone();
        for set in ["alpha_x=0.1", "alpha_y=0.1"].iter().filter(|_| brdf == "ggx") {
            session.brdf.configured.values.set_text(&manifest, set)?;
        }
        if let Ok(map) = std::env::var("BRDF_BENCH_MAP") {
            session.environment.map = map;
        }
        Ok(Self {
            points: open::shading_points(&session, &Shape::Sphere)?.points,
            environment: Arc::new(open::environment(&registry, &session.environment)?),
            brdf: session.brdf.configured,
            integrator: session.integrator.configured,
        })
    }
}

fn open_executor(name: &str) -> Result<Box<dyn exec::Executor>> {
    let opened = match name {
        "cores f32" => exec::open(Some("cpu"), Precision::F32)?,
        "cores f64" => exec::open(Some("cpu"), Precision::F64)?,
        _ => exec::open(Some("0"), Precision::F32)?,
    };
    Ok(opened.executor)
}

fn measure(bencher: divan::Bencher, executor: &str, integrator: &str, effort: Effort) {
    measure_brdf(bencher, executor, "ggx", integrator, effort);
}

fn measure_brdf(
    bencher: divan::Bencher,
    executor: &str,
    brdf: &str,
    integrator: &str,
    effort: Effort,
) {
    if executor == "adapter" && gpu::list().is_empty() {
        return;
    }
    let done = match executor {
        "scalar Rust" => measure_scalar(bencher, effort),
        _ => measure_executor(bencher, executor, brdf, integrator, effort),
    };
    if let Err(problem) = done {
        eprintln!("{executor}, {integrator}: {problem}");
    }
}

fn samples(scene: &Scene, effort: Effort) -> ItemsCount {
    ItemsCount::new(scene.points.len() as u64 * effort.spp())
}

fn measure_executor(
    bencher: divan::Bencher,
    executor: &str,
    brdf: &str,
    integrator: &str,
    effort: Effort,
) -> Result<()> {
    let scene = Scene::new(brdf, integrator)?;
    let items = samples(&scene, effort);
    let (brdf, integrator) = (scene.brdf, scene.integrator);
    let view =
        View::Film { brdf: brdf.clone(), integrator: integrator.clone(), form: Form::default() };
    let program = Arc::new(link(&view)?);
    let mut executor = open_executor(executor)?;
    let executor = executor.as_mut();
    let mut stage = Stage::new(scene.points, scene.environment, DMat3::IDENTITY);
    let plugins = [&brdf, &integrator];
    let mut prepared = Prepared::new(
        executor,
        &mut stage,
        &program,
        &plugins,
        effort,
        Pace::new(HEADLESS_BUDGET),
    )?;
    let mut film = Film::new(0, 1, 1.0);
    bencher
        .counter(items)
        .bench_local(|| prepared.run(executor, &stage, &mut film, &mut |_| Wish::GoOn));
    Ok(())
}

fn measure_scalar(bencher: divan::Bencher, effort: Effort) -> Result<()> {
    let scene = Scene::new("ggx", "brdf-is")?;
    let f0 = [0.95, 0.79, 0.47];
    bencher
        .counter(samples(&scene, effort))
        .bench_local(|| scalar::render(&scene.points, &scene.environment, 0.1, f0, effort));
    Ok(())
}
