//! Native libraries: compiled code that turns files and parameters into arrays for a plugin's WGSL.
//!
//! Nothing is loaded by finding or listing a plugin: a library is opened when a program that reads its arrays
//! is about to run, and only where its origin allows (`trust`). A copy under a fresh name is opened, and it
//! stays open: what a newer build replaced may still be in use. What it gives is copied and given back at
//! once. It may name brdf-sdk and the libraries that are shipped, and nothing of the host.

mod call;
mod library;
mod packed;
mod shipped;
pub mod trust;

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::SystemTime;

use brdf_sdk::manifest::{Array, Lobes};
use brdf_sdk::native::{Request, Setting, lobes};
use brdf_sdk::{Manifest, ParamValue, ParamValues, Problem, Result};

use crate::file;
use crate::held::Held;
use library::Library;
pub use library::file_name;
pub use packed::{PART_WORDS, Packed, Place, TEXTURE_WIDTH, buffer_names, pack, texture_name};

/// What stands behind a manifest's `library`; nothing is opened yet.
#[derive(Debug, Clone, PartialEq)]
pub struct Native {
    /// The manifest's `library`.
    pub name: String,
    /// The plugin's folder, unless it is embedded in the program.
    pub folder: Option<PathBuf>,
    /// Whether any library may be run.
    pub allowed: bool,
}

impl Native {
    /// The library's file in the plugin's own folder, where there is one; libraries of the program's own lie
    /// elsewhere.
    pub fn own_file(&self) -> Option<PathBuf> {
        Some(self.folder.as_ref()?.join(file_name(&self.name)))
    }

    /// The arrays for these values, from memory where nothing has changed since they were made.
    ///
    /// # Errors
    /// A library that is not there, is not trusted or does not fit; a file that it cannot read; arrays that are
    /// not what the manifest says.
    pub fn arrays(
        &self,
        id: &str,
        manifest: &Manifest,
        values: &ParamValues,
    ) -> Result<Arc<Packed>> {
        let settings = settings(manifest, values);
        let library = self.open()?;
        let key = Key {
            library: library.id,
            entry: manifest.entry.clone(),
            stamps: stamps(manifest, values)?,
            settings,
            declared: manifest.arrays.clone(),
        };
        let load = |key: &Key| {
            let request = Request { entry: manifest.entry.clone(), settings: key.settings.clone() };
            let loaded = call::load(library.table, &request)
                .map_err(|said| told(&said, &thing(id, &key.settings)))?;
            let packed = pack(id, &manifest.arrays, loaded)?;
            check_lobes(id, manifest, &packed)?;
            Ok(Arc::new(packed))
        };
        let too_much = |held: &[(Key, Arc<Packed>)]| {
            let bytes: usize = held.iter().map(|(_, packed)| packed.bytes()).sum();
            held.len() > MOST_HELD || bytes > MOST_BYTES
        };
        HELD.get(key, |known, wanted| known == wanted, load, too_much)
    }

    /// The library of the plugin's own folder, else the program's own, else the one beside the program.
    fn open(&self) -> Result<Library> {
        let own = self.own_file();
        if let Some(file) = own.as_ref().filter(|file| file.is_file()) {
            return library::open(file, |hash| match self.allowed {
                true => Ok(()),
                false => trust::check(file, hash),
            });
        }
        if let Some(table) = shipped::table(&self.name) {
            return library::checked(table, &self.name);
        }
        if let Some(file) = beside_program(&self.name) {
            return library::open(&file, |_| Ok(()));
        }
        let looked = own.map_or_else(|| self.name.clone(), |file| file.display().to_string());
        Err(Problem::new(
            looked,
            "there is no such library, and none of its name beside the program",
            "build it (`cargo build --release` where its Cargo.toml lies), or mend `library` in plugin.toml",
        ))
    }
}

