//! The program as its users call it: what it writes, what it prints, what bad input gets.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    reason = "a test says what it expects by unwrapping"
)]

mod common;

use std::fs;

use common::program::{folder, refused, run, small, text};
use common::root;

#[test]
fn render_writes_a_picture_with_its_report() {
    let folder = folder();
    let output = run(folder.path(), &small(&["--json", "--export", "a", "--ibl", "furnace"]));
    assert!(output.status.success(), "{}", text(&output.stderr));
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    for key in [
        "brdf",
        "integrator",
        "environment",
        "device",
        "resolution",
        "covered_pixels",
        "spp",
        "seconds",
        "msamples_per_s",
        "std_error",
        "relmse_estimate",
        "nonfinite",
        "exr",
        "png",
    ] {
        assert!(!report[key].is_null(), "{key} is missing: {report}");
    }
    assert_eq!((&report["spp"], &report["nonfinite"]), (&8.into(), &0.into()));
    assert!(folder.path().join("a.png").exists() && folder.path().join("a.exr").exists());
}

#[test]
fn several_brdfs_make_a_picture_each_and_the_fallback_is_told_once() {
    let folder = folder();
    let arguments = small(&["lambert", "minnaert", "--export", "p", "--set", "k=0.7"]);
    let output = run(folder.path(), &arguments);
    let (out, error) = (text(&output.stdout), text(&output.stderr));
    assert!(output.status.success(), "{error}");
    assert!(folder.path().join("p-lambert.exr").exists());
    assert!(folder.path().join("p-minnaert.png").exists());
    let note = "note: minnaert has neither `sample` nor `pdf`: sampled by the cosine";
    assert_eq!(error.matches(note).count(), 1, "{error}");
    assert_eq!(out.matches("sampled by the cosine").count(), 1, "{out}");
}

/// One that is wrong is told of, and takes no other with it; two of one name get two files.
#[test]
fn several_brdfs_are_rendered_although_one_of_them_is_wrong() {
    let folder = folder();
    fs::write(folder.path().join("wrong.brdf"), "analytic\n::begin shader\nno\n").unwrap();
    let output = run(folder.path(), &small(&["lambert", "wrong.brdf", "none.brdf", "lambert"]));
    let error = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{error}");
    let lines: Vec<&str> = error.lines().filter(|line| line.starts_with("error: ")).collect();
    assert!(lines[0].starts_with("error: wrong.brdf:"), "{error}");
    assert!(lines[1].starts_with("error: none.brdf: there is no such file"), "{error}");
    assert!(lines[2].starts_with("error: 2 of 4 BRDFs: there is no picture of them"), "{error}");
    for picture in ["lambert.exr", "lambert.png", "lambert-2.exr", "lambert-2.png"] {
        assert!(folder.path().join(picture).exists(), "{picture}");
    }
}

/// Samples estimate no error of a density that does not fit them; a sum over directions tells.
#[test]
fn an_albedo_by_a_wrong_density_is_doubted() {
    let folder = folder();
    let fixtures = root().join("tests/fixtures").display().to_string();
    for (brdf, wrong) in [("pdf-too-large", true), ("ggx", false), ("minnaert", false)] {
        let own = ["--plugins", &fixtures, "--device", "cpu"];
        let eval = ["eval", brdf, "--albedo", "--angles", "0,60"];
        let output = run(folder.path(), &[&eval[..], &own].concat());
        let error = text(&output.stderr);
        assert!(output.status.success(), "{error}");
        assert_eq!(error.contains("WARNING: pdf-too-large: at "), wrong, "{error}");
        let plot = ["plot", brdf, "--view", "albedo", "-o", "a.csv"];
        let error = text(&run(folder.path(), &[&plot[..], &own].concat()).stderr);
        assert_eq!(error.contains("WARNING: pdf-too-large: at "), wrong, "{error}");
    }
}

