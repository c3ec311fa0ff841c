//! `brdf numerics`: the right lines are blamed, and what is right blames nobody. No device is needed.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    reason = "a test says what it expects by unwrapping"
)]

mod common;

use std::io::Write;
use std::process::Stdio;
use std::sync::Arc;

use brdf_host::exec::cpu::Cpu;
use brdf_host::exec::{Executor, Precision};
use brdf_host::link::{Function, View, link};
use brdf_host::numerics::{FunctionReport, Report, measure};
use brdf_host::plugin::Configured;
use brdf_host::render::evaluate::{Pair, evaluate};
use common::program::{folder, run, text};
use common::{brdf, devices, from_text, root};
use serde_json::Value;

const BRDF: &str = "kind = \"brdf\"\nname = \"B\"\nabout = \"B.\"\n";

fn measured(brdf: &Configured, fixed: &[&str]) -> Report {
    let fixed: Vec<String> = fixed.iter().map(|key| (*key).to_owned()).collect();
    measure(brdf, &fixed).unwrap()
}

fn of(report: &Report, function: Function) -> &FunctionReport {
    report.functions.iter().find(|found| found.function == function).unwrap()
}

/// A BRDF whose `eval` returns an expression.
fn returning(expression: &str) -> Configured {
    from_text(
        "returning",
        BRDF,
        &format!(
            "fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {{\n    return vec3f({expression});\n}}"
        ),
    )
}

/// Half of GGX's digits are gone in d = NoH^2 (a^2 - 1) + 1 where NoH is 1 - a^2: with alpha = 0.001
/// one rounding of NoH, 2^-24, is 6 % of a^2.
#[test]
fn the_textbook_ggx_loses_its_digits_in_the_line_with_noh() {
    let report = measured(&brdf("ggx-textbook", &["alpha=0.001"]), &["alpha"]);
    for function in [Function::Eval, Function::Pdf] {
        let found = of(&report, function);
        let worst = &found.lines[0];
        assert!(worst.excerpt.contains("(noh * noh) * (a2 - 1.0) + 1.0"), "{worst:?}");
        assert!(worst.is_author && worst.error > 1e-3 && worst.cancelled_bits > 12.0, "{worst:?}");
        // Neither who rounded before it nor who hands the error on. The density also divides by
        // dot(wo, h), which cancels where both directions graze.
        let others = found.lines[1..].iter();
        assert!(others.clone().all(|line| line.error < 1e-3), "{:?}", found.lines);
        assert!(
            others.clone().all(|line| line.excerpt.contains("dot(wo, h)")),
            "{:?}",
            found.lines
        );
        assert!(found.errors.largest.unwrap() > 1e-3);
        assert!(found.errors.median.unwrap() < 1e-6);
    }
    // 1 - cos^2, and the inversion that cancels likewise.
    let sample = &of(&report, Function::Sample).lines;
    let blamed: Vec<&str> = sample.iter().map(|line| line.excerpt.trim()).collect();
    let cosine = blamed.iter().position(|line| line.starts_with("let cos2 =")).unwrap();
    let sine = blamed.iter().position(|line| line.starts_with("let sin_theta =")).unwrap();
    assert!(cosine < 2 && sine < 2, "{blamed:?}");
}

/// What was measured, with half as much again: 7.2e-7 in pdf, 1.5e-6 in eval, 1.2e-6 in weight.
/// Some ten roundings of 6e-8 add up to that.
#[test]
fn the_shipped_ggx_has_rounding_alone() {
    for f0 in ["f0=0.0001", "f0=0.9"] {
        let report = measured(&brdf("ggx", &[f0]), &["f0"]);
        for (function, bound) in
            [(Function::Eval, 2.2e-6), (Function::Pdf, 1.1e-6), (Function::Weight, 1.8e-6)]
        {
            let found = of(&report, function);
            let largest = found.errors.largest.unwrap();
            assert!(found.errors.nonfinite == 0 && largest < bound, "{function:?}: {largest}");
            assert!(found.lines.is_empty(), "{:?}", found.lines);
        }
        // Where the cap's point and the view are opposite, the half vector is nothing but rounding:
        // at the rim, u.y = 1 - 2^-24.
        let sample = of(&report, Function::Sample);
        assert!(sample.errors.percentile_99.unwrap() < 1e-5, "{:?}", sample.errors);
        assert!(sample.errors.worst.as_ref().unwrap().u[1] > 0.999_999);
        assert!(sample.lines.iter().all(|line| line.excerpt.contains("let half_std =")));
    }
    // Black at normal incidence: what is left are products below the smallest normal f32.
    let report = measured(&brdf("ggx", &["f0=0"]), &["f0"]);
    let eval = of(&report, Function::Eval);
    assert!(eval.errors.percentile_99.unwrap() < 2e-6, "{:?}", eval.errors);
    assert!(eval.errors.worst.as_ref().unwrap().f64[0] < 1e-36, "{:?}", eval.errors);
}