/// Tables with views around are of no use where the manifest says that there is one.
fn check_lobes(id: &str, manifest: &Manifest, packed: &Packed) -> Result<()> {
    let declared = manifest.arrays.iter().position(|array| array.name == lobes::NAMES[0]);
    let around = declared.map_or(1, |index| packed.places[index].shape[1]);
    match (manifest.lobes, around) {
        (Some(Lobes::Isotropic), 2..) => Err(Problem::new(
            id,
            format!(
                "its lobes have {around} views around, and plugin.toml says that they are isotropic"
            ),
            "write `lobes = \"anisotropic\"`, or give `phi_o: 1`",
        )),
        (Some(Lobes::Anisotropic), 1) => Err(Problem::new(
            id,
            "its lobes have one view around, and plugin.toml says that they are anisotropic",
            "write `lobes = \"isotropic\"`, or give several `phi_o`",
        )),
        _ => Ok(()),
    }
}

/// Arrays of recent loads: an edit of a plugin's WGSL shall not read its data again.
static HELD: Held<Key, Arc<Packed>> = Held::new();
const MOST_HELD: usize = 8;
/// Beside the newest.
const MOST_BYTES: usize = 1 << 30;

/// What arrays depend on.
#[derive(PartialEq)]
struct Key {
    library: [u8; 32],
    entry: String,
    settings: Vec<(String, Setting)>,
    stamps: Vec<(u64, Option<SystemTime>)>,
    declared: Vec<Array>,
}

fn settings(manifest: &Manifest, values: &ParamValues) -> Vec<(String, Setting)> {
    let value = |key: &String| match values.get(key)? {
        ParamValue::Float(number) => Some(Setting::Number(*number)),
        ParamValue::Int(number) => Some(Setting::Number(*number as f64)),
        ParamValue::Bool(on) => Some(Setting::Number(f64::from(u8::from(*on)))),
        ParamValue::Color(rgb) => Some(Setting::Color(*rgb)),
        ParamValue::Choice(text) | ParamValue::File(text) => Some(Setting::Text(text.clone())),
    };
    manifest.load.iter().filter_map(|key| Some((key.clone(), value(key)?))).collect()
}

/// The files that the library is handed.
pub fn files(manifest: &Manifest, values: &ParamValues) -> Vec<PathBuf> {
    let named = manifest.load.iter().filter_map(|key| match values.get(key)? {
        ParamValue::File(path) if !path.is_empty() => Some(PathBuf::from(path)),
        _ => None,
    });
    named.collect()
}

/// Size and time of each file; whoever writes it again changes one of them.
fn stamps(manifest: &Manifest, values: &ParamValues) -> Result<Vec<(u64, Option<SystemTime>)>> {
    let stamp = |path: PathBuf| {
        let known = fs::metadata(&path).map_err(|error| {
            let thing = path.display().to_string();
            match error.kind() {
                std::io::ErrorKind::NotFound => {
                    Problem::new(thing, "there is no such file", "name one that is there")
                }
                _ => Problem::new(thing, file::why(&error), "check its permissions"),
            }
        })?;
        if !known.is_file() {
            // A pipe would be waited for.
            let what = if known.is_dir() { "a folder" } else { "no regular file" };
            let thing = path.display().to_string();
            return Err(Problem::new(thing, format!("this is {what}"), "name a file"));
        }
        Ok((known.len(), known.modified().ok()))
    };
    files(manifest, values).into_iter().map(stamp).collect()
}

/// What a library's complaint is about: the file where it is handed one, else the plugin.
fn thing(id: &str, settings: &[(String, Setting)]) -> String {
    let mut texts = settings.iter().filter_map(|(_, setting)| match setting {
        Setting::Text(text) if Path::new(text).is_file() => Some(text),
        _ => None,
    });
    match (texts.next(), texts.next()) {
        (Some(file), None) => file.clone(),
        _ => id.to_owned(),
    }
}

/// A library's sentence as a problem: what stands behind the last semicolon is the cure.
fn told(said: &str, thing: &str) -> Problem {
    let line = said.split_whitespace().collect::<Vec<_>>().join(" ");
    match line.rsplit_once("; ") {
        Some((reason, cure)) => Problem::new(thing, reason, cure),
        None => Problem::new(thing, line, "give it what it asks for, or use another plugin"),
    }
}

/// A library of this name in the installed tree.
fn beside_program(name: &str) -> Option<PathBuf> {
    let program = std::env::current_exe().ok()?.canonicalize().ok()?;
    let folder = program.parent()?;
    let file = file_name(name);
    let places = [folder.join(&file), folder.join("../lib/brdf").join(&file)];
    places.into_iter().find(|place| place.is_file())
}
