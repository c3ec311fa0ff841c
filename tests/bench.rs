//! Speed against error: errors that follow from the seed alone, a baseline of them, and what the command line makes of it.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    reason = "a test says what it expects by unwrapping"
)]

mod common;

use std::fmt::Write as _;
use std::path::Path;
use std::process::{Command, Output};

use brdf_host::bench::{Limits, Plan, Preset, Report, Row, Wanted, recommend, run, scenes};
use brdf_host::exec::{Precision, open};
use brdf_host::session::Chosen;
use brdf_sdk::Kind;
use common::{registry, root};

/// The quick preset, small, by work and not by time.
fn plan(samples: u64, seed: u32) -> Plan {
    let mut plan = Preset::Quick.plan(&registry()).unwrap();
    for Row { case, .. } in &mut plan.rows {
        case.scene.film.resolution = [32, 32];
        case.scene.environment.width = Some(64);
    }
    plan.limits = Limits { time: 1e9, samples, repeats: 1, seed, ..Limits::default() };
    plan
}

fn report(plan: &Plan, store: &Path) -> Report {
    let mut devices = [open(Some("cpu"), Precision::F32).unwrap().executor];
    let wanted = Wanted { store: Some(store), pictures: false };
    run(&registry(), plan, &mut devices, wanted, &mut |_, _| true).unwrap().report
}

/// Scene, integrator, samples and relMSE of every step.
fn errors(report: &Report) -> Vec<(String, u64, f64)> {
    let cells = report.cells.iter().flat_map(|cell| {
        let name = format!("{},{}", cell.case, cell.integrator);
        cell.steps.iter().map(move |step| (name.clone(), step.spp, step.errors.relmse))
    });
    cells.collect()
}

#[test]
fn errors_follow_from_the_seed_alone_and_references_are_kept() {
    let store = tempfile::tempdir().unwrap();
    let mut small = plan(64, 0);
    small.rows.truncate(1);
    let once = report(&small, store.path());
    assert_eq!(once.cells.len(), small.rows[0].integrators.len());
    assert!(once.cells.iter().all(|cell| cell.problem.is_none() && cell.steps.len() == 3));
    assert!(
        once.cases[0].reference_said.contains("agrees with"),
        "{}",
        once.cases[0].reference_said
    );
    let kept: Vec<_> =
        std::fs::read_dir(store.path()).unwrap().map(|e| e.unwrap().path()).collect();
    let [kept] = kept.as_slice() else { panic!("{kept:?}") };
    assert!(kept.to_str().unwrap().contains(&once.cases[0].reference));
    // A mark in the kept one would be seen in the errors: it is what is read the second time.
    let again = report(&small, store.path());
    assert_eq!(errors(&once), errors(&again));
    assert_eq!(once.cases, again.cases);

    small.limits.seed = 1;
    assert_ne!(errors(&once), errors(&report(&small, store.path())));
    // Another scene has another reference.
    small.rows[0].case.scene.environment.phi = 30.0;
    let turned = report(&small, store.path());
    assert_ne!(turned.cases[0].reference, once.cases[0].reference);
    assert_eq!(std::fs::read_dir(store.path()).unwrap().count(), 2);
}

/// Work is counted in samples: whoever makes an integrator less accurate sees it here. `UPDATE_BASELINE=1` writes it anew.
#[test]
fn no_integrator_is_less_accurate_than_it_was() {
    let store = tempfile::tempdir().unwrap();
    let now = errors(&report(&plan(256, 0), store.path()));
    let file = root().join("tests/baseline/errors.csv");
    if std::env::var_os("UPDATE_BASELINE").is_some() {
        let mut text = "case,integrator,spp,relmse\n".to_owned();
        for (name, spp, relmse) in &now {
            writeln!(text, "{name},{spp},{relmse:.4e}").unwrap();
        }
        std::fs::create_dir_all(file.parent().unwrap()).unwrap();
        std::fs::write(&file, text).unwrap();
    }
    let before = std::fs::read_to_string(&file).unwrap();
    assert_eq!(before.lines().count(), now.len() + 1, "cells came or went: UPDATE_BASELINE=1");
    for (line, (name, spp, relmse)) in before.lines().skip(1).zip(&now) {
        let known = line.strip_prefix(&format!("{name},{spp},"));
        let known: f64 = known.unwrap_or_else(|| panic!("{line} is not {name}")).parse().unwrap();
        // Roundings of other machines, and no more.
        assert!(
            *relmse <= 1.02 * known,
            "{name} at {spp} samples: {relmse:.4e}, it was {known:.4e}"
        );
    }
}

fn brdf(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_brdf")).current_dir(folder).args(arguments).output().unwrap()
}

const TINY: [&str; 16] = [
    "bench",
    "lambert",
    "--maps",
    "furnace",
    "--integrators",
    "uniform,cosine",
    "--resolution",
    "16",
    "--ibl-width",
    "16",
    "--time",
    "0.02",
    "--repeats",
    "2",
    "--device",
    "cpu",
];

