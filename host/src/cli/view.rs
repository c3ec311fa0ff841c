//! `brdf view`: the window.

use std::path::Path;

use brdf_sdk::{Kind, Result};

use super::{Verdict, readable};
use crate::exec::{self, Precision};
use crate::live::Document;
use crate::registry::Registry;
use crate::session::{Chosen, Session};
use crate::ui::{self, Begin};

#[derive(Debug, Default, clap::Args)]
pub(super) struct Arguments {
    /// What to open: BRDFs by name, plugin folders, scenes, pictures with a scene, maps, meshes, data files
    files: Vec<String>,
    /// Where pictures are rendered, by its index or a part of its name (see `brdf devices`); `cpu` for this machine's cores
    #[arg(long, value_name = "DEVICE")]
    device: Option<String>,
}

pub(super) fn run(registry: Registry, arguments: &Arguments) -> Result<Verdict> {
    let begin = match arguments.files.as_slice() {
        [] => None,
        files => Some(opened(&registry, files)?),
    };
    if let Some(device) = &arguments.device {
        // A name that means nothing is told before a window opens.
        exec::open(Some(device), Precision::F32)?;
    }
    ui::open(registry, begin, arguments.device.clone())?;
    Ok(Verdict::Passed)
}

/// All that is named and can be opened, before a window opens. BRDFs among it take the place of the usual one, unless a
/// scene among it has that one, too.
fn opened(registry: &Registry, files: &[String]) -> Result<Begin> {
    let mut document = Document::new(Session::new(registry)?);
    let (mut is_usual, mut file) = (true, None);
    let (_, problems) = readable(files, |name| match Path::new(name).exists() {
        true => document.open(registry, Path::new(name)).map(|opened| {
            if let Some(scene) = opened.scene {
                (is_usual, file) = (false, scene);
            }
        }),
        false => Chosen::find(registry, Kind::Brdf, name).map(|chosen| document.add(chosen)),
    })?;
    if is_usual && document.materials.len() > 1 {
        document.close(0);
        document.materials.iter_mut().enumerate().for_each(|(pen, material)| material.pen = pen);
    }
    Ok(Begin { document, file, problems })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(begin: &Begin) -> Vec<&str> {
        begin.document.materials.iter().map(|material| material.chosen.name()).collect()
    }

    #[test]
    fn the_usual_brdf_gives_way_to_others_and_that_of_a_scene_does_not() {
        let registry = Registry::new(&[]);
        let folder = tempfile::tempdir().unwrap();
        let scene = folder.path().join("scene.toml").display().to_string();
        let text = "[brdf]\nplugin = \"ggx\"\n[[beside]]\nplugin = \"phong\"\n";
        std::fs::write(&scene, text).unwrap();
        let open = |files: &[&str]| {
            let files: Vec<String> = files.iter().map(|file| (*file).to_owned()).collect();
            opened(&registry, &files).unwrap()
        };
        let begin = open(&["phong", "minnaert"]);
        assert_eq!((names(&begin), begin.file.is_none()), (vec!["phong", "minnaert"], true));
        let begin = open(&[&scene]);
        assert_eq!(names(&begin), ["ggx", "phong"]);
        assert_eq!(begin.file.unwrap().display().to_string(), scene);
        let begin = open(&["phong", "none.hdr"]);
        assert_eq!((names(&begin), begin.problems.len()), (vec!["phong"], 1));
        assert!(opened(&registry, &["none.hdr".to_owned()]).is_err());
    }
}
