//! `brdf plot`: numbers against what is known of them, pictures of the document, refusals.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    reason = "a test says what it expects by unwrapping"
)]

mod common;

use std::f64::consts::PI;
use std::fs;
use std::path::Path;

use common::program::{folder, refused, run, text};
use common::root;

/// The rows of a plot on the cores: the name and the numbers of each.
fn rows(folder: &Path, arguments: &[&str]) -> Vec<(String, Vec<f64>)> {
    let all = [&["plot"], arguments, &["-o", "rows.csv", "--device", "cpu"]].concat();
    let output = run(folder, &all);
    assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
    let rows = fs::read_to_string(folder.join("rows.csv")).unwrap();
    let row = |line: &str| {
        // Names with commas are quoted.
        let (name, numbers) = match line.strip_prefix('"') {
            Some(rest) => rest.split_once("\",").unwrap(),
            None => line.split_once(',').unwrap(),
        };
        (name.to_owned(), numbers.split(',').map(|n| n.parse().unwrap()).collect())
    };
    rows.lines().skip(1).map(row).collect()
}

/// The names of the curves, in their order.
fn names_of(folder: &Path, arguments: &[&str]) -> Vec<String> {
    let mut names: Vec<String> =
        rows(folder, arguments).into_iter().map(|(name, _)| name).collect();
    names.dedup();
    names
}

/// f of one pair by `brdf eval`, the channels' luminance.
fn luminance_of(folder: &Path, brdf: &[&str], wo: [f64; 3], wi: [f64; 3]) -> f64 {
    let pair = [wo, wi].concat().iter().map(f64::to_string).collect::<Vec<_>>().join(" ");
    fs::write(folder.join("pair.txt"), pair).unwrap();
    let mut arguments = vec!["eval"];
    arguments.extend_from_slice(brdf);
    arguments.extend_from_slice(&["pair.txt", "--device", "cpu"]);
    let output = run(folder, &arguments);
    let printed = text(&output.stdout);
    let numbers: Vec<f64> =
        printed.lines().nth(1).unwrap().split(',').map(|n| n.parse().unwrap()).collect();
    0.2126 * numbers[0] + 0.7152 * numbers[1] + 0.0722 * numbers[2]
}

fn direction(theta: f64, phi: f64) -> [f64; 3] {
    let (theta, phi) = (theta.to_radians(), phi.to_radians());
    [theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()]
}

/// Lambert reflects rho / pi everywhere, so every view of it is known: 0.5 / pi with its default, times the cosine
/// of `wi` where asked for, an albedo of 0.5.
#[test]
fn lambert_is_the_same_everywhere() {
    let folder = folder();
    let f = 0.5 / PI;
    let close = |value: f64, expected: f64| (value - expected).abs() < 1e-6;
    for view in ["polar", "theta-v", "theta-h", "theta-d"] {
        let rows = rows(folder.path(), &["lambert", "--view", view]);
        assert!(rows.len() > 300, "{view}: {} rows", rows.len());
        assert!(rows.iter().all(|(name, row)| name == "lambert" && close(row[1], f)), "{view}");
    }
    let slanted = rows(
        folder.path(),
        &["lambert", "--view", "polar", "--cosine", "--theta-i", "60", "--channel", "rgb"],
    );
    assert!(slanted.iter().all(|(_, row)| close(row[1], 0.5 * f)));
    assert_eq!(
        slanted.iter().filter(|(name, _)| name == "lambert blue").count() * 3,
        slanted.len()
    );
    // Along theta_d with the half vector at the normal wi lies theta_d from it.
    for (_, row) in rows(folder.path(), &["lambert", "--view", "theta-d", "--cosine"]) {
        assert!(close(row[1], f * row[0].to_radians().cos()), "{row:?}");
    }
    for (_, row) in rows(folder.path(), &["lambert", "--view", "albedo"]) {
        assert!((row[1] - 0.5).abs() <= 5.0 * row[2] + 1e-6, "{row:?}");
    }
    let lobe = rows(folder.path(), &["lambert", "--view", "lobe"]);
    assert!(lobe.iter().all(|(_, row)| close(row[3], f) && row[2] > 0.0));
    let slice = rows(folder.path(), &["lambert", "--view", "slice", "--size", "16"]);
    assert!(slice.iter().all(|(_, row)| row[2..].iter().all(|c| close(*c, f))));
    // With phi_d of 90 degrees both directions have the height cos theta_h cos theta_d: all is seen.
    assert_eq!(slice.len(), 256);
    // With 0 wi lies theta_h + theta_d from the normal: half of the square is seen, its diagonal to rounding.
    let flat = ["lambert", "--view", "slice", "--size", "16", "--phi-d", "0", "--square", "false"];
    let (mut above, mut below) = (0, 0);
    for (_, row) in rows(folder.path(), &flat) {
        above += usize::from(row[0] + row[1] < 89.9);
        below += usize::from(row[0] + row[1] > 90.1);
    }
    assert_eq!((above, below), (16 * 15 / 2, 0));
}

