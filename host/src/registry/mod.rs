//! Finds plugins and recipes: in folders on disk first, then among those embedded in the binary.
//!
//! A plugin is `<root>/<kind>/<name>/plugin.toml` with its WGSL beside it; nothing else lists it.
//! The registry reads text and manifests; it links nothing and runs nothing.

pub mod explorer;
mod folder;
mod opener;
pub mod watch;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use brdf_sdk::manifest::MANIFEST_FILE;
use brdf_sdk::table::suggestion;
use brdf_sdk::{Kind, Manifest, Problem, Result};

use crate::native::Native;
use crate::plugin::Plugin;
use crate::template::Texts;

mod embedded {
    include!(concat!(env!("OUT_DIR"), "/embedded.rs"));
}

/// Where plugins and recipes are looked for, the first place that has a name wins.
#[derive(Debug, Clone)]
pub struct Registry {
    roots: Vec<PathBuf>,
    allow_native: bool,
}

/// A plugin that was found, readable or not.
#[derive(Debug, Clone)]
pub struct Found {
    /// Its folder's name.
    pub id: String,
    /// Where it was found.
    pub origin: Origin,
    /// The plugin, or why it cannot be used.
    pub plugin: Result<Arc<Plugin>>,
}

/// Where a plugin or a recipe comes from.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub enum Origin {
    /// A folder (or, for a recipe, a file) on disk.
    Disk(PathBuf),
    /// The binary itself.
    Embedded,
}

impl std::fmt::Display for Origin {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Origin::Disk(path) => write!(f, "{}", path.display()),
            Origin::Embedded => write!(f, "embedded"),
        }
    }
}

/// Files that the binary holds below a folder of the source tree, each with its path in there, by name.
pub fn embedded_below(folder: &str) -> impl Iterator<Item = (&'static str, &'static str)> {
    embedded::FILES.iter().filter_map(move |(path, text)| {
        let name = path.strip_prefix(folder)?.strip_prefix('/')?;
        Some((name, *text))
    })
}

impl Registry {
    /// Lets the native libraries of all plugins on disk run, also those that the user does not trust.
    pub fn allowing_native(self, allow_native: bool) -> Self {
        Self { allow_native, ..self }
    }

    /// Looks in `extra`, then in ./plugins, then in the user's data folder, then in the binary.
    pub fn new(extra: &[PathBuf]) -> Self {
        use etcetera::BaseStrategy;
        let mut roots = extra.to_vec();
        roots.push(PathBuf::from("plugins"));
        if let Ok(strategy) = etcetera::choose_base_strategy() {
            roots.push(strategy.data_dir().join("brdf").join("plugins"));
        }
        Self { roots, allow_native: false }
    }

    /// The folders that plugins are looked for in, as far as they are there.
    pub fn folders(&self) -> Vec<PathBuf> {
        self.roots.iter().filter(|root| root.is_dir()).cloned().collect()
    }

    /// All plugins of a kind, by name.
    pub fn all(&self, kind: Kind) -> Vec<Found> {
        let mut found: Vec<Found> = Vec::new();
        for root in &self.roots {
            let folder = root.join(kind.word());
            for id in folder::names(&folder) {
                let path = folder.join(&id);
                if path.join(MANIFEST_FILE).is_file() && !found.iter().any(|f| f.id == id) {
                    let plugin = folder::read(&path, self.allow_native).map(Arc::new);
                    found.push(Found { id, origin: Origin::Disk(path), plugin });
                }
            }
        }
        for id in embedded_ids(kind) {
            if !found.iter().any(|f| f.id == id) {
                let plugin = read_embedded(kind, &id).map(Arc::new);
                found.push(Found { id, origin: Origin::Embedded, plugin });
            }
        }
        found.sort_by(|a, b| a.id.cmp(&b.id));
        found
    }

    /// One plugin, by its name or by the path of its folder, which has a `/` in it or begins with a dot; or by a file of
    /// BRDF Explorer.
    pub fn find(&self, kind: Kind, name: &str) -> Result<Found> {
        let path = Path::new(name);
        if kind == Kind::Brdf && explorer::is_file(path) {
            let plugin = Arc::new(explorer::plugin(path)?);
            let id = plugin.id.clone();
            return Ok(Found { id, origin: Origin::Disk(path.to_owned()), plugin: Ok(plugin) });
        }
        if path.components().count() > 1 || name.starts_with('.') {
            let plugin = Arc::new(folder::read(path, self.allow_native)?);
            expect_kind(kind, name, &plugin.manifest)?;
            let id = plugin.id.clone();
            return Ok(Found { id, origin: Origin::Disk(path.to_owned()), plugin: Ok(plugin) });
        }
        let all = self.all(kind);
        match all.iter().find(|found| found.id == name) {
            Some(found) => {
                expect_kind(kind, name, &found.plugin.clone()?.manifest)?;
                Ok(found.clone())
            }
            None if path.is_dir() && !path.join(MANIFEST_FILE).is_file() => Err(Problem::new(
                name,
                format!("the folder of this name holds no {MANIFEST_FILE}"),
                "name the folder of a plugin, or a file by its path",
            )),
            None => {
                let cure = match path.join(MANIFEST_FILE).is_file() {
                    true => format!("write ./{name} for the folder that lies here"),
                    false => suggestion(name, all.iter().map(|found| found.id.as_str())),
                };
                Err(Problem::new(name, format!("there is no {} of this name", kind.word()), cure))
            }
        }
    }

