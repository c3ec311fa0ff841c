//! A plugin as read from its folder, manifest and WGSL text, and with a value for each of its parameters.
//!
//! Nothing is read, linked or loaded here.

use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

use brdf_sdk::manifest::Preset;
use brdf_sdk::{Manifest, Param, ParamType, ParamValue, ParamValues, Result};

use crate::native::Native;

/// A plugin's manifest and source, with the names that messages give its files.
#[derive(Debug, Clone, PartialEq)]
pub struct Plugin {
    /// Its folder's name: its id on the command line and in sessions.
    pub id: String,
    /// The parsed manifest.
    pub manifest: Manifest,
    /// The WGSL file's name in messages.
    pub wgsl_file: String,
    /// The WGSL text.
    pub source: Arc<str>,
    /// The entries of its tables, as far as they are filled.
    pub tables: Filled,
    /// What fills its arrays, where it has any.
    pub native: Option<Native>,
}

/// Entries of tables, for each choice of a plugin's switches that they were filled for. What is known is no
/// part of what the plugin is: a copy begins anew, and all are equal.
#[derive(Debug, Default)]
pub struct Filled(Mutex<Vec<Entries>>);

/// Switches and choices, and the entries of all tables there, as bits.
type Entries = (Vec<(String, ParamValue)>, Arc<[u32]>);

impl Filled {
    /// The entries for these constants; they are filled by `fill` where they are not known.
    pub fn at<E>(
        &self,
        constants: &[(&str, &ParamValue)],
        fill: impl FnOnce() -> std::result::Result<Vec<u32>, E>,
    ) -> std::result::Result<Arc<[u32]>, E> {
        let mut held = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let same = |known: &[(String, ParamValue)]| {
            let known = known.iter().map(|(key, value)| (key.as_str(), value));
            known.eq(constants.iter().copied())
        };
        if let Some((_, entries)) = held.iter().find(|(known, _)| same(known)) {
            return Ok(Arc::clone(entries));
        }
        let entries: Arc<[u32]> = fill()?.into();
        let own = constants.iter().map(|(key, value)| ((*key).to_owned(), (*value).clone()));
        held.push((own.collect(), Arc::clone(&entries)));
        Ok(entries)
    }
}

impl Clone for Filled {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl PartialEq for Filled {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

/// Whether a path names the same file as a default does, however it is written.
fn same_file(path: &str, default: &ParamValue) -> bool {
    let ParamValue::File(default) = default else { return false };
    let full = |path: &str| Path::new(path).canonicalize().ok();
    path == default || full(path).is_some_and(|path| Some(path) == full(default))
}

/// A plugin with a value for each of its parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Configured {
    /// The plugin.
    pub plugin: Arc<Plugin>,
    /// A value for each parameter.
    pub values: ParamValues,
    /// Whether a sampler is fitted to its values where it is a BRDF without `sample` and `pdf`.
    pub fit_sampler: bool,
}

impl Configured {
    /// The plugin with its defaults.
    pub fn new(plugin: Arc<Plugin>) -> Self {
        Self { values: ParamValues::defaults(&plugin.manifest), plugin, fit_sampler: false }
    }

    /// The data file of somebody's that it shows; none where it shows what its manifest names.
    pub fn data_file(&self) -> Option<&Path> {
        let own = |param: &Param| match self.values.get(&param.key)? {
            ParamValue::File(path) if !same_file(path, &ParamValue::default_of(param)) => {
                Some(Path::new(path))
            }
            _ => None,
        };
        self.plugin.manifest.files().find_map(own)
    }

    /// Takes values as the command line writes them, `key=value` each.
    ///
    /// # Errors
    /// Where one is no parameter or no value of it; then none is taken.
    pub fn assign(&mut self, assignments: &[String]) -> Result<()> {
        let mut values = self.values.clone();
        for assignment in assignments {
            values.set_text(&self.plugin.manifest, assignment)?;
        }
        self.values = values;
        Ok(())
    }

    /// Takes the values of the preset of that name; false where there is none.
    pub fn set_preset_named(&mut self, name: &str) -> bool {
        let plugin = Arc::clone(&self.plugin);
        let preset = plugin.manifest.presets.iter().find(|preset| preset.name == name);
        preset.inspect(|preset| self.set_preset(preset)).is_some()
    }

    /// Takes the values of a preset; what it does not set stays.
    pub fn set_preset(&mut self, preset: &Preset) {
        preset.values.iter().for_each(|(key, value)| self.values.set(key, value.clone()));
    }

    /// The values that differ from the manifest's defaults.
    pub fn changed(&self) -> impl Iterator<Item = (&str, &ParamValue)> {
        let manifest = &self.plugin.manifest;
        let usual = |key| manifest.param(key).map(ParamValue::default_of);
        self.values.iter().filter(move |(key, value)| usual(key).as_ref() != Some(value))
    }

    /// Takes the values of another form of the plugin by their names, as far as they fit: what this form does not have or
    /// allow stays as it is. They go by way of their text, so that a number fits whatever kind of number it is now.
    pub fn take<'a>(&mut self, values: impl Iterator<Item = (&'a str, &'a ParamValue)>) {
        for (key, value) in values {
            let _ = self.values.set_text(&self.plugin.manifest, &format!("{key}={value}"));
        }
    }

    /// It with one of its switches and choices changed, for each of their other values, and which one: each is a program
    /// of its own.
    pub fn switched(&self) -> impl Iterator<Item = (&Param, Self)> {
        let options = |param: &Param| -> Vec<ParamValue> {
            match &param.ty {
                ParamType::Bool { .. } => [false, true].map(ParamValue::Bool).into(),
                ParamType::Choice { options, .. } => {
                    options.iter().cloned().map(ParamValue::Choice).collect()
                }
                _ => Vec::new(),
            }
        };
        self.plugin.manifest.params.iter().flat_map(move |param| {
            let others = options(param).into_iter();
            let others = others.filter(|option| self.values.get(&param.key) != Some(option));
            others.map(move |option| {
                let mut other = self.clone();
                other.values.set(&param.key, option);
                (param, other)
            })
        })
    }

    /// Values that become module constants: whoever changes one needs another program.
    pub fn constants(&self) -> Vec<(&str, &ParamValue)> {
        let param = |key| self.plugin.manifest.param(key);
        let is_constant = |key| param(key).is_some_and(|p: &Param| !p.constant_names().is_empty());
        self.values.iter().filter(|(key, _)| is_constant(key)).collect()
    }
}
