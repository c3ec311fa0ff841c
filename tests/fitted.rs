//! Samplers that are fitted to BRDFs without sampling: they keep the laws, show the same picture as the cosine with
//! less noise, follow the parameters, and are a choice of the scene.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    reason = "a test says what it expects by unwrapping"
)]

mod common;

use std::f64::consts::TAU;
use std::fs;
use std::sync::Arc;

use brdf_host::conformance::{Drawer, Law, Outcome, Report, Wanted, conform};
use brdf_host::environment::Environment;
use brdf_host::exec::Precision;
use brdf_host::exec::cpu::Cpu;
use brdf_host::link::{Sampling, View, link};
use brdf_host::plugin::Configured;
use brdf_host::render::evaluate::{Pair, evaluate};
use brdf_host::render::{
    Effort, Estimate, Film, HEADLESS_BUDGET, Pace, Prepared, Sampler, Stage, Wish, estimate,
};
use brdf_host::session::{Chosen, Session, render_command};
use brdf_sdk::Kind;
use brdf_sdk::native::directions::{dot, mirrored};
use common::program::{folder, refused, run, small, text};
use common::shot::{Shot, map, sphere};
use common::{brdf, from_text, integrator, registry, root};

const MANIFEST: &str = "kind = \"brdf\"\nname = \"t\"\nabout = \"t\"\n";

/// A cosine power about the mirror direction; the wider setting comes first.
const GLOSSY: &str =
    "[params.n]\ntype = \"float\"\ndefault = 200.0\nrange = [200.0, 5000.0]\nabout = \"t\"\n";
const GLOSSY_EVAL: &str = "let c = max(dot(vec3f(-wo.xy, wo.z), wi), 0.0);\n    \
    return vec3f(0.7, 0.5, 0.3) * (p.n + 2.0) * 0.5 * INV_PI * exp(p.n * log(max(c, 1e-6)));";

/// Ward's exponent, ten times as wide along the tangent's normal as along the tangent.
const BRUSHED_EVAL: &str = "let m = (wo + wi) / (wo.z + wi.z);\n    \
    return vec3f(6.0 * exp(-m.x * m.x / 0.0009 - m.y * m.y / 0.09));";

/// Brighter where both directions lean to one side.
const LEANING_EVAL: &str = "return vec3f(0.2, 0.1, 0.1) * (1.0 + wo.x * wi.x + 0.5 * wi.y * wo.y);";

/// Nothing but a cone of a degree about the viewer, which no grid of half vectors about the normal looks for.
const SPIKE_EVAL: &str = "return vec3f(select(0.0, 300.0, distance(wo, wi) < 0.01745));";

fn given(id: &str, parameters: &str, eval: &str) -> Configured {
    let source = format!("fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {{\n    {eval}\n}}\n");
    fitted(from_text(id, &format!("{MANIFEST}{parameters}"), &source))
}

fn fitted(brdf: Configured) -> Configured {
    Configured { fit_sampler: true, ..brdf }
}

fn hard(name: &str) -> Configured {
    let folder = root().join("examples/hard").join(name);
    let found = Chosen::find(&registry(), Kind::Brdf, folder.to_str().unwrap()).unwrap();
    fitted(found.configured)
}

/// The laws hold that look at draws, and the furnace with an integrator that draws from the BRDF and one that mixes; the
/// verdicts say whose sampler it is. The report, for what it says of variance.
fn keeps_the_laws(brdf: &Configured) -> Report {
    let wanted = Wanted {
        laws: vec![Law::Contract, Law::Sampling, Law::Mean, Law::Variance, Law::Furnace],
        integrators: vec![integrator("brdf-is", &[]), integrator("mis-balance", &[])],
        ..Wanted::default()
    };
    let report = conform(&mut Cpu::new(Precision::F32), brdf, &wanted).unwrap();
    for law in [Law::Contract, Law::Sampling, Law::Mean, Law::Furnace] {
        let verdict = report.verdicts.iter().find(|verdict| verdict.law == law).unwrap();
        assert_eq!(verdict.outcome, Outcome::Passed, "{}: {verdict:?}", brdf.plugin.id);
        let told = verdict.said.contains("the host's fitted sampler");
        assert!(told || law == Law::Furnace, "{verdict:?}");
    }
    report
}

/// The laws hold, and the largest variance of any setting is that part of the cosine's.
fn gains(brdf: &Configured, most: f64) {
    let report = keeps_the_laws(brdf);
    let variance = report.verdicts.iter().find(|verdict| verdict.law == Law::Variance).unwrap();
    assert!(variance.number.unwrap() <= most, "{}: {variance:?}", brdf.plugin.id);
}

