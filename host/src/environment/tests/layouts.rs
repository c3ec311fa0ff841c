//! Every layout of every kind of file: the same directions, the same energy.

use exr::image::{AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer};
use exr::meta::attribute::EnvironmentMap;
use exr::meta::header::LayerAttributes;
use exr::prelude::WritableImage;
use glam::DVec3;

use super::*;
use crate::environment::arrangement;
use crate::environment::convert::relative;
use crate::environment::six_files::NAMES;
use crate::tone::luminance;

/// A radiance that tells all directions apart: each of the three coordinates in its own channel.
fn told_by(direction: DVec3) -> [f32; 4] {
    let rgb = (direction.normalize() * 0.5 + 0.5).as_vec3();
    [rgb.x, rgb.y, rgb.z, 0.0]
}

/// The map of that radiance with its texels' centres.
fn named_directions(layout: Layout, width: u32) -> Environment {
    let height = if layout == Layout::Cube { 6 * width } else { width / 2 };
    let mut map = Environment { layout, width, height, ..Environment::constant(0.0) };
    let texel = |i: u32| told_by(map.direction(i % width, i / width));
    let texels = (0..width * height).map(texel).collect();
    map.texels = Arc::new(texels);
    map
}

/// Directions all around, no two alike.
fn directions() -> impl Iterator<Item = DVec3> {
    (0..500).map(|i| {
        let z = (f64::from(i) + 0.5) / 250.0 - 1.0;
        let angle = f64::from(i) * 2.4;
        let radius = (1.0 - z * z).sqrt();
        DVec3::new(radius * angle.cos(), z, radius * angle.sin())
    })
}

/// In all directions the map shows the named radiance, to `tolerance`.
fn assert_named(map: &Environment, tolerance: f32) {
    for direction in directions() {
        let (found, expected) = (map.radiance(direction), told_by(direction));
        for (found, expected) in found.iter().zip(expected) {
            assert!(
                (found - expected).abs() < tolerance,
                "{} {:?}: {direction} is {found}, not {expected}",
                map.name,
                map.layout
            );
        }
    }
}

fn write_exr(path: &Path, width: u32, texels: &[[f32; 4]], envmap: Option<EnvironmentMap>) {
    let channel = |index: usize, name: &str| {
        AnyChannel::new(name, FlatSamples::F32(texels.iter().map(|t| t[index]).collect()))
    };
    let channels = AnyChannels::sort(
        [channel(0, "R"), channel(1, "G"), channel(2, "B")].into_iter().collect(),
    );
    let mut attributes = LayerAttributes::named("map");
    attributes.environment_map = envmap;
    let size = (width as usize, texels.len() / width as usize);
    let layer = Layer::new(size, attributes, Encoding::SMALL_LOSSLESS, channels);
    Image::from_layer(layer).write().to_file(path).unwrap();
}

#[test]
fn every_arrangement_shows_the_same_directions() {
    let folder = tempfile::tempdir().unwrap();
    let side = 24;
    let cube = named_directions(Layout::Cube, side);
    // Half a texel's diagonal on the sphere, halved by the encoding of directions.
    assert_named(&cube, 0.05);
    for (word, arrangement) in [
        ("cross-h", Arrangement::CrossH),
        ("cross-v", Arrangement::CrossV),
        ("strip-row", Arrangement::StripRow),
        ("strip-col", Arrangement::StripCol),
    ] {
        let (width, _, texels) = pack(&cube.texels, side, arrangement);
        let path = folder.path().join(format!("{word}.exr"));
        write_exr(&path, width, &texels, None);
        for asked in [None, Some(arrangement)] {
            let map = load(&path, &Options { arrangement: asked, ..Options::default() }).unwrap();
            assert_eq!((map.layout, map.width), (Layout::Cube, side), "{word}");
            assert_eq!(map.texels, cube.texels, "{word}");
        }
        let lat_long =
            load(&path, &Options { layout: Some(Layout::LatLong), ..Options::default() });
        let lat_long = lat_long.unwrap();
        assert_eq!((lat_long.width, lat_long.height), (96, 48));
        assert_named(&lat_long, 0.09);
    }
    // Six files of each set of names.
    let (width, _, strip) = pack(&cube.texels, side, Arrangement::StripCol);
    for (index, names) in NAMES.iter().enumerate() {
        for (face, name) in names.iter().enumerate() {
            let path = folder.path().join(format!("{index}_{name}.exr"));
            let texels = &strip[face * (width * width) as usize..][..(width * width) as usize];
            write_exr(&path, width, texels, None);
        }
        let map = load(&folder.path().join(format!("{index}_%.exr")), &Options::default()).unwrap();
        assert_eq!(map.texels, cube.texels, "{names:?}");
    }
    // Lat-long, and what becomes of it.
    let path = folder.path().join("panorama.exr");
    write_exr(&path, 96, &named_directions(Layout::LatLong, 96).texels, None);
    assert_named(&load(&path, &Options::default()).unwrap(), 0.05);
    let options = Options { layout: Some(Layout::Cube), ..Options::default() };
    let map = load(&path, &options).unwrap();
    assert_eq!((map.layout, map.width, map.height), (Layout::Cube, 24, 144));
    assert_named(&map, 0.09);
}

