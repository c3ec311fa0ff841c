//! Pictures on disk: OpenEXR with linear radiance and the scene in its header, PNG for the eye, maps; and
//! charts for pages.
//!
//! Every file is written under a temporary name and renamed, so that no half file is ever left.

pub mod chart;
mod exr_file;
mod false_colour;
mod map_file;
mod png_file;
pub mod read;

use std::path::{Path, PathBuf};

use brdf_sdk::{Problem, Result};
use rayon::prelude::*;

pub use exr_file::{read_fact, read_scene, stage_exr};
pub use false_colour::{FalseColour, Scale, stage_false_colour};
pub use map_file::{MapFormat, stage_map};
pub use png_file::{Raster, stage_png};

use crate::render::Film;
use crate::scene::ShadingPoint;

/// The channels of a picture's standard error, beside `R`, `G`, `B` and `A`.
const STD_ERROR: [&str; 3] = ["std_error.R", "std_error.G", "std_error.B"];

/// A picture in linear Rec. 709 radiance, row by row from the top left.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// Width and height in pixels.
    pub resolution: [u32; 2],
    /// Radiance per pixel.
    pub rgb: Vec<[f32; 3]>,
    /// 1 where the object is, 0 where the background is.
    pub coverage: Vec<f32>,
    /// Standard error of each pixel's radiance, 0 on the background; `None` where it is not known.
    pub std_error: Option<Vec<[f32; 3]>>,
}

impl Picture {
    /// The film's means over a background; `background` is black where it is empty, and otherwise
    /// holds the uncovered pixels in order.
    pub fn compose(
        resolution: [u32; 2],
        points: &[ShadingPoint],
        film: &Film,
        background: &[[f32; 3]],
    ) -> Self {
        let count = resolution[0] as usize * resolution[1] as usize;
        let mut rgb = vec![[0.0; 3]; count];
        let mut coverage = vec![0.0; count];
        for (row, point) in points.iter().enumerate() {
            rgb[point.pixel as usize] = film.mean(row).map(|channel| channel as f32);
            coverage[point.pixel as usize] = 1.0;
        }
        let uncovered = rgb.iter_mut().zip(&coverage).filter(|(_, covered)| **covered == 0.0);
        for ((pixel, _), radiance) in uncovered.zip(background) {
            *pixel = *radiance;
        }
        let known = film.sampled_replicates() >= 2;
        let std_error = known.then(|| {
            let of_row = |row: usize| film.variance_of_mean(row).unwrap_or_default();
            let variances: Vec<[f64; 3]> = (0..points.len()).into_par_iter().map(of_row).collect();
            let mut errors = vec![[0.0; 3]; count];
            for (point, variance) in points.iter().zip(variances) {
                errors[point.pixel as usize] = variance.map(|variance| variance.sqrt() as f32);
            }
            errors
        });
        Self { resolution, rgb, coverage, std_error }
    }
}

/// `path` with an ending added: `a` becomes `a.exr`, `a.b` becomes `a.b.exr`; a picture's own ending
/// gives way, so that `a.png` becomes `a.exr` too.
pub fn with_ending(path: &Path, ending: &str) -> PathBuf {
    let own = path.extension().is_some_and(|own| own == "exr" || own == "png");
    let mut name =
        if own { path.with_extension("").into_os_string() } else { path.as_os_str().to_owned() };
    name.push(".");
    name.push(ending);
    PathBuf::from(name)
}

/// A file that is written, under a temporary name, and waits to get its own.
#[must_use = "a staged file is gone unless it is kept"]
pub struct Staged {
    temporary: tempfile::NamedTempFile,
    path: PathBuf,
}

