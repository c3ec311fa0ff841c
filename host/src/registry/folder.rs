//! One plugin folder on disk.

use std::fs;
use std::io::ErrorKind;
use std::path::Path;

use brdf_sdk::manifest::MANIFEST_FILE;
use brdf_sdk::{Manifest, ParamType, ParamValue, Problem, Result};

use crate::native::Native;
use crate::plugin::Plugin;

/// No plugin text is larger; whatever is was not meant as one.
const MAX_BYTES: u64 = 1 << 20;

/// The names in a folder, sorted; none where it cannot be read.
pub(super) fn names(folder: &Path) -> Vec<String> {
    let Ok(entries) = fs::read_dir(folder) else { return Vec::new() };
    let mut names: Vec<String> =
        entries.flatten().filter_map(|entry| entry.file_name().into_string().ok()).collect();
    names.sort();
    names
}

/// Reads the plugin in a folder.
pub(super) fn read(folder: &Path, allow_native: bool) -> Result<Plugin> {
    let manifest_path = folder.join(MANIFEST_FILE);
    if !folder.is_dir() {
        return Err(Problem::new(
            folder.display().to_string(),
            "there is no such plugin folder",
            "name a folder that holds a plugin.toml; `brdf list` shows the plugins by name",
        ));
    }
    let id = folder_name(folder)?;
    let manifest_file = shown(&manifest_path);
    let mut manifest = Manifest::parse(&manifest_file, &read_text(&manifest_path)?, &id)?;
    from_folder(folder, &mut manifest);
    let wgsl_path = folder.join(&manifest.wgsl);
    let wgsl_file = shown(&wgsl_path);
    check_inside(folder, &wgsl_path, &wgsl_file)?;
    let source = read_text(&wgsl_path)?;
    if source.trim().is_empty() {
        return Err(Problem::new(
            wgsl_file,
            "the file is empty",
            "write the plugin's functions into it",
        ));
    }
    let native = manifest.library.as_ref().map(|name| Native {
        name: name.clone(),
        folder: Some(folder.to_owned()),
        allowed: allow_native,
    });
    let source = source.into();
    Ok(Plugin { id, manifest, wgsl_file, source, tables: Default::default(), native })
}

/// Files that a manifest names lie beside it.
fn from_folder(folder: &Path, manifest: &mut Manifest) {
    for param in &mut manifest.params {
        if let ParamType::File { default: Some(path), .. } = &mut param.ty {
            *path = shown(&folder.join(&*path));
        }
    }
    for (_, value) in manifest.presets.iter_mut().flat_map(|preset| &mut preset.values) {
        if let ParamValue::File(path) = value {
            *path = shown(&folder.join(&*path));
        }
    }
}

/// Reads a text file that a person wrote.
pub(super) fn read_text(path: &Path) -> Result<String> {
    let problem = |reason: &str, cure: &str| Problem::new(shown(path), reason, cure);
    let size = fs::metadata(path).map(|metadata| metadata.len());
    if size.is_ok_and(|size| size > MAX_BYTES) {
        return Err(problem("the file is larger than 1 MiB", "keep plugins and recipes short"));
    }
    fs::read(path)
        .map_err(|error| match error.kind() {
            ErrorKind::NotFound => {
                problem("the file does not exist", "create it, or name the right one")
            }
            _ => problem(&format!("the file cannot be read ({error})"), "check its permissions"),
        })
        .and_then(|bytes| {
            String::from_utf8(bytes)
                .map_err(|_| problem("the file is not UTF-8 text", "save it as UTF-8"))
        })
        // Some editors begin UTF-8 with a byte order mark, which is no part of the text.
        .map(|text| text.strip_prefix('\u{feff}').map(str::to_owned).unwrap_or(text))
}

/// Reads a text file of the time before UTF-8: bytes that are none are taken for Latin-1.
pub(super) fn read_old_text(path: &Path) -> Result<String> {
    read_text(path).or_else(|problem| match fs::read(path) {
        Ok(bytes) if bytes.len() as u64 <= MAX_BYTES && std::str::from_utf8(&bytes).is_err() => {
            Ok(bytes.into_iter().map(char::from).collect())
        }
        _ => Err(problem),
    })
}

/// The folder's own name, also for `.` and for paths that end in `..`.
fn folder_name(folder: &Path) -> Result<String> {
    let resolved = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
    resolved.file_name().and_then(|name| name.to_str()).map(str::to_owned).ok_or_else(|| {
        Problem::new(folder.display().to_string(), "the folder has no name in UTF-8", "rename it")
    })
}

/// Links may not lead out of the folder either.
fn check_inside(folder: &Path, file: &Path, shown_file: &str) -> Result<()> {
    if let (Ok(folder), Ok(file)) = (folder.canonicalize(), file.canonicalize())
        && !file.starts_with(folder)
    {
        return Err(Problem::new(
            shown_file,
            "the file is a link that leaves the plugin's folder",
            "put the file itself into the folder",
        ));
    }
    Ok(())
}

pub(super) fn shown(path: &Path) -> String {
    path.display().to_string().replace('\\', "/")
}
