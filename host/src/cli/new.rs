//! `brdf new`: a plugin folder that works as it stands.

use std::fs;
use std::path::Path;

use brdf_sdk::manifest::MANIFEST_FILE;
use brdf_sdk::{Problem, Result};

use super::print;

#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// What to make
    kind: Template,
    /// The folder to make; its last part names the plugin
    name: String,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Template {
    Brdf,
    Integrator,
}

pub(super) fn run(arguments: &Arguments) -> Result<()> {
    let folder = Path::new(&arguments.name);
    let problem = |reason: String, cure: &str| Problem::new(&arguments.name, reason, cure);
    let id = folder.file_name().and_then(|name| name.to_str()).unwrap_or_default();
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
    let (manifest, wgsl, next) = match arguments.kind {
        Template::Brdf => (
            include_str!("templates/brdf.toml"),
            include_str!("templates/brdf.wgsl"),
            format!(
                "see it with `brdf render {0} --watch`, prove it with `brdf conform {0}`",
                shown(folder)
            ),
        ),
        Template::Integrator => (
            include_str!("templates/integrator.toml"),
            include_str!("templates/integrator.wgsl"),
            format!("see it with `brdf render --rendering {} --watch`", shown(folder)),
        ),
    };
    let title = title_of(id);
    let write = |file: &Path, text: &str| fs::write(file, text.replace("@TITLE@", &title));
    fs::create_dir_all(folder)
        .and_then(|()| write(&folder.join(MANIFEST_FILE), manifest))
        .and_then(|()| write(&folder.join(format!("{id}.wgsl")), wgsl))
        .map_err(|error| problem(error.to_string(), "name a folder that you may write to"))?;
    print(&format!("made {0}/{MANIFEST_FILE} and {0}/{id}.wgsl; {next}\n", folder.display()))
}

/// A path that the other verbs take for a folder and not for a name.
fn shown(folder: &Path) -> String {
    let text = folder.display().to_string();
    if folder.components().count() > 1 { text } else { format!("./{text}") }
}

fn title_of(id: &str) -> String {
    let words = id.split('-').map(|word| {
        let mut letters = word.chars();
        letters.next().map(|first| first.to_ascii_uppercase().to_string() + letters.as_str())
    });
    words.flatten().collect::<Vec<_>>().join(" ")
}
