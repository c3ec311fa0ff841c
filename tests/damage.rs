//! Thousands of changed files, the same in every run: each reader of the host gives a value or one line, and never
//! panics; what links gives the same bits on the CPU executor however it is run.
//!
//! The checks are those of `fuzz/`, where coverage leads the changes; this is the bounded run that is always made.
//! `BRDF_DAMAGE` is by how much longer it shall be.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    reason = "a test says what it expects by unwrapping"
)]

#[path = "../fuzz/src/map.rs"]
mod map;
#[path = "../fuzz/src/mesh.rs"]
mod mesh;
#[path = "../fuzz/src/plugin.rs"]
mod plugin;
#[path = "../fuzz/src/problem.rs"]
mod problem;
#[path = "../fuzz/src/rows.rs"]
mod rows;
#[path = "../fuzz/src/tokens.rs"]
mod tokens;

use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use brdf_host::environment::{Options, from_recipe};
use brdf_host::link::{View, link};
use brdf_host::registry::Registry;
use brdf_host::session::Session;
use brdf_sdk::Manifest;
use glsl_brdf::{Source, Translated, translate};
use problem::{file, refused};
use tokens::Chance;

/// What panicked last in the program's own code, and what did anywhere. Tests take their turns.
static OWN: Mutex<Option<String>> = Mutex::new(None);
static TURN: Mutex<()> = Mutex::new(());

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// All files of a folder whose names end so, in order.
fn seeds(folder: &str, ending: &str) -> Vec<Vec<u8>> {
    let entries = fs::read_dir(root().join(folder)).unwrap();
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.is_file() && path.to_string_lossy().ends_with(ending));
    paths.sort();
    assert!(!paths.is_empty(), "{folder}");
    paths.iter().map(|path| fs::read(path).unwrap()).collect()
}

/// Plugins as `plugin` reads them.
fn plugins() -> Vec<Vec<u8>> {
    let mut folders: Vec<PathBuf> = Vec::new();
    for outer in ["plugins/brdf", "tests/cases"] {
        let entries = fs::read_dir(root().join(outer)).unwrap();
        folders.extend(entries.map(|entry| entry.unwrap().path()));
    }
    folders.sort();
    let text = |folder: &PathBuf| {
        let manifest = fs::read_to_string(folder.join("plugin.toml")).ok()?;
        let mut files = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
        let wgsl = files.find(|file| file.extension().is_some_and(|ending| ending == "wgsl"))?;
        let text = manifest + "\n//---\n" + &fs::read_to_string(wgsl).ok()?;
        (text.len() < 12_000).then(|| text.into_bytes())
    };
    folders.iter().filter_map(text).collect()
}

/// Changes a file: a text by its tokens, too.
fn changed(seeds: &[Vec<u8>], chance: &mut Chance) -> Vec<u8> {
    const WORDS: [u32; 8] = [0, 1, 2, 0x7f, 0xffff, 0x7fff_ffff, 0x7f80_0000, u32::MAX];
    let mut bytes = seeds[chance.below(seeds.len())].clone();
    if let Ok(text) = std::str::from_utf8(&bytes)
        && chance.below(8) > 0
    {
        return tokens::edited(text, chance).into_bytes();
    }
    for _ in 0..=chance.below(3) {
        let at = chance.below(bytes.len().max(1));
        match chance.below(7) {
            _ if bytes.is_empty() => {}
            0 => bytes[at] ^= 1 << chance.below(8),
            1 => bytes[at] = [0, 1, 0x7f, 0x80, 0xff, b'\n', b' '][chance.below(7)],
            2 | 3 => {
                let word = WORDS[chance.below(WORDS.len())].to_le_bytes();
                bytes[at..].iter_mut().zip(word).for_each(|(byte, new)| *byte = new);
            }
            4 => bytes.truncate(at),
            5 => {
                let end = (at + 1 + chance.below(16)).min(bytes.len());
                let copy = bytes[at..end].to_vec();
                let to = chance.below(bytes.len());
                bytes.splice(to..to, copy);
            }
            _ => {
                let end = (at + 1 + chance.below(16)).min(bytes.len());
                bytes.drain(at..end);
            }
        }
    }
    bytes
}