#[test]
fn reports_are_written_and_compared() {
    let folder = tempfile::tempdir().unwrap();
    let run =
        |more: &[&str]| brdf(folder.path(), &[&TINY[..], &["--references", "refs"], more].concat());
    let done = run(&["--json", "a.json", "--csv", "a.csv", "--html", "a.html", "--md", "a.md"]);
    let said = String::from_utf8_lossy(&done.stdout).into_owned();
    assert!(done.status.success(), "{said}{}", String::from_utf8_lossy(&done.stderr));
    assert!(said.contains("lambert under furnace") && said.contains("cosine"), "{said}");
    let text = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
    let report = Report::from_json("a.json", &text("a.json")).unwrap();
    assert_eq!(report.cells.len(), 2);
    assert!(text("a.csv").lines().count() > 4);
    let page = text("a.html");
    assert!(page.contains("Which integrator?") && page.contains("relMSE against time"));
    assert_eq!(
        page.matches("data:image/png").count(),
        1 + 2 * 2,
        "reference, two pictures, two errors"
    );

    let markdown = text("a.md");
    let heading = "## lambert under furnace";
    assert!(markdown.contains(heading), "{markdown}");
    // The winners link to it, and its picture lies beside the page.
    assert!(markdown.contains("[lambert under furnace](#lambert-under-furnace)"), "{markdown}");
    let picture = markdown.split("](a/").nth(1).and_then(|rest| rest.split(')').next()).unwrap();
    assert_eq!(image::open(folder.path().join("a").join(picture)).unwrap().width(), 16);

    // A report in which all was a hundred times more accurate: now it is worse.
    let mut better = report.clone();
    for cell in &mut better.cells {
        cell.steps.iter_mut().for_each(|step| step.errors.relmse *= 0.01);
    }
    std::fs::write(folder.path().join("better.json"), better.to_json()).unwrap();
    let worse = run(&["--compare", "better.json"]);
    let said = String::from_utf8_lossy(&worse.stdout).into_owned();
    assert_eq!(worse.status.code(), Some(1), "{said}");
    assert!(said.contains("WORSE  lambert under furnace, uniform: relMSE"), "{said}");
}

#[test]
fn a_plan_that_measures_nothing_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, line) in [
        (
            vec!["bench", "--preset", "quick", "ggx"],
            "--preset quick: it has scenes and integrators",
        ),
        (
            vec!["bench", "--preset", "quik"],
            "--preset quik: there is no such preset; for a benchmark: quick, seed, hard; for the BRDF: ",
        ),
        (vec!["bench", "--integrators", "cosine,cosine"], "cosine: this integrator is named twice"),
        (vec!["bench", "ggx", "ggx"], "ggx under studio: two cases are called so"),
        (
            vec!["bench", "--maps", "nowhere", "--device", "cpu"],
            "nowhere: there is no file and no recipe",
        ),
        (vec!["bench", "--json", "a.txt"], "--json a.txt: this option writes JSON"),
        (vec!["bench", "--compare", "none.json"], "none.json: there is no such file"),
        (vec!["bench", "--time", "0"], "--time 0: this is no positive number"),
        (vec!["bench", "--iset", "nothing=1"], "--iset nothing=1: none of the integrators"),
        (vec!["bench", "ggx", "--scenes", "."], "--scenes: scenes have a BRDF, a map and a shape"),
        (vec!["bench", "--scenes", "."], ".: neither it nor a folder in it holds a scene.toml"),
        (vec!["bench", "--scenes", "no.toml"], "no.toml: "),
        (vec!["bench", "--md", "a.txt"], "--md a.txt: this option writes Markdown"),
        (vec!["recommend", "--time", "-1"], "--time -1: this is no positive number"),
        (vec!["recommend", "--integrators", "nobody"], "nobody: "),
    ] {
        let found = brdf(folder.path(), &arguments);
        let said = String::from_utf8_lossy(&found.stderr).into_owned();
        assert_eq!(found.status.code(), Some(2), "{arguments:?}: {said}");
        assert!(said.starts_with(&format!("error: {line}")), "{arguments:?}: {said}");
        assert_eq!(said.trim_end().lines().count(), 1, "{said}");
    }
}

/// Whatever the scene, samples are numbers. The large map is left out: it takes half a gigabyte.
#[test]
fn no_hard_scene_makes_samples_that_are_no_numbers() {
    let all = scenes(&registry(), &[root().join("examples/hard")]).unwrap();
    assert!(all.len() >= 13 && all.iter().all(|case| !case.about.is_empty()));
    let integrators = [integrator("mis-balance"), integrator("brdf-is")];
    let limits = Limits { time: 0.05, ..Limits::default() };
    let mut cores = open(Some("cpu"), Precision::F32).unwrap().executor;
    for mut case in all.into_iter().filter(|case| case.name != "large-map") {
        case.scene.film.resolution = [24, 24];
        let found =
            recommend(&registry(), &case, &integrators, cores.as_mut(), &limits, &mut |_| true);
        for trial in found.unwrap() {
            assert!(trial.problem.is_none() && trial.done > 0, "{}: {trial:?}", case.name);
            assert_eq!(trial.nonfinite, 0, "{}", case.name);
        }
    }
}

