//! What a page's reader brings along: maps, meshes, measured files, scenes, pictures, the tree's examples. Made small, by
//! the program where it can, and only where a page names them.

use std::fs;
use std::path::Path;

use super::common::{program, root};
use super::crates;

/// A file, and what makes it in a folder.
type Brought = (&'static str, fn(&Path));

const FILES: [Brought; 13] = [
    ("MAP.hdr", |folder| brdf(folder, &["env", "sky-with-sun", "--width", "16", "-o", "MAP.hdr"])),
    ("MESH.obj", |folder| write(folder, "MESH.obj", OCTAHEDRON)),
    ("gold.binary", |folder| write(folder, "gold.binary", merl())),
    ("brushed.bsdf", |folder| write(folder, "brushed.bsdf", rgl())),
    ("satin.dat", |folder| write(folder, "satin.dat", csail())),
    ("slice.exr", slice),
    ("satin.brdf", |folder| {
        copy(&root().join("examples/brdf-explorer/satin.brdf"), &folder.join("satin.brdf"));
    }),
    ("brocade.bparam", |folder| {
        for name in ["satin.brdf", "brocade.bparam"] {
            copy(&root().join("examples/brdf-explorer").join(name), &folder.join(name));
        }
    }),
    ("A.exr", |folder| picture(folder, "A", "1")),
    ("B.exr", |folder| picture(folder, "B", "2")),
    ("scene.toml", |folder| write(folder, "scene.toml", SCENE)),
    ("yesterday.json", yesterday),
    ("speckle", speckle),
];

/// Folders of the tree that pages read from.
const FOLDERS: [&str; 3] = ["examples", "tests/references", "tests/fixtures/brdf"];

const OCTAHEDRON: &str = "v 1 0 0\nv -1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nv 0 0 -1\nf 1 3 5\nf 3 2 5\nf 2 4 5\nf 4 1 5\n\
    f 3 1 6\nf 2 3 6\nf 4 2 6\nf 1 4 6\n";

const SCENE: &str = "[brdf]\nplugin = \"ggx\"\nparams = { alpha_x = 0.3, alpha_y = 0.3 }\n\n[environment]\nmap = \"studio\"\n\
    width = 32\n\n[film]\nresolution = [24, 24]\n";

/// Brings what the commands name.
pub fn files(folder: &Path, commands: &[&String]) {
    let words: Vec<&str> = commands
        .iter()
        .flat_map(|line| line.split([' ', '=', ',', ';']))
        .map(|word| word.trim_start_matches("./"))
        .collect();
    let named = |name: &str| {
        let (inside, like_it) = (format!("{name}/"), format!("-{name}"));
        words
            .iter()
            .any(|word| *word == name || word.starts_with(&inside) || word.ends_with(&like_it))
    };
    for (name, make) in FILES {
        if named(name) {
            make(folder);
        }
    }
    // Other names for the same.
    if words.contains(&"purple-satin.dat") {
        copy(&folder.join("satin.dat"), &folder.join("purple-satin.dat"));
    }
    for tree in FOLDERS {
        if named(tree) {
            copy_folder(&root().join(tree), &folder.join(tree));
        }
    }
    // Of the hard scenes a few stand for all, whose references take minutes.
    for scene in fs::read_dir(folder.join("examples/hard")).into_iter().flatten() {
        let scene = scene.unwrap().path();
        if !["black", "mirror", "unsampled"].iter().any(|few| scene.ends_with(few)) {
            fs::remove_dir_all(scene).unwrap();
        }
    }
}

fn write(folder: &Path, name: &str, bytes: impl AsRef<[u8]>) {
    fs::write(folder.join(name), bytes).unwrap();
}

pub fn copy(from: &Path, to: &Path) {
    fs::copy(from, to).unwrap_or_else(|error| panic!("{}: {error}", from.display()));
}

/// Everything in a folder but what cargo builds.
pub fn copy_folder(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let path = entry.unwrap().path();
        let target = to.join(path.file_name().unwrap());
        match path.is_dir() {
            true if path.ends_with("target") => {}
            true => copy_folder(&path, &target),
            false => copy(&path, &target),
        }
    }
}

