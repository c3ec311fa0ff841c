//! The matrix: every integrator that ships, with every material, under every map, gives what the oracle says.
//!
//! A cell is one integrator, material, map, layout and filter. The mean of the picture and those of its tiles
//! may differ from the oracle's by max(t SE, 2e-4 of the mean), where t is Student's quantile at 1 %
//! for all comparisons of the matrix together. A cell counts where its standard error is below 1 %
//! of the mean and no replicate holds most of the variance; which cells do not is fixed in `standing`.
//! `BRDF_AGREEMENT_WIDTH` and `BRDF_AGREEMENT_RESOLUTION` ask for larger maps and pictures; what is undecided
//! is fixed for the usual sizes, so with others it is only listed.
//! Everything has a fixed seed and runs on the CPU executor, whose bits are the same on all machines;
//! `BRDF_AGREEMENT_DEVICE` names another device, as `--device` does.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    reason = "a test says what it expects by unwrapping"
)]

#[path = "../common/mod.rs"]
mod common;
mod maps;
#[path = "../common/oracle/mod.rs"]
mod oracle;
mod places;
mod scores;
mod standing;

use std::cell::RefCell;
use std::collections::HashMap;
use std::fmt::Write as _;
use std::sync::Arc;

use brdf_host::environment::{self, Environment};
use brdf_host::exec::{self, CPU, Executor, Precision};
use brdf_host::link::{Form, Program, View, link};
use brdf_host::measure::student;
use brdf_host::plugin::Configured;
use brdf_host::registry::Registry;
use brdf_host::render::{
    Effort, Film, HEADLESS_BUDGET, Lighting, Progress, Sampler, Stage, Wish, render,
};
use brdf_host::scene::ShadingPoint;
use brdf_sdk::{Kind, Param};
use common::shot;
use glam::DMat3;
use oracle::{Filter, Layout, Map, Model, Oracle, Point};
use places::{Place, RESOLUTION, Spread, places};
use standing::STANDING;

/// With 32 replicates half of a normal spread's variance falls into one of them once in 10,000
/// cells; with 16 it would be once in 50.
const REPLICATES: u32 = 32;

/// Samples a pixel in each replicate. Where a look leaves a doubt the second one follows, and where it finds
/// a difference all do, each on samples of its own: what few samples hardly ever meet in a tile is
/// met by more, and a bias stays.
const LOOKS: [u32; 3] = [128, 512, 4096];

/// The oracle's own relative error at every pixel.
const TOLERANCE: f64 = 1e-5;

const MAPS: [&str; 6] = [
    "furnace",
    "single-texel",
    "structured",
    "studio_small_03",
    "kloppenheim_05",
    "st_peters_square_night",
];

const KINDS: [(&str, Layout, Filter); 4] = [
    ("lat-long nearest", Layout::LatLong, Filter::Nearest),
    ("lat-long linear", Layout::LatLong, Filter::Linear),
    ("cube nearest", Layout::Cube, Filter::Nearest),
    ("cube linear", Layout::Cube, Filter::Linear),
];

/// A BRDF with its parameters, as a plugin and as the oracle's model.
struct Material {
    name: &'static str,
    brdf: Configured,
    model: Model,
}

fn materials() -> Vec<Material> {
    let ggx = |name, alpha: f64| {
        let set = [format!("alpha_x={alpha}"), format!("alpha_y={alpha}")];
        let colour = "f0=0.95,0.79,0.47".to_owned();
        let set: Vec<&str> = set.iter().chain([&colour]).map(String::as_str).collect();
        Material {
            name,
            brdf: common::brdf("ggx", &set),
            model: Model::ggx(alpha, [0.95, 0.79, 0.47]),
        }
    };
    let phong = common::brdf("modified-phong", &["kd=0.25,0.1,0.05", "ks=0.5", "n=40"]);
    vec![
        Material {
            name: "lambert",
            brdf: common::brdf("lambert", &["albedo=0.5,0.6,0.7"]),
            model: Model::Lambert { albedo: [0.5, 0.6, 0.7] },
        },
        ggx("ggx-0.5", 0.5),
        ggx("ggx-0.1", 0.1),
        ggx("ggx-0.01", 0.01),
        Material {
            name: "modified-phong",
            brdf: phong,
            model: Model::ModifiedPhong { kd: [0.25, 0.1, 0.05], ks: [0.5; 3], n: 40.0 },
        },
    ]
}

