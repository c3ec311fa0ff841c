//! What a viewer has open: a scene, the BRDFs in it, and which of them the scene shows. It is what undo goes back over
//! and what sessions hold.

use std::path::{Path, PathBuf};

use brdf_sdk::manifest::MANIFEST_FILE;
use brdf_sdk::{Kind, Manifest, Problem, Result};

use crate::open;
use crate::picture;
use crate::plot::Settings;
use crate::registry::Registry;
use crate::session::{Chosen, Session};

/// A BRDF that is open.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// The BRDF with its parameters.
    pub chosen: Chosen,
    /// The number of its colour in plots.
    pub pen: usize,
    /// Whether plots show it.
    pub visible: bool,
    /// Whether plots show it and no others but such.
    pub solo: bool,
}

/// A scene and the BRDFs that are open.
#[derive(Debug, Clone, PartialEq)]
pub struct Document {
    /// The scene; its BRDFs are those of `materials`.
    pub session: Session,
    /// What is open, oldest first; never empty.
    pub materials: Vec<Material>,
    /// The one that pictures show.
    pub current: usize,
    /// What plots show of them.
    pub plot: Settings,
}

/// What became of a path that was opened.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Opened {
    /// One line on it.
    pub said: String,
    /// The scene's own file, where all that is open comes from it; nothing where it comes from a picture's header.
    pub scene: Option<Option<PathBuf>>,
}

impl Opened {
    /// Something came into the scene that is open.
    fn into_scene(said: String) -> Self {
        Self { said, scene: None }
    }
}

/// Files up to this size are read before they are taken; larger ones would be waited for, and whoever renders them says
/// what is wrong with them.
const SMALL: u64 = 8 << 20;

fn is_small(path: &Path) -> bool {
    std::fs::metadata(path).is_ok_and(|file| file.len() <= SMALL)
}

impl Document {
    /// What a session holds.
    pub fn new(mut session: Session) -> Self {
        let mut all = std::mem::take(&mut session.beside);
        let current = std::mem::take(&mut session.place).min(all.len());
        all.insert(current, session.brdf.clone());
        let material = |(pen, chosen)| Material { chosen, pen, visible: true, solo: false };
        let materials = all.into_iter().enumerate().map(material).collect();
        Self { session, materials, current, plot: Settings::default() }
    }

    /// The scene with the current BRDF, the others beside it.
    pub fn scene(&self) -> Session {
        let mut session = Session { place: self.current, ..self.session.clone() };
        for (index, material) in self.materials.iter().enumerate() {
            match index == self.current {
                true => session.brdf = material.chosen.clone(),
                false => session.beside.push(material.chosen.clone()),
            }
        }
        session
    }

    /// The BRDF that pictures show.
    pub fn current(&self) -> &Material {
        &self.materials[self.current.min(self.materials.len() - 1)]
    }

    /// The BRDF that is drawn in this colour.
    pub fn with_pen(&self, pen: usize) -> Option<&Material> {
        self.materials.iter().find(|material| material.pen == pen)
    }

    /// What plots show: those alone, where there are such, else all visible ones.
    pub fn plotted(&self) -> Vec<&Material> {
        let solo = self.materials.iter().any(|material| material.solo);
        let shown = |m: &&Material| if solo { m.solo } else { m.visible };
        self.materials.iter().filter(shown).collect()
    }

    /// Opens another BRDF, which pictures then show.
    pub fn add(&mut self, chosen: Chosen) {
        let used = |pen: &usize| self.materials.iter().any(|material| material.pen == *pen);
        let pen = (0..).find(|pen| !used(pen)).unwrap_or_default();
        self.materials.push(Material { chosen, pen, visible: true, solo: false });
        self.current = self.materials.len() - 1;
    }

    /// Closes a BRDF; the last one stays.
    pub fn close(&mut self, index: usize) {
        if self.materials.len() > 1 && index < self.materials.len() {
            self.materials.remove(index);
            if self.current > index || self.current == self.materials.len() {
                self.current -= 1;
            }
        }
    }

    /// Reads all plugins from disk again, parameters kept by name; what cannot be read stays as it was, and is told of.
    pub fn reload(&mut self, registry: &Registry) -> Vec<Problem> {
        let mut problems = Vec::new();
        let all = self.materials.iter_mut().map(|material| &mut material.chosen);
        for chosen in all.chain([&mut self.session.integrator]) {
            match chosen.reload(registry) {
                Ok(fresh) if fresh != *chosen => *chosen = fresh,
                Ok(_) => {}
                Err(problem) => problems.push(problem),
            }
        }
        problems
    }