/// A picture is made again from its own header, bit for bit.
#[test]
fn a_picture_is_made_again_from_its_header() {
    let folder = folder();
    let first = [
        "ggx",
        "--set",
        "alpha_x=0.3",
        "--set",
        "masking=separable",
        "--rendering",
        "uniform",
        "--iset",
        "domain=sphere",
        "--phi",
        "-30",
        "--theta",
        "12.5",
        "--seed",
        "9",
        "--camera",
        "yaw=20,pitch=-10",
        "--shape",
        "torus",
        "--ibl",
        "sky-with-sun",
        "--ibl-width",
        "64",
        "--export",
        "a",
    ];
    let made = run(folder.path(), &small(&first));
    assert!(made.status.success(), "{:?} {}", made.status, text(&made.stderr));
    let again = run(folder.path(), &["render", "--session", "a.exr", "--export", "b"]);
    assert!(again.status.success(), "{}", text(&again.stderr));
    let bytes = |name: &str| fs::read(folder.path().join(name)).unwrap();
    assert!(bytes("a.png") == bytes("b.png"));
    let pixels = |name: &str| {
        let image = exr::prelude::read_first_rgba_layer_from_file(
            folder.path().join(name),
            |size, _| (size.width(), vec![[0.0f32; 4]; size.area()]),
            // Blocks come in any order.
            |(width, pixels): &mut (usize, Vec<_>), at, (r, g, b, a): (f32, f32, f32, f32)| {
                pixels[at.y() * *width + at.x()] = [r, g, b, a];
            },
        );
        image.unwrap().layer_data.channel_data.pixels.1
    };
    let (a, b) = (pixels("a.exr"), pixels("b.exr"));
    let differing: Vec<_> = a.iter().zip(&b).enumerate().filter(|(_, (a, b))| a != b).collect();
    assert!(a.len() == b.len() && differing.is_empty(), "{differing:?}");
}

/// The header of a picture names the very plugin, wherever it lay, so that no other of its name is taken.
#[test]
fn a_picture_of_a_users_plugin_is_made_again_from_another_folder() {
    let folder = folder();
    let here = folder.path().join("here");
    let there = folder.path().join("there");
    fs::create_dir_all(&here).unwrap();
    fs::create_dir_all(&there).unwrap();
    // A plugin that is called like an embedded one.
    assert!(run(&here, &["new", "brdf", "ggx"]).status.success());
    assert!(run(&here, &small(&["./ggx", "--set", "gloss=0.9", "--export", "a"])).status.success());
    // Its name alone means the program's own; the picture that a session comes from is not replaced.
    assert!(run(&here, &small(&["ggx", "--export", "own"])).status.success());
    assert!(fs::read(here.join("own.png")).unwrap() != fs::read(here.join("a.png")).unwrap());
    let line = refused(&here, &["render", "--session", "a.exr", "--export", "a"]);
    assert!(line.contains("would replace the one that --session names"), "{line}");
    let again = run(&there, &["render", "--session", "../here/a.exr", "--export", "b"]);
    assert!(again.status.success(), "{}", text(&again.stderr));
    assert!(fs::read(here.join("a.png")).unwrap() == fs::read(there.join("b.png")).unwrap());
}

#[test]
fn a_scene_without_an_object_in_view_is_a_picture_all_the_same() {
    let folder = folder();
    let far = small(&["--camera", "distance=100000", "--json", "--export", "far"]);
    let output = run(folder.path(), &far);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["covered_pixels"], 0);
    assert!(report["notes"].to_string().contains("the object covers no pixel"));
    assert!(folder.path().join("far.png").exists());
}

#[test]
fn a_scene_file_says_it_all_and_options_change_it() {
    let folder = folder();
    fs::write(
        folder.path().join("scene.toml"),
        "format = 1\n[brdf]\nplugin = \"lambert\"\nparams = { albedo = [1.0, 0.5, 0.0] }\n\
         [environment]\nmap = \"furnace\"\n[film]\nresolution = [20, 10]\n[stopping]\nsamples = 64\npasses = 2\n",
    )
    .unwrap();
    let output =
        run(folder.path(), &["render", "--session", "scene.toml", "--json", "--passes", "3"]);
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["resolution"], serde_json::json!([20, 10]));
    assert_eq!((&report["samples"], &report["passes"]), (&64.into(), &3.into()));
    // The furnace shows the albedo, without noise since the weight is the albedo.
    let mean = |channel: usize| report["mean"][channel].as_f64().unwrap();
    assert!((mean(0) - 1.0).abs() < 1e-6 && (mean(1) - 0.5).abs() < 1e-6 && mean(2) == 0.0);
}

