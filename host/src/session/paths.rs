//! Names and paths in scenes: which is which, from where a path is seen, and how it is written to be found again.

use std::path::Path;

/// A path as seen from the scene's folder; plain names, such as `ggx` or `studio`, stay as they are.
pub fn from_folder(folder: &Path, name: String) -> String {
    match is_path(&name) {
        true => folder.join(&name).display().to_string(),
        false => name,
    }
}

/// Whether it names a file or a folder, and not a plugin, a recipe or a shape of the program.
fn is_path(name: &str) -> bool {
    name.contains(['/', '\\', '.'])
}

/// A path in full where it is there.
pub fn full_path(path: &Path) -> String {
    path.canonicalize().unwrap_or_else(|_| path.to_owned()).display().to_string()
}

/// An existing path in full, so that it is found from any folder, and six files by their folder; names stay as
/// they are.
pub fn absolute(name: &str) -> String {
    let path = Path::new(name);
    if let (Some(folder), Some(file)) = (path.parent(), path.file_name())
        && file.to_string_lossy().contains('%')
        && !path.exists()
    {
        let here = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        return here.canonicalize().map_or(name.to_owned(), |f| f.join(file).display().to_string());
    }
    match path.canonicalize() {
        Ok(path) if is_path(name) => path.display().to_string(),
        _ => name.to_owned(),
    }
}
