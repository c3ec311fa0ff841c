//! The laws themselves are tested: each mutant of tests/mutants/brdf is caught, and by the law that should.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    reason = "a test says what it expects by unwrapping"
)]

mod common;

use std::fs;
use std::path::Path;

use brdf_host::conformance::{Law, Outcome, References, Verdict, Wanted, conform};
use brdf_host::exec::cpu::Cpu;
use brdf_host::exec::{Executor, Precision};
use brdf_host::plugin::Configured;
use brdf_host::session::Chosen;
use brdf_sdk::Kind;
use clap::ValueEnum;
use common::{brdf, devices, from_text, integrator, registry, root};

fn judged(device: &mut dyn Executor, brdf: &Configured, wanted: &Wanted) -> Vec<Verdict> {
    let report = conform(device, brdf, wanted);
    report.unwrap_or_else(|problem| panic!("{}: {problem}", brdf.plugin.id)).verdicts
}

fn opened(folder: &Path) -> Configured {
    Chosen::find(&registry(), Kind::Brdf, folder.to_str().unwrap()).unwrap().configured
}

fn references(file: &str, brdf: &Configured) -> Vec<References> {
    vec![References::load(&root().join("tests/references").join(file), &brdf.plugin).unwrap()]
}

/// `caught_by.txt` names the law, and where it is that of references the file in tests/references.
#[test]
fn every_mutant_is_caught_by_the_law_that_should() {
    let mut seen = 0;
    for entry in fs::read_dir(root().join("tests/mutants/brdf")).unwrap() {
        let folder = entry.unwrap().path();
        let told = fs::read_to_string(folder.join("caught_by.txt")).unwrap();
        let mut words = told.split_whitespace();
        let law = Law::from_str(words.next().unwrap(), false).unwrap();
        let mutant = opened(&folder);
        let references = words.next().map(|file| references(file, &mutant));
        let wanted = Wanted {
            laws: vec![law],
            references: references.unwrap_or_default(),
            ..Wanted::default()
        };
        let found = judged(&mut Cpu::new(Precision::F32), &mutant, &wanted);
        let verdict = found.iter().find(|verdict| verdict.law == law).unwrap();
        assert_eq!(verdict.outcome, Outcome::Failed, "{}: {verdict:?}", mutant.plugin.id);
        let shown = verdict.reproduce.is_some() || verdict.said.contains("remove");
        assert!(shown && !verdict.said.is_empty(), "{verdict:?}");
        seen += 1;
    }
    assert!(seen >= 15, "the mutants are gone");
}

/// The textbook's GGX loses its digits where alpha is 0.001: on every device.
#[test]
fn the_textbook_is_not_stable() {
    let textbook = opened(&root().join("tests/fixtures/brdf/ggx-textbook"));
    let wanted = Wanted { laws: vec![Law::Stability], ..Wanted::default() };
    for mut device in devices() {
        // In f32 its narrowest lobe is one direction: the contract speaks up as well.
        let found = judged(device.as_mut(), &textbook, &wanted);
        let verdict = found.iter().find(|verdict| verdict.law == Law::Stability).unwrap();
        assert_eq!(verdict.outcome, Outcome::Failed, "{verdict:?}");
        assert!(verdict.reproduce.as_ref().unwrap().contains("brdf eval"), "{verdict:?}");
    }
}

/// One that loses 2 % of the light at some azimuths does not show the albedo.
#[test]
fn the_furnace_catches_an_integrator_that_is_wrong() {
    let lambert = brdf("lambert", &[]);
    let wanted = |id: &str| Wanted {
        laws: vec![Law::Furnace],
        integrators: vec![integrator(id, &[])],
        ..Wanted::default()
    };
    for (id, outcome) in [("uniform", Outcome::Passed), ("lost-light", Outcome::Failed)] {
        let found = judged(&mut Cpu::new(Precision::F32), &lambert, &wanted(id));
        assert_eq!(found[0].outcome, outcome, "{found:?}");
    }
}

/// A tenth that is lost at every pixel lies within the noise of each of them, and far outside of that of their mean.
#[test]
fn the_furnace_sees_a_bias_that_no_pixel_shows() {
    let glossy = brdf("ggx", &["alpha_x=0.1", "alpha_y=0.1"]);
    let wanted = |id: &str| Wanted {
        laws: vec![Law::Furnace],
        integrators: vec![integrator(id, &[])],
        ..Wanted::default()
    };
    for (id, outcome) in [("cosine", Outcome::Passed), ("dimmed", Outcome::Failed)] {
        let found = judged(&mut Cpu::new(Precision::F32), &glossy, &wanted(id));
        assert_eq!(found[0].outcome, outcome, "{found:?}");
        assert!(outcome == Outcome::Passed || found[0].said.contains("all pixels"), "{found:?}");
    }
}