/// Rows come as f32, whose vectors are off the unit sphere by some 1e-8. In f64 that would make the half vector of this
/// pair, near the mirror direction and near the horizon, lean by its own angle to both: V H would be -1.1e-5 and L H
/// 2.1e-4, and textbook models with a V H in them would not be reciprocal.
#[test]
fn directions_are_unit_vectors_in_f64() {
    let wo = [0.798_635_5, 0.601_815_04, 0.0001];
    let wi = [-0.798_629_6, -0.601_822_9, 0.000_101_736_485];
    let source = "fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {\n\
                  let h = normalize(wo + wi);\n\
                  return vec3f(dot(wo, h), dot(wi, h), dot(wi, wi) - 1.0);\n}";
    let manifest = "kind = \"brdf\"\nname = \"Half\"\nabout = \"For a test.\"\n";
    let half = from_text("half", manifest, source);
    let program = Arc::new(link(&View::Eval { brdf: half.clone() }).unwrap());
    let mut oracle = Cpu::new(Precision::F64);
    let found = evaluate(&mut oracle, &program, &half, &[Pair { wo, wi }]).unwrap();
    let [v, l, length] = found[0].f;
    assert!((v - l).abs() < 1e-7 * l && l > 0.0, "{v} and {l}");
    assert!(length.abs() < 1e-14, "{length:e}");
}

/// The prelude's log1p and expm1 keep their digits near 0 and on both sides of where the series end: in f64
/// 2e-8 is left by the series; in f32 a device's exp may be off by 3 + 2 |x| ulp, which is 2.3e-6 at 8.
#[test]
fn the_prelude_keeps_digits_near_zero() {
    let tiny = [1e-30, 1e-12, 1e-7, 1e-4, 0.01, 0.1, 0.3, 0.499, 0.5, 0.501, 0.7, 0.99];
    let pairs: Vec<Pair> = tiny
        .iter()
        .flat_map(|x| [*x, -*x])
        .map(|x: f32| Pair { wo: [0.0, 0.0, 1.0], wi: [x, 0.0, (1.0 - x * x).sqrt()] })
        .collect();
    type Exact = fn(f64) -> f64;
    let functions: [(&str, Exact); 4] = [
        ("log1p(wi.x)", f64::ln_1p),
        ("expm1(wi.x)", f64::exp_m1),
        ("log1p(4.0 * max(wi.x, 0.0))", |x| (4.0 * x.max(0.0)).ln_1p()),
        ("expm1(8.0 * wi.x)", |x| (8.0 * x).exp_m1()),
    ];
    let oracle: Box<dyn Executor> = Box::new(Cpu::new(Precision::F64));
    let with_bounds = devices().into_iter().map(|device| (device, 3e-6));
    for (mut device, bound) in std::iter::once((oracle, 2e-8)).chain(with_bounds) {
        for (expression, expected) in functions {
            let brdf = returning(expression);
            let program = Arc::new(link(&View::Eval { brdf: brdf.clone() }).unwrap());
            let found = evaluate(device.as_mut(), &program, &brdf, &pairs).unwrap();
            for (pair, found) in pairs.iter().zip(found) {
                // In f64 the row is made a unit vector again.
                let [x, _, z] = pair.wi.map(f64::from);
                let expected = expected(x / x.hypot(z));
                let off = (found.f[0] - expected).abs();
                let name = device.name();
                assert!(
                    off <= bound * expected.abs(),
                    "{name}: {expression} at {}: {} and not {expected}",
                    pair.wi[0],
                    found.f[0]
                );
            }
        }
    }
}