/// The same numbers as `brdf eval` gives for directions that are made here: `wo` opposite to `wi` for positive angles,
/// and half vectors towards the tangent with the difference across.
#[test]
fn angles_mean_what_they_say() {
    let folder = folder();
    let set = ["--set", "alpha_x=0.2", "--set", "alpha_y=0.5"];
    let ggx = [&["ggx"], &set[..]].concat();
    let plotted = |more: &[&str]| rows(folder.path(), &[&ggx[..], more].concat());
    let wi = direction(50.0, 20.0);
    let line =
        plotted(&["--view", "theta-v", "--theta-i", "50", "--phi-i", "20", "--phi-v", "110"]);
    for (_, row) in line.iter().step_by(97) {
        let expected = luminance_of(folder.path(), &ggx, direction(row[0], 110.0), wi);
        assert!((row[1] - expected).abs() <= 2e-5 * expected, "{row:?} {expected}");
    }
    let polar = plotted(&["--view", "polar", "--theta-i", "50", "--phi-i", "20"]);
    for (_, row) in polar.iter().step_by(97) {
        let expected = luminance_of(folder.path(), &ggx, direction(row[0], 200.0), wi);
        assert!((row[1] - expected).abs() <= 2e-5 * expected, "{row:?} {expected}");
    }
    for (_, row) in plotted(&["--view", "theta-h", "--theta-d", "30"]).iter().step_by(61) {
        // h in the plane of the tangent, and at right angles to that plane half of what is between both.
        let h = direction(row[0], 0.0);
        let (sine, cosine) = 30f64.to_radians().sin_cos();
        let side = |sign: f64| [h[0] * cosine, sign * sine, h[2] * cosine];
        let expected = luminance_of(folder.path(), &ggx, side(-1.0), side(1.0));
        assert!((row[1] - expected).abs() <= 2e-5 * expected, "{row:?} {expected}");
    }
}

/// The peak of a near-mirror is a thousandth of a degree wide; between the first angles nothing of it is seen. At the
/// mirror direction GGX of a conductor that reflects all is D G2 / (4 cos^2), D = 1 / (pi alpha^2), and at 45 degrees
/// G2 is 1 but for alpha^2 / 2, so f is 1 / (2 pi alpha^2).
#[test]
fn a_needle_is_found_in_full_height() {
    let folder = folder();
    let peaks: Vec<f64> = ["theta-v", "theta-h"]
        .iter()
        .map(|view| {
            let arguments = [
                "ggx",
                "--view",
                view,
                "--set",
                "alpha_x=0.001",
                "--set",
                "alpha_y=0.001",
                "--set",
                "f0=1,1,1",
            ];
            let rows = rows(folder.path(), &arguments);
            assert!(rows.len() < 4000, "{view}: {} rows", rows.len());
            rows.iter().map(|(_, row)| row[1]).fold(0.0, f64::max)
        })
        .collect();
    let at_45 = 1.0 / (2.0 * PI * 1e-6);
    assert!((peaks[0] / at_45 - 1.0).abs() < 2e-3, "{peaks:?}");
    // Straight on the cosines are 1.
    assert!((peaks[1] / (0.5 * at_45) - 1.0).abs() < 2e-3, "{peaks:?}");
}

