//! Environment maps as users hand them in: facts, conversions, layouts of scenes, what wrong ones get.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    reason = "a test says what it expects by unwrapping"
)]

mod common;

use std::path::Path;

use brdf_host::environment::{Environment, Layout, Options, load};
use common::program::{folder, refused, run, small, text};
use glam::DVec3;

fn loaded(path: &Path) -> Environment {
    load(path, &Options::default()).unwrap()
}

fn json(folder: &Path, arguments: &[&str]) -> serde_json::Value {
    let output = run(folder, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// A panorama, 64 x 32: red grows to +x, green to +y, blue to +z, and one bright texel.
fn panorama(path: &Path) {
    let map = Environment { width: 64, height: 32, ..Environment::constant(0.0) };
    exr::prelude::write_rgb_file(path, 64, 32, |x, y| {
        let d = map.direction(x as u32, y as u32);
        let [r, g, b] = (d * 0.5 + 0.5).as_vec3().to_array();
        if (x, y) == (20, 9) { (90_000.0, 90_000.0, 90_000.0) } else { (r, g, b) }
    })
    .unwrap();
}

#[test]
fn facts_are_printed_and_are_json() {
    let folder = folder();
    panorama(&folder.path().join("map.exr"));
    let facts = json(folder.path(), &["env", "map.exr", "--json"]);
    assert_eq!((&facts["width"], &facts["height"]), (&64.into(), &32.into()));
    assert_eq!(
        (&facts["layout"], &facts["above_f16"], &facts["black"]),
        (&"lat-long".into(), &1.into(), &0.into())
    );
    assert_eq!(facts["max"], 90_000.0);
    // The bright texel sees (cos t0 - cos t1) 2 pi / 64 of row 9; all else has a mean of 1/2 of 4 pi.
    let angle = |row: f64| std::f64::consts::PI * row / 32.0;
    let sun = 90_000.0 * (angle(9.0).cos() - angle(10.0).cos()) / 64.0 / 2.0;
    let mean = facts["mean"].as_f64().unwrap();
    assert!((mean - sun - 0.5).abs() < 2e-3, "{mean} {sun}");
    let share = facts["brightest"][0].as_f64().unwrap();
    assert!((share - sun / mean).abs() < 1e-6, "{share}");
    assert!(facts["seconds"].as_f64().unwrap() > 0.0);
    let told = text(&run(folder.path(), &["env", "map.exr"]).stdout);
    for part in
        ["map.exr: lat-long, 64x32, ready in", "1 texels above 65504", "share of the energy"]
    {
        assert!(told.contains(part), "{part} is not in {told}");
    }
    // A recipe by its name, at a width and as a cube.
    let told =
        text(&run(folder.path(), &["env", "map.exr", "--conform", "--device", "cpu"]).stdout);
    assert_eq!(told.matches(" ok ").count(), 4, "{told}");
    assert!(told.contains("nearest, compensated draws of 1 texels follow"), "{told}");
    let facts = json(folder.path(), &["env", "map.exr", "--conform", "--device", "cpu", "--json"]);
    assert_eq!(facts["sampling"]["laws"][0]["verdict"]["outcome"], "passed");
    let recipe = json(folder.path(), &["env", "studio", "--width", "128", "--json"]);
    assert_eq!(recipe["width"], 128);
    let cube =
        json(folder.path(), &["env", "studio", "--layout", "cube", "--face", "16", "--json"]);
    assert_eq!(
        (&cube["layout"], &cube["face"], &cube["height"]),
        (&"cube".into(), &16.into(), &96.into())
    );
    assert!(cube["notes"].to_string().contains("the energy changed by"), "{cube}");
}

/// Every layout in both formats, loaded again: the same radiance in the same directions.
#[test]
fn conversions_come_back() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    panorama(&at("map.exr"));
    let first =
        json(folder.path(), &["env", "map.exr", "-o", "cube.exr", "--layout", "cube", "--json"]);
    assert_eq!(first["wrote"], serde_json::json!(["cube.exr"]));
    let cube = loaded(&at("cube.exr"));
    assert_eq!((cube.layout, cube.width), (Layout::Cube, 16));
    let x = cube.radiance(DVec3::new(1.0, 0.02, 0.02))[0];
    assert!((x - 1.0).abs() < 0.02, "{x}");
    for layout in ["cross-h", "cross-v", "strip-row", "strip-col"] {
        for ending in ["exr", "hdr"] {
            let name = format!("{layout}.{ending}");
            let made = run(folder.path(), &["env", "cube.exr", "-o", &name, "--layout", layout]);
            assert!(
                text(&made.stdout).contains(&format!("wrote {name} ({layout}, faces of 16x16)"))
            );
            compare(&loaded(&at(&name)), &cube, ending == "hdr");
        }
    }
    for ending in ["exr", "hdr"] {
        let name = format!("face_%.{ending}");
        assert!(run(folder.path(), &["env", "cross-h.exr", "-o", &name]).status.success());
        assert!(at(&format!("face_nz.{ending}")).exists());
        compare(&loaded(&at(&name)), &cube, ending == "hdr");
    }
    // And back to a lat-long map, whose sun has kept its energy.
    let back = json(
        folder.path(),
        &["env", "face_%.exr", "-o", "back.hdr", "--layout", "lat-long", "--json"],
    );
    assert_eq!(back["width"], 64);
    let (mean, first) = (back["mean"].as_f64().unwrap(), first["mean"].as_f64().unwrap());
    assert!((mean / first - 1.0).abs() < 1e-4, "{mean} {first}");
    let wide =
        json(folder.path(), &["env", "map.exr", "-o", "wide.exr", "--width", "100", "--json"]);
    assert_eq!((&wide["width"], &wide["wrote"][0]), (&100.into(), &"wide.exr".into()));
    assert_eq!(loaded(&at("wide.exr")).width, 100);
}

/// Equal, or equal to half a step: the largest channel has a mantissa of 127.75 steps at the least.
fn compare(map: &Environment, expected: &Environment, rounded: bool) {
    assert_eq!((map.layout, map.width), (expected.layout, expected.width));
    for (texel, expected) in map.texels.iter().zip(expected.texels.iter()) {
        let step = expected.iter().fold(0.0, |a: f32, b| a.max(*b)) / 127.75;
        let tolerance = if rounded { 0.5 * step } else { 0.0 };
        for (value, expected) in texel.iter().zip(expected) {
            assert!((value - expected).abs() <= tolerance, "{}: {value} {expected}", map.name);
        }
    }
}

/// A scene says the layout, and its picture's header repeats it.
#[test]
fn scenes_name_the_layout() {
    let folder = folder();
    panorama(&folder.path().join("map.exr"));
    let scene = "format = 1\n[environment]\nmap = \"map.exr\"\nread_as = \"lat-long\"\nlayout = \"cube\"\nface = 8\n";
    std::fs::write(folder.path().join("scene.toml"), scene).unwrap();
    let parsed = brdf_host::session::Session::parse(
        &brdf_host::registry::Registry::new(&[]),
        "scene.toml",
        scene,
        folder.path(),
    );
    let light = parsed.unwrap().environment;
    assert_eq!((light.layout, light.face), (Some(Layout::Cube), Some(8)));
    let map =
        brdf_host::open::environment(&brdf_host::registry::Registry::new(&[]), &light).unwrap();
    assert_eq!((map.layout, map.width, map.height), (Layout::Cube, 8, 48));
    let bad = scene.replace("cube", "cbue");
    std::fs::write(folder.path().join("bad.toml"), bad).unwrap();
    let line = refused(folder.path(), &["render", "--session", "bad.toml"]);
    assert!(
        line.contains("bad.toml:5:10: there is no `cbue` here; did you mean `cube`?"),
        "{line}"
    );
    // Rendered as what it is: a cross becomes a lat-long map on request, with a note.
    assert!(
        run(folder.path(), &["env", "map.exr", "-o", "c.exr", "--layout", "cross-h"])
            .status
            .success()
    );
    let render = small(&["--ibl", "c.exr", "--ibl-layout", "lat-long", "--json", "--export", "p"]);
    let report = json(folder.path(), &render);
    assert!(report["notes"].to_string().contains("to a lat-long map of 64x32"), "{report}");
    let header = brdf_host::picture::read_scene(&folder.path().join("p.exr")).unwrap();
    assert!(header.contains("layout = \"lat-long\""), "{header}");
    let again = run(folder.path(), &["render", "--session", "p.exr", "--export", "q"]);
    assert!(again.status.success(), "{}", text(&again.stderr));
    let bytes = |name: &str| std::fs::read(folder.path().join(name)).unwrap();
    assert!(bytes("p.png") == bytes("q.png"));
}

/// A Ptex cube of 4x4 texels a face whose faces each have one radiance, in floats.
fn ptex(faces: [[f32; 3]; 6]) -> Vec<u8> {
    let zipped = |bytes: &[u8]| miniz_oxide::deflate::compress_to_vec_zlib(bytes, 6);
    let words = |words: &[u32]| words.iter().flat_map(|w| w.to_le_bytes()).collect::<Vec<u8>>();
    // Two logarithms of the side, edges, "constant", four neighbours.
    let infos = zipped(&[[2, 2, 0, 1].as_slice(), &[0xff; 16]].concat().repeat(6));
    let constants: Vec<u8> = faces.as_flattened().iter().flat_map(|c| c.to_le_bytes()).collect();
    let constants = zipped(&constants);
    let level = zipped(&[0; 6 * 4]);
    let [infos_size, constants_size, level_size] =
        [&infos, &constants, &level].map(|part| part.len() as u32);
    // Version, quads, floats, no alpha; 3 channels and 1 level; 6 faces; sizes of the parts.
    let head = [1, 1, 3, u32::MAX, 3 | (1 << 16), 6, 0, infos_size, constants_size, 16, 4];
    let parts = [words(&head), words(&[level_size, 0, 0, 0]), infos, constants];
    [b"Ptex".to_vec(), parts.concat(), words(&[level_size, 0, level_size, 6]), level].concat()
}

#[test]
fn a_ptex_probe_lights_as_the_same_faces_in_an_exr() {
    let folder = folder();
    let faces = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0].map(|face: f32| [face, 0.5 * face, 1.0 / face]);
    for name in ["m.penv", "m.ptex", "m.ptx"] {
        std::fs::write(folder.path().join(name), ptex(faces)).unwrap();
    }
    // Ptex has +x first; a strip has px first, which is seen at -x.
    let strip = folder.path().join("strip.exr");
    exr::prelude::write_rgb_file(strip, 4, 24, |_, y| faces[[1, 0, 2, 3, 4, 5][y / 4]].into())
        .unwrap();
    let picture = |map: &str, name: &str| {
        let output = run(folder.path(), &small(&["--ibl", map, "--export", name]));
        assert!(output.status.success(), "{map}: {}", text(&output.stderr));
        std::fs::read(folder.path().join(name).with_extension("png")).unwrap()
    };
    let expected = picture("strip.exr", "s");
    for name in ["m.penv", "m.ptex", "m.ptx"] {
        assert!(picture(name, "p") == expected, "{name}");
        let compared = run(folder.path(), &["compare", "p.exr", "s.exr", "--fail", "0"]);
        assert!(compared.status.success(), "{name}: {}", text(&compared.stdout));
    }
}