#[test]
fn eval_reads_rows_and_writes_columns() {
    let folder = folder();
    // Lambert: f = 0.5 / pi, pdf = cos / pi, weight 0.5; below the horizon all is zero.
    fs::write(
        folder.path().join("rows.csv"),
        "wo_x,wo_y,wo_z,wi_x,wi_y,wi_z\n0,0,1,0,0,2\n0 0 1 0.6 0 0.8\n0,0,1,0,0.6,-0.8\n",
    )
    .unwrap();
    let output = run(folder.path(), &["eval", "lambert", "rows.csv"]);
    let out = text(&output.stdout);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let rows: Vec<Vec<f64>> = out
        .lines()
        .skip(1)
        .map(|row| row.split(',').map(|n| n.parse().unwrap()).collect())
        .collect();
    assert_eq!(out.lines().next(), Some("f_r,f_g,f_b,pdf,weight_r,weight_g,weight_b"));
    let inv_pi = std::f64::consts::FRAC_1_PI;
    let expected = [
        [0.5 * inv_pi, 0.5 * inv_pi, 0.5 * inv_pi, inv_pi, 0.5, 0.5, 0.5],
        [0.5 * inv_pi, 0.5 * inv_pi, 0.5 * inv_pi, 0.8 * inv_pi, 0.5, 0.5, 0.5],
        [0.0; 7],
    ];
    for (row, expected) in rows.iter().zip(&expected) {
        assert!(row.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6), "{row:?}");
    }
    // A byte order mark, a header, a comment: none of them is a row, and no row is taken for one.
    let marked = "\u{feff}0 0 1 0 0 1\n# c\n0 0 1e-200 0 0 1e200\n";
    fs::write(folder.path().join("marked.txt"), marked).unwrap();
    let rows = text(&run(folder.path(), &["eval", "lambert", "marked.txt"]).stdout);
    assert_eq!(rows.lines().count(), 3, "{rows}");
    let table =
        text(&run(folder.path(), &["eval", "lambert", "--albedo", "--angles", "0,89.9"]).stdout);
    assert!(table.starts_with("theta,albedo_r") && table.contains("\n89.9,0.5000000,"), "{table}");
}

#[test]
fn new_plugins_work_as_they_stand() {
    let folder = folder();
    assert!(run(folder.path(), &["new", "brdf", "my-velvet"]).status.success());
    assert!(run(folder.path(), &["new", "integrator", "half-half"]).status.success());
    let output =
        run(folder.path(), &small(&["./my-velvet", "--rendering", "./half-half", "--json"]));
    assert!(output.status.success(), "{}", text(&output.stderr));
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(
        (&report["brdf"], &report["integrator"]),
        (&"my-velvet".into(), &"half-half".into())
    );
    assert!(report["mean"][2].as_f64().unwrap() > 0.01);
    // A second time the folder is there already; nothing of it is lost.
    refused(folder.path(), &["new", "brdf", "my-velvet"]);
}

#[test]
fn lists_and_programs_are_printed_without_a_device() {
    let folder = folder();
    let list = text(&run(folder.path(), &["list"]).stdout);
    for name in
        ["ggx  [embedded]", "lambert", "modified-phong", "uniform", "brdf-is", "studio", "furnace"]
    {
        assert!(list.contains(name), "{name} is not in {list}");
    }
    let json: serde_json::Value =
        serde_json::from_slice(&run(folder.path(), &["list", "--json"]).stdout).unwrap();
    assert!(json["brdfs"].as_array().unwrap().len() >= 3);
    let program = text(&run(folder.path(), &["expand", "lambert", "uniform"]).stdout);
    assert!(
        program.contains("fn brdf_lambert__eval") && program.contains("//   brdf_lambert__sample")
    );
    let script = text(&run(folder.path(), &["completions", "bash"]).stdout);
    assert!(script.contains("--rendering"));
}

#[test]
fn a_plugin_folder_of_the_user_goes_before_the_embedded_one() {
    let folder = folder();
    let own = folder.path().join("mine/brdf/lambert");
    fs::create_dir_all(&own).unwrap();
    let tree = root().join("plugins/brdf/lambert");
    fs::copy(tree.join("plugin.toml"), own.join("plugin.toml")).unwrap();
    fs::copy(tree.join("lambert.wgsl"), own.join("lambert.wgsl")).unwrap();
    let list = text(&run(folder.path(), &["list", "--plugins", "mine"]).stdout);
    assert!(list.contains("lambert  [mine/brdf/lambert]"), "{list}");
    fs::write(own.join("plugin.toml"), "kind = 3").unwrap();
    let list = text(&run(folder.path(), &["list", "--plugins", "mine"]).stdout);
    assert!(list.contains("broken: mine/brdf/lambert/plugin.toml:1:8"), "{list}");
}