#[test]
fn a_lambert_has_nothing_to_blame() {
    let report = measured(&brdf("lambert", &[]), &[]);
    assert_eq!(report.functions.len(), 4);
    for found in &report.functions {
        assert!(found.lines.is_empty() && found.unblamed.cases == 0, "{found:?}");
        // Angles: the radius and the azimuth, 2^-24 each, and 2 pi of a turn.
        assert!(found.errors.largest.unwrap() < 4e-7, "{found:?}");
        assert_eq!(found.errors.nonfinite + found.errors.nonfinite_in_f64, 0);
    }
}

/// (z + 1000) - 1000 is 0 in f32 for z below 3e-5, and z in f64.
#[test]
fn what_is_not_finite_is_counted_and_told_apart() {
    let x = "((wo.z + 1000.0) - 1000.0)";
    let report = measured(&returning(&format!("{x} / {x}")), &[]);
    let found = of(&report, Function::Eval);
    assert!(found.errors.nonfinite > 100 && found.errors.nonfinite_in_f64 == 0, "{found:?}");
    let first = found.errors.first_nonfinite.as_ref().unwrap();
    assert!(first.f32[0].is_nan() && (first.f64[0] - 1.0).abs() < 1e-6, "{first:?}");
    assert_eq!(found.lines[0].line, 2);

    let report = measured(&returning("(wo.x - wo.x) / (wi.z - wi.z)"), &[]);
    let found = of(&report, Function::Eval);
    assert_eq!((found.errors.nonfinite, found.errors.nonfinite_in_f64), (0, found.errors.cases));
    assert!(found.lines.is_empty() && found.errors.median.is_none());

    let report = measured(&returning("(1e30 + wo.z) * (1e30 + wi.z)"), &[]);
    let found = of(&report, Function::Eval);
    assert_eq!(found.errors.beyond_f32, found.errors.cases);
}

/// The cosine of nearly a right angle has no right digit, and the result does not care.
#[test]
fn an_error_that_reaches_no_result_blames_nobody() {
    let source = "fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    let idle = cos(1.5707963 + 1e-9 * wo.z);
    let difference = (1.0 + 1e-4 * (1.5 + wo.z * wi.z)) - 1.0;
    return vec3f(difference + 1e-12 * idle);
}";
    let report = measured(&from_text("idle", BRDF, source), &[]);
    let lines = &of(&report, Function::Eval).lines;
    assert_eq!(lines.iter().map(|line| line.line).collect::<Vec<_>>(), [3], "{lines:?}");
}

#[test]
fn each_option_of_a_choice_is_measured() {
    let manifest = format!(
        "{BRDF}[params.form]\ntype = \"choice\"\ndefault = \"good\"\noptions = [\"good\", \"bad\"]\nabout = \"A.\"\n"
    );
    let source = "fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    if FORM == FORM_GOOD {
        return vec3f(wo.z);
    }
    return vec3f((wo.z + 1.0) - 1.0);
}";
    let plugin = from_text("forms", &manifest, source);
    let varied = measured(&plugin, &[]);
    let found = of(&varied, Function::Eval);
    assert_eq!(found.lines[0].line, 5);
    let set = &found.errors.worst.as_ref().unwrap().parameters;
    assert_eq!(set[..], [("form".to_owned(), "bad".to_owned())]);
    assert!(of(&measured(&plugin, &["form"]), Function::Eval).lines.is_empty());
}

#[test]
fn measuring_is_a_function_of_its_input() {
    let once = || serde_json::to_string(&measured(&brdf("ggx-textbook", &[]), &[])).unwrap();
    assert_eq!(once(), once());
}

#[test]
fn a_loop_without_an_end_is_told_at_its_place() {
    let problem = measure(&brdf("endless", &[]), &[]).unwrap_err();
    assert!(problem.thing.ends_with("endless.wgsl"), "{problem}");
    assert!((3..=5).contains(&problem.place.as_ref().unwrap().line), "{problem}");
    assert!(problem.reason.contains("does not come to an end"), "{problem}");
}

fn program(arguments: &[&str]) -> (Option<i32>, String, String) {
    let plugins = root().join("tests/fixtures").display().to_string();
    let all = [&["--plugins", &plugins, "numerics"], arguments].concat();
    let output = run(folder().path(), &all);
    (output.status.code(), text(&output.stdout), text(&output.stderr))
}

