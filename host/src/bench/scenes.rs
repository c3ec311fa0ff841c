//! Scenes of files and folders, as cases.

use std::path::{Path, PathBuf};

use brdf_sdk::{Problem, Result};

use super::Case;
use crate::file;
use crate::open;
use crate::registry::Registry;

/// The scenes of files, and of a folder and all folders in it that hold a `scene.toml`; each is called as its folder is, or
/// as its file.
///
/// # Errors
/// Where there is none, or one of them cannot be read.
pub fn scenes(registry: &Registry, paths: &[PathBuf]) -> Result<Vec<Case>> {
    const SCENE: &str = "scene.toml";
    let mut cases = Vec::new();
    let name = |path: &Path| {
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned());
        name.unwrap_or_else(|| path.display().to_string())
    };
    for path in paths {
        if !path.is_dir() {
            let stem = path.with_extension("");
            cases.push(case(registry, name(&stem), path)?);
            continue;
        }
        let shown = path.display().to_string();
        let entries = std::fs::read_dir(path).map_err(|error| {
            let reason = format!("it cannot be read ({})", file::why(&error));
            Problem::new(&shown, reason, "check the path")
        })?;
        let mut folders: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
        folders.push(path.clone());
        folders.retain(|folder| folder.join(SCENE).is_file());
        folders.sort();
        if folders.is_empty() {
            return Err(Problem::new(
                shown,
                "neither it nor a folder in it holds a scene.toml",
                "name a scene, or a folder of such",
            ));
        }
        for folder in folders {
            cases.push(case(registry, name(&folder), &folder.join(SCENE))?);
        }
    }
    Ok(cases)
}

/// A scene's file; what it is about stands in the comment that it begins with.
fn case(registry: &Registry, name: String, path: &Path) -> Result<Case> {
    let scene = open::session(registry, path)?;
    let text = std::fs::read_to_string(path).unwrap_or_default();
    let about = text.lines().map_while(|line| line.strip_prefix('#')).map(str::trim);
    Ok(Case { name, about: about.collect::<Vec<_>>().join(" "), scene })
}