/// OpenEXR's own maps, made pixel by pixel from the directions that ImfEnvmap.h gives.
#[test]
fn openexr_environment_maps_are_resampled() {
    let folder = tempfile::tempdir().unwrap();
    // Latitude from pi/2 down to -pi/2 and longitude from pi down to -pi, on the outer pixels' centres.
    let (width, height) = (96_u32, 48_u32);
    let pixel = |i: u32| {
        let longitude =
            std::f64::consts::PI * (1.0 - 2.0 * f64::from(i % width) / f64::from(width - 1));
        let latitude = std::f64::consts::PI * (0.5 - f64::from(i / width) / f64::from(height - 1));
        let (sin, cos) = latitude.sin_cos();
        told_by(DVec3::new(longitude.sin() * cos, sin, longitude.cos() * cos))
    };
    let texels: Vec<[f32; 4]> = (0..width * height).map(pixel).collect();
    let path = folder.path().join("latlong.exr");
    write_exr(&path, width, &texels, Some(EnvironmentMap::LatitudeLongitude));
    let map = load(&path, &Options::default()).unwrap();
    assert_eq!((map.width, map.height), (width, height));
    assert!(map.notes[0].starts_with("resampled from OpenEXR's LATLONG"), "{:?}", map.notes);
    assert_named(&map, 0.05);
    // Nearly no error is left at the seam, where a shift by half a pixel would show: 0.5 = no x.
    let seam = map.radiance(DVec3::new(1e-9, 0.0, -1.0))[0]
        + map.radiance(DVec3::new(-1e-9, 0.0, -1.0))[0];
    assert!((seam - 1.0).abs() < 1e-6, "{seam}");
    // Its energy is that of its own half pixels: the mean of three linear functions, 1/2 each.
    for channel in map.energy() {
        assert!((channel / std::f64::consts::TAU - 1.0).abs() < 1e-5, "{channel}");
    }
    // Asked for plain pixels it is not resampled.
    let plain = Options { arrangement: Some(Arrangement::LatLong), ..Options::default() };
    assert_eq!(*load(&path, &plain).unwrap().texels, texels);

    // Faces with pixel centres from edge to edge; right and down of each as in ImfEnvmap.h's drawing.
    let side = 25_u32;
    let faces = [
        (DVec3::X, DVec3::Z, DVec3::NEG_Y),
        (DVec3::NEG_X, DVec3::NEG_Z, DVec3::NEG_Y),
        (DVec3::Y, DVec3::X, DVec3::NEG_Z),
        (DVec3::NEG_Y, DVec3::X, DVec3::Z),
        (DVec3::Z, DVec3::NEG_X, DVec3::NEG_Y),
        (DVec3::NEG_Z, DVec3::X, DVec3::NEG_Y),
    ];
    let place = |i: u32| 2.0 * f64::from(i) / f64::from(side - 1) - 1.0;
    let pixel = |i: u32| {
        let (axis, right, down) = faces[(i / side / side) as usize];
        told_by(axis + right * place(i % side) + down * place(i / side % side))
    };
    let texels: Vec<[f32; 4]> = (0..6 * side * side).map(pixel).collect();
    let path = folder.path().join("cube.exr");
    write_exr(&path, side, &texels, Some(EnvironmentMap::Cube));
    let map = load(&path, &Options::default()).unwrap();
    assert_eq!((map.layout, map.width), (Layout::Cube, side));
    assert_named(&map, 0.05);
    for channel in map.energy() {
        assert!((channel / std::f64::consts::TAU - 1.0).abs() < 1e-5, "{channel}");
    }
}