#[test]
fn the_report_is_text_or_json_and_options_fix_parameters() {
    let (code, out, error) = program(&["ggx-textbook", "--set", "alpha=0.001"]);
    assert_eq!(code, Some(0), "{error}");
    assert!(out.contains("with alpha fixed"), "{out}");
    assert!(out.contains("ggx-textbook.wgsl:6\n"), "{out}");
    assert!(out.contains("(noh * noh) * (a2 - 1.0) + 1.0"), "{out}");
    assert!(out.lines().all(|line| line.chars().count() <= 100), "{out}");

    let all = ["fresnel=schlick", "masking=separable", "eta=1.5"];
    let all = [&all[..], &["metal_eta=1,1,1", "metal_k=0,0,0"]].concat();
    let all = all.iter().flat_map(|set| ["--set", set]);
    let arguments = ["ggx", "--preset", "gold", "--json"].into_iter().chain(all);
    let (code, out, error) = program(&arguments.collect::<Vec<_>>());
    assert_eq!(code, Some(0), "{error}");
    let report: Value = serde_json::from_str(&out).unwrap();
    let names: Vec<&str> = report["functions"]
        .as_array()
        .unwrap()
        .iter()
        .map(|f| f["function"].as_str().unwrap())
        .collect();
    assert_eq!(names, ["eval", "pdf", "sample", "weight"]);
    let eval = &report["functions"][0];
    assert_eq!(eval["settings"], 1, "all parameters are fixed");
    for key in ["cases", "nonfinite", "median", "percentile_99", "largest", "worst", "lines"] {
        assert!(!eval[key].is_null(), "{key} is missing: {eval}");
    }
}

/// The row that is told for the worst case gives the reported value when it is pasted.
#[test]
fn the_worst_row_is_reproduced_by_eval() {
    let (_, out, _) = program(&["ggx-textbook", "--json"]);
    let report: Value = serde_json::from_str(&out).unwrap();
    let worst = &report["functions"][0]["worst"];
    let numbers = |key: &str| -> Vec<f32> {
        worst[key].as_array().unwrap().iter().map(|n| n.as_f64().unwrap() as f32).collect()
    };
    let row: Vec<String> =
        [numbers("wo"), numbers("wi")].concat().iter().map(|n| n.to_string()).collect();
    let plugins = root().join("tests/fixtures").display().to_string();
    let mut arguments = vec!["--plugins", &plugins, "eval", "ggx-textbook", "--device", "cpu"];
    let set: Vec<String> = worst["parameters"]
        .as_array()
        .unwrap()
        .iter()
        .map(|pair| format!("{}={}", pair[0].as_str().unwrap(), pair[1].as_str().unwrap()))
        .collect();
    set.iter().for_each(|set| arguments.extend(["--set", set]));
    let folder = folder();
    let mut eval = common::program::brdf(folder.path(), &arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    eval.stdin.take().unwrap().write_all(row.join(" ").as_bytes()).unwrap();
    let printed = text(&eval.wait_with_output().unwrap().stdout);
    let values: Vec<f32> =
        printed.lines().nth(1).unwrap().split(',').take(3).map(|n| n.parse().unwrap()).collect();
    assert_eq!(values, numbers("f32"), "{printed}");
}

#[test]
fn bad_input_is_one_line_and_exit_code_2() {
    for (arguments, told) in [
        (&["no-such-brdf"][..], "no-such-brdf"),
        (&["brdf-is"], "brdf-is"),
        (&["ggx", "--set", "alpha=0.1"], "alpha=0.1"),
        (&["ggx", "--set", "alpha_x=2"], "alpha_x=2"),
        (&["ggx", "--set", "alpha_x"], "alpha_x"),
        (&["ggx", "--preset", "golden"], "--preset golden"),
    ] {
        let (code, out, error) = program(arguments);
        assert_eq!((code, out.as_str()), (Some(2), ""), "{arguments:?}: {error}");
        let problems: Vec<_> = error.lines().filter(|l| l.starts_with("error: ")).collect();
        assert!(problems.len() == 1 && problems[0].contains(told), "{arguments:?}: {error}");
    }
}
