//! Meshes from files against the analytic sphere, glTF written by hand, and every bad input.

mod spellings;

use std::f64::consts::{PI, TAU};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::Vec3;

use super::super::{Camera, Shape, cast};
use super::*;

/// Writes a file into a folder of its own and loads it.
fn load(name: &str, bytes: impl AsRef<[u8]>) -> Result<Mesh> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    Mesh::load(path)
}

/// A sphere of `n` by `n / 2` facets about +y, as quads and polar triangles; with normals and uv
/// where wanted, and vertices moved and scaled, which loading must undo.
fn sphere_obj(n: usize, attributes: bool) -> String {
    let mut text = String::from("# a sphere\nmtllib none.mtl\no ball\n");
    let rows = n / 2;
    let at = |i: usize, j: usize| {
        let (phi, theta) = (TAU * i as f64 / n as f64, PI * j as f64 / rows as f64);
        [theta.sin() * phi.sin(), theta.cos(), theta.sin() * phi.cos()]
    };
    for j in 0..=rows {
        for i in 0..=n {
            let [x, y, z] = at(i, j);
            writeln!(text, "v {} {} {}", 3.0 * x + 5.0, 3.0 * y - 1.0, 3.0 * z).unwrap();
            if attributes {
                writeln!(text, "vn {x} {y} {z}").unwrap();
                writeln!(text, "vt {} {}", i as f64 / n as f64, j as f64 / rows as f64).unwrap();
            }
        }
    }
    let corner = |i: usize, j: usize| {
        let v = j * (n + 1) + i + 1;
        if attributes { format!("{v}/{v}/{v}") } else { v.to_string() }
    };
    for j in 0..rows {
        if j == rows / 2 {
            text.push_str("g lower half\ns 1\n");
        }
        for i in 0..n {
            let quad = [corner(i, j), corner(i, j + 1), corner(i + 1, j + 1), corner(i + 1, j)];
            writeln!(text, "f {}", quad.join(" ")).unwrap();
        }
    }
    text
}

/// Casts a mesh of a sphere beside the analytic one: no hole, and the largest angle (as a chord)
/// between their normals and tangents where the sphere does not graze.
fn against_the_sphere(mesh: Mesh, camera: &Camera, facet: f64) -> (f64, f64) {
    let size = 129;
    let coverage = cast(camera, &Shape::Mesh(Arc::new(mesh)), [size, size]);
    let exact = cast(camera, &Shape::Sphere, [size, size]);
    let mut points = coverage.points.iter().peekable();
    let (mut normals, mut tangents) = (0.0_f64, 0.0_f64);
    // The facets lie within one sagitta of the sphere, on its inside; the diagonal's is the
    // largest: 2 facet^2 / 8. A pixel deeper inside the silhouette must be covered.
    let sagitta = facet * facet / 4.0;
    for expected in &exact.points {
        let found = points.next_if(|point| point.pixel == expected.pixel);
        let offset = (1.0 - f64::from(expected.wo[2]).powi(2)).sqrt();
        assert!(found.is_some() || offset > 1.0 - sagitta, "a hole at {expected:?}");
        let Some(found) = found.filter(|_| expected.wo[2] > 0.3) else { continue };
        let chord = |a: [f32; 3], b: [f32; 3]| f64::from(Vec3::from(a).distance(b.into()));
        normals = normals.max(chord(found.normal, expected.normal));
        if expected.normal[1].abs() < 0.9 {
            tangents = tangents.max(chord(found.tangent, expected.tangent));
        }
    }
    assert!(points.next().is_none(), "a point outside the sphere");
    (normals, tangents)
}

