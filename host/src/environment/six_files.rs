//! A cube from six picture files whose names differ in one word: `probe_%.hdr` is probe_px.hdr to probe_nz.hdr.

use std::path::{Path, PathBuf};

use brdf_sdk::{Problem, Result};

use super::{Arrangement, Picture};

/// What may stand for the `%`, each row in the order px nx py ny pz nz.
pub const NAMES: [[&str; 6]; 5] = [
    ["px", "nx", "py", "ny", "pz", "nz"],
    ["posx", "negx", "posy", "negy", "posz", "negz"],
    ["right", "left", "top", "bottom", "front", "back"],
    ["right", "left", "up", "down", "front", "back"],
    ["rt", "lf", "up", "dn", "ft", "bk"],
];

/// Whether a path names six files: it has a `%` and is no file itself.
pub fn is_named(path: &Path) -> bool {
    file_name(path).contains('%') && !path.exists()
}

/// The six files that are written for a path with a `%`: px to nz.
pub fn face_paths(path: &Path) -> [PathBuf; 6] {
    paths(path, NAMES[0])
}

/// The files that a name with a `%` may be read from; none for other names.
pub fn files_of(name: &str) -> Vec<PathBuf> {
    let path = Path::new(name);
    match is_named(path) {
        true => NAMES.into_iter().flat_map(|names| paths(path, names)).collect(),
        false => Vec::new(),
    }
}

/// The six paths with these words in place of the first `%`.
fn paths(path: &Path, names: [&str; 6]) -> [PathBuf; 6] {
    names.map(|word| path.with_file_name(file_name(path).replacen('%', word, 1)))
}

fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// Reads the six pictures into one column of faces.
pub fn read(name: &str, path: &Path, asked: Option<Arrangement>) -> Result<Picture> {
    if asked.is_some() {
        let cure = "leave out how it is to be read";
        return Err(Problem::new(name, "six files are always a cube of six faces", cure));
    }
    let mut column: Option<Picture> = None;
    let mut first = String::new();
    for path in found(name, path)? {
        let shown = path.display().to_string();
        let bytes = super::read(&path)?;
        let face = super::decode(&shown, &bytes).unwrap_or_else(|| {
            let cure = "give six Radiance or OpenEXR pictures";
            Err(Problem::new(&shown, super::unknown_content(&bytes), cure))
        })?;
        if face.width != face.height {
            return Err(Problem::new(
                shown,
                format!("the picture is {}x{}, and a face is a square", face.width, face.height),
                "give six square pictures of one size",
            ));
        }
        match &mut column {
            None => {
                first = shown;
                column = Some(face);
            }
            Some(column) if column.width != face.width => {
                return Err(Problem::new(
                    shown,
                    format!(
                        "the face is {0}x{0}, that of {first} is {1}x{1}",
                        face.width, column.width
                    ),
                    "give six square pictures of one size",
                ));
            }
            Some(column) => {
                column.height += face.height;
                column.texels.extend(face.texels);
                for note in face.notes {
                    if !column.notes.contains(&note) {
                        column.notes.push(note);
                    }
                }
            }
        }
    }
    column
        .map(|column| Picture { declared: None, ..column })
        .ok_or_else(|| Problem::new(name, "there are no faces", "name six files with a %"))
}

/// The first six that are all there, or a problem that names what is missing.
fn found(name: &str, path: &Path) -> Result<[PathBuf; 6]> {
    let mut most: (usize, Vec<String>) = (0, Vec::new());
    for names in NAMES {
        let paths = paths(path, names);
        let missing: Vec<String> =
            paths.iter().filter(|path| !path.is_file()).map(|path| file_name(path)).collect();
        if missing.is_empty() {
            return Ok(paths);
        }
        if 6 - missing.len() > most.0 {
            most = (6 - missing.len(), missing);
        }
    }
    let reason = match most.0 {
        0 => "there are no six files of this name".to_owned(),
        _ => format!("of its six files these are missing: {}", most.1.join(", ")),
    };
    Err(Problem::new(
        name,
        reason,
        "let % stand for px nx py ny pz nz, posx negx .., right left top bottom front back, or rt lf up dn ft bk",
    ))
}
