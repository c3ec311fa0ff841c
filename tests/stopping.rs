//! When a picture is done, and what it says of itself: time, error, Ctrl-C, standard errors in the file.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    reason = "a test says what it expects by unwrapping"
)]

mod common;

use common::program::{folder, refused, run, text};
use serde_json::Value;

/// A small picture on the cores, with more arguments; its report.
fn report(folder: &std::path::Path, more: &[&str]) -> Value {
    let mut arguments = vec![
        "render",
        "ggx",
        "--device",
        "cpu",
        "--resolution",
        "24",
        "--json",
        "--set",
        "alpha_x=0.5",
    ];
    arguments.extend(["--set", "alpha_y=0.5"]);
    arguments.extend_from_slice(more);
    let output = run(folder, &arguments);
    assert!(output.status.success(), "{}", text(&output.stderr));
    serde_json::from_str(&text(&output.stdout)).unwrap()
}

#[test]
fn a_time_ends_it() {
    let folder = folder();
    let report = report(folder.path(), &["--time", "0.2"]);
    assert_eq!(report["stopped"], "time");
    assert_eq!(report["unfinished"], false);
    assert!(report["spp"].as_u64().unwrap() > 0 && report["passes"].is_null());
}

/// The error ends it where the samples have doubled, after the least number, and below what was asked.
#[test]
fn an_error_ends_it_at_a_doubling() {
    let folder = folder();
    let report = report(folder.path(), &["--rendering", "mis-balance", "--error", "1e-3"]);
    assert_eq!(report["stopped"], "error");
    let spp = report["spp"].as_u64().unwrap();
    assert!(spp.is_power_of_two() && spp >= 64, "{spp}");
    assert!(report["relmse_estimate"].as_f64().unwrap() <= 1e-3);
}

#[test]
fn passes_end_it_before_an_error_that_is_out_of_reach() {
    let folder = folder();
    let report = report(folder.path(), &["--error", "1e-30", "--passes", "2", "--samples", "32"]);
    assert_eq!((report["stopped"].as_str(), report["spp"].as_u64()), (Some("passes"), Some(64)));
}

#[test]
fn wrong_rules_are_refused() {
    let folder = folder();
    for (arguments, expected) in [
        (["render", "--time", "0"], "--time 0: this is no positive number"),
        (["render", "--error", "-1"], "--error -1: this is no positive number"),
        (["render", "--error", "nan"], "--error NaN: this is no positive number"),
    ] {
        let line = refused(folder.path(), &arguments);
        assert!(line.contains(expected), "{line}");
    }
}

/// A sum that is stopped is completed on a coarse grid: it has the brightness of the whole, and says that
/// it is biased.
#[test]
fn an_unfinished_sum_is_as_bright_as_the_whole_and_says_so() {
    let folder = folder();
    let sum = ["--rendering", "convolution", "--iset", "order=luminance", "--ibl", "studio"];
    let with = |width: &'static str, more: &[&str]| {
        let mut arguments = sum.to_vec();
        arguments.extend(["--ibl-width", width]);
        arguments.extend_from_slice(more);
        report(folder.path(), &arguments)
    };
    let whole = with("64", &[]);
    assert_eq!(
        (whole["biased"].as_bool(), whole["stopped"].as_str()),
        (Some(false), Some("passes"))
    );
    // A map too large to be summed up in this time, of the same light.
    let part = with("2048", &["--time", "0.3"]);
    assert_eq!((part["biased"].as_bool(), part["unfinished"].as_bool()), (Some(true), Some(true)));
    assert!(part["sum"]["texels"].as_u64().unwrap() < part["sum"]["of"].as_u64().unwrap());
    for channel in 0..3 {
        let [part, whole] = [&part, &whole].map(|report| report["mean"][channel].as_f64().unwrap());
        assert!((part / whole - 1.0).abs() < 0.1, "{part} {whole}");
    }
}

/// Ctrl-C writes what there is.
#[cfg(unix)]
#[test]
fn an_interrupt_leaves_a_marked_picture() {
    use std::process::{Command, Stdio};
    let folder = folder();
    let arguments = [
        "render",
        "--device",
        "cpu",
        "--resolution",
        "32",
        "--time",
        "100",
        "--export",
        "a",
        "--json",
    ];
    let child = common::program::brdf(folder.path(), &arguments)
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    std::thread::sleep(std::time::Duration::from_millis(1500));
    Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success());
    let report: Value = serde_json::from_str(&text(&output.stdout)).unwrap();
    assert_eq!(report["stopped"], "interrupted");
    assert_eq!(report["unfinished"], true);
    assert!(folder.path().join("a.exr").exists());
}

/// Two pictures of different seeds differ as their standard errors say: the root mean square of z-scores of
/// 24 x 24 pixels with 15 degrees of freedom each side is sqrt(30 / 28), give or take 5 %.
#[test]
fn the_files_standard_errors_are_those_of_the_pictures() {
    let folder = folder();
    for seed in ["1", "2"] {
        let name = format!("s{seed}");
        report(folder.path(), &["--seed", seed, "--sampler", "independent", "--export", &name]);
    }
    let output = run(folder.path(), &["compare", "s1.exr", "s2.exr", "--json"]);
    let compared: Value = serde_json::from_str(&text(&output.stdout)).unwrap();
    let rms = find(&compared, "rms").expect("compare tells the z-scores");
    assert!((rms - (30.0f64 / 28.0).sqrt()).abs() < 0.1, "{rms}");
}

/// The first number under that key, at any depth.
fn find(value: &Value, key: &str) -> Option<f64> {
    match value {
        Value::Object(map) => map
            .get(key)
            .and_then(Value::as_f64)
            .or_else(|| map.values().find_map(|inner| find(inner, key))),
        _ => None,
    }
}