#[test]
fn a_fine_obj_sphere_agrees_with_the_analytic_one() {
    let n = 256;
    let facet = TAU / n as f64;
    // The odd image puts its middle column on the meridian x = 0, which is a row of shared edges;
    // from above, many rays pass close to the pole, where 256 triangles meet.
    let level = Camera::default();
    let above = Camera { pitch: 90.0, yaw: 10.0, ..level };
    for camera in [level, above] {
        // With the sphere's own normals, the only error is that the ray meets the facet one sagitta
        // deeper, hence up to sagitta * tan(acos 0.3) = 3.2 sagittas aside.
        let mesh = load("ball.obj", sphere_obj(n, true)).unwrap();
        assert_eq!(mesh.triangles(), 2 * n * (n / 2) - 2 * n);
        assert_eq!(mesh.degenerate(), 2 * n, "the halves of quads at the poles");
        let (normals, tangents) = against_the_sphere(mesh, &camera, facet);
        let bound = 3.2 * facet * facet / 4.0 + 1e-6;
        assert!(normals < bound, "{normals} against {bound}");
        // Tangents from uv lie along the facets' edges: half a facet off at most, less by averaging.
        assert!(tangents < facet, "{tangents} against {facet}");

        // Computed normals add an error of second order in the facet.
        let mesh = load("ball.obj", sphere_obj(n, false)).unwrap();
        let (normals, tangents) = against_the_sphere(mesh, &camera, facet);
        assert!(normals < bound + facet * facet, "{normals}");
        assert!(tangents < 0.01, "{tangents}");
    }
}

#[test]
fn a_far_eye_and_an_eye_inside_see_the_mesh_as_well() {
    let mesh = Arc::new(load("ball.obj", sphere_obj(64, true)).unwrap());
    let far = Camera { distance: 1e5, fov: (2e-5_f64).to_degrees(), ..Camera::default() };
    let full = cast(&far, &Shape::Mesh(mesh.clone()), [64, 64]).points.len() as f64;
    assert!((full / (64.0 * 64.0) - PI / 4.0).abs() < 0.02, "{full}");
    let inside = Camera { distance: 0.5, ..Camera::default() };
    let coverage = cast(&inside, &Shape::Mesh(mesh), [33, 33]);
    assert_eq!((coverage.points.len(), coverage.bent), (33 * 33, 0));
}

#[test]
fn tilted_normals_are_bent_back_and_counted() {
    // A square that faces the default camera, with normals 89 degrees to the right: on the left
    // half of the image the eye stands to the right and sees them from the front, on the right half
    // the eye lies beyond their horizon by more than the one degree that is left.
    let (sin, cos) = 89.0_f64.to_radians().sin_cos();
    let text = format!(
        "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvn {sin} 0 {cos}\nf 1//1 2//1 3//1 4//1\n"
    );
    let mesh = load("square.obj", text).unwrap();
    assert_eq!(mesh.triangles(), 2);
    let coverage = cast(&Camera::default(), &Shape::Mesh(Arc::new(mesh)), [64, 64]);
    // The square's half-side is sqrt(1/2) once scaled. A view from x has wo.z > 0 for
    // sin * (0 - x) + cos * 4.5 > 0, that is x < 4.5 / tan 89 deg = 0.0785.
    let pixels_per_unit = 32.0 / (4.5 * 15.0_f64.to_radians().tan());
    let half = (0.5_f64.sqrt() * pixels_per_unit).round() as usize;
    let straight = half + (4.5 / 89.0_f64.to_radians().tan() * pixels_per_unit).round() as usize;
    assert_eq!(coverage.points.len(), 4 * half * half);
    assert_eq!(coverage.bent, (2 * half - straight) * 2 * half);
    let flat = coverage.points.iter().filter(|point| point.normal == [0.0, 0.0, 1.0]).count();
    assert_eq!(flat, coverage.bent);
}

#[test]
fn obj_peculiarities_are_read() {
    // Relative indices, w, colours, polylines, a Latin-1 comment, short material lines, unusable
    // normals, groups with and without attributes.
    let mut text =
        b"# caf\xe9\nmtllib gone.mtl\nv 0 0 0\nv 2 0 0 2\nv 0 1 0 0.5 0.5 0.5\n".to_vec();
    text.extend(b"vn 0 0 0\nvn nan 0 0\nl 1 2 3 1 2\nusemtl x\ng one\nf -3//1 -2//2 -1//1\n");
    text.extend(b"g two\nv 0 0 1\nf 1 2 4\n");
    let mesh = load("odd.obj", text).unwrap();
    assert_eq!(mesh.triangles(), 2);
    assert!(mesh.normals.iter().all(|n| n.is_normalized()));
    // The box is the unit cube: its corners lie sqrt(3) / 2 from the centre, the vertices too.
    assert!(mesh.positions.iter().all(|p| (p.length() - 1.0).abs() < 1e-12));
}