#[test]
fn glossy_lobes_keep_the_laws() {
    gains(&given("glossy", GLOSSY, GLOSSY_EVAL), 0.02);
}

#[test]
fn an_anisotropic_lobe_keeps_the_laws() {
    gains(&given("brushed", "", BRUSHED_EVAL), 0.1);
}

/// Weights that vary by less than half of their mean, at views where the cosine is as good as can be, too.
#[test]
fn rough_brdfs_keep_the_laws() {
    let wide = "return vec3f(0.2 + 0.3 * wo.z * wi.z);";
    for brdf in [given("leaning", "", LEANING_EVAL), given("wide", "", wide)] {
        let report = keeps_the_laws(&brdf);
        let own = report.plots.spreads.iter().map(|spread| spread.own);
        let most = own.fold(0.0, f64::max);
        assert!(most > 0.0 && most < 0.5, "{}: {most}", brdf.plugin.id);
    }
}

#[test]
fn what_is_black_keeps_the_laws() {
    keeps_the_laws(&given("nothing", "", "return vec3f(0.0);"));
}

#[test]
fn the_hard_scenes_without_sampling_keep_the_laws() {
    keeps_the_laws(&hard("unsampled"));
    gains(&hard("needle"), 0.1);
}

/// Of a BRDF that is zero nearly everywhere the tables hold what single looks have met: peaks that the laws' quadrature
/// of directions steps over. Here the cells are of half vectors, as those of the tables are: in each that lies above
/// the horizon a million draws are within five deviations of what the density says, with a chance of 1e-4 that one of
/// all cells is not.
#[test]
fn draws_follow_the_density_of_what_is_hardly_anywhere() {
    const DRAWS: usize = 1 << 20;
    const CELLS: usize = 16;
    /// Points along both sides of a cell.
    const ACROSS: usize = 64;
    let spike = given("spike", "", SPIKE_EVAL);
    let program = Arc::new(link(&View::Eval { brdf: spike.clone() }).unwrap());
    for theta in [0.3f64, 1.1, 1.4] {
        let wo = [theta.sin() * 0.6, theta.sin() * 0.8, theta.cos()];
        let wo32 = wo.map(|c| c as f32);
        let mut counts = [[0.0; CELLS]; CELLS];
        let mut cores = Cpu::new(Precision::F32);
        let mut drawer = Drawer::new(&mut cores, &spike).unwrap();
        let draws = drawer.draws(&mut cores, &spike, wo32, 7, DRAWS).unwrap();
        for draw in draws.iter().filter(|draw| draw.counts()) {
            let m: Vec<f64> = (0..3).map(|i| wo[i] + f64::from(draw.wi[i])).collect();
            // s = sin^2(theta_h / 2) = root^4 / 2.
            let theta_h = m[0].hypot(m[1]).atan2(m[2]);
            let root = (2.0 * (0.5 * theta_h).sin().powi(2)).powf(0.25);
            let turn = m[1].atan2(m[0]) / TAU + 0.5;
            let [row, column] = [root, turn].map(|part| (part * CELLS as f64) as usize);
            counts[row.min(CELLS - 1)][column.min(CELLS - 1)] += 1.0;
        }
        let mut looked_at = 0;
        for (cell, count) in counts.as_flattened().iter().enumerate() {
            let (mut pairs, mut measures) = (Vec::new(), Vec::new());
            for point in 0..ACROSS * ACROSS {
                let part = |cell: usize, point: usize| {
                    (cell as f64 + (point as f64 + 0.5) / ACROSS as f64) / CELLS as f64
                };
                let root = part(cell / CELLS, point / ACROSS);
                let phi = (part(cell % CELLS, point % ACROSS) - 0.5) * TAU;
                let s = 0.5 * root.powi(4);
                let across = 2.0 * (s * (1.0 - s)).sqrt();
                let h = [across * phi.cos(), across * phi.sin(), 1.0 - 2.0 * s];
                let wi = mirrored(wo, h);
                // dwi = 4 (wo . h) dh, dh = 2 ds dphi, ds = 2 root^3 droot.
                let area = TAU / (CELLS * CELLS * ACROSS * ACROSS) as f64;
                if dot(wo, h) > 0.0 && wi[2] > 0.0 {
                    pairs.push(Pair { wo: wo32, wi: wi.map(|c| c as f32) });
                    measures.push(16.0 * dot(wo, h) * root.powi(3) * area);
                }
            }
            if pairs.len() < ACROSS * ACROSS {
                continue;
            }
            let found = evaluate(&mut Cpu::new(Precision::F64), &program, &spike, &pairs).unwrap();
            let terms = found.iter().zip(measures).map(|(row, measure)| row.pdf * measure);
            let expected = terms.sum::<f64>() * DRAWS as f64;
            let off = (count - expected).abs();
            // Fewer than ten are Poisson's.
            let most = 5.0 * expected.max(10.0).sqrt();
            assert!(off < most, "theta {theta}, cell {cell}: {count} of {expected}");
            looked_at += 1;
        }
        assert!(looked_at >= 100, "{looked_at}");
    }
}

