//! `brdf compare` as its users call it: figures, exit codes, false-colour pictures, bad input.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    reason = "a test says what it expects by unwrapping"
)]

mod common;

use std::fs;
use std::path::Path;

use common::program::{folder, refused, run, small, text};
use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, LayerAttributes, WritableImage,
};
use serde_json::Value;

/// Writes `channels` as a picture of 2x2 pixels.
fn write(folder: &Path, name: &str, channels: &[(&str, [f32; 4])]) {
    let channels = channels
        .iter()
        .map(|(name, values)| AnyChannel::new(*name, FlatSamples::F32(values.to_vec())));
    let channels = AnyChannels::sort(channels.collect());
    let attributes = LayerAttributes::default();
    let layer = Layer::new((2, 2), attributes, Encoding::SMALL_LOSSLESS, channels);
    Image::from_layer(layer).write().to_file(folder.join(name)).unwrap();
}

/// Grey pictures: the reference covers the first two pixels.
fn pair(folder: &Path) {
    let grey = |values: [f32; 4]| [("R", values), ("G", values), ("B", values)];
    write(folder, "a.exr", &grey([1.5, 2.0, 0.25, 0.0]));
    let mut b = grey([1.0, 3.0, 0.0, 0.0]).to_vec();
    b.push(("A", [1.0, 1.0, 0.0, 0.0]));
    write(folder, "b.exr", &b);
}

