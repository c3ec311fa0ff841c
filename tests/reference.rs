//! References: written where samples agree with them, refused with both numbers where they do not.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    reason = "a test says what it expects by unwrapping"
)]

mod common;

use std::fs;
use std::path::Path;
use std::process::Output;

use common::program::{folder, refused, run, text};
use common::root;
use serde_json::Value;

/// More samples than any check here needs.
const MANY: &str = "16384";

/// `reference` of a small scene on the cores. The check ends by its samples and never by the clock, so
/// that all machines find the same.
fn reference(folder: &Path, samples: &str, more: &[&str]) -> Output {
    let fixtures = root().join("tests/fixtures");
    let mut arguments = vec!["--plugins", fixtures.to_str().unwrap(), "reference"];
    arguments.extend(["--device", "cpu", "--resolution", "16", "--ibl-width", "64"]);
    arguments.extend(["--check-time", "1000", "--check-samples", samples]);
    arguments.extend_from_slice(more);
    run(folder, &arguments)
}

fn json(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout)
        .unwrap_or_else(|_| panic!("{} {}", text(&output.stdout), text(&output.stderr)))
}

/// Lambert in a furnace of radiance 1 is its albedo, and `brdf-is` knows it without noise: cos / (cos / pi) / pi.
#[test]
fn in_a_furnace_both_ways_give_the_albedo() {
    let folder = folder();
    let scene = ["lambert", "--ibl", "furnace", "--against", "brdf-is", "--json"];
    let output =
        reference(folder.path(), MANY, &[&scene[..], &["--set", "albedo=0.25,0.5,1"]].concat());
    assert!(output.status.success(), "{}", text(&output.stderr));
    let report = json(&output);
    assert_eq!(report["check"]["finding"], "agrees");
    for (channel, albedo) in [0.25, 0.5, 1.0].into_iter().enumerate() {
        let by = |which: &str| report["check"]["picture"][channel][which].as_f64().unwrap();
        assert!((by("reference") / albedo - 1.0).abs() < 5e-5, "{report}");
        assert!((by("found") / albedo - 1.0).abs() < 1e-6, "{report}");
    }
    // The picture is the reference and not the samples: a sum over texels, with nothing of noise.
    assert_eq!((&report["integrator"], &report["spp"]), (&"convolution".into(), &0.into()));
    assert!(report["std_error"].is_null());
    assert!(folder.path().join("lambert-reference.png").exists());
}

/// In a furnace all that quadrature can miss lies along the horizon, which cuts large texels. In f64, so that
/// f32's sums of many small terms do not hide it: what is missed is no more than what is estimated.
#[test]
fn quadrature_is_no_more_wrong_than_it_says() {
    let folder = folder();
    for tolerance in ["tolerance=1e-3", "tolerance=1e-5"] {
        let scene = ["render", "lambert", "--set", "albedo=1,1,1", "--ibl", "furnace"];
        let small = ["--ibl-width", "16", "--resolution", "8", "--precision", "f64", "--json"];
        let by = ["--rendering", "convolution", "--iset", tolerance];
        let report = json(&run(folder.path(), &[&scene[..], &small[..], &by[..]].concat()));
        let mean = report["mean"][0].as_f64().unwrap();
        let estimated = report["sum"]["error"].as_f64().unwrap();
        assert!((mean - 1.0).abs() < estimated && estimated < 2e-3, "{report}");
    }
}

#[test]
fn a_reference_says_in_its_header_what_it_was_checked_against() {
    let folder = folder();
    let scene = ["ggx", "--set", "alpha_x=0.4", "--set", "alpha_y=0.4", "--ibl", "studio"];
    let output = reference(folder.path(), MANY, &[&scene[..], &["--export", "r"]].concat());
    let told = text(&output.stdout);
    assert!(output.status.success(), "{told} {}", text(&output.stderr));
    let meta = exr::meta::MetaData::read_from_file(folder.path().join("r.exr"), false).unwrap();
    let fact = |name: &str| {
        let others = &meta.headers[0].own_attributes.other;
        let found = others.iter().find(|(key, _)| *key == name).map(|(_, value)| value.clone());
        match found {
            Some(exr::meta::attribute::AttributeValue::Text(text)) => text.to_string(),
            other => panic!("{name}: {other:?}"),
        }
    };
    let sentence = fact("brdf.reference");
    assert!(sentence.starts_with("checked against mis-balance, "), "{sentence}");
    assert!(told.contains(&sentence), "{told}");
    let check: Value = serde_json::from_str(&fact("brdf.check")).unwrap();
    assert_eq!((&check["finding"], &check["by"]), (&"agrees".into(), &"convolution".into()));
    assert!(fact("brdf.integrator_params").contains("\"tolerance\":0.00001"));

    // Rendered from its own header it is the same picture.
    let again = run(
        folder.path(),
        &["render", "--device", "cpu", "--session", "r.exr", "--export", "again"],
    );
    assert!(again.status.success(), "{}", text(&again.stderr));
    let bytes = |name: &str| fs::read(folder.path().join(name)).unwrap();
    assert!(bytes("r.png") == bytes("again.png"));
}

