//! Builds the crates of plugins that pages write, or bring from the examples, as their readers do.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Mutex;

use super::bring::{copy, copy_folder};
use super::common::{native, program, root};

/// `cargo build --release` of a plugin's crate, by a copy below the tree's own target folder, so that what it needs is
/// built once; the library comes back to where its manifest expects it.
pub fn build(folder: &Path) -> Result<(), String> {
    static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());
    let _guard = ONE_AT_A_TIME.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
    let work = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("book");
    let copied = work.join(folder.file_name().unwrap());
    let _ = fs::remove_dir_all(&copied);
    copy_folder(folder, &copied);
    let manifest =
        fs::read_to_string(copied.join("Cargo.toml")).map_err(|error| error.to_string())?;
    let mut manifest: toml::Table =
        manifest.parse().map_err(|error| format!("Cargo.toml: {error}"))?;
    // The path to the SDK is another one here, and the folder lies in a workspace.
    manifest["dependencies"]["brdf-sdk"]["path"] =
        root().join("brdf-sdk").display().to_string().into();
    manifest.entry("workspace").or_insert(toml::Table::new().into());
    let name = manifest["package"]["name"].as_str().unwrap_or_default().replace('-', "_");
    fs::write(copied.join("Cargo.toml"), manifest.to_string())
        .map_err(|error| error.to_string())?;
    let output = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
        .args(["build", "--release", "--offline", "--quiet"])
        .env("CARGO_TARGET_DIR", work.join("target"))
        .current_dir(&copied)
        .output()
        .map_err(|error| error.to_string())?;
    if !output.status.success() {
        return Err(program::text(&output.stderr));
    }
    let library = native::file_name(&name);
    let release = folder.join("target/release");
    fs::create_dir_all(&release).map_err(|error| error.to_string())?;
    copy(&work.join("target/release").join(&library), &release.join(library));
    Ok(())
}
