//! A plugin as read from its folder: manifest and WGSL text. No files are touched here.

use std::sync::{Arc, OnceLock};

use brdf_sdk::{Manifest, ParamValue, ParamValues};

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
    /// The entries of its tables, once they are filled.
    pub tables: OnceLock<Arc<[f32]>>,
}

/// A plugin with a value for each of its parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Configured {
    /// The plugin.
    pub plugin: Arc<Plugin>,
    /// A value for each parameter.
    pub values: ParamValues,
}

impl Configured {
    /// The plugin with its defaults.
    pub fn new(plugin: Arc<Plugin>) -> Self {
        Self { values: ParamValues::defaults(&plugin.manifest), plugin }
    }

    /// Values that become module constants: whoever changes one needs another program.
    pub fn constants(&self) -> Vec<(&str, &ParamValue)> {
        let is_constant =
            |value: &ParamValue| matches!(value, ParamValue::Bool(_) | ParamValue::Choice(_));
        self.values.iter().filter(|(_, value)| is_constant(value)).collect()
    }
}