/// More curves than colours are told of; a logarithmic drawing ends a curve that leaves it.
#[test]
fn drawings_say_what_they_cannot_show() {
    let folder = folder();
    let noted = |arguments: &[&str]| {
        let all = [&["plot"], arguments, &["-o", "a.svg", "--device", "cpu"]].concat();
        let output = run(folder.path(), &all);
        assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
        text(&output.stderr)
    };
    let many = (1..=17).map(|i| format!("0.{i:02}")).collect::<Vec<_>>().join(",");
    let notes = noted(&["ggx", "--vary", &format!("alpha_x={many}"), "--view", "theta-v"]);
    assert!(notes.contains("there are 17 curves, and 16 can be told apart"), "{notes}");
    let needle = ["ggx", "lambert", "--vary", "alpha_x=0.001", "--vary", "alpha_y=0.001"];
    let notes = noted(&[&needle[..], &["--view", "theta-v", "--log"]].concat());
    assert!(notes.contains("lambert lies below what is drawn"), "{notes}");
    let notes = noted(&[&needle[..], &["--view", "theta-v", "--log", "--decades", "8"]].concat());
    assert!(!notes.contains("below what is drawn"), "{notes}");
    let notes = noted(&["lambert", "--set", "albedo=0,0,0", "--view", "polar", "--log"]);
    assert!(notes.contains("no value is above 0"), "{notes}");
    let unseen = ["ggx", "--view", "theta-d", "--theta-h", "90", "--phi-d", "0"];
    let unseen = rows(folder.path(), &unseen);
    assert!(unseen.iter().all(|(_, row)| row[0] < 1.0), "{unseen:?}");
    // Phong's lobe falls below any decade, its cosine to 0.
    let all = ["plot", "blinn-phong", "--log", "--view", "theta-v", "-o", "b.svg"];
    let output = run(folder.path(), &[&all[..], &["--device", "cpu"]].concat());
    assert!(output.status.success() && !text(&output.stderr).contains("colours"));
    let drawing = fs::read_to_string(folder.path().join("b.svg")).unwrap();
    let (_, curve) = drawing.rsplit_once("class=\"curve c0 d0\" d=\"M").unwrap();
    // The frame's bottom lies at 246.
    let lowest = |path: &str| path.split(['L', 'M']).filter(|at| at.ends_with(" 246.0")).count();
    assert!(lowest(curve.split('"').next().unwrap()) <= 2, "{curve}");
}

/// Each value that varies is a curve of its own, and BRDFs without the parameter stay one.
#[test]
fn parameters_take_their_values_in_turn() {
    let folder = folder();
    let names = names_of(
        folder.path(),
        &[
            "ggx",
            "lambert",
            "--view",
            "theta-v",
            "--vary",
            "alpha_x=0.1,0.2",
            "--vary",
            "alpha_y=0.3,0.4",
        ],
    );
    assert_eq!(names, ["ggx alpha_x=0.1 alpha_y=0.3", "ggx alpha_x=0.2 alpha_y=0.4", "lambert"]);

    // Counts are a BRDF's own; colours have commas; who is named twice gets a number.
    let names = names_of(
        folder.path(),
        &[
            "disney",
            "ggx",
            "ggx",
            "--view",
            "albedo",
            "--vary",
            "base_color=1,0,0;0,1,0",
            "--vary",
            "f0=0.04,0.04,0.04;1,1,1;0,0,0",
            "--set",
            "roughness=0.4",
        ],
    );
    assert_eq!(
        names,
        [
            "disney roughness=0.4 base_color=1,0,0",
            "disney roughness=0.4 base_color=0,1,0",
            "ggx f0=0.04,0.04,0.04",
            "ggx f0=1,1,1",
            "ggx f0=0,0,0",
            "ggx f0=0.04,0.04,0.04 (2)",
            "ggx f0=1,1,1 (2)",
            "ggx f0=0,0,0 (2)",
        ]
    );
}

/// Every command of the document makes its picture, byte for byte.
#[test]
fn pictures_of_the_document_are_what_their_commands_make() {
    let page = fs::read_to_string(root().join("docs/plots.md")).unwrap();
    let folder = folder();
    fs::create_dir(folder.path().join("plots")).unwrap();
    let commands: Vec<&str> = page.lines().filter(|line| line.starts_with("brdf plot ")).collect();
    assert!(commands.len() >= 7, "{commands:?}");
    for command in commands {
        let mut arguments: Vec<&str> = command.split(' ').skip(1).collect();
        let file = arguments[arguments.len() - 1];
        assert!(page.contains(&format!("]({file})")), "{file} is not shown");
        arguments.extend(["--device", "cpu"]);
        let output = run(folder.path(), &arguments);
        assert!(output.status.success(), "{command}: {}", text(&output.stderr));
        let made = fs::read_to_string(folder.path().join(file)).unwrap();
        assert!(made.starts_with("<svg xmlns=") && !made.contains("NaN"), "{command}");
        let kept = fs::read_to_string(root().join("docs").join(file)).unwrap_or_default();
        assert!(made == kept, "run scripts/pictures, and look at what it makes of docs/{file}");
    }
}

