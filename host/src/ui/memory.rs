//! What is remembered from one time to the next, in the platform's folder for settings: where views lie, what was
//! opened lately, and the scene as it was.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use brdf_sdk::Result;
use serde::{Deserialize, Serialize};

use crate::picture::write_text;

/// Files that were opened lately.
const MOST_RECENT: usize = 12;

/// The scene is saved no more often.
const SAVED_EVERY: Duration = Duration::from_secs(2);

/// The folder, and what was last written there.
#[derive(Default)]
pub(super) struct Memory {
    folder: Option<PathBuf>,
    remembered: Remembered,
    scene: String,
    saved: Option<Instant>,
}

#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
struct Remembered {
    /// Where views lie, as the tree of tabs writes itself.
    layout: String,
    /// `Light`, `Dark` or `System`.
    theme: Option<egui::ThemePreference>,
    recent: Vec<PathBuf>,
}

/// The platform's folder for this program's settings.
pub(super) fn folder() -> Option<PathBuf> {
    use etcetera::BaseStrategy;
    Some(etcetera::choose_base_strategy().ok()?.config_dir().join("brdf"))
}

impl Memory {
    /// What a folder remembers; nothing where there is none. What cannot be read is as if it were not there.
    pub(super) fn new(folder: Option<PathBuf>) -> Self {
        let text = |name: &str| {
            let path = folder.as_ref()?.join(name);
            std::fs::read_to_string(path).ok()
        };
        let remembered = text("viewer.toml").and_then(|text| toml::from_str(&text).ok());
        let scene = text("scene.toml").unwrap_or_default();
        Self { remembered: remembered.unwrap_or_default(), scene, saved: None, folder }
    }

    /// The scene as it was left.
    pub(super) fn scene(&self) -> Option<PathBuf> {
        let path = self.folder.as_ref()?.join("scene.toml");
        (!self.scene.is_empty()).then_some(path)
    }

    pub(super) fn layout(&self) -> &str {
        &self.remembered.layout
    }

    pub(super) fn theme(&self) -> Option<egui::ThemePreference> {
        self.remembered.theme
    }

    pub(super) fn recent(&self) -> &[PathBuf] {
        &self.remembered.recent
    }

    /// Takes note of a file that was opened.
    pub(super) fn opened(&mut self, path: &Path) {
        let path = path.canonicalize().unwrap_or_else(|_| path.to_owned());
        let recent = &mut self.remembered.recent;
        recent.retain(|other| *other != path);
        recent.insert(0, path);
        recent.truncate(MOST_RECENT);
        let _ = self.write();
    }

    /// Whether it is time to save the scene.
    pub(super) fn is_due(&self) -> bool {
        self.folder.is_some() && self.saved.is_none_or(|saved| saved.elapsed() >= SAVED_EVERY)
    }

    /// Writes what has changed.
    ///
    /// # Errors
    /// Where the folder cannot be made or written.
    pub(super) fn keep(
        &mut self,
        scene: String,
        layout: String,
        theme: egui::ThemePreference,
    ) -> Result<()> {
        self.saved = Some(Instant::now());
        if let Some(folder) = self.folder.clone().filter(|_| scene != self.scene) {
            write(&folder, "scene.toml", &scene)?;
            self.scene = scene;
        }
        let theme = Some(theme);
        if self.remembered.layout != layout || self.remembered.theme != theme {
            (self.remembered.layout, self.remembered.theme) = (layout, theme);
            self.write()?;
        }
        Ok(())
    }

    fn write(&self) -> Result<()> {
        let Some(folder) = &self.folder else { return Ok(()) };
        write(folder, "viewer.toml", &toml::to_string(&self.remembered).unwrap_or_default())
    }
}

fn write(folder: &Path, name: &str, text: &str) -> Result<()> {
    // Where it cannot be made, the file cannot be written, and that is told.
    let _ = std::fs::create_dir_all(folder);
    write_text(&folder.join(name), text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_kept_is_there_the_next_time_and_nonsense_is_passed_over() {
        let folder = tempfile::tempdir().unwrap();
        let own = folder.path().join("brdf");
        let mut memory = Memory::new(Some(own.clone()));
        assert!(memory.scene().is_none() && memory.is_due());
        memory
            .keep("a scene".to_owned(), "a layout".to_owned(), egui::ThemePreference::Dark)
            .unwrap();
        memory.opened(folder.path());
        assert!(!memory.is_due());
        let again = Memory::new(Some(own.clone()));
        assert_eq!(again.layout(), "a layout");
        assert_eq!(again.theme(), Some(egui::ThemePreference::Dark));
        assert_eq!(again.recent(), [folder.path().canonicalize().unwrap()]);
        assert_eq!(std::fs::read_to_string(again.scene().unwrap()).unwrap(), "a scene");
        std::fs::write(own.join("viewer.toml"), "= nonsense").unwrap();
        assert_eq!(Memory::new(Some(own)).layout(), "");
        assert!(Memory::new(None).scene().is_none());
    }
}
