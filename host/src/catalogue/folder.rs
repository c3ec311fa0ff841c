//! A catalogue on disk: written whole or not at all, and held against what lies there.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use brdf_sdk::{Problem, Result};

use super::{Entry, page};
use crate::picture::{Raster, Staged, stage};

/// How far a picture's bytes may be off: another machine may round another way.
const TOLERANCE: u8 = 2;

/// The page, and in the folder beside it the pictures.
const PAGE: &str = "catalogue.md";
pub const PICTURES: &str = "catalogue";

/// The files of a catalogue.
#[derive(Debug, Clone)]
pub struct Catalogue {
    /// Paths inside the folder of documents; the page is the last, so that it is never there without the
    /// pictures that it shows.
    files: Vec<(PathBuf, Content)>,
}

#[derive(Debug, Clone)]
enum Content {
    Text(String),
    Picture(Raster),
}

impl Catalogue {
    /// A catalogue of these entries in their order.
    pub fn new(entries: &[Entry]) -> Self {
        let file = |entry: &Entry, ending, content| {
            (Path::new(PICTURES).join(format!("{}.{ending}", entry.plugin.id)), content)
        };
        let mut files: Vec<_> = entries
            .iter()
            .flat_map(|entry| {
                let sphere = Content::Picture(entry.sphere.clone());
                let lobes = Content::Text(entry.lobes.clone());
                [file(entry, "png", sphere), file(entry, "svg", lobes)]
            })
            .collect();
        files.push((PAGE.into(), Content::Text(page::page(entries))));
        Self { files }
    }

    /// Refuses what is no folder, before any work is done for it.
    ///
    /// # Errors
    /// Where it is none.
    pub fn check_folder(folder: &Path) -> Result<()> {
        if folder.is_dir() {
            return Ok(());
        }
        let cure = "name the folder of the documents, or make it";
        Err(Problem::new(shown(folder), "there is no such folder", cure))
    }

    /// Writes the files into a folder; what else lies among the pictures stays.
    ///
    /// # Errors
    /// Where one of them cannot be written; then none is.
    pub fn write(&self, folder: &Path) -> Result<()> {
        Self::check_folder(folder)?;
        let pictures = folder.join(PICTURES);
        let made = !pictures.exists();
        if made {
            fs::create_dir(&pictures).map_err(|error| {
                let reason = format!("the folder cannot be made ({error})");
                Problem::new(shown(&pictures), reason, "name a folder that you may write to")
            })?;
        }
        let staged: Result<Vec<Staged>> =
            self.files.iter().map(|(path, content)| content.stage(&folder.join(path))).collect();
        if staged.is_err() && made {
            // Nothing is in it, and if it cannot be removed, an empty folder does no harm.
            let _ = fs::remove_dir(&pictures);
        }
        staged?.into_iter().try_for_each(Staged::keep)
    }

    /// A line for each file that is not what would be written, and for each that would not be.
    ///
    /// # Errors
    /// Where there is no such folder.
    pub fn stale(&self, folder: &Path) -> Result<Vec<String>> {
        Self::check_folder(folder)?;
        let lines = self.files.iter().filter_map(|(path, content)| {
            let path = folder.join(path);
            Some(format!("{} {}", shown(&path), content.unlike(&path)?))
        });
        Ok(lines.chain(self.strays(folder)).collect())
    }

    /// A line for each file among the pictures that is none of them; hidden ones are passed over.
    pub fn strays(&self, folder: &Path) -> Vec<String> {
        let pictures = folder.join(PICTURES);
        let Ok(entries) = fs::read_dir(pictures) else { return Vec::new() };
        let mut strays: Vec<PathBuf> = entries
            .flatten()
            .filter(|entry| !entry.file_name().as_encoded_bytes().starts_with(b"."))
            .map(|entry| entry.path())
            .filter(|path| self.files.iter().all(|(file, _)| folder.join(file) != *path))
            .collect();
        strays.sort();
        strays.iter().map(|path| format!("{} belongs to no BRDF: remove it", shown(path))).collect()
    }

    /// How many pictures there are.
    pub fn pictures(&self) -> usize {
        self.files.len() - 1
    }
}

impl Content {
    fn stage(&self, path: &Path) -> Result<Staged> {
        match self {
            Self::Picture(raster) => raster.stage(path),
            Self::Text(text) => {
                stage(path, |file| file.write_all(text.as_bytes()).map_err(|e| e.to_string()))
            }
        }
    }

    /// In what the file on disk is not this; `None` where it is.
    fn unlike(&self, path: &Path) -> Option<String> {
        if !path.exists() {
            return Some("is missing".to_owned());
        }
        match self {
            Self::Text(text) => unlike_text(text, &fs::read(path).unwrap_or_default()),
            Self::Picture(raster) => match Raster::read(path) {
                Ok(found) => unlike_picture(raster, &found),
                Err(problem) => Some(format!("cannot be read: {}", problem.reason)),
            },
        }
    }
}

/// Line ends are git's business.
fn unlike_text(expected: &str, found: &[u8]) -> Option<String> {
    let found = String::from_utf8_lossy(found).replace("\r\n", "\n");
    if found == expected {
        return None;
    }
    let same = expected.lines().zip(found.lines()).take_while(|(a, b)| a == b).count();
    Some(format!("is out of date from line {} on", same + 1))
}

fn unlike_picture(expected: &Raster, found: &Raster) -> Option<String> {
    if expected.resolution != found.resolution {
        let [[a, b], [c, d]] = [found.resolution, expected.resolution];
        return Some(format!("is out of date: {a}x{b} pixels instead of {c}x{d}"));
    }
    let off = |(a, b): (&[u8; 3], &[u8; 3])| a.iter().zip(b).map(|(a, b)| a.abs_diff(*b)).max();
    let off = expected.rgb.iter().zip(&found.rgb).filter_map(off);
    let (count, most) = off
        .filter(|off| *off > TOLERANCE)
        .fold((0, 0), |(count, most), off| (count + 1, most.max(off)));
    (count > 0).then(|| format!("is out of date: {count} pixels differ, by up to {most} of 255"))
}

fn shown(path: &Path) -> String {
    path.display().to_string().replace('\\', "/")
}