/// A GLB of one JSON and one binary chunk.
fn glb(json: &str, bin: &[u8]) -> Vec<u8> {
    let pad = |bytes: &[u8], fill: u8| {
        let mut bytes = bytes.to_vec();
        bytes.resize(bytes.len().next_multiple_of(4), fill);
        bytes
    };
    let (json, bin) = (pad(json.as_bytes(), b' '), pad(bin, 0));
    let mut out = b"glTF".to_vec();
    let word = |n: usize| (n as u32).to_le_bytes();
    out.extend([word(2), word(12 + 8 + json.len() + 8 + bin.len()), word(json.len())].concat());
    out.extend([b"JSON".as_slice(), &json, &word(bin.len()), b"BIN\0", &bin].concat());
    out
}

/// A GLB with a slanted square, z = x, whose normal is (-1, 0, 1) / sqrt(2); `node` is the JSON of
/// its nodes and `change` edits the rest.
fn slanted(node: &str, change: impl Fn(String) -> String) -> Vec<u8> {
    let mut bin = Vec::new();
    for [x, y] in [[-1.0_f32, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]] {
        bin.extend([x, y, x].iter().flat_map(|v| v.to_le_bytes()));
    }
    let n = 0.5_f32.sqrt();
    for _ in 0..4 {
        bin.extend([-n, 0.0, n].iter().flat_map(|v| v.to_le_bytes()));
    }
    bin.extend([0_u16, 1, 2, 0, 2, 3].iter().flat_map(|v| v.to_le_bytes()));
    // Normalized bytes: u grows along +y, v along x.
    bin.extend([[0_u8, 0], [0, 255], [255, 255], [255, 0]].concat());
    let json = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[NODES],
"meshes":[{"primitives":[{"attributes":{"POSITION":0,"NORMAL":1,"TEXCOORD_0":3},"indices":2}]}],
"buffers":[{"byteLength":116}],
"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":48},
{"buffer":0,"byteOffset":48,"byteLength":48},{"buffer":0,"byteOffset":96,"byteLength":12},
{"buffer":0,"byteOffset":108,"byteLength":8}],
"accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3",
"min":[-1,-1,-1],"max":[1,1,1]},
{"bufferView":1,"componentType":5126,"count":4,"type":"VEC3"},
{"bufferView":2,"componentType":5123,"count":6,"type":"SCALAR"},
{"bufferView":3,"componentType":5121,"normalized":true,"count":4,"type":"VEC2"}]}"#;
    glb(&change(json.replace("NODES", node)), &bin)
}