fn brdf(folder: &Path, arguments: &[&str]) {
    let output = program::run(folder, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", program::text(&output.stderr));
}

fn picture(folder: &Path, name: &str, seed: &str) {
    let mut arguments =
        program::small(&["lambert", "--ibl", "furnace", "--ibl-width", "32", "--device", "cpu"]);
    arguments.extend(["--export", name, "--seed", seed]);
    brdf(folder, &arguments);
}

/// A report of `brdf bench` of a machine whose times were so long that none can be worse today.
fn yesterday(folder: &Path) {
    let few = [
        "--resolution",
        "16",
        "--ibl-width",
        "32",
        "--samples",
        "16",
        "--time",
        "0.01",
        "--repeats",
        "1",
    ];
    brdf(
        folder,
        &[&["bench", "--preset", "quick", "--json", "yesterday.json", "--device", "cpu"], &few[..]]
            .concat(),
    );
    let text = fs::read_to_string(folder.join("yesterday.json")).unwrap();
    let mut report: serde_json::Value = serde_json::from_str(&text).unwrap();
    for cell in report["cells"].as_array_mut().unwrap() {
        let rate = cell["relative_rate"].as_f64().expect("a cell has its rate");
        cell["relative_rate"] = (0.01 * rate).into();
    }
    write(folder, "yesterday.json", report.to_string());
}

/// An image over theta_h and theta_d.
fn slice(folder: &Path) {
    let value = |x: usize, y: usize| 1.0 / (1.0 + x as f32) + 0.01 * y as f32;
    let colour = |x, y| (value(x, y), value(x, y), 0.5 * value(x, y));
    exr::prelude::write_rgb_file(folder.join("slice.exr"), 8, 8, colour).unwrap();
}

/// MERL: a lobe over theta_h, by whose steps the bins go slowest.
fn merl() -> Vec<u8> {
    const BINS: usize = 90 * 90 * 180;
    let value = |bin: usize| {
        let f = 0.1 + (-20.0 * bin as f64 / BINS as f64).exp();
        Some([f, 0.7 * f, 0.2 * f])
    };
    brdf_measured::merl::bytes(&(0..BINS).map(value).collect::<Vec<_>>())
}

/// MIT CSAIL: the header's numbers of bins, of channels, then a plane for each colour.
fn csail() -> Vec<u8> {
    let bins = [4i32, 4, 6, 2];
    let header = [bins[0], bins[1], bins[2], bins[3], 0, 0, 0, 0, 0, 0, 3, 0, 0, 0, 0, 0];
    let mut bytes: Vec<u8> = header.iter().flat_map(|word| word.to_le_bytes()).collect();
    let count = bins.iter().product::<i32>();
    bytes.extend((0..3 * count).flat_map(|i| (0.01 + 0.001 * (i % 7) as f32).to_le_bytes()));
    bytes
}

/// RGL: a tensor file of a grey isotropic material; the table of fields, then their bytes.
fn rgl() -> Vec<u8> {
    let even = |shape: &[u64], number: f32| {
        let count: u64 = shape.iter().product();
        (shape.to_vec(), vec![number; count as usize])
    };
    let fields = [
        ("theta_i", (vec![2], vec![0.0, 1.5])),
        ("phi_i", (vec![1], vec![0.0])),
        ("ndf", even(&[2, 3], 0.5)),
        ("sigma", even(&[2, 2], 0.5)),
        ("vndf", even(&[1, 2, 2, 3], 0.5)),
        ("luminance", even(&[1, 2, 2, 2], 0.5)),
        ("rgb", even(&[1, 2, 3, 2, 2], 0.2)),
    ];
    let table: usize =
        fields.iter().map(|(name, (shape, _))| 13 + name.len() + 8 * shape.len()).sum();
    let mut begin = 18 + table as u64;
    let mut bytes = b"tensor_file\0\x01\0".to_vec();
    bytes.extend((fields.len() as u32).to_le_bytes());
    for (name, (shape, numbers)) in &fields {
        bytes.extend((name.len() as u16).to_le_bytes());
        bytes.extend(name.bytes());
        bytes.extend((shape.len() as u16).to_le_bytes());
        // Floats of 32 bits.
        bytes.push(10);
        bytes.extend(begin.to_le_bytes());
        bytes.extend(shape.iter().flat_map(|n| n.to_le_bytes()));
        begin += 4 * numbers.len() as u64;
    }
    bytes.extend(
        fields.iter().flat_map(|(_, (_, numbers))| numbers).flat_map(|number| number.to_le_bytes()),
    );
    bytes
}

/// A plugin with a native library, by another name.
fn speckle(folder: &Path) {
    let own = folder.join("speckle");
    copy_folder(&root().join("examples/gloss-curve"), &own);
    fs::rename(own.join("gloss-curve.wgsl"), own.join("speckle.wgsl")).unwrap();
    crates::build(&own).unwrap();
}