    /// The folders of its plugins, and the files that these read.
    pub fn files(&self) -> [Vec<PathBuf>; 2] {
        let all = self.materials.iter().map(|material| &material.chosen);
        let all = all.chain([&self.session.integrator]);
        let (mut folders, mut files): (Vec<PathBuf>, Vec<PathBuf>) = Default::default();
        for chosen in all {
            folders.extend(chosen.folder.clone());
            files.extend(chosen.files());
        }
        for list in [&mut folders, &mut files] {
            list.sort();
            list.dedup();
        }
        [folders, files]
    }

    /// Opens what lies at a path, whatever it is: a plugin's folder, a scene or a picture with its scene, a map, a mesh,
    /// a BRDF's data.
    ///
    /// # Errors
    /// Where nothing here opens it, or it is broken.
    pub fn open(&mut self, registry: &Registry, path: &Path) -> Result<Opened> {
        let shown = path.display().to_string();
        let folder = match path.file_name().is_some_and(|name| name == MANIFEST_FILE) {
            true => path.parent(),
            false => Some(path).filter(|path| path.is_dir()),
        };
        if let Some(folder) = folder {
            return self.open_folder(registry, folder);
        }
        let ending = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_lowercase();
        match ending.as_str() {
            "toml" => self.open_toml(registry, path),
            "wgsl" => match path.parent() {
                Some(folder) => self.open_folder(registry, folder),
                None => {
                    Err(Problem::new(shown, "it lies in no folder", "open its plugin's folder"))
                }
            },
            "exr" if picture::read_scene(path).is_ok() => self.open_scene(registry, path),
            "exr" | "hdr" | "ptex" | "ptx" | "penv" => {
                let mut light = self.session.environment.clone();
                light.set_map(shown.clone());
                if is_small(path) {
                    open::environment(registry, &light)?;
                }
                self.session.environment = light;
                Ok(Opened::into_scene(format!("{shown} is the environment now")))
            }
            "obj" | "gltf" | "glb" => {
                if is_small(path) {
                    open::shape(&shown)?;
                }
                self.session.shape.clone_from(&shown);
                Ok(Opened::into_scene(format!("{shown} is the shape now")))
            }
            _ => {
                let chosen = Chosen::find(registry, Kind::Brdf, &shown)?;
                self.add(chosen);
                Ok(Opened::into_scene(format!("opened {shown}")))
            }
        }
    }

    fn open_folder(&mut self, registry: &Registry, folder: &Path) -> Result<Opened> {
        let manifest = folder.join(MANIFEST_FILE);
        let shown = folder.display().to_string();
        let full = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
        let reference = full.display().to_string();
        let text = std::fs::read_to_string(&manifest).map_err(|_| {
            Problem::new(&shown, "it holds no plugin.toml", "name the folder of a plugin")
        })?;
        let id = full.file_name().map(|name| name.to_string_lossy().into_owned());
        let kind =
            Manifest::parse(&manifest.display().to_string(), &text, &id.unwrap_or_default())?.kind;
        let chosen = Chosen::find(registry, kind, &reference)?;
        match kind {
            Kind::Brdf => self.add(chosen),
            Kind::Integrator => self.session.integrator = chosen,
        }
        Ok(Opened::into_scene(format!("opened the {} {shown}", kind.word())))
    }

    /// A scene, or the recipe of a map.
    fn open_toml(&mut self, registry: &Registry, path: &Path) -> Result<Opened> {
        let scene = self.open_scene(registry, path);
        if scene.is_ok() {
            return scene;
        }
        let shown = path.display().to_string();
        let mut light = self.session.environment.clone();
        light.set_map(shown.clone());
        // Of a file that is neither, what is wrong with it as a scene is told.
        if open::environment(registry, &light).is_err() {
            return scene;
        }
        self.session.environment = light;
        Ok(Opened::into_scene(format!("{shown} is the environment now")))
    }

    fn open_scene(&mut self, registry: &Registry, path: &Path) -> Result<Opened> {
        *self = Self::new(open::session(registry, path)?);
        let is_picture = path.extension().is_some_and(|end| end.eq_ignore_ascii_case("exr"));
        Ok(Opened {
            said: format!("opened the scene {}", path.display()),
            scene: Some((!is_picture).then(|| path.to_owned())),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_document_comes_back_in_its_order() {
        let registry = Registry::new(&[]);
        let mut document = Document::new(Session::new(&registry).unwrap());
        for name in ["lambert", "minnaert"] {
            document.add(Chosen::find(&registry, Kind::Brdf, name).unwrap());
        }
        for current in 0..3 {
            document.current = current;
            let written = document.scene().to_toml();
            let read = Session::parse(&registry, "scene.toml", &written, Path::new("")).unwrap();
            let read = Document::new(read);
            assert_eq!(
                (&read.materials, read.current),
                (&document.materials, current),
                "{written}"
            );
        }
    }
}