/// Every seed as it is, then `rounds` changed ones.
fn hold(name: &str, seeds: &[Vec<u8>], rounds: u32, check: impl Fn(&[u8])) {
    let _turn = TURN.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    set_hook(Box::new(|panic| {
        // Others' decoders and compilers may panic where the program makes a sentence of it.
        let own = panic.location().is_none_or(|place| !place.file().contains("/registry/src/"));
        if own && let Ok(mut last) = OWN.lock() {
            *last = Some(panic.to_string());
        }
    }));
    let factor = std::env::var("BRDF_DAMAGE").map_or(1, |factor| factor.parse().unwrap());
    let mut finds: Vec<(String, PathBuf)> = Vec::new();
    for round in 0..seeds.len() as u32 + rounds * factor {
        let bytes = match seeds.get(round as usize) {
            Some(seed) => seed.clone(),
            None => changed(seeds, &mut Chance::new(round)),
        };
        let left = catch_unwind(AssertUnwindSafe(|| check(&bytes)));
        let own = OWN.lock().unwrap().take();
        let told = own.or_else(|| left.is_err().then(|| "a panic of another crate".to_owned()));
        let Some(told) = told else { continue };
        if finds.iter().all(|(known, _)| known.lines().next() != told.lines().next()) {
            let path = std::env::temp_dir().join(format!("brdf-damage-{name}-{round}"));
            fs::write(&path, &bytes).unwrap();
            finds.push((told, path));
        }
    }
    let _ = std::panic::take_hook();
    assert!(finds.is_empty(), "{finds:#?}");
}

#[test]
fn maps() {
    for (name, ending) in [("hdr", "hdr"), ("exr", "exr"), ("ptex", "ptx")] {
        let seeds = seeds(&format!("fuzz/seeds/{name}"), "");
        hold(name, &seeds, 400, |bytes| map::check(ending, bytes));
    }
}

#[test]
fn meshes() {
    for (name, ending) in [("obj", "obj"), ("gltf", "glb")] {
        let seeds = seeds(&format!("fuzz/seeds/{name}"), "");
        hold(name, &seeds, 400, |bytes| mesh::check(ending, bytes));
    }
}

#[test]
fn recipes() {
    hold("recipe", &seeds("envmaps", ".toml"), 400, |bytes| {
        let Ok(text) = std::str::from_utf8(bytes) else { return };
        let options = Options { width: Some(8), ..Options::default() };
        match from_recipe("fuzzed", "fuzzed.toml", text, &options) {
            Ok(map) => map::held(&map),
            Err(problem) => refused(&problem),
        }
    });
}

/// What is read is written back and read again as the same scene.
#[test]
fn scenes() {
    let registry = Registry::new(&[root().join("plugins")]);
    let folder = Path::new("/a folder that is not there");
    hold("scene", &seeds("fuzz/seeds/scene", ".toml"), 100, |bytes| {
        let Ok(text) = std::str::from_utf8(bytes) else { return };
        let session = match Session::parse(&registry, "scene.toml", text, folder) {
            Ok(session) => session,
            Err(problem) => return refused(&problem),
        };
        let written = session.to_toml();
        let read = Session::parse(&registry, "written.toml", &written, folder);
        let read = read.unwrap_or_else(|problem| panic!("{problem}\n{written}"));
        assert_eq!(session, read, "{written}");
    });
}

/// A manifest and its WGSL, as `plugin` reads them.
fn link_and_run(text: &str) {
    let brdf = match plugin::read(text) {
        Ok(brdf) => brdf,
        Err(problem) => return refused(&problem),
    };
    match link(&View::Eval { brdf: brdf.clone() }) {
        Ok(program) => rows::agree(&program, &brdf),
        Err(problem) => refused(&problem),
    }
}

#[test]
fn plugins_link_and_run_or_are_refused() {
    hold("wgsl", &plugins(), 100, |bytes| {
        if let Ok(text) = std::str::from_utf8(bytes) {
            link_and_run(text);
        }
    });
}

#[test]
fn what_is_translated_links_and_runs_or_is_refused() {
    let own = seeds("examples/brdf-explorer", ".brdf");
    hold("brdf", &[own, seeds("fuzz/seeds/explorer", ".brdf")].concat(), 200, |bytes| {
        let Ok(text) = std::str::from_utf8(bytes) else { return };
        match translate(Source { file: "fuzzed.brdf", text }, "fuzzed", None) {
            Err(problem) => refused(&problem),
            Ok(Translated { manifest, wgsl, .. }) => {
                assert!(Manifest::parse("plugin.toml", &manifest, "fuzzed").is_ok(), "{manifest}");
                link_and_run(&format!("{manifest}\n//---\n{wgsl}"));
            }
        }
    });
}