/// Writes a file under a temporary name beside `path`.
pub fn stage(
    path: &Path,
    write: impl FnOnce(&mut std::io::BufWriter<&mut std::fs::File>) -> Result<(), String>,
) -> Result<Staged> {
    let problem = |reason: String| unwritable(path, &reason);
    let mut temporary = tempfile::Builder::new()
        .prefix(".brdf-")
        .tempfile_in(folder_of(path))
        .map_err(|error| problem(error.kind().to_string()))?;
    {
        let mut buffered = std::io::BufWriter::new(temporary.as_file_mut());
        write(&mut buffered).map_err(problem)?;
        std::io::Write::flush(&mut buffered).map_err(|error| problem(error.to_string()))?;
    }
    readable(temporary.as_file());
    Ok(Staged { temporary, path: path.to_owned() })
}

/// Makes a folder that files will be written to, and those above it, where they are not there.
///
/// # Errors
/// Where it cannot be made; `cure` says what else would do.
pub fn make_folder(folder: &Path, cure: &str) -> Result<()> {
    std::fs::create_dir_all(folder).map_err(|error| {
        let reason = format!("it cannot be made ({})", error.kind());
        Problem::new(folder.display().to_string(), reason, cure)
    })
}

/// Writes a text, whole or not at all, in place of any older file.
pub fn write_text(path: &Path, text: &str) -> Result<()> {
    stage(path, |file| {
        std::io::Write::write_all(file, text.as_bytes()).map_err(|error| error.to_string())
    })?
    .keep()
}

impl Staged {
    /// Gives the file its own name, in place of any older one.
    pub fn keep(self) -> Result<()> {
        let kept = self.temporary.persist(&self.path);
        kept.map(|_| ()).map_err(|error| unwritable(&self.path, &error.error.kind().to_string()))
    }
}

/// Refuses a path that cannot be written, before any work is done for it.
pub fn check_writable(path: &Path) -> Result<()> {
    if !folder_of(path).is_dir() {
        return Err(unwritable(path, "its folder does not exist"));
    }
    if path.is_dir() {
        return Err(unwritable(path, "a folder has this name"));
    }
    // A name that is too long is told when it is looked for, a folder that takes no files when one is made.
    if let Err(error) = path.symlink_metadata()
        && error.kind() != std::io::ErrorKind::NotFound
    {
        return Err(unwritable(path, &error.kind().to_string()));
    }
    stage(path, |_| Ok(())).map(drop)
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

fn unwritable(path: &Path, reason: &str) -> Problem {
    Problem::new(
        path.display().to_string(),
        format!("the file cannot be written ({reason})"),
        "name an existing folder with enough room that you may write to",
    )
}

/// Temporary files are private; pictures are as readable as any other new file.
#[cfg(unix)]
fn readable(file: &std::fs::File) {
    use std::os::unix::fs::PermissionsExt;
    // A file system without permissions refuses, and needs none.
    let _ = file.set_permissions(std::fs::Permissions::from_mode(0o644));
}

#[cfg(not(unix))]
fn readable(_: &std::fs::File) {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn endings_are_added_and_a_pictures_own_gives_way() {
        for (given, expected) in
            [("a", "a.exr"), ("x/a.b", "x/a.b.exr"), ("a.png", "a.exr"), ("a.exr", "a.exr")]
        {
            assert_eq!(with_ending(Path::new(given), "exr"), Path::new(expected));
        }
    }

    #[test]
    fn a_failed_write_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        std::fs::write(&path, "old").unwrap();
        let failed = stage(&path, |file| {
            std::io::Write::write_all(file, b"half").unwrap();
            Err("the disk is full".to_owned())
        });
        assert!(failed.err().unwrap().reason.contains("the disk is full"));
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "old");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
        assert!(
            check_writable(&folder.path().join("none/a.txt"))
                .unwrap_err()
                .cure
                .contains("existing folder")
        );
        let long = folder.path().join("a".repeat(300));
        assert!(check_writable(&long).unwrap_err().reason.contains("cannot be written"));
        check_writable(&path).unwrap();
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
        stage(&path, |file| std::io::Write::write_all(file, b"new").map_err(|e| e.to_string()))
            .unwrap()
            .keep()
            .unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "new");
    }
}
