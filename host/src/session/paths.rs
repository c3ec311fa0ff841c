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

/// The same, but what lies in `folder`, or in a folder of it, is named from there: they can be moved together.
pub fn seen_from(folder: &Path, name: &str) -> String {
    let full = absolute(name);
    let here = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    match here.canonicalize().map(|here| Path::new(&full).strip_prefix(here).map(Path::to_owned)) {
        Ok(Ok(inside)) => {
            let names = inside.iter().map(|name| name.to_string_lossy());
            format!("./{}", names.collect::<Vec<_>>().join("/"))
        }
        _ => full,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_lies_beside_a_scene_moves_with_it() {
        let folder = tempfile::tempdir().unwrap();
        let [old, new] = ["old", "new"].map(|name| folder.path().join(name));
        std::fs::create_dir_all(old.join("maps")).unwrap();
        for file in ["maps/a.hdr", "velvet", "maps/px.hdr"] {
            std::fs::write(old.join(file), "").unwrap();
        }
        let outside = folder.path().join("outside.obj");
        std::fs::write(&outside, "").unwrap();
        let old_name = |file: &str| old.join(file).display().to_string();
        let names = ["maps/a.hdr", "velvet", "maps/p%.hdr"].map(old_name);
        let written = names.map(|name| seen_from(&old, &name));
        assert_eq!(written, ["./maps/a.hdr", "./velvet", "./maps/p%.hdr"]);
        assert_eq!(seen_from(&old, &outside.display().to_string()), full_path(&outside));
        assert_eq!(seen_from(&old, "studio"), "studio");
        std::fs::rename(&old, &new).unwrap();
        let found = written.map(|name| from_folder(&new, name));
        assert!(Path::new(&found[0]).exists() && Path::new(&found[1]).exists(), "{found:?}");
        assert_eq!(found[2], new.join("./maps/p%.hdr").display().to_string());
    }
}
