//! `brdf new`: a plugin folder that works as it stands.

use std::path::Path;

use brdf_sdk::manifest::MANIFEST_FILE;
use brdf_sdk::{Kind, Result};

use super::print;
use crate::template::{self, Texts, path_of};

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
    let (kind, next) = match arguments.kind {
        Template::Brdf => (
            Kind::Brdf,
            format!(
                "see it with `brdf view {0}`, prove it with `brdf conform {0}`",
                path_of(folder)
            ),
        ),
        Template::Integrator => (
            Kind::Integrator,
            format!("see it with `brdf render --rendering {} --watch`", path_of(folder)),
        ),
    };
    template::make(&Texts::template(kind, folder), folder)?;
    let id = template::id_of(folder);
    print(&format!("made {0}/{MANIFEST_FILE} and {0}/{id}.wgsl; {next}\n", folder.display()))
}