#[test]
fn bad_names_numbers_and_files_get_one_line_each() {
    let folder = folder();
    let f = folder.path();
    fs::write(f.join("wide.hdr"), hdr(30, 10, &[[128, 128, 128, 128]; 300])).unwrap();
    fs::write(f.join("short.hdr"), &hdr(32, 16, &[[128, 128, 128, 128]; 512])[..900]).unwrap();
    fs::write(f.join("text.hdr"), "no picture").unwrap();
    fs::write(f.join("short.exr"), [0x76, 0x2f, 0x31, 0x01, 2, 0, 0, 0]).unwrap();
    fs::write(f.join("bad.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n").unwrap();
    fs::write(f.join("scene.toml"), "[film]\nresolutoin = [3, 3]\n").unwrap();
    fs::write(f.join("rows.csv"), "0,0,1,0,0\n").unwrap();
    for (arguments, parts) in [
        (vec!["render", "gxg"], ["gxg: there is no brdf of this name", "did you mean `ggx`?"]),
        (vec!["render", "./nowhere"], ["./nowhere: there is no such plugin folder", "plugin.toml"]),
        (vec!["render", "--rendering", "ggx"], ["ggx: there is no integrator", "known are"]),
        (
            vec!["render", "--set", "alpha=1"],
            ["GGX has no parameter `alpha`", "did you mean `alpha_x`?"],
        ),
        (
            vec!["render", "--set", "alpha_x=7"],
            ["7 is outside the range [0.0001, 1]", "is a number in"],
        ),
        (vec!["render", "--set", "alpha_x"], ["alpha_x: this sets nothing", "write key=value"]),
        (vec!["render", "--set", "masking=smith"], ["`smith` is no option", "known are"]),
        (vec!["render", "--iset", "domain=cube"], ["has no parameter `domain`", "remove it"]),
        (
            vec!["render", "--ibl", "studoi"],
            ["there is no file and no recipe", "did you mean `studio`?"],
        ),
        (vec!["render", "--ibl", "none.hdr"], ["none.hdr: ", "exr"]),
        (vec!["render", "--ibl", "wide.hdr"], ["wide.hdr: ", "30x10"]),
        (vec!["render", "--ibl", "short.hdr"], ["short.hdr: ", ";"]),
        (vec!["render", "--ibl", "short.exr"], ["short.exr: ", ";"]),
        (vec!["render", "--ibl", "text.hdr"], ["text.hdr: ", ";"]),
        (
            vec!["render", "--shape", "cube"],
            ["cube: there is no such shape", "sphere, torus, plane"],
        ),
        (vec!["render", "--shape", "bad.obj"], ["bad.obj:4:", ";"]),
        (vec!["render", "--shape", "none.glb"], ["none.glb: ", ";"]),
        (vec!["render", "--resolution", "0"], ["--resolution 0: this is no picture size", "512"]),
        (vec!["render", "--resolution", "12xy"], ["--resolution 12xy: ", "512"]),
        (vec!["render", "--resolution", "400000"], ["this needs about", "lower the resolution"]),
        (vec!["render", "--camera", "zoom=2"], ["camera", "yaw, pitch, distance, fov"]),
        (vec!["render", "--camera", "fov=180"], ["fov is out of range", ";"]),
        (vec!["render", "--phi", "inf"], ["--phi inf: this is no finite number", ";"]),
        (vec!["render", "--session", "none.toml"], ["none.toml: there is no such file", ";"]),
        (
            vec!["render", "--session", "scene.toml"],
            ["scene.toml:2:1: unknown key", "did you mean `resolution`?"],
        ),
        (vec!["render", "--session", "short.exr"], ["short.exr: its header cannot be read", ";"]),
        (vec!["render", "lambert", "ggx", "--watch"], ["--watch: it follows one BRDF", "name one"]),
        (vec!["render", "--watch"], ["--watch: both plugins are embedded", "brdf new"]),
        (
            vec!["render", "--plugins", "nowhere"],
            ["--plugins nowhere: there is no such folder", ";"],
        ),
        (
            vec!["eval", "lambert", "rows.csv"],
            ["rows.csv:1:1: this row has 5 entries", "six finite numbers"],
        ),
        (vec!["eval", "lambert"], ["standard input: it holds no rows", ";"]),
        (vec!["eval", "lambert", "--albedo", "--angles", "90"], ["--angles 90: ", "below 90"]),
        (vec!["eval", "lambert", "--albedo", "--azimuth", "nan"], ["--azimuth NaN: ", "finite"]),
        (
            vec!["render", "--export", "nowhere/a"],
            ["nowhere/a.exr: the file cannot be written", "existing folder"],
        ),
        (
            vec!["render", "--preset", "glod"],
            ["--preset glod: there is no such preset", "did you mean `gold`?"],
        ),
        (vec!["render", "--session", "rows.csv"], ["rows.csv:1:", ";"]),
        (vec!["new", "brdf", "My Velvet"], ["cannot name a plugin", "lower-case"]),
        (vec!["expand", "uniform"], ["uniform: there is no brdf of this name", ";"]),
    ] {
        let line = refused(f, &arguments);
        for part in parts {
            assert!(line.contains(part), "{arguments:?}: {part} is not in {line}");
        }
    }
}

#[test]
fn a_map_with_bad_texels_is_used_only_at_the_users_word() {
    let folder = folder();
    let mut pixels = vec![(0.5f32, 0.5f32, 0.5f32); 8 * 4];
    pixels[3].0 = f32::NAN;
    pixels[9].1 = f32::INFINITY;
    pixels[20].2 = -1.0;
    exr::prelude::write_rgb_file(folder.path().join("bad.exr"), 8, 4, |x, y| pixels[y * 8 + x])
        .unwrap();
    let line = refused(folder.path(), &small(&["--ibl", "bad.exr"]));
    for part in ["1 NaN", "1 infinite", "1 negative", "--replace-bad-texels"] {
        assert!(line.contains(part), "{part} is not in {line}");
    }
    let output = run(folder.path(), &small(&["--ibl", "bad.exr", "--replace-bad-texels"]));
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("note: replaced"), "{}", text(&output.stderr));
}