/// A map with a bright window and a dim rest.
fn window() -> Arc<Environment> {
    map(32, 16, |x, y| {
        let lit = (6..10).contains(&x) && (4..7).contains(&y);
        let dim = 0.2 + 0.01 * x as f32;
        if lit { [30.0, 25.0, 20.0] } else { [dim, 0.3, 0.5 - 0.01 * y as f32] }
    })
}

fn taken(brdf: &Configured, by: &str, replicates: u32, samples: u32) -> Film {
    let mut shot = Shot::new(sphere(20), window(), samples, 1);
    shot.effort = Effort { replicates, seed: 3, ..Effort::new(samples, 1) };
    shot.take(&mut Cpu::new(Precision::F32), brdf, &integrator(by, &[])).unwrap()
}

/// What is fitted, the cosine, and directions of the whole hemisphere have one mean: within four standard errors of
/// their differences.
#[test]
fn pictures_have_the_mean_of_other_samplers() {
    let scenes = [
        (hard("needle"), 20.0),
        (hard("unsampled"), 20.0),
        (given("glossy", GLOSSY, GLOSSY_EVAL), 20.0),
        (given("brushed", "", BRUSHED_EVAL), 5.0),
        (given("leaning", "", LEANING_EVAL), 0.2),
        (given("spike", "", SPIKE_EVAL), 0.1),
        (fitted(brdf("image-slice", &[])), 0.0),
    ];
    for (fitted, gain) in scenes {
        let id = fitted.plugin.id.clone();
        let cosine = Configured { fit_sampler: false, ..fitted.clone() };
        let films = [
            taken(&fitted, "brdf-is", 64, 4096),
            taken(&fitted, "mis-balance", 64, 1024),
            taken(&cosine, "brdf-is", 64, 16384),
            taken(&cosine, "uniform", 64, 16384),
        ];
        let all: Vec<Estimate> = films.iter().map(estimate).collect();
        for (index, other) in all.iter().enumerate().skip(1) {
            for channel in 0..3 {
                let errors = [&all[0], other].map(|e| e.mean_std_error.unwrap()[channel]);
                let apart = (all[0].mean[channel] - other.mean[channel]).abs();
                let deviation = errors[0].hypot(errors[1]);
                assert!(apart <= 4.0 * deviation, "{id}, {index}: {apart} of {deviation}");
            }
        }
        // Four times as many samples of the cosine.
        let relmse = |estimate: &Estimate| estimate.relmse.unwrap();
        let gained = 4.0 * relmse(&all[2]) / relmse(&all[0]);
        assert!(gained > gain, "{id}: {gained}");
        assert_eq!(films[0].nonfinite(), 0);
    }
}

/// Tables follow the numbers of a program that stays: as those of the window's sliders do.
#[test]
fn other_numbers_have_other_tables() {
    let wide = given("glossy", GLOSSY, GLOSSY_EVAL);
    let mut narrow = wide.clone();
    narrow.values.set_text(&narrow.plugin.manifest.clone(), "n=4000").unwrap();
    let by = integrator("brdf-is", &[]);
    let shot = Shot::new(sphere(16), window(), 16, 1);
    let mut cpu = Cpu::new(Precision::F32);
    let fresh = shot.take(&mut cpu, &narrow, &by).unwrap();

    let mut stage = Stage::new(shot.points.clone(), shot.environment.clone(), shot.rotation);
    let form = stage.form(Sampler::default());
    let view = View::Film { brdf: wide.clone(), integrator: by.clone(), form };
    let program = Arc::new(link(&view).unwrap());
    assert_eq!(program.sampling, Sampling::Fitted);
    let pace = Pace::new(HEADLESS_BUDGET);
    let plugins = [&wide, &by];
    let mut prepared =
        Prepared::new(&mut cpu, &mut stage, &program, &plugins, shot.effort, pace).unwrap();
    let mut film = Film::new(0, 1, 1.0);
    for numbers in [&narrow, &wide, &narrow] {
        prepared.set_values(&mut cpu, &[numbers, &by]).unwrap();
        prepared.run(&mut cpu, &stage, &mut film, &mut |_| Wish::GoOn).unwrap();
        let same = film.means().eq(fresh.means());
        assert_eq!(same, std::ptr::eq(numbers, &narrow));
    }
    prepared.free(&mut cpu);
}

