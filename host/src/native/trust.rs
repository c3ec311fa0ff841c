//! Which native libraries from outside of the program may run: those in the user's trust file, by path and
//! content.

use std::fs;
use std::path::{Path, PathBuf};

use brdf_sdk::manifest::check_format;
use brdf_sdk::table::Document;
use brdf_sdk::{Problem, Result};

use super::library::{self, hexadecimal};

/// An entry of the trust file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Entry {
    /// The library's file, in full.
    pub path: String,
    /// The SHA-256 of its content.
    pub sha256: String,
}

/// The user's trust file.
///
/// # Errors
/// The system names no home.
pub fn file() -> Result<PathBuf> {
    use etcetera::BaseStrategy;
    let strategy = etcetera::choose_base_strategy().map_err(|error| {
        Problem::new("the trust file", error.to_string(), "set HOME, or write --allow-native")
    })?;
    Ok(strategy.config_dir().join("brdf").join("trusted.toml"))
}

/// What is trusted; nothing where there is no file.
///
/// # Errors
/// A file that cannot be read or understood.
pub fn entries() -> Result<Vec<Entry>> {
    let file = file()?;
    let shown = file.display().to_string();
    let source = match fs::read_to_string(&file) {
        Ok(source) => source,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(Vec::new()),
        Err(error) => {
            return Err(Problem::new(shown, error.to_string(), "mend or remove the file"));
        }
    };
    Document { file: &shown, source: &source }.read(|table| {
        check_format(table)?;
        let Some(list) = table.get("library") else { return Ok(Vec::new()) };
        let mut entries = Vec::new();
        for item in list.items()? {
            let entry = item.table()?;
            let text =
                |key: &str| entry.require(key, "`path = \"...\"` and `sha256 = \"...\"`")?.string();
            entries.push(Entry { path: text("path")?, sha256: text("sha256")?.to_lowercase() });
            entry.finish()?;
        }
        Ok(entries)
    })
}

/// Refuses a library that nobody trusts.
pub(super) fn check(file: &Path, hash: [u8; 32]) -> Result<()> {
    let path = full(file);
    let sha256 = hexadecimal(hash);
    let entries = entries()?;
    if entries.iter().any(|entry| entry.path == path && entry.sha256 == sha256) {
        return Ok(());
    }
    let changed = entries.iter().any(|entry| entry.path == path);
    let reason = match changed {
        true => "this native library has changed since it was trusted",
        false => "this is native code from outside of the program, and may do whatever you may",
    };
    Err(Problem::new(
        path,
        reason,
        "if you know where it comes from, write --allow-native for once, or `brdf trust` with the plugin's \
         folder for good",
    ))
}

/// Trusts a library as it is now; an older entry of the same path goes. Returns the entry.
///
/// # Errors
/// A library or a trust file that cannot be read or written.
pub fn add(library: &Path) -> Result<Entry> {
    let entry = Entry { path: full(library), sha256: hexadecimal(library::hash(library)?) };
    let mut entries = entries()?;
    entries.retain(|known| known.path != entry.path);
    entries.push(entry.clone());
    write(&entries)?;
    Ok(entry)
}

/// Trusts a library no longer; false where it was not.
///
/// # Errors
/// A trust file that cannot be read or written.
pub fn remove(library: &Path) -> Result<bool> {
    let path = full(library);
    let mut entries = entries()?;
    let before = entries.len();
    entries.retain(|known| known.path != path);
    if entries.len() != before {
        write(&entries)?;
    }
    Ok(entries.len() != before)
}

fn write(entries: &[Entry]) -> Result<()> {
    let file = file()?;
    let mut text = String::from("format = 1\n");
    for Entry { path, sha256 } in entries {
        let path = toml::Value::String(path.clone());
        text.push_str(&format!("\n[[library]]\npath = {path}\nsha256 = \"{sha256}\"\n"));
    }
    let folder = file.parent().unwrap_or(Path::new("."));
    let written = fs::create_dir_all(folder).and_then(|()| {
        // Whole or not at all: what was trusted before stays.
        let staged = tempfile::NamedTempFile::new_in(folder)?;
        fs::write(staged.path(), &text)?;
        staged.persist(&file).map_err(|error| error.error)?;
        Ok(())
    });
    written.map_err(|error| {
        Problem::new(
            file.display().to_string(),
            error.to_string(),
            "check its folder's permissions",
        )
    })
}

/// The path in full, also of a file that is gone from a folder that is not.
fn full(file: &Path) -> String {
    let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty());
    let beside = folder.unwrap_or(Path::new(".")).canonicalize();
    let found =
        file.canonicalize().or_else(|_| Ok(beside?.join(file.file_name().unwrap_or_default())));
    found.unwrap_or_else(|_: std::io::Error| file.to_owned()).display().to_string()
}