/// Every integrator in the source tree that looks at the environment, with its defaults.
fn integrators() -> Vec<Configured> {
    let found = Registry::new(&[common::root().join("plugins")]).all(Kind::Integrator);
    let all = found.into_iter().map(|found| common::integrator(&found.id, &[]));
    all.filter(|chosen| {
        let program = linked([&common::brdf("lambert", &[]), chosen], Form::default());
        let looks = program.binds("env_map");
        if !looks {
            common::skip(&format!("{}: it does not look at the environment", chosen.plugin.id));
        }
        looks
    })
    .collect()
}

/// The map as the host takes it.
fn environment(map: &Map) -> Arc<Environment> {
    let texel = |x: u32, y: u32| map.at((x as usize, y as usize)).map(|value| value as f32);
    let environment = shot::map(map.width as u32, map.height as u32, texel);
    let layout = match map.layout {
        Layout::LatLong => environment::Layout::LatLong,
        Layout::Cube => environment::Layout::Cube,
    };
    Arc::new(Environment { layout, ..Arc::unwrap_or_clone(environment) })
}

/// The points under a map, as the host takes them.
fn lit(points: &[ShadingPoint], map: &Map, filter: Filter) -> Stage {
    let filter = match filter {
        Filter::Nearest => environment::Filter::Nearest,
        Filter::Linear => environment::Filter::Linear,
    };
    let stage = Stage::new(points.to_vec(), environment(map), DMat3::IDENTITY);
    stage.lit(Lighting { filter, ..Lighting::default() })
}

/// The points as the oracle takes them.
fn seen(points: &[ShadingPoint]) -> Vec<Point> {
    points.iter().map(|point| Point::new(point.tangent, point.normal, point.wo)).collect()
}

/// So many samples a pixel in each replicate.
fn effort(samples: u32) -> Effort {
    let total = samples * REPLICATES;
    Effort { replicates: REPLICATES, seed: samples, ..Effort::new(total, 1) }
}

fn linked([brdf, integrator]: [&Configured; 2], form: Form) -> Arc<Program> {
    let (brdf, integrator) = (brdf.clone(), integrator.clone());
    Arc::new(link(&View::Film { brdf, integrator, form }).unwrap())
}

/// A picture by the host.
fn film_of(
    stage: &mut Stage,
    program: &Arc<Program>,
    plugins: [&Configured; 2],
    effort: Effort,
) -> Film {
    EXECUTOR.with_borrow_mut(|executor| {
        let executor = executor.as_mut();
        let go_on = &mut |_: Progress<'_>| Wish::GoOn;
        let done =
            render(executor, stage, program, &plugins, effort, HEADLESS_BUDGET, go_on).unwrap();
        stage.unload(executor);
        assert_eq!(done.film.nonfinite(), 0);
        done.film
    })
}

thread_local! {
    /// A test's own device, opened once.
    static EXECUTOR: RefCell<Box<dyn Executor>> = {
        let device = std::env::var("BRDF_AGREEMENT_DEVICE").unwrap_or_else(|_| CPU.to_owned());
        RefCell::new(exec::open(Some(&device), Precision::F32).unwrap().executor)
    };
}

/// Each replicate's radiance at each point. A sum over texels has one replicate.
fn replicates(film: &Film) -> Vec<Vec<[f64; 3]>> {
    let rows = |replicate| (0..film.rows()).map(move |row| (row, replicate));
    (0..film.replicates())
        .map(|replicate| rows(replicate).map(|(row, r)| film.replicate_mean(row, r)).collect())
        .collect()
}

/// What came of a cell.
struct Verdict {
    /// Why it cannot be decided.
    doubt: Option<String>,
    /// Places that disagree.
    wrong: Vec<String>,
    /// The whole picture's largest standard error, relative.
    std_error: f64,
    /// The largest difference, as a part of what is allowed there.
    worst: f64,
}

