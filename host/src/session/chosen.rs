//! A plugin that was chosen, with a value for each of its parameters.

use std::path::{Path, PathBuf};

use brdf_sdk::{Kind, ParamValue, Problem, Result};

use super::paths::full_path;
use crate::native::{self, Native};
use crate::plugin::Configured;
use crate::registry::{Found, Origin, Registry, explorer};

/// A plugin, the name it was asked for by, and its parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Chosen {
    /// Its name where the program's own plugin is meant, else the path of its folder: what finds it
    /// again from any folder.
    pub reference: String,
    /// The folder on disk that it was read from, if any.
    pub folder: Option<PathBuf>,
    /// The plugin with a value for each parameter.
    pub configured: Configured,
}

impl Chosen {
    /// Looks a plugin up by its name or the path of its folder; a BRDF also by a data file that it opens.
    pub fn find(registry: &Registry, kind: Kind, reference: &str) -> Result<Self> {
        let found = registry.find(kind, reference);
        if kind == Kind::Brdf && explorer::is_file(Path::new(reference)) {
            return Self::of(registry, found?);
        }
        // A file that is called like a plugin does not hide it.
        if found.is_err() && kind == Kind::Brdf && Path::new(reference).is_file() {
            let (found, key) = registry.opener(Path::new(reference))?;
            let mut chosen = Self::of(registry, found)?;
            chosen.configured.values.set(&key, ParamValue::File(reference.to_owned()));
            return Ok(chosen);
        }
        let is_data = kind == Kind::Brdf && Path::new(reference).extension().is_some();
        if found.is_err() && is_data && !Path::new(reference).exists() {
            return Err(Problem::new(
                reference,
                "there is no such file",
                "name one that is there, or a plugin; `brdf list` shows the plugins by name",
            ));
        }
        Self::of(registry, found?)
    }

    /// The integrator that draws from the BRDF: of scenes that name none, of albedos, of quick pictures.
    pub fn by_samples(registry: &Registry) -> Result<Self> {
        Self::find(registry, Kind::Integrator, "brdf-is")
    }

    /// What its pictures are called: the data file that it shows, else the plugin.
    pub fn name(&self) -> &str {
        let file = self.configured.data_file().and_then(|file| file.file_stem()?.to_str());
        file.unwrap_or(&self.configured.plugin.id)
    }

    fn of(registry: &Registry, found: Found) -> Result<Self> {
        let folder = match found.origin {
            Origin::Disk(path) => Some(path),
            Origin::Embedded => None,
        };
        let configured = Configured::new(found.plugin?);
        let reference = match &folder {
            Some(folder) if !registry.is_embedded(&configured.plugin) => full_path(folder),
            _ => configured.plugin.id.clone(),
        };
        Ok(Self { reference, folder, configured })
    }

    /// The files that it reads beside its folder: data, its own library, and the model that a file of values is for.
    pub fn files(&self) -> Vec<PathBuf> {
        let Configured { plugin, values, .. } = &self.configured;
        let mut files = native::files(&plugin.manifest, values);
        files.extend(plugin.native.as_ref().and_then(Native::own_file));
        if self.folder.as_deref().is_some_and(explorer::is_file) {
            files.push(PathBuf::from(&plugin.wgsl_file));
        }
        files
    }

    /// Reads the plugin again from where it came from; parameters are kept by name where they still fit.
    pub fn reload(&self, registry: &Registry) -> Result<Self> {
        let reference = match &self.folder {
            Some(folder) => folder.display().to_string(),
            None => self.reference.clone(),
        };
        let kind = self.configured.plugin.manifest.kind;
        let mut fresh = Self::find(registry, kind, &reference)?;
        fresh.configured.fit_sampler = self.configured.fit_sampler;
        // What nobody set follows the manifest, and what it no longer allows gives way to the new default.
        fresh.configured.take(self.configured.changed());
        Ok(fresh)
    }
}