/// The ancestor's table: each BRDF by four integrators and two numbers of samples, and by sums over three cubes.
#[test]
fn the_ancestors_table_counts_samples_as_it_did() {
    let mut plan = Preset::Seed.plan(&registry()).unwrap();
    plan.check().unwrap();
    assert_eq!(plan.rows.len(), 3 * 5);
    let cells: usize = plan.rows.iter().map(|row| row.integrators.len()).sum();
    assert_eq!(cells, 3 * (2 * 4 + 3));
    assert!(plan.rows.iter().all(|row| row.case.scene.film.resolution == [512; 2]));

    // 75 samples are no power of two; and no limit of time or of all cells ends them later.
    plan.rows.truncate(1);
    plan.rows[0].case.scene.film.resolution = [16, 16];
    plan.rows[0].case.scene.environment.face = Some(8);
    plan.limits = Limits { time: 1e9, repeats: 2, ..Limits::default() };
    let store = tempfile::tempdir().unwrap();
    let found = report(&plan, store.path());
    for cell in &found.cells {
        let done: Vec<u64> = cell.steps.iter().map(|step| step.spp).collect();
        assert_eq!(done, [16, 32, 64, 75], "{}", cell.integrator);
    }
    plan.limits.samples = 70;
    let found = report(&plan, store.path());
    assert_eq!(found.cells[0].last().unwrap().spp, 70);
}

/// A sum whose first texels take longer than there is time for is given up, and said to be.
#[test]
fn time_ends_a_sum_that_does_not_get_anywhere() {
    let mut plan = plan(64, 0);
    plan.rows.truncate(1);
    let store = tempfile::tempdir().unwrap();
    // With the reference at hand, only the sum is out of time.
    report(&plan, store.path());
    plan.rows[0].integrators.push(integrator("convolution"));
    plan.limits.time = 1e-12;
    let found = report(&plan, store.path());
    let problem = found.cells.last().unwrap().problem.clone().unwrap();
    assert!(problem.contains("were not enough for its first 4096 texels"), "{problem}");
    assert!(found.cells[0].problem.is_none() && !found.cells[0].steps.is_empty());
}

/// The program has the hard scenes with it, and writes them where they can be looked at and rendered.
#[test]
fn the_hard_scenes_come_with_the_program() {
    let folder = tempfile::tempdir().unwrap();
    let run = || {
        Command::new(env!("CARGO_BIN_EXE_brdf"))
            .current_dir(folder.path())
            .env("XDG_CACHE_HOME", folder.path().join("cache"))
            .args(["bench", "--preset", "hard", "--time", "0"])
            .output()
            .unwrap()
    };
    // Only what it would measure is made; no time is none.
    assert_eq!(run().status.code(), Some(2));
    let written = folder.path().join("cache/brdf/scenes/hard");
    let shipped = root().join("examples/hard");
    for entry in walk(&shipped) {
        let name = entry.strip_prefix(&shipped).unwrap();
        let text = std::fs::read(&entry).unwrap();
        assert_eq!(std::fs::read(written.join(name)).ok(), Some(text), "{}", name.display());
    }
    let named = |folder: &Path| -> Vec<String> {
        let cases = scenes(&registry(), &[folder.to_owned()]).unwrap();
        cases.into_iter().map(|case| case.name).collect()
    };
    assert_eq!(named(&written), named(&shipped));

    // What somebody has changed there is as it was shipped the next time.
    let changed = written.join("black/scene.toml");
    std::fs::write(&changed, "format = 7").unwrap();
    run();
    assert_ne!(std::fs::read(&changed).unwrap(), b"format = 7");
}

fn walk(folder: &Path) -> Vec<std::path::PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let within = |path: std::path::PathBuf| if path.is_dir() { walk(&path) } else { vec![path] };
    entries.flat_map(within).collect()
}

fn integrator(id: &str) -> Chosen {
    Chosen::find(&registry(), Kind::Integrator, id).unwrap()
}

/// Under a sun, samples of the map find what those of the plain integrator do not: the trial says so.
#[test]
fn the_one_to_use_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let found = brdf(
        folder.path(),
        &[
            "recommend",
            "lambert",
            "--ibl",
            "sky-with-sun",
            "--ibl-width",
            "512",
            "--resolution",
            "48",
            "--time",
            "1",
            "--device",
            "cpu",
            "--integrators",
            "uniform,env-is,convolution",
        ],
    );
    let said = String::from_utf8_lossy(&found.stdout).into_owned();
    assert!(found.status.success(), "{said}{}", String::from_utf8_lossy(&found.stderr));
    assert!(said.contains("use env-is:\n  brdf render lambert"), "{said}");
    // Which of both depends on the machine: how far it comes, or that its first texels take too long.
    let told = ["the whole sum takes about", "were not enough for its first"];
    assert!(told.iter().any(|line| said.contains(line)), "{said}");
}