/// Compares the picture and its tiles with the truth; a sum over texels, which has no noise, at every pixel.
///
/// A tile may not have met in any replicate what is rare and bright, and then its own spread says too
/// little. The picture as a whole has met it, so a tile's standard error is taken as at least what the
/// picture's would be for as few pixels.
fn judge(places: &[Place], found: &[Vec<[f64; 3]>], expected: &[[f64; 3]], t: f64) -> Verdict {
    let mut verdict = Verdict { doubt: None, wrong: Vec::new(), std_error: 0.0, worst: 0.0 };
    let mut picture = [Spread::default(); 3];
    let pixels = if found.len() == 1 { places::pixels(expected.len()) } else { Vec::new() };
    for (index, place) in places.iter().chain(&pixels).enumerate() {
        let count = place.rows.len() as f64;
        let mean = |picture: &[[f64; 3]], c: usize| {
            place.rows.iter().map(|row| picture[*row][c]).sum::<f64>() / count
        };
        let spreads = [0, 1, 2].map(|c| {
            let means: Vec<f64> = found.iter().map(|replicate| mean(replicate, c)).collect();
            Spread::of(&means)
        });
        if index == 0 {
            picture = spreads;
            verdict.doubt = spreads.iter().find_map(Spread::doubt);
            verdict.std_error = spreads.iter().map(Spread::relative).fold(0.0, f64::max);
            if verdict.doubt.is_some() {
                break;
            }
        }
        for (c, spread) in spreads.iter().enumerate() {
            let truth = mean(expected, c);
            let fewer = (expected.len() as f64 / count).sqrt();
            let std_error = spread.std_error.max(picture[c].std_error * fewer);
            let allowed = (t * std_error).max(2e-4 * truth);
            if allowed > 0.0 {
                verdict.worst = verdict.worst.max((spread.mean - truth).abs() / allowed);
            }
            if (spread.mean - truth).abs() > allowed {
                verdict.wrong.push(format!(
                    "{} channel {c}: {:.6e} is not {truth:.6e}, off by {:.2e} of it, the standard error is {:.1e}",
                    place.name,
                    spread.mean,
                    spread.mean / truth - 1.0,
                    std_error / truth
                ));
            }
        }
    }
    verdict
}

/// All cells under one map.
fn agree_under(name: &str) {
    let data = if name.contains('_') { common::data() } else { None };
    let Some(map) = maps::map(name, data.as_deref()) else { return };
    let points = shot::sphere(*RESOLUTION);
    let places = places(&points);
    let (materials, integrators) = (materials(), integrators());
    let cells = MAPS.len() * KINDS.len() * materials.len() * integrators.len();
    let tests = (cells * places.len() * 3) as f64;
    let t = student::quantile(student::sidak(0.01, tests), REPLICATES - 1);
    let usual = (*maps::WIDTH, *RESOLUTION) == (16, 12);
    let (mut failed, mut report) = (String::new(), String::new());
    for (kind, layout, filter) in KINDS {
        let map = match layout {
            Layout::LatLong => map.clone(),
            Layout::Cube if name == "single-texel" => maps::single_texel_cube(&map),
            Layout::Cube => maps::on_cube(&map),
        };
        let oracle = Oracle::new(&map, filter, DMat3::IDENTITY);
        let mut stage = lit(&points, &map, filter);
        let form = stage.form(Sampler::default());
        // One serves all materials of a BRDF: they differ in numbers.
        let mut programs = HashMap::new();
        for material in &materials {
            let expected = oracle.picture(&seen(&points), &material.model, TOLERANCE);
            for integrator in &integrators {
                let id = &integrator.plugin.id;
                let plugins = [&material.brdf, integrator];
                let names = plugins.map(|configured| configured.plugin.id.clone());
                let program = programs.entry(names).or_insert_with(|| linked(plugins, form));
                let mut look = |samples| {
                    let film = film_of(&mut stage, program, plugins, effort(samples));
                    judge(&places, &replicates(&film), &expected, t)
                };
                let mut verdict = look(LOOKS[0]);
                if verdict.doubt.is_some() {
                    verdict = look(LOOKS[1]);
                }
                for samples in &LOOKS[1..] {
                    if !verdict.wrong.is_empty() && verdict.std_error > 0.0 {
                        verdict = look(*samples);
                    }
                }
                let standing = STANDING.iter().find(|s| s.covers([id, material.name, name, kind]));
                let cell = format!("{id} x {} x {name} x {kind}", material.name);
                let said = match (&verdict.doubt, standing) {
                    (None, None) if verdict.wrong.is_empty() => "agrees".to_owned(),
                    (None, None) => "differs".to_owned(),
                    (Some(doubt), Some(standing)) => {
                        format!("undecided ({doubt}): {}", standing.reason)
                    }
                    (Some(doubt), None) if !usual => format!("undecided ({doubt})"),
                    (None, Some(_)) if !usual && verdict.wrong.is_empty() => "agrees".to_owned(),
                    (Some(doubt), None) => {
                        let _ =
                            writeln!(failed, "{cell}: undecided and not expected to be: {doubt}");
                        "undecided".to_owned()
                    }
                    (None, Some(_)) => {
                        let _ = writeln!(failed, "{cell}: decided, though it stands as undecided");
                        "decided".to_owned()
                    }
                };
                let (shown, more) = verdict.wrong.split_at(verdict.wrong.len().min(3));
                shown.iter().for_each(|wrong| {
                    let _ = writeln!(failed, "{cell}: {wrong}");
                });
                if !more.is_empty() {
                    let _ = writeln!(failed, "{cell}: and {} more", more.len());
                }
                let _ = writeln!(
                    report,
                    "{cell}: SE {:.2} %, at {:.2} of what is allowed, {said}",
                    100.0 * verdict.std_error,
                    verdict.worst
                );
            }
        }
    }
    eprintln!("t = {t:.2}\n{report}");
    assert!(failed.is_empty(), "{failed}");
}