#[test]
fn faces_and_shapes_that_make_no_map_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let grey = |count: usize| vec![[0.5; 4]; count];
    write_exr(&path("square.exr"), 4, &grey(16), None);
    let told_with = |name: &str, options: &Options| {
        let prefix = format!("{}/", folder.path().display());
        load(&path(name), options).unwrap_err().to_string().replace(&prefix, "")
    };
    let told = |name: &str| told_with(name, &Options::default());
    assert!(
        told("square.exr")
            .starts_with("square.exr: the picture is 4x4, a single face of a cube; give")
    );
    assert!(told("no_%.exr").starts_with("no_%.exr: there are no six files of this name; let %"));
    for name in ["px", "nx", "py", "pz"] {
        write_exr(&path(&format!("a_{name}.exr")), 4, &grey(16), None);
    }
    assert!(told("a_%.exr").contains("of its six files these are missing: a_ny.exr, a_nz.exr"));
    write_exr(&path("a_ny.exr"), 2, &grey(4), None);
    write_exr(&path("a_nz.exr"), 4, &grey(16), None);
    assert_eq!(
        told("a_%.exr"),
        "a_ny.exr: the face is 2x2, that of a_px.exr is 4x4; give six square pictures of one size"
    );
    write_exr(&path("a_ny.exr"), 4, &grey(8), None);
    assert!(told("a_%.exr").contains("a_ny.exr: the picture is 4x2, and a face is a square"));
    let cross = Options { arrangement: Some(Arrangement::CrossH), ..Options::default() };
    write_exr(&path("panorama.exr"), 4, &grey(8), None);
    assert_eq!(
        told_with("panorama.exr", &cross),
        "panorama.exr: the picture is 4x2, and cross-h, as was asked for, is 4:3; \
         leave the layout to the picture's shape, or give a picture of that shape"
    );
    assert!(told_with("a_%.exr", &cross).contains("six files are always a cube"));
    write_exr(&path("envmap.exr"), 4, &grey(8), Some(EnvironmentMap::Cube));
    assert!(told("envmap.exr").contains("openexr-cube, as its `envmap` attribute says, is 1:6"));
    let face = Options { face: Some(7), ..Options::default() };
    assert!(told_with("panorama.exr", &face).starts_with("a face of 7: "));
    let huge = Options { layout: Some(Layout::Cube), face: Some(6000), ..Options::default() };
    assert_eq!(
        told_with("panorama.exr", &huge),
        "a face of 6000: this is no size of a map; give a number from 1 to 5461"
    );
    // What a cross leaves empty may hold anything.
    let mut texels = pack(&grey(6 * 4), 2, Arrangement::CrossH).2;
    texels[0] = [f32::NAN; 4];
    write_exr(&path("corner.exr"), 8, &texels, None);
    load(&path("corner.exr"), &Options::default()).unwrap();
    assert_eq!(arrangement::of_shape(4, 4), None);
}

#[test]
fn constants_stay_and_single_texels_keep_their_energy() {
    for (width, face) in [(2, 1), (2, 5), (64, 16), (64, 3), (64, 100), (1024, 8)] {
        let constant = Environment {
            width,
            height: width / 2,
            texels: Arc::new(vec![[0.25, 3e30, 1e-30, 0.0]; (width * width / 2) as usize]),
            ..Environment::constant(0.0)
        };
        let form = Form { layout: Some(Layout::Cube), face: Some(face), width: None };
        let cube = constant.clone().in_form(form).unwrap();
        let form = Form { layout: Some(Layout::LatLong), face: None, width: Some(width) };
        let back = cube.clone().in_form(form).unwrap();
        for map in [&cube, &back] {
            for texel in map.texels.iter() {
                for (value, exact) in texel.iter().zip([0.25, 3e30, 1e-30]) {
                    assert!((value / exact - 1.0).abs() < 1e-5, "{width} {face}: {texel:?}");
                }
            }
        }
    }
    // One texel after another is the only light: at the poles, at corners and edges of faces, between.
    for (column, row) in [(0, 0), (17, 1), (8, 10), (8, 11), (24, 16), (5, 20), (40, 31), (63, 13)]
    {
        let mut texels = vec![[0.0; 4]; 64 * 32];
        texels[row * 64 + column] = [1e6, 1e6, 1e6, 0.0];
        let map = Environment {
            width: 64,
            height: 32,
            texels: Arc::new(texels),
            ..Environment::constant(0.0)
        };
        let before = luminance(map.energy());
        for face in [4, 16, 50] {
            let form = Form { layout: Some(Layout::Cube), face: Some(face), width: None };
            let cube = map.clone().in_form(form).unwrap();
            let change = relative(before, luminance(cube.energy()));
            assert!(change.abs() < 2e-5, "{column} {row} to {face}: {change}");
            let form = Form { layout: Some(Layout::LatLong), face: None, width: Some(64) };
            let back = cube.in_form(form).unwrap();
            let change = relative(before, luminance(back.energy()));
            assert!(change.abs() < 2e-5, "{column} {row} from {face}: {change}");
        }
    }
}

#[test]
fn real_maps_keep_their_energy_as_cubes() {
    let Some(folder) = real_maps() else { return };
    for file in [
        "studio_small_03_1k",
        "potsdamer_platz_1k",
        "kloppenheim_05_1k",
        "st_peters_square_night_1k",
    ] {
        let map = load(&folder.join(format!("{file}.hdr")), &Options::default()).unwrap();
        let before = map.energy();
        let form = Form { layout: Some(Layout::Cube), ..Form::default() };
        let cube = map.in_form(form).unwrap();
        let back = cube.clone().in_form(Form { layout: Some(Layout::LatLong), ..Form::default() });
        for map in [&cube, &back.unwrap()] {
            println!("{file}: {:?}", map.notes.last());
            for (before, after) in before.iter().zip(map.energy()) {
                assert!(relative(*before, after).abs() < 1e-6, "{file}: {before} {after}");
            }
        }
    }
}