/// Few samples of the cosine meet a narrow lobe; those that do not are no proof against it.
#[test]
fn the_furnace_does_not_believe_a_small_spread() {
    let narrow = brdf("ggx", &["alpha_x=0.002", "alpha_y=0.02"]);
    let wanted = Wanted {
        laws: vec![Law::Furnace],
        integrators: vec![integrator("cosine", &[])],
        ..Wanted::default()
    };
    let found = judged(&mut Cpu::new(Precision::F32), &narrow, &wanted);
    assert_eq!(found[0].outcome, Outcome::Passed, "{found:?}");
    assert!(found[0].notes.iter().any(|note| note.contains("too noisy to tell")), "{found:?}");
}

/// A lobe of 9 by 0.6 degrees seen at a grazing angle is a ridge that rules of Gauss step over, also where a
/// diffuse part draws the most of what falls into its cells.
#[test]
fn a_ridge_that_rules_step_over_is_no_wrong_density() {
    let wanted = Wanted { laws: vec![Law::Sampling], ..Wanted::default() };
    for (kd, alpha_y) in [("kd=0,0,0", "alpha_y=0.01"), ("kd=1,1,1", "alpha_y=0.001")] {
        let thin = brdf("ward", &[kd, "ks=1,1,1", alpha_y]);
        let found = judged(&mut Cpu::new(Precision::F32), &thin, &wanted);
        assert_eq!(found[0].outcome, Outcome::Passed, "{found:?}");
    }
}

/// The same BRDF on the same device gives the same numbers.
#[test]
fn verdicts_can_be_made_again() {
    let ggx = brdf("ggx", &[]);
    let wanted =
        Wanted { laws: vec![Law::Finite, Law::Energy, Law::Stability], ..Wanted::default() };
    let mut numbers = (0..2).map(|_| {
        let found = judged(&mut Cpu::new(Precision::F32), &ggx, &wanted);
        found.iter().map(|verdict| verdict.number).collect::<Vec<_>>()
    });
    assert_eq!(numbers.next(), numbers.next());
}

/// A table is filled for each choice of the switches that it reads, whichever comes first; and a value that is
/// NaN, or an albedo over one, is no reference's value.
#[test]
fn references_see_tables_and_nan() {
    let manifest = "kind = \"brdf\"\nname = \"t\"\nabout = \"t\"\n\
        [params.twice]\ntype = \"bool\"\ndefault = false\nabout = \"t\"\n\
        [tables.level]\nsize = [2, 2]\nabout = \"t\"\n";
    let source = "fn fill_level(at: vec2f) -> f32 { return select(1.0, 2.0, TWICE); }\n\
        fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {\n    \
            return vec3f(0.1 * level_at(3u) + 0.0 * sqrt(0.75 - wi.x));\n}\n";
    let levels = from_text("levels", manifest, source);
    let folder = tempfile::tempdir().unwrap();
    let judge = |values: &str| {
        let file = folder.path().join("levels.toml");
        fs::write(&file, format!("brdf = \"levels\"\nsource = \"t\"\n{values}")).unwrap();
        let references = vec![References::load(&file, &levels.plugin).unwrap()];
        let wanted = Wanted { laws: vec![Law::References], references, ..Wanted::default() };
        let found = judged(&mut Cpu::new(Precision::F32), &levels, &wanted);
        found.iter().find(|verdict| verdict.law == Law::References).unwrap().outcome
    };
    let at = |wi: &str, f: f64| format!("wo = [0.0, 0.0, 1.0]\nwi = {wi}\nf = {f}\n");
    let slant = "[0.6, 0.0, 0.8]";
    let both = format!(
        "[[values]]\n{}[[values]]\nset = {{ twice = true }}\n{}",
        at(slant, 0.1),
        at(slant, 0.2)
    );
    assert_eq!(judge(&both), Outcome::Passed);
    assert_eq!(judge(&format!("[[values]]\n{}", at(slant, 0.2))), Outcome::Failed);
    assert_eq!(judge(&format!("[[values]]\n{}", at("[0.8, 0.0, 0.6]", 0.1))), Outcome::Failed);
    assert_eq!(judge("[[values]]\ntheta = 10.0\nalbedo = 0.3\n"), Outcome::Failed);
}
