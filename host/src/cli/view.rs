//! `brdf view`: the window.

use std::path::Path;

use brdf_sdk::{Kind, Result};

use super::{Verdict, readable};
use crate::exec::{self, Precision};
use crate::live::Document;
use crate::registry::Registry;
use crate::session::{Chosen, Session};
use crate::ui;

#[derive(Debug, Default, clap::Args)]
pub(super) struct Arguments {
    /// What to open: BRDFs by name, plugin folders, scenes, pictures with a scene, maps, meshes, data files
    files: Vec<String>,
    /// Where pictures are rendered, by its index or a part of its name (see `brdf devices`); `cpu` for this machine's cores
    #[arg(long, value_name = "DEVICE")]
    device: Option<String>,
}

pub(super) fn run(registry: Registry, arguments: &Arguments) -> Result<Verdict> {
    let document = match arguments.files.as_slice() {
        [] => None,
        files => Some(opened(&registry, files)?),
    };
    if let Some(device) = &arguments.device {
        // A name that means nothing is told before a window opens.
        exec::open(Some(device), Precision::F32)?;
    }
    ui::open(registry, document, arguments.device.clone())?;
    Ok(Verdict::Passed)
}

/// All that is named and can be opened, before a window opens. A BRDF among it takes the place of the usual one.
fn opened(registry: &Registry, files: &[String]) -> Result<Document> {
    let usual = Document::new(Session::new(registry)?);
    let mut document = usual.clone();
    readable(files, |file| match Path::new(file).exists() {
        true => document.open(registry, Path::new(file)).map(|_| ()),
        false => Chosen::find(registry, Kind::Brdf, file).map(|chosen| document.add(chosen)),
    })?;
    if document.materials.len() > 1 && document.materials[0] == usual.materials[0] {
        document.close(0);
        document.materials.iter_mut().enumerate().for_each(|(pen, material)| material.pen = pen);
    }
    Ok(document)
}