/// The choice stands in scenes, in pictures and in the command that makes them; a BRDF with sampling keeps its own.
#[test]
fn scenes_and_pictures_hold_the_choice() {
    let folder = folder();
    let arguments = small(&["minnaert", "ggx", "--fit-sampler", "--export", "a", "--json"]);
    let made = run(folder.path(), &arguments);
    assert!(made.status.success(), "{}", text(&made.stderr));
    let out = text(&made.stdout);
    let reports: Vec<serde_json::Value> =
        out.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(
        (&reports[0]["sampling"], &reports[1]["sampling"]),
        (&"fitted".into(), &"own".into())
    );
    let told = |report: &serde_json::Value, note: &str| {
        report["notes"].as_array().unwrap().iter().filter(|told| *told == note).count()
    };
    let fit = "minnaert has neither `sample` nor `pdf`: sampled by what is fitted to its values";
    assert_eq!(told(&reports[0], fit), 1, "{out}");
    let own = "ggx has its own `sample` and `pdf`: nothing is fitted";
    assert_eq!(told(&reports[1], own), 1, "{out}");

    let again = ["render", "--session", "a-minnaert.exr", "--export", "b"];
    let again = run(folder.path(), &again);
    assert!(again.status.success(), "{}", text(&again.stderr));
    assert!(text(&again.stdout).contains("sampled by what is fitted to its values"));
    let bytes = |name: &str| fs::read(folder.path().join(name)).unwrap();
    assert!(bytes("a-minnaert.png") == bytes("b.png"));

    let registry = registry();
    let parse = |scene: &str| Session::parse(&registry, "scene.toml", scene, folder.path());
    let chosen = "format = 1\n[brdf]\nplugin = \"minnaert\"\nfit_sampler = true\n\
        [[beside]]\nplugin = \"ggx\"\nfit_sampler = true\n";
    let scene = parse(chosen).unwrap();
    assert!(scene.brdf.configured.fit_sampler && scene.beside[0].configured.fit_sampler);
    assert_eq!(parse(&scene.to_toml()).unwrap(), scene);
    assert!(render_command(&scene).contains(&"--fit-sampler".to_owned()));
    assert!(scene.brdf.reload(&registry).unwrap().configured.fit_sampler);
    let without = parse("format = 1\n[brdf]\nplugin = \"minnaert\"\n").unwrap();
    assert!(!without.to_toml().contains("fit_sampler"));
    assert!(!render_command(&without).contains(&"--fit-sampler".to_owned()));

    // A number is no choice, and integrators have none.
    for (scene, said) in [
        ("[brdf]\nfit_sampler = 1\n", "scene.toml:3:15"),
        ("[integrator]\nfit_sampler = true\n", "fit_sampler"),
    ] {
        let problem = parse(&format!("format = 1\n{scene}")).unwrap_err().to_string();
        assert!(problem.contains(said), "{problem}");
    }
}

/// A name that the tables need, and a loop without an end: one line each.
#[test]
fn what_cannot_be_fitted_is_told() {
    let folder = folder();
    let plugin = |name: &str, manifest: &str, source: &str| {
        let place = folder.path().join(name);
        fs::create_dir(&place).unwrap();
        fs::write(place.join("plugin.toml"), format!("{MANIFEST}{manifest}")).unwrap();
        fs::write(place.join(format!("{name}.wgsl")), source).unwrap();
    };
    plugin(
        "taken",
        "[tables.lobe_rows]\nsize = [2, 2]\nabout = \"t\"\n",
        "fn fill_lobe_rows(at: vec2f) -> f32 { return 1.0; }\n\
         fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f { return vec3f(lobe_rows_at(0u)); }\n",
    );
    plugin(
        "endless",
        "",
        "fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {\n    var f = 0.1;\n    \
         while wo.x < 2.0 { f += 1e-9; }\n    return vec3f(f);\n}\n",
    );
    let said = refused(folder.path(), &small(&["./taken", "--fit-sampler", "--device", "cpu"]));
    assert_eq!(
        said,
        "error: taken: `lobe_rows` of its plugin.toml is also a table of the sampler to be fitted; \
         rename it, or leave --fit-sampler out"
    );
    let said = refused(folder.path(), &small(&["./endless", "--fit-sampler", "--device", "cpu"]));
    assert!(said.contains("while a sampler was fitted to it"), "{said}");
}