/// Samples whose pdf is 1.1 times their density: f cos / p is 1 / 1.1 of the albedo with `brdf-is`. With one
/// sample of each technique, densities c = cos / pi and u = 1 / (4 pi), a direction is weighed by
/// (c + u) / (1.1 c + u), which falls short by up to 9 % too.
#[test]
fn a_wrong_pdf_is_refused_with_both_numbers() {
    let folder = folder();
    let scene = ["pdf-too-large", "--ibl", "furnace"];
    let output = reference(folder.path(), MANY, &[&scene[..], &["--against", "brdf-is"]].concat());
    let told = text(&output.stdout);
    assert_eq!(output.status.code(), Some(1), "{told} {}", text(&output.stderr));
    assert!(told.starts_with("REFUSED: convolution and brdf-is disagree\n"), "{told}");
    // 1 by quadrature (0.99998 and more), 1 / 1.1 by samples.
    assert!(told.contains("convolution 9.999") || told.contains("convolution 1.000"), "{told}");
    // Sums of 1024 equal samples, in f32, may be off by 2^-19 of them: all are rounded the same way.
    assert!(
        ["89", "90", "91", "92"]
            .iter()
            .any(|end| told.contains(&format!("brdf-is 9.090{end}e-1 +- "))),
        "{told}"
    );
    assert!(told.contains("worst tile, x ") && told.contains("no file was written"), "{told}");

    let output = reference(folder.path(), MANY, &[&scene[..], &["--json", "--undecided"]].concat());
    assert_eq!(output.status.code(), Some(1));
    let check = json(&output);
    assert_eq!(
        (&check["finding"], &check["against"]),
        (&"disagrees".into(), &"mis-balance".into())
    );
    // With x = cos the integral of cos / pi (c + u) / (1.1 c + u) over the hemisphere is that of
    // 2 x (4 x + 1) / (4.4 x + 1) from 0 to 1. Since (4 x + 1) / (4.4 x + 1) = 10/11 + (1/11) / (4.4 x + 1)
    // and 2 x / (4.4 x + 1) integrates to 2 / 4.4 (1 - ln(5.4) / 4.4), it is 0.9346.
    let expected = 10.0 / 11.0 + 2.0 / 4.4 * (1.0 - 5.4f64.ln() / 4.4) / 11.0;
    let found = check["picture"][0]["found"].as_f64().unwrap();
    let error = check["picture"][0]["std_error"].as_f64().unwrap();
    assert!((found - expected).abs() < 5.0 * error && error < 2e-3, "{check} {expected}");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

/// A hemisphere's uniform directions meet the one bright texel rarely: their spread is far above 0.2 %.
#[test]
fn what_cannot_be_decided_is_refused_unless_it_is_asked_for() {
    let folder = folder();
    let scene = ["lambert", "--ibl", "single-texel", "--against", "uniform", "--export", "u"];
    let output = reference(folder.path(), "64", &scene);
    let told = text(&output.stdout);
    assert_eq!(output.status.code(), Some(1), "{told}");
    assert!(
        told.starts_with("REFUSED: undecided, the standard error of the picture, red"),
        "{told}"
    );
    assert!(told.contains("convolution ") && told.contains("uniform ") && told.contains(" 64 spp"));
    assert!(told.contains("--undecided"), "{told}");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);

    let output = reference(folder.path(), "64", &[&scene[..], &["--undecided"]].concat());
    let told = text(&output.stdout);
    assert!(output.status.success(), "{told}");
    assert!(told.contains("  unchecked, the standard error of the picture, red"), "{told}");
    assert!(folder.path().join("u.exr").exists());
}

/// Samples that are not finite count as zero: whatever their mean is, it checks nothing.
#[test]
fn samples_that_are_not_finite_decide_nothing() {
    let folder = folder();
    let output = reference(folder.path(), MANY, &["nan-sample", "--ibl", "furnace", "--json"]);
    let check = json(&output);
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(check["finding"], "undecided", "{check}");
    let doubt = check["doubt"].as_str().unwrap();
    assert!(doubt.ends_with("samples of mis-balance are not finite"), "{doubt}");
}

#[test]
fn bad_input_is_told_in_one_line() {
    let folder = folder();
    let small = ["reference", "--device", "cpu", "--resolution", "8", "--ibl-width", "8"];
    for (more, expected) in [
        (vec!["--by", "uniform"], "--by uniform: it draws samples, and a reference has no noise"),
        (
            vec!["--against", "convolution"],
            "--against convolution: it adds up terms, and tells nothing",
        ),
        (vec!["--against", "none"], "none: there is no integrator of this name"),
        (vec!["--check-time", "0"], "--check-time 0: this is no positive number"),
        (vec!["--check-time", "nan"], "--check-time NaN: this is no positive number"),
        (vec!["--iset", "tolerance=2"], "tolerance"),
        (vec!["--iset", "toleranse=1e-5"], "toleranse"),
        (vec!["--export", "no/r"], "no/r.exr: the file cannot be written"),
        (vec!["--camera", "distance=100000"], "the scene: the object covers no pixel"),
        (vec!["none"], "none: there is no brdf of this name"),
    ] {
        let line = refused(folder.path(), &[&small[..], &more[..]].concat());
        assert!(line.contains(expected), "{line}");
    }
    let output = run(folder.path(), &["reference", "--check-samples", "1"]);
    assert_eq!(output.status.code(), Some(2));
}