#[test]
fn what_cannot_be_plotted_is_refused() {
    let folder = folder();
    let f = folder.path();
    for (arguments, part) in [
        (&["--view", "polar", "-o", "a.png"][..], "end the name in .svg or in .csv"),
        (&["--view", "polar", "-o", "a"], "end the name in .svg or in .csv"),
        (&["--view", "polar", "-o", "none/a.svg"], "none/a.svg"),
        (&["--view", "polar", "-o", "a.svg", "--phi-d", "3"], "theta-h, theta-d, slice"),
        (&["--view", "slice", "-o", "a.svg", "--log"], "the view slice has no such thing"),
        (&["--view", "polar", "-o", "a.svg", "--theta-i", "90"], "give a number from 0 to 89.9"),
        (&["--view", "theta-h", "-o", "a.svg", "--phi-d", "nan"], "give a number from -360 to 360"),
        (&["--view", "slice", "-o", "a.svg", "--size", "0"], "give a number from 1 to 2048"),
        (&["--view", "slice", "-o", "a.svg", "--size", "-1"], "give a number from 1 to 2048"),
        (
            &["--view", "slice", "-o", "a.svg", "--size", "2.5"],
            "leave out what is behind the point",
        ),
        (&["--view", "polar", "-o", "a.svg", "--phi-i", "1e30"], "give a number from -360 to 360"),
        (&["--view", "polar", "-o", "a.svg", "--log", "--decades", "0"], "from 1 to 10"),
        (&["--view", "polar", "-o", "a.svg", "--vary", "f0=1,0,0"], "put `;` between them"),
        (
            &["--view", "polar", "-o", "a.svg", "--vary", "alpha_x=0.1", "--vary", "alpha_x=0.2"],
            "say its values once",
        ),
        (
            &["--view", "polar", "-o", "a.svg", "--set", "alpha_x=0.1", "--vary", "alpha_x=0.2"],
            "say its values once",
        ),
        (&["--view", "lobe", "-o", "a.svg", "--channel", "rgb"], "name one channel"),
        (&["--view", "polar", "-o", "a.svg", "--set", "alpha_q=1"], "alpha_q"),
        (&["--view", "polar", "-o", "a.svg", "--vary", "alpha_x"], "write KEY=VALUE,VALUE,..."),
        (&["--view", "polar", "-o", "a.svg", "--vary", "alpha_x=0.1,much"], "much"),
        (
            &["--view", "polar", "-o", "a.svg", "--vary", "alpha_x=0.1,0.2", "--vary", "alpha_y=1"],
            "it has 1 values, and `alpha_x` has 2",
        ),
    ] {
        let mut all = vec!["plot", "ggx", "--device", "cpu"];
        all.extend_from_slice(arguments);
        let line = refused(f, &all);
        assert!(line.contains(part), "{arguments:?}: {line}");
    }
    let line = refused(f, &["plot", "nobody", "--view", "polar", "-o", "a.svg"]);
    assert!(line.contains("nobody"), "{line}");
}

/// Lambert's one product rounds once or twice; in `loses` 1 + x - 1 leaves a digit or two of x = 1e-6.
#[test]
fn errors_are_those_of_roundings_where_nothing_cancels() {
    use brdf_host::plot::digits;
    let lambert = digits(&common::brdf("lambert", &[]), 4, 3).unwrap();
    assert_eq!(lambert.len(), 16);
    assert!(lambert.iter().all(|error| *error < 2.4e-7), "{lambert:?}");
    let loses = common::from_text(
        "loses",
        "kind = \"brdf\"\nname = \"Loses\"\nabout = \"Digits.\"\n",
        "fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {\n    \
         return vec3f((1.0 + 1e-6 * wi.z) - 1.0);\n}\n",
    );
    let largest = digits(&loses, 16, 2).unwrap().into_iter().fold(0.0, f64::max);
    assert!(largest > 1e-2, "{largest}");
}