    /// The BRDF that opens a data file, and the parameter that takes it: by what the file begins with, else by
    /// its ending.
    pub fn opener(&self, file: &Path) -> Result<(Found, String)> {
        opener::of(file, self.all(Kind::Brdf))
    }

    /// The texts of a plugin: of the folder it was read from, or of the binary.
    ///
    /// # Errors
    /// Where a file cannot be read any more, or the plugin has a library: its arrays come from there.
    pub fn texts(&self, kind: Kind, id: &str, folder: Option<&Path>) -> Result<Texts> {
        let (manifest, wgsl, plugin) = match folder {
            Some(file) if explorer::is_file(file) => {
                let read = explorer::read(file, explorer::Values::Defaults)?.translated;
                let wgsl = explorer::tidied(&read.wgsl);
                return Ok(Texts { manifest: read.manifest, wgsl });
            }
            Some(folder) => {
                let plugin = folder::read(folder, self.allow_native)?;
                let text = |name: &str| folder::read_text(&folder.join(name));
                (text(MANIFEST_FILE)?, text(&plugin.manifest.wgsl)?, plugin)
            }
            None => {
                let plugin = read_embedded(kind, id)?;
                let text = |name: &str| {
                    let path = format!("plugins/{}/{id}/{name}", kind.word());
                    embedded_text(&path).unwrap_or_default().to_owned()
                };
                (text(MANIFEST_FILE), text(&plugin.manifest.wgsl), plugin)
            }
        };
        if plugin.native.is_some() {
            return Err(Problem::new(
                id,
                "its arrays come from a native library, which is not copied",
                "begin with the template, or with examples/native-plugin",
            ));
        }
        Ok(Texts { manifest, wgsl })
    }

    /// Whether the binary itself holds this very plugin, word for word.
    pub fn is_embedded(&self, plugin: &Plugin) -> bool {
        read_embedded(plugin.manifest.kind, &plugin.id).is_ok_and(|embedded| {
            embedded.manifest == plugin.manifest && embedded.source == plugin.source
        })
    }

    /// The names of all environment recipes with their origin.
    pub fn recipes(&self) -> Vec<(String, Origin)> {
        let mut recipes: Vec<(String, Origin)> = Vec::new();
        for folder in self.recipe_folders() {
            for file in folder::names(&folder) {
                if let Some(id) = file.strip_suffix(".toml")
                    && !recipes.iter().any(|(known, _)| known == id)
                {
                    recipes.push((id.to_owned(), Origin::Disk(folder.join(&file))));
                }
            }
        }
        for (path, _) in embedded::FILES {
            if let Some(id) = path.strip_prefix("envmaps/").and_then(|p| p.strip_suffix(".toml"))
                && !recipes.iter().any(|(known, _)| known == id)
            {
                recipes.push((id.to_owned(), Origin::Embedded));
            }
        }
        recipes.sort();
        recipes
    }

    /// The file name and the text of a recipe.
    pub fn recipe(&self, name: &str) -> Option<Result<(String, String)>> {
        let (_, origin) = self.recipes().into_iter().find(|(id, _)| id == name)?;
        Some(match origin {
            Origin::Disk(path) => {
                folder::read_text(&path).map(|text| (path.display().to_string(), text))
            }
            Origin::Embedded => {
                let path = format!("envmaps/{name}.toml");
                let text = embedded_text(&path).unwrap_or_default();
                Ok((path, text.to_owned()))
            }
        })
    }

    /// `envmaps` beside each `plugins` folder.
    fn recipe_folders(&self) -> Vec<PathBuf> {
        self.roots.iter().map(|root| root.with_file_name("envmaps")).collect()
    }
}

fn expect_kind(kind: Kind, name: &str, manifest: &Manifest) -> Result<()> {
    if manifest.kind == kind {
        return Ok(());
    }
    Err(Problem::new(
        name,
        format!("this plugin is of kind `{}`", manifest.kind.word()),
        format!("name one of kind `{}` here", kind.word()),
    ))
}

fn embedded_ids(kind: Kind) -> Vec<String> {
    let prefix = format!("plugins/{}/", kind.word());
    let suffix = format!("/{MANIFEST_FILE}");
    let ids = embedded::FILES
        .iter()
        .filter_map(|(path, _)| path.strip_prefix(&prefix)?.strip_suffix(&suffix));
    ids.map(str::to_owned).collect()
}

fn embedded_text(path: &str) -> Option<&'static str> {
    embedded::FILES.iter().find(|(file, _)| *file == path).map(|(_, text)| *text)
}

fn read_embedded(kind: Kind, id: &str) -> Result<Plugin> {
    let folder = format!("plugins/{}/{id}", kind.word());
    let manifest_file = format!("{folder}/{MANIFEST_FILE}");
    let text = |file: &str| {
        embedded_text(file).ok_or_else(|| {
            Problem::new(file, "the file is not embedded in this binary", "build the program again")
        })
    };
    let manifest = Manifest::parse(&manifest_file, text(&manifest_file)?, id)?;
    let wgsl_file = format!("{folder}/{}", manifest.wgsl);
    let source = text(&wgsl_file)?.into();
    let native = manifest.library.as_ref().map(|name| Native {
        name: name.clone(),
        folder: None,
        allowed: false,
    });
    let id = id.to_owned();
    Ok(Plugin { id, manifest, wgsl_file, source, tables: Default::default(), native })
}
