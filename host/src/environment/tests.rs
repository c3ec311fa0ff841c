//! The module as a whole: files of every kind, and real maps where there are some.

mod layouts;

use std::fs;
use std::path::PathBuf;

use super::*;

fn told(path: &Path) -> String {
    let folder = path.parent().map(|folder| format!("{}/", folder.display())).unwrap_or_default();
    load(path, &Options::default()).unwrap_err().to_string().replace(&folder, "")
}

#[test]
fn what_is_no_map_is_told_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, content: &[u8]| {
        let path = folder.path().join(name);
        fs::write(&path, content).unwrap();
        told(&path)
    };
    let cure = "give a Radiance picture (.hdr), an OpenEXR picture (.exr), a Ptex cube (.ptx) or a \
                recipe (.toml)";
    assert_eq!(
        told(&folder.path().join("none.hdr")),
        format!("none.hdr: there is no such file; {cure}")
    );
    fs::create_dir(folder.path().join("maps.exr")).unwrap();
    assert_eq!(
        told(&folder.path().join("maps.exr")),
        format!("maps.exr: this is a folder; {cure}")
    );
    assert_eq!(file("empty.hdr", b""), format!("empty.hdr: the file is empty; {cure}"));
    assert_eq!(
        file("text.hdr", b"hello"),
        format!(
            "text.hdr: this is neither a Radiance nor an OpenEXR picture nor a Ptex file; {cure}"
        )
    );
    assert_eq!(
        file("photo.hdr", b"\x89PNG\r\n\x1a\n"),
        format!("photo.hdr: this is a PNG picture, not a map that can be read; {cure}")
    );
    assert_eq!(
        file("r.toml", b"\xff\xfe"),
        "r.toml: the recipe is not UTF-8 text; save it as UTF-8 text"
    );
}

#[test]
fn content_and_not_the_extension_decides() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("map.exr");
    fs::write(&path, b"#?RADIANCE\nEXPOSURE=2\n\n-Y 1 +X 2\n\x80\x80\x80\x82\x80\x80\x80\x82")
        .unwrap();
    let map = load(&path, &Options { width: Some(64), ..Options::default() }).unwrap();
    assert_eq!((map.width, map.height), (2, 1));
    assert_eq!(*map.texels, [[1.0, 1.0, 1.0, 0.0]; 2]);
    assert_eq!(map.name, path.display().to_string());
    assert_eq!(
        map.notes,
        [
            "divided by the file's EXPOSURE 2",
            "kept at its own 2x1: a width can be chosen for recipes only"
        ]
    );
    assert!(map.seconds > 0.0);
}

#[test]
fn bad_texels_of_a_file_are_counted_and_replaced_on_request() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bad.exr");
    let values = [f32::NAN, f32::INFINITY, -3.0, 2.0, 5.0, 1.0, 1.0, 1.0];
    exr::prelude::write_rgb_file(&path, 4, 2, |x, y| (values[y * 4 + x], 0.5_f32, 0.25_f32))
        .unwrap();
    assert_eq!(
        told(&path),
        "bad.exr: the map has 1 NaN, 1 infinite and 1 negative texels; \
         mend the file, or replace them with --replace-bad-texels"
    );
    let map = load(&path, &Options { replace_bad: true, ..Options::default() }).unwrap();
    let reds: Vec<f32> = map.texels.iter().map(|texel| texel[0]).collect();
    assert_eq!(reds, [0.0, 5.0, 0.0, 2.0, 5.0, 1.0, 1.0, 1.0]);
    assert_eq!(
        map.notes,
        [
            "replaced 1 NaN, 1 infinite and 1 negative texels (NaN and negative by 0, +infinity by the largest finite \
          value)"
        ]
    );
}

#[test]
fn a_recipe_is_the_same_from_disk_and_from_memory() {
    let source =
        "kind = \"recipe\"\nformat = 1\nabout = \"x\"\n[background]\nconstant = [1, 2, 3]\n";
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("r.toml");
    fs::write(&path, source).unwrap();
    let options = Options { width: Some(32), ..Options::default() };
    let disk = load(&path, &options).unwrap();
    let memory = from_recipe("r", "envmaps/r.toml", source, &options).unwrap();
    assert_eq!((memory.name.as_str(), memory.width, memory.height), ("r", 32, 16));
    assert_eq!(disk.texels, memory.texels);
    assert_eq!(memory.texels[0], [1.0, 2.0, 3.0, 0.0]);
}

/// The folder of real maps, or none with the reason printed.
fn real_maps() -> Option<PathBuf> {
    let folder = std::env::var_os("BRDF_TEST_DATA").map(|data| PathBuf::from(data).join("hdri"));
    if folder.is_none() {
        println!("skipped: BRDF_TEST_DATA is not set, so there are no real maps to check");
    }
    folder
}

#[test]
fn real_maps_have_their_published_luminances() {
    let Some(folder) = real_maps() else { return };
    // Largest luminance and mean by solid angle, with as many digits as their table prints.
    let facts = [
        ("studio_small_03_1k.hdr", "3350", "2.22"),
        ("potsdamer_platz_1k.hdr", "10.9", "0.558"),
        ("kloppenheim_05_1k.hdr", "78900", "0.804"),
        ("st_peters_square_night_1k.hdr", "9130", "0.949"),
    ];
    for (file, largest, mean) in facts {
        let map = load(&folder.join(file), &Options::default()).unwrap();
        assert_eq!((map.width, map.height), (1024, 512));
        let luminance = |texel: &[f32; 4]| {
            let [r, g, b, _] = texel.map(f64::from);
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        let mut sum = 0.0;
        let mut most = 0.0_f64;
        for (y, row) in map.texels.chunks(1024).enumerate() {
            let solid_angle = orientation::texel_solid_angle(y as u32, 1024, 512);
            for value in row.iter().map(luminance) {
                sum += value * solid_angle;
                most = most.max(value);
            }
        }
        let three_digits = |value: f64| {
            let unit = 10.0_f64.powf(value.log10().floor() - 2.0);
            (value / unit).round() * unit
        };
        let same = |got: f64, printed: &str| {
            (three_digits(got) / printed.parse::<f64>().unwrap() - 1.0).abs() < 1e-9
        };
        let mean_found = sum / (4.0 * std::f64::consts::PI);
        assert!(same(most, largest), "{file}: largest {most}, not {largest}");
        assert!(same(mean_found, mean), "{file}: mean {mean_found}, not {mean}");
    }
}

#[test]
fn the_shipped_recipes_are_maps() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../envmaps");
    let mut count = 0;
    for entry in fs::read_dir(&folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "toml") {
            let map = load(&path, &Options { width: Some(128), ..Options::default() }).unwrap();
            assert!(map.texels.iter().any(|texel| texel[1] > 0.0), "{}", path.display());
            count += 1;
        }
    }
    assert!(count > 0, "{} holds recipes", folder.display());
}
