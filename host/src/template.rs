//! New plugin folders that work as they stand: from a template, or from a plugin that there is.

use std::fs;
use std::path::Path;

use brdf_sdk::manifest::MANIFEST_FILE;
use brdf_sdk::{Kind, Problem, Result};

/// The texts of a plugin.
pub struct Texts {
    /// Its plugin.toml.
    pub manifest: String,
    /// Its WGSL.
    pub wgsl: String,
}

impl Texts {
    /// A template, with the title that a folder's name gives.
    pub fn template(kind: Kind, folder: &Path) -> Self {
        let (manifest, wgsl) = match kind {
            Kind::Brdf => {
                (include_str!("templates/brdf.toml"), include_str!("templates/brdf.wgsl"))
            }
            Kind::Integrator => (
                include_str!("templates/integrator.toml"),
                include_str!("templates/integrator.wgsl"),
            ),
        };
        let title = title_of(id_of(folder));
        let [manifest, wgsl] = [manifest, wgsl].map(|text| text.replace("@TITLE@", &title));
        Self { manifest, wgsl }
    }
}

/// Makes a plugin's folder, which must not exist; its last part names the plugin.
///
/// # Errors
/// A name that no plugin can have, a folder that exists or cannot be written.
pub fn make(texts: &Texts, folder: &Path) -> Result<()> {
    let problem =
        |reason: String, cure: &str| Problem::new(folder.display().to_string(), reason, cure);
    let id = id_of(folder);
    let well_formed = id.starts_with(|c: char| c.is_ascii_lowercase())
        && id.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-');
    if !well_formed {
        return Err(problem(
            format!("`{id}` cannot name a plugin"),
            "use lower-case letters, digits and `-`, beginning with a letter",
        ));
    }
    if folder.exists() {
        return Err(problem(
            "it exists already".to_owned(),
            "choose another name, or remove it first",
        ));
    }
    fs::create_dir_all(folder)
        .and_then(|()| fs::write(folder.join(MANIFEST_FILE), &texts.manifest))
        .and_then(|()| fs::write(folder.join(format!("{id}.wgsl")), &texts.wgsl))
        .map_err(|error| problem(error.to_string(), "name a folder that you may write to"))
}

/// A folder's path as the verbs take it for a folder and not for a name.
pub fn path_of(folder: &Path) -> String {
    let text = folder.display().to_string();
    if folder.components().count() > 1 { text } else { format!("./{text}") }
}

/// The id that a folder gives its plugin.
pub fn id_of(folder: &Path) -> &str {
    folder.file_name().and_then(|name| name.to_str()).unwrap_or_default()
}

fn title_of(id: &str) -> String {
    let words = id.split('-').map(|word| {
        let mut letters = word.chars();
        letters.next().map(|first| first.to_ascii_uppercase().to_string() + letters.as_str())
    });
    words.flatten().collect::<Vec<_>>().join(" ")
}
