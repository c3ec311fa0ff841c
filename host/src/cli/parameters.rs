//! The options that say what the parameters of BRDFs are, the same for every verb.

use brdf_sdk::table::suggestion;
use brdf_sdk::{Problem, Result};

use crate::plugin::Configured;

#[derive(Debug, Clone, Default, clap::Args)]
pub(super) struct Parameters {
    /// Start from a preset of the BRDF (see `brdf list`); --set changes it further
    #[arg(long, value_name = "NAME")]
    pub(super) preset: Option<String>,
    /// Set a parameter of the BRDF; of several, of each that has it
    #[arg(long, value_name = "KEY=VALUE", allow_hyphen_values = true)]
    pub(super) set: Vec<String>,
}

impl Parameters {
    /// Sets them for one BRDF.
    pub(super) fn apply(&self, brdf: &mut Configured) -> Result<()> {
        self.apply_each(&mut [brdf])
    }

    /// Sets them for several: each takes the preset and the parameters that it has. Without one that has them it is a
    /// problem.
    pub(super) fn apply_each(&self, brdfs: &mut [&mut Configured]) -> Result<()> {
        if let Some(name) = &self.preset {
            // All are asked before one is missed.
            let mut without = Vec::new();
            for brdf in brdfs.iter_mut() {
                if !brdf.set_preset_named(name) {
                    without.push(brdf.plugin.id.clone());
                }
            }
            if without.len() < brdfs.len() {
                without.iter().for_each(|id| eprintln!("note: {id} has no preset `{name}`"));
            } else {
                let presets = brdfs.iter().flat_map(|brdf| &brdf.plugin.manifest.presets);
                let cure = suggestion(name, presets.map(|preset| preset.name.as_str()));
                let what = format!("--preset {name}");
                return Err(Problem::new(what, "there is no such preset", cure));
            }
        }
        for assignment in &self.set {
            let alone = brdfs.len() == 1;
            let anyone = brdfs.iter().any(|brdf| has(brdf, assignment));
            for brdf in brdfs.iter_mut() {
                // What nobody has is said with the names that there are.
                if alone || !anyone || has(brdf, assignment) {
                    brdf.assign(std::slice::from_ref(assignment))?;
                }
            }
        }
        Ok(())
    }

    /// What of them a BRDF has, as words: the preset's name and the assignments.
    pub(super) fn of(&self, brdf: &Configured) -> Vec<String> {
        let manifest = &brdf.plugin.manifest;
        let preset = self.preset.iter().filter(|name| {
            let mut presets = manifest.presets.iter();
            presets.any(|preset| preset.name == **name)
        });
        preset.chain(self.set.iter().filter(|assignment| has(brdf, assignment))).cloned().collect()
    }

    /// Names of the parameters that they fix.
    pub(super) fn keys(&self, brdf: &Configured) -> Vec<String> {
        let presets = brdf.plugin.manifest.presets.iter();
        let preset = presets.filter(|preset| self.preset.as_ref() == Some(&preset.name));
        let of_preset = preset.flat_map(|preset| preset.values.iter().map(|(key, _)| key.clone()));
        let of_set = self.set.iter().map(|assignment| key_of(assignment).to_owned());
        let mut keys: Vec<String> = of_preset.chain(of_set).collect();
        keys.sort();
        keys.dedup();
        keys
    }
}

/// The parameter of an assignment.
pub(super) fn key_of(assignment: &str) -> &str {
    assignment.split('=').next().unwrap_or_default().trim()
}

/// Whether a plugin has the parameter of an assignment.
pub(super) fn has(configured: &Configured, assignment: &str) -> bool {
    configured.plugin.manifest.param(key_of(assignment)).is_some()
}