#[test]
fn in_the_furnace() {
    agree_under("furnace");
}

#[test]
fn under_a_single_texel() {
    agree_under("single-texel");
}

#[test]
fn under_a_structured_map() {
    agree_under("structured");
}

#[test]
fn in_a_studio() {
    agree_under("studio_small_03");
}

#[test]
fn under_the_sun() {
    agree_under("kloppenheim_05");
}

#[test]
fn among_lamps_at_night() {
    agree_under("st_peters_square_night");
}

/// The matrix has integrators as they come; here each of their switches at its other values, on cells that all decide.
/// One evaluation a texel is no approximation that gets better with samples, and left out.
#[test]
fn with_every_other_choice() {
    let points = shot::sphere(*RESOLUTION);
    let places = places(&points);
    let (_, _, filter) = KINDS[0];
    let map = maps::map("structured", None).unwrap();
    let oracle = Oracle::new(&map, filter, DMat3::IDENTITY);
    let mut stage = lit(&points, &map, filter);
    let form = stage.form(Sampler::default());
    let mut materials = materials();
    materials.retain(|material| ["lambert", "ggx-0.5"].contains(&material.name));
    let integrators = integrators();
    let others: Vec<(String, Configured)> = integrators
        .iter()
        .flat_map(|integrator| {
            let id = &integrator.plugin.id;
            let named = move |(param, other): (&Param, _)| (format!("{id}, {}", param.key), other);
            integrator.switched().map(named)
        })
        .filter(|(name, _)| name != "convolution, quadrature")
        .collect();
    assert!(others.len() >= 3, "{others:?}");
    let tests = (materials.len() * others.len() * places.len() * 3) as f64;
    let t = student::quantile(student::sidak(0.01, tests), REPLICATES - 1);
    for material in &materials {
        let expected = oracle.picture(&seen(&points), &material.model, TOLERANCE);
        for (name, other) in &others {
            let plugins = [&material.brdf, other];
            let program = linked(plugins, form);
            let mut look = |samples| {
                let film = film_of(&mut stage, &program, plugins, effort(samples));
                judge(&places, &replicates(&film), &expected, t)
            };
            let mut verdict = look(LOOKS[1]);
            if verdict.doubt.is_some() {
                verdict = look(LOOKS[2]);
            }
            let Verdict { doubt, wrong, .. } = verdict;
            assert!(doubt.is_none(), "{name} x {}: {doubt:?}", material.name);
            assert!(wrong.is_empty(), "{name} x {}: {wrong:#?}", material.name);
        }
    }
}

/// Nothing stands as undecided that does not exist.
#[test]
fn what_stands_exists() {
    let (materials, integrators) = (materials(), integrators());
    for standing in STANDING {
        let mut cells = integrators.iter().flat_map(|integrator| {
            let id = integrator.plugin.id.as_str();
            let of_map = move |material, map| KINDS.map(|kind| [id, material, map, kind.0]);
            let of_material =
                move |material| MAPS.into_iter().flat_map(move |map| of_map(material, map));
            materials.iter().flat_map(move |material| of_material(material.name))
        });
        assert!(cells.any(|cell| standing.covers(cell)), "{:?}", standing.cell);
    }
}