#[test]
fn a_glb_is_read_with_its_transforms_mirrored_ones_too() {
    let close = |a: DVec3, b: DVec3| (a - b).length() < 1e-6;
    // Scaling x by 2 makes the plane z = x / 2: its normal is (-1, 0, 2); the mirror flips x.
    // A parent turns both by 90 degrees about +y, which takes +x to -z and +z to +x.
    let nodes = r#"{"children":[1],"rotation":[0,0.70710678,0,0.70710678]},
{"mesh":0,"scale":[SCALE,1,1],"translation":[7,8,9]}"#;
    for (scale, normal) in [("2", [-1.0, 0.0, 2.0]), ("-2", [1.0, 0.0, 2.0])] {
        let nodes = nodes.replace("SCALE", scale);
        let [x, _, z] = normal;
        let normal = DVec3::new(z, 0.0, -x).normalize();
        for without_normals in [false, true] {
            let change = |json: String| match without_normals {
                true => json.replace(r#""NORMAL":1,"#, ""),
                false => json,
            };
            let mesh = load("slanted.glb", slanted(&nodes, change)).unwrap();
            assert_eq!(mesh.triangles(), 2);
            assert!(mesh.normals.iter().all(|&n| close(n, normal)), "{:?}", mesh.normals);
            let farthest = mesh.positions.iter().map(|p| p.length()).fold(0.0, f64::max);
            assert!((farthest - 1.0).abs() < 1e-12);
            let chart = usize::from(mesh.mirrored[0]);
            assert!(mesh.tangents.iter().all(|t| close(t[chart], DVec3::Y)), "u grows along +y");
        }
    }
}

#[test]
fn glb_tangents_of_the_file_win() {
    // The normals serve as tangents: four components are wanted, so the view is told its stride.
    let change = |json: String| {
        json.replace(r#""NORMAL":1"#, r#""TANGENT":1"#)
            .replace(r#"4,"type":"VEC3"},"#, r#"3,"type":"VEC4"},"#)
            .replace(r#""count":4,"type":"VEC3","#, r#""count":3,"type":"VEC3","#)
            .replace(r#""TEXCOORD_0":3"#, r#""TEXCOORD_1":3"#)
            .replace(r#""count":6"#, r#""count":3"#)
    };
    let mesh = load("tangents.glb", slanted(r#"{"mesh":0}"#, change)).unwrap();
    let expected = DVec3::new(-1.0, 0.0, 1.0).normalize();
    assert!((mesh.tangents[0][0] - expected).length() < 1e-6, "{:?}", mesh.tangents);
}

/// Asserts that loading fails with one line that has this reason, and a cure.
#[track_caller]
fn rejects(name: &str, bytes: impl AsRef<[u8]>, reason: &str) {
    let problem = load(name, bytes).unwrap_err();
    assert!(problem.reason.contains(reason), "{problem}");
    assert!(!problem.cure.is_empty() && !problem.reason.contains('\n'), "{problem}");
}

#[test]
fn bad_obj_files_are_told_by_line() {
    let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nvn 0 0 1\n";
    let with = |face: &str| format!("{square}{face}\n");
    rejects("no.obj", "\u{1}\u{2}PNG not a mesh\n", "is not an OBJ file");
    rejects("no.obj", "", "is not an OBJ file");
    rejects("no.obj", square, "has no faces");
    rejects("no.obj", with("f 1 2 0"), "vertex 0 is out of range");
    rejects("no.obj", with("f 1 2 4"), "vertex 4 is out of range: the file has 3");
    rejects("no.obj", with("f 1 2 -4"), "vertex -4 is out of range");
    rejects("no.obj", with("f 1/1 2/-9 3/1"), "texture coordinate -9 is out of range");
    rejects("no.obj", with("f 1//1 2//2 3//1"), "normal 2 is out of range");
    rejects("no.obj", with("f 1 2 x"), "\"x\" is not an index");
    rejects("no.obj", with("f 1 2 3/1/1/1"), "not a corner of a face");
    rejects("no.obj", with("f 1 2 99999999999999999999"), "is not an index");
    rejects("no.obj", with("f 1 2"), "needs three vertices");
    rejects("no.obj", with("v 1 nan 0\nf 1 2 3"), "\"nan\" is not a finite coordinate");
    rejects("no.obj", with("v 1 1e99 0\nf 1 2 3"), "\"1e99\" is not a finite coordinate");
    rejects("no.obj", with("v 1 2\nf 1 2 3"), "needs x, y and z");
    rejects("no.obj", with("v 1 2 3 0\nf 1 2 3"), "dividing by w gives no finite vertex");
    rejects("no.obj", with("v 1 2 3 1e-45\nf 1 2 4"), "dividing by w gives no finite vertex");
    rejects("no.obj", with("v 1 2 3 w\nf 1 2 3"), "\"w\" is not a finite coordinate");
    rejects("no.obj", with("vn 0 1\nf 1 2 3"), "a normal needs x, y and z");
    rejects("no.obj", with("vn 0 1 1,0\nf 1 2 3"), "\"1,0\" is not a number");
    rejects("no.obj", with("vt\nf 1 2 3"), "a texture coordinate needs u");
    rejects("no.obj", with("vt 0 y\nf 1 2 3"), "\"y\" is not a number");
    rejects("no.obj", with("f 1 2 //1"), "not a corner of a face");
    rejects("no.obj", "v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n", "has no size");
    rejects("no.obj", "v 0 0 0\nv 1 1 1\nv 2 2 2\nf 1 2 3\n", "all its 1 triangles have no area");
    let place = load("no.obj", with("f 1 2 4")).unwrap_err().place.unwrap();
    assert_eq!((place.line, place.column), (6, 7));
}

#[test]
fn bad_gltf_files_are_told() {
    let whole = slanted(r#"{"mesh":0}"#, |json| json);
    assert!(load("whole.glb", &whole).is_ok());
    for cut in [4, 11, 12, 19, 100, whole.len() - 1] {
        rejects("cut.glb", &whole[..cut], "is cut short");
    }
    let mut short_header = whole.clone();
    short_header[8..12].copy_from_slice(&3_u32.to_le_bytes());
    rejects("no.glb", short_header, "is cut short");
    rejects("no.gltf", "{", "is not a valid glTF file");
    rejects("no.gltf", "", "is not a valid glTF file");
    rejects("no.gltf", r#"{"asset":{"version":"2.0"}}"#, "holds no scene");
    let missing = r#"{"asset":{"version":"2.0"},"scenes":[{"nodes":[]}],"buffers":[{"byteLength":1,"uri":"U"}]}"#;
    rejects("no.gltf", missing.replace('U', "gone.bin"), "its data cannot be read");
    rejects("no.gltf", missing.replace('U', "%FF.bin"), "cannot read the file name");

    let edit = |from: &str, to: &str, reason: &str| {
        let change = |json: String| {
            assert!(json.contains(from), "{from}");
            json.replacen(from, to, 1)
        };
        rejects("no.glb", slanted(r#"{"mesh":0}"#, change), reason);
    };
    edit(r#""POSITION":0"#, r#""POSITION":9"#, "a mesh names data that is not in the file");
    edit(r#""count":4"#, r#""count":5"#, "beyond its buffer");
    edit(r#""count":4"#, r#""count":0"#, "a face uses vertex");
    edit(r#""count":6"#, r#""count":200000000"#, "more than the 50000000 allowed");
    edit(r#""type":"VEC3""#, r#""type":"VEC2""#, "wrong number of components");
    edit(r#""byteLength":12"#, r#""byteLength":99"#, "beyond its buffer");
    edit(r#""byteOffset":96"#, r#""byteOffset":18446744073709551615"#, "beyond its buffer");
    edit(r#""byteOffset":96"#, r#""byteOffset":48"#, "a face uses vertex");
    edit(r#""indices":2"#, r#""indices":2,"mode":1"#, "holds no triangles (1 primitives");
    edit(r#""nodes":[0]"#, r#""nodes":[0,0]"#, "reached twice");
    edit(r#"{"mesh":0}"#, r#"{"mesh":0,"children":[0]}"#, "reached twice");
    edit(r#"{"mesh":0}"#, r#"{"mesh":0,"scale":[0,0,0]}"#, "has no size");
    edit(r#"{"mesh":0}"#, r#"{"mesh":0,"scale":[0,1,0]}"#, "have no area");
    let flat = slanted(r#"{"mesh":0}"#, |json| {
        json.replacen(r#""byteLength":116"#, r#""byteLength":999"#, 1)
    });
    rejects("no.glb", flat, "its data cannot be read");
}

#[test]
fn missing_files_and_unknown_kinds_are_told() {
    let problem = Mesh::load("/nowhere/mesh.obj").unwrap_err();
    assert!(problem.reason.starts_with("there is no such file"), "{problem}");
    rejects("mesh.ply", "ply", "no mesh file of a known kind");
    assert!(load("mesh", "").unwrap_err().cure.contains(".obj, .gltf or .glb"));
    assert!(check_count("big.obj", MAX_TRIANGLES).is_ok());
    assert!(check_count("big.obj", MAX_TRIANGLES + 1).unwrap_err().reason.contains("50000001"));
}

/// A file of the outside data, or a printed reason for the skip.
fn outside(name: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("BRDF_TEST_DATA");
    if folder.is_none() {
        println!("skipped mesh/{name}: BRDF_TEST_DATA is not set");
    }
    Some(Path::new(&folder?).join("mesh").join(name))
}

#[test]
fn real_meshes_load_and_cover() {
    for (name, triangles) in [("spot.obj", 5856), ("vintage_oil_lamp_font.obj", 5156)] {
        let Some(path) = outside(name) else { continue };
        let start = std::time::Instant::now();
        let mesh = Mesh::load(path).unwrap();
        let loaded = start.elapsed();
        assert!(mesh.triangles() + mesh.degenerate() >= triangles);
        let degenerate = mesh.degenerate();
        let start = std::time::Instant::now();
        let coverage = cast(&Camera::default(), &Shape::Mesh(Arc::new(mesh)), [512, 512]);
        let (points, bent) = (coverage.points.len(), coverage.bent);
        println!("{name}: load {loaded:?}, cast {:?}", start.elapsed());
        println!("{points} points, {bent} bent, {degenerate} degenerate");
        assert!(points > 20_000 && bent * 100 < points);
        assert!(coverage.points.iter().all(|point| point.wo[2] > 0.0));
    }
}