/// The smallest Radiance file: flat RGBE.
fn hdr(width: u32, height: u32, texels: &[[u8; 4]]) -> Vec<u8> {
    let mut bytes =
        format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n").into_bytes();
    bytes.extend(texels.iter().flatten());
    bytes
}

/// Which program is it? The version, the commit, and what was built in.
#[test]
fn the_version_says_what_was_built() {
    let folder = folder();
    let said = |argument| text(&run(folder.path(), &[argument]).stdout);
    let (short, long) = (said("-V"), said("--version"));
    let name = format!("brdf {} (", env!("CARGO_PKG_VERSION"));
    assert!(short.starts_with(&name) && short.lines().count() == 1, "{short}");
    assert_eq!(long.lines().next(), short.lines().next());
    for fact in ["build: ", "renders by: ", "CPU executor", "manifests of format 1"] {
        assert!(long.contains(fact), "{long}");
    }
}

/// A man page for the program and one for each verb, each with the verb's own options.
#[test]
fn man_pages_are_written_for_every_verb() {
    let folder = folder();
    let output = run(folder.path(), &["man", "."]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let page = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    assert!(page("brdf-render.1").contains("\\-\\-resolution"), "{}", page("brdf-render.1"));
    let program = page("brdf.1");
    let pages = fs::read_dir(folder.path()).unwrap().count();
    let named = program.matches("\nbrdf\\-").count() + program.matches("fBbrdf\\-").count();
    assert!(pages > 20 && named >= pages - 1, "{pages} pages, {named} named in\n{program}");
    let line = refused(folder.path(), &["man", "nowhere"]);
    assert!(line.contains("nowhere: there is no such folder; make it"), "{line}");
}

/// What ends in a slash is a folder, and not the beginning of a hidden file's name.
#[test]
fn an_export_that_ends_in_a_slash_goes_into_the_folder() {
    let folder = folder();
    fs::create_dir(folder.path().join("out")).unwrap();
    let output = run(folder.path(), &small(&["lambert", "--export", "out/"]));
    assert!(output.status.success(), "{}", text(&output.stderr));
    let both = run(folder.path(), &small(&["lambert", "minnaert", "--export", "out/"]));
    assert!(both.status.success(), "{}", text(&both.stderr));
    let mut names: Vec<_> = fs::read_dir(folder.path().join("out"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    assert_eq!(names, ["lambert.exr", "lambert.png", "minnaert.exr", "minnaert.png"]);
}
