//! `brdf trust`: which native libraries from outside of the program may run.

use std::path::{Path, PathBuf};

use brdf_sdk::manifest::MANIFEST_FILE;
use brdf_sdk::{Manifest, Problem, Result};

use super::print;
use crate::file;
use crate::native::{file_name, trust};

#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// Folders of plugins, or libraries; none lists what is trusted
    #[arg(value_name = "FOLDER")]
    trusted: Vec<PathBuf>,
    /// Trust them no longer
    #[arg(long, requires = "trusted")]
    forget: bool,
}

pub(super) fn run(arguments: &Arguments) -> Result<()> {
    if arguments.trusted.is_empty() {
        let mut text = format!("{}\n", trust::file()?.display());
        for entry in trust::entries()? {
            text.push_str(&format!("  {}\n    sha256 {}\n", entry.path, entry.sha256));
        }
        return print(&text);
    }
    let libraries =
        arguments.trusted.iter().map(|path| library(path)).collect::<Result<Vec<_>>>()?;
    // What is gone can still be forgotten.
    if let Some(absent) = libraries.iter().find(|file| !arguments.forget && !file.is_file()) {
        return Err(Problem::new(
            absent.display().to_string(),
            "there is no such library",
            "build it first, or name the folder of the plugin that it belongs to",
        ));
    }
    for library in libraries {
        if arguments.forget {
            let known = trust::remove(&library)?;
            let word = if known { "trusted no longer" } else { "was not trusted" };
            print(&format!("{}: {word}\n", library.display()))?;
        } else {
            let entry = trust::add(&library)?;
            print(&format!("trusted: {}\n  sha256 {}\n", entry.path, entry.sha256))?;
        }
    }
    Ok(())
}

/// The library of a plugin's folder, or the file itself. Nothing is opened.
fn library(path: &Path) -> Result<PathBuf> {
    let shown = path.display().to_string();
    let file = if path.is_dir() {
        let manifest = path.join(MANIFEST_FILE);
        let text = file::read_text(&manifest, "name a plugin's folder")?;
        let manifest = Manifest::parse(&manifest.display().to_string(), &text, "plugin")?;
        let name = manifest.library.ok_or_else(|| {
            Problem::new(
                &shown,
                "this plugin has no native library",
                "it needs no trust: just use it",
            )
        })?;
        path.join(file_name(&name))
    } else {
        path.to_owned()
    };
    Ok(file)
}