#[test]
fn wrong_conversions_get_one_line_each() {
    let folder = folder();
    let f = folder.path();
    panorama(&f.join("map.exr"));
    assert!(run(f, &["env", "map.exr", "-o", "a_%.exr", "--layout", "cube"]).status.success());
    exr::prelude::write_rgb_file(f.join("odd.exr"), 7, 5, |_, _| (1.0_f32, 1.0_f32, 1.0_f32))
        .unwrap();
    for (arguments, parts) in [
        (
            vec!["env", "map.exr", "-o", "map.exr"],
            ["map.exr: the new map would replace", "another name"],
        ),
        (
            vec!["env", "map.exr", "-o", "./map.exr", "--width", "8"],
            ["./map.exr: the new map would", ";"],
        ),
        (
            vec!["env", "a_%.exr", "-o", "a_nz.exr", "--layout", "cross-v"],
            ["a_nz.exr: the new map would", ";"],
        ),
        (vec!["env", "a_%.exr", "-o", "a_%.exr"], ["a_px.exr: the new map would", ";"]),
        (vec!["env", "map.exr", "-o", "m.png"], ["m.png: maps are written as .exr or .hdr", ";"]),
        (
            vec!["env", "map.exr", "-o", "none/m.exr"],
            ["none/m.exr: the file cannot be written", "existing"],
        ),
        (
            vec!["env", "map.exr", "-o", "b_%.exr", "--layout", "cross-h"],
            ["b_%.exr: a % writes", ";"],
        ),
        (
            vec!["env", "map.exr", "-o", "m.exr", "--layout", "openexr-cube"],
            ["this is read, and not", ";"],
        ),
        (vec!["env", "map.exr", "--face", "8"], ["a face of 8: ", "ask for the layout `cube`"]),
        (vec!["env", "map.exr", "--layout", "cube", "--width", "8"], ["a width of 8: ", "face"]),
        (
            vec!["env", "map.exr", "--layout", "cube", "--face", "9000"],
            ["a face of 9000: ", "5461"],
        ),
        (vec!["env", "map.exr", "--width", "7"], ["a width of 7: ", "an even number"]),
        (
            vec!["env", "odd.exr"],
            ["odd.exr: the picture is 7x5, which is no shape of a map", "(2:1), a cross"],
        ),
        (vec!["env", "map.exr", "--env-layout", "strip-row"], ["as was asked for, is 6:1", ";"]),
        (vec!["env", "studio", "--env-layout", "cross-h"], ["studio: a recipe is no picture", ";"]),
        (vec!["env", "b_%.exr"], ["b_%.exr: there are no six files of this name", "px nx py"]),
        (vec!["env", "studoi"], ["there is no file and no recipe", "did you mean `studio`?"]),
    ] {
        let line = refused(f, &arguments);
        for part in parts {
            assert!(line.contains(part), "{arguments:?}: {part} is not in {line}");
        }
    }
}