fn json(folder: &Path, arguments: &[&str]) -> Value {
    let all = [&["compare", "--json"], arguments].concat();
    let output = run(folder, &all);
    assert!(output.status.success(), "{}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn close(value: &Value, expected: f64) {
    let value = value.as_f64().unwrap();
    assert!((value - expected).abs() < 1e-6 * expected.abs().max(1.0), "{value} {expected}");
}

/// Differences 1/2, -1, 1/4, 0.
#[test]
fn figures_by_hand() {
    let folder = folder();
    pair(folder.path());
    let (mse, pixels) = ((0.25 + 1.0 + 0.0625) / 4.0_f64, 4);
    // Over the two covered pixels, whose mean is 2: eps = 0.02^2.
    let relmse = (0.25 / 1.0004 + 1.0 / 9.0004) / 2.0;
    // Over all four: the mean is 1, eps = 0.01^2.
    let relmse_of_all = (0.25 / 1.0001 + 1.0 / 9.0001 + 0.0625 / 0.0001) / 4.0;
    let metrics = [
        ("mse", mse, pixels),
        ("rmse", mse.sqrt(), pixels),
        ("mae", 1.75 / 4.0, pixels),
        ("relmse", relmse, 2),
    ];
    for (metric, figure, pixels) in metrics {
        let found = json(folder.path(), &["a.exr", "b.exr", "--metric", metric]);
        close(&found["figure"], figure);
        assert_eq!((&found["metric"], &found["pixels"]), (&metric.into(), &pixels.into()));
        for channel in 0..3 {
            close(&found["mean_difference"][channel], -0.25);
        }
        assert_eq!((&found["passed"], &found["z"]), (&true.into(), &Value::Null));
    }
    let all = json(folder.path(), &["a.exr", "b.exr", "--all-pixels"]);
    close(&all["figure"], relmse_of_all);
    close(&all["mean_difference"][0], -0.25 / 4.0);
    assert_eq!(all["mean_difference_pixels"], 4);
    // The picture beside itself.
    for metric in ["mse", "relmse", "flip"] {
        let same = json(folder.path(), &["b.exr", "b.exr", "--metric", metric, "--fail", "0"]);
        assert_eq!((&same["figure"], &same["passed"]), (&0.0.into(), &true.into()));
    }
}

#[test]
fn a_check_that_fails_is_exit_code_1() {
    let folder = folder();
    pair(folder.path());
    let code = |limit: &str, more: &[&str]| {
        let all =
            [&["compare", "a.exr", "b.exr", "--metric", "mse", "--fail", limit], more].concat();
        let output = run(folder.path(), &all);
        assert!(output.stderr.is_empty(), "{}", text(&output.stderr));
        (output.status.code(), text(&output.stdout))
    };
    // The MSE is 0.328125, exactly.
    let (passed, told) = code("0.328125", &[]);
    assert!(passed == Some(0) && told.contains("mse 3.281250e-1 over 4 pixels"), "{told}");
    assert!(told.ends_with("passed: --fail 0.328125\n"), "{told}");
    let (failed, told) = code("0.328124", &[]);
    assert!(failed == Some(1) && told.ends_with("FAILED: --fail 0.328124\n"), "{told}");
    let (failed, told) = code("0", &["--json"]);
    assert!(failed == Some(1) && told.contains("\"passed\":false"), "{told}");
}

/// What is not finite enters no figure, is told, and fails a check.
#[test]
fn values_that_are_not_finite_are_counted() {
    let folder = folder();
    pair(folder.path());
    let nan = [
        ("R", [1.5, 9.0, 0.0, 0.0]),
        ("G", [1.5, f32::NAN, 0.0, 0.0]),
        ("B", [1.5, 9.0, 0.0, 0.0]),
    ];
    write(folder.path(), "nan.exr", &nan);
    let arguments = ["compare", "nan.exr", "b.exr", "--metric", "mse", "--fail", "100"];
    let output = run(folder.path(), &arguments);
    let told = text(&output.stdout);
    assert_eq!(output.status.code(), Some(1), "{told}");
    assert!(
        told.contains("over 3 pixels") && told.contains("WARNING: 1 pixels are not finite"),
        "{told}"
    );
    let found = json(folder.path(), &["nan.exr", "b.exr", "--metric", "mse"]);
    close(&found["figure"], 0.25 / 3.0);
    // The coverage of the one that is left.
    let relative = json(folder.path(), &["nan.exr", "b.exr"]);
    close(&relative["figure"], 0.25 / (1.0 + 1e-4));
    assert_eq!((&relative["pixels"], &relative["nonfinite_pixels"]), (&1.into(), &1.into()));
    // Nor do its neighbours see it: a picture that is the reference elsewhere looks the same there.
    let hole = ["R", "G", "B"].map(|channel| (channel, [1.0, f32::INFINITY, 0.0, 0.0]));
    write(folder.path(), "hole.exr", &hole);
    let flip = json(folder.path(), &["hole.exr", "b.exr", "--metric", "flip", "-o", "m.png"]);
    assert_eq!((&flip["figure"], &flip["pixels"]), (&0.0.into(), &3.into()));
    // Nothing left is no figure, and no figure is no success.
    let none = [("R", [f32::INFINITY; 4]), ("G", [0.0; 4]), ("B", [0.0; 4])];
    write(folder.path(), "none.exr", &none);
    for metric in ["mse", "relmse", "flip"] {
        let arguments =
            ["compare", "none.exr", "b.exr", "--metric", metric, "--fail", "9", "--json"];
        let output = run(folder.path(), &arguments);
        assert_eq!(output.status.code(), Some(1));
        assert!(text(&output.stdout).contains("\"figure\":null"), "{}", text(&output.stdout));
    }
}

#[test]
fn z_scores_from_the_standard_errors_of_the_files() {
    let folder = folder();
    pair(folder.path());
    let with = |name: &str, values: [f32; 4], errors: [f32; 4]| {
        let rgb = ["R", "G", "B"].map(|channel| (channel, values));
        let errors = ["std_error.R", "std_error.G", "std_error.B"].map(|name| (name, errors));
        write(folder.path(), name, &[rgb, errors].concat());
    };
    with("x.exr", [1.5, 2.0, 0.25, 0.0], [0.3, 0.25, 0.0, 0.0]);
    with("y.exr", [1.0, 3.0, 0.0, 0.0], [0.4, 0.0, 0.0, 0.0]);
    // z = 0.5 / 0.5 = 1, -1 / 0.25 = -4, one difference without error, one equal pixel.
    let both = json(folder.path(), &["x.exr", "y.exr"]);
    close(&both["z"]["rms"], (17.0_f64 / 2.0).sqrt());
    close(&both["z"]["beyond_3"], 0.5);
    assert_eq!((&both["z"]["values"], &both["z"]["unknown"]), (&6.into(), &0.into()));
    assert_eq!(both["z"]["equal_without_error"], 3);
    assert_eq!(both["z"]["different_without_error"], 3);
    // sqrt(0.09 + 0.16 + 0.0625) over four pixels.
    close(&both["mean_difference_std_error"][1], 0.3125_f64.sqrt() / 4.0);
    // One side alone: z = 0.5 / 0.3 and -4, over the two pixels that b covers.
    let one = json(folder.path(), &["x.exr", "b.exr"]);
    close(&one["z"]["rms"], ((0.25 / 0.09 + 16.0) / 2.0_f64).sqrt());
    assert!(one["notes"][0].to_string().contains("counts as exact"), "{one}");
    let told = run(folder.path(), &["compare", "x.exr", "y.exr", "--map", "z", "-o", "z.png"]);
    let told = text(&told.stdout);
    assert!(told.contains("z: RMS 2.9155, 50.00 % beyond 3, over 6 values"), "{told}");
    assert!(told.contains("3 values DIFFER where the standard error is 0"), "{told}");
    assert!(told.ends_with("wrote z.png\n") && folder.path().join("z.png").exists(), "{told}");
}

#[test]
fn maps_are_pictures_with_a_legend() {
    let folder = folder();
    pair(folder.path());
    let map = |more: &[&str]| {
        let all = [&["compare", "a.exr", "b.exr", "-o", "m.png"], more].concat();
        let output = run(folder.path(), &all);
        assert!(output.status.success(), "{}", text(&output.stderr));
        image::open(folder.path().join("m.png")).unwrap().into_rgb8()
    };
    // Two pixels are 160 pixels wide each. The third has the largest relMSE, the last one none.
    let error = map(&[]);
    assert_eq!(error.width(), 320);
    let brightness =
        |x: u32, y: u32| error.get_pixel(x, y).0.iter().map(|c| u32::from(*c)).sum::<u32>();
    assert!(brightness(0, 160) > brightness(0, 0) && brightness(0, 0) > brightness(160, 0));
    assert!(brightness(160, 0) > brightness(319, 319));
    // A is brighter at first (red), then darker (blue).
    let signed = map(&["--map", "signed"]);
    let [first, second] = [signed.get_pixel(0, 0).0, signed.get_pixel(319, 0).0];
    assert!(first[0] > first[2] && second[2] > second[0], "{first:?} {second:?}");
    for metric in ["mse", "rmse", "mae", "flip"] {
        map(&["--metric", metric]);
    }
}

/// A picture that was shown on a screen is compared as it is, radiance by the display curve.
#[test]
fn a_rendered_picture_looks_like_its_png() {
    let folder = folder();
    let render = |seed: &str, name: &str| {
        let arguments = small(&["--seed", seed, "--export", name, "--ibl", "sky-with-sun"]);
        assert!(run(folder.path(), &arguments).status.success());
    };
    render("1", "p");
    render("2", "q");
    let flip = |a: &str, b: &str| {
        json(folder.path(), &[a, b, "--metric", "flip"])["figure"].as_f64().unwrap()
    };
    // Eight bits are all that differs: steps of 1/255 are hardly seen.
    let rounding = flip("p.exr", "p.png");
    assert!(rounding > 0.0 && rounding < 0.02, "{rounding}");
    let noise = flip("p.exr", "q.exr");
    assert!(noise > 5.0 * rounding, "{noise} {rounding}");
    assert!((flip("p.png", "q.png") - noise).abs() < 0.02);
    let found = json(folder.path(), &["p.png", "p.exr", "--metric", "mae"]);
    assert!(found["notes"][0].to_string().contains("one picture is a PNG"), "{found}");
    assert!(json(folder.path(), &["p.png", "q.png"])["notes"].as_array().unwrap().is_empty());
}

#[test]
fn bad_input_is_told_in_one_line() {
    let folder = folder();
    pair(folder.path());
    fs::write(folder.path().join("text.exr"), "no picture").unwrap();
    fs::write(folder.path().join("cut.exr"), &fs::read(folder.path().join("a.exr")).unwrap()[..60])
        .unwrap();
    fs::create_dir(folder.path().join("folder.exr")).unwrap();
    write(folder.path(), "two.exr", &[("R", [0.0; 4]), ("G", [0.0; 4])]);
    let wide = image::RgbImage::new(3, 2);
    wide.save(folder.path().join("wide.png")).unwrap();
    for (arguments, expected) in [
        (vec!["none.exr", "b.exr"], "none.exr: there is no such file; give an OpenEXR"),
        (vec!["a.exr", "folder.exr"], "folder.exr: this is a folder"),
        (vec!["text.exr", "b.exr"], "text.exr: this is no picture that can be read"),
        (vec!["a.exr", "cut.exr"], "cut.exr: the file is cut short or damaged"),
        (vec!["two.exr", "b.exr"], "two.exr: it has no channels R, G and B (it has G, R)"),
        (
            vec!["wide.png", "b.exr"],
            "wide.png: it is 3x2, and b.exr is 2x2; compare pictures of one size",
        ),
        (vec!["a.exr", "b.exr", "--fail", "NaN"], "--fail NaN: no figure can be held to this"),
        (vec!["a.exr", "b.exr", "--fail", "-1"], "--fail -1: no figure can be held to this"),
        (vec!["a.exr", "b.exr", "--exposure", "inf"], "--exposure inf: this is no exposure"),
        (
            vec!["a.exr", "b.exr", "--pixels-per-degree", "0"],
            "--pixels-per-degree 0: no screen is seen like this",
        ),
        (
            vec!["a.exr", "b.exr", "-o", "m.exr"],
            "--output m.exr: the false-colour picture is a PNG",
        ),
        (
            vec!["wide.png", "b.exr", "-o", "./wide.png"],
            "this would replace a picture that is compared",
        ),
        (vec!["a.exr", "b.exr", "-o", "no/m.png"], "no/m.png: the file cannot be written"),
        (
            vec!["a.exr", "b.exr", "-o", "m.png", "--map", "z"],
            "--map z: neither picture has standard errors",
        ),
    ] {
        let line = refused(folder.path(), &[vec!["compare"], arguments].concat());
        assert!(line.contains(expected), "{line}");
    }
    // A map that nobody writes.
    let output = run(folder.path(), &["compare", "a.exr", "b.exr", "--map", "z"]);
    assert_eq!(output.status.code(), Some(2));
}
